//! A flight that ends in a slap-down to the impact of R: the same drop in a mirror, which begins as R
//! strikes.

use super::flight_search;
use super::setup::{MIDDLE, U_UNKNOWN};
use crate::data::{
    AssumedFriction, At, AxialClosure, Axis, Cask, CaskFile, Drop, Events, FlightFit, Motion, MotionState,
    Setup, Signal,
};
use crate::fit;
use crate::motion::{self, ContactCourse, ForceCourse, Integrated};

/// A flight after the impact of R that is shorter than this share of it tells nothing of what came before.
const LEAST_FLIGHT: f64 = 1.0;
/// A fit of it that leaves more than this share of the speed at which R strikes has not explained it.
const MOST_LEFT: f64 = 0.015;
/// Standard uncertainty of a velocity step of R's contact over what its flight says of it: with it the
/// intervals of what R gains hold 19 of 20 simulated drops.
const STEPS: f64 = 2.0;

/// The impact of R, seen in a mirror: what strikes is its first end.
pub(super) struct SecondImpact {
    /// What its own channels read, in a mirror.
    integrated: Integrated<'static>,
    pub flight: FlightFit,
    /// When R leaves.
    pub left: At,
    axial: AxialClosure,
    friction: Option<AssumedFriction>,
    u_steps_m_s: Vec<f64>,
    /// What S gains along the axis, and R across it, m/s; and the rotation, rad/s.
    along_m_s: f64,
    across_m_s: f64,
    gained_rad_s: f64,
}

/// The drop in a mirror, from the state in which R strikes; `None` where it does not.
fn mirrored(first: &Setup, motion: &Motion, axial: AxialClosure) -> Option<Setup> {
    let (at, (_, up_m_s)) = motion.slap_down.zip(motion.second_end_m_s)?;
    Some(Setup {
        cog_m: first.length_m - first.cog_m,
        angle_rad: -at.angle_rad,
        impact_velocity_m_s: -up_m_s,
        is_of_fall: false,
        angular_velocity_rad_s: -at.angular_velocity_rad_s,
        horizontal_velocity_m_s: -at.horizontal_velocity_m_s,
        axial,
        ..*first
    })
}

/// The cask file as the mirror shows it.
fn in_mirror(file: &CaskFile, setup: &Setup) -> CaskFile {
    CaskFile {
        cask: Cask { cog_m: setup.cog_m, ..file.cask.clone() },
        drop: Drop {
            angle_rad: setup.angle_rad,
            impact_velocity_m_s: setup.impact_velocity_m_s,
            impact_velocity_given: true,
            angular_velocity_rad_s: setup.angular_velocity_rad_s,
            horizontal_velocity_m_s: setup.horizontal_velocity_m_s,
            ..file.drop
        },
        ..file.clone()
    }
}

/// When R leaves, and the flight after it; `None` where that does not tell the velocity which the contact
/// gave   (43)
fn told(file: &CaskFile, integrated: &Integrated) -> Option<(At, FlightFit)> {
    let found = flight_search::find_open(file, integrated)?;
    let (left, flight) = (found.separation, found.flight?);
    let pulse_s = left.time_s - integrated.contact_s;
    let most_left_m_s = MOST_LEFT * file.drop.impact_velocity_m_s;
    let is_told = pulse_s > 0.0
        && flight.to_s - flight.from_s > LEAST_FLIGHT * pulse_s
        && flight.is_told_apart()
        && flight.resolves_modes()
        && flight.plateaus.iter().all(|p| p.residual_m_s < most_left_m_s);
    is_told.then_some((left, flight))
}

/// How R slides as far as the channels tell: nobody states it, and it may be anything from none to what
/// sticking needs, `needed`.
fn sliding(signals: &[Signal], needed: f64) -> (AxialClosure, Option<AssumedFriction>) {
    if signals.iter().any(|s| s.axis == Axis::Axial) {
        return (AxialClosure::Measured, None);
    }
    let (ratio, u) = (MIDDLE * needed, (U_UNKNOWN * needed).abs());
    (AxialClosure::Sliding { friction: ratio }, Some(AssumedFriction { ratio, u }))
}

impl SecondImpact {
    /// The impact of R after a flight with this motion, where the recording tells when R leaves the target
    /// and what velocity that gives.
    pub fn find(
        file: &CaskFile,
        recorded: &[Signal],
        motion: &Motion,
        measured: &fit::FitData,
    ) -> Option<Self> {
        let (before, first) = (measured.flight, measured.setup);
        let slap_down = measured.events.slap_down?;
        let turning_rad_s = motion.separation.angular_velocity_rad_s;
        let mut setup = mirrored(first, motion, AxialClosure::Sticking)?;
        let signals = motion::mirrored(recorded, before, turning_rad_s, (first.length_m, first.cog_m));
        let integrated = Integrated::over(&signals, slap_down.time_s).into_owned();
        let (left, flight) = told(&in_mirror(file, &setup), &integrated)?;
        let times = Events { first_contact: Some(slap_down), separation: Some(left), ..Events::default() };
        let needed = motion::outcome(&integrated, &flight, &times, &setup)?.impulse_ratio;
        let (axial, friction) = sliding(&signals, needed);
        setup.axial = axial;
        let basis =
            fit::FitData { signals: &signals, flight: &flight, events: &times, setup: &setup, ..*measured };
        // What either flight leaves unexplained may ring on in the other.
        let left_m_s = |of: &FlightFit, i: usize| of.plateaus.get(i).map_or(0.0, |p| p.residual_m_s);
        let u_step_m_s = |i: usize| {
            STEPS * fit::u_step_m_s(&basis, i).hypot(left_m_s(before, i)).hypot(left_m_s(&flight, i))
        };
        let u_steps_m_s = (0..flight.plateaus.len()).map(u_step_m_s).collect();
        let moved = motion::outcome(&integrated, &flight, &times, &setup)?;
        let along = |s: &MotionState| {
            s.horizontal_velocity_m_s * s.angle_rad.cos() + s.vertical_velocity_m_s * s.angle_rad.sin()
        };
        let along_m_s = along(&moved.separation) - along(&moved.contact);
        let across_m_s = moved.rebound_m_s + setup.impact_velocity_m_s;
        let gained_rad_s = motion::rotation_rad_s(&signals, &flight);
        Some(Self {
            integrated,
            flight,
            left,
            axial,
            friction,
            u_steps_m_s,
            along_m_s,
            across_m_s,
            gained_rad_s,
        })
    }

    /// How many uncertain inputs it has beside those of the first impact and the flight.
    pub fn further(&self) -> usize {
        self.u_steps_m_s.len() + 2
    }

    /// The contact of R after a first impact with these inputs and this motion; its further inputs moved by
    /// so many standard uncertainties.
    pub fn course(
        &self,
        (inputs, first): (&fit::Inputs, &Motion),
        by_u: &[f64],
        (inertia_m2, by): (f64, ForceCourse),
    ) -> Option<(Motion, ContactCourse)> {
        let mut setup = mirrored(&inputs.setup, first, self.axial)?;
        let (steps, rest) = by_u.split_at_checked(self.u_steps_m_s.len())?;
        let [by_left, by_friction] = *rest.first_chunk()?;
        if let Some(AssumedFriction { ratio, u }) = self.friction {
            setup.axial = AxialClosure::Sliding { friction: ratio + by_friction * u };
        }
        let left = At { time_s: self.left.time_s + by_left * self.left.u_s, ..self.left };
        let times =
            Events { first_contact: inputs.events.slap_down, separation: Some(left), ..Events::default() };
        let mut flight = self.flight.clone();
        let moved = |i: usize, plateau: &mut crate::data::Plateau| {
            let of_channel = |all: &[f64]| all.get(i).copied().unwrap_or(0.0);
            // What a sensor in the mirror reads more for being farther from R, −ω δ, it reads less for being
            // farther from L.
            let across = self.integrated.signals.get(i).is_some_and(|s| s.axis == Axis::Transverse);
            let by_seat_m_s = if across {
                self.along_m_s * of_channel(&inputs.crosses)
                    - self.gained_rad_s * of_channel(&inputs.places_m)
            } else {
                self.across_m_s * of_channel(&inputs.crosses)
            };
            plateau.velocity_step_m_s = plateau.velocity_step_m_s * (1.0 + of_channel(&inputs.scales))
                + by_seat_m_s
                + of_channel(steps) * of_channel(&self.u_steps_m_s);
        };
        flight.plateaus.iter_mut().enumerate().for_each(|(i, plateau)| moved(i, plateau));
        let (motion, states) = motion::with_states(&self.integrated, &flight, &times, &setup)?;
        let course = ContactCourse::of((&motion, &states), &setup, inertia_m2, by)?;
        Some((motion, course))
    }
}
