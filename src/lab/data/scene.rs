//! A scene for `synth`: the cask, its drop and impacts, its ringing, and the measuring chain.

use crate::data::{Axis, Cask, Contact, Drop, End};
use serde::Serialize;

/// A corner that crushes: bilinear force over depth, whose two stiffnesses give k < 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct CrushableEnd {
    /// Loading stiffness, N/m.
    pub loading_n_m: f64,
    /// Unloading stiffness, N/m; not below the loading stiffness.
    pub unloading_n_m: f64,
    /// Force at which the end yields, N: the force stays constant during further crush.
    pub yield_n: Option<f64>,
    /// Lock-up: beyond the first, m, of crush the force grows by the second, N/m, on top of that.
    pub lock_up: Option<(f64, f64)>,
    /// Inward movement of the force along the target as the end flattens, m/m of crush.
    pub footprint: f64,
}

/// A loose mass in the cask, which flies across it from pad to pad: two of them are a body that rattles at
/// both its ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LooseMass {
    /// Mass in addition to the cask's, kg.
    pub mass_kg: f64,
    /// Along the axis from the first end, m.
    pub position_m: f64,
    /// Way to the lower pad at first contact, m.
    pub gap_m: f64,
    /// Way from pad to pad, m.
    pub play_m: f64,
    /// Duration of an impact on a pad that absorbs no energy, s.
    pub pulse_s: f64,
    /// λ of the pads' force K c (1 + λ ċ) over their crush c, s/m.
    pub damping_s_m: f64,
}

/// Features that most drops lack.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SceneExtras {
    /// Loose contents.
    pub contents: Vec<LooseMass>,
    /// Friction of L that falls with the sliding speed: towards the first number, within the second, m/s.
    pub falling_friction: Option<(f64, f64)>,
    /// Friction of L from its greatest crush on.
    pub returning_friction: Option<f64>,
    /// Share of gravity that rails, ropes or a brake remove in the fall.
    pub guided: f64,
    /// Roll that a tilted edge leaves, built up with the force of the first contact, rad/s.
    pub roll_rad_s: f64,
    /// Angular-rate sensors; their channels follow the others.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rates: Vec<RateSensor>,
}

/// An angular-rate sensor and its chain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RateSensor {
    /// Name.
    pub name: String,
    /// Along the axis from the first end, m.
    pub position_m: f64,
    /// Unit in the recording, "rad/s" or "deg/s".
    pub unit: String,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// True scale over stated scale.
    pub scale: f64,
    /// Constant offset, rad/s.
    pub offset_rad_s: f64,
    /// Standard deviation of the white noise, rad/s.
    pub white_noise_rad_s: f64,
}

/// A bending mode of the free uniform beam.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BendingMode {
    /// 1, 2 or 3: which shape.
    pub order: u8,
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// Share of critical damping.
    pub damping: f64,
    /// Strength with which the contact force drives the mode; 1 is the uniform beam.
    pub strength: f64,
}

/// A body that is a free elastic beam of the cask's length and section, whose modes move the corners that
/// strike.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ElasticBody {
    /// Natural frequency of the first bending mode, Hz; the others follow from the slenderness.
    pub first_bending_hz: f64,
    /// Share of critical damping of each mode.
    pub damping: f64,
}

/// Errors that a sensor and its chain add to the specific force at its place.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Chain {
    /// Inclination of the sensitive axis towards the other body axis, rad.
    pub tilt_rad: f64,
    /// Share of the cross axis in the reading.
    pub cross_axis: f64,
    /// Resonance of the mounted sensor: frequency, Hz, and share of critical damping.
    pub resonance: Option<(f64, f64)>,
    /// AC coupling: time constant, s.
    pub ac_time_constant_s: Option<f64>,
    /// Fourth-order Butterworth before the sampling: cut-off, Hz.
    pub anti_alias_hz: Option<f64>,
    /// True scale over stated scale.
    pub scale: f64,
    /// Constant offset, m/s².
    pub offset_m_s2: f64,
    /// Offset that grows over the first contact and stays, m/s².
    pub zero_shift_m_s2: f64,
    /// Standard deviation of the white noise, m/s².
    pub white_noise_m_s2: f64,
    /// Standard deviation of the 1/f noise from 1 Hz to half the sample rate, m/s².
    pub pink_noise_m_s2: f64,
    /// Mains hum: amplitude, m/s², and frequency, Hz.
    pub hum: Option<(f64, f64)>,
    /// Bursts of a shaken cable during each contact: amplitude, m/s².
    pub cable_noise_m_s2: f64,
    /// Wave of a whipping cable from first contact on, which fades: amplitude, m/s², and frequency, Hz.
    pub whip: Option<(f64, f64)>,
    /// The converter cuts off beyond ± this, m/s².
    pub full_scale_m_s2: Option<f64>,
    /// Bits of the converter over ± full scale.
    pub bits: Option<u8>,
    /// Spans after the first sample in which the channel repeats its last value, s.
    pub dropouts_s: Vec<(f64, f64)>,
    /// Spans after the first sample that the recorder lost, s.
    pub gaps_s: Vec<(f64, f64)>,
    /// Delay of this channel's stamps behind those of the others, s.
    pub skew_s: f64,
    /// True if the polarity in the cask file is wrong.
    pub swapped_polarity: bool,
}

impl Chain {
    /// A chain that alters nothing.
    pub fn perfect() -> Self {
        Self { scale: 1.0, ..Self::default() }
    }
}

/// A channel of the scene: its position, its format, and its chain.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SceneChannel {
    /// Name.
    pub name: String,
    /// The end in the cask file; `swapped_ends` of the scene exchanges the recordings.
    pub end: End,
    /// Body axis.
    pub axis: Axis,
    /// True position along the axis from the first end, m.
    pub position_m: f64,
    /// True position across the axis, m.
    pub offset_m: f64,
    /// True place off the plane of the drop, m.
    pub lateral_m: f64,
    /// Unit in the recording, "g" or "m/s^2".
    pub unit: String,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// The chain.
    pub chain: Chain,
}

impl SceneChannel {
    /// A transverse channel in g at 20 kHz whose chain alters nothing.
    pub fn perfect(name: &str, end: End, position_m: f64) -> Self {
        Self {
            name: name.to_owned(),
            end,
            position_m,
            unit: "g".to_owned(),
            sample_rate_hz: 2e4,
            chain: Chain::perfect(),
            ..Self::default()
        }
    }
}

/// A scene, checked, with its defaults filled in.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Scene {
    /// Name, for the files and the cask file.
    pub name: String,
    /// Seed of everything random.
    pub seed: u64,
    /// The cask.
    pub cask: Cask,
    /// The drop.
    pub drop: Drop,
    /// The contact of L.
    pub contact: Contact,
    /// L.
    pub first_end: CrushableEnd,
    /// R.
    pub second_end: CrushableEnd,
    /// Bending modes that ride on the rigid motion.
    pub modes: Vec<BendingMode>,
    /// The body if it is elastic: then there are no other modes.
    pub elastic: Option<ElasticBody>,
    /// Record before first contact, s.
    pub before_s: f64,
    /// Record after the slap-down, s.
    pub after_s: f64,
    /// True if the record shows the cask hanging at rest before its release, as far as `before_s` reaches.
    pub rest: bool,
    /// The recorder's clock: true rate over stated rate, minus one.
    pub clock_error: f64,
    /// True if the recordings of the ends are exchanged.
    pub swapped_ends: bool,
    /// The channels.
    pub channels: Vec<SceneChannel>,
    /// Features that most drops lack.
    pub extras: SceneExtras,
}

/// The drop if guides remove `share` of g from its fall: √(2 g h) becomes √(2 (1 − q) g h).
pub fn slow_down(free: Drop, share: f64) -> Drop {
    let of_fall_m_s = (2.0 * free.gravity_m_s2 * free.height_m).sqrt();
    let lost_m_s = of_fall_m_s * (1.0 - (1.0 - share).sqrt());
    Drop { impact_velocity_m_s: free.impact_velocity_m_s - lost_m_s, ..free }
}

impl Scene {
    /// Time from the release to first contact, s: √(2 h/(g (1 − q))), with q the share of g that guides
    /// remove.
    pub fn fall_s(&self) -> f64 {
        (2.0 * self.drop.height_m / (self.drop.gravity_m_s2 * (1.0 - self.extras.guided))).sqrt()
    }
}

/// The simulated motion.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedMotion {
    /// Steps at the integrator's times, ascending; a time occurs twice if a contact changes and acceleration
    /// may step.
    pub steps: Vec<MotionStep>,
    /// The bending modes at each of these times, grouped by time.
    pub modes: Vec<ModeStep>,
    /// Results of a perfect measurement.
    pub truth: Truth,
}

impl SimulatedMotion {
    /// Counts the steps for which `is_before` holds, all of which lie at the beginning.
    pub fn count_before(&self, is_before: impl Fn(f64) -> bool) -> usize {
        self.steps.partition_point(|step| is_before(step.time_s))
    }

    /// Tangential and normal impulse of the first contact, N s.
    pub fn first_impulse_n_s(&self) -> (f64, f64) {
        let end_s = self.truth.contact_s.unwrap_or(f64::INFINITY);
        let steps = self.steps[..self.count_before(|t| t <= end_s)].windows(2);
        steps.fold((0.0, 0.0), |(along, up), steps| {
            let half_s = (steps[1].time_s - steps[0].time_s) / 2.0;
            let [before, after] = [0, 1].map(|i| steps[i].loads_n[0]);
            (along + half_s * (before.0 + after.0), up + half_s * (before.1 + after.1))
        })
    }
}

/// The simulated motion at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionStep {
    /// Since first contact, s.
    pub time_s: f64,
    /// State: 0 to 2 are x and z of S, m, and the inclination, rad; 3 to 5 are their rates.
    pub state: [f64; 6],
    /// Rates of the state.
    pub rates: [f64; 6],
    /// Forces on the corners of L and R, N: tangential, normal.
    pub loads_n: [(f64, f64); 2],
    /// Heights of these corners above the target, m.
    pub heights_m: [f64; 2],
}

/// A bending mode at one time, before its strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeStep {
    /// Coordinate of the mode, m.
    pub q_m: f64,
    /// Rate of the coordinate, m/s.
    pub rate_m_s: f64,
    /// Second derivative of the coordinate, m/s².
    pub rate_m_s2: f64,
}

/// Results of a perfect measurement for the impact of one end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ImpactTruth {
    /// Duration of the contact, s; `None` if the end does not leave.
    pub contact_s: Option<f64>,
    /// Greatest crush of the end: depth of its corner below the target, including bending, m.
    pub crush_m: f64,
    /// Greatest normal force, unfiltered, N.
    pub force_n: f64,
    /// Energy that the rigid motion loses in the contact, kinetic and potential, J; if the end does not leave
    /// the target, up to the greatest crush.
    pub energy_j: f64,
}

/// Results of a perfect measurement. Times count from first contact.
///
/// k, velocities, ω and angles belong to the rigid motion: that of S by its momentum and of the axis by its
/// angular momentum, without bending. Times belong to the contacts that the corners make. A bending corner
/// chatters: it leaves and returns before the rigid motion has ended its contact. A pause that is shorter
/// than the contact so far and than a period of the first bending mode therefore belongs to the contact,
/// unless R strikes in it; a longer one is a flight.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Truth {
    /// Speed at first contact, m/s.
    pub v0: f64,
    /// Inclination at first contact, degrees.
    pub angle_deg: f64,
    /// −ż_L after over ż_L before; `None` where L never leaves.
    pub k: Option<f64>,
    /// Vertical velocity of L when it leaves, m/s.
    pub rebound_velocity: Option<f64>,
    /// Length of the first contact, s.
    pub contact_s: Option<f64>,
    /// ω as L leaves, rad/s.
    pub omega_rebound: Option<f64>,
    /// Inclination as L leaves, degrees.
    pub angle_sep_deg: Option<f64>,
    /// Horizontal velocity of L's corner as it leaves, m/s.
    pub vx_corner_after: Option<f64>,
    /// Slap-down, s.
    pub slap_t: Option<f64>,
    /// Time from separation to slap-down, s.
    pub flight_s: Option<f64>,
    /// Horizontal and vertical velocity of R just before it strikes, m/s.
    pub vx: Option<f64>,
    /// See `vx`.
    pub vz: Option<f64>,
    /// Magnitude of R's velocity, m/s.
    pub speed: Option<f64>,
    /// Speed of the corner that strikes, including bending.
    pub local_speed: Option<f64>,
    /// ω just before slap-down, rad/s.
    pub omega: Option<f64>,
    /// Inclination at slap-down, degrees.
    pub angle_hit_deg: Option<f64>,
    /// Kinetic energy before slap-down over that before first impact.
    pub energy_ratio: Option<f64>,
    /// Times that L touched again before R struck.
    pub relands: u32,
    /// True if L was on the target when R struck.
    pub first_down_at_slap: bool,
    /// The impacts of L and R, where they strike.
    pub impacts: [Option<ImpactTruth>; 2],
}
