//! Searches for a further mode among many candidates.

use super::drive::{Drive, Form};
use super::projection::{SharedByTimes, columns, mode_columns};
use super::ringing::{Ringing, evenly_spaced_ringing};
use super::series::{Oscillation, Series};
use crate::numerics::{as_f64, reduce};
use nalgebra::{DMatrix, DVector, Dyn, MatrixView, U1};

/// From this many rows on a product of matrices is faster; fewer rows are filled up with zeros.
const FAST_COLUMNS: usize = 8;

/// Series with this many points or more are searched in means of two: a period of five points still spans
/// more than two of them.
const LONG: usize = 100;

/// Projection of each column of a mode on the modes known so far.
type Known<'a> = MatrixView<'a, f64, Dyn, Dyn, U1, Dyn>;

/// Candidate modes of a band: steps of 7 % and three dampings. Made once for all fits of the same series and
/// drive.
pub struct Seeds {
    band_hz: (f64, f64),
    modes: Vec<Oscillation>,
    series: Vec<Series>,
    tried: SharedByTimes<Tried>,
}

/// The modes at the same times.
struct Tried {
    /// Columns, one mode after the other.
    columns: DMatrix<f64>,
    /// Products of each mode's columns: of the first with itself, of both, of the last with itself.
    products: Vec<[f64; 3]>,
}

impl Seeds {
    /// The seeds of a band, Hz, for `series` and its drive.
    pub fn new(series: &[Series], band_hz: (f64, f64), drive: Option<&Drive>) -> Self {
        let form = Form { drift: false, drive };
        let mut modes = Vec::new();
        let mut frequency_hz = band_hz.0;
        while frequency_hz <= band_hz.1 {
            modes.extend([0.005, 0.03, 0.1].map(|damping| Oscillation { frequency_hz, damping }));
            frequency_hz *= 1.07;
        }
        let series: Vec<Series> = series.iter().map(coarse).collect();
        let tried = SharedByTimes::from_fn(&series, |s| Tried::new(s, &modes, form));
        Self { band_hz, modes, series, tried }
    }

    /// True if a mode lies in the band or close to it.
    pub(super) fn is_near(&self, mode: &Oscillation) -> bool {
        (0.8 * self.band_hz.0..1.25 * self.band_hz.1).contains(&mode.frequency_hz)
    }
}

impl Tried {
    fn new(series: &Series, modes: &[Oscillation], form: Form) -> Self {
        let width = form.width();
        let mut columns = DMatrix::zeros(series.time_s.len(), width * modes.len());
        for (i, mode) in modes.iter().enumerate() {
            let phase = form.drive.map(|drive| drive.phase(*mode));
            let ringing = evenly_spaced_ringing(*mode, &series.time_s)
                .unwrap_or_else(|| Ringing::new(*mode, &series.time_s).collect());
            mode_columns(columns.columns_mut(width * i, width), ringing.into_iter(), phase);
        }
        let products = |i: usize| {
            let (first, last) = (columns.column(width * i), columns.column(width * (i + 1) - 1));
            [first.norm_squared(), first.dot(&last), last.norm_squared()]
        };
        let products = (0..modes.len()).map(products).collect();
        Self { columns, products }
    }
}

/// A long series in means of two neighbours.
fn coarse(series: &Series) -> Series {
    if series.value.len() < LONG {
        return series.clone();
    }
    let means = |values: &[f64]| reduce::block_means(values, 2);
    Series { time_s: means(&series.time_s), value: means(&series.value), ..series.clone() }
}

/// The seed that, added to `start`, leaves the smallest residual.
pub(super) fn best_seed(start: &[Oscillation], seeds: &Seeds, form: Form) -> Option<Oscillation> {
    let width = form.width();
    let mut scores = vec![0.0; seeds.modes.len()];
    for (tried, series) in seeds.tried.groups(&seeds.series) {
        let basis = basis(series.first()?, start, form)?;
        let count = basis.ncols();
        let rest = |own: &Series| {
            let value = DVector::from_column_slice(&own.value);
            &value - &basis * basis.tr_mul(&value)
        };
        let rests: Vec<DVector<f64>> = series.iter().map(|own| rest(own)).collect();
        // One product for all seeds gives their components along the known modes and along the residual.
        let mut beside = DMatrix::zeros(basis.nrows(), (count + rests.len()).max(FAST_COLUMNS));
        beside.columns_mut(0, count).copy_from(&basis);
        rests.iter().enumerate().for_each(|(j, rest)| beside.set_column(count + j, rest));
        let along = beside.transpose() * &tried.columns;
        for (i, score) in scores.iter_mut().enumerate() {
            let own = along.columns(width * i, width);
            let factor = factor(tried.products[i], &own.rows(0, count));
            for (j, (series, rest)) in series.iter().zip(&rests).enumerate() {
                let along = [own[(count + j, 0)], own[(count + j, width - 1)]];
                *score += factor.map_or(f64::NAN, |factor| {
                    let left = rest.norm_squared() - explained_square(factor, along);
                    (left.max(0.0) / as_f64(rest.len()) + series.floor.powi(2)).ln()
                });
            }
        }
    }
    // Two modes at one frequency are one mode and make the fit singular.
    let is_free =
        |seed: &Oscillation| start.iter().all(|m| (m.frequency_hz / seed.frequency_hz).ln().abs() >= 0.05);
    let scored = seeds.modes.iter().zip(scores).filter(|(mode, score)| is_free(mode) && !score.is_nan());
    scored.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(mode, _)| *mode)
}

/// The Cholesky factor of the products of a mode's columns, less the part that the `known` ones explain;
/// `None` if they explain everything. A single column has no second row: it is divided by infinity.
fn factor([own, both, other]: [f64; 3], known: &Known) -> Option<[f64; 3]> {
    let first = known.column(0);
    let size = Some(own - first.norm_squared()).filter(|size| *size > 0.0)?.sqrt();
    if known.ncols() == 1 {
        return Some([size, 0.0, f64::INFINITY]);
    }
    let last = known.column(1);
    let shared = (both - first.dot(&last)) / size;
    let left = other - last.norm_squared() - shared * shared;
    (left > 0.0).then(|| [size, shared, left.sqrt()])
}

/// Square of the residual that a mode explains, given its components along the mode's columns.
fn explained_square([size, shared, left]: [f64; 3], along: [f64; 2]) -> f64 {
    let first = along[0] / size;
    let second = (along[1] - shared * first) / left;
    first * first + second * second
}

/// An orthonormal basis of the known modes; `None` if one more mode would leave fewer than two points more
/// than unknowns.
pub(super) fn basis(series: &Series, start: &[Oscillation], form: Form) -> Option<DMatrix<f64>> {
    let matrix = columns(series, start, form);
    (matrix.nrows() >= matrix.ncols() + form.width() + 2).then(|| matrix.qr().q())
}
