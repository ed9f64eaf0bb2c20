//! Best linear coefficients for given frequencies and dampings, and improved frequencies and dampings (Golub
//! & Pereyra 1973).

use super::drive::Form;
use super::ringing::Ringing;
use super::series::{Oscillation, Series};
use crate::numerics::as_f64;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Cholesky, Complex, DMatrix, DMatrixViewMut, DVector, Dyn, Owned};
use std::cell::OnceCell;

/// Damping ratios stay below this: above, a "mode" is a bend of the plateau.
const MAX_DAMPING: f64 = 0.3;

/// Relative weights that change by more than this factor are computed again, at most this many times.
const WEIGHT_CHANGE: f64 = 2.0;
const MOST_ROUNDS: usize = 3;

/// Squares are increased by this share, so that rounding leaves a root of their products.
const ROUNDING_SHARE: f64 = 1e-12;

/// Columns of one series' linear problem: 1, t, the jumps, then e^(−ζωt) cos ωt and sin ωt of each mode, or
/// their driven sum.
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
        let phase = form.drive.map(|drive| drive.phase(*mode));
        let own = matrix.columns_mut(fixed + width * i, width);
        mode_columns(own, Ringing::new(*mode, &series.time_s), phase);
    }
    matrix
}

/// Cosine and sine of one mode, or the sum of both that its drive determines, from the mode's `ringing`.
pub(super) fn mode_columns(
    mut columns: DMatrixViewMut<f64>,
    ringing: impl Iterator<Item = Complex<f64>>,
    phase: Option<Complex<f64>>,
) {
    for (row, value) in ringing.enumerate() {
        if let Some(phase) = phase {
            columns[(row, 0)] = (phase * value).re;
        } else {
            columns[(row, 0)] = value.re;
            columns[(row, 1)] = value.im;
        }
    }
}

fn fixed_columns(series: &Series, drift: bool) -> usize {
    1 + usize::from(drift) + series.steps_s.len()
}

/// A value that depends on the times of a series alone: neighbouring series with the same times share it.
pub(super) struct SharedByTimes<T> {
    made: Vec<T>,
    places: Vec<usize>,
}

impl<T> SharedByTimes<T> {
    /// Calls `make` with the first series of each set of times; `None` if `make` returns `None`.
    pub(super) fn new(series: &[Series], make: impl Fn(&Series) -> Option<T>) -> Option<Self> {
        let SharedByTimes { made, places } = SharedByTimes::from_fn(series, make);
        Some(Self { made: made.into_iter().collect::<Option<_>>()?, places })
    }

    /// Evaluates a function that always gives a value, once for each set of times.
    pub(super) fn from_fn(series: &[Series], make: impl Fn(&Series) -> T) -> Self {
        let (mut made, mut places) = (Vec::new(), Vec::new());
        for (i, own) in series.iter().enumerate() {
            let before = i.checked_sub(1).map(|i| &series[i]);
            if before.is_none_or(|b| b.time_s != own.time_s || b.steps_s != own.steps_s) {
                made.push(make(own));
            }
            places.push(made.len() - 1);
        }
        Self { made, places }
    }

    /// Applies a function to each value.
    pub(super) fn map<U>(self, of: impl Fn(T) -> U) -> SharedByTimes<U> {
        SharedByTimes { made: self.made.into_iter().map(of).collect(), places: self.places }
    }

    /// Iterates over the values, one per series.
    pub(super) fn per_series(&self) -> impl Iterator<Item = &T> {
        self.places.iter().map(|&place| &self.made[place])
    }

    /// Iterates over the values, each with the series that share its times.
    pub(super) fn groups<'a>(
        &'a self,
        series: &'a [Series],
    ) -> impl Iterator<Item = (&'a T, Vec<&'a Series>)> {
        let sharing = |place: usize| series.iter().zip(&self.places).filter(move |(_, own)| **own == place);
        self.made
            .iter()
            .enumerate()
            .map(move |(place, made)| (made, sharing(place).map(|(s, _)| s).collect()))
    }
}

/// The normal equations of the linear problem, its columns scaled to length 1.
pub(super) struct Normal {
    columns: DMatrix<f64>,
    scales: Vec<f64>,
    cholesky: Cholesky<f64, Dyn>,
}

impl Normal {
    fn new(series: &Series, modes: &[Oscillation], form: Form) -> Option<Self> {
        let mut columns = columns(series, modes, form);
        if columns.nrows() < columns.ncols() + 2 {
            return None;
        }
        let scales: Vec<f64> = columns.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
        for (mut column, scale) in columns.column_iter_mut().zip(&scales) {
            column /= *scale;
        }
        let cholesky = columns.tr_mul(&columns).cholesky()?;
        Some(Self { columns, scales, cholesky })
    }

    fn solve(&self, values: &[f64]) -> (DVector<f64>, DVector<f64>) {
        let value = DVector::from_column_slice(values);
        let mut solution = self.cholesky.solve(&self.columns.tr_mul(&value));
        let residual = value - &self.columns * &solution;
        for (coefficient, scale) in solution.iter_mut().zip(&self.scales) {
            *coefficient /= scale;
        }
        (solution, residual)
    }

    /// Splits slopes into the part that the columns explain, in units of the coefficients, and the residual.
    fn split(&self, slopes: DMatrix<f64>) -> [DMatrix<f64>; 2] {
        let mut explained = self.cholesky.solve(&self.columns.tr_mul(&slopes));
        let left = slopes - &self.columns * &explained;
        for (mut row, scale) in explained.row_iter_mut().zip(&self.scales) {
            row /= *scale;
        }
        [explained, left]
    }

    /// Variance of a coefficient if the noise of the values is 1 and the modes are known.
    pub fn variance(&self, coefficient: usize) -> f64 {
        let mut unit = DVector::zeros(self.scales.len());
        unit[coefficient] = 1.0;
        self.cholesky.solve_mut(&mut unit);
        unit[coefficient] / self.scales[coefficient].powi(2)
    }
}

/// Change of a series with ln f and the damping of each mode, one column each.
pub(super) struct Slopes {
    /// Coefficients of the part that the columns explain.
    pub explained: DMatrix<f64>,
    /// Products of the residual slopes, one column with another.
    pub information: DMatrix<f64>,
    /// Products of the residual slopes with the residual of the series.
    along: DVector<f64>,
}

/// The linear problem at given modes, solved.
pub(super) struct Projected {
    modes: Vec<Oscillation>,
    pub normals: SharedByTimes<Normal>,
    /// Best linear coefficients and residuals of each series.
    pub solved: Vec<(DVector<f64>, DVector<f64>)>,
}

impl Projected {
    /// Solves the linear problem; `None` if a series has fewer than two points more than unknowns.
    pub fn new(series: &[Series], modes: Vec<Oscillation>, form: Form) -> Option<Self> {
        let normals = SharedByTimes::new(series, |s| Normal::new(s, &modes, form))?;
        let solved =
            series.iter().zip(normals.per_series()).map(|(s, normal)| normal.solve(&s.value)).collect();
        Some(Self { modes, normals, solved })
    }

    /// The slopes of each series; those with the same times share the parts that do not depend on its
    /// amplitudes.
    pub fn slopes(&self, series: &[Series], form: Form) -> Vec<Slopes> {
        let mut solved = self.solved.iter();
        let sharing = self.normals.groups(series).flat_map(|(normal, sharing)| {
            let fixed = fixed_columns(sharing[0], form.drift);
            let [explained, left] = normal.split(unit_slopes(sharing[0], &self.modes, form));
            let products = left.tr_mul(&left);
            let own = solved.by_ref().take(sharing.len()).map(|(solution, residual)| {
                let mixing = mixing(&form.amplitudes(&self.modes, &solution.as_slice()[fixed..]));
                Slopes {
                    explained: &explained * &mixing,
                    information: mixing.tr_mul(&(&products * &mixing)),
                    along: mixing.tr_mul(&left.tr_mul(residual)),
                }
            });
            own.collect::<Vec<_>>()
        });
        sharing.collect()
    }
}

/// Change of e^((−ζ + i) ω t) of each mode with ln f and with its damping: real and imaginary part of the
/// first, then of the second.
fn unit_slopes(series: &Series, modes: &[Oscillation], form: Form) -> DMatrix<f64> {
    let mut slopes = DMatrix::zeros(series.time_s.len(), 4 * modes.len());
    for (i, mode) in modes.iter().enumerate() {
        let omega = std::f64::consts::TAU * mode.frequency_hz;
        // Both derivatives of e^((−ζ + i) ω t) are t times a number.
        let rates = [Complex::new(-mode.damping * omega, omega), Complex::from(-omega)];
        let age_s = form.drive.map_or(Complex::from(0.0), |drive| drive.age_s(*mode));
        // Its amplitude is one by definition: only the phase of a driven mode depends on the parameters.
        let turns = rates.map(|rate| Complex::new(0.0, (rate * age_s).im));
        for (row, (value, t)) in Ringing::new(*mode, &series.time_s).zip(&series.time_s).enumerate() {
            for (j, (rate, turn)) in rates.iter().zip(turns).enumerate() {
                let slope = value * (rate * *t + turn);
                slopes[(row, 4 * i + 2 * j)] = slope.re;
                slopes[(row, 4 * i + 2 * j + 1)] = slope.im;
            }
        }
    }
    slopes
}

/// Matrix from the unit slopes to those of modes with these amplitudes: A cos + B sin = Re((A − iB) e^(iωt)).
fn mixing(amplitudes: &[(f64, f64)]) -> DMatrix<f64> {
    let mut mixing = DMatrix::zeros(4 * amplitudes.len(), 2 * amplitudes.len());
    for (i, (a, b)) in amplitudes.iter().enumerate() {
        for j in 2 * i..2 * i + 2 {
            mixing[(2 * j, j)] = *a;
            mixing[(2 * j + 1, j)] = *b;
        }
    }
    mixing
}

pub(super) fn rms(residual: &DVector<f64>) -> f64 {
    (residual.norm_squared() / as_f64(residual.len())).sqrt()
}

/// The variable projection problem in ln f and the logit of ζ / 0.3, residuals weighted by each series' own
/// size; as many rows as the products of slopes and residuals need.
pub(super) struct Projection<'a> {
    series: &'a [Series],
    weights: Vec<f64>,
    form: Form<'a>,
    parameters: DVector<f64>,
    /// Solution of the linear problem at these parameters, computed when first needed.
    here: OnceCell<Option<Projected>>,
    /// Root of the products in the solution, with the residuals as its last column.
    root: OnceCell<Option<DMatrix<f64>>>,
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

impl<'a> Projection<'a> {
    pub fn new(series: &'a [Series], weights: Vec<f64>, form: Form<'a>, modes: &[Oscillation]) -> Self {
        let parameters = to_parameters(modes);
        Self { series, weights, form, parameters, here: OnceCell::new(), root: OnceCell::new() }
    }

    fn current(&self) -> Option<&Projected> {
        let project = || Projected::new(self.series, to_modes(&self.parameters), self.form);
        self.here.get_or_init(project).as_ref()
    }

    /// [J r]ᵀ[J r] = RᵀR, J = −P⊥ ∂Φ/∂θ c, with P⊥ subtracting the part that the columns Φ explain (Kaufman
    /// 1975): exact if nothing remains. R replaces [J r], which has as many rows as points.
    fn root(&self) -> Option<&DMatrix<f64>> {
        let make = || {
            let here = self.current()?;
            let last = self.parameters.len();
            let mut products = DMatrix::zeros(last + 1, last + 1);
            let slopes = here.slopes(self.series, self.form);
            for ((own, (_, left)), weight) in slopes.iter().zip(&here.solved).zip(&self.weights) {
                let square = weight * weight;
                let mut among_slopes = products.view_mut((0, 0), (last, last));
                among_slopes += &own.information * square;
                let mut beside_residuals = products.view_mut((last, 0), (1, last));
                beside_residuals -= own.along.transpose() * square;
                products[(last, last)] += left.norm_squared() * square;
            }
            // The damping is converted to its logit.
            for (i, mode) in here.modes.iter().enumerate() {
                let by_logit = mode.damping * (1.0 - mode.damping / MAX_DAMPING);
                products.column_mut(2 * i + 1).scale_mut(by_logit);
                products.row_mut(2 * i + 1).scale_mut(by_logit);
            }
            for i in 0..=last {
                products[(i, i)] = products[(i, i)] * (1.0 + ROUNDING_SHARE) + f64::MIN_POSITIVE;
            }
            let root = products.cholesky()?.l().transpose();
            root.iter().all(|x| x.is_finite()).then_some(root)
        };
        self.root.get_or_init(make).as_ref()
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Projection<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, parameters: &DVector<f64>) {
        self.parameters.copy_from(parameters);
        self.here = OnceCell::new();
        self.root = OnceCell::new();
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.root()?.column(self.parameters.len()).into_owned())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some(self.root()?.columns(0, self.parameters.len()).into_owned())
    }
}

/// Inverse of the residual of each series, including its floor.
fn weights(series: &[Series], projected: &Projected) -> Vec<f64> {
    let weight = |(s, (_, left)): (&Series, &(_, DVector<f64>))| 1.0 / rms(left).hypot(s.floor).max(1e-300);
    series.iter().zip(&projected.solved).map(weight).collect()
}

/// True if the relative weights of some series have grown by more than [`WEIGHT_CHANGE`].
fn has_new_weights(before: &[f64], after: &[f64]) -> bool {
    let changes = || before.iter().zip(after).map(|(before, after)| after / before);
    changes().fold(0.0, f64::max) > WEIGHT_CHANGE * changes().fold(f64::INFINITY, f64::min)
}

/// Refines frequencies and dampings. Weights follow the residuals, so a series that the first guess fits
/// badly still counts.
pub(super) fn refine(series: &[Series], modes: &[Oscillation], form: Form) -> Option<Vec<Oscillation>> {
    let mut by_weight = weights(series, &Projected::new(series, modes.to_vec(), form)?);
    let mut refined = modes.to_vec();
    for _ in 0..MOST_ROUNDS {
        let problem = Projection::new(series, by_weight, form, &refined);
        let (solved, report) = LevenbergMarquardt::new()
            .with_patience(8)
            .with_ftol(1e-7)
            .with_xtol(1e-6)
            .with_gtol(1e-8)
            .minimize(problem);
        // A fit that reached its limit of evaluations is still valid at its best point; only values that are
        // not numbers are useless.
        refined = Some(to_modes(&solved.parameters)).filter(|refined| {
            report.objective_function.is_finite()
                && refined.iter().all(|m| m.frequency_hz.is_finite() && m.damping.is_finite())
        })?;
        let anew = weights(series, solved.current()?);
        if !has_new_weights(&solved.weights, &anew) {
            break;
        }
        by_weight = anew;
    }
    Some(refined)
}

#[cfg(test)]
mod tests {
    use super::super::Drive;
    use super::*;

    const MODES: [Oscillation; 2] = [
        Oscillation { frequency_hz: 62.0, damping: 0.02 },
        Oscillation { frequency_hz: 170.0, damping: 0.05 },
    ];

    /// Two series of 60 ms that the modes explain whole.
    fn series(form: Form) -> Vec<Series> {
        [(3.0, -1.0), (2.0, 4.0)]
            .into_iter()
            .map(|(a, b)| {
                let time_s: Vec<f64> = (0..120).map(|i| f64::from(i) * 5e-4).collect();
                let empty = Series { value: vec![0.0; 120], time_s, steps_s: vec![], floor: 1e-3 };
                let sizes =
                    DVector::from_iterator(2 * form.width(), [a, b, b, a].into_iter().take(2 * form.width()));
                let matrix = columns(&empty, &MODES, form);
                let value = matrix.columns(1, 2 * form.width()) * sizes;
                Series { value: value.as_slice().to_vec(), ..empty }
            })
            .collect()
    }

    #[track_caller]
    fn slopes_are_those_of_the_residuals(form: Form) {
        let series = series(form);
        let mut problem = Projection::new(&series, vec![1.0, 2.0], form, &MODES);
        let slopes = problem.jacobian().expect("a Jacobian");
        let parameters = problem.params();
        let mut at = |i: usize, step: f64| {
            let mut moved = parameters.clone();
            moved[i] += step;
            problem.set_params(&moved);
            let solved = &problem.current().expect("a solution").solved;
            let weighted = solved
                .iter()
                .zip([1.0, 2.0])
                .flat_map(|((_, left), weight)| left.iter().map(move |r| r * weight));
            DVector::from_iterator(240, weighted)
        };
        let columns: Vec<DVector<f64>> =
            (0..parameters.len()).map(|i| (at(i, 1e-5) - at(i, -1e-5)) / 2e-5).collect();
        let differences = DMatrix::from_columns(&columns);
        let (own, truth) = (slopes.tr_mul(&slopes), differences.tr_mul(&differences));
        for i in 0..parameters.len() {
            // Kaufman's form is exact where nothing is left; the difference is off by h² of the third
            // derivative, (ω t)³ ~ 1e4.
            let off = (own.column(i) - truth.column(i)).amax() / truth.column(i).amax();
            assert!(off < 1e-5, "{i}: {off}");
        }
    }

    #[test]
    fn slopes_are_those_of_free_modes() {
        slopes_are_those_of_the_residuals(Form::free(false));
    }

    #[test]
    fn slopes_are_those_of_driven_modes() {
        let impulses = (0..40).map(|i| (std::f64::consts::PI * (f64::from(i) + 0.5) / 40.0).sin()).collect();
        let drive = Drive { age_s: 6e-3, step_s: 1e-4, impulses };
        slopes_are_those_of_the_residuals(Form { drift: false, drive: Some(&drive) });
    }

    #[test]
    fn a_quiet_series_does_not_tell_the_modes_of_loud_ones() {
        // A cask rings on two transverse channels; an axial one has little of it, and a hum of its own.
        let rings = |t: f64, mode: Oscillation| {
            let turned = std::f64::consts::TAU * mode.frequency_hz * t;
            (-mode.damping * turned).exp() * (turned + 0.7).cos()
        };
        let series: Vec<Series> = [(13.0, -4.0, 0.0, 0.03), (4.0, 3.0, 0.0, 0.01), (3e-3, 1e-3, 1e-4, 8e-5)]
            .into_iter()
            .map(|(first, second, hum, floor)| {
                let time_s: Vec<f64> = (0..240).map(|i| f64::from(i) * 0.0165 / 240.0).collect();
                let value = time_s.iter().map(|&t| {
                    let hums = hum * (std::f64::consts::TAU * 90.0 * t).sin();
                    first * rings(t, MODES[0]) + second * rings(t, MODES[1]) + hums
                });
                Series { value: value.collect(), time_s, steps_s: vec![], floor }
            })
            .collect();
        let start = [(70.0, 0.09), (180.0, 0.03)]
            .map(|(frequency_hz, damping)| Oscillation { frequency_hz, damping });
        let refined = refine(&series, &start, Form::free(true)).expect("modes");
        for (own, truth) in refined.iter().zip(MODES) {
            assert!((own.frequency_hz / truth.frequency_hz - 1.0).abs() < 1e-3, "{refined:?}");
            assert!((own.damping - truth.damping).abs() < 1e-3, "{refined:?}");
        }
    }
}
