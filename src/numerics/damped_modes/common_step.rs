//! Tests if a common step at one time explains the residual of known modes in several series.

use super::covariance::describe;
use super::drive::Form;
use super::projection::SharedByTimes;
use super::seeds::basis;
use super::series::{Fit, Oscillation, Series};
use crate::numerics::as_f64;
use nalgebra::{DMatrix, DVector};

/// Series with known modes, prepared to test a step at any time.
pub struct CommonStep<'a> {
    series: &'a [Series],
    without: Fit,
    /// Sums over the points from each one on, of the basis of the modes and of the residual of each series.
    behind: SharedByTimes<DMatrix<f64>>,
    left_behind: Vec<DVector<f64>>,
}

/// Sums of each column from each row on, and 0 after the last.
fn suffix_sums(columns: DMatrix<f64>) -> DMatrix<f64> {
    let last = columns.nrows();
    let mut sums = columns.insert_row(last, 0.0);
    for mut column in sums.column_iter_mut() {
        for row in (0..last).rev() {
            column[row] += column[row + 1];
        }
    }
    sums
}

impl<'a> CommonStep<'a> {
    /// Prepares the series; `None` if they have too few points for one more step.
    pub fn new(series: &'a [Series], modes: &[Oscillation], form: Form) -> Option<Self> {
        let bases = SharedByTimes::new(series, |s| basis(s, modes, form))?;
        let left = |(s, basis): (&Series, &DMatrix<f64>)| {
            let value = DVector::from_column_slice(&s.value);
            let left = &value - basis * basis.tr_mul(&value);
            suffix_sums(DMatrix::from_columns(&[left])).column(0).into_owned()
        };
        let left_behind = series.iter().zip(bases.per_series()).map(left).collect();
        let without = describe(series, modes.to_vec(), form)?;
        Some(Self { series, without, behind: bases.map(suffix_sums), left_behind })
    }

    /// The step of each series after a time, and the reduction of the sum of squares; `None` if the modes
    /// explain everything.
    pub fn step(&self, after_s: f64) -> Option<Vec<(f64, f64)>> {
        let each = self.series.iter().zip(self.behind.per_series()).zip(&self.left_behind);
        let step_and_weight = |((series, behind), left): ((&Series, &DMatrix<f64>), &DVector<f64>)| {
            let first = series.time_s.partition_point(|t| *t <= after_s);
            let own = as_f64(series.time_s.len() - first) - behind.row(first).norm_squared();
            (own > 0.0).then(|| (left[first] / own, left[first] * left[first] / own))
        };
        each.map(step_and_weight).collect()
    }

    /// Bayesian information criterion with such a step   (21)
    pub fn bic(&self, after_s: f64, correlation: f64) -> Option<f64> {
        let mut fit = self.without.clone();
        for ((own, series), (_, explained)) in fit.series.iter_mut().zip(self.series).zip(self.step(after_s)?)
        {
            let square = own.residual.powi(2) - explained / as_f64(series.value.len());
            own.residual = square.max(0.0).sqrt();
        }
        fit.parameters += self.series.len();
        Some(fit.bic(self.series, correlation))
    }
}
