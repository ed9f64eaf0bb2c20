//! The uncertain inputs of the reconstruction, each with its standard uncertainty, and the reconstruction's
//! inputs with them moved.

use super::FitData;
use super::steps::{u_base_strain_m_s, u_step_m_s};
use crate::data::planar::first_arm_m;
use crate::data::{
    AssumedFriction, At, AxialClosure, Axis, Events, FlightFit, MeasuredRotation, Motion, MotionState, Setup,
    StoodIn,
};

/// Standard uncertainty of the roll after a first contact, rad/s: edges tilted by 1 to 5° leave 20 to 180°/s.
const ROLL_RAD_S: f64 = 1.0;

/// Remedies that more than one input has.
pub(super) const REST: &str = "record the cask at rest before the release";
pub(super) const RELEASE: &str = "begin the recording before the release";
pub(super) const SECOND_SENSOR: &str = "a second sensor at the same end";
const SECOND_RATE_SENSOR: &str = "a second angular-rate sensor";
const MEASURE: &str = "measure between the edges that strike";
const FILM: &str = "high-speed video of the fall";
const GYRO: &str = "an angular-rate sensor and the rest before the release";

/// Share of cot φ that a friction reaches at most.
const MOST_FRICTION: f64 = 0.9;

/// One set of inputs, as a reconstruction is followed with them.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Velocity steps of the channels.
    pub flight: FlightFit,
    /// Times of the events.
    pub events: Events,
    /// Geometry, initial motion and friction.
    pub setup: Setup,
    /// By which share each channel's reading is corrected.
    pub scales: Vec<f64>,
    /// Likewise of each angular-rate sensor.
    pub rate_scales: Vec<f64>,
    /// What share of the other body axis is taken off each channel.
    pub crosses: Vec<f64>,
    /// How much farther from L each channel is, m.
    pub places_m: Vec<f64>,
    /// Θ / m, m².
    pub inertia_m2: Option<f64>,
    /// Inputs of the second impact alone, in their standard uncertainties.
    pub second_u: Vec<f64>,
    /// The channel that stands in for an end without one, and the channel it is derived from: their errors
    /// are equal.
    stood_in: Option<StoodIn>,
}

/// One input that is uncertain.
#[derive(Debug, Clone)]
pub struct UncertainInput {
    pub(super) name: String,
    /// Its standard uncertainty, as a person reads it.
    pub(super) size: String,
    /// More than one where channels share it.
    pub(super) changes: Vec<InputShift>,
}

impl UncertainInput {
    /// Whether the motion is discontinuous in this input, so that it has no derivative at zero: any change of
    /// the friction lets a cask that sticks slide.
    pub(super) fn jumps(&self) -> bool {
        self.changes.iter().any(|change| matches!(change, InputShift::Friction { .. }))
    }

    /// The key of `[tolerance]` that its uncertainty is from; `None` where the recording gives it.
    pub(super) fn tolerance(&self, setup: &Setup) -> Option<&'static str> {
        Some(self.changes.first()?.stated(setup)?.tolerance)
    }
}

/// An event whose time is uncertain.
#[derive(Debug, Clone, Copy)]
pub(super) enum Event {
    FirstContact,
    Separation,
    SlapDown,
}

impl Event {
    /// Its time.
    fn of(self, events: &mut Events) -> Option<&mut At> {
        match self {
            Self::FirstContact => events.first_contact.as_mut(),
            Self::Separation => events.separation.as_mut(),
            Self::SlapDown => events.slap_down.as_mut(),
        }
    }
}

/// What a positive standard uncertainty does; to a landing along the axis, where it names no channel.
#[derive(Debug, Clone, Copy)]
pub(super) enum InputShift {
    Step { channel: usize, add_m_s: f64 },
    BaseStrain { channel: usize, add_m_s: f64, share: f64 },
    Scale { channel: usize, share: f64 },
    RateScale { sensor: usize, share: f64 },
    Cross { channel: usize, share: f64, other_m_s: f64 },
    Place { channel: usize, by_m: f64, gained_rad_s: f64 },
    Angle { by_rad: f64 },
    ImpactVelocity { share: f64 },
    Event { event: Event, by_s: f64 },
    CentreOfGravity { by_m: f64 },
    Inertia { share: f64 },
    Friction { ratio: f64, by: f64 },
    Clock { share: f64 },
    Length { by_m: f64 },
    Section { by_m: f64 },
    AngularVelocity { by_rad_s: f64 },
    HorizontalVelocity { by_m_s: f64 },
    OfSecondImpact { input: usize },
    Landing { channel: Option<usize>, add_m_s: f64 },
}

/// The key of the cask file that states an input.
#[derive(Clone, Copy)]
pub(super) struct StatedKey {
    /// The key of `[tolerance]` that says how well it is known.
    pub tolerance: &'static str,
    /// The key itself; of a channel without its table.
    pub key: &'static str,
    /// A mistake as a person makes it, and how many standard uncertainties of the input it is.
    pub by: &'static str,
    pub by_u: f64,
    /// What would test it.
    pub remedy: &'static str,
}

impl InputShift {
    /// The key that states it; `None` where the recording itself gives it.
    pub(super) fn stated(&self, setup: &Setup) -> Option<StatedKey> {
        const DEGREE: f64 = std::f64::consts::PI / 180.0;
        let row = |tolerance, key, by, mistake: f64, u: f64, remedy| {
            Some(StatedKey { tolerance, key, by, by_u: mistake / u, remedy })
        };
        match *self {
            Self::Step { .. } | Self::Event { .. } | Self::OfSecondImpact { .. } | Self::Landing { .. } => {
                None
            }
            Self::Scale { share, .. } => {
                row("calibration_percent", "calibration_percent", "1 %", 0.01, share, REST)
            }
            Self::RateScale { share, .. } => {
                row("calibration_percent", "calibration_percent", "1 %", 0.01, share, SECOND_RATE_SENSOR)
            }
            Self::BaseStrain { share, .. } => {
                row("base_strain_percent", "tolerance.base_strain_percent", "1 %", 0.01, share, SECOND_SENSOR)
            }
            Self::Place { by_m, .. } => row("position_m", "position_m", "10 mm", 0.01, by_m, SECOND_SENSOR),
            Self::Cross { share, .. } => {
                row("cross_axis_percent", "axis", "1°", DEGREE, share, "check how the sensor sits")
            }
            // v0 is that of the root of the height.
            Self::ImpactVelocity { share } if setup.is_of_fall => {
                row("impact_velocity_percent", "drop.height_m", "1 %", 0.005, share, REST)
            }
            Self::ImpactVelocity { share } => {
                row("impact_velocity_percent", "drop.impact_velocity_m_s", "1 %", 0.01, share, REST)
            }
            Self::Angle { by_rad } => {
                let remedy = "an inclinometer on the rigged cask";
                row("angle_deg", "drop.angle_deg", "1°", DEGREE, by_rad, remedy)
            }
            Self::CentreOfGravity { by_m } => {
                row("cog_m", "cask.cog_m", "10 mm", 0.01, by_m, "weigh the cask on two supports")
            }
            Self::Inertia { share } => {
                let remedy = "high-speed video of both ends";
                row("inertia_percent", "cask.inertia_kg_m2", "10 %", 0.1, share, remedy)
            }
            Self::Friction { by, .. } => {
                let remedy = "an axial sensor at the first end";
                row("friction_percent", "contact.friction", "0.1", 0.1, by, remedy)
            }
            Self::Clock { share } => {
                row("clock_percent", "tolerance.clock_percent", "1 %", 0.01, share, REST)
            }
            Self::Length { by_m } => {
                row("length_m", "cask.length_m", "1 %", 0.01 * setup.length_m, by_m, MEASURE)
            }
            Self::Section { by_m } => {
                row("height_m", "cask.height_m", "1 %", 0.01 * setup.height_m, by_m, MEASURE)
            }
            Self::AngularVelocity { by_rad_s } => {
                row("angular_velocity_deg_s", "drop.angular_velocity_deg_s", "1°/s", DEGREE, by_rad_s, GYRO)
            }
            Self::HorizontalVelocity { by_m_s } => {
                row("horizontal_velocity_m_s", "drop.horizontal_velocity_m_s", "0.1 m/s", 0.1, by_m_s, FILM)
            }
        }
    }
}

impl Inputs {
    pub(super) fn new(measured: &FitData) -> Self {
        let channels = measured.flight.plateaus.len();
        Self {
            flight: measured.flight.clone(),
            events: *measured.events,
            setup: *measured.setup,
            scales: vec![0.0; channels],
            rate_scales: vec![0.0; measured.rotations.len()],
            crosses: vec![0.0; channels],
            places_m: vec![0.0; channels],
            inertia_m2: measured.inertia_m2,
            second_u: vec![0.0; measured.second.map_or(0, |second| second.inputs.len())],
            stood_in: measured.stood_in,
        }
    }

    /// The same inputs, the contact followed in so many steps.
    pub(super) fn in_steps(&self, contact_steps: usize) -> Self {
        Self { setup: Setup { contact_steps, ..self.setup }, ..self.clone() }
    }

    /// These inputs with each of `inputs` moved by so many of its standard uncertainties.
    pub(super) fn moved(&self, inputs: &[UncertainInput], by_u: &[f64]) -> Self {
        let mut moved = self.clone();
        for (input, &by) in inputs.iter().zip(by_u) {
            for change in input.changes.iter().filter(|_| by != 0.0) {
                moved.apply(self, *change, by);
            }
        }
        moved
    }

    fn apply(&mut self, base: &Self, change: InputShift, by: f64) {
        let stood_in = self.stood_in;
        let mut step = |channel: usize, add_m_s: f64| {
            let other = stood_in.filter(|s| s.by == channel).map(|s| (s.channel, s.share * add_m_s));
            for (channel, add_m_s) in [Some((channel, add_m_s)), other].into_iter().flatten() {
                if let Some(plateau) = self.flight.plateaus.get_mut(channel) {
                    plateau.velocity_step_m_s += add_m_s;
                }
            }
        };
        match change {
            InputShift::Step { channel, add_m_s } | InputShift::BaseStrain { channel, add_m_s, .. } => {
                step(channel, by * add_m_s);
            }
            InputShift::Scale { channel, share } => {
                let value = base.flight.plateaus.get(channel).map_or(0.0, |p| p.velocity_step_m_s);
                step(channel, by * share * value);
                self.scales[channel] += by * share;
            }
            InputShift::RateScale { sensor, share } => self.rate_scales[sensor] += by * share,
            InputShift::Cross { channel, share, other_m_s } => {
                step(channel, -by * share * other_m_s);
                self.crosses[channel] += by * share;
            }
            InputShift::Place { channel, by_m, gained_rad_s } => {
                // A sensor farther from L by δ reads Ω δ = −ω δ more.
                step(channel, by * gained_rad_s * by_m);
                self.places_m[channel] += by * by_m;
            }
            InputShift::Angle { by_rad } => self.setup.angle_rad += by * by_rad,
            InputShift::ImpactVelocity { share } => self.setup.impact_velocity_m_s *= 1.0 + by * share,
            InputShift::Event { event, by_s } => {
                if let Some(at) = event.of(&mut self.events) {
                    at.time_s += by * by_s;
                }
            }
            InputShift::CentreOfGravity { by_m } => self.setup.cog_m += by * by_m,
            InputShift::Inertia { share } => {
                self.inertia_m2 = self.inertia_m2.map(|i| i * (1.0 + by * share));
            }
            InputShift::Friction { ratio, by: u } => {
                // A force along the axis' own slope and no other has none across it: f_η says nothing of it.
                let most = MOST_FRICTION / self.setup.angle_rad.tan();
                self.setup.axial = AxialClosure::Sliding { friction: (ratio + by * u).min(most) };
            }
            InputShift::Clock { share } => self.setup.second_s += by * share,
            InputShift::Length { by_m } => self.setup.length_m += by * by_m,
            InputShift::Section { by_m } => self.setup.height_m += by * by_m,
            InputShift::AngularVelocity { by_rad_s } => {
                self.setup.angular_velocity_rad_s += by * by_rad_s;
                if self.setup.is_of_fall {
                    // ż_S is that of the fall: L strikes ω a more slowly   (3)
                    let Setup { cog_m, height_m, angle_rad, .. } = self.setup;
                    self.setup.impact_velocity_m_s -= by * by_rad_s * first_arm_m(cog_m, height_m, angle_rad);
                }
            }
            InputShift::HorizontalVelocity { by_m_s } => self.setup.horizontal_velocity_m_s += by * by_m_s,
            InputShift::OfSecondImpact { input } => self.second_u[input] += by,
            InputShift::Landing { channel, add_m_s } => {
                let Some(landing) = &mut self.flight.landing else { return };
                let along_m_s = landing.along_m_s.as_mut().map(|[along_m_s, _]| along_m_s);
                let own = channel.map_or(along_m_s, |channel| landing.steps_m_s.get_mut(channel));
                if let Some(step_m_s) = own {
                    *step_m_s += by * add_m_s;
                }
            }
        }
    }
}

/// Every input that is uncertain, with its size; `motion` is the one that the stated inputs give.
pub(super) fn inputs(measured: &FitData, motion: &Motion) -> Vec<UncertainInput> {
    let mut all = Vec::new();
    for (channel, signal) in measured.signals.iter().enumerate() {
        if signal.axis == Axis::Transverse || measured.setup.axial == AxialClosure::Measured {
            of_channel(&mut all, measured, motion, channel);
        }
    }
    all.extend(shared_calibrations(measured));
    all.extend(roll(measured));
    all.extend(measured.rotations.iter().enumerate().map(|rotation| rate_calibration(measured, rotation)));
    // Half of a 95 % half-width is a standard uncertainty.
    let known = &measured.tolerances;
    let mut add = |name: &str, size: String, change: InputShift| {
        all.push(UncertainInput { name: name.into(), size, changes: vec![change] });
    };
    if let Some([_, add_m_s]) = measured.flight.landing.as_ref().and_then(|landing| landing.along_m_s) {
        let shift = InputShift::Landing { channel: None, add_m_s };
        add("step by the touch along the axis", format!("{add_m_s:.3} m/s"), shift);
    }
    let by_rad = known.angle_rad / 2.0;
    add("drop angle", format!("{:.2}°", by_rad.to_degrees()), InputShift::Angle { by_rad });
    let share = known.impact_velocity / 2.0;
    add("impact velocity", percent(share), InputShift::ImpactVelocity { share });
    let events = measured.events;
    for (event, at, name) in [
        (Event::FirstContact, events.first_contact, "time of first contact"),
        (Event::Separation, events.separation, "time of separation"),
        (Event::SlapDown, events.slap_down, "time of slap-down"),
    ] {
        let by_s = at.map_or(0.0, |at| at.u_s);
        add(name, format!("{:.3} ms", 1e3 * by_s), InputShift::Event { event, by_s });
    }
    let by_m = known.cog_m / 2.0;
    add("centre of gravity", format!("{:.0} mm", 1e3 * by_m), InputShift::CentreOfGravity { by_m });
    if measured.inertia_m2.is_some() {
        let share = known.inertia / 2.0;
        add("inertia", percent(share), InputShift::Inertia { share });
    }
    if let Some(AssumedFriction { ratio, u }) = measured.friction {
        add("friction of the first contact", format!("{u:.3}"), InputShift::Friction { ratio, by: u });
    }
    let by_m = known.length * measured.setup.length_m / 2.0;
    add("length", format!("{:.0} mm", 1e3 * by_m), InputShift::Length { by_m });
    let by_m = known.height * measured.setup.height_m / 2.0;
    add("section", format!("{:.0} mm", 1e3 * by_m), InputShift::Section { by_m });
    let by_rad_s = known.angular_velocity_rad_s / 2.0;
    let size = format!("{:.2}°/s", by_rad_s.to_degrees());
    add("rotation at first contact", size, InputShift::AngularVelocity { by_rad_s });
    let by_m_s = known.horizontal_velocity_m_s / 2.0;
    add(
        "sideways velocity at first contact",
        format!("{by_m_s:.3} m/s"),
        InputShift::HorizontalVelocity { by_m_s },
    );
    let share = known.clock / 2.0;
    add("recorder's clock", format!("{:.3} %", 100.0 * share), InputShift::Clock { share });
    for (input, [name, size]) in measured.second.iter().flat_map(|second| second.inputs).enumerate() {
        add(name, size.clone(), InputShift::OfSecondImpact { input });
    }
    all
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// Standard uncertainty of a channel's scale.
fn u_scale(measured: &FitData, channel: usize) -> f64 {
    let own = measured.spec(channel).and_then(|spec| spec.calibration);
    own.unwrap_or(measured.tolerances.calibration) / 2.0
}

/// The scales of channels that were calibrated with the same thing: one input each, since they are off
/// together.
fn shared_calibrations(measured: &FitData) -> Vec<UncertainInput> {
    let mut shared: Vec<UncertainInput> = Vec::new();
    for channel in 0..measured.flight.plateaus.len().min(measured.signals.len()) {
        let Some(reference) = measured.spec(channel).and_then(|spec| spec.reference.as_ref()) else {
            continue;
        };
        let share = u_scale(measured, channel);
        let (name, change) = (format!("calibration by {reference}"), InputShift::Scale { channel, share });
        match shared.iter_mut().find(|input| input.name == name) {
            Some(input) => input.changes.push(change),
            None => shared.push(UncertainInput { name, size: percent(share), changes: vec![change] }),
        }
    }
    shared
}

/// The scale of an angular-rate sensor.
fn rate_calibration(measured: &FitData, (sensor, rotation): (usize, &MeasuredRotation)) -> UncertainInput {
    let share = rotation.calibration.unwrap_or(measured.tolerances.calibration) / 2.0;
    UncertainInput {
        name: format!("calibration of {}", rotation.channel),
        size: percent(share),
        changes: vec![InputShift::RateScale { sensor, share }],
    }
}

/// The roll that a tilted edge gives the cask, where channels sit off the plane of the drop: each reads roll
/// × place.
fn roll(measured: &FitData) -> Option<UncertainInput> {
    let at = |channel: usize| measured.spec(channel).map_or(0.0, |spec| spec.lateral_m);
    let is_beside =
        |&channel: &usize| measured.signals[channel].axis == Axis::Transverse && at(channel) != 0.0;
    let beside = (0..measured.flight.plateaus.len().min(measured.signals.len())).filter(is_beside);
    let step = |channel| InputShift::Step { channel, add_m_s: ROLL_RAD_S * at(channel) };
    let changes: Vec<InputShift> = beside.map(step).collect();
    let size = format!("{:.0}°/s", ROLL_RAD_S.to_degrees());
    (!changes.is_empty()).then(|| UncertainInput {
        name: "roll after the first contact".into(),
        size,
        changes,
    })
}

/// Step, calibration, cross axis and position of one channel.
fn of_channel(all: &mut Vec<UncertainInput>, measured: &FitData, motion: &Motion, channel: usize) {
    let (signal, known) = (&measured.signals[channel], &measured.tolerances);
    if channel >= measured.flight.plateaus.len() {
        return;
    }
    let mut add = |name: &str, size: String, change: InputShift| {
        all.push(UncertainInput { name: format!("{name} of {}", signal.name), size, changes: vec![change] });
    };
    let is_stood_in = measured.stood_in.is_some_and(|s| s.channel == channel);
    let u_m_s =
        if is_stood_in { measured.flight.plateaus[channel].u_m_s } else { u_step_m_s(measured, channel) };
    add("velocity step", format!("{u_m_s:.3} m/s"), InputShift::Step { channel, add_m_s: u_m_s });
    if let Some(landing) = &measured.flight.landing {
        let add_m_s = landing.u_m_s[channel];
        let shift = InputShift::Landing { channel: Some(channel), add_m_s };
        add("step by the touch", format!("{add_m_s:.3} m/s"), shift);
    }
    if is_stood_in {
        // Its sensor's errors are those of the channel that it is made of.
        return;
    }
    if measured.spec(channel).is_none_or(|spec| spec.reference.is_none()) {
        let share = u_scale(measured, channel);
        add("calibration", percent(share), InputShift::Scale { channel, share });
    }
    let share = known.base_strain / 2.0;
    let strain = InputShift::BaseStrain { channel, add_m_s: u_base_strain_m_s(measured, channel), share };
    add("base strain", percent(share), strain);
    let (before, after) = (body_m_s(&motion.contact), body_m_s(&motion.separation));
    let (transverse_m_s, axial_m_s) = (after.0 - before.0, after.1 - before.1);
    let omega = motion.separation.angular_velocity_rad_s - motion.contact.angular_velocity_rad_s;
    let is_transverse = signal.axis == Axis::Transverse;
    let other_m_s = if is_transverse {
        axial_m_s
    } else {
        transverse_m_s - omega * (signal.position_m - measured.setup.cog_m)
    };
    let share = known.cross_axis / 2.0;
    add("cross axis", percent(share), InputShift::Cross { channel, share, other_m_s });
    if is_transverse {
        let by_m = known.position_m / 2.0;
        let place = InputShift::Place { channel, by_m, gained_rad_s: omega };
        add("position", format!("{:.0} mm", 1e3 * by_m), place);
    }
}

/// Velocity of S along the body axes, m/s: transverse, axial.
fn body_m_s(state: &MotionState) -> (f64, f64) {
    let (sin, cos) = state.angle_rad.sin_cos();
    let (along_m_s, up_m_s) = (state.horizontal_velocity_m_s, state.vertical_velocity_m_s);
    (up_m_s * cos - along_m_s * sin, along_m_s * cos + up_m_s * sin)
}
