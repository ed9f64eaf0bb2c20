//! A plausible study of an ANF-18 drop, made by hand of smooth curves, for the tests of this module only.

use super::sample;
use crate::data::{
    Advice, AngleCurve, Body, BodyModel, BodyPath, CogVelocity, Contact, Criterion, CriticalAngle,
    FlightRegime, Ladder, LadderStep, MonteCarlo, Pose, Prediction, PredictionRow, QuantileCurves, Rung,
    Study, StudyRequest, Sweep, SweepVariable, Uncertain,
};

const MODELS: [BodyModel; 2] = [BodyModel::Rod, BodyModel::Body];

/// A study of the four borderline cases at 15°, every part filled in.
pub(super) fn study() -> Study {
    of(StudyRequest {
        contacts: vec![Contact::Rough, Contact::Smooth],
        ks: vec![0.0, 1.0],
        angle_deg: 15.0,
        sweeps: Vec::new(),
        angles_deg: (0..=180).map(|i| f64::from(i) * 0.5).collect(),
        band_percent: 5.0,
        uncertain: uncertain(),
    })
}

/// A study of two sweeps, with a contact law and k of its own.
pub(super) fn swept() -> Study {
    let base = study().request;
    of(StudyRequest {
        contacts: vec![Contact::Coulomb(0.3)],
        ks: vec![0.5],
        sweeps: vec![
            Sweep { variable: SweepVariable::Angle, values: base.angles_deg.clone() },
            Sweep { variable: SweepVariable::Length, values: vec![4.0, 5.0, 6.0] },
        ],
        ..base
    })
}

/// A study in which the second end never strikes.
pub(super) fn without_slap_down() -> Study {
    let mut study = study();
    for row in &mut study.rows {
        row.prediction = never(&row.prediction);
    }
    for step in study.ladders.iter_mut().flat_map(|ladder| &mut ladder.steps) {
        step.prediction = never(&step.prediction);
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

fn never(prediction: &Prediction) -> Prediction {
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

fn uncertain() -> Uncertain {
    Uncertain {
        k: (0.0, 1.0),
        friction: Some((0.2, 0.6)),
        contact_s: (0.005, 0.03),
        angle_deg: 1.0,
        impact_velocity: 0.003,
        angular_velocity_deg_s: 1.0,
        horizontal_velocity_m_s: 0.1,
        length: 0.005,
        height: 0.005,
        cog: 0.01,
        inertia: 0.05,
        draws: 2000,
        seed: 1,
    }
}

fn of(request: StudyRequest) -> Study {
    let cases: Vec<(BodyModel, Contact, f64)> = MODELS
        .into_iter()
        .flat_map(|model| request.contacts.clone().into_iter().map(move |contact| (model, contact)))
        .flat_map(|(model, contact)| request.ks.clone().into_iter().map(move |k| (model, contact, k)))
        .collect();
    let values = |wanted| {
        request.sweeps.iter().find(|sweep| sweep.variable == wanted).map(|sweep| sweep.values.clone())
    };
    let angles = values(SweepVariable::Angle).unwrap_or_else(|| vec![request.angle_deg]);
    let lengths = values(SweepVariable::Length).unwrap_or_else(|| vec![5.512]);
    let mut rows = Vec::new();
    for &angle_deg in &angles {
        for &length_m in &lengths {
            for &case in &cases {
                let prediction = prediction(case, angle_deg, length_m);
                let turns_over = false;
                rows.push(PredictionRow { angle_deg, length_m, drop_height_m: 9.0, turns_over, prediction });
            }
        }
    }
    let section = |height_m| AngleCurve {
        height_m,
        ..curve(&request, (BodyModel::Body, Contact::Smooth, 1.0 - 0.2 * height_m))
    };
    Study {
        cask_file: sample::cask_file(),
        rows,
        paths: cases[cases.len() / 2..].iter().map(|case| path(*case)).collect(),
        ladders: cases[..cases.len() / 2].iter().map(|case| ladder(&request, *case)).collect(),
        curves: cases.iter().map(|case| curve(&request, *case)).collect(),
        sections: [0.0, 0.01, 0.5, 0.6, 0.792].map(section).into(),
        critical: cases.iter().flat_map(|case| Criterion::ALL.map(|c| critical(*case, c))).collect(),
        monte_carlo: monte_carlo(&request),
        plan: None,
        advice: Advice {
            band_deg: Some((5.0, 19.0)),
            largest_m_s: 25.0,
            at_deg: 12.0,
            own_deg: request.angle_deg,
            own_m_s: 20.68,
            own_range_m_s: (17.68, 23.68),
            own_share: 1.0,
            drawn: request.uncertain,
        },
        request,
    }
}

fn path((model, contact, k): (BodyModel, Contact, f64)) -> BodyPath {
    let pose = |share: f64| Pose {
        time_s: 0.06 * share,
        along_m: 2.7 + 0.2 * share,
        height_m: 0.7 - 0.5 * share,
        angle_rad: 0.26 - 0.3 * share,
    };
    let body = Body {
        model,
        mass_kg: 4466.0,
        length_m: 5.512,
        height_m: 0.792,
        cog_m: 2.756,
        inertia_kg_m2: 11_540.7,
    };
    BodyPath { body, contact, k, poses: [0.0, 0.5, 1.0].map(pose).into() }
}

/// The speed of a curve with a hump at 12°; for k = 0 it ends at 70°.
fn speed_m_s((model, contact, k): (BodyModel, Contact, f64), angle_deg: f64) -> Option<f64> {
    let share = if model == BodyModel::Rod { 1.0 } else { 0.92 };
    let drop = if contact == Contact::Rough { 0.0022 } else { 0.0009 };
    let far = (k > 0.0 || angle_deg < 70.0).then_some(angle_deg)?;
    Some(share * (20.0 + 5.0 * k) * (1.0 - drop * (far - 12.0).powi(2) / 10.0).max(0.1))
}

fn prediction(case: (BodyModel, Contact, f64), angle_deg: f64, length_m: f64) -> Prediction {
    let (model, contact, k) = case;
    let speed = speed_m_s(case, angle_deg).map(|v| v * (1.0 + 0.01 * (length_m - 5.512)));
    let slope = 0.09_f64;
    Prediction {
        model,
        contact,
        k,
        slap_down_speed_m_s: speed,
        vertical_velocity_m_s: speed.map(|v| -v * slope.cos()),
        horizontal_velocity_m_s: speed.map(|v| v * slope.sin()),
        angular_velocity_rad_s: 4.0 + 1.8 * k,
        flight_time_s: speed.map(|_| 0.078 - 0.02 * k),
        energy_ratio: speed.map(|_| 0.75 + 0.28 * k),
        slap_down_angle_deg: speed.map(|_| -4.0 - 1.9 * k),
        first_end_impacts: if angle_deg > 60.0 { 2 } else { 1 },
        impulse_ratio: 0.624,
        friction_to_stick: 0.624,
        sticks: contact == Contact::Rough,
        regime: if k > 0.0 || angle_deg < 40.0 { FlightRegime::Free } else { FlightRegime::Contact },
        cog: CogVelocity::default(),
        closed_form_speed_m_s: (k <= 0.0).then(|| speed.unwrap_or(9.0) + 0.3),
    }
}

fn ladder(request: &StudyRequest, case: (BodyModel, Contact, f64)) -> Ladder {
    let step = |(i, rung): (usize, Rung)| LadderStep {
        rung,
        adds: rung.adds(),
        prediction: prediction(
            (if i == 0 { BodyModel::Rod } else { BodyModel::Body }, case.1, case.2),
            request.angle_deg,
            5.512,
        ),
        change_percent: (i > 0).then_some(if i == 1 { -8.0 } else { 0.0 }),
    };
    Ladder {
        angle_deg: request.angle_deg,
        contact: case.1,
        k: case.2,
        steps: Rung::ALL.into_iter().enumerate().map(step).collect(),
        suffices: Rung::Body,
    }
}

fn curve(request: &StudyRequest, case: (BodyModel, Contact, f64)) -> AngleCurve {
    let angle_deg = request.angles_deg.clone();
    let series = |value: fn(&Prediction) -> Option<f64>| -> Vec<f64> {
        angle_deg.iter().map(|angle| value(&prediction(case, *angle, 5.512)).unwrap_or(f64::NAN)).collect()
    };
    AngleCurve {
        model: case.0,
        height_m: if case.0 == BodyModel::Rod { 0.0 } else { 0.792 },
        contact: case.1,
        k: case.2,
        speed_m_s: series(|p| p.slap_down_speed_m_s),
        vertical_velocity_m_s: series(|p| p.vertical_velocity_m_s),
        horizontal_velocity_m_s: series(|p| p.horizontal_velocity_m_s),
        energy_ratio: series(|p| p.energy_ratio),
        closed_form_speed_m_s: series(|p| p.closed_form_speed_m_s),
        turns_over: vec![false; angle_deg.len()],
        angle_deg,
    }
}

fn critical((model, contact, k): (BodyModel, Contact, f64), criterion: Criterion) -> CriticalAngle {
    let largest = if criterion == Criterion::EnergyRatio { 1.031 } else { 20.0 + 5.0 * k };
    let bands_deg = if k > 0.0 { vec![(3.5, 28.0)] } else { vec![(0.0, 24.2), (61.0, 70.0)] };
    let further_impacts = (k > 0.0 && criterion == Criterion::Speed).then_some((86.0, 30.1));
    CriticalAngle { model, contact, k, criterion, angle_deg: 12.0, largest, bands_deg, further_impacts }
}

fn monte_carlo(request: &StudyRequest) -> MonteCarlo {
    let angle_deg = request.angles_deg.clone();
    let speeds: Vec<f64> = angle_deg
        .iter()
        .map(|angle| speed_m_s((BodyModel::Body, Contact::Smooth, 0.5), *angle).unwrap_or(f64::NAN))
        .collect();
    let shifted = |by: f64, factor: f64| -> Vec<f64> { speeds.iter().map(|v| (v + by) * factor).collect() };
    let quantiles = Criterion::ALL.map(|criterion| {
        let factor = if criterion == Criterion::EnergyRatio { 0.045 } else { 1.0 };
        QuantileCurves {
            criterion,
            q025: shifted(-3.0, factor),
            q25: shifted(-1.0, factor),
            q50: shifted(0.0, factor),
            q75: shifted(1.0, factor),
            q975: shifted(3.0, factor),
            in_band: angle_deg.iter().map(|a| (1.3 - ((a - 12.0) / 30.0).abs()).clamp(0.0, 1.0)).collect(),
            critical_angle_deg: [4.5, 9.0, 12.0, 14.5, 19.5],
            largest: [18.0, 20.0, 21.0, 22.0, 24.0].map(|v| v * factor),
            critical_counts: angle_deg.iter().map(|a| if (4.0..20.0).contains(a) { 62 } else { 0 }).collect(),
            robust_bands_deg: vec![(5.0, 19.0)],
        }
    });
    MonteCarlo {
        model: BodyModel::Body,
        contact: Contact::Rough,
        uncertain: request.uncertain,
        band_percent: request.band_percent,
        no_slap_down: angle_deg.iter().map(|a| if *a > 80.0 { 0.3 } else { 0.0 }).collect(),
        angle_deg,
        quantiles: quantiles.into(),
    }
}
