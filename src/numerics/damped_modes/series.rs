//! Noisy series, the modes that ring on them, and what a fit says of both.

use crate::numerics::as_f64;

/// One series y(t) to be explained.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Times from the window's start, s, increasing.
    pub time_s: Vec<f64>,
    /// Values at those times.
    pub value: Vec<f64>,
    /// Times at which the series may jump by an unknown amount (samples were lost there), s.
    pub steps_s: Vec<f64>,
    /// RMS that noise alone leaves in such a series.
    pub floor: f64,
}

/// A damped oscillation e^(−ζ ω t) cos(ω t + ψ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Damping ratio ζ.
    pub damping: f64,
}

/// What the fit says of one series; values at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesFit {
    /// p.
    pub plateau: f64,
    /// Its standard uncertainty.
    pub u_plateau: f64,
    /// d, per second.
    pub drift: f64,
    /// Its standard uncertainty.
    pub u_drift: f64,
    /// A and B of each mode.
    pub amplitudes: Vec<(f64, f64)>,
    /// RMS of what is left.
    pub residual: f64,
    /// RMS of its means over a 24th of the series: of what oscillates faster than that next to nothing.
    pub slow_residual: f64,
    /// Jumps at `steps_s`.
    pub jumps: Vec<f64>,
}

/// y(t) = p + d t + Σ_m e^(−ζ ω t) (A cos ω t + B sin ω t) + jumps   (20), modes common to all series.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The modes, in the order found.
    pub modes: Vec<Oscillation>,
    /// Whether a drift was fitted.
    pub drift: bool,
    /// Whether the phases of the modes are those of their drive.
    pub driven: bool,
    /// One a series.
    pub series: Vec<SeriesFit>,
    /// By how much serial correlation shrinks the number of independent residuals.
    pub correlation: f64,
    /// Number of free parameters.
    pub parameters: usize,
}

impl Fit {
    /// BIC = Σ_j (n_j/κ) ln(RMS_j² + floor_j²) + parameters · ln(Σ n_j/κ)   (21), κ the correlation of the
    /// richest candidate.
    pub fn bic(&self, series: &[Series], correlation: f64) -> f64 {
        let mut points = 0.0;
        let mut score = 0.0;
        for (s, f) in series.iter().zip(&self.series) {
            let n = as_f64(s.value.len()) / correlation;
            points += n;
            score += n * (f.residual.powi(2) + s.floor.powi(2)).ln();
        }
        score + as_f64(self.parameters) * points.max(2.0).ln()
    }
}
