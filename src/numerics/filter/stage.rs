//! Samples through a second-order low-pass in one direction, and back.

use rayon::prelude::*;

/// A second-order low-pass with gain 1 at frequency 0: two trapezoidal integrators (26).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateVariable {
    /// g (g + 2R) / (1 + g (g + 2R)).
    decay: f64,
    /// g / (1 + g (g + 2R)).
    second: f64,
    /// g times that.
    third: f64,
}

impl StateVariable {
    /// By g = tan(π f/f_s) and 2R.
    pub(crate) fn new(g: f64, damping: f64) -> Self {
        let first = 1.0 / (1.0 + g * (g + damping));
        Self { decay: g * (g + damping) * first, second: g * first, third: g * g * first }
    }

    /// Rows of samples, one a series, in the given order through it, from and to the states of its integrators.
    pub(crate) fn run<'a, const N: usize>(
        &self,
        rows: impl Iterator<Item = &'a mut [f64; N]>,
        [band, low]: &mut [[f64; N]; 2],
    ) {
        let Self { decay, second, third } = *self;
        for row in rows {
            for ((x, band), low) in row.iter_mut().zip(band.iter_mut()).zip(low.iter_mut()) {
                // Only what is added is rounded at its own size: 2 v1 − band and 2 v2 − low would round the states twice.
                let v3 = *x - *low;
                let added = second * *band + third * v3;
                *band += 2.0 * (second * v3 - decay * *band);
                *x = *low + added;
                *low += 2.0 * added;
            }
        }
    }
}

/// All samples forward, then all back; each way started in the steady state of its first sample.
pub(crate) fn forward_and_back(stage: &StateVariable, samples: &mut [f64]) {
    rows_forward_and_back(stage, samples.as_chunks_mut::<1>().0);
}

fn rows_forward_and_back<const N: usize>(stage: &StateVariable, rows: &mut [[f64; N]]) {
    let start = rows.first().copied().unwrap_or([0.0; N]);
    stage.run(rows.iter_mut(), &mut [[0.0; N], start]);
    let start = rows.last().copied().unwrap_or([0.0; N]);
    stage.run(rows.iter_mut().rev(), &mut [[0.0; N], start]);
}

/// Series that go through the filter beside one another: each step of one waits for the one before it.
const LANES: usize = 4;

/// The same of each series, to the bit; those of one length take little longer together than one of them.
pub(crate) fn each_forward_and_back(stage: &StateVariable, all: &mut [Vec<f64>]) {
    all.par_chunks_mut(LANES).for_each(|some| match some {
        [first, others @ ..] if others.iter().any(|series| series.len() != first.len()) => {
            for series in some {
                forward_and_back(stage, series);
            }
        }
        [one] => forward_and_back(stage, one),
        [_, _] => beside_forward_and_back::<2>(stage, some),
        _ => beside_forward_and_back::<LANES>(stage, some),
    });
}

/// Of up to `N` series of one length.
fn beside_forward_and_back<const N: usize>(stage: &StateVariable, some: &mut [Vec<f64>]) {
    let mut rows = vec![[0.0; N]; some.first().map_or(0, Vec::len)];
    for (lane, series) in some.iter().enumerate() {
        for (row, x) in rows.iter_mut().zip(series) {
            row[lane] = *x;
        }
    }
    rows_forward_and_back(stage, &mut rows);
    for (lane, series) in some.iter_mut().enumerate() {
        for (x, row) in series.iter_mut().zip(&rows) {
            *x = row[lane];
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
            each_forward_and_back(&stage, &mut together);
            for series in &mut alone {
                forward_and_back(&stage, series);
            }
            assert_eq!(together, alone, "{lengths:?}");
        }
    }
}
