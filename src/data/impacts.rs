//! Both impacts as test reports tabulate them.

use super::cask::End;
use super::estimate::Estimate;
use serde::Serialize;

/// One impact; what the recording does not give is `None`, and a finding says why.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ImpactTable {
    /// The end that strikes.
    pub end: End,
    /// When it touches, s from the recording's first sample.
    pub start: Option<Estimate>,
    /// Until it leaves, s.
    pub duration: Option<Estimate>,
    /// Vertical velocity that its corner gains, m/s.
    pub velocity_change: Option<Estimate>,
    /// Impulse of the target along itself, positive towards R, N s: the stated mass times the change of velocity of S.
    pub impulse_x: Option<Estimate>,
    /// Impulse of the target upwards, N s.
    pub impulse_z: Option<Estimate>,
    /// Vertical velocity of the corner as it leaves over that with which it struck.
    pub restitution: Option<Estimate>,
    /// `impulse_x` over `impulse_z`.
    pub friction: Option<Estimate>,
    /// Kinetic energy of the rigid body before, J.
    pub energy_before: Option<Estimate>,
    /// What the contact takes, J: kinetic energy before less that after, and what S comes down.
    pub energy_absorbed: Option<Estimate>,
    /// Kinetic energy after, J.
    pub energy_after: Option<Estimate>,
    /// `energy_before` over that of the first impact   (13)
    pub energy_ratio: Option<Estimate>,
    /// `energy_absorbed` over `energy_before` of the first impact.
    pub absorbed_ratio: Option<Estimate>,
    /// How far the corner of the undeformed cask goes below where it touched, m.
    pub crush: Option<Estimate>,
    /// Largest vertical force, N, low-passed as the decelerations: the stated mass times that of S.
    pub force_peak: Option<Estimate>,
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
}

impl ImpactTable {
    /// Nothing known of it yet.
    #[must_use]
    pub fn unknown(end: End) -> Self {
        Self { end, ..Self::default() }
    }
}
