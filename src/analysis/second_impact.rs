//! Follows the impact of R after a flight: the same drop in a mirror, which begins when R strikes.

use super::flight_search;
use super::setup::apply_law;
use crate::data::{
    AssumedFriction, At, AxialSource, Axis, Cask, CaskFile, Contact, Drop, End, Events, FlightFit, Motion,
    MotionState, Setup, Signal, transverse,
};
use crate::motion::{self, ContactCourse, ForceCourse, Integrated};
use crate::{events, fit};

/// Shortest flight after the impact of R that shows its velocity change, as a share of that impact.
const LEAST_FLIGHT_SHARE: f64 = 1.0;
/// Largest residual of a fit that explains this flight, as a share of the speed at which R strikes.
const MOST_RESIDUAL: f64 = 0.015;
/// Largest deviation of the rotation from that of a single contact at R, as a share: more means that L
/// strikes meanwhile. A length off by 5 % makes 0.1; if no flight shows the rotation, it includes ringing.
const TWO_CONTACTS_SHARE: f64 = 0.2;
const TWO_CONTACTS_SHARE_RINGING: f64 = 0.8;

/// A corner stands still when it sinks with less than this share of the velocity with which it struck: less
/// than a thousandth of its energy is left. It is sought in such steps, for so long after it struck.
const STILL: f64 = 0.02;
const CRUSH_STEP_S: f64 = 5e-4;
const LONGEST_CRUSH_S: f64 = 0.1;

/// Motion and contact of one impact.
pub(super) struct Course {
    pub motion: Motion,
    pub contact: ContactCourse,
}

/// The drop in a mirror, from the state in which R strikes: the striking end is then its first end.
pub(super) struct Mirror {
    setup: Setup,
    struck: At,
    signals: Vec<Signal>,
    /// Integrals of these signals.
    integrated: Integrated<'static>,
}

/// The impact of R in the mirror.
pub(super) struct SecondImpact<'a> {
    mirror: &'a Mirror,
    pub flight: FlightFit,
    /// Time at which R leaves; if no flight shows it, the end of the force.
    pub left: At,
    /// True if no flight determines the whole effect of the contact, which is then followed to its greatest
    /// crush.
    pub is_open: bool,
    axial: AxialSource,
    friction: Option<AssumedFriction>,
    /// True if the friction is measured or stated.
    is_known: bool,
    u_steps_m_s: Vec<f64>,
    /// Stated length, m, from which the channels in the mirror count.
    length_m: f64,
    /// Velocity that S gains along the axis, and R across it, m/s; and the rotation, rad/s.
    along_m_s: f64,
    across_m_s: f64,
    gained_rad_s: f64,
}

/// The mirror after a first impact with shifted inputs.
struct MovedMirror {
    setup: Setup,
    flight: FlightFit,
    times: Events,
}

/// Mirrors the drop from the state in which R strikes; `None` if it does not.
fn mirror_setup(first: &Setup, motion: &Motion, axial: AxialSource) -> Option<Setup> {
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

/// Mirrors the cask file.
fn mirror_file(file: &CaskFile, setup: &Setup) -> CaskFile {
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

/// Finds when R leaves and the flight after it; `None` if that does not determine the velocity from the
/// contact   (43)
fn find_flight(file: &CaskFile, integrated: &Integrated) -> Option<(At, FlightFit)> {
    let found = flight_search::find_without_target(file, integrated)?;
    let (left, flight) = (found.separation, found.flight?);
    let pulse_s = left.time_s - integrated.contact_s;
    let most_residual_m_s = MOST_RESIDUAL * file.drop.impact_velocity_m_s;
    let is_determined = pulse_s > 0.0
        && flight.to_s - flight.from_s > LEAST_FLIGHT_SHARE * pulse_s
        && flight.resolves_modes()
        && flight.plateaus.iter().all(|p| p.residual_m_s < most_residual_m_s);
    is_determined.then_some((left, flight))
}

/// Time at which the corner of R stands still once the force on R has ended, and the integrals there: the end
/// of a contact that no flight follows.
fn standstill(integrated: &Integrated, setup: &Setup) -> Option<(At, FlightFit)> {
    let to_s = flight_search::record_end_s(&integrated.signals).min(integrated.contact_s + LONGEST_CRUSH_S);
    let struck = transverse(&integrated.signals, End::First)?;
    let force_end_s = events::first_separation(struck, integrated.contact_s, to_s);
    let from_s = force_end_s.unwrap_or(integrated.contact_s + CRUSH_STEP_S);
    let mut steps =
        (0_u32..).map(|i| from_s + f64::from(i) * CRUSH_STEP_S).take_while(|time_s| *time_s < to_s);
    steps.find_map(|time_s| {
        let [first_contact, separation] = [integrated.contact_s, time_s].map(|at_s| Some(At::exact(at_s)));
        let times = Events { first_contact, separation, ..Events::default() };
        let flight = motion::flight_at(integrated, time_s);
        let motion = motion::outcome(integrated, &flight, &times, setup)?;
        let is_still = motion.rebound_m_s > -STILL * setup.impact_velocity_m_s;
        is_still.then_some((At::exact(time_s), flight))
    })
}

impl Mirror {
    /// Mirrors a flight with this motion; `None` if R does not strike.
    pub fn new(recorded: &[Signal], motion: &Motion, measured: &fit::FitData) -> Option<Self> {
        let (before, first) = (measured.flight, measured.setup);
        let struck = measured.events.slap_down?;
        let turning_rad_s = motion.separation.angular_velocity_rad_s;
        let setup = mirror_setup(first, motion, AxialSource::Sticking)?;
        let signals = motion::mirror(recorded, before, turning_rad_s, first.length_m, first.cog_m);
        let integrated = Integrated::new(&signals, struck.time_s).into_owned();
        Some(Self { setup, struck, signals, integrated })
    }
}

impl<'a> SecondImpact<'a> {
    /// Finds the impact of R if the recording shows when R leaves the target and with which velocity; if
    /// `is_open`, only up to its greatest crush.
    pub fn find(mirror: &'a Mirror, file: &CaskFile, measured: &fit::FitData, is_open: bool) -> Option<Self> {
        let (before, first) = (measured.flight, measured.setup);
        let Mirror { mut setup, struck, ref signals, ref integrated } = *mirror;
        let end = if is_open {
            standstill(integrated, &setup)
        } else {
            find_flight(&mirror_file(file, &setup), integrated)
        };
        let (left, flight) = end?;
        let times = Events { first_contact: Some(struck), separation: Some(left), ..Events::default() };
        let needed = motion::outcome(integrated, &flight, &times, &setup)?.impulse_ratio;
        let is_measured = signals.iter().any(|s| s.axis == Axis::Axial);
        // A contact that sticks at L may slide at R, and one that slides there may turn round or stick here.
        let law = if file.contact == Contact::Smooth { Contact::Smooth } else { Contact::Unknown };
        let friction = (!is_measured).then(|| apply_law(file, law, needed));
        let is_known = is_measured || law != Contact::Unknown;
        setup.axial = friction.map_or(AxialSource::Measured, |(axial, _)| axial);
        let basis = fit::FitData { signals, flight: &flight, events: &times, setup: &setup, ..*measured };
        // Unexplained ringing of either flight may continue in the other.
        let residual_m_s = |fit: &FlightFit, i: usize| fit.plateaus.get(i).map_or(0.0, |p| p.residual_m_s);
        let u_step_m_s = |i: usize| {
            let strain_m_s = fit::u_base_strain_m_s(&signals[i], &times, &measured.tolerances);
            let own_m_s = fit::u_step_m_s(&basis, i).hypot(strain_m_s);
            own_m_s.hypot(residual_m_s(before, i)).hypot(residual_m_s(&flight, i))
        };
        let u_steps_m_s = (0..flight.plateaus.len()).map(u_step_m_s).collect();
        let moved = motion::outcome(integrated, &flight, &times, &setup)?;
        let rotation_rad_s = moved.separation.angular_velocity_rad_s - moved.contact.angular_velocity_rad_s;
        let by_impulse_rad_s = moved.angular_impulse_m2_s * file.cask.mass_kg / file.cask.inertia_kg_m2;
        let most_off = if is_open { TWO_CONTACTS_SHARE_RINGING } else { TWO_CONTACTS_SHARE };
        let is_one = (rotation_rad_s - by_impulse_rad_s).abs() < most_off * rotation_rad_s.abs();
        let along = |s: &MotionState| {
            s.horizontal_velocity_m_s * s.angle_rad.cos() + s.vertical_velocity_m_s * s.angle_rad.sin()
        };
        let along_m_s = along(&moved.separation) - along(&moved.contact);
        let across_m_s = moved.rebound_m_s + setup.impact_velocity_m_s;
        let gained_rad_s = motion::rotation_rad_s(signals, &flight);
        is_one.then_some(Self {
            mirror,
            flight,
            left,
            is_open,
            axial: setup.axial,
            friction: friction.map(|(_, assumed)| assumed),
            is_known,
            u_steps_m_s,
            length_m: first.length_m,
            along_m_s,
            across_m_s,
            gained_rad_s,
        })
    }

    /// Lists the uncertain inputs beside those of the first impact and the flight, each with its standard
    /// uncertainty.
    pub fn inputs(&self) -> Vec<[String; 2]> {
        let entry = |what: &str, size: String| [format!("{what} of the second impact"), size];
        let steps = self.mirror.integrated.signals.iter().zip(&self.u_steps_m_s);
        let steps = steps.map(|(s, u)| entry(&format!("velocity step of {}", s.name), format!("{u:.3} m/s")));
        let u = self.friction.map_or(0.0, |friction| friction.u);
        let left = entry("end", format!("{:.3} ms", 1e3 * self.left.u_s));
        steps.chain([left, entry("friction", format!("{u:.3}"))]).collect()
    }

    /// Rotation from this impact, rad/s, if its friction is known.
    pub fn rotation_rad_s(&self) -> Option<f64> {
        self.is_known.then_some(self.gained_rad_s)
    }

    /// Excess of the rotation over that of its impulse, rad/s, after a first impact with these inputs and
    /// this motion   (32)
    pub fn excess_rotation_rad_s(&self, inputs: &fit::Inputs, first: &Motion) -> Option<f64> {
        let inertia_m2 = inputs.inertia_m2?;
        let MovedMirror { setup, flight, times } = self.shift(inputs, first)?;
        let motion = motion::outcome(&self.mirror.integrated, &flight, &times, &setup)?;
        Some(motion.excess_rotation_rad_s(inertia_m2))
    }

    /// Follows the contact of R after a first impact with these inputs and this motion.
    pub fn course(&self, inputs: &fit::Inputs, first: &Motion, by: ForceCourse) -> Option<Course> {
        let MovedMirror { setup, flight, times } = self.shift(inputs, first)?;
        let (motion, states) = motion::with_states(&self.mirror.integrated, &flight, &times, &setup)?;
        Some(Course { motion, contact: ContactCourse::from_states(&states, &setup, by)? })
    }

    /// Shifts setup, flight and times of the mirror to a first impact with these inputs and this motion.
    fn shift(&self, inputs: &fit::Inputs, first: &Motion) -> Option<MovedMirror> {
        let mut setup = mirror_setup(&inputs.setup, first, self.axial)?;
        // No check of the fit shifts the inputs of an open one.
        let (steps, [by_left, by_friction]) = if self.is_open {
            (&[][..], [0.0; 2])
        } else {
            let (steps, rest) = inputs.second_u.split_at_checked(self.u_steps_m_s.len())?;
            (steps, *rest.first_chunk()?)
        };
        if let Some(AssumedFriction { ratio, u }) = self.friction {
            setup.axial = AxialSource::Sliding { friction: ratio + by_friction * u };
        }
        let left = At { time_s: self.left.time_s + by_left * self.left.u_s, ..self.left };
        let times =
            Events { first_contact: inputs.events.slap_down, separation: Some(left), ..Events::default() };
        let mut flight = self.flight.clone();
        let shift = |i: usize, plateau: &mut crate::data::Plateau| {
            let at_channel = |all: &[f64]| all.get(i).copied().unwrap_or(0.0);
            // A sensor in the mirror that is farther from R by δ reads −ω δ more; so do all in a cask that is
            // longer than stated.
            let farther_m = inputs.setup.length_m - self.length_m - at_channel(&inputs.places_m);
            let across = self.mirror.integrated.signals.get(i).is_some_and(|s| s.axis == Axis::Transverse);
            let by_seat_m_s = if across {
                self.along_m_s * at_channel(&inputs.crosses) + self.gained_rad_s * farther_m
            } else {
                self.across_m_s * at_channel(&inputs.crosses)
            };
            plateau.velocity_step_m_s = plateau.velocity_step_m_s * (1.0 + at_channel(&inputs.scales))
                + by_seat_m_s
                + at_channel(steps) * at_channel(&self.u_steps_m_s);
        };
        flight.plateaus.iter_mut().enumerate().for_each(|(i, plateau)| shift(i, plateau));
        Some(MovedMirror { setup, flight, times })
    }
}
