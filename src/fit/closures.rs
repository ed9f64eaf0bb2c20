//! Consistency checks: observables that the motion must reproduce beside the velocity steps, and their misses
//! for given inputs.

use super::FitData;
use super::inputs::Inputs;
use crate::data::{Axis, CheckKind, Motion, RestLevel, RotationRate, U_RELEASE_S};

/// Standard uncertainty of the height of R's corner above the target when it strikes: corner and target are
/// flat to some millimetres, m.
const U_HEIGHT_M: f64 = 0.003;
/// Standard uncertainty of the height of L's corner when it touches again, as a share of the length: 15 mm of
/// 5 m; three drops of elastic bars miss it by 15 to 22 mm, and 37 of rigid casks by 1 to 3 mm.
const U_TOUCH_SHARE: f64 = 0.003;
/// Standard uncertainty of the angular impulse against Θ ω, as a share of ω: the difference on simulated
/// drops whose pulse is finite and rings.
const U_TURNING: f64 = 0.005;

/// Miss of an observable by the motion of some inputs; `None` if the motion does not show it.
type MissFunction<'a> = Box<dyn Fn(&Inputs, &Motion) -> Option<f64> + Sync + 'a>;

/// An observable with its standard uncertainty.
pub(super) struct Observable<'a> {
    pub kind: CheckKind,
    /// The channel, where it is one channel's.
    pub channel: Option<String>,
    /// Name for a reader.
    pub name: String,
    /// Standard uncertainty of the observable itself, in the unit of the miss.
    u: f64,
    miss: MissFunction<'a>,
    /// A miss as a person reads it.
    words: Box<dyn Fn(f64) -> String + Sync + 'a>,
}

impl<'a> Observable<'a> {
    fn new(
        kind: CheckKind,
        name: impl Into<String>,
        u: f64,
        miss: impl Fn(&Inputs, &Motion) -> Option<f64> + Sync + 'a,
        words: impl Fn(f64) -> String + Sync + 'a,
    ) -> Self {
        Self { kind, channel: None, name: name.into(), u, miss: Box::new(miss), words: Box::new(words) }
    }

    /// The miss over the standard uncertainty of the observable.
    pub fn residual(&self, inputs: &Inputs, motion: &Motion) -> Option<f64> {
        (self.miss)(inputs, motion).map(|miss| miss / self.u)
    }

    /// Describes a miss of `residual` standard uncertainties for a reader.
    pub fn words(&self, residual: f64) -> String {
        (self.words)(residual * self.u)
    }
}

/// The observables that this recording has.
pub(super) fn observables<'a>(measured: &'a FitData<'a>, motion: &Motion) -> Vec<Observable<'a>> {
    let mut all = Vec::new();
    let in_mm = |miss: f64| format!("{:+.0} mm", 1e3 * miss);
    // z_R = 0   (33)
    all.extend(motion.second_end_height_m.map(|_| {
        let name = "height of the second end at slap-down";
        Observable::new(CheckKind::Height, name, U_HEIGHT_M, |_, motion| motion.second_end_height_m, in_mm)
    }));
    all.extend(motion.touch_height_m.map(|_| {
        let name = "height of the first end as it touches again";
        let u_m = U_TOUCH_SHARE * measured.setup.length_m;
        Observable::new(CheckKind::Touch, name, u_m, |_, motion| motion.touch_height_m, in_mm)
    }));
    all.extend(rotation_check(measured, motion));
    all.extend(second_rotation_check(measured));
    all.extend(measured.rests.iter().filter_map(|level| rest_check(measured, level)));
    all.extend(measured.fall_s.map(|fall_s| fall_check(measured, fall_s)));
    for (sensor, rotation) in measured.rotations.iter().enumerate() {
        all.extend(rotation.before.map(|rate| rate_check(sensor, &rotation.channel, rate, true)));
        all.push(rate_check(sensor, &rotation.channel, rotation.gained, false));
    }
    all
}

/// The angular impulse about S is Θ ω.
fn rotation_check<'a>(measured: &FitData, motion: &Motion) -> Option<Observable<'a>> {
    let turning_rad_s = motion.separation.angular_velocity_rad_s.abs();
    let name = "rotation against the impulse of the first impact";
    // Δω − ∫(a f_z − b f_x) dt m / Θ = 0   (32)
    let miss_rad_s =
        |inputs: &Inputs, motion: &Motion| inputs.inertia_m2.map(|m2| motion.excess_rotation_rad_s(m2));
    let words = move |miss: f64| format!("{:+.1} % of ω", 100.0 * miss / turning_rad_s);
    let u_rad_s = U_TURNING * turning_rad_s;
    (u_rad_s > 0.0 && measured.inertia_m2.is_some())
        .then(|| Observable::new(CheckKind::Turning, name, u_rad_s, miss_rad_s, words))
}

/// The angular impulse of the second impact about S is Θ times the change of ω.
fn second_rotation_check<'a>(measured: &FitData<'a>) -> Option<Observable<'a>> {
    let second = measured.second.filter(|_| measured.inertia_m2.is_some())?;
    let turned_rad_s = second.rotation_rad_s?.abs();
    let name = "rotation against the impulse of the second impact";
    let miss = move |inputs: &Inputs, motion: &Motion| (second.excess_rotation_rad_s)(inputs, motion);
    let words = move |miss: f64| format!("{:+.1} %", 100.0 * miss / turned_rad_s);
    Some(Observable::new(CheckKind::SecondTurning, name, U_TURNING * turned_rad_s, miss, words))
}

/// A channel at rest reads g cos φ, an axial one g sin φ.
fn rest_check<'a>(measured: &FitData, level: &RestLevel) -> Option<Observable<'a>> {
    let RestLevel { rest_m_s2, u_m_s2, .. } = *level;
    let channel = measured.signals.iter().position(|s| s.name == level.channel)?;
    let is_axial = level.axis == Axis::Axial;
    // (1 + e) f_rest − χ g sin φ' = g cos φ' across the axis, with sine and cosine exchanged along it; φ' is
    // the angle before the fall   (34)
    let miss = move |inputs: &Inputs, motion: &Motion| {
        let (setup, g) = (&inputs.setup, inputs.setup.gravity_m_s2);
        let fall_s = -motion.contact.vertical_velocity_m_s / g;
        let (sin, cos) = (setup.angle_rad + setup.angular_velocity_rad_s * fall_s).sin_cos();
        let (own, other) = if is_axial { (sin, cos) } else { (cos, sin) };
        let (scale, cross) = (inputs.scales.get(channel)?, inputs.crosses.get(channel)?);
        Some((1.0 + scale) * rest_m_s2 - cross * g * other - g * own)
    };
    let function = if is_axial { "sin" } else { "cos" };
    let words = move |miss: f64| format!("{:+.1} % of g {function} φ", 100.0 * miss / (rest_m_s2 - miss));
    let name = format!("rest level of {}", level.channel);
    let observable = Observable::new(CheckKind::Rest, name, u_m_s2, miss, words);
    Some(Observable { channel: Some(level.channel.clone()), ..observable })
}

/// The fall lasts v0 / g.
fn fall_check<'a>(measured: &FitData, fall_s: f64) -> Observable<'a> {
    let g = measured.setup.gravity_m_s2;
    // g t = −ż_S   (35)
    let miss = move |inputs: &Inputs, motion: &Motion| {
        let setup = &inputs.setup;
        Some(setup.gravity_m_s2 * fall_s * setup.second_s + motion.contact.vertical_velocity_m_s)
    };
    let words = move |miss: f64| format!("{:+.1} % of v0", 100.0 * miss / (g * fall_s - miss));
    Observable::new(CheckKind::Fall, "time of the free fall", g * U_RELEASE_S, miss, words)
}

/// An angular-rate sensor determines the rotation of the cask before the first contact, or the rotation that
/// the contact adds.
fn rate_check<'a>(sensor: usize, channel: &str, rate: RotationRate, is_before: bool) -> Observable<'a> {
    // (1 + e) f = ω0 in the fall, and ω2 − ω0 more in the flight   (45)
    let miss = move |inputs: &Inputs, motion: &Motion| {
        let [before, after] = [&motion.contact, &motion.separation].map(|s| s.angular_velocity_rad_s);
        let turns_rad_s = if is_before { before } else { after - before };
        Some((1.0 + inputs.rate_scales.get(sensor)?) * rate.rad_s - turns_rad_s)
    };
    let (kind, name) = if is_before {
        (CheckKind::RateBefore, format!("rotation before the contact by {channel}"))
    } else {
        (CheckKind::RateGained, format!("rotation by the first impact by {channel}"))
    };
    let words = |miss: f64| format!("{:+.2}°/s", miss.to_degrees());
    let observable = Observable::new(kind, name, rate.u_rad_s, miss, words);
    Observable { channel: Some(channel.to_owned()), ..observable }
}
