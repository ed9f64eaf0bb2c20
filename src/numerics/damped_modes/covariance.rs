//! Modes found to coefficients with their standard uncertainties.

use super::drive::Form;
use super::projection::{Projected, Projection, SharedByTimes, columns, rms};
use super::series::{Fit, Oscillation, Series, SeriesFit};
use crate::numerics::as_f64;
use levenberg_marquardt::LeastSquaresProblem;
use nalgebra::{DMatrix, DVector};

/// Coefficients, uncertainties and residuals at given modes; `None` where a series has fewer than two points
/// over.
pub fn describe(series: &[Series], modes: Vec<Oscillation>, form: Form) -> Option<Fit> {
    let mut fit = coefficients(series, modes, form)?;
    uncertainties(series, &mut fit, form)?;
    Some(fit)
}

/// Coefficients and residuals at given modes; the uncertainties are left at 0.
fn coefficients(series: &[Series], modes: Vec<Oscillation>, form: Form) -> Option<Fit> {
    let drift = form.drift;
    let mut fits = Vec::new();
    let mut lag_sum = 0.0;
    let mut parameters = 2 * modes.len();
    for (s, (solution, residual)) in series.iter().zip(Projected::new(series, modes.clone(), form)?.solved) {
        let fixed = 1 + usize::from(drift);
        let jumps = s.steps_s.len();
        lag_sum += lag_one(&residual);
        parameters += solution.len();
        fits.push(SeriesFit {
            plateau: solution[0],
            u_plateau: 0.0,
            drift: if drift { solution[1] } else { 0.0 },
            u_drift: 0.0,
            amplitudes: form.amplitudes(&modes, &solution.as_slice()[fixed + jumps..]),
            residual: rms(&residual),
            jumps: solution.as_slice()[fixed..fixed + jumps].to_vec(),
        });
    }
    let lag = (lag_sum / as_f64(series.len())).clamp(0.0, 0.95);
    Some(Fit {
        modes,
        drift,
        driven: form.drive.is_some(),
        series: fits,
        correlation: (1.0 + lag) / (1.0 - lag),
        parameters,
    })
}

/// Lag-one autocorrelation.
fn lag_one(residual: &DVector<f64>) -> f64 {
    let r = residual.as_slice();
    let power: f64 = r.iter().map(|x| x * x).sum();
    if power > 0.0 { r.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / power } else { 0.0 }
}

/// Covariance of all parameters together, s² κ (JᵀJ)⁻¹, J = [Φ_1 … | ∂Φc/∂θ].
fn uncertainties(series: &[Series], fit: &mut Fit, form: Form) -> Option<()> {
    let rows: usize = series.iter().map(|s| s.value.len()).sum();
    let mut jacobian = DMatrix::zeros(rows, fit.parameters);
    let weights: Vec<f64> =
        series.iter().zip(&fit.series).map(|(s, f)| 1.0 / f.residual.hypot(s.floor).max(1e-300)).collect();
    let (mut row, mut column) = (0, 2 * fit.modes.len());
    let mut places = Vec::new();
    let blocks = SharedByTimes::new(series, |s| Some(columns(s, &fit.modes, form)))?;
    for (block, weight) in blocks.each().zip(&weights) {
        let block = block * *weight;
        jacobian.view_mut((row, column), block.shape()).copy_from(&block);
        places.push(column);
        row += block.nrows();
        column += block.ncols();
    }
    if !fit.modes.is_empty() {
        let nonlinear = Projection::new(series, weights, form, &fit.modes).jacobian()?;
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
