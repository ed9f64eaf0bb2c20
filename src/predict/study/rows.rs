//! Sweeps of a request: one prediction for every combination of their values.

use super::super::bodies;
use super::{Fall, falls, raise, resize};
use crate::data::{Body, CaskFile, Contact, PredictionRow, StudyRequest, SweepVariable};
use rayon::prelude::*;

/// Rows of the product of all sweeps, the first outermost; within it for every body, contact law and k that
/// is not swept.
pub(super) fn rows(cask_file: &CaskFile, request: &StudyRequest) -> Vec<PredictionRow> {
    let mut points: Vec<Vec<(SweepVariable, f64)>> = vec![Vec::new()];
    for sweep in &request.sweeps {
        let with_each = |point: &Vec<_>| {
            let point = point.clone();
            let with = move |&value: &f64| [&point[..], &[(sweep.variable, value)]].concat();
            sweep.values.iter().map(with)
        };
        points = points.iter().flat_map(with_each).collect();
    }
    points.par_iter().flat_map(|point| rows_at(point, cask_file, request)).collect()
}

fn rows_at(
    point: &[(SweepVariable, f64)],
    cask_file: &CaskFile,
    request: &StudyRequest,
) -> Vec<PredictionRow> {
    let swept = |wanted| point.iter().find(|(variable, _)| *variable == wanted).map(|(_, value)| *value);
    let angle_deg = swept(SweepVariable::Angle).unwrap_or(request.angle_deg);
    let contacts = swept(SweepVariable::Friction).map(|friction| vec![Contact::Coulomb(friction)]);
    let ks = swept(SweepVariable::K).map(|k| vec![k]);
    let height_m = swept(SweepVariable::DropHeight);
    let drop = height_m.map_or(cask_file.drop, |height_m| raise(&cask_file.drop, height_m));
    let sized = |body: Body| match swept(SweepVariable::Length) {
        Some(length_m) => resize(&body, length_m, body.height_m),
        None => body,
    };
    let bodies: Vec<Body> = bodies(&cask_file.cask).into_iter().map(sized).collect();
    let contacts = contacts.as_ref().unwrap_or(&request.contacts);
    let row = |fall: Fall| {
        let prediction = fall.predict(angle_deg);
        let (length_m, drop_height_m) = (fall.body.length_m, drop.height_m);
        PredictionRow { angle_deg, length_m, drop_height_m, turns_over: prediction.turns_over(), prediction }
    };
    falls(&bodies, drop, contacts, ks.as_ref().unwrap_or(&request.ks)).into_iter().map(row).collect()
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that are handed through, not computed")]
mod tests {
    use super::super::tests::{cask_file, request};
    use super::*;
    use crate::data::{BodyModel, Sweep};

    fn sweep_rows(height_m: f64, sweeps: Vec<(SweepVariable, Vec<f64>)>) -> Vec<PredictionRow> {
        let sweeps = sweeps.into_iter().map(|(variable, values)| Sweep { variable, values }).collect();
        let asked =
            StudyRequest { sweeps, ..request(vec![Contact::Rough, Contact::Smooth], vec![0.0, 1.0], vec![]) };
        rows(&cask_file(height_m), &asked)
    }

    #[test]
    fn without_a_sweep_there_is_one_row_a_case() {
        let rows = sweep_rows(0.792, vec![]);
        let cases: Vec<_> =
            rows.iter().map(|r| (r.prediction.model, r.prediction.contact, r.prediction.k)).collect();
        let (rod, body) = (BodyModel::Rod, BodyModel::Body);
        let cases_of = |model| {
            [
                (model, Contact::Rough, 0.0),
                (model, Contact::Rough, 1.0),
                (model, Contact::Smooth, 0.0),
                (model, Contact::Smooth, 1.0),
            ]
        };
        assert_eq!(cases, [cases_of(rod), cases_of(body)].concat());
        assert!(rows.iter().all(|r| r.angle_deg == 15.0 && r.length_m == 5.512 && r.drop_height_m == 9.0));
    }

    #[test]
    fn the_first_sweep_is_outermost_and_a_swept_k_replaces_the_stated() {
        let rows = sweep_rows(
            0.0,
            vec![(SweepVariable::Angle, vec![5.0, 10.0]), (SweepVariable::K, vec![0.2, 0.4, 0.6])],
        );
        let asked = |r: &PredictionRow| (r.angle_deg, r.prediction.k, r.prediction.contact);
        assert_eq!(rows.len(), 2 * 3 * 2);
        assert_eq!(asked(&rows[0]), (5.0, 0.2, Contact::Rough));
        assert_eq!(asked(&rows[1]), (5.0, 0.2, Contact::Smooth));
        assert_eq!(asked(&rows[2]), (5.0, 0.4, Contact::Rough));
        assert_eq!(asked(&rows[6]), (10.0, 0.2, Contact::Rough));
    }

    #[test]
    fn a_swept_friction_replaces_the_contact_law() {
        let rows = sweep_rows(0.0, vec![(SweepVariable::Friction, vec![0.0, 2.0])]);
        assert_eq!(rows.len(), 2 * 2);
        let speed = |r: &PredictionRow| r.prediction.slap_down_speed_m_s.expect("R strikes");
        let borderline = sweep_rows(0.0, vec![]);
        // k = 1 without friction is smooth, with more than sticking needs rough; the same sums in another
        // order.
        assert!((speed(&rows[1]) - speed(&borderline[3])).abs() < 1e-11);
        assert!((speed(&rows[3]) - speed(&borderline[1])).abs() < 1e-11);
    }

    #[test]
    fn four_times_the_size_doubles_every_speed() {
        // g l / v0² is the only number in the equations of a rod: with l and h four times as large v0 and all
        // speeds double.
        let small = sweep_rows(0.0, vec![]);
        let large = sweep_rows(
            0.0,
            vec![(SweepVariable::Length, vec![4.0 * 5.512]), (SweepVariable::DropHeight, vec![36.0])],
        );
        for (small, large) in small.iter().zip(&large) {
            assert!((large.length_m - 22.048).abs() < 1e-12 && large.drop_height_m == 36.0);
            let ratio = large.prediction.slap_down_speed_m_s.expect("R strikes")
                / small.prediction.slap_down_speed_m_s.expect("R strikes");
            // The slap-down is found to 1e-9 m of height: 1e-9 of the speed at 13 m/s and 10 m/s² is far
            // above it.
            assert!((ratio / 2.0 - 1.0).abs() < 1e-9, "{ratio}");
        }
    }

    #[test]
    fn a_longer_body_keeps_its_section() {
        let rows = sweep_rows(0.792, vec![(SweepVariable::Length, vec![5.0, 5.512])]);
        let same = sweep_rows(0.792, vec![]);
        assert_eq!(rows.len(), 2 * same.len());
        for (row, expected) in rows[same.len()..].iter().zip(&same) {
            assert_eq!(row, expected);
        }
        assert_ne!(rows[4].prediction.slap_down_speed_m_s, same[4].prediction.slap_down_speed_m_s);
    }
}
