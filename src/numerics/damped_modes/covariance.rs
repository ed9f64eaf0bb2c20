//! Coefficients of known modes with their standard uncertainties.

use super::drive::Form;
use super::projection::{Projected, rms};
use super::series::{Fit, Oscillation, Series, SeriesFit};
use crate::numerics::as_f64;
use crate::numerics::reduce::finite_block_means;
use nalgebra::{DMatrix, DVector};

/// Stretches of a series; residuals that remain in the means over them count as slow.
const STRETCHES: usize = 24;

/// Coefficients, uncertainties and residuals at given modes; `None` if a series has fewer than two points
/// more than unknowns.
pub fn describe(series: &[Series], modes: Vec<Oscillation>, form: Form) -> Option<Fit> {
    let projected = Projected::new(series, modes.clone(), form)?;
    let mut fit = coefficients(series, modes, form, &projected);
    uncertainties(series, &mut fit, form, &projected)?;
    Some(fit)
}

/// Coefficients and residuals at given modes; the uncertainties are left at 0.
fn coefficients(series: &[Series], modes: Vec<Oscillation>, form: Form, projected: &Projected) -> Fit {
    let drift = form.drift;
    let mut fits = Vec::new();
    let mut lag_sum = 0.0;
    let mut parameters = 2 * modes.len();
    for (s, (solution, residual)) in series.iter().zip(&projected.solved) {
        let fixed = 1 + usize::from(drift);
        let jumps = s.steps_s.len();
        lag_sum += lag_one(residual);
        parameters += solution.len();
        fits.push(SeriesFit {
            plateau: solution[0],
            u_plateau: 0.0,
            drift: if drift { solution[1] } else { 0.0 },
            u_drift: 0.0,
            amplitudes: form.amplitudes(&modes, &solution.as_slice()[fixed + jumps..]),
            residual: rms(residual),
            slow_residual: rms(&stretch_means(residual)),
            jumps: solution.as_slice()[fixed..fixed + jumps].to_vec(),
        });
    }
    let lag = (lag_sum / as_f64(series.len())).clamp(0.0, 0.95);
    Fit {
        modes,
        drift,
        driven: form.drive.is_some(),
        series: fits,
        correlation: (1.0 + lag) / (1.0 - lag),
        parameters,
    }
}

/// Means over a 24th of the series each.
fn stretch_means(residual: &DVector<f64>) -> DVector<f64> {
    DVector::from_vec(finite_block_means(residual.as_slice(), residual.len().div_ceil(STRETCHES)))
}

/// Lag-one autocorrelation.
fn lag_one(residual: &DVector<f64>) -> f64 {
    let r = residual.as_slice();
    let power: f64 = r.iter().map(|x| x * x).sum();
    if power > 0.0 { r.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / power } else { 0.0 }
}

/// Covariance of the plateaus and drifts, s² κ times their part of (JᵀJ)⁻¹, J = [Φ_1 … | ∂Φc/∂θ]: that at
/// known modes, and the contribution of the modes' uncertainty.
fn uncertainties(series: &[Series], fit: &mut Fit, form: Form, projected: &Projected) -> Option<()> {
    let slopes = projected.slopes(series, form);
    let variances: Vec<f64> = series
        .iter()
        .zip(&fit.series)
        .map(|(s, f)| (f.residual.powi(2) + s.floor.powi(2)).max(1e-300))
        .collect();
    let mut information = DMatrix::zeros(2 * fit.modes.len(), 2 * fit.modes.len());
    for (own, variance) in slopes.iter().zip(&variances) {
        information += &own.information / *variance;
    }
    let of_modes = information.cholesky()?.inverse();
    let normals = projected.normals.per_series();
    for (((own, slopes), normal), variance) in fit.series.iter_mut().zip(&slopes).zip(normals).zip(variances)
    {
        let u = |coefficient: usize| {
            let slopes = slopes.explained.row(coefficient);
            let by_modes = (slopes * &of_modes).dot(&slopes);
            (fit.correlation * (variance * normal.variance(coefficient) + by_modes)).sqrt()
        };
        own.u_plateau = u(0);
        own.u_drift = if fit.drift { u(1) } else { 0.0 };
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::super::fit;
    use super::*;
    use rand::{SeedableRng, rngs::ChaCha8Rng};
    use rand_distr::{Distribution, Normal};
    use std::f64::consts::TAU;

    /// Misses of both plateaus over their stated uncertainties, of a mode seen for `periods` in white noise.
    fn misses(periods: f64) -> Vec<f64> {
        let (length_s, truth) = (0.03, [20.0, -7.0]);
        let mode = Oscillation { frequency_hz: periods / length_s, damping: 0.03 };
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let noise = Normal::new(0.0, 0.02).expect("a spread");
        let mut of_trial = || {
            let series: Vec<Series> = truth
                .into_iter()
                .zip([3.0, 2.0])
                .map(|(plateau, size)| {
                    let time_s: Vec<f64> = (0..240).map(|i| f64::from(i) * length_s / 240.0).collect();
                    let ringing = |t: f64| {
                        let phase = TAU * mode.frequency_hz * t;
                        size * (-mode.damping * phase).exp() * (phase + 0.7).cos()
                    };
                    let value =
                        time_s.iter().map(|&t| plateau + ringing(t) + noise.sample(&mut random)).collect();
                    Series { time_s, value, steps_s: vec![], floor: 0.02 }
                })
                .collect();
            let fit = fit(&series, &[mode], None, Form::free(false)).expect("a fit");
            [0, 1].map(|i| (fit.series[i].plateau - truth[i]) / fit.series[i].u_plateau)
        };
        (0..300).flat_map(|_| of_trial()).collect()
    }

    #[test]
    fn plateaus_miss_by_what_is_stated() {
        // Residual and floor are both counted, so that where the model is right √2 is stated too much.
        for periods in [0.8, 1.5, 3.0] {
            let misses = misses(periods);
            let rms = (misses.iter().map(|z| z * z).sum::<f64>() / as_f64(misses.len())).sqrt();
            assert!((0.6..0.85).contains(&rms), "{periods} periods: {rms:.2}");
        }
    }
}
