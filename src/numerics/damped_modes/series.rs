//! Noisy series, the modes that ring on them, and the results of a fit.

use crate::numerics::as_f64;

/// One series y(t) to explain.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Times from the window's start, s, increasing.
    pub time_s: Vec<f64>,
    /// Values at those times.
    pub value: Vec<f64>,
    /// Times at which the series may jump by an unknown amount (samples were lost there), s.
    pub steps_s: Vec<f64>,
    /// RMS of the noise in such a series.
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

/// Fitted values of one series at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesFit {
    /// p.
    pub plateau: f64,
    /// Standard uncertainty of the plateau.
    pub u_plateau: f64,
    /// d, per second.
    pub drift: f64,
    /// Standard uncertainty of the drift.
    pub u_drift: f64,
    /// A and B of each mode.
    pub amplitudes: Vec<(f64, f64)>,
    /// RMS of the residual.
    pub residual: f64,
    /// RMS of the residual's means over a 24th of the series, which hardly contain faster oscillations.
    pub slow_residual: f64,
    /// Jumps at `steps_s`.
    pub jumps: Vec<f64>,
}

/// y(t) = p + d t + Σ_m e^(−ζ ω t) (A cos ω t + B sin ω t) + jumps   (20), modes common to all series.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The modes, in the order found.
    pub modes: Vec<Oscillation>,
    /// True if a drift was fitted.
    pub drift: bool,
    /// True if the force determines the phases of the modes.
    pub driven: bool,
    /// Fitted values of each series.
    pub series: Vec<SeriesFit>,
    /// Factor by which serial correlation reduces the number of independent residuals.
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
