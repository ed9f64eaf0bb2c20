//! The uncertain inputs of the reconstruction, each with its standard uncertainty and the effect of a shift
//! on the reconstruction.

use super::FitData;
use super::steps::{u_base_strain_m_s, u_step_m_s};
use crate::data::planar::first_arm_m;
use crate::data::{
    AssumedFriction, At, AxialSource, Axis, Events, FlightFit, Motion, MotionState, ScaledCopy, Setup, Signal,
};

/// Standard uncertainty of the roll after a first contact, rad/s: edges tilted by 1 to 5° give 20 to 180°/s.
const ROLL_RAD_S: f64 = 1.0;

/// Remedies that more than one input has.
pub(super) const REST: &str = "record the cask at rest before the release";
pub(super) const RELEASE: &str = "begin the recording before the release";
pub(super) const SECOND_SENSOR: &str = "a second sensor at the same end";
pub(super) const LARGER_RANGE: &str = "a second sensor of ten times the range at the same end";
const MEASURE: &str = "measure between the edges that strike";

/// Beginning of the name of an input for the base strain of a channel.
pub(super) const BASE_STRAIN: &str = "base strain of ";

/// The key of the tolerance of the friction.
const FRICTION: &str = "friction_percent";
/// A corner that crushes by less than the first share of the length is an edge, one that crushes by more than
/// the second belongs to a limiter: contacts of 10 and 17 ms after a fall of 9 m. With half of them lengths
/// that are 3 % off remain undetected.
const EDGE: f64 = 0.012;
const LIMITER: f64 = 0.02;
/// Standard uncertainty of the inward movement of the force on a limiter per crush, as a share of cot φ: half
/// of the section that the target cuts off is 0.5, the mean over a contact 0.4.
const U_INWARD: f64 = 0.2;
/// Outward the force moves by at most this share of it.
const LEAST_INWARD: f64 = 0.2;
/// The inward movement reduces the rotation by at most half: by a fifth, if the friction is not known.
const MOST_MISSED: f64 = 0.5;
/// Largest friction, as a share of cot φ.
const MOST_FRICTION: f64 = 0.9;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// One set of inputs of a reconstruction.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Velocity steps of the channels.
    pub flight: FlightFit,
    /// Times of the events.
    pub events: Events,
    /// Geometry, initial motion and friction.
    pub setup: Setup,
    /// Correction of each channel's reading, as a share.
    pub scales: Vec<f64>,
    /// Likewise of each angular-rate sensor.
    pub rate_scales: Vec<f64>,
    /// Share of the other body axis that is subtracted from each channel.
    pub crosses: Vec<f64>,
    /// Shift of each channel away from L, m.
    pub places_m: Vec<f64>,
    /// Θ / m, m².
    pub inertia_m2: Option<f64>,
    /// Inputs of the second impact alone, in their standard uncertainties.
    pub second_u: Vec<f64>,
    /// The reconstructed channel, and the channel from which it is derived: their errors are equal.
    stood_in: Option<ScaledCopy>,
}

/// The time of an event.
type EventTime = fn(&mut Events) -> &mut Option<At>;

/// Shifts an input by a number of standard uncertainties.
type Shift = Box<dyn Fn(&mut Inputs, f64) + Send + Sync>;

/// One uncertain input.
pub struct UncertainInput {
    pub(super) name: String,
    /// Standard uncertainty for a reader.
    pub(super) size: String,
    /// The key that states it; `None` if the recording determines it.
    pub(super) stated: Option<StatedKey>,
    /// More than one where channels share it.
    pub(super) shifts: Vec<Shift>,
}

impl UncertainInput {
    /// True if the motion is discontinuous in this input, so that it has no derivative at zero: any change of
    /// the friction lets a cask that sticks slide.
    pub(super) fn jumps(&self) -> bool {
        self.stated.as_ref().is_some_and(|stated| stated.tolerance == FRICTION)
    }
}

/// The key of the cask file that states an input.
pub(super) struct StatedKey {
    /// The key of `[tolerance]` for its uncertainty.
    pub tolerance: &'static str,
    /// The key itself; for a channel without its table.
    pub key: &'static str,
    /// The channel whose key it is.
    pub channel: Option<String>,
    /// A typical mistake, and its size in standard uncertainties of the input.
    pub by: &'static str,
    pub by_u: f64,
    /// Measure that would check the input.
    pub remedy: &'static str,
    /// Stated number, for a scale 1, and the change of it by a standard uncertainty; none if another number
    /// could not be separated from other mistakes.
    pub number: Option<[f64; 2]>,
}

fn entry(
    tolerance: &'static str,
    key: &'static str,
    by: &'static str,
    by_u: f64,
    remedy: &'static str,
) -> StatedKey {
    StatedKey { tolerance, key, channel: None, by, by_u, remedy, number: None }
}

/// The key of a channel's scale.
fn calibration(channel: &str, share: f64, remedy: &'static str) -> StatedKey {
    let key = entry("calibration_percent", "calibration_percent", "1 %", 0.01 / share, remedy);
    key.tag(channel).with_number(1.0, share)
}

impl StatedKey {
    /// Moves the key to the table of a channel.
    fn tag(self, channel: &str) -> Self {
        Self { channel: Some(channel.to_owned()), ..self }
    }

    fn with_number(self, stated: f64, by_u: f64) -> Self {
        Self { number: Some([stated, by_u]), ..self }
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

    /// Copies the inputs with another number of steps for the contact.
    pub(super) fn with_contact_steps(&self, contact_steps: usize) -> Self {
        Self { setup: Setup { contact_steps, ..self.setup }, ..self.clone() }
    }

    /// Copies the inputs with each of `inputs` shifted by a number of its standard uncertainties.
    pub(super) fn shift(&self, inputs: &[UncertainInput], by_u: &[f64]) -> Self {
        let mut moved = self.clone();
        for (input, by) in inputs.iter().zip(by_u).filter(|(_, by)| **by != 0.0) {
            input.shifts.iter().for_each(|shift| shift(&mut moved, *by));
        }
        moved
    }

    /// Adds to a channel's velocity step, and in proportion to the channel that is reconstructed from it.
    fn step(&mut self, channel: usize, add_m_s: f64) {
        let other = self.stood_in.filter(|s| s.by == channel).map(|s| (s.channel, s.share * add_m_s));
        for (channel, add_m_s) in [Some((channel, add_m_s)), other].into_iter().flatten() {
            if let Some(plateau) = self.flight.plateaus.get_mut(channel) {
                plateau.velocity_step_m_s += add_m_s;
            }
        }
    }

    fn turn_faster(&mut self, by_rad_s: f64) {
        self.setup.angular_velocity_rad_s += by_rad_s;
        if self.setup.is_of_fall {
            // ż_S follows from the fall: L strikes slower by ω a   (3)
            let Setup { cog_m, height_m, angle_rad, .. } = self.setup;
            self.setup.impact_velocity_m_s -= by_rad_s * first_arm_m(cog_m, height_m, angle_rad);
        }
    }
}

/// Lists every uncertain input with its size; `motion` belongs to the stated inputs.
pub(super) fn inputs(measured: &FitData, motion: &Motion) -> Vec<UncertainInput> {
    let mut all = InputList(Vec::new());
    for (channel, signal) in measured.signals.iter().enumerate().take(measured.flight.plateaus.len()) {
        if signal.axis == Axis::Transverse || measured.setup.axial == AxialSource::Measured {
            all.add_channel(measured, motion, channel);
        }
    }
    all.add_shared_calibrations(measured);
    all.add_roll(measured);
    for (sensor, rotation) in measured.rotations.iter().enumerate() {
        let share = rotation.calibration.unwrap_or(measured.tolerances.calibration) / 2.0;
        let (name, channel) = (format!("calibration of {}", rotation.channel), &rotation.channel);
        let key = calibration(channel, share, "a second angular-rate sensor");
        all.add(name, percent(share), Some(key), move |inputs, by| inputs.rate_scales[sensor] += by * share);
    }
    if let Some([_, add_m_s]) = measured.flight.landing.as_ref().and_then(|landing| landing.along_m_s) {
        all.add("step by the touch along the axis", format!("{add_m_s:.3} m/s"), None, move |inputs, by| {
            if let Some([along_m_s, _]) = inputs.flight.landing.as_mut().and_then(|l| l.along_m_s.as_mut()) {
                *along_m_s += by * add_m_s;
            }
        });
    }
    all.add_fall(measured);
    all.add_body(measured, motion);
    all.add_further(measured);
    all.0
}

/// The inputs found so far.
struct InputList(Vec<UncertainInput>);

// Half of a 95 % half-width is a standard uncertainty.
impl InputList {
    fn add(
        &mut self,
        name: impl Into<String>,
        size: String,
        stated: Option<StatedKey>,
        shift: impl Fn(&mut Inputs, f64) + Send + Sync + 'static,
    ) {
        let shifts: Vec<Shift> = vec![Box::new(shift)];
        self.0.push(UncertainInput { name: name.into(), size, stated, shifts });
    }

    /// Angle, impact velocity and the times of the events.
    fn add_fall(&mut self, measured: &FitData) {
        let by_rad = measured.tolerances.angle_rad / 2.0;
        let remedy = "an inclinometer on the rigged cask";
        let key = entry("angle_deg", "drop.angle_deg", "1°", DEGREE / by_rad, remedy);
        let key = key.with_number(measured.setup.angle_rad, by_rad);
        let size = format!("{:.2}°", by_rad.to_degrees());
        self.add("drop angle", size, Some(key), move |inputs, by| inputs.setup.angle_rad += by * by_rad);
        let share = measured.tolerances.impact_velocity / 2.0;
        let key = if measured.setup.is_of_fall {
            // v0 grows with the root of the height.
            entry("impact_velocity_percent", "drop.height_m", "1 %", 0.005 / share, REST)
        } else {
            entry("impact_velocity_percent", "drop.impact_velocity_m_s", "1 %", 0.01 / share, REST)
        };
        let v0_m_s = measured.setup.impact_velocity_m_s;
        let key = key.with_number(v0_m_s, share * v0_m_s);
        self.add("impact velocity", percent(share), Some(key), move |inputs, by| {
            inputs.setup.impact_velocity_m_s *= 1.0 + by * share;
        });
        let events: [(&str, EventTime); 3] = [
            ("time of first contact", |events| &mut events.first_contact),
            ("time of separation", |events| &mut events.separation),
            ("time of slap-down", |events| &mut events.slap_down),
        ];
        let mut stated = *measured.events;
        for (name, event) in events {
            let by_s = event(&mut stated).map_or(0.0, |at| at.u_s);
            self.add(name, format!("{:.3} ms", 1e3 * by_s), None, move |inputs, by| {
                if let Some(at) = event(&mut inputs.events) {
                    at.time_s += by * by_s;
                }
            });
        }
    }

    /// Mass properties, the friction of the contact, and the size of the cask.
    fn add_body(&mut self, measured: &FitData, motion: &Motion) {
        let (known, setup) = (&measured.tolerances, measured.setup);
        let by_m = known.cog_m / 2.0;
        let key = entry("cog_m", "cask.cog_m", "10 mm", 0.01 / by_m, "weigh the cask on two supports");
        let key = key.with_number(setup.cog_m, by_m);
        self.add("centre of gravity", mm(by_m), Some(key), move |inputs, by| inputs.setup.cog_m += by * by_m);
        if measured.inertia_m2.is_some() {
            let share = known.inertia / 2.0;
            let remedy = "high-speed video of both ends";
            let key = entry("inertia_percent", "cask.inertia_kg_m2", "10 %", 0.1 / share, remedy);
            let key = key.with_number(1.0, share);
            self.add("inertia", percent(share), Some(key), move |inputs, by| {
                inputs.inertia_m2 = inputs.inertia_m2.map(|i| i * (1.0 + by * share));
            });
        }
        if let Some(AssumedFriction { ratio, u }) = measured.friction {
            let remedy = "an axial sensor at the first end";
            let key = entry(FRICTION, "contact.friction", "0.1", 0.1 / u, remedy);
            self.add("friction of the first contact", format!("{u:.3}"), Some(key), move |inputs, by| {
                // A force along the slope of the axis has no component across it, so f_η does not show it.
                let most = MOST_FRICTION / inputs.setup.angle_rad.tan();
                inputs.setup.axial = AxialSource::Sliding { friction: (ratio + by * u).min(most) };
            });
        }
        self.add_footprint(measured, motion);
        let by_m = known.length * setup.length_m / 2.0;
        let key = entry("length_m", "cask.length_m", "1 %", 0.01 * setup.length_m / by_m, MEASURE);
        let key = key.with_number(setup.length_m, by_m);
        self.add("length", mm(by_m), Some(key), move |inputs, by| inputs.setup.length_m += by * by_m);
        let by_m = known.height * setup.height_m / 2.0;
        let key = entry("height_m", "cask.height_m", "1 %", 0.01 * setup.height_m / by_m, MEASURE);
        let key = key.with_number(setup.height_m, by_m);
        self.add("section", mm(by_m), Some(key), move |inputs, by| inputs.setup.height_m += by * by_m);
    }

    /// Adds the inward movement of the force from a corner that crushes   (32)
    fn add_footprint(&mut self, measured: &FitData, motion: &Motion) {
        let (setup, Some(inertia_m2)) = (measured.setup, measured.inertia_m2) else { return };
        let limited = ((motion.crush_m / setup.length_m - EDGE) / (LIMITER - EDGE)).clamp(0.0, 1.0);
        let turned_rad_s = motion.separation.angular_velocity_rad_s;
        // If the rotation shows the wrong end or a wrong scale, the crush is unknown.
        if limited > 0.0 && motion.excess_rotation_rad_s(inertia_m2).abs() < MOST_MISSED * turned_rad_s {
            let u = limited * U_INWARD / setup.angle_rad.tan();
            let size = format!("{u:.2} m per m of crush");
            // Twice as steep inward, and level outward.
            let moved = |by: f64| by + by.hypot(LEAST_INWARD) - LEAST_INWARD;
            self.add("footprint of the corners", size, None, move |inputs, by| {
                inputs.setup.inward = u * moved(by);
            });
        }
    }

    /// Adds rotation and sideways velocity, the recorder's clock, and the inputs of the second impact alone.
    fn add_further(&mut self, measured: &FitData) {
        let known = &measured.tolerances;
        let by_rad_s = known.angular_velocity_rad_s / 2.0;
        let remedy = "an angular-rate sensor and the rest before the release";
        let (tolerance, by_u) = ("angular_velocity_deg_s", DEGREE / by_rad_s);
        let key = entry(tolerance, "drop.angular_velocity_deg_s", "1°/s", by_u, remedy);
        let key = key.with_number(measured.setup.angular_velocity_rad_s, by_rad_s);
        let size = format!("{:.2}°/s", by_rad_s.to_degrees());
        let shift = move |inputs: &mut Inputs, by: f64| inputs.turn_faster(by * by_rad_s);
        self.add("rotation at first contact", size, Some(key), shift);
        let by_m_s = known.horizontal_velocity_m_s / 2.0;
        let (tolerance, remedy) = ("horizontal_velocity_m_s", "high-speed video of the fall");
        let key = entry(tolerance, "drop.horizontal_velocity_m_s", "0.1 m/s", 0.1 / by_m_s, remedy);
        let size = format!("{by_m_s:.3} m/s");
        self.add("sideways velocity at first contact", size, Some(key), move |inputs, by| {
            inputs.setup.horizontal_velocity_m_s += by * by_m_s;
        });
        let share = known.clock / 2.0;
        let key = entry("clock_percent", "tolerance.clock_percent", "1 %", 0.01 / share, REST);
        let key = key.with_number(1.0, share);
        let size = format!("{:.3} %", 100.0 * share);
        self.add("recorder's clock", size, Some(key), move |inputs, by| inputs.setup.second_s += by * share);
        for (input, [name, size]) in measured.second.iter().flat_map(|second| second.inputs).enumerate() {
            self.add(name, size.clone(), None, move |inputs, by| inputs.second_u[input] += by);
        }
    }

    /// Adds the scales of channels that share a calibration: one input each, since their errors are equal.
    fn add_shared_calibrations(&mut self, measured: &FitData) {
        let first = self.0.len();
        for (channel, signal) in measured.signals.iter().enumerate().take(measured.flight.plateaus.len()) {
            let Some(reference) = measured.spec(channel).and_then(|spec| spec.reference.as_ref()) else {
                continue;
            };
            let name = format!("calibration by {reference}");
            let (share, shift) = scale(measured, channel);
            match self.0[first..].iter_mut().find(|input| input.name == name) {
                Some(input) => input.shifts.push(shift),
                None => self.add(name, percent(share), Some(calibration(&signal.name, share, REST)), shift),
            }
        }
    }

    /// Adds the roll from a tilted edge, if channels sit off the plane of the drop: each reads roll ×
    /// position.
    fn add_roll(&mut self, measured: &FitData) {
        let place = |(channel, signal): (usize, &Signal)| {
            let spec = measured.spec(channel).filter(|_| signal.axis == Axis::Transverse)?;
            (spec.lateral_m != 0.0).then_some((channel, ROLL_RAD_S * spec.lateral_m))
        };
        let own = measured.signals.iter().enumerate().take(measured.flight.plateaus.len());
        let steps_m_s: Vec<(usize, f64)> = own.filter_map(place).collect();
        if !steps_m_s.is_empty() {
            let size = format!("{:.0}°/s", ROLL_RAD_S.to_degrees());
            self.add("roll after the first contact", size, None, move |inputs, by| {
                for (channel, add_m_s) in &steps_m_s {
                    inputs.step(*channel, by * add_m_s);
                }
            });
        }
    }

    /// Step, calibration, cross axis and position of one channel.
    fn add_channel(&mut self, measured: &FitData, motion: &Motion, channel: usize) {
        let (signal, known) = (&measured.signals[channel], &measured.tolerances);
        let name = |what: &str| format!("{what} of {}", signal.name);
        let is_stood_in = measured.stood_in.is_some_and(|s| s.channel == channel);
        let u_m_s =
            if is_stood_in { measured.flight.plateaus[channel].u_m_s } else { u_step_m_s(measured, channel) };
        let step = move |inputs: &mut Inputs, by: f64| inputs.step(channel, by * u_m_s);
        self.add(name("velocity step"), format!("{u_m_s:.3} m/s"), None, step);
        if let Some(landing) = &measured.flight.landing {
            let add_m_s = landing.u_m_s[channel];
            self.add(name("step by the touch"), format!("{add_m_s:.3} m/s"), None, move |inputs, by| {
                let steps_m_s = inputs.flight.landing.as_mut().map(|landing| &mut landing.steps_m_s);
                if let Some(step_m_s) = steps_m_s.and_then(|steps_m_s| steps_m_s.get_mut(channel)) {
                    *step_m_s += by * add_m_s;
                }
            });
        }
        if is_stood_in {
            // A reconstructed channel has the sensor errors of the channel from which it is made.
            return;
        }
        if measured.spec(channel).is_none_or(|spec| spec.reference.is_none()) {
            let (share, shift) = scale(measured, channel);
            self.add(
                name("calibration"),
                percent(share),
                Some(calibration(&signal.name, share, REST)),
                shift,
            );
        }
        let (share, add_m_s) = (known.base_strain / 2.0, u_base_strain_m_s(signal, measured.events, known));
        let (tolerance, key) = ("base_strain_percent", "tolerance.base_strain_percent");
        let strain = entry(tolerance, key, "1 %", 0.01 / share, SECOND_SENSOR);
        let step = move |inputs: &mut Inputs, by: f64| inputs.step(channel, by * add_m_s);
        self.add(format!("{BASE_STRAIN}{}", signal.name), percent(share), Some(strain), step);
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
        let cross = entry("cross_axis_percent", "axis", "1°", DEGREE / share, "check how the sensor sits");
        self.add(name("cross axis"), percent(share), Some(cross.tag(&signal.name)), move |inputs, by| {
            inputs.step(channel, -by * share * other_m_s);
            inputs.crosses[channel] += by * share;
        });
        let by_m = known.position_m / 2.0;
        let place = |key, number_m| {
            let place = entry("position_m", key, "10 mm", 0.01 / by_m, SECOND_SENSOR);
            Some(place.with_number(number_m, by_m).tag(&signal.name))
        };
        if is_transverse {
            let place = place("position_m", signal.position_m);
            self.add(name("position"), mm(by_m), place, move |inputs, by| {
                // A sensor farther from L by δ reads Ω δ = −ω δ more.
                inputs.step(channel, by * omega * by_m);
                inputs.places_m[channel] += by * by_m;
            });
        } else {
            let offset = place("offset_m", signal.offset_m);
            self.add(name("offset"), mm(by_m), offset, move |inputs, by| {
                // A sensor farther from the axis by δ reads −Ω δ more   (15)
                inputs.step(channel, -by * omega * by_m);
            });
        }
    }
}

/// Standard uncertainty of a channel's scale, and its effect.
fn scale(measured: &FitData, channel: usize) -> (f64, Shift) {
    let own = measured.spec(channel).and_then(|spec| spec.calibration);
    let share = own.unwrap_or(measured.tolerances.calibration) / 2.0;
    let share = share.hypot(measured.signals[channel].u_around);
    let step_m_s = measured.flight.plateaus[channel].velocity_step_m_s;
    let shift = move |inputs: &mut Inputs, by: f64| {
        inputs.step(channel, by * share * step_m_s);
        inputs.scales[channel] += by * share;
    };
    (share, Box::new(shift))
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

fn mm(length_m: f64) -> String {
    format!("{:.0} mm", 1e3 * length_m)
}

/// Velocity of S along the body axes, m/s: transverse, axial.
fn body_m_s(state: &MotionState) -> (f64, f64) {
    let (sin, cos) = state.angle_rad.sin_cos();
    let (along_m_s, up_m_s) = (state.horizontal_velocity_m_s, state.vertical_velocity_m_s);
    (up_m_s * cos - along_m_s * sin, along_m_s * cos + up_m_s * sin)
}
