//! Noisy series to plateau, drift and damped modes that ring on them, by variable projection.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};
use std::f64::consts::TAU;

/// Damping ratios stay below this: above, a "mode" is a bend of the plateau.
const MAX_DAMPING: f64 = 0.3;

/// A mode damped more than this is none: bolted and welded structures have 0.5 to 8 %, and an oscillation that dies within a
/// period can stand for anything.
const MOST_DAMPING: f64 = 0.15;

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
    /// One a series.
    pub series: Vec<SeriesFit>,
    /// By how much serial correlation shrinks the number of independent residuals.
    pub correlation: f64,
    /// Number of free parameters.
    pub parameters: usize,
}

impl Fit {
    /// BIC = Σ_j (n_j/κ) ln(RMS_j² + floor_j²) + parameters · ln(Σ n_j/κ)   (21), κ the correlation of the richest candidate.
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "a few thousand points")]
    pub fn bic(&self, series: &[Series], correlation: f64) -> f64 {
        let mut points = 0.0;
        let mut score = 0.0;
        for (s, f) in series.iter().zip(&self.series) {
            let n = s.value.len() as f64 / correlation;
            points += n;
            score += n * (f.residual.powi(2) + s.floor.powi(2)).ln();
        }
        score + self.parameters as f64 * points.max(2.0).ln()
    }
}

/// Fits with `start.len() + 1` modes, the new one sought over `band_hz`, or with `start` alone where `band_hz` is `None`.
///
/// `None` where a series has fewer points than unknowns or the fit is singular.
#[must_use]
pub fn fit(
    series: &[Series],
    start: &[Oscillation],
    band_hz: Option<(f64, f64)>,
    drift: bool,
) -> Option<Fit> {
    let mut modes = start.to_vec();
    if let Some(band) = band_hz {
        modes.push(best_seed(series, start, band, drift)?);
    }
    if !modes.is_empty() {
        modes = refine(series, modes, drift)?;
        if let Some((low, high)) = band_hz
            && modes.iter().any(|m| {
                m.damping > MOST_DAMPING || m.frequency_hz < 0.8 * low || m.frequency_hz > 1.25 * high
            })
        {
            return None;
        }
    }
    describe(series, modes, drift)
}

/// Columns of one series' linear problem: 1, t, the jumps, then e^(−ζωt) cos ωt and sin ωt of each mode.
fn columns(series: &Series, modes: &[Oscillation], drift: bool) -> DMatrix<f64> {
    let fixed = 1 + usize::from(drift) + series.steps_s.len();
    let mut matrix = DMatrix::zeros(series.time_s.len(), fixed + 2 * modes.len());
    for (row, &t) in series.time_s.iter().enumerate() {
        matrix[(row, 0)] = 1.0;
        if drift {
            matrix[(row, 1)] = t;
        }
        for (i, &step_s) in series.steps_s.iter().enumerate() {
            matrix[(row, 1 + usize::from(drift) + i)] = f64::from(t > step_s);
        }
        for (i, mode) in modes.iter().enumerate() {
            let omega = TAU * mode.frequency_hz;
            let (sin, cos) = (omega * t).sin_cos();
            let envelope = (-mode.damping * omega * t).exp();
            matrix[(row, fixed + 2 * i)] = envelope * cos;
            matrix[(row, fixed + 2 * i + 1)] = envelope * sin;
        }
    }
    matrix
}

/// Best linear coefficients and what they leave.
fn project(series: &Series, modes: &[Oscillation], drift: bool) -> Option<(DVector<f64>, DVector<f64>)> {
    let mut matrix = columns(series, modes, drift);
    if matrix.nrows() < matrix.ncols() + 2 {
        return None;
    }
    let scales: Vec<f64> = matrix.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    for (mut column, scale) in matrix.column_iter_mut().zip(&scales) {
        column /= *scale;
    }
    let value = DVector::from_column_slice(&series.value);
    let normal = matrix.tr_mul(&matrix);
    let mut solution = normal.cholesky()?.solve(&matrix.tr_mul(&value));
    let residual = value - &matrix * &solution;
    for (coefficient, scale) in solution.iter_mut().zip(&scales) {
        *coefficient /= scale;
    }
    Some((solution, residual))
}

#[allow(clippy::cast_precision_loss, reason = "a few thousand points")]
fn rms(residual: &DVector<f64>) -> f64 {
    (residual.norm_squared() / residual.len() as f64).sqrt()
}

/// The frequency and damping that, added to `start`, leave least: a scan in steps of 7 % and three dampings.
fn best_seed(
    series: &[Series],
    start: &[Oscillation],
    (low_hz, high_hz): (f64, f64),
    drift: bool,
) -> Option<Oscillation> {
    let mut best: Option<(f64, Oscillation)> = None;
    let mut frequency_hz = low_hz;
    while frequency_hz <= high_hz {
        for damping in [0.005, 0.03, 0.1] {
            let seed = Oscillation { frequency_hz, damping };
            // Two modes at one place are one mode and a singular fit.
            if start.iter().any(|m| (m.frequency_hz / frequency_hz).ln().abs() < 0.05) {
                continue;
            }
            let trial: Vec<Oscillation> = start.iter().copied().chain([seed]).collect();
            let score: Option<f64> = series
                .iter()
                .map(|s| project(s, &trial, drift).map(|(_, r)| (rms(&r).powi(2) + s.floor.powi(2)).ln()))
                .sum();
            if let Some(score) = score
                && best.is_none_or(|(least, _)| score < least)
            {
                best = Some((score, seed));
            }
        }
        frequency_hz *= 1.07;
    }
    best.map(|(_, seed)| seed)
}

/// The variable projection problem in ln f and the logit of ζ / 0.3, residuals weighted by each series' own size.
struct Projection<'a> {
    series: &'a [Series],
    weights: Vec<f64>,
    drift: bool,
    parameters: DVector<f64>,
}

fn to_parameters(modes: &[Oscillation]) -> DVector<f64> {
    DVector::from_iterator(
        2 * modes.len(),
        modes.iter().flat_map(|m| {
            let share = (m.damping / MAX_DAMPING).clamp(1e-4, 1.0 - 1e-4);
            [m.frequency_hz.ln(), (share / (1.0 - share)).ln()]
        }),
    )
}

fn to_modes(parameters: &DVector<f64>) -> Vec<Oscillation> {
    parameters
        .as_slice()
        .chunks_exact(2)
        .map(|p| Oscillation { frequency_hz: p[0].exp(), damping: MAX_DAMPING / (1.0 + (-p[1]).exp()) })
        .collect()
}

impl Projection<'_> {
    fn residuals_at(&self, parameters: &DVector<f64>) -> Option<DVector<f64>> {
        let modes = to_modes(parameters);
        let mut all = Vec::new();
        for (series, weight) in self.series.iter().zip(&self.weights) {
            let (_, residual) = project(series, &modes, self.drift)?;
            all.extend(residual.iter().map(|r| r * weight));
        }
        all.iter().all(|r| r.is_finite()).then(|| DVector::from_vec(all))
    }

    /// ∂r/∂θ by forward differences; the residuals are smooth in θ and the step is √ε.
    fn jacobian_at(&self, parameters: &DVector<f64>) -> Option<DMatrix<f64>> {
        const STEP: f64 = 1e-6;
        let base = self.residuals_at(parameters)?;
        let mut jacobian = DMatrix::zeros(base.len(), parameters.len());
        for i in 0..parameters.len() {
            let mut moved = parameters.clone();
            moved[i] += STEP;
            jacobian.set_column(i, &((self.residuals_at(&moved)? - &base) / STEP));
        }
        Some(jacobian)
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Projection<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, parameters: &DVector<f64>) {
        self.parameters.copy_from(parameters);
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.residuals_at(&self.parameters)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        self.jacobian_at(&self.parameters)
    }
}

fn refine(series: &[Series], modes: Vec<Oscillation>, drift: bool) -> Option<Vec<Oscillation>> {
    let weights = series
        .iter()
        .map(|s| project(s, &modes, drift).map(|(_, r)| 1.0 / rms(&r).hypot(s.floor).max(1e-300)))
        .collect::<Option<Vec<f64>>>()?;
    let problem = Projection { series, weights, drift, parameters: to_parameters(&modes) };
    let (solved, report) = LevenbergMarquardt::new()
        .with_patience(20)
        .with_ftol(1e-9)
        .with_xtol(1e-7)
        .with_gtol(1e-9)
        .minimize(problem);
    let refined = to_modes(&solved.parameters);
    // A fit that stopped for lack of patience still stands at its best point; only numbers that are none are useless.
    let usable = report.objective_function.is_finite()
        && refined.iter().all(|m| m.frequency_hz.is_finite() && m.damping.is_finite());
    usable.then_some(refined)
}

/// Coefficients, uncertainties and residuals at given modes.
fn describe(series: &[Series], modes: Vec<Oscillation>, drift: bool) -> Option<Fit> {
    let mut fits = Vec::new();
    let mut lag_sum = 0.0;
    let mut parameters = 2 * modes.len();
    for s in series {
        let (solution, residual) = project(s, &modes, drift)?;
        let fixed = 1 + usize::from(drift);
        let jumps = s.steps_s.len();
        lag_sum += lag_one(&residual);
        parameters += solution.len();
        fits.push(SeriesFit {
            plateau: solution[0],
            u_plateau: 0.0,
            drift: if drift { solution[1] } else { 0.0 },
            u_drift: 0.0,
            amplitudes: solution.as_slice()[fixed + jumps..].chunks_exact(2).map(|c| (c[0], c[1])).collect(),
            residual: rms(&residual),
            jumps: solution.as_slice()[fixed..fixed + jumps].to_vec(),
        });
    }
    #[allow(clippy::cast_precision_loss, reason = "a handful of series")]
    let lag = (lag_sum / series.len() as f64).clamp(0.0, 0.95);
    let mut fit = Fit { modes, drift, series: fits, correlation: (1.0 + lag) / (1.0 - lag), parameters };
    uncertainties(series, &mut fit)?;
    Some(fit)
}

/// Lag-one autocorrelation.
fn lag_one(residual: &DVector<f64>) -> f64 {
    let r = residual.as_slice();
    let power: f64 = r.iter().map(|x| x * x).sum();
    if power > 0.0 { r.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / power } else { 0.0 }
}

/// Covariance of all parameters together, s² κ (JᵀJ)⁻¹, J = [Φ_1 … | ∂Φc/∂θ].
fn uncertainties(series: &[Series], fit: &mut Fit) -> Option<()> {
    let rows: usize = series.iter().map(|s| s.value.len()).sum();
    let mut jacobian = DMatrix::zeros(rows, fit.parameters);
    let weights: Vec<f64> =
        series.iter().zip(&fit.series).map(|(s, f)| 1.0 / f.residual.hypot(s.floor).max(1e-300)).collect();
    let (mut row, mut column) = (0, 2 * fit.modes.len());
    let mut places = Vec::new();
    for (s, weight) in series.iter().zip(&weights) {
        let block = columns(s, &fit.modes, fit.drift) * *weight;
        jacobian.view_mut((row, column), block.shape()).copy_from(&block);
        places.push(column);
        row += block.nrows();
        column += block.ncols();
    }
    if !fit.modes.is_empty() {
        let problem = Projection { series, weights, drift: fit.drift, parameters: to_parameters(&fit.modes) };
        let nonlinear = problem.jacobian_at(&problem.parameters)?;
        jacobian.view_mut((0, 0), nonlinear.shape()).copy_from(&nonlinear);
    }
    let scales: Vec<f64> = jacobian.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    for (mut c, scale) in jacobian.column_iter_mut().zip(&scales) {
        c /= *scale;
    }
    let covariance = jacobian.tr_mul(&jacobian).cholesky()?.inverse();
    let u = |i: usize| (covariance[(i, i)] * fit.correlation).max(0.0).sqrt() / scales[i];
    for (series_fit, &place) in fit.series.iter_mut().zip(&places) {
        series_fit.u_plateau = u(place);
        series_fit.u_drift = if fit.drift { u(place + 1) } else { 0.0 };
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two series of 60 ms with a 62 Hz and a 170 Hz mode, and a small deterministic disturbance.
    fn ringing(modes: &[Oscillation], drift: f64) -> Vec<Series> {
        [(20.0_f64, 3.0), (-7.0, 2.0)]
            .into_iter()
            .map(|(plateau, size)| {
                let time_s: Vec<f64> = (0..240).map(|i| f64::from(i) * 2.5e-4).collect();
                let value = time_s
                    .iter()
                    .enumerate()
                    .map(|(i, &t)| {
                        let ring: f64 = modes
                            .iter()
                            .map(|m| {
                                let w = TAU * m.frequency_hz;
                                size * (-m.damping * w * t).exp() * (w * t + 0.7).cos()
                            })
                            .sum();
                        let mut hash =
                            (i as u64 + 1 + (plateau.to_bits() >> 40)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                        hash ^= hash >> 29;
                        hash = hash.wrapping_mul(0xBF58_476D_1CE4_E5B9);
                        hash ^= hash >> 32;
                        let hash = f64::from((hash & 0xFFFF) as u16) / 65536.0 - 0.5;
                        plateau + drift * t + ring + 0.002 * hash
                    })
                    .collect();
                Series { time_s, value, steps_s: vec![], floor: 1e-3 }
            })
            .collect()
    }

    #[test]
    fn one_mode_is_found_and_taken_off() {
        let truth = [Oscillation { frequency_hz: 62.0, damping: 0.02 }];
        let series = ringing(&truth, 0.0);
        let fit = fit(&series, &[], Some((20.0, 600.0)), false).expect("a fit");
        assert!((fit.modes[0].frequency_hz - 62.0).abs() < 0.05, "{fit:?}");
        // The disturbance has 6e-4 RMS over 240 points: 1e-4 is three of its standard errors.
        assert!((fit.series[0].plateau - 20.0).abs() < 2e-4, "{}", fit.series[0].plateau);
        assert!((fit.series[1].plateau + 7.0).abs() < 2e-4);
        assert!(fit.series[0].u_plateau < 3e-4);
    }

    #[test]
    fn the_criterion_counts_the_modes() {
        let two = [
            Oscillation { frequency_hz: 62.0, damping: 0.02 },
            Oscillation { frequency_hz: 170.0, damping: 0.01 },
        ];
        for (truth, expected) in [(&two[..0], 0), (&two[..1], 1), (&two[..2], 2)] {
            let series = ringing(truth, 0.0);
            let mut fits = vec![fit(&series, &[], None, false).expect("a line")];
            while fits.len() < 4 {
                let start = fits[fits.len() - 1].modes.clone();
                let Some(next) = fit(&series, &start, Some((20.0, 600.0)), false) else { break };
                fits.push(next);
            }
            let richest = fits[fits.len() - 1].correlation;
            let best = (0..fits.len())
                .min_by(|&a, &b| fits[a].bic(&series, richest).total_cmp(&fits[b].bic(&series, richest)));
            let scores: Vec<_> =
                fits.iter().map(|f| (f.bic(&series, richest), f.modes.clone(), f.correlation)).collect();
            assert_eq!(best, Some(expected), "{scores:?}");
        }
    }

    #[test]
    fn a_jump_in_a_gap_is_given_back() {
        let mut series = ringing(&[Oscillation { frequency_hz: 62.0, damping: 0.02 }], 0.0);
        let Series { time_s, value, .. } = &mut series[0];
        for (t, v) in time_s.iter().zip(value) {
            *v += if *t > 0.03 { 1.5 } else { 0.0 };
        }
        series[0].steps_s = vec![0.03];
        let fit = fit(&series, &[], Some((20.0, 600.0)), false).expect("a fit");
        assert!((fit.series[0].jumps[0] - 1.5).abs() < 1e-3);
        assert!((fit.series[0].plateau - 20.0).abs() < 1e-3);
    }

    #[test]
    fn too_few_points_are_no_fit() {
        let series =
            vec![Series { time_s: vec![0.0, 1.0], value: vec![1.0, 1.0], steps_s: vec![], floor: 1.0 }];
        assert!(fit(&series, &[], None, false).is_none());
    }
}
