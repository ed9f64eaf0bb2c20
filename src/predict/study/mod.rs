//! Rows, curves, critical angles and Monte Carlo for a cask file and a request.

mod advice;
mod critical;
mod curves;
mod monte_carlo;
mod peak;
mod poses;
mod rows;
mod uncertain;

pub use uncertain::{default_uncertain, usual_request};

use super::{Fall, bodies, ladder, predict};
use crate::data::{
    Body, BodyModel, BodyPath, CaskFile, Contact, Drop, Ladder, Prediction, Study, StudyRequest,
};
use rayon::prelude::*;

/// Angles of Monte Carlo: one degree, finer than a drop can be rigged; beyond [`STEEP_DEG`] every third, as
/// drops are flatter.
const DRAW_ANGLES: usize = 91;
const STEEP_DEG: f64 = 30.0;

/// Evaluates a study of the drop angle on all cores; the result does not depend on their number.
///
/// The seed fixes the draws bit by bit; predictions from them differ between machines in the last bits of the
/// sine only.
pub fn study(cask_file: &CaskFile, request: &StudyRequest) -> Study {
    let falls = falls(&bodies(&cask_file.cask), cask_file.drop, &request.contacts, &request.ks);
    let traced: Vec<Vec<Prediction>> = falls.par_iter().map(|fall| fall.sweep(&request.angles_deg)).collect();
    let (curves, critical): (Vec<_>, Vec<_>) = falls
        .par_iter()
        .zip(&traced)
        .map(|(fall, predictions)| {
            let curve = curves::curve(fall, &request.angles_deg, predictions);
            let over = (&request.angles_deg[..], &predictions[..]);
            (curve, critical::critical_angles(fall, request.band_percent, over))
        })
        .unzip();
    let (critical, rows) = (critical.concat(), rows::rows(cask_file, request));
    let drawn_deg = thin(&request.angles_deg, DRAW_ANGLES);
    let contact = request.contacts.first().copied().unwrap_or(cask_file.contact);
    let base = Fall { body: richest_body(cask_file), drop: cask_file.drop, contact, k: 0.0 };
    let draws = monte_carlo::trace_draws(&base, request, &drawn_deg);
    let monte_carlo = monte_carlo::monte_carlo(&base, request, &drawn_deg, &draws);
    Study {
        advice: advice::advice(request, (&monte_carlo, &draws), &critical, &rows),
        rows,
        paths: paths(&falls, request.angle_deg),
        ladders: ladders(cask_file, request),
        curves,
        sections: curves::sections(cask_file, &request.angles_deg),
        critical,
        monte_carlo,
        plan: None,
        cask_file: cask_file.clone(),
        request: request.clone(),
    }
}

/// A fall whose angle is open.
impl Fall {
    fn drop_at(&self, angle_deg: f64) -> Drop {
        Drop { angle_rad: angle_deg.to_radians(), ..self.drop }
    }

    fn predict(&self, angle_deg: f64) -> Prediction {
        predict(&self.body, &self.drop_at(angle_deg), self.contact, self.k)
    }

    fn sweep(&self, angles_deg: &[f64]) -> Vec<Prediction> {
        angles_deg.par_iter().map(|&angle_deg| self.predict(angle_deg)).collect()
    }
}

/// Every body with every contact law and k, in this order.
fn falls(bodies: &[Body], drop: Drop, contacts: &[Contact], ks: &[f64]) -> Vec<Fall> {
    let mut falls = Vec::new();
    for &body in bodies {
        for &contact in contacts {
            falls.extend(ks.iter().map(|&k| Fall { body, drop, contact, k }));
        }
    }
    falls
}

/// Largest number of drawn paths of the richest body: two contact laws with two k each.
const MOST_PATHS: usize = 4;

fn paths(falls: &[Fall], angle_deg: f64) -> Vec<BodyPath> {
    let of_richest = |fall: &&Fall| falls.last().is_some_and(|last| last.body.model == fall.body.model);
    falls.iter().filter(of_richest).filter_map(|fall| poses::path(fall, angle_deg)).take(MOST_PATHS).collect()
}

/// The body if the cask file describes one, else the rod.
pub fn richest_body(cask_file: &CaskFile) -> Body {
    let model = if cask_file.cask.is_body { BodyModel::Body } else { BodyModel::Rod };
    super::body(&cask_file.cask, model)
}

fn ladders(cask_file: &CaskFile, request: &StudyRequest) -> Vec<Ladder> {
    let body = richest_body(cask_file);
    let drop = Drop { angle_rad: request.angle_deg.to_radians(), ..cask_file.drop };
    let ladders = |&contact: &Contact| request.ks.iter().map(move |&k| ladder(&body, &drop, contact, k));
    request.contacts.iter().flat_map(ladders).collect()
}

/// The body with another length and section: the centre of gravity keeps its share of the length, Θ ∝ l² +
/// h².
fn resize(body: &Body, length_m: f64, height_m: f64) -> Body {
    let size_m2 = |l: f64, h: f64| l * l + h * h;
    Body {
        length_m,
        height_m,
        cog_m: body.cog_m * (length_m / body.length_m),
        inertia_kg_m2: body.inertia_kg_m2
            * (size_m2(length_m, height_m) / size_m2(body.length_m, body.height_m)),
        ..*body
    }
}

/// The drop from another height: v0 = √(2 g h); a stated v0 scales with √h.
fn raise(drop: &Drop, height_m: f64) -> Drop {
    let impact_velocity_m_s = if drop.impact_velocity_given {
        drop.impact_velocity_m_s * (height_m / drop.height_m).sqrt()
    } else {
        (2.0 * drop.gravity_m_s2 * height_m).sqrt()
    };
    Drop { height_m, impact_velocity_m_s, ..*drop }
}

/// Picks at most `most` of the angles (2 or more), evenly, including the first and the last.
fn thin(angles_deg: &[f64], most: usize) -> Vec<f64> {
    let most = most.min(angles_deg.len());
    let last = angles_deg.len().saturating_sub(1);
    let picked = (0..most).map(|i| (i, angles_deg[i * last / (most - 1)]));
    let is_drawn = |&(i, angle_deg): &(usize, f64)| angle_deg <= STEEP_DEG || i % 3 == 0 || i + 1 == most;
    picked.filter(is_drawn).map(|(_, angle_deg)| angle_deg).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Uncertain, example};

    pub(super) const V0_M_S: f64 = 13.288_340_754_210_061; // √(2 · 9.81 · 9)

    /// A uniform cask as long and heavy as ANF-18; a section of 0 makes it the thin rod.
    pub(super) fn cask_file(height_m: f64) -> CaskFile {
        let cask = example::cask(4466.0, 5.512, height_m);
        CaskFile::new(
            cask,
            Drop { impact_velocity_m_s: V0_M_S, ..Drop::from_height(9.0, 15_f64.to_radians()) },
            Contact::Rough,
        )
    }

    pub(super) fn steps(count: u32, last: f64) -> Vec<f64> {
        (0..=count).map(|i| last * f64::from(i) / f64::from(count)).collect()
    }

    /// Nothing is uncertain but k.
    pub(super) fn uncertain(k: (f64, f64), draws: u32) -> Uncertain {
        Uncertain { k, draws, seed: 1, ..Uncertain::default() }
    }

    pub(super) fn request(contacts: Vec<Contact>, ks: Vec<f64>, angles_deg: Vec<f64>) -> StudyRequest {
        StudyRequest {
            contacts,
            ks,
            angle_deg: 15.0,
            sweeps: vec![],
            angles_deg,
            band_percent: 5.0,
            uncertain: uncertain((0.0, 1.0), 20),
        }
    }

    pub(super) fn rough_rod(k: f64) -> Fall {
        let file = cask_file(0.0);
        Fall { body: richest_body(&file), drop: file.drop, contact: Contact::Rough, k }
    }

    #[test]
    fn the_number_of_cores_changes_no_bit() {
        let file = cask_file(0.792);
        let mut asked = request(vec![Contact::Rough, Contact::Smooth], vec![0.0, 1.0], steps(30, 90.0));
        asked.uncertain = Uncertain { draws: 20, friction: Some((0.1, 0.6)), ..default_uncertain(&file) };
        let on = |cores: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(cores).build().expect("a pool");
            // Debug prints every bit of a double, and NaN as equal to itself.
            format!("{:?}", pool.install(|| study(&file, &asked)))
        };
        assert_eq!(on(1), on(3));
    }

    #[test]
    fn a_study_holds_one_of_each() {
        let asked = request(vec![Contact::Rough, Contact::Smooth], vec![0.0, 0.5, 1.0], steps(30, 90.0));
        for (height_m, bodies, sections) in [(0.0, 1, 4), (0.792, 2, 5)] {
            let found = study(&cask_file(height_m), &asked);
            assert_eq!(found.rows.len(), bodies * 2 * 3);
            assert_eq!(found.ladders.len(), 2 * 3);
            assert_eq!(found.curves.len(), bodies * 2 * 3);
            assert_eq!(found.sections.len(), sections);
            assert_eq!(found.critical.len(), bodies * 2 * 3 * 3);
        }
    }

    #[test]
    fn a_study_of_no_angle_is_empty_and_no_fault() {
        let found = study(&cask_file(0.0), &request(vec![Contact::Rough], vec![0.5], vec![]));
        assert!(found.critical.iter().all(|c| c.angle_deg.is_nan() && c.bands_deg.is_empty()));
        assert!(found.monte_carlo.quantiles[0].q50.is_empty());
    }

    #[test]
    fn thinning_keeps_both_ends_and_every_third_steep_angle() {
        let flat: Vec<f64> = thin(&steps(180, 90.0), 91).into_iter().filter(|a| *a <= STEEP_DEG).collect();
        assert_eq!(flat, steps(30, 30.0));
        for angles_deg in [steps(180, 90.0), steps(1000, 90.0), steps(7, 70.0)] {
            let thin = thin(&angles_deg, 91);
            assert_eq!((thin.first(), thin.last()), (angles_deg.first(), angles_deg.last()));
            assert!(
                thin.len() <= 52 && thin.windows(2).all(|w| w[0] < w[1] && w[1] - w[0] <= 31.0),
                "{thin:?}"
            );
        }
    }

    #[test]
    fn a_uniform_body_stays_uniform_when_resized() {
        let body = richest_body(&cask_file(0.792));
        let other = resize(&body, 4.0, 1.0);
        // Three roundings of a product: 1e-15 each.
        assert!((other.inertia_kg_m2 / (body.mass_kg * 17.0 / 12.0) - 1.0).abs() < 3e-15);
        assert!((other.cog_m - 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_stated_speed_scales_with_the_root_of_the_height() {
        let drop = cask_file(0.0).drop;
        assert!((raise(&drop, 36.0).impact_velocity_m_s / (2.0 * V0_M_S) - 1.0).abs() < 1e-15);
        let stated = Drop { impact_velocity_m_s: 13.0, impact_velocity_given: true, ..drop };
        assert!((raise(&stated, 36.0).impact_velocity_m_s / 26.0 - 1.0).abs() < 1e-15);
    }
}
