//! What the motion must meet beside the velocity steps, and by how much given inputs miss it.

use super::FitData;
use super::inputs::Inputs;
use crate::data::{Axis, ClosureKind, Motion, RestLevel, RotationRate, U_RELEASE_S};

/// Height of R's corner above the target as it strikes: corner and target are even to some millimetres, m.
const U_HEIGHT_M: f64 = 0.003;
/// Height of L's corner as it touches again, as a share of the length: 5 mm of 5 m, where 37 simulated drops
/// miss it by 1 to 3 mm.
const U_TOUCH_SHARE: f64 = 0.001;
/// Angular impulse against Θ ω, as a share of ω: so far apart are both on simulated drops whose pulse is
/// finite and rings.
const U_TURNING: f64 = 0.005;

/// An observable with its standard uncertainty.
#[derive(Debug, Clone)]
pub(super) enum Observable {
    /// R's corner is on the target when it strikes.
    Height,
    /// L's corner is on the target when it touches again.
    Touch,
    /// The angular impulse about S is Θ ω.
    Turning { u_rad_s: f64 },
    /// The angular impulse of the second impact about S is Θ times what it changes ω by.
    SecondTurning { u_rad_s: f64 },
    /// A channel at rest reads g cos φ.
    Rest { channel: usize, name: String, is_axial: bool, rest_m_s2: f64, u_m_s2: f64 },
    /// The fall lasts v0 / g.
    Fall { fall_s: f64 },
    /// The cask turns before the first contact as an angular-rate sensor says, or gains as much by it.
    Rate { sensor: usize, name: String, is_before: bool, rate: RotationRate },
}

impl Observable {
    pub fn kind(&self) -> ClosureKind {
        match self {
            Self::Height => ClosureKind::Height,
            Self::Touch => ClosureKind::Touch,
            Self::Turning { .. } => ClosureKind::Turning,
            Self::SecondTurning { .. } => ClosureKind::SecondTurning,
            Self::Rest { .. } => ClosureKind::Rest,
            Self::Fall { .. } => ClosureKind::Fall,
            Self::Rate { is_before: true, .. } => ClosureKind::RateBefore,
            Self::Rate { .. } => ClosureKind::RateGained,
        }
    }

    pub fn channel(&self) -> Option<&str> {
        match self {
            Self::Rest { name, .. } | Self::Rate { name, .. } => Some(name),
            _ => None,
        }
    }

    /// As a person says it.
    pub fn name(&self) -> String {
        match self {
            Self::Height => "height of the second end at slap-down".into(),
            Self::Touch => "height of the first end as it touches again".into(),
            Self::Turning { .. } => "rotation against the impulse of the first impact".into(),
            Self::SecondTurning { .. } => "rotation against the impulse of the second impact".into(),
            Self::Rest { name, .. } => format!("rest level of {name}"),
            Self::Fall { .. } => "time of the free fall".into(),
            Self::Rate { name, is_before: true, .. } => format!("rotation before the contact by {name}"),
            Self::Rate { name, .. } => format!("rotation by the first impact by {name}"),
        }
    }

    /// By how much the motion misses it, in the unit of [`Self::u`]; `None` where the motion does not show
    /// it.
    fn miss(&self, measured: &FitData, inputs: &Inputs, motion: &Motion) -> Option<f64> {
        let setup = &inputs.setup;
        let g = setup.gravity_m_s2;
        match self {
            // z_R = 0   (33)
            Self::Height => motion.second_end_height_m,
            Self::Touch => motion.touch_height_m,
            // Δω − ∫(a f_z − b f_x) dt m / Θ = 0   (32)
            Self::Turning { .. } => Some(
                motion.separation.angular_velocity_rad_s
                    - motion.contact.angular_velocity_rad_s
                    - motion.angular_impulse_m2_s / inputs.inertia_m2?,
            ),
            Self::SecondTurning { .. } => (measured.second?.turned_beyond_rad_s)(inputs, motion),
            // (1 + e) f_rest − χ g sin φ' = g cos φ' across the axis, the other way round along it; φ' before
            // the fall   (34)
            Self::Rest { channel, is_axial, rest_m_s2, .. } => {
                let fall_s = -motion.contact.vertical_velocity_m_s / g;
                let (sin, cos) = (setup.angle_rad + setup.angular_velocity_rad_s * fall_s).sin_cos();
                let (own, other) = if *is_axial { (sin, cos) } else { (cos, sin) };
                let (scale, cross) = (inputs.scales.get(*channel)?, inputs.crosses.get(*channel)?);
                Some((1.0 + scale) * rest_m_s2 - cross * g * other - g * own)
            }
            // g t = −ż_S   (35)
            Self::Fall { fall_s } => Some(g * fall_s * setup.second_s + motion.contact.vertical_velocity_m_s),
            // (1 + e) f = ω0 in the fall, and ω2 − ω0 beyond it in the flight   (45)
            Self::Rate { sensor, is_before, rate, .. } => {
                let [before, after] = [&motion.contact, &motion.separation].map(|s| s.angular_velocity_rad_s);
                let turns_rad_s = if *is_before { before } else { after - before };
                Some((1.0 + inputs.rate_scales.get(*sensor)?) * rate.rad_s - turns_rad_s)
            }
        }
    }

    /// Its own standard uncertainty.
    fn u(&self, measured: &FitData) -> f64 {
        match self {
            Self::Height => U_HEIGHT_M,
            Self::Touch => U_TOUCH_SHARE * measured.setup.length_m,
            Self::Turning { u_rad_s } | Self::SecondTurning { u_rad_s } => *u_rad_s,
            Self::Rest { u_m_s2, .. } => *u_m_s2,
            Self::Fall { .. } => measured.setup.gravity_m_s2 * U_RELEASE_S,
            Self::Rate { rate, .. } => rate.u_rad_s,
        }
    }

    /// The miss over its own standard uncertainty.
    pub fn residual(&self, measured: &FitData, inputs: &Inputs, motion: &Motion) -> Option<f64> {
        self.miss(measured, inputs, motion).map(|miss| miss / self.u(measured))
    }

    /// A miss of `residual` own standard uncertainties as a person reads it.
    pub fn words(&self, measured: &FitData, motion: &Motion, residual: f64) -> String {
        let miss = residual * self.u(measured);
        match self {
            Self::Height | Self::Touch => format!("{:+.0} mm", 1e3 * miss),
            Self::Turning { .. } => {
                format!("{:+.1} % of ω", 100.0 * miss / motion.separation.angular_velocity_rad_s.abs())
            }
            Self::SecondTurning { .. } => {
                let turned_rad_s = measured.second.and_then(|second| second.turned_rad_s).unwrap_or(f64::NAN);
                format!("{:+.1} %", 100.0 * miss / turned_rad_s.abs())
            }
            Self::Rest { is_axial, rest_m_s2, .. } => {
                let function = if *is_axial { "sin" } else { "cos" };
                format!("{:+.1} % of g {function} φ", 100.0 * miss / (rest_m_s2 - miss))
            }
            Self::Fall { fall_s } => {
                format!("{:+.1} % of v0", 100.0 * miss / (measured.setup.gravity_m_s2 * fall_s - miss))
            }
            Self::Rate { .. } => format!("{:+.2}°/s", miss.to_degrees()),
        }
    }
}

/// The observables that this recording has.
pub(super) fn observables(measured: &FitData, motion: &Motion) -> Vec<Observable> {
    let mut all = Vec::new();
    if motion.second_end_height_m.is_some() {
        all.push(Observable::Height);
    }
    all.extend(motion.touch_height_m.map(|_| Observable::Touch));
    let u_rad_s = U_TURNING * motion.separation.angular_velocity_rad_s.abs();
    if u_rad_s > 0.0 && measured.inertia_m2.is_some() {
        all.push(Observable::Turning { u_rad_s });
    }
    let turned_rad_s = measured.second.and_then(|second| second.turned_rad_s);
    if let Some(turned_rad_s) = turned_rad_s.filter(|_| measured.inertia_m2.is_some()) {
        all.push(Observable::SecondTurning { u_rad_s: U_TURNING * turned_rad_s.abs() });
    }
    for rest in measured.rests {
        if let Some(channel) = measured.signals.iter().position(|s| s.name == rest.channel) {
            let (name, is_axial) = (rest.channel.clone(), rest.axis == Axis::Axial);
            let RestLevel { rest_m_s2, u_m_s2, .. } = *rest;
            all.push(Observable::Rest { channel, name, is_axial, rest_m_s2, u_m_s2 });
        }
    }
    if let Some(fall_s) = measured.fall_s {
        all.push(Observable::Fall { fall_s });
    }
    for (sensor, rotation) in measured.rotations.iter().enumerate() {
        let both = [(true, rotation.before), (false, Some(rotation.gained))];
        all.extend(both.into_iter().filter_map(|(is_before, rate)| {
            let name = rotation.channel.clone();
            Some(Observable::Rate { sensor, name, is_before, rate: rate? })
        }));
    }
    all
}
