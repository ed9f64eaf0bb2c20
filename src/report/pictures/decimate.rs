//! A long curve to the lowest and highest point of each column of the picture, broken where samples are
//! missing.

use crate::numerics::{as_count, as_f64};

/// Unbroken runs of points, at most two in each unit of x, in order.
pub(super) fn runs(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<PixelColumn>> = vec![Vec::new()];
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            runs.push(Vec::new());
        } else if let Some(run) = runs.last_mut() {
            match run.last_mut().filter(|column| column.index.total_cmp(&x.floor()).is_eq()) {
                Some(column) => column.take((x, y)),
                None => run.push(PixelColumn { index: x.floor(), low: (x, y), high: (x, y) }),
            }
        }
    }
    runs.retain(|run| !run.is_empty());
    runs.into_iter().map(|run| run.into_iter().flat_map(PixelColumn::points).collect()).collect()
}

/// Of values at numbered places the lowest and the highest of each `each` places, and not a number between
/// runs, where values are missing.
pub(super) fn thinned(values: impl IntoIterator<Item = (usize, f64)>, each: usize) -> Vec<(usize, f64)> {
    let mut kept = Vec::new();
    let places = values.into_iter().map(|(place, value)| (as_f64(place) / as_f64(each), value));
    for (i, run) in runs(places).into_iter().enumerate() {
        let place = |x: f64| as_count((x * as_f64(each)).round());
        kept.extend(run.first().filter(|_| i > 0).map(|(begins, _)| (place(*begins) - 1, f64::NAN)));
        kept.extend(run.into_iter().map(|(x, value)| (place(x), value)));
    }
    kept
}

/// What lies in one unit of x.
struct PixelColumn {
    index: f64,
    low: (f64, f64),
    high: (f64, f64),
}

impl PixelColumn {
    fn take(&mut self, at: (f64, f64)) {
        if at.1 < self.low.1 {
            self.low = at;
        }
        if at.1 > self.high.1 {
            self.high = at;
        }
    }

    fn points(self) -> Vec<(f64, f64)> {
        let (first, second) =
            if self.low.0 <= self.high.0 { (self.low, self.high) } else { (self.high, self.low) };
        if first == second { vec![first] } else { vec![first, second] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_survive_and_points_stay_few() {
        let mut points: Vec<(f64, f64)> =
            (0..100_000).map(|i| (f64::from(i) * 5e-3, (f64::from(i) * 0.01).sin())).collect();
        points[61_803].1 = 9.0;
        points[31_415].1 = -7.0;
        let runs = runs(points);
        assert_eq!(runs.len(), 1);
        assert!(runs[0].len() <= 1002);
        assert!(runs[0].iter().any(|p| p.1 > 8.9) && runs[0].iter().any(|p| p.1 < -6.9));
        assert!(runs[0].windows(2).all(|w| w[0].0 <= w[1].0));
    }

    #[test]
    fn a_missing_stretch_breaks_the_curve() {
        let points = [(0.0, 1.0), (10.0, f64::NAN), (20.0, 2.0), (30.0, 3.0)];
        assert_eq!(runs(points), [vec![(0.0, 1.0)], vec![(20.0, 2.0), (30.0, 3.0)]]);
        assert!(runs([]).is_empty());
    }
}
