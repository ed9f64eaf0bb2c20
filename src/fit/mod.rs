//! A motion that depends on uncertain inputs to k and the other unknowns, each with its interval.

mod inputs;

use crate::data::{
    AxialClosure, Contribution, Estimate, Events, FlightFit, Motion, Quantities, Setup, Signal, Tolerances,
};
use inputs::{Inputs, variations};

/// Coverage factor of a 95 % interval (GUM, 6.3.3).
pub const COVERAGE: f64 = 2.0;

/// Number of quantities followed through the propagation.
const COUNT: usize = 12;

/// The measured motion as a function of its inputs, such as `motion::reconstruct`.
pub type Reconstruct<'a> = &'a dyn Fn(&[Signal], &FlightFit, &Events, &Setup) -> Option<Motion>;

/// What the propagation starts from.
#[derive(Debug, Clone, Copy)]
pub struct Measured<'a> {
    /// The conditioned channels.
    pub signals: &'a [Signal],
    /// The flight fit.
    pub flight: &'a FlightFit,
    /// Times of the events.
    pub events: &'a Events,
    /// Standard uncertainties of first contact, separation and slap-down, s.
    pub u_events_s: [f64; 3],
    /// Geometry, initial motion and contact law.
    pub setup: &'a Setup,
    /// The contact law that the recording does not exclude either, where no axial channel tests it.
    pub other_law: Option<AxialClosure>,
    /// How well the stated things are known.
    pub tolerances: Tolerances,
}

/// Reads the quantities off the motion and propagates the inputs' standard uncertainties to them (GUM, 5.1.2), each input moved
/// by its standard uncertainty both ways; `None` where the motion cannot be had.
#[must_use]
pub fn quantities(measured: &Measured, reconstruct: Reconstruct) -> Option<Quantities> {
    let inputs = Inputs::new(measured);
    let values = |i: &Inputs| {
        reconstruct(measured.signals, &i.flight, &i.events, &i.setup).map(|m| observables(&m, i))
    };
    let base = values(&inputs)?;
    let mut variance = [0.0; COUNT];
    let mut budget = Vec::new();
    for variation in variations(measured) {
        let up = values(&variation.moved(&inputs, 1.0));
        let down = values(&variation.moved(&inputs, -1.0));
        let (Some(up), Some(down)) = (up, down) else { continue };
        let mut change = [0.0; COUNT];
        for i in 0..COUNT {
            change[i] = variation.share * f64::midpoint((up[i] - base[i]).abs(), (down[i] - base[i]).abs());
            variance[i] += change[i] * change[i];
        }
        budget.push(Contribution {
            input: variation.name,
            standard_uncertainty: variation.size,
            speed_m_s: measured.events.slap_down_s.map(|_| change[SPEED]),
            k: Some(change[K]),
        });
    }
    budget.sort_by(|a, b| {
        let weight = |c: &Contribution| c.speed_m_s.unwrap_or(0.0).hypot(10.0 * c.k.unwrap_or(0.0));
        weight(b).total_cmp(&weight(a))
    });
    let estimate = |i: usize, unit: &'static str| Estimate::new(base[i], COVERAGE * variance[i].sqrt(), unit);
    let at_slap_down = |i: usize, unit: &'static str| measured.events.slap_down_s.map(|_| estimate(i, unit));
    Some(Quantities {
        impact_velocity: estimate(IMPACT, "m/s"),
        duration: estimate(DURATION, "s"),
        rebound_velocity: estimate(REBOUND, "m/s"),
        angular_velocity: estimate(ROTATION, "rad/s"),
        k: estimate(K, "1"),
        flight_time: at_slap_down(FLIGHT, "s"),
        speed: at_slap_down(SPEED, "m/s"),
        vertical_velocity: at_slap_down(VERTICAL, "m/s"),
        horizontal_velocity: at_slap_down(HORIZONTAL, "m/s"),
        angle: at_slap_down(ANGLE, "deg"),
        second_end_height: at_slap_down(HEIGHT, "m"),
        slip_velocity: estimate(SLIP, "m/s"),
        budget,
    })
}

const IMPACT: usize = 0;
const DURATION: usize = 1;
const REBOUND: usize = 2;
const ROTATION: usize = 3;
const K: usize = 4;
const FLIGHT: usize = 5;
const SPEED: usize = 6;
const VERTICAL: usize = 7;
const HORIZONTAL: usize = 8;
const ANGLE: usize = 9;
const HEIGHT: usize = 10;
const SLIP: usize = 11;

/// Rebound ż_L as L leaves (22), k = −ż_L after over ż_L before (23), speed = |v_R| (24), and the rest.
fn observables(motion: &Motion, inputs: &Inputs) -> [f64; COUNT] {
    let contact_s = inputs.events.first_contact_s.unwrap_or(f64::NAN);
    let (horizontal, vertical) = motion.second_end_m_s.unwrap_or((f64::NAN, f64::NAN));
    let mut values = [0.0; COUNT];
    values[IMPACT] = inputs.setup.impact_velocity_m_s;
    values[DURATION] = motion.separation.time_s - contact_s;
    values[REBOUND] = motion.rebound_m_s;
    values[ROTATION] = motion.separation.angular_velocity_rad_s;
    values[K] = motion.rebound_m_s / inputs.setup.impact_velocity_m_s;
    values[FLIGHT] = motion.slap_down.map_or(f64::NAN, |s| s.time_s - motion.separation.time_s);
    values[SPEED] = horizontal.hypot(vertical);
    values[VERTICAL] = vertical;
    values[HORIZONTAL] = horizontal;
    values[ANGLE] = motion.slap_down.map_or(f64::NAN, |s| s.angle_rad.to_degrees());
    values[HEIGHT] = motion.second_end_height_m.unwrap_or(f64::NAN);
    values[SLIP] = motion.slip_m_s;
    values
}
