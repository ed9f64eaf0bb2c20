//! Draws of the uncertain inputs to quantiles over the angle, of the critical angle, and the bands that hold
//! for nearly all.

use super::peak::{Sample, bands};
use super::uncertain::{Draw, draw};
use super::{Fall, richest};
use crate::data::{CaskFile, Criterion, MonteCarlo, QuantileCurves, StudyRequest};
use crate::numerics::{as_f64, robust::quantile};
use rayon::prelude::*;

/// Probabilities of the quantiles.
const PROBABILITIES: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];

/// Share of the draws that must lie within their band for an angle to be robust.
const ROBUST_SHARE: f64 = 0.95;

/// One draw over the angle.
struct Traced {
    /// The criteria for each nominal angle, at the true angle of this draw.
    samples: Vec<Sample>,
    /// True angle and size of each criterion's largest value.
    largest: [(f64, f64); 3],
}

/// What the uncertain inputs make of slap-down and critical angle of the richest body, at nominal
/// `angles_deg`.
pub(super) fn monte_carlo(cask_file: &CaskFile, request: &StudyRequest, angles_deg: &[f64]) -> MonteCarlo {
    let uncertain = request.uncertain;
    let contact = request.contacts.first().copied().unwrap_or(cask_file.contact);
    let base = Fall { body: richest(cask_file), drop: cask_file.drop, contact, k: 0.0 };
    let draws: Vec<Traced> = (0..uncertain.draws)
        .into_par_iter()
        .map(|index| trace(&draw(&base, &uncertain, index), angles_deg, request.band_percent))
        .collect();
    let no_slap_down =
        share_of(angles_deg.len(), &draws, |traced, j| traced.samples[j].values[0] == f64::NEG_INFINITY);
    let quantiles = [0, 1, 2].map(|criterion| quantiles(&draws, criterion, angles_deg, request.band_percent));
    MonteCarlo {
        model: base.body.model,
        contact,
        uncertain,
        band_percent: request.band_percent,
        angle_deg: angles_deg.to_vec(),
        no_slap_down,
        quantiles: quantiles.into(),
    }
}

/// One draw at every nominal angle plus its error, kept between 0 and 90°, and where it is largest between
/// the outermost nominal angles.
///
/// The samples at true angles serve both: the vertex of the parabola through the highest and its neighbours
/// is off by less than their spacing squared, far below the scatter of the draws.
fn trace(draw: &Draw, angles_deg: &[f64], band_percent: f64) -> Traced {
    let at = |angle_deg: f64| Sample::new(angle_deg, &draw.fall.at(angle_deg));
    let moved: Vec<Sample> =
        angles_deg.iter().map(|a| at((a + draw.angle_error_deg).clamp(0.0, 90.0))).collect();
    let (Some(&low_deg), Some(&high_deg)) = (angles_deg.first(), angles_deg.last()) else {
        return Traced { samples: moved, largest: [(f64::NAN, f64::NAN); 3] };
    };
    let within = moved.iter().filter(|s| s.angle_deg > low_deg && s.angle_deg < high_deg);
    let mut inside = vec![at(low_deg)];
    inside.extend(within);
    inside.push(at(high_deg));
    let largest = [0, 1, 2].map(|criterion| largest(&inside, criterion, band_percent));
    Traced { samples: moved, largest }
}

/// True angle and size of the largest of the samples with one impact of L, the angle by a parabola; NaN if
/// there is none. Its neighbours, as far off as the angle of a drop is known, lie within the band: a maximum
/// that no rig hits is none, nor is its flank.
fn largest(samples: &[Sample], criterion: usize, band_percent: f64) -> (f64, f64) {
    let value = |i: usize| samples[i].critical(criterion);
    let is_maximum = |i: &usize| {
        let beside =
            samples[i.saturating_sub(1)..samples.len().min(i + 2)].iter().filter(|s| s.course.is_some());
        let in_band = |v: f64| v <= value(*i) && v >= value(*i) * (1.0 - band_percent / 100.0);
        samples[*i].course.is_some() && beside.map(|s| s.critical(criterion)).all(in_band)
    };
    let maxima = (0..samples.len()).rev().filter(is_maximum);
    let Some(top) = maxima.max_by(|a, b| value(*a).total_cmp(&value(*b))) else {
        return (f64::NAN, f64::NAN);
    };
    let around = top.checked_sub(1).and_then(|before| samples.get(before..=top + 1));
    let angle_deg = match around {
        Some([a, b, c]) if a.course == b.course && b.course == c.course => {
            vertex([a, b, c].map(|s| (s.angle_deg, s.values[criterion])))
        }
        _ => samples[top].angle_deg,
    };
    (angle_deg, value(top))
}

/// Where the parabola through three points is highest, if the middle one is the highest of them; else the
/// middle one.
fn vertex([a, b, c]: [(f64, f64); 3]) -> f64 {
    let (left, right) = (b.0 - a.0, c.0 - b.0);
    let (rise, fall) = (right * (b.1 - a.1), left * (b.1 - c.1));
    // x = b + ½ (r² Δ_l − l² Δ_r) / (r Δ_l + l Δ_r), Δ the height of the middle one above its neighbours.
    let weight = rise + fall;
    if weight > 0.0 { b.0 + 0.5 * (right * rise - left * fall) / weight } else { b.0 }
}

fn quantiles(draws: &[Traced], criterion: usize, angles_deg: &[f64], band_percent: f64) -> QuantileCurves {
    let columns: Vec<[f64; 5]> = (0..angles_deg.len())
        .into_par_iter()
        .map(|j| {
            let column =
                sorted(draws.iter().map(|d| d.samples[j].values[criterion]).filter(|v| v.is_finite()));
            if 2 * column.len() < draws.len() { [f64::NAN; 5] } else { quantiles_of(&column) }
        })
        .collect();
    let in_band = share_of(angles_deg.len(), draws, |traced, j| {
        let largest = traced.largest[criterion].1;
        traced.samples[j].critical(criterion) >= largest - band_percent / 100.0 * largest.abs()
    });
    let quantile = |i: usize| columns.iter().map(|q| q[i]).collect();
    let critical = sorted(draws.iter().map(|d| d.largest[criterion].0).filter(|a| a.is_finite()));
    let sizes = sorted(draws.iter().map(|d| d.largest[criterion].1).filter(|v| v.is_finite()));
    QuantileCurves {
        criterion: Criterion::ALL[criterion],
        q025: quantile(0),
        q25: quantile(1),
        q50: quantile(2),
        q75: quantile(3),
        q975: quantile(4),
        robust_bands_deg: robust_bands(angles_deg, &in_band),
        in_band,
        critical_angle_deg: quantiles_of(&critical),
        largest: quantiles_of(&sizes),
        critical_counts: counts(&critical, angles_deg),
    }
}

/// The share of the draws for which each of `count` angles `holds`.
fn share_of(count: usize, draws: &[Traced], holds: impl Fn(&Traced, usize) -> bool + Sync) -> Vec<f64> {
    let among = |j: usize| draws.iter().filter(|traced| holds(traced, j)).count();
    let share = |j: usize| as_f64(among(j)) / as_f64(draws.len());
    (0..count).into_par_iter().map(share).collect()
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// The quantiles of ascending values; NaN of none.
fn quantiles_of(ascending: &[f64]) -> [f64; 5] {
    PROBABILITIES.map(|probability| quantile(ascending, probability))
}

/// How many of the critical angles are nearest to each of the angles.
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

/// Where at least 95 % of the draws lie in their band, the share taken straight between the angles.
fn robust_bands(angles_deg: &[f64], in_band: &[f64]) -> Vec<(f64, f64)> {
    let between = |angle_deg: f64| {
        let i = angles_deg.partition_point(|a| *a < angle_deg).clamp(1, angles_deg.len() - 1);
        let share = (angle_deg - angles_deg[i - 1]) / (angles_deg[i] - angles_deg[i - 1]);
        in_band[i - 1] + (in_band[i] - in_band[i - 1]) * share
    };
    let marks: Vec<(f64, bool)> =
        angles_deg.iter().zip(in_band).map(|(&a, &share)| (a, share >= ROBUST_SHARE)).collect();
    bands(&marks, |angle_deg| between(angle_deg) >= ROBUST_SHARE)
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are handed through, not computed")]
mod tests {
    use super::super::tests::{cask_file, request, rough_rod, steps, uncertain};
    use super::*;
    use crate::data::{Contact, Uncertain};

    const DRAWS: u32 = 1000;

    fn of(uncertain: Uncertain, angles_deg: Vec<f64>) -> MonteCarlo {
        let asked = StudyRequest { uncertain, ..request(vec![Contact::Rough], vec![0.5], angles_deg) };
        monte_carlo(&cask_file(0.0), &asked, &asked.angles_deg)
    }

    fn speed(k: f64, angle_deg: f64) -> f64 {
        rough_rod(k).at(angle_deg).slap_down_speed_m_s.expect("R strikes")
    }

    /// Five standard errors of the probability that a quantile of the draws stands for.
    fn error(probability: f64) -> f64 {
        5.0 * (probability * (1.0 - probability) / f64::from(DRAWS)).sqrt()
    }

    #[test]
    fn with_k_alone_uncertain_quantiles_are_those_of_k() {
        let found = of(uncertain((0.1, 0.9), DRAWS), vec![15.0]);
        let speeds = &found.quantiles[0];
        let columns = [&speeds.q025, &speeds.q25, &speeds.q50, &speeds.q75, &speeds.q975];
        for (column, probability) in columns.into_iter().zip(PROBABILITIES) {
            // At 15° the speed of a rough rod grows with k: its quantile is the speed at the quantile of k.
            let at = |p: f64| speed(0.1 + 0.8 * p.clamp(0.0, 1.0), 15.0);
            let margin = error(probability);
            assert!(column[0] > at(probability - margin) - 1e-9, "{} {probability}", column[0]);
            assert!(column[0] < at(probability + margin) + 1e-9, "{} {probability}", column[0]);
        }
        assert_eq!(found.no_slap_down, [0.0]);
    }

    #[test]
    fn with_the_angle_alone_uncertain_quantiles_are_those_of_the_angle() {
        let found = of(Uncertain { angle_deg: 1.96, ..uncertain((0.5, 0.5), DRAWS) }, steps(30, 30.0));
        let speeds = &found.quantiles[0];
        // At 30° the speed of a rough rod with k = 0.5 falls with the angle: its 2.5 % quantile is at the
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
        // The critical angle is that of the true angle: no draw moves it.
        let [low, .., high] = speeds.critical_angle_deg;
        assert!((0.0..=30.0).contains(&low) && (0.0..=30.0).contains(&high));
    }

    #[test]
    fn without_uncertainty_every_draw_is_the_curve() {
        let angles_deg = steps(180, 90.0);
        let found = of(uncertain((0.3, 0.3), 10), angles_deg.clone());
        let speeds = &found.quantiles[0];
        for (j, &angle_deg) in angles_deg.iter().enumerate() {
            let expected = rough_rod(0.3).at(angle_deg).slap_down_speed_m_s;
            assert_eq!(found.no_slap_down[j], f64::from(u8::from(expected.is_none())));
            assert_eq!(expected.is_none(), speeds.q50[j].is_nan());
            if let Some(speed_m_s) = expected {
                assert_eq!([speeds.q025[j], speeds.q50[j], speeds.q975[j]], [speed_m_s; 3]);
            }
        }
        let (low_deg, high_deg) = (speeds.critical_angle_deg[0], speeds.critical_angle_deg[4]);
        assert_eq!(low_deg.to_bits(), high_deg.to_bits());
        // The parabola's vertex is off by v‴/v″ (0.5°)²/6 or so, far below 0.05°; the samples are 0.5° apart.
        let top = (0..=2000)
            .map(|i| f64::from(i) / 100.0)
            .filter_map(|a| rough_rod(0.3).at(a).slap_down_speed_m_s.map(|v| (a, v)));
        let top = top.fold((0.0, 0.0), |top, next| if next.1 > top.1 { next } else { top });
        assert!((low_deg - top.0).abs() < 0.05, "{low_deg} {top:?}");
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
        let seeded = |seed| of(Uncertain { seed, ..super::super::default_uncertain(&file) }, steps(18, 45.0));
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
        let found = quantiles_of(&[1.0, 2.0, 3.0, 4.0]);
        for (found, expected) in found.into_iter().zip([1.075, 1.75, 2.5, 3.25, 3.925]) {
            assert!((found - expected).abs() < 1e-14);
        }
        assert_eq!(quantiles_of(&[5.0]), [5.0; 5]);
        assert!(quantiles_of(&[])[0].is_nan());
    }

    #[test]
    fn the_vertex_of_a_parabola_is_exact() {
        let at = |x: f64| (x, 7.0 - 0.3 * (x - 2.2).powi(2));
        // Differences of order 1 with roundings of 1e-15.
        assert!((vertex([at(1.0), at(2.0), at(3.5)]) - 2.2).abs() < 1e-13);
        assert!((vertex([(0.0, 1.0), (1.0, 1.0), (2.0, 1.0)]) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn critical_angles_are_counted_at_the_nearest() {
        assert_eq!(counts(&[0.0, 0.4, 0.6, 1.4, 9.0], &[0.0, 1.0, 2.0]), [2, 2, 1]);
        assert!(counts(&[1.0], &[]).is_empty());
    }

    #[test]
    fn robust_bands_end_between_the_angles() {
        let found = robust_bands(&[0.0, 1.0, 2.0, 3.0], &[0.90, 1.0, 1.0, 0.0]);
        assert_eq!(found.len(), 1);
        // 0.95 is half-way from 0.90 to 1, and a twentieth of the way from 1 to 0.
        assert!((found[0].0 - 0.5).abs() < 2e-6 && (found[0].1 - 2.05).abs() < 2e-6, "{found:?}");
    }
}
