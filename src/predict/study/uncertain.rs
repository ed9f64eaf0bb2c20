//! What is not known before a test to its default ranges, and to casks and drops drawn from them.

use super::{Fall, raised, resized};
use crate::data::shown::rounded;
use crate::data::{CaskFile, Contact, StudyRequest, Uncertain};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// Standard deviations in the half-width that holds 95 % of a normal distribution.
const SIGMAS_OF_95: f64 = 1.959_963_984_540_054;

/// Least share of a length or inertia that a draw leaves: far out of reach of any half-width that a cask file
/// would state.
const LEAST_SHARE: f64 = 0.1;

/// Curves are drawn at every half degree: finer than a drop can be rigged.
const CURVE_ANGLES: u32 = 180;

/// What a study is asked of a cask file alone: the four borderline cases at its angle, curves from 0 to 90°.
pub fn usual_request(cask_file: &CaskFile) -> StudyRequest {
    let usual = default_uncertain(cask_file);
    // Rough and smooth bound the table; what is drawn has the contact of the cask file.
    let friction = match cask_file.contact {
        Contact::Coulomb(coefficient) => Some((coefficient, coefficient)),
        Contact::Smooth => Some((0.0, 0.0)),
        Contact::Rough | Contact::Unknown => usual.friction,
    };
    StudyRequest {
        contacts: vec![Contact::Rough, Contact::Smooth],
        ks: vec![0.0, 1.0],
        angle_deg: rounded(cask_file.drop.angle_rad.to_degrees()),
        sweeps: Vec::new(),
        angles_deg: (0..=CURVE_ANGLES)
            .map(|i| rounded(90.0 * f64::from(i) / f64::from(CURVE_ANGLES)))
            .collect(),
        band_percent: 5.0,
        uncertain: Uncertain { friction, ..usual },
    }
}

/// Ranges and half-widths for a cask whose user states none.
pub fn default_uncertain(cask_file: &CaskFile) -> Uncertain {
    let is_uniform =
        !cask_file.cask.is_body || cask_file.defaults.iter().any(|key| key == "cask.inertia_kg_m2");
    Uncertain {
        // Unknown before a test: the borderline cases of [P].
        k: (0.0, 1.0),
        // The contact law asked for.
        friction: None,
        // Inclinometer ±0.5°, and as much again for the release. It can be worse: a test of Sandia's matched
        // at 13° for 10°.
        angle_deg: 1.0,
        // 2.5 cm of 9 m, as for the measured impact velocity.
        drop_height: 0.003,
        // 2.5 cm of 5 m: where on its rounded or padded edge an end strikes.
        size: 0.005,
        // 5 cm of 5 m: weighed at two points, the contents within their clearance.
        cog: 0.01,
        // Twice the standard uncertainties of the comparison with a test: 1 % stated, 5 % for the uniform
        // block.
        inertia: if is_uniform { 0.1 } else { 0.02 },
        // The 2.5 % quantile then has a standard error of 0.5 % in probability.
        draws: 1000,
        seed: 1,
    }
}

/// One cask and drop out of the uncertain ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw {
    pub fall: Fall,
    /// What the true angle is above the nominal one, degrees.
    pub angle_error_deg: f64,
}

/// The draw of this index: k and friction uniform, all else normal. It depends on the seed and its index
/// alone, on any machine.
pub(super) fn draw(base: &Fall, uncertain: &Uncertain, index: u32) -> Draw {
    let mut rng = ChaCha8Rng::seed_from_u64(uncertain.seed);
    rng.set_stream(u64::from(index));
    // Every number is drawn whether it is used or not, so that one more uncertain input leaves the others as
    // they were.
    let (k_share, friction_share) = (rng.random::<f64>(), rng.random::<f64>());
    let mut normal = |half_width: f64| {
        let z: f64 = StandardNormal.sample(&mut rng);
        half_width / SIGMAS_OF_95 * z
    };
    let (length, height) = (normal(uncertain.size), normal(uncertain.size));
    let (cog, inertia) = (normal(uncertain.cog), normal(uncertain.inertia));
    let (drop_height, angle_error_deg) = (normal(uncertain.drop_height), normal(uncertain.angle_deg));
    let scaled = |value: f64, by: f64| value * (1.0 + by).max(LEAST_SHARE);
    let between = |(low, high): (f64, f64), share: f64| low + (high - low) * share;
    let mut body =
        resized(&base.body, scaled(base.body.length_m, length), scaled(base.body.height_m, height));
    body.cog_m = (body.cog_m + cog * body.length_m).clamp(0.0, body.length_m);
    body.inertia_kg_m2 = scaled(body.inertia_kg_m2, inertia);
    let contact =
        uncertain.friction.map_or(base.contact, |range| Contact::Coulomb(between(range, friction_share)));
    let drop = raised(&base.drop, scaled(base.drop.height_m, drop_height));
    Draw { fall: Fall { body, drop, contact, k: between(uncertain.k, k_share) }, angle_error_deg }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are handed through, not computed")]
mod tests {
    use super::super::tests::{cask_file, rough_rod, uncertain};
    use super::*;

    const DRAWS: u32 = 2000;

    fn all(base: &Fall, of: &Uncertain) -> Vec<Draw> {
        (0..DRAWS).map(|i| draw(base, of, i)).collect()
    }

    /// Mean and standard deviation.
    fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
        let n = f64::from(DRAWS);
        let mean = values.clone().sum::<f64>() / n;
        (mean, (values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
    }

    #[test]
    fn a_uniform_or_unstated_inertia_is_less_certain() {
        let mut file = cask_file(0.792);
        assert!((default_uncertain(&file).inertia - 0.02).abs() < 1e-15);
        file.defaults.push("cask.inertia_kg_m2".into());
        assert!((default_uncertain(&file).inertia - 0.1).abs() < 1e-15);
        assert!((default_uncertain(&cask_file(0.0)).inertia - 0.1).abs() < 1e-15);
    }

    #[test]
    fn what_is_certain_stays_as_it_is() {
        let base = rough_rod(0.0);
        for Draw { fall, angle_error_deg } in all(&base, &uncertain((0.3, 0.3), DRAWS)) {
            assert_eq!((fall.body, fall.drop, fall.contact), (base.body, base.drop, base.contact));
            assert_eq!((fall.k, angle_error_deg), (0.3, 0.0));
        }
    }

    #[test]
    fn half_widths_hold_95_percent_and_ranges_are_filled_evenly() {
        let uncertain = Uncertain {
            k: (0.2, 0.8),
            friction: Some((0.1, 0.3)),
            angle_deg: 1.96,
            drop_height: 0.0196,
            size: 0.0392,
            cog: 0.0,
            inertia: 0.0,
            ..uncertain((0.0, 1.0), DRAWS)
        };
        let base = rough_rod(0.0);
        let draws = all(&base, &uncertain);
        // Five standard errors of a mean, σ/√n, and of a standard deviation, σ/√(2n).
        let error = 5.0 / f64::from(DRAWS).sqrt();
        let check = |(mean, deviation): (f64, f64), expected: f64, sigma: f64| {
            assert!((mean - expected).abs() < error * sigma, "{mean} {expected}");
            assert!((deviation / sigma - 1.0).abs() < error, "{deviation} {sigma}");
        };
        check(moments(draws.iter().map(|d| d.angle_error_deg)), 0.0, 1.0);
        check(moments(draws.iter().map(|d| d.fall.drop.height_m)), 9.0, 0.09);
        check(moments(draws.iter().map(|d| d.fall.body.length_m)), 5.512, 0.02 * 5.512);
        check(moments(draws.iter().map(|d| d.fall.k)), 0.5, 0.6 / 12.0_f64.sqrt());
        assert!(draws.iter().all(|d| (0.2..0.8).contains(&d.fall.k)));
        let mu = |d: &Draw| if let Contact::Coulomb(mu) = d.fall.contact { mu } else { f64::NAN };
        assert!(draws.iter().all(|d| (0.1..0.3).contains(&mu(d))));
    }

    #[test]
    fn one_more_uncertain_input_leaves_the_others_as_drawn() {
        let base = rough_rod(0.0);
        let few = Uncertain { angle_deg: 1.0, ..uncertain((0.0, 1.0), 1) };
        let more = Uncertain { inertia: 0.1, friction: Some((0.0, 1.0)), ..few };
        for i in 0..10 {
            let (a, b) = (draw(&base, &few, i), draw(&base, &more, i));
            assert_eq!((a.fall.k, a.angle_error_deg), (b.fall.k, b.angle_error_deg));
            assert!(a.fall.body.inertia_kg_m2 != b.fall.body.inertia_kg_m2);
        }
    }

    #[test]
    fn the_draws_are_those_of_every_machine() {
        // ChaCha8 is defined bit by bit; a change of these numbers changes everybody's results.
        let found = draw(&rough_rod(0.0), &uncertain((0.0, 1.0), 1), 0).fall.k;
        let again = draw(&rough_rod(0.0), &uncertain((0.0, 1.0), 1), 1).fall.k;
        assert_eq!((found, again), (0.402_485_663_664_848_06, 0.851_912_160_844_185_2));
    }

    #[test]
    fn nonsensical_half_widths_leave_a_body() {
        let drawn =
            Uncertain { size: 3.0, cog: 3.0, inertia: 3.0, drop_height: 3.0, ..uncertain((0.0, 1.0), 1) };
        for Draw { fall, .. } in all(&rough_rod(0.0), &drawn) {
            assert!(fall.body.length_m > 0.0 && fall.body.inertia_kg_m2 > 0.0 && fall.drop.height_m > 0.0);
            assert!((0.0..=fall.body.length_m).contains(&fall.body.cog_m));
        }
    }
}
