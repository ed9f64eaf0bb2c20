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
    /// Mean velocity just before the flight ends less what the fit says of it, m/s, where the flight goes on beyond the window.
    pub late_mismatch_m_s: Option<f64>,
}

/// How one candidate of the flight fit scored.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FlightModelScore {
    /// Number of modes.
    pub modes: usize,
    /// Whether each channel has a drift (zero shift).
    pub drift: bool,
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

/// A mode that would have been this much larger at the time asked for (e^1.6, fivefold) is not followed back to it: the fit knows
/// nothing of it there, and an error of its damping would be blown up likewise.
const MOST_GROWTH: f64 = 1.6;

impl FlightFit {
    /// The plateau of a channel.
    #[must_use]
    pub fn plateau(&self, channel: &str) -> Option<&Plateau> {
        self.plateaus.iter().find(|p| p.channel == channel)
    }

    /// Velocity of a plateau's ringing, m/s, and the specific force of it, m/s², at `time_s` from the recording's first sample.
    ///
    /// v = Σ e^(−ζωτ) (A cos ωτ + B sin ωτ), f = v̇, τ from the window's start   (20)
    #[must_use]
    pub fn ringing(&self, plateau: &Plateau, time_s: f64) -> (f64, f64) {
        let tau = time_s - self.from_s;
        let mut sum = (0.0, 0.0);
        for (mode, &(a, b)) in self.modes.iter().zip(&plateau.ringing_m_s) {
            let omega = std::f64::consts::TAU * mode.frequency_hz;
            let decay = mode.damping * omega;
            if -decay * tau > MOST_GROWTH {
                continue;
            }
            let (sin, cos) = (omega * tau).sin_cos();
            let envelope = (-decay * tau).exp();
            let velocity = envelope * (a * cos + b * sin);
            sum.0 += velocity;
            sum.1 += envelope * omega * (b * cos - a * sin) - decay * velocity;
        }
        sum
    }
}
