//! Tables of both impacts as test reports print them.

use super::cask::End;
use super::estimate::Estimate;
use super::quantities::named_numbers;
use super::shocks::ChannelPulse;
use serde::Serialize;

named_numbers! {
    /// Values of one impact.
    #[derive(Default, Serialize)]
    pub struct ImpactNumbers<T = Option<Estimate>> {
        /// Until the end leaves, s.
        duration: "s",
        /// Vertical velocity that its corner gains, m/s.
        velocity_change: "m/s",
        /// Impulse of the target along its surface, positive towards R, N s: the stated mass times the change
        /// of velocity of S.
        impulse_x: "N s",
        /// Impulse of the target upwards, N s.
        impulse_z: "N s",
        /// Ratio of the vertical velocities of the corner, leaving over striking.
        restitution: "1",
        /// `impulse_x` over `impulse_z`.
        friction: "1",
        /// Kinetic energy of the rigid body before the impact, J.
        energy_before: "J",
        /// Energy absorbed by the contact, J: kinetic energy before less that after, plus the work of gravity
        /// on S; without a flight after it, the work of the vertical force up to the greatest crush.
        energy_absorbed: "J",
        /// Kinetic energy after, J.
        energy_after: "J",
        /// `energy_before` relative to the first impact   (13)
        energy_ratio: "1",
        /// `energy_absorbed` relative to `energy_before` of the first impact.
        absorbed_ratio: "1",
        /// Greatest depth of the undeformed cask's corner below the point of first touch, m.
        crush: "m",
        /// Largest vertical force, N, filtered like the decelerations: the stated mass times the acceleration
        /// of S.
        force_peak: "N",
        /// Largest deceleration of the rigid body at S, m/s²; `rigid_body_deceleration` states its low-pass
        /// too.
        #[serde(skip)]
        at_cog: "m/s^2",
        /// Largest deceleration at the end that strikes, m/s², likewise.
        #[serde(skip)]
        at_struck_end: "m/s^2",
    }
    may_be_missing {}
}

impl<T> ImpactNumbers<T> {
    /// Values that depend on the course of the force, not only on its impulse.
    pub fn course_numbers(&mut self) -> [&mut T; 4] {
        [&mut self.crush, &mut self.force_peak, &mut self.at_cog, &mut self.at_struck_end]
    }
}

/// One impact; a value that the recording does not determine is `None`, and a finding says why.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ImpactTable {
    /// The end that strikes.
    pub end: End,
    /// Time of the first touch, s from the recording's first sample.
    pub start: Option<Estimate>,
    /// Values of the impact.
    #[serde(flatten)]
    pub numbers: ImpactNumbers,
    /// Largest decelerations of the rigid body.
    pub rigid_body_deceleration: RigidBodyDeceleration,
    /// Vertical force over crush during the contact, with the same low-pass.
    pub force_over_crush: ForceOverCrush,
    /// Readings of the channels.
    pub channels: Vec<ChannelPeak>,
}

/// Largest reading, through a low-pass, of a transverse sensor on the axis of a rigid cask.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RigidBodyDeceleration {
    /// Name of the low-pass.
    pub filter: String,
    /// −3 dB frequency of the low-pass, Hz.
    pub cutoff_hz: f64,
    /// Value at S, m/s².
    pub at_cog: Option<Estimate>,
    /// Value at the end that strikes, m/s².
    pub at_struck_end: Option<Estimate>,
    /// `at_cog` without a low-pass, m/s².
    #[serde(skip)]
    pub at_cog_unfiltered: Option<f64>,
    /// Values with other low-pass filters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<RigidBodyDeceleration>,
}

/// A curve of force over crush; both vectors have one length, in the order of time.
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
    /// Name of the low-pass, which is the same in every drop of a cask unless the cask file states one.
    pub filter: String,
    /// −3 dB frequency of the low-pass, Hz.
    pub cutoff_hz: f64,
    /// Largest value of either sign, unfiltered, m/s².
    pub peak_raw: Option<Estimate>,
    /// Peak after the low-pass, m/s².
    pub peak_filtered: Option<Estimate>,
    /// True if the low-pass overshoots.
    pub is_above_raw: bool,
    /// Time of the filtered peak, s.
    pub time: Option<Estimate>,
    /// Time for which the filtered reading stays above a tenth of its peak, s.
    pub pulse_length: Option<Estimate>,
    /// Pulse from which these values are taken.
    #[serde(skip)]
    pub pulse: Option<ChannelPulse>,
}

impl ImpactTable {
    /// A table in which nothing is determined yet.
    pub fn empty(end: End) -> Self {
        Self { end, ..Self::default() }
    }
}

/// Delay of a channel's first response to the first impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Onset {
    /// The channel's name.
    pub channel: String,
    /// Delay of its response against first contact on the first end, s: 0 for a rigid body and one clock,
    /// negative if stamped early.
    pub delay_s: f64,
    /// Standard uncertainty of the delay, s.
    pub u_s: f64,
}
