//! What the free-flight window gave: a plateau per channel, and the modes that ring on it.

use serde::Serialize;

/// One damped bending mode in the flight window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mode {
    /// Damped frequency, Hz.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Largest velocity amplitude over the channels at the window's start, m/s.
    pub amplitude_m_s: f64,
}

/// The velocity step of one channel from before the impact to the flight, free of ringing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plateau {
    /// The channel's name.
    pub channel: String,
    /// Integral of specific force from before first contact to the reference time, ringing and drift removed, m/s.
    pub velocity_step_m_s: f64,
    /// Standard uncertainty of it, m/s.
    pub u_m_s: f64,
    /// Change of the channel's offset from before the impact to the flight, m/s²; 0 where none was called for.
    pub zero_shift_m_s2: f64,
    /// Standard uncertainty of it, m/s².
    pub u_zero_shift_m_s2: f64,
    /// RMS of what the fit leaves, m/s.
    pub residual_m_s: f64,
    /// Cosine and sine amplitude of each mode at the window's start, m/s.
    pub ringing_m_s: Vec<(f64, f64)>,
    /// Mean velocity just before the flight ends less what the fit says of it, m/s, where the flight is long enough to tell.
    pub late_mismatch_m_s: Option<f64>,
}

/// How one candidate of the flight fit scored.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FlightModelScore {
    /// Number of modes.
    pub modes: usize,
    /// Whether each channel has a drift (zero shift).
    pub drift: bool,
    /// Whether the contact force gives the modes their phases; else they are free.
    pub driven: bool,
    /// Whether it is the fit taken: the one of the lowest criterion, or where the motion speaks against that one the next.
    pub taken: bool,
    /// Bayesian information criterion; lower is better.
    pub bic: f64,
    /// RMS of what the fit leaves over all channels, m/s.
    pub residual_m_s: f64,
}

/// The fit of the free-flight window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlightFit {
    /// Start of the window, s from the recording's first sample.
    pub from_s: f64,
    /// End of the window, s.
    pub to_s: f64,
    /// One plateau a channel, transverse channels first.
    pub plateaus: Vec<Plateau>,
    /// The modes taken, lowest frequency first.
    pub modes: Vec<Mode>,
    /// Whether a drift was taken.
    pub drift: bool,
    /// Every candidate that was tried, the one taken among them.
    pub candidates: Vec<FlightModelScore>,
}

impl FlightFit {
    /// The plateau of a channel.
    #[must_use]
    pub fn plateau(&self, channel: &str) -> Option<&Plateau> {
        self.plateaus.iter().find(|p| p.channel == channel)
    }
}
