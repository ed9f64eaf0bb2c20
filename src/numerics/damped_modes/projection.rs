//! Frequencies and dampings to the best linear coefficients, and to better frequencies and dampings (Golub & Pereyra 1973).

use super::{Form, Oscillation, Ringing, Series};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

/// Damping ratios stay below this: above, a "mode" is a bend of the plateau.
const MAX_DAMPING: f64 = 0.3;

/// Columns of one series' linear problem: 1, t, the jumps, then e^(−ζωt) cos ωt and sin ωt of each mode, or their driven sum.
pub(super) fn columns(series: &Series, modes: &[Oscillation], form: Form) -> DMatrix<f64> {
    let (fixed, width) = (fixed_columns(series, form.drift), form.width());
    let mut matrix = DMatrix::zeros(series.time_s.len(), fixed + width * modes.len());
    for (row, &t) in series.time_s.iter().enumerate() {
        matrix[(row, 0)] = 1.0;
        if form.drift {
            matrix[(row, 1)] = t;
        }
        for (i, &step_s) in series.steps_s.iter().enumerate() {
            matrix[(row, 1 + usize::from(form.drift) + i)] = f64::from(t > step_s);
        }
    }
    for (i, mode) in modes.iter().enumerate() {
        matrix.columns_mut(fixed + width * i, width).copy_from(&mode_columns(series, *mode, form));
    }
    matrix
}

/// Cosine and sine of one mode, or the one sum of both that its drive gives it.
fn mode_columns(series: &Series, mode: Oscillation, form: Form) -> DMatrix<f64> {
    let mut columns = DMatrix::zeros(series.time_s.len(), form.width());
    let phase = form.drive.map(|drive| drive.phase(mode));
    for (row, value) in Ringing::new(mode, &series.time_s).enumerate() {
        if let Some(phase) = phase {
            columns[(row, 0)] = (phase * value).re;
        } else {
            columns[(row, 0)] = value.re;
            columns[(row, 1)] = value.im;
        }
    }
    columns
}

fn fixed_columns(series: &Series, drift: bool) -> usize {
    1 + usize::from(drift) + series.steps_s.len()
}

/// Best linear coefficients and what they leave.
pub(super) fn project(
    series: &Series,
    modes: &[Oscillation],
    form: Form,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let mut matrix = columns(series, modes, form);
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
pub(super) fn rms(residual: &DVector<f64>) -> f64 {
    (residual.norm_squared() / residual.len() as f64).sqrt()
}

/// The frequency and damping that, added to `start`, leave least: a scan in steps of 7 % and three dampings.
pub(super) fn best_seed(
    series: &[Series],
    start: &[Oscillation],
    (low_hz, high_hz): (f64, f64),
    form: Form,
) -> Option<Oscillation> {
    let backgrounds =
        series.iter().map(|s| Background::new(s, start, form)).collect::<Option<Vec<Background>>>()?;
    let mut best: Option<(f64, Oscillation)> = None;
    let mut frequency_hz = low_hz;
    while frequency_hz <= high_hz {
        // Two modes at one place are one mode and a singular fit.
        let is_taken = start.iter().any(|m| (m.frequency_hz / frequency_hz).ln().abs() < 0.05);
        for damping in [0.005, 0.03, 0.1] {
            let seed = Oscillation { frequency_hz, damping };
            let score: Option<f64> = backgrounds
                .iter()
                .map(|b| b.mean_square_with(seed).map(|left| (left + b.series.floor.powi(2)).ln()))
                .sum();
            if let Some(score) = score.filter(|_| !is_taken)
                && best.is_none_or(|(least, _)| score < least)
            {
                best = Some((score, seed));
            }
        }
        frequency_hz *= 1.07;
    }
    best.map(|(_, seed)| seed)
}

/// One series with what the modes known so far explain taken off, so that a further mode costs two columns.
struct Background<'a> {
    series: &'a Series,
    form: Form<'a>,
    basis: DMatrix<f64>,
    rest: DVector<f64>,
}

impl<'a> Background<'a> {
    /// `None` where one mode more would leave fewer than two points over.
    fn new(series: &'a Series, start: &[Oscillation], form: Form<'a>) -> Option<Self> {
        let matrix = columns(series, start, form);
        if matrix.nrows() < matrix.ncols() + form.width() + 2 {
            return None;
        }
        let basis = matrix.qr().q();
        let value = DVector::from_column_slice(&series.value);
        let rest = &value - &basis * basis.tr_mul(&value);
        Some(Self { series, form, basis, rest })
    }

    /// Mean square of what is left with the best amplitudes of one more mode; `None` where it adds nothing of its own.
    #[allow(clippy::cast_precision_loss, reason = "a few thousand points")]
    fn mean_square_with(&self, mode: Oscillation) -> Option<f64> {
        let pair = mode_columns(self.series, mode, self.form);
        let known = self.basis.tr_mul(&pair);
        let along = pair.tr_mul(&self.rest);
        let normal = pair.tr_mul(&pair) - known.tr_mul(&known);
        let explained = along.dot(&normal.cholesky()?.solve(&along));
        Some((self.rest.norm_squared() - explained).max(0.0) / self.rest.len() as f64)
    }
}

/// The variable projection problem in ln f and the logit of ζ / 0.3, residuals weighted by each series' own size.
pub(super) struct Projection<'a> {
    pub series: &'a [Series],
    pub weights: Vec<f64>,
    pub form: Form<'a>,
    pub parameters: DVector<f64>,
}

pub(super) fn to_parameters(modes: &[Oscillation]) -> DVector<f64> {
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
            let (_, residual) = project(series, &modes, self.form)?;
            all.extend(residual.iter().map(|r| r * weight));
        }
        all.iter().all(|r| r.is_finite()).then(|| DVector::from_vec(all))
    }

    /// ∂r/∂θ by forward differences; the residuals are smooth in θ and the step is √ε.
    pub fn jacobian_at(&self, parameters: &DVector<f64>) -> Option<DMatrix<f64>> {
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

pub(super) fn refine(series: &[Series], modes: &[Oscillation], form: Form) -> Option<Vec<Oscillation>> {
    let weights = series
        .iter()
        .map(|s| project(s, modes, form).map(|(_, r)| 1.0 / rms(&r).hypot(s.floor).max(1e-300)))
        .collect::<Option<Vec<f64>>>()?;
    let problem = Projection { series, weights, form, parameters: to_parameters(modes) };
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
