//! A cask of the paper to the throughput of the analytical prediction: every rung, a sweep and a whole study.

use crate::recordings::{self, Kind};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use dropcheck::data::{
    Body, BodyModel, Cask, CaskFile, Contact, Drop, Rung, StudyRequest, Sweep, SweepVariable,
};
use dropcheck::predict;
use std::fmt::{Display, Formatter};

/// Predictions a sample, each at another angle: 5° to 45°, where drops are made.
const ANGLES: u32 = 1000;

const CONTACTS: [Contact; 2] = [Contact::Rough, Contact::Coulomb(0.3)];

/// A rung, a contact law and k.
struct Case {
    rung: Rung,
    contact: Contact,
    k: f64,
}

impl Display for Case {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, friction {}, k = {}", self.rung.words(), self.contact, self.k)
    }
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for rung in Rung::ALL {
        for contact in CONTACTS {
            cases.extend([0.5, 0.0].map(|k| Case { rung, contact, k }));
        }
    }
    cases
}

/// ANF-18 with its section, dropped from 9 m.
fn anf18() -> CaskFile {
    let file = recordings::cask_file(Kind::Hdf5);
    let (mass_kg, length_m, height_m) = (4466.0, 5.512, 0.792);
    let cask = Cask {
        name: "ANF-18".to_owned(),
        mass_kg,
        length_m,
        height_m,
        width_m: None,
        cog_m: length_m / 2.0,
        inertia_kg_m2: mass_kg * (length_m * length_m + height_m * height_m) / 12.0,
        is_body: true,
    };
    CaskFile { cask, ..file }
}

fn drops(file: &CaskFile) -> Vec<Drop> {
    let angle_deg = |i: u32| 5.0 + 40.0 * f64::from(i) / f64::from(ANGLES - 1);
    (0..ANGLES).map(|i| Drop { angle_rad: angle_deg(i).to_radians(), ..file.drop }).collect()
}

fn body(file: &CaskFile) -> Body {
    predict::body(&file.cask, BodyModel::Body)
}

#[divan::bench(args = cases())]
fn prediction_by_rung(bencher: Bencher, case: &Case) {
    let file = anf18();
    let (body, drops) = (body(&file), drops(&file));
    bencher.counter(ItemsCount::new(drops.len())).bench_local(|| {
        for drop in &drops {
            black_box(predict::predict_by(case.rung, black_box(&body), drop, case.contact, case.k));
        }
    });
}

/// From 0 in equal steps, without the rounding of a sum.
fn steps(count: u32, last: f64) -> Vec<f64> {
    (0..=count).map(|i| last * f64::from(i) / f64::from(count)).collect()
}

/// What `predict` asks for where its user names nothing.
fn request(file: &CaskFile) -> StudyRequest {
    StudyRequest {
        contacts: vec![Contact::Rough, Contact::Smooth],
        ks: vec![0.0, 1.0],
        angle_deg: 15.0,
        sweeps: Vec::new(),
        angles_deg: steps(180, 90.0),
        band_percent: 5.0,
        uncertain: predict::default_uncertain(file),
    }
}

/// The whole study over 0.5°, all cores.
#[divan::bench]
fn prediction_study(bencher: Bencher) {
    let file = anf18();
    let request = request(&file);
    bencher.counter(ItemsCount::new(1_u32)).bench(|| predict::study(&file, &request));
}

/// The study with rows for every 0.5° of angle and 0.01 of k, all cores.
#[divan::bench]
fn prediction_study_with_sweeps(bencher: Bencher) {
    let file = anf18();
    let sweep = |variable, values| Sweep { variable, values };
    let sweeps =
        vec![sweep(SweepVariable::Angle, steps(180, 90.0)), sweep(SweepVariable::K, steps(100, 1.0))];
    let request = StudyRequest { sweeps, ..request(&file) };
    bencher.counter(ItemsCount::new(1_u32)).bench(|| predict::study(&file, &request));
}
