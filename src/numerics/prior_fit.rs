//! Finds the most probable unknowns for unit normal priors and observations of unit uncertainty, and the
//! information of each datum on them.

use super::as_f64;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, storage::Owned};
use rayon::prelude::*;

/// Step of the derivatives, in prior standard deviations: the models are smooth over it, and the change is
/// far above their round-off.
const STEP: f64 = 0.05;

/// A fit with this χ² per observation may have stuck at its start.
const IMPROBABLE_CHI_SQUARE: f64 = 10.0;

/// With more unknowns than this, the fit uses as many directions as there are observations.
const MOST_UNKNOWNS: usize = 150;

/// Residuals of the observations at given unknowns, each over its standard uncertainty; `None` if the model
/// fails there.
pub type Residuals<'a> = &'a (dyn Fn(&[f64]) -> Option<Vec<f64>> + Sync);

/// Their derivatives there, for example from [`derivatives`].
pub type Slopes<'a> = &'a dyn Fn(&[f64]) -> Option<DMatrix<f64>>;

/// Result of the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorFit {
    /// The unknowns, in prior standard deviations.
    pub unknowns: Vec<f64>,
    /// Σ q² + Σ r², with as many degrees of freedom as there are observations.
    pub chi_square: f64,
    /// Response of each unknown to each datum, first the priors and then the observations: one row per
    /// unknown, unit steps.
    pub response: DMatrix<f64>,
}

impl PriorFit {
    /// The fit without any observation, which is the prior.
    pub fn from_priors(count: usize) -> Self {
        Self { unknowns: vec![0.0; count], chi_square: 0.0, response: DMatrix::identity(count, count) }
    }

    /// Standard deviation of unknown `index` after the fit, as a share of the one before.
    pub fn remaining_share(&self, index: usize) -> f64 {
        self.response.row(index).norm()
    }
}

/// Minimises Σ q_i² + Σ r_j(q)²   (30) by the Levenberg-Marquardt method; `None` if the model fails at the
/// start or the normal matrix is singular.
pub fn fit(count: usize, residuals: Residuals, slopes: Slopes) -> Option<PriorFit> {
    let search = LevenbergMarquardt::new().with_ftol(1e-6).with_xtol(1e-4).with_patience(4);
    let solved_from = |unknowns| search.minimize(PriorProblem { residuals, slopes, unknowns });
    let begun = residuals(&vec![0.0; count])?;
    let observations = as_f64(begun.len());
    if count > MOST_UNKNOWNS && begun.len() < count / 2 {
        return in_few_directions(count, residuals, slopes);
    }
    let (mut solved, _) = solved_from(DVector::zeros(count));
    if chi_square(&solved) > IMPROBABLE_CHI_SQUARE * observations {
        // If the model jumps or ripples at the start its slope there misleads; the slope over a standard
        // deviation on either side does not.
        let (other, _) = solved_from(linear_solution(begun, &wide_slopes(residuals, count)?)?);
        if chi_square(&other) < chi_square(&solved) {
            solved = other;
        }
    }
    let chi_square = chi_square(&solved);
    finish(solved.unknowns.as_slice(), chi_square, slopes)
}

/// Like [`fit`] for many unknowns: the most probable ones are q = −Jᵀ r, so that they lie in as many
/// directions as there are observations.
fn in_few_directions(count: usize, residuals: Residuals, slopes: Slopes) -> Option<PriorFit> {
    let mut unknowns = DVector::zeros(count);
    let mut chi_square = f64::INFINITY;
    // J changes during the fit: the second pass uses the directions at the end of the first.
    for _ in 0..2 {
        let directions = slopes(unknowns.as_slice())?.transpose().qr().q();
        let at = |along: &[f64]| &directions * DVector::from_column_slice(along);
        let solved = fit(directions.ncols(), &|along| residuals(at(along).as_slice()), &|along| {
            Some(slopes(at(along).as_slice())? * &directions)
        })?;
        unknowns = at(&solved.unknowns);
        chi_square = solved.chi_square;
    }
    finish(unknowns.as_slice(), chi_square, slopes)
}

/// Response of the unknowns at the end of a search: (1 + JᵀJ)⁻¹ (prior + Jᵀ observation), in which the
/// inverse is 1 − Jᵀ (1 + JJᵀ)⁻¹ J   (31)
fn finish(unknowns: &[f64], chi_square: f64, slopes: Slopes) -> Option<PriorFit> {
    let jacobian = slopes(unknowns)?;
    let (rows, count) = jacobian.shape();
    let of_observations = DMatrix::identity(rows, rows) + &jacobian * jacobian.transpose();
    let covariance =
        DMatrix::identity(count, count) - jacobian.tr_mul(&(of_observations.cholesky()?.solve(&jacobian)));
    let mut response = DMatrix::zeros(count, count + rows);
    response.columns_mut(0, count).copy_from(&covariance);
    response.columns_mut(count, rows).copy_from(&(&covariance * jacobian.transpose()));
    chi_square.is_finite().then(|| PriorFit { unknowns: unknowns.to_vec(), chi_square, response })
}

/// ∂r/∂q by differences from the values at `at`, on all cores; one column per unknown. If an unknown `jumps`,
/// any shift of it changes more than proportionally: its differences are those between both sides.
pub fn derivatives(
    values: &[f64],
    model: Residuals,
    at: &[f64],
    jumps: &(dyn Fn(usize) -> bool + Sync),
) -> Option<DMatrix<f64>> {
    let before = DVector::from_column_slice(values);
    let beside = |i: usize, step: f64| {
        let mut moved = at.to_vec();
        moved[i] += step;
        model(&moved).map(DVector::from_vec)
    };
    let column = |i: usize| {
        let after = beside(i, STEP)?;
        Some(if jumps(i) { (after - beside(i, -STEP)?) / (2.0 * STEP) } else { (after - &before) / STEP })
    };
    let columns: Vec<DVector<f64>> = (0..at.len()).into_par_iter().map(column).collect::<Option<_>>()?;
    let rows = columns.first().map_or(0, DVector::len);
    Some(if rows == 0 { DMatrix::zeros(0, at.len()) } else { DMatrix::from_columns(&columns) })
}

/// The most probable unknowns of a linear model with these residuals at zero and these slopes.
fn linear_solution(residuals: Vec<f64>, slopes: &DMatrix<f64>) -> Option<DVector<f64>> {
    let normal = DMatrix::identity(slopes.ncols(), slopes.ncols()) + slopes.tr_mul(slopes);
    Some(-normal.cholesky()?.solve(&slopes.tr_mul(&DVector::from_vec(residuals))))
}

/// ∂r/∂q at 0 from the residuals one prior standard deviation on either side.
fn wide_slopes(residuals: Residuals, count: usize) -> Option<DMatrix<f64>> {
    let beside = |i: usize, step: f64| {
        let mut moved = vec![0.0; count];
        moved[i] = step;
        residuals(&moved).map(DVector::from_vec)
    };
    let columns = (0..count).map(|i| Some((beside(i, 1.0)? - beside(i, -1.0)?) / 2.0));
    columns.collect::<Option<Vec<_>>>().map(|columns| DMatrix::from_columns(&columns))
}

/// Σ q² + Σ r², infinite where the model fails.
fn chi_square(at: &PriorProblem) -> f64 {
    let squares = |left: Vec<f64>| at.unknowns.norm_squared() + left.iter().map(|r| r * r).sum::<f64>();
    (at.residuals)(at.unknowns.as_slice()).map_or(f64::INFINITY, squares)
}

struct PriorProblem<'a> {
    residuals: Residuals<'a>,
    slopes: Slopes<'a>,
    unknowns: DVector<f64>,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for PriorProblem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, unknowns: &DVector<f64>) {
        self.unknowns.copy_from(unknowns);
    }

    fn params(&self) -> DVector<f64> {
        self.unknowns.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let observed = (self.residuals)(self.unknowns.as_slice())?;
        Some(DVector::from_vec([self.unknowns.as_slice(), &observed].concat()))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let observed = (self.slopes)(self.unknowns.as_slice())?;
        let count = self.unknowns.len();
        let mut all = DMatrix::identity(count + observed.nrows(), count);
        all.view_mut((count, 0), (observed.nrows(), count)).copy_from(&observed);
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_differences(count: usize, residuals: Residuals) -> Option<PriorFit> {
        fit(count, residuals, &|at| derivatives(&residuals(at)?, residuals, at, &|_| false))
    }

    #[test]
    fn many_unknowns_are_found_in_few_directions() {
        let weight = |i: usize, j: usize| (as_f64(i * 7 + j * 3)).sin();
        let residuals = |q: &[f64]| {
            let along = |j: usize| q.iter().enumerate().map(|(i, q)| weight(i, j) * q).sum::<f64>();
            let left = (0..3).map(|j| 2.0 * along(j) + 0.1 * along(0) * along(j) - 5.0);
            Some(left.collect::<Vec<f64>>())
        };
        let slopes = |at: &[f64]| derivatives(&residuals(at)?, &residuals, at, &|_| true);
        let whole = fit(60, &residuals, &slopes).expect("a fit");
        let few = in_few_directions(60, &residuals, &slopes).expect("a fit");
        assert!((whole.chi_square - few.chi_square).abs() < 1e-5 * whole.chi_square, "{few:?}");
        let apart = whole.unknowns.iter().zip(&few.unknowns).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-3);
        assert!((whole.response - few.response).amax() < 1e-3);
    }

    #[test]
    fn two_measurements_of_one_thing_meet_by_their_weights() {
        // Prior 0 ± 1, observation 3 ± 0.5 of it: (0/1 + 3/0.25) / (1/1 + 1/0.25) = 2.4, u = √(1/5).
        let fit = by_differences(1, &|q| Some(vec![(q[0] - 3.0) / 0.5])).expect("a fit");
        assert!((fit.unknowns[0] - 2.4).abs() < 1e-6, "{fit:?}");
        assert!((fit.remaining_share(0) - 0.2_f64.sqrt()).abs() < 1e-6);
        // χ² = 2.4² + (0.6/0.5)².
        assert!((fit.chi_square - 7.2).abs() < 1e-6);
    }

    #[test]
    fn a_bent_model_is_solved_where_it_bends() {
        // (q + 0.1 q²) = 2 ± 0.01 holds almost alone: q = (√1.8 − 1)/0.2.
        let fit = by_differences(1, &|q| Some(vec![(q[0] + 0.1 * q[0] * q[0] - 2.0) / 0.01])).expect("a fit");
        let exact = (1.8_f64.sqrt() - 1.0) / 0.2;
        // The prior pulls by q / (slope/0.01)², below 2e-4.
        assert!((fit.unknowns[0] - exact).abs() < 3e-4, "{fit:?}");
    }

    #[test]
    fn the_contributions_add_up_to_the_variance() {
        let fit = by_differences(2, &|q| Some(vec![(q[0] + q[1]) / 0.3])).expect("a fit");
        // Covariance of (1 + JᵀJ)⁻¹ with J = (1, 1)/0.3: diagonal 1 − 1/(2 + 0.09).
        let variance = 1.0 - 1.0 / 2.09;
        assert!((fit.remaining_share(0).powi(2) - variance).abs() < 1e-6);
        assert_eq!(PriorFit::from_priors(3).remaining_share(1).to_bits(), 1.0_f64.to_bits());
    }

    #[test]
    fn a_model_that_ripples_is_solved_across_its_ripples() {
        // 3 q_0 = 6 ± 0.1 with a ripple that falls where the line rises: a step to either side is worse.
        let ripple = |q: f64| 3.0 * q - 0.4 * (40.0 * q).sin();
        let fit =
            by_differences(2, &|q| Some(vec![(ripple(q[0]) + 0.01 * q[1] - 6.0) / 0.1])).expect("a fit");
        // The line over ± 1 ends within 0.4/3 of q_0 = 2, the minimum next to it within one ripple, 2π/40;
        // what it leaves is no more than the ripple: q_0² + (0.4/0.1)².
        assert!((fit.unknowns[0] - 2.0).abs() < 0.29 && fit.chi_square < 21.3, "{fit:?}");
    }

    #[test]
    fn a_model_that_fails_is_no_fit() {
        assert!(by_differences(2, &|_| None).is_none());
    }
}
