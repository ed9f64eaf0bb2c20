//! Fits noisy series by plateau, drift and damped modes, by variable projection.

mod common_step;
mod covariance;
mod drive;
mod projection;
mod ringing;
mod seeds;
mod series;

pub use covariance::describe;
use projection::refine;
use seeds::best_seed;

pub use common_step::CommonStep;
pub use drive::{Drive, Form};
pub use ringing::{rate, uniform_ringing};
pub use seeds::Seeds;
pub use series::{Fit, Oscillation, Series, SeriesFit};

/// Largest damping of a mode: bolted and welded structures have 0.5 to 8 %, and an oscillation that dies
/// within a period can fit anything.
const MOST_DAMPING: f64 = 0.15;

/// Fits with `start.len() + 1` modes, the new one the best of `seeds`, or with `start` alone if there are no
/// seeds.
///
/// `None` if a series has fewer points than unknowns or the fit is singular.
pub fn fit(series: &[Series], start: &[Oscillation], seeds: Option<&Seeds>, form: Form) -> Option<Fit> {
    let mut modes = start.to_vec();
    if let Some(seeds) = seeds {
        modes.push(best_seed(start, seeds, form)?);
    }
    if !modes.is_empty() {
        let refined = refine(series, &modes, form);
        let is_mode = |m: &Oscillation| m.damping < MOST_DAMPING && seeds.is_none_or(|s| s.is_near(m));
        // A refinement that leaves the bounds misses another mode: the seeds are kept until that one is found
        // too.
        if let Some(refined) = refined.filter(|r| r.iter().all(is_mode)) {
            modes = refined;
        }
    }
    describe(series, modes, form)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Two series of 60 ms with a 62 Hz and a 170 Hz mode, and a small deterministic disturbance.
    fn ringing(modes: &[Oscillation], drift: f64) -> Vec<Series> {
        [(20.0_f64, 3.0), (-7.0, 2.0)]
            .into_iter()
            .map(|(plateau, size)| {
                let time_s: Vec<f64> = (0..240).map(|i| f64::from(i) * 2.5e-4).collect();
                let value = time_s
                    .iter()
                    .enumerate()
                    .map(|(i, &t)| {
                        let ring: f64 = modes
                            .iter()
                            .map(|m| {
                                let w = TAU * m.frequency_hz;
                                size * (-m.damping * w * t).exp() * (w * t + 0.7).cos()
                            })
                            .sum();
                        let mut hash =
                            (i as u64 + 1 + (plateau.to_bits() >> 40)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                        hash ^= hash >> 29;
                        hash = hash.wrapping_mul(0xBF58_476D_1CE4_E5B9);
                        hash ^= hash >> 32;
                        let hash = f64::from((hash & 0xFFFF) as u16) / 65536.0 - 0.5;
                        plateau + drift * t + ring + 0.002 * hash
                    })
                    .collect();
                Series { time_s, value, steps_s: vec![], floor: 1e-3 }
            })
            .collect()
    }

    #[test]
    fn one_mode_is_found_and_taken_off() {
        let truth = [Oscillation { frequency_hz: 62.0, damping: 0.02 }];
        let series = ringing(&truth, 0.0);
        let fit = fit(&series, &[], Some(&Seeds::new(&series, (20.0, 600.0), None)), Form::free(false))
            .expect("a fit");
        assert!((fit.modes[0].frequency_hz - 62.0).abs() < 0.05, "{fit:?}");
        // The disturbance has 6e-4 RMS over 240 points: 1e-4 is three of its standard errors.
        assert!((fit.series[0].plateau - 20.0).abs() < 2e-4, "{}", fit.series[0].plateau);
        assert!((fit.series[1].plateau + 7.0).abs() < 2e-4);
        assert!(fit.series[0].u_plateau < 3e-4);
    }

    #[test]
    fn what_oscillates_fast_is_left_but_not_slowly() {
        let left = |change: fn(f64) -> f64| {
            let mut series = ringing(&[], 0.0);
            for s in &mut series {
                s.value.iter_mut().zip(&s.time_s).for_each(|(value, t)| *value += change(*t));
            }
            let fit = fit(&series, &[], None, Form::free(false)).expect("a line");
            (fit.series[0].residual, fit.series[0].slow_residual)
        };
        // A sine of 600 Hz has 1.5 periods in a 24th of 60 ms, of which the mean is 2/3π times half of it.
        let (fast, slow) = left(|t| (TAU * 600.0 * t).sin());
        assert!((fast - 0.5_f64.sqrt()).abs() < 0.01 && (slow - 0.212).abs() < 0.02, "{fast}, {slow}");
        let (step, slow) = left(|t| if t > 0.03 { 1.0 } else { 0.0 });
        assert!((step - 0.5).abs() < 0.01 && (slow - step).abs() < 0.01, "{step}, {slow}");
    }

    #[test]
    fn the_criterion_counts_the_modes() {
        let two = [
            Oscillation { frequency_hz: 62.0, damping: 0.02 },
            Oscillation { frequency_hz: 170.0, damping: 0.01 },
        ];
        for (truth, expected) in [(&two[..0], 0), (&two[..1], 1), (&two[..2], 2)] {
            let series = ringing(truth, 0.0);
            let mut fits = vec![fit(&series, &[], None, Form::free(false)).expect("a line")];
            while fits.len() < 4 {
                let start = fits[fits.len() - 1].modes.clone();
                let Some(next) =
                    fit(&series, &start, Some(&Seeds::new(&series, (20.0, 600.0), None)), Form::free(false))
                else {
                    break;
                };
                fits.push(next);
            }
            let richest = fits[fits.len() - 1].correlation;
            let best = (0..fits.len())
                .min_by(|&a, &b| fits[a].bic(&series, richest).total_cmp(&fits[b].bic(&series, richest)));
            let scores: Vec<_> =
                fits.iter().map(|f| (f.bic(&series, richest), f.modes.clone(), f.correlation)).collect();
            assert_eq!(best, Some(expected), "{scores:?}");
        }
    }

    #[test]
    fn a_jump_in_a_gap_is_given_back() {
        let mut series = ringing(&[Oscillation { frequency_hz: 62.0, damping: 0.02 }], 0.0);
        let Series { time_s, value, .. } = &mut series[0];
        for (t, v) in time_s.iter().zip(value) {
            *v += if *t > 0.03 { 1.5 } else { 0.0 };
        }
        series[0].steps_s = vec![0.03];
        let fit = fit(&series, &[], Some(&Seeds::new(&series, (20.0, 600.0), None)), Form::free(false))
            .expect("a fit");
        assert!((fit.series[0].jumps[0] - 1.5).abs() < 1e-3);
        assert!((fit.series[0].plateau - 20.0).abs() < 1e-3);
    }

    #[test]
    fn too_few_points_are_no_fit() {
        let series =
            vec![Series { time_s: vec![0.0, 1.0], value: vec![1.0, 1.0], steps_s: vec![], floor: 1.0 }];
        assert!(fit(&series, &[], None, Form::free(false)).is_none());
    }
}
