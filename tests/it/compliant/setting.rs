//! From a contact law and a pace to what a simulated drop comes to: the words that the simulation and its
//! readers share.

use super::rigid::Vector;
use dropcheck::data::Contact;

/// What the target does to L.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// Share of the normal speed that a touch gives back.
    pub k: f64,
    /// Largest ratio of tangential to normal impulse; infinite for rough.
    pub friction: f64,
    /// With k = 0 L is held on the target whatever the sign of the force.
    pub holds: bool,
    /// L is let go for good where it does not slide and would have to be pulled to go on so, even if it could
    /// slide on.
    pub lets_go: bool,
    /// L is touched again; else the target is gone once L has left it.
    pub again: bool,
}

/// The limit that is taken: how short a pulse, how slow a touch that is rest, how short a step at rest.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::struct_field_names, reason = "the end of each name is its unit")]
pub struct Pace {
    /// Time to the deepest crush, s.
    pub loading_s: f64,
    /// A slower touch is rest, m/s.
    pub rest_m_s: f64,
    /// Step while L rests, s.
    pub rest_step_s: f64,
}

impl Pace {
    /// The pace with everything at `share`.
    pub fn times(self, share: f64) -> Self {
        Self {
            loading_s: share * self.loading_s,
            rest_m_s: share * self.rest_m_s,
            rest_step_s: share * self.rest_step_s,
        }
    }
}

/// How a simulated drop ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// R strikes.
    SlapDown,
    /// R comes down past the vertical.
    Never,
    /// Neither within the time or the number of touches allowed.
    Open,
}

/// What a simulated drop leads to.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// How it ends.
    pub end: End,
    /// R's velocity at the end, m/s.
    pub second_end_m_s: Vector,
    /// Inclination at the end, rad.
    pub angle_rad: f64,
    /// Time from first contact to the end, s.
    pub time_s: f64,
    /// Pulses at L, the first included.
    pub touches: u32,
    /// How long the first pulse lasts, s, and the share of its speed that L's corner leaves with; `None`
    /// where it does not spring back.
    pub first_pulse: Option<(f64, f64)>,
    /// Whether L rested on the target at any time.
    pub rested: bool,
    /// Largest rise of the energy over what it was before, as a share of that at first contact.
    pub energy_rise: f64,
}

/// The coefficient that a contact law puts on the tangential impulse.
pub fn friction(contact: Contact) -> f64 {
    match contact {
        Contact::Rough | Contact::Unknown => f64::INFINITY,
        Contact::Smooth => 0.0,
        Contact::Coulomb(coefficient) => coefficient,
    }
}
