//! Filters samples through a second-order low-pass in one direction, and back.

use rayon::prelude::*;

/// A second-order low-pass with gain 1 at frequency 0: two trapezoidal integrators (26).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StateVariable {
    /// g (g + 2R) / (1 + g (g + 2R)).
    decay: f64,
    /// g / (1 + g (g + 2R)).
    second: f64,
    /// g times that.
    third: f64,
}

impl StateVariable {
    /// Makes a stage from g = tan(π f/f_s) and 2R.
    pub(super) fn new(g: f64, damping: f64) -> Self {
        let first = 1.0 / (1.0 + g * (g + damping));
        Self { decay: g * (g + damping) * first, second: g * first, third: g * g * first }
    }

    /// Filters rows of samples, one per series, in the given order, and updates the states of its
    /// integrators.
    pub(super) fn run<'a, const N: usize>(
        &self,
        rows: impl Iterator<Item = &'a mut [f64; N]>,
        [band, low]: &mut [[f64; N]; 2],
    ) {
        let Self { decay, second, third } = *self;
        for row in rows {
            for ((x, band), low) in row.iter_mut().zip(band.iter_mut()).zip(low.iter_mut()) {
                // Only the increment is rounded at its own size: 2 v1 − band and 2 v2 − low would round the
                // states twice.
                let v3 = *x - *low;
                let added = second * *band + third * v3;
                *band += 2.0 * (second * v3 - decay * *band);
                *x = *low + added;
                *low += 2.0 * added;
            }
        }
    }
}

/// Filters all samples forward, then backward; each pass starts in the steady state of its first sample.
pub(super) fn forward_and_back(stage: &StateVariable, samples: &mut [f64]) {
    rows_forward_and_back(stage, samples.as_chunks_mut::<1>().0);
}

fn rows_forward_and_back<const N: usize>(stage: &StateVariable, rows: &mut [[f64; N]]) {
    let start = rows.first().copied().unwrap_or([0.0; N]);
    stage.run(rows.iter_mut(), &mut [[0.0; N], start]);
    let start = rows.last().copied().unwrap_or([0.0; N]);
    stage.run(rows.iter_mut().rev(), &mut [[0.0; N], start]);
}

/// Stretches that are filtered in parallel: each step of one waits for the one before it.
const LANES: usize = 4;
/// A series that is longer than its filter's memory by this factor is filtered in this many stretches.
const STRETCH_FACTOR: usize = 6;
const STRETCHES: usize = 2;

/// Filters each series. Series of one length take little longer together than one of them, and long ones less
/// if they are cut into stretches that begin and end `memory` samples farther out than their results.
pub(super) fn filter_all(stage: &StateVariable, memory: usize, all: &mut [Vec<f64>]) {
    let count = all.first().map_or(0, Vec::len);
    if all.iter().any(|series| series.len() != count) {
        all.par_iter_mut().for_each(|series| forward_and_back(stage, series));
        return;
    }
    let stretches = if count > STRETCH_FACTOR * memory { STRETCHES } else { 1 };
    let own = count.div_ceil(stretches);
    let length = (own + 2 * memory).min(count);
    // The place of a stretch is its series, the range of its results, and its beginning.
    let place = |stretch: usize| {
        let from = stretch % stretches * own;
        (stretch / stretches, from..(from + own).min(count), from.saturating_sub(memory).min(count - length))
    };
    let together: Vec<Vec<usize>> =
        (0..all.len() * stretches).collect::<Vec<_>>().chunks(LANES).map(<[usize]>::to_vec).collect();
    let filtered = |some: &Vec<usize>| {
        let mut rows = vec![[0.0; LANES]; length];
        for (lane, &stretch) in some.iter().enumerate() {
            let (series, _, start) = place(stretch);
            for (row, x) in rows.iter_mut().zip(&all[series][start..]) {
                row[lane] = *x;
            }
        }
        rows_forward_and_back(stage, &mut rows);
        rows
    };
    let rows: Vec<Vec<[f64; LANES]>> = together.par_iter().map(filtered).collect();
    for (some, rows) in together.iter().zip(&rows) {
        for (lane, &stretch) in some.iter().enumerate() {
            let (series, own, start) = place(stretch);
            let from = own.start - start;
            for (x, row) in all[series][own].iter_mut().zip(&rows[from..]) {
                *x = row[lane];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_beside_one_another_are_as_each_by_itself() {
        let stage = StateVariable::new(0.01, std::f64::consts::SQRT_2);
        let series =
            |i: u32, count: u32| (0..count).map(|n| f64::from((n * n + 7 * i) % 31)).collect::<Vec<_>>();
        for lengths in [&[50, 50, 50][..], &[50, 50, 50, 50, 50], &[50, 40], &[50], &[0, 0], &[]] {
            let mut together: Vec<Vec<f64>> = (0..).zip(lengths).map(|(i, n)| series(i, *n)).collect();
            let mut alone = together.clone();
            filter_all(&stage, 10, &mut together);
            for series in &mut alone {
                forward_and_back(&stage, series);
            }
            assert_eq!(together, alone, "{lengths:?}");
        }
    }

    #[test]
    fn long_series_in_stretches_are_as_in_one() {
        // f/f_s = 0.01/π: what was forgotten after three paddings of 3.1/f.
        let (stage, memory) = (StateVariable::new(0.01, std::f64::consts::SQRT_2), 3 * 974);
        let series =
            |i: u32| (0..20_001_u32).map(move |n| f64::from((n * n + 7 * i) % 31) + 1e-3 * f64::from(n));
        let mut together: Vec<Vec<f64>> = (0..3).map(|i| series(i).collect()).collect();
        let mut alone = together.clone();
        filter_all(&stage, memory, &mut together);
        for (alone, together) in alone.iter_mut().zip(&together) {
            forward_and_back(&stage, alone);
            let off = alone.iter().zip(together).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "{off}");
        }
    }
}
