//! A long curve to the lowest and highest point of each pixel column, broken where samples are missing.

/// Unbroken runs of points, at most two a column over `columns` columns between the ends of the axis, in order.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "columns are few, and places are cut to them before the cast"
)]
pub(super) fn runs(points: &[(f64, f64)], from: f64, to: f64, columns: usize) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut run: Vec<(f64, f64)> = Vec::new();
    let mut column: Option<PixelColumn> = None;
    for &(x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            flush(&mut run, column.take().as_ref());
            if !run.is_empty() {
                runs.push(std::mem::take(&mut run));
            }
            continue;
        }
        if x < from || x > to {
            continue;
        }
        let index = (((x - from) / (to - from)) * columns as f64) as usize;
        match &mut column {
            Some(open) if open.index == index => open.take(x, y),
            _ => flush(&mut run, column.replace(PixelColumn { index, low: (x, y), high: (x, y) }).as_ref()),
        }
    }
    flush(&mut run, column.as_ref());
    if !run.is_empty() {
        runs.push(run);
    }
    runs
}

struct PixelColumn {
    index: usize,
    low: (f64, f64),
    high: (f64, f64),
}

impl PixelColumn {
    fn take(&mut self, x: f64, y: f64) {
        if y < self.low.1 {
            self.low = (x, y);
        }
        if y > self.high.1 {
            self.high = (x, y);
        }
    }
}

fn flush(run: &mut Vec<(f64, f64)>, column: Option<&PixelColumn>) {
    let Some(&PixelColumn { low, high, .. }) = column else { return };
    let (first, second) = if low.0 <= high.0 { (low, high) } else { (high, low) };
    run.push(first);
    if second != first {
        run.push(second);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_survive_and_points_stay_few() {
        let mut points: Vec<(f64, f64)> =
            (0..100_000).map(|i| (f64::from(i) * 1e-5, (f64::from(i) * 0.01).sin())).collect();
        points[61_803].1 = 9.0;
        points[31_415].1 = -7.0;
        let runs = runs(&points, 0.0, 1.0, 500);
        assert_eq!(runs.len(), 1);
        assert!(runs[0].len() <= 1002);
        assert!(runs[0].iter().any(|p| p.1 > 8.9) && runs[0].iter().any(|p| p.1 < -6.9));
        assert!(runs[0].windows(2).all(|w| w[0].0 <= w[1].0));
    }

    #[test]
    fn a_missing_stretch_breaks_the_curve() {
        let points = [(0.0, 1.0), (0.1, f64::NAN), (0.2, 2.0), (0.3, 3.0)];
        assert_eq!(runs(&points, 0.0, 1.0, 100), [vec![(0.0, 1.0)], vec![(0.2, 2.0), (0.3, 3.0)]]);
    }

    #[test]
    fn points_off_the_axis_are_left_out() {
        assert!(runs(&[(-1.0, 0.0), (2.0, 0.0)], 0.0, 1.0, 10).is_empty());
        assert!(runs(&[], 0.0, 1.0, 10).is_empty());
    }
}
