//! Both impacts as test reports tabulate them.

use super::cask::End;
use super::estimate::Estimate;
use super::quantities::named_numbers;
use super::shocks::ChannelPulse;
use serde::Serialize;

named_numbers! {
    /// The numbers of one impact.
    #[derive(Default, Serialize)]
    pub struct ImpactNumbers<T = Option<Estimate>> {
        /// Until the end leaves, s.
        duration: "s",
        /// Vertical velocity that its corner gains, m/s.
        velocity_change: "m/s",
        /// Impulse of the target along itself, positive towards R, N s: the stated mass times the change of
        /// velocity of S.
        impulse_x: "N s",
        /// Impulse of the target upwards, N s.
        impulse_z: "N s",
        /// Vertical velocity of the corner as it leaves over that with which it struck.
        restitution: "1",
        /// `impulse_x` over `impulse_z`.
        friction: "1",
        /// Kinetic energy of the rigid body before, J.
        energy_before: "J",
        /// What the contact takes, J: kinetic energy before less that after, and what S comes down; where no
        /// flight follows, the work of the vertical force up to the greatest crush.
        energy_absorbed: "J",
        /// Kinetic energy after, J.
        energy_after: "J",
        /// `energy_before` over that of the first impact   (13)
        energy_ratio: "1",
        /// `energy_absorbed` over `energy_before` of the first impact.
        absorbed_ratio: "1",
        /// How far the corner of the undeformed cask goes below where it touched, m.
        crush: "m",
        /// Largest vertical force, N, low-passed as the decelerations: the stated mass times that of S.
        force_peak: "N",
        /// Largest deceleration of the rigid body at S, m/s²; `rigid_body_deceleration` has it beside its
        /// low-pass.
        #[serde(skip)]
        at_cog: "m/s^2",
        /// Largest deceleration at the end that strikes, m/s², likewise.
        #[serde(skip)]
        at_struck_end: "m/s^2",
    }
    may_be_missing {}
}

impl<T> ImpactNumbers<T> {
    /// The numbers that follow the course of the force, not only what it gives in all.
    pub fn of_course(&mut self) -> [&mut T; 4] {
        [&mut self.crush, &mut self.force_peak, &mut self.at_cog, &mut self.at_struck_end]
    }
}

/// One impact; what the recording does not give is `None`, and a finding says why.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ImpactTable {
    /// The end that strikes.
    pub end: End,
    /// When it touches, s from the recording's first sample.
    pub start: Option<Estimate>,
    /// Its numbers.
    #[serde(flatten)]
    pub numbers: ImpactNumbers,
    /// Largest decelerations of the rigid body.
    pub rigid_body_deceleration: RigidBodyDeceleration,
    /// Vertical force over crush, from touching to leaving, low-passed likewise.
    pub force_over_crush: ForceOverCrush,
    /// What each channel reads.
    pub channels: Vec<ChannelPeak>,
}

/// What a transverse sensor on the axis would read at most, were the cask rigid, through a low-pass.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RigidBodyDeceleration {
    /// The low-pass, by its name.
    pub filter: String,
    /// Its −3 dB frequency, Hz.
    pub cutoff_hz: f64,
    /// At S, m/s².
    pub at_cog: Option<Estimate>,
    /// At the end that strikes, m/s².
    pub at_struck_end: Option<Estimate>,
    /// `at_cog` without a low-pass, m/s².
    #[serde(skip)]
    pub at_cog_unfiltered: Option<f64>,
    /// The same through other low-passes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<RigidBodyDeceleration>,
}

/// A curve of force over crush; both of one length, in the order of time.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ForceOverCrush {
    /// m.
    pub crush_m: Vec<f64>,
    /// N.
    pub force_n: Vec<f64>,
}

/// The pulse of one channel in one impact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelPeak {
    /// The channel.
    pub name: String,
    /// The low-pass, by its name; the same in every drop of a cask unless the cask file states one.
    pub filter: String,
    /// Its −3 dB frequency, Hz.
    pub cutoff_hz: f64,
    /// The largest of either sign, unfiltered, m/s².
    pub peak_raw: Option<Estimate>,
    /// The same through the low-pass, m/s².
    pub peak_filtered: Option<Estimate>,
    /// Whether the low-pass overshoots.
    pub is_above_raw: bool,
    /// When the filtered one is reached, s.
    pub time: Option<Estimate>,
    /// How long the filtered reading stays above a tenth of its peak around it, s.
    pub pulse_length: Option<Estimate>,
    /// What all that is read off.
    #[serde(skip)]
    pub pulse: Option<ChannelPulse>,
}

impl ImpactTable {
    /// Nothing known of it yet.
    pub fn unknown(end: End) -> Self {
        Self { end, ..Self::default() }
    }
}

/// The delay of a channel's first answer to the first impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Onset {
    /// The channel's name.
    pub channel: String,
    /// Its answer less first contact on the first end, s: 0 for a rigid body and one clock, negative if
    /// stamped early.
    pub delay_s: f64,
    /// Standard uncertainty of it, s.
    pub u_s: f64,
}
