//! Draws of the uncertain inputs: quantiles over the angle and of the critical angle, and the bands that hold
//! for nearly all draws.

use super::Fall;
use super::peak::Sample;
use super::uncertain::{CONTACT_LENGTHS, Draw, draw};
use crate::data::{Criterion, MonteCarlo, QuantileCurves, StudyRequest};
use crate::numerics::{as_f64, robust::quantile};
use rayon::prelude::*;

/// Probabilities of the quantiles.
const PROBABILITIES: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];

/// Share of the draws with each contact duration that must lie within their band for an angle to be robust.
///
/// A sixth of 1000 draws gives it with a standard error of 1.2 %: for other draws the share then exceeds 95 %
/// too.
const ROBUST_SHARE: f64 = 0.975;

/// A largest value has neighbours this close, degrees: its error is below 0.1 % if the speed falls by a
/// hundredth per degree.
const FINE_DEG: f64 = 0.1;

/// One draw over the angle.
pub(super) struct Trace {
    /// The criteria for each nominal angle, at the true angle of this draw.
    samples: Vec<Sample>,
    /// Sample at the angle of the request.
    pub own: Sample,
    /// True angle and value of each criterion's maximum.
    pub largest: [(f64, f64); 3],
}

/// Draws from the uncertain inputs of `base`, at nominal `angles_deg` and the angle of the request.
pub(super) fn trace_draws(base: &Fall, request: &StudyRequest, angles_deg: &[f64]) -> Vec<Trace> {
    let trace = |index| trace(&draw(base, &request.uncertain, index), angles_deg, request.angle_deg);
    (0..request.uncertain.draws).into_par_iter().map(trace).collect()
}

/// Distribution of slap-down and critical angle from the uncertain inputs.
pub(super) fn monte_carlo(
    base: &Fall,
    request: &StudyRequest,
    angles_deg: &[f64],
    draws: &[Trace],
) -> MonteCarlo {
    let all: Vec<&Trace> = draws.iter().collect();
    let quantiles = [0, 1, 2].map(|criterion| quantiles(draws, criterion, angles_deg, request.band_percent));
    MonteCarlo {
        model: base.body.model,
        contact: base.contact,
        uncertain: request.uncertain,
        band_percent: request.band_percent,
        angle_deg: angles_deg.to_vec(),
        no_slap_down: draw_share(angles_deg.len(), &all, |traced, j| traced.samples[j].course.is_none()),
        quantiles: quantiles.into(),
    }
}

/// Evaluates one draw at every nominal angle plus its error, kept between 0 and 90°, and finds its largest
/// sample, including those at the outermost angles and at `own_deg`.
fn trace(draw: &Draw, angles_deg: &[f64], own_deg: f64) -> Trace {
    let at = |angle_deg: f64| Sample::predict(&draw.fall, angle_deg);
    let moved = |angle_deg: f64| at((angle_deg + draw.angle_error_deg).clamp(0.0, 90.0));
    let samples: Vec<Sample> = angles_deg.iter().map(|angle_deg| moved(*angle_deg)).collect();
    let own = moved(own_deg);
    let ends = [angles_deg.first(), angles_deg.last()].into_iter().flatten();
    let mut all: Vec<Sample> = ends.map(|angle_deg| at(*angle_deg)).chain([own]).collect();
    all.extend(&samples);
    Trace { samples, own, largest: [0, 1, 2].map(|criterion| largest(&mut all, criterion, at)) }
}

/// True angle and value of the largest sample, with samples added between it and its neighbours until they
/// are [`FINE_DEG`] apart; NaN if there is none.
fn largest(samples: &mut Vec<Sample>, criterion: usize, at: impl Fn(f64) -> Sample) -> (f64, f64) {
    loop {
        samples.sort_by(|a, b| a.angle_deg.total_cmp(&b.angle_deg));
        let value = |i: &usize| samples[*i].critical(criterion);
        let within = (0..samples.len()).rev().filter(|i| samples[*i].course.is_some());
        let Some(i) = within.max_by(|a, b| value(a).total_cmp(&value(b))) else {
            return (f64::NAN, f64::NAN);
        };
        let top = samples[i];
        let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|j| samples.get(j));
        let wide = beside.filter(|s| (s.angle_deg - top.angle_deg).abs() > FINE_DEG);
        let between: Vec<Sample> = wide.map(|s| at(f64::midpoint(s.angle_deg, top.angle_deg))).collect();
        if between.is_empty() {
            return (top.angle_deg, top.critical(criterion));
        }
        samples.extend(between);
    }
}

fn quantiles(draws: &[Trace], criterion: usize, angles_deg: &[f64], band_percent: f64) -> QuantileCurves {
    let columns: Vec<[f64; 5]> = (0..angles_deg.len())
        .into_par_iter()
        .map(|j| {
            let column =
                sort(draws.iter().map(|d| d.samples[j].critical(criterion)).filter(|v| v.is_finite()));
            if 2 * column.len() < draws.len() { [f64::NAN; 5] } else { five_quantiles(&column) }
        })
        .collect();
    // A band must hold for every contact duration within the range.
    let of_length = |length: usize| {
        let alike: Vec<&Trace> = draws.iter().skip(length).step_by(CONTACT_LENGTHS as usize).collect();
        draw_share(angles_deg.len(), &alike, |traced, j| {
            let largest = traced.largest[criterion].1;
            traced.samples[j].critical(criterion) >= largest - band_percent / 100.0 * largest.abs()
        })
    };
    let shares: Vec<Vec<f64>> = (0..CONTACT_LENGTHS as usize).map(of_length).collect();
    let least = |j: usize| shares.iter().map(|of_length| of_length[j]).fold(f64::NAN, f64::min);
    let in_band: Vec<f64> = (0..angles_deg.len()).map(least).collect();
    let quantile = |i: usize| columns.iter().map(|q| q[i]).collect();
    let critical = sort(draws.iter().map(|d| d.largest[criterion].0).filter(|a| a.is_finite()));
    let sizes = sort(draws.iter().map(|d| d.largest[criterion].1).filter(|v| v.is_finite()));
    QuantileCurves {
        criterion: Criterion::ALL[criterion],
        q025: quantile(0),
        q25: quantile(1),
        q50: quantile(2),
        q75: quantile(3),
        q975: quantile(4),
        robust_bands_deg: robust_bands(angles_deg, &in_band),
        in_band,
        critical_angle_deg: five_quantiles(&critical),
        largest: five_quantiles(&sizes),
        critical_counts: counts(&critical, angles_deg),
    }
}

/// The share of the draws for which each of `count` angles `holds`.
fn draw_share(count: usize, draws: &[&Trace], holds: impl Fn(&Trace, usize) -> bool + Sync) -> Vec<f64> {
    let among = |j: usize| draws.iter().filter(|traced| holds(traced, j)).count();
    let share = |j: usize| as_f64(among(j)) / as_f64(draws.len());
    (0..count).into_par_iter().map(share).collect()
}

pub(super) fn sort(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// The quantiles of ascending values; NaN if there are none.
pub(super) fn five_quantiles(ascending: &[f64]) -> [f64; 5] {
    PROBABILITIES.map(|probability| quantile(ascending, probability))
}

/// Counts the critical angles that are nearest to each of the angles.
fn counts(critical_deg: &[f64], angles_deg: &[f64]) -> Vec<u32> {
    let mut counts = vec![0; angles_deg.len()];
    for &angle_deg in critical_deg {
        let above = angles_deg.partition_point(|a| *a < angle_deg);
        let distance = |j: usize| angles_deg.get(j).map_or(f64::INFINITY, |a| (a - angle_deg).abs());
        let nearest =
            above.checked_sub(1).filter(|&below| distance(below) <= distance(above)).unwrap_or(above);
        if let Some(count) = counts.get_mut(nearest) {
            *count += 1;
        }
    }
    counts
}

/// The runs of angles at which enough draws lie in their band, from the first to the last of each.
fn robust_bands(angles_deg: &[f64], in_band: &[f64]) -> Vec<(f64, f64)> {
    let marks: Vec<(f64, bool)> = angles_deg
        .iter()
        .zip(in_band)
        .map(|(&angle_deg, &share)| (angle_deg, share >= ROBUST_SHARE))
        .collect();
    let runs = marks.chunk_by(|a, b| a.1 == b.1).filter(|run| run[0].1);
    runs.map(|run| (run[0].0, run[run.len() - 1].0)).collect()
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are handed through, not computed")]
mod tests {
    use super::super::tests::{cask_file, request, rough_rod, steps, uncertain};
    use super::*;
    use crate::data::{Contact, Uncertain};

    const DRAWS: u32 = 1000;

    fn summarize(uncertain: Uncertain, angles_deg: Vec<f64>) -> MonteCarlo {
        let asked = StudyRequest { uncertain, ..request(vec![Contact::Rough], vec![0.5], angles_deg) };
        let draws = trace_draws(&rough_rod(0.0), &asked, &asked.angles_deg);
        monte_carlo(&rough_rod(0.0), &asked, &asked.angles_deg, &draws)
    }

    fn speed(k: f64, angle_deg: f64) -> f64 {
        rough_rod(k).predict(angle_deg).slap_down_speed_m_s.expect("R strikes")
    }

    /// Five standard errors of the probability of a quantile of the draws.
    fn error(probability: f64) -> f64 {
        5.0 * (probability * (1.0 - probability) / f64::from(DRAWS)).sqrt()
    }

    #[test]
    fn with_k_alone_uncertain_quantiles_are_those_of_k() {
        let found = summarize(uncertain((0.1, 0.9), DRAWS), vec![15.0]);
        let speeds = &found.quantiles[0];
        let columns = [&speeds.q025, &speeds.q25, &speeds.q50, &speeds.q75, &speeds.q975];
        for (column, probability) in columns.into_iter().zip(PROBABILITIES) {
            // The speed of a rough rod at 15° grows with k: its quantile is the speed at the quantile of k.
            let at = |p: f64| speed(0.1 + 0.8 * p.clamp(0.0, 1.0), 15.0);
            let margin = error(probability);
            assert!(column[0] > at(probability - margin) - 1e-9, "{} {probability}", column[0]);
            assert!(column[0] < at(probability + margin) + 1e-9, "{} {probability}", column[0]);
        }
        assert_eq!(found.no_slap_down, [0.0]);
    }

    #[test]
    fn with_the_angle_alone_uncertain_quantiles_are_those_of_the_angle() {
        let found = summarize(Uncertain { angle_deg: 1.96, ..uncertain((0.5, 0.5), DRAWS) }, steps(30, 30.0));
        let speeds = &found.quantiles[0];
        // The speed of a rough rod with k = 0.5 at 30° falls with the angle: its 2.5 % quantile is at the
        // angle's 97.5 %, 1.96° above; 5 standard errors of that probability reach from 1.40 to 3.1 standard
        // deviations of 1°.
        assert!(
            speeds.q025[30] > speed(0.5, 33.1) && speeds.q025[30] < speed(0.5, 31.4),
            "{}",
            speeds.q025[30]
        );
        assert!(
            speeds.q975[30] < speed(0.5, 26.9) && speeds.q975[30] > speed(0.5, 28.6),
            "{}",
            speeds.q975[30]
        );
        // The critical angle is that of the true angle: no draw moves it by more than the samples are apart.
        let [low, .., high] = speeds.critical_angle_deg;
        assert!(high - low <= 2.0 * FINE_DEG, "{low} {high}");
    }

    #[test]
    fn without_uncertainty_every_draw_is_the_curve() {
        let angles_deg = steps(180, 90.0);
        let found = summarize(uncertain((0.3, 0.3), 10), angles_deg.clone());
        let speeds = &found.quantiles[0];
        for (j, &angle_deg) in angles_deg.iter().enumerate() {
            let prediction = rough_rod(0.3).predict(angle_deg);
            let expected = prediction.slap_down_speed_m_s.filter(|_| prediction.is_single_slap_down());
            assert_eq!(found.no_slap_down[j], f64::from(u8::from(expected.is_none())));
            assert_eq!(expected.is_none(), speeds.q50[j].is_nan());
            if let Some(speed_m_s) = expected {
                assert_eq!([speeds.q025[j], speeds.q50[j], speeds.q975[j]], [speed_m_s; 3]);
            }
        }
        let (low_deg, high_deg) = (speeds.critical_angle_deg[0], speeds.critical_angle_deg[4]);
        assert_eq!(low_deg.to_bits(), high_deg.to_bits());
        let top = (0..=2000)
            .map(|i| f64::from(i) / 100.0)
            .filter_map(|a| rough_rod(0.3).predict(a).slap_down_speed_m_s.map(|v| (a, v)));
        let top = top.fold((0.0, 0.0), |top, next| if next.1 > top.1 { next } else { top });
        assert!((low_deg - top.0).abs() <= FINE_DEG, "{low_deg} {top:?}");
        assert_eq!(speeds.critical_counts.iter().sum::<u32>(), 10);
        // Without uncertainty the robust bands are the bands.
        for band in &speeds.robust_bands_deg {
            assert!(band.0 <= low_deg && low_deg <= band.1, "{band:?}");
        }
        assert_eq!(speeds.robust_bands_deg.len(), 1);
    }

    #[test]
    fn the_seed_fixes_every_bit_and_another_seed_moves_within_the_error() {
        let file = cask_file(0.0);
        let seeded =
            |seed| summarize(Uncertain { seed, ..super::super::default_uncertain(&file) }, steps(18, 45.0));
        let (first, again, other) = (seeded(7), seeded(7), seeded(8));
        assert_eq!(format!("{first:?}"), format!("{again:?}"));
        let median = |found: &MonteCarlo| found.quantiles[0].q50[6];
        assert!(median(&first).to_bits() != median(&other).to_bits());
        // The median's standard error is half of √(1/n) in probability: 1.6 %; two of them differ by less
        // than 7 of 5 σ.
        let width = first.quantiles[0].q975[6] - first.quantiles[0].q025[6];
        assert!((median(&first) - median(&other)).abs() < 2.0 * error(0.5) * width);
    }

    #[test]
    fn quantiles_are_those_of_type_7() {
        // numpy.quantile([1, 2, 3, 4], [0.025, 0.25, 0.5, 0.75, 0.975]).
        let found = five_quantiles(&[1.0, 2.0, 3.0, 4.0]);
        for (found, expected) in found.into_iter().zip([1.075, 1.75, 2.5, 3.25, 3.925]) {
            assert!((found - expected).abs() < 1e-14);
        }
        assert_eq!(five_quantiles(&[5.0]), [5.0; 5]);
        assert!(five_quantiles(&[])[0].is_nan());
    }

    #[test]
    fn critical_angles_are_counted_at_the_nearest() {
        assert_eq!(counts(&[0.0, 0.4, 0.6, 1.4, 9.0], &[0.0, 1.0, 2.0]), [2, 2, 1]);
        assert!(counts(&[1.0], &[]).is_empty());
    }

    #[test]
    fn robust_bands_end_at_angles_with_enough_draws() {
        let angles_deg = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(robust_bands(&angles_deg, &[0.96, 1.0, 0.98, 0.0, 1.0, 0.5]), [(1.0, 2.0), (4.0, 4.0)]);
        assert!(robust_bands(&angles_deg[..1], &[f64::NAN]).is_empty());
    }

    #[test]
    fn a_band_holds_for_each_length_of_the_contact() {
        let open = Uncertain { contact_s: (0.005, 0.03), ..uncertain((0.5, 0.5), 12) };
        let found = summarize(open, steps(45, 45.0));
        let bands = &found.quantiles[0].robust_bands_deg;
        assert_eq!(bands.len(), 1, "{bands:?}");
        for lasts_s in [0.005, 0.01, 0.02, 0.03] {
            let mut fall = rough_rod(0.5);
            fall.drop.contact_duration_s = lasts_s;
            let at =
                |tenths: u32| fall.predict(f64::from(tenths) / 10.0).slap_down_speed_m_s.expect("R strikes");
            let largest = (0..450).map(at).fold(0.0, f64::max);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "tenths of 45°")]
            let [from, to] = [bands[0].0, bands[0].1].map(|angle_deg| (10.0 * angle_deg) as u32);
            // A draw's largest value may lack 0.1 %.
            let least = (from..=to).map(at).fold(f64::INFINITY, f64::min);
            assert!(least >= (0.95 - 0.001) * largest, "{lasts_s}: {least} {largest} {bands:?}");
        }
    }
}
