//! Samples or a function to integrals.

/// Running integral of uniform samples by the trapezoid with end correction; entry 0 is 0, same length as
/// `samples`.
///
/// V_n = h (f_0/2 + f_1 + … + f_n/2) − h²/12 (f′_n − f′_0)   (27), with slopes by central differences,
/// one-sided at the ends.
pub fn running_integral(samples: &[f64], step: f64) -> Vec<f64> {
    const TOGETHER: usize = 8;
    let n = samples.len();
    let mut integral = Vec::with_capacity(n);
    if n < 3 {
        integral
            .extend([0.0, step * (samples.first().unwrap_or(&0.0) + samples.last().unwrap_or(&0.0)) / 2.0]);
        integral.truncate(n);
        return integral;
    }
    // Slopes are in units of value per step, doubled.
    let first_slope = -3.0 * samples[0] + 4.0 * samples[1] - samples[2];
    let last_slope = 3.0 * samples[n - 1] - 4.0 * samples[n - 2] + samples[n - 3];
    let at = |doubled_sum: f64, slope: f64| 0.5 * step * (doubled_sum - (slope - first_slope) / 12.0);
    let mut doubled_sum = 0.0;
    integral.push(0.0);
    // Several steps are summed before they are added to the total, whose previous value they wait for.
    for own in samples.windows(TOGETHER + 2).step_by(TOGETHER) {
        let mut since = 0.0;
        integral.extend(own.windows(3).map(|w| {
            since += w[0] + w[1];
            at(doubled_sum + since, w[2] - w[0])
        }));
        doubled_sum += since;
    }
    for w in samples[integral.len() - 1..].windows(3) {
        doubled_sum += w[0] + w[1];
        integral.push(at(doubled_sum, w[2] - w[0]));
    }
    doubled_sum += samples[n - 2] + samples[n - 1];
    integral.push(at(doubled_sum, last_slope));
    integral
}

/// Integral of `f` over `low..high` by Simpson's rule with `panels` pairs of intervals.
pub fn simpson(f: impl Fn(f64) -> f64, low: f64, high: f64, panels: u32) -> f64 {
    let step = (high - low) / f64::from(2 * panels);
    let inner: f64 =
        (1..2 * panels).map(|i| f(low + f64::from(i) * step) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    step / 3.0 * (f(low) + inner + f(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_half_sine_integrates_to_its_area_along_the_way() {
        // 10 ms half sine at 10 kHz: the plain trapezoid is off by 1e-4 of the area on the way, the corrected
        // by h⁴.
        let (n, step) = (101, 1e-4);
        let pulse: Vec<f64> = (0..n).map(|i| (PI * f64::from(i) / 100.0).sin()).collect();
        let running = running_integral(&pulse, step);
        for (i, value) in (0..n).zip(&running) {
            let exact = 0.01 / PI * (1.0 - (PI * f64::from(i) / 100.0).cos());
            assert!((value - exact).abs() < 1e-6 * 0.02 / PI, "{i}: {value} {exact}");
        }
    }

    #[test]
    fn short_inputs_are_safe() {
        assert!(running_integral(&[], 1.0).is_empty());
        assert_eq!(running_integral(&[5.0], 1.0), [0.0]);
        assert_eq!(running_integral(&[1.0, 3.0], 1.0), [0.0, 2.0]);
    }

    #[test]
    fn simpson_is_exact_for_cubics() {
        assert!((simpson(|x| x * x * x, 0.0, 2.0, 1) - 4.0).abs() < 1e-14);
    }
}
