//! Uniform samples to their running integral, by any of several rules and sums.

use crate::numerics::quadrature::running_integral;
use rustfft::{FftPlanner, num_complex::Complex};
use std::f64::consts::TAU;

/// How the curve between samples is taken.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum IntegrationRule {
    /// Straight lines.
    Trapezoid,
    /// Straight lines, less h²/12 of the change of slope (27).
    #[default]
    CorrectedTrapezoid,
    /// Parabolas over pairs of intervals.
    Simpson,
    /// A cubic spline, its end slopes of fourth order.
    CubicSpline,
    /// Sines of a period that the record is taken for.
    Spectral,
}

impl IntegrationRule {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Trapezoid, Self::CorrectedTrapezoid, Self::Simpson, Self::CubicSpline, Self::Spectral];

    /// Its name.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Trapezoid => "trapezoid",
            Self::CorrectedTrapezoid => "corrected trapezoid",
            Self::Simpson => "Simpson",
            Self::CubicSpline => "cubic spline",
            Self::Spectral => "spectral",
        }
    }
}

/// In what a sum is kept.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Summation {
    /// Single precision.
    F32,
    /// Double precision.
    #[default]
    F64,
    /// Double precision, and what each addition rounded off (Neumaier 1974).
    Compensated,
}

impl Summation {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::F32, Self::F64, Self::Compensated];

    /// Its name.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
            Self::Compensated => "f64, compensated",
        }
    }

    /// The partial sums of `terms`, one for each.
    pub fn partial_sums<'a>(
        self,
        terms: impl Iterator<Item = f64> + 'a,
    ) -> Box<dyn Iterator<Item = f64> + 'a> {
        match self {
            #[allow(clippy::cast_possible_truncation, reason = "single precision is what is asked for")]
            Self::F32 => Box::new(terms.scan(0.0_f32, |sum, term| {
                *sum += term as f32;
                Some(f64::from(*sum))
            })),
            Self::F64 => Box::new(terms.scan(0.0, |sum, term| {
                *sum += term;
                Some(*sum)
            })),
            Self::Compensated => Box::new(terms.scan((0.0_f64, 0.0), |(sum, lost), term| {
                let next = *sum + term;
                let (large, small) = if sum.abs() >= term.abs() { (*sum, term) } else { (term, *sum) };
                *lost += (large - next) + small;
                *sum = next;
                Some(*sum + *lost)
            })),
        }
    }
}

/// Running integral; entry 0 is 0, same length as `samples`. With both defaults it is `running_integral`.
#[must_use]
pub fn running_integral_by(
    rule: IntegrationRule,
    summation: Summation,
    samples: &[f64],
    step: f64,
) -> Vec<f64> {
    let n = samples.len();
    if n < 5 || (rule == IntegrationRule::CorrectedTrapezoid && summation == Summation::F64) {
        // Fewer than 5 samples do not tell a spline's end slopes, nor one rule from the other.
        return running_integral(samples, step);
    }
    let trapezoids = samples.windows(2).map(|w| 0.5 * step * (w[0] + w[1]));
    match rule {
        IntegrationRule::Trapezoid => from_zero(summation, trapezoids),
        IntegrationRule::CorrectedTrapezoid => {
            corrected(from_zero(summation, trapezoids), &central_slopes(samples), step)
        }
        IntegrationRule::CubicSpline => {
            corrected(from_zero(summation, trapezoids), &spline_slopes(samples), step)
        }
        IntegrationRule::Simpson => from_zero(summation, simpson_parts(samples, step)),
        IntegrationRule::Spectral => spectral(samples, step),
    }
}

fn from_zero(summation: Summation, terms: impl Iterator<Item = f64>) -> Vec<f64> {
    std::iter::once(0.0).chain(summation.partial_sums(terms)).collect()
}

/// V − h/12 (f′_n − f′_0), `slopes` a step   (27)
fn corrected(mut integral: Vec<f64>, slopes: &[f64], step: f64) -> Vec<f64> {
    for (value, slope) in integral.iter_mut().zip(slopes) {
        *value -= step / 12.0 * (slope - slopes[0]);
    }
    integral
}

/// Central differences a step, one-sided at the ends.
fn central_slopes(f: &[f64]) -> Vec<f64> {
    let n = f.len();
    let first = 0.5 * (-3.0 * f[0] + 4.0 * f[1] - f[2]);
    let last = 0.5 * (3.0 * f[n - 1] - 4.0 * f[n - 2] + f[n - 3]);
    let inner = f.windows(3).map(|w| 0.5 * (w[2] - w[0]));
    std::iter::once(first).chain(inner).chain(std::iter::once(last)).collect()
}

/// Slopes a step of the cubic spline: m_(i−1) + 4 m_i + m_(i+1) = 3 (f_(i+1) − f_(i−1)), the end slopes given.
fn spline_slopes(f: &[f64]) -> Vec<f64> {
    let n = f.len();
    let end =
        |at: [f64; 5]| (-25.0 * at[0] + 48.0 * at[1] - 36.0 * at[2] + 16.0 * at[3] - 3.0 * at[4]) / 12.0;
    let mut slopes = vec![0.0; n];
    slopes[0] = end([f[0], f[1], f[2], f[3], f[4]]);
    slopes[n - 1] = -end([f[n - 1], f[n - 2], f[n - 3], f[n - 4], f[n - 5]]);
    // Thomas: the pivots fall to 2 + √3 within a dozen rows.
    let mut pivots = vec![1.0; n];
    let mut above = slopes[0];
    let mut carried = 0.0;
    for i in 1..n - 1 {
        pivots[i] = 4.0 - carried;
        above = (3.0 * (f[i + 1] - f[i - 1]) - above) / pivots[i];
        slopes[i] = above;
        carried = 1.0 / pivots[i];
    }
    for i in (1..n - 1).rev() {
        slopes[i] -= slopes[i + 1] / pivots[i];
    }
    slopes
}

/// ∫ over each interval of the parabola through its pair: h/12 (5 f_0 + 8 f_1 − f_2), then h/12 (−f_0 + 8 f_1 + 5 f_2).
fn simpson_parts(f: &[f64], step: f64) -> impl Iterator<Item = f64> {
    (0..f.len() - 1).map(move |i| {
        let second_of_pair = i % 2 == 1 || i + 2 >= f.len();
        let (near, far, beyond) =
            if second_of_pair { (f[i + 1], f[i], f[i - 1]) } else { (f[i], f[i + 1], f[i + 2]) };
        step / 12.0 * (5.0 * near + 8.0 * far - beyond)
    })
}

/// The mean grows as a line, every other line of the spectrum is divided by iω; exact for what repeats with the record.
#[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
fn spectral(f: &[f64], step: f64) -> Vec<f64> {
    let n = f.len();
    let mut work: Vec<Complex<f64>> = f.iter().map(|x| Complex::new(*x, 0.0)).collect();
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(n).process(&mut work);
    let mean = work[0].re / n as f64;
    work[0] = Complex::new(0.0, 0.0);
    for (k, line) in work.iter_mut().enumerate().skip(1) {
        let turns = if 2 * k < n { k as f64 } else { k as f64 - n as f64 };
        // The line at half the rate has no phase, hence no integral.
        let omega = if 2 * k == n { f64::INFINITY } else { TAU * turns / (n as f64 * step) };
        *line = Complex::new(line.im / omega, -line.re / omega) / n as f64;
    }
    planner.plan_fft_inverse(n).process(&mut work);
    let start = work[0].re;
    work.iter().enumerate().map(|(i, c)| c.re - start + mean * step * i as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_where_theory_says_so() {
        let step = 0.1;
        let x: Vec<f64> = (0..40).map(|i| f64::from(i) * step).collect();
        let cases: [(IntegrationRule, i32); 4] = [
            (IntegrationRule::Trapezoid, 1),
            (IntegrationRule::CorrectedTrapezoid, 2),
            (IntegrationRule::Simpson, 2),
            (IntegrationRule::CubicSpline, 3),
        ];
        for (rule, degree) in cases {
            let f: Vec<f64> = x.iter().map(|x| x.powi(degree)).collect();
            for (x, v) in x.iter().zip(running_integral_by(rule, Summation::F64, &f, step)) {
                // Values up to 60, forty additions.
                assert!((v - x.powi(degree + 1) / f64::from(degree + 1)).abs() < 1e-12, "{rule:?} {x}");
            }
        }
        let wave: Vec<f64> = (0..40).map(|i| (TAU * f64::from(i) / 40.0).cos() + 0.5).collect();
        for (i, v) in
            running_integral_by(IntegrationRule::Spectral, Summation::F64, &wave, step).iter().enumerate()
        {
            let turn = TAU * f64::from(u32::try_from(i).unwrap()) / 40.0;
            assert!((v - (4.0 / TAU * turn.sin() + 0.5 * 4.0 * turn / TAU)).abs() < 1e-13, "{i}");
        }
    }

    #[test]
    fn the_defaults_are_the_programs_integral() {
        let f: Vec<f64> = (0..200).map(|i| (f64::from(i) * 0.05).sin()).collect();
        let ours = running_integral_by(IntegrationRule::default(), Summation::default(), &f, 0.05);
        assert_eq!(ours, running_integral(&f, 0.05));
        let compensated = running_integral_by(IntegrationRule::default(), Summation::Compensated, &f, 0.05);
        // The same rule summed in another order.
        assert!(ours.iter().zip(&compensated).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    #[test]
    fn every_length_is_safe() {
        for rule in IntegrationRule::ALL {
            for summation in Summation::ALL {
                for count in 0..12 {
                    let v = running_integral_by(rule, summation, &vec![2.0; count], 0.5);
                    assert_eq!(v.len(), count);
                    let exact = (0..count).map(|i| f64::from(u32::try_from(i).unwrap()));
                    // 12 additions of numbers near 10 in single precision.
                    assert!(v.iter().zip(exact).all(|(v, e)| (v - e).abs() < 1e-5), "{rule:?} {count} {v:?}");
                }
            }
        }
    }

    #[test]
    fn a_compensated_sum_loses_nothing() {
        let terms = [1.0, 1e17, 1.0, -1e17];
        let last = |s: Summation| s.partial_sums(terms.into_iter()).last();
        assert_eq!(last(Summation::Compensated), Some(2.0));
        assert_ne!(last(Summation::F64), Some(2.0));
    }
}
