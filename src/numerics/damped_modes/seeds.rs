//! A further mode sought among many that are tried.

use super::drive::{Drive, Form};
use super::projection::{OfTimes, columns, mode_columns};
use super::series::{Oscillation, Series};
use crate::numerics::as_f64;
use nalgebra::{DMatrix, DVector};

/// One more mode as it is tried: its columns, and their products with one another.
struct Seed {
    mode: Oscillation,
    columns: OfTimes<(DMatrix<f64>, DMatrix<f64>)>,
}

/// The modes that are tried in a band: steps of 7 % and three dampings. Made once for all fits of the same series and drive.
pub struct Seeds {
    band_hz: (f64, f64),
    seeds: Vec<Seed>,
}

impl Seeds {
    /// The seeds of a band, Hz, for `series` and what drives them.
    #[must_use]
    pub fn new(series: &[Series], band_hz: (f64, f64), drive: Option<&Drive>) -> Self {
        let form = Form { drift: false, drive };
        let mut seeds = Vec::new();
        let mut frequency_hz = band_hz.0;
        while frequency_hz <= band_hz.1 {
            for damping in [0.005, 0.03, 0.1] {
                let mode = Oscillation { frequency_hz, damping };
                let columns = OfTimes::new(series, |s| {
                    let columns = mode_columns(s, mode, form);
                    let products = columns.tr_mul(&columns);
                    Some((columns, products))
                });
                seeds.extend(columns.map(|columns| Seed { mode, columns }));
            }
            frequency_hz *= 1.07;
        }
        Self { band_hz, seeds }
    }

    /// Whether a mode lies in the band or close to it.
    pub(super) fn is_near(&self, mode: &Oscillation) -> bool {
        (0.8 * self.band_hz.0..1.25 * self.band_hz.1).contains(&mode.frequency_hz)
    }
}

/// The seed that, added to `start`, leaves least.
pub(super) fn best_seed(
    series: &[Series],
    start: &[Oscillation],
    seeds: &Seeds,
    form: Form,
) -> Option<Oscillation> {
    let bases = OfTimes::new(series, |s| basis(s, start, form))?;
    let rest = |(s, basis): (&Series, &DMatrix<f64>)| {
        let value = DVector::from_column_slice(&s.value);
        &value - basis * basis.tr_mul(&value)
    };
    let rests: Vec<DVector<f64>> = series.iter().zip(bases.each()).map(rest).collect();
    // Two modes at one place are one mode and a singular fit.
    let is_free =
        |seed: &&Seed| start.iter().all(|m| (m.frequency_hz / seed.mode.frequency_hz).ln().abs() >= 0.05);
    let score = |seed: &Seed| -> Option<f64> {
        let free = seed.columns.with(&bases, |(columns, products), basis| {
            // What the modes known so far explain is taken off, so that a further mode costs two columns.
            let known = basis.tr_mul(columns);
            (products - known.tr_mul(&known)).cholesky()
        })?;
        let parts = series.iter().zip(&rests).zip(seed.columns.each()).zip(free.each());
        Some(
            parts
                .map(|(((series, rest), (columns, _)), free)| {
                    let along = columns.tr_mul(rest);
                    let explained = along.dot(&free.solve(&along));
                    let left = (rest.norm_squared() - explained).max(0.0) / as_f64(rest.len());
                    (left + series.floor.powi(2)).ln()
                })
                .sum(),
        )
    };
    let scored = seeds.seeds.iter().filter(is_free).filter_map(|seed| Some((score(seed)?, seed.mode)));
    scored.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, mode)| mode)
}

/// An orthonormal basis of what the modes known so far explain; `None` where one mode more would leave fewer than two points over.
fn basis(series: &Series, start: &[Oscillation], form: Form) -> Option<DMatrix<f64>> {
    let matrix = columns(series, start, form);
    (matrix.nrows() >= matrix.ncols() + form.width() + 2).then(|| matrix.qr().q())
}
