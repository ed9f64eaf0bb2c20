//! Uncertain inputs before a test: their ranges and tolerances, and casks and drops drawn from them.

use super::super::impact::strike_first_end;
use super::super::state::State;
use super::{Fall, resize};
use crate::data::shown::round_off;
use crate::data::{CaskFile, Contact, Drop, StudyRequest, Uncertain};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// Standard deviations in the half-width that holds 95 % of a normal distribution.
const SIGMAS_OF_95: f64 = 1.959_963_984_540_054;

/// Least share of a length or inertia in a draw: far beyond any half-width that a cask file would state.
const LEAST_SHARE: f64 = 0.1;

/// Curves are drawn at every half degree: finer than a drop can be rigged.
const CURVE_ANGLES: u32 = 180;

/// Duration of a first contact that nobody states, s: from bare metal to a soft impact limiter.
const CONTACT_S: (f64, f64) = (0.005, 0.03);

/// Number of contact durations, which draws use in turn, evenly from end to end of the range: results can
/// then be required for each duration, including the shortest and the longest.
pub(super) const CONTACT_LENGTHS: u32 = 6;

/// Default request of a study for a cask file alone: the four borderline cases at its angle, curves from 0 to
/// 90°.
pub fn usual_request(cask_file: &CaskFile) -> StudyRequest {
    StudyRequest {
        contacts: vec![Contact::Rough, Contact::Smooth],
        ks: vec![0.0, 1.0],
        angle_deg: round_off(cask_file.drop.angle_rad.to_degrees()),
        sweeps: Vec::new(),
        angles_deg: curve_angles_deg().collect(),
        band_percent: 5.0,
        uncertain: default_uncertain(cask_file),
    }
}

fn curve_angles_deg() -> impl Iterator<Item = f64> {
    (0..=CURVE_ANGLES).map(|i| round_off(90.0 * f64::from(i) / f64::from(CURVE_ANGLES)))
}

/// Ranges of the inputs that a cask file leaves open, and the half-widths of its `[tolerance]`.
pub fn default_uncertain(cask_file: &CaskFile) -> Uncertain {
    let CaskFile { cask, tolerances, contact_duration_s, .. } = cask_file;
    Uncertain {
        // The range before a test covers the borderline cases of [P].
        k: (0.0, 1.0),
        friction: match cask_file.contact {
            Contact::Rough => None,
            Contact::Smooth => Some((0.0, 0.0)),
            Contact::Coulomb(coefficient) => Some((coefficient, coefficient)),
            Contact::Unknown => Some((0.0, friction_that_sticks(cask_file))),
        },
        contact_s: contact_duration_s.map_or(CONTACT_S, |lasts_s| (lasts_s, lasts_s)),
        angle_deg: round_off(tolerances.angle_rad.to_degrees()),
        impact_velocity: tolerances.impact_velocity,
        angular_velocity_deg_s: round_off(tolerances.angular_velocity_rad_s.to_degrees()),
        horizontal_velocity_m_s: tolerances.horizontal_velocity_m_s,
        length: tolerances.length,
        height: tolerances.height,
        cog: tolerances.cog_m / cask.length_m,
        inertia: tolerances.inertia,
        // With this number the 2.5 % quantile has a standard error of 0.5 % in probability.
        draws: 1000,
        seed: 1,
    }
}

/// The friction with which the first end sticks at every angle   (6)
fn friction_that_sticks(cask_file: &CaskFile) -> f64 {
    let body = super::richest_body(cask_file);
    let needed = curve_angles_deg().map(|angle_deg| {
        let before = State::falling(&body, angle_deg.to_radians(), &cask_file.drop);
        strike_first_end(&body, &before, Contact::Rough, 0.0).friction_to_stick
    });
    (needed.fold(0.0, f64::max) * 100.0).ceil() / 100.0
}

/// One cask and drop drawn from the uncertain inputs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw {
    pub fall: Fall,
    /// True angle less the nominal one, degrees.
    pub angle_error_deg: f64,
}

/// The draw of this index: k and friction uniform, the contact's duration in turn, everything else normal. It
/// depends on the seed and its index alone, on any machine.
pub(super) fn draw(base: &Fall, uncertain: &Uncertain, index: u32) -> Draw {
    let mut rng = ChaCha8Rng::seed_from_u64(uncertain.seed);
    rng.set_stream(u64::from(index));
    // Every number is drawn, used or not, so that one more uncertain input leaves the others unchanged.
    let (k_share, friction_share) = (rng.random::<f64>(), rng.random::<f64>());
    let mut normal = |half_width: f64| {
        let z: f64 = StandardNormal.sample(&mut rng);
        half_width / SIGMAS_OF_95 * z
    };
    let (length, height) = (normal(uncertain.length), normal(uncertain.height));
    let (cog, inertia) = (normal(uncertain.cog), normal(uncertain.inertia));
    let (impact_velocity, angle_error_deg) = (normal(uncertain.impact_velocity), normal(uncertain.angle_deg));
    let turned_rad_s = normal(uncertain.angular_velocity_deg_s).to_radians();
    let sideways_m_s = normal(uncertain.horizontal_velocity_m_s);
    let contact_share = f64::from(index % CONTACT_LENGTHS) / f64::from(CONTACT_LENGTHS - 1);
    let scaled = |value: f64, by: f64| value * (1.0 + by).max(LEAST_SHARE);
    let between = |(low, high): (f64, f64), share: f64| low + (high - low) * share;
    let mut body = resize(&base.body, scaled(base.body.length_m, length), scaled(base.body.height_m, height));
    body.cog_m = (body.cog_m + cog * body.length_m).clamp(0.0, body.length_m);
    body.inertia_kg_m2 = scaled(body.inertia_kg_m2, inertia);
    let contact =
        uncertain.friction.map_or(base.contact, |range| Contact::Coulomb(between(range, friction_share)));
    let drop = Drop {
        impact_velocity_m_s: scaled(base.drop.impact_velocity_m_s, impact_velocity),
        angular_velocity_rad_s: base.drop.angular_velocity_rad_s + turned_rad_s,
        horizontal_velocity_m_s: base.drop.horizontal_velocity_m_s + sideways_m_s,
        contact_duration_s: between(uncertain.contact_s, contact_share),
        ..base.drop
    };
    Draw { fall: Fall { body, drop, contact, k: between(uncertain.k, k_share) }, angle_error_deg }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are handed through, not computed")]
mod tests {
    use super::super::tests::{V0_M_S, cask_file, rough_rod, uncertain};
    use super::*;
    use crate::data::Tolerances;

    const DRAWS: u32 = 2000;

    fn draw_all(base: &Fall, of: &Uncertain) -> Vec<Draw> {
        (0..DRAWS).map(|i| draw(base, of, i)).collect()
    }

    /// Mean and standard deviation.
    fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
        let n = f64::from(DRAWS);
        let mean = values.clone().sum::<f64>() / n;
        (mean, (values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
    }

    #[test]
    fn what_the_file_states_and_tolerates_is_what_is_drawn_from() {
        let mut file = cask_file(0.792);
        file.tolerances = Tolerances { angle_rad: 0.05, length: 0.02, inertia: 0.15, ..file.tolerances };
        file.tolerances.cog_m = 0.5512;
        let found = default_uncertain(&file);
        let held = [found.angle_deg, found.length, found.inertia, found.cog];
        for (held, stated) in held.into_iter().zip([0.05_f64.to_degrees(), 0.02, 0.15, 0.1]) {
            assert!((held - stated).abs() < 1e-12, "{found:?}");
        }
        assert_eq!((found.friction, found.contact_s), (None, CONTACT_S));
        file.contact_duration_s = Some(0.02);
        file.contact = Contact::Coulomb(0.3);
        let found = default_uncertain(&file);
        assert_eq!((found.friction, found.contact_s), (Some((0.3, 0.3)), (0.02, 0.02)));
    }

    #[test]
    fn an_unknown_friction_reaches_from_none_to_sticking_at_every_angle() {
        let file = CaskFile { contact: Contact::Unknown, ..cask_file(0.0) };
        // μ* of the rod, 3 sin φ cos φ/(1 + 3 sin² φ), is 3/4 at most, where tan φ = 1/2.
        assert_eq!(default_uncertain(&file).friction, Some((0.0, 0.75)));
        for angle_deg in [5.0, 26.6, 60.0] {
            let fall = Fall { contact: Contact::Coulomb(0.75), ..rough_rod(0.5) };
            assert!(fall.predict(angle_deg).sticks, "{angle_deg}");
        }
    }

    #[test]
    fn every_length_of_the_contact_has_its_draws_the_ends_too() {
        let base = rough_rod(0.0);
        let open = Uncertain { contact_s: (0.005, 0.03), ..uncertain((0.0, 1.0), DRAWS) };
        let lasting = |i| draw(&base, &open, i).fall.drop.contact_duration_s;
        for (i, lasts_s) in (0..).zip([0.005, 0.01, 0.015, 0.02, 0.025, 0.03]) {
            assert!((lasting(i) - lasts_s).abs() < 1e-12 && (lasting(i + 60) - lasts_s).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_certain_stays_as_it_is() {
        let base = rough_rod(0.0);
        for Draw { fall, angle_error_deg } in draw_all(&base, &uncertain((0.3, 0.3), DRAWS)) {
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
            impact_velocity: 0.0196,
            angular_velocity_deg_s: 1.96,
            length: 0.0392,
            ..uncertain((0.0, 1.0), DRAWS)
        };
        let base = rough_rod(0.0);
        let draws = draw_all(&base, &uncertain);
        // Five standard errors of a mean, σ/√n, and of a standard deviation, σ/√(2n).
        let error = 5.0 / f64::from(DRAWS).sqrt();
        let check = |(mean, deviation): (f64, f64), expected: f64, sigma: f64| {
            assert!((mean - expected).abs() < error * sigma, "{mean} {expected}");
            assert!((deviation / sigma - 1.0).abs() < error, "{deviation} {sigma}");
        };
        check(moments(draws.iter().map(|d| d.angle_error_deg)), 0.0, 1.0);
        check(moments(draws.iter().map(|d| d.fall.drop.impact_velocity_m_s)), V0_M_S, 0.01 * V0_M_S);
        check(moments(draws.iter().map(|d| d.fall.drop.angular_velocity_rad_s.to_degrees())), 0.0, 1.0);
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
        let drawn = Uncertain {
            length: 3.0,
            cog: 3.0,
            inertia: 3.0,
            impact_velocity: 3.0,
            ..uncertain((0.0, 1.0), 1)
        };
        for Draw { fall, .. } in draw_all(&rough_rod(0.0), &drawn) {
            assert!(fall.body.length_m > 0.0 && fall.body.inertia_kg_m2 > 0.0);
            assert!(fall.drop.impact_velocity_m_s > 0.0);
            assert!((0.0..=fall.body.length_m).contains(&fall.body.cog_m));
        }
    }
}
