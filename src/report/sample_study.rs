//! Studies of the drop of `sample`, for the tests of this module only.

use super::sample;
use crate::data::{Contact, Prediction, Study, StudyRequest, Sweep, SweepVariable, Uncertain};
use std::sync::LazyLock;

fn request() -> StudyRequest {
    StudyRequest {
        contacts: vec![Contact::Rough, Contact::Smooth],
        ks: vec![0.0, 1.0],
        angle_deg: 15.0,
        sweeps: Vec::new(),
        angles_deg: (0..=180).map(|i| f64::from(i) * 0.5).collect(),
        band_percent: 5.0,
        uncertain: Uncertain {
            k: (0.0, 1.0),
            friction: Some((0.2, 0.6)),
            contact_s: (0.005, 0.03),
            angle_deg: 1.0,
            impact_velocity: 0.003,
            angular_velocity_deg_s: 1.0,
            horizontal_velocity_m_s: 0.1,
            length: 0.01,
            height: 0.01,
            cog: 0.01 / 5.512,
            inertia: 0.02,
            draws: 100,
            seed: 1,
        },
    }
}

/// The four borderline cases at 15°.
pub(super) fn study() -> Study {
    static MADE: LazyLock<Study> = LazyLock::new(|| crate::study(&sample::cask_file(), &request()));
    MADE.clone()
}

/// Two sweeps, with another contact law and k.
pub(super) fn sweep_study() -> Study {
    static MADE: LazyLock<Study> = LazyLock::new(|| {
        let base = request();
        let request = StudyRequest {
            contacts: vec![Contact::Coulomb(0.3)],
            ks: vec![0.5],
            sweeps: vec![
                Sweep { variable: SweepVariable::Angle, values: base.angles_deg.clone() },
                Sweep { variable: SweepVariable::Length, values: vec![4.0, 5.0, 6.0] },
            ],
            ..base
        };
        crate::study(&sample::cask_file(), &request)
    });
    MADE.clone()
}

/// One case with an impact so short that the body gives the result of every richer model.
pub(super) fn single_study() -> Study {
    let mut file = sample::cask_file();
    (file.drop.contact_duration_s, file.contact_duration_s) = (2e-4, Some(2e-4));
    crate::study(&file, &StudyRequest { contacts: vec![Contact::Rough], ks: vec![1.0], ..request() })
}

/// A study in which the second end never strikes.
pub(super) fn without_slap_down() -> Study {
    let mut study = study();
    for row in &mut study.rows {
        row.prediction = without_second_impact(&row.prediction);
    }
    for step in study.ladders.iter_mut().flat_map(|ladder| &mut ladder.steps) {
        step.prediction = without_second_impact(&step.prediction);
        step.change_percent = None;
    }
    for curve in study.curves.iter_mut().chain(&mut study.sections) {
        for values in [
            &mut curve.speed_m_s,
            &mut curve.vertical_velocity_m_s,
            &mut curve.horizontal_velocity_m_s,
            &mut curve.energy_ratio,
            &mut curve.closed_form_speed_m_s,
        ] {
            values.fill(f64::NAN);
        }
    }
    study.paths.clear();
    study.critical.clear();
    study.monte_carlo.quantiles.clear();
    study.monte_carlo.no_slap_down.fill(1.0);
    study
}

fn without_second_impact(prediction: &Prediction) -> Prediction {
    Prediction {
        slap_down_speed_m_s: None,
        vertical_velocity_m_s: None,
        horizontal_velocity_m_s: None,
        flight_time_s: None,
        energy_ratio: None,
        slap_down_angle_deg: None,
        closed_form_speed_m_s: None,
        ..prediction.clone()
    }
}
