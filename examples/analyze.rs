//! The six names of the library: a recording and a cask file to a report, and what the model says of the same
//! drop.
//!
//! `cargo run --example analyze -- fixtures/examples/anf18-json.mcap fixtures/examples/anf18-json.toml
//! out/example`

use dropcheck::data::{Body, BodyModel, Contact, StudyRequest, Uncertain};
use std::path::Path;
use std::process::ExitCode;

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    // HDF5 is taken apart in a process of its own: this program, started again.
    if let Some(ended) = dropcheck::serve_hdf5() {
        return Ok(ended);
    }
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [recording, cask, out] = &words[..] else {
        return Err("three words: RECORDING CASK OUT".into());
    };

    let file = dropcheck::cask_file(cask.as_ref())?;
    let recording = dropcheck::read(recording.as_ref(), &file, &|_| ())?;
    let analysis = dropcheck::analyze(&recording, &file);
    std::fs::create_dir_all(out)?;
    for (name, bytes) in dropcheck::files(&analysis)? {
        std::fs::write(Path::new(out).join(name), bytes)?;
    }
    let result = &analysis.result;
    println!("{:?}, with {} findings; the report is in {out}", result.verdict, result.quality.len());
    let (Some(speed), Some(k)) = (&result.slap_down.speed, &result.k) else { return Ok(ExitCode::from(1)) };
    println!("slap-down at {:.2} ± {:.2} m/s, k {:.3} ± {:.3}", speed.value, speed.u95, k.value, k.u95);

    let cask = &file.cask;
    let body = Body {
        model: BodyModel::Body,
        mass_kg: cask.mass_kg,
        length_m: cask.length_m,
        height_m: cask.height_m,
        cog_m: cask.cog_m,
        inertia_kg_m2: cask.inertia_kg_m2,
    };
    let rough = dropcheck::predict(&body, &file.drop, Contact::Rough, k.value);
    println!("predicted of a rough contact: {:.2} m/s", rough.slap_down_speed_m_s.unwrap_or(f64::NAN));
    let study = dropcheck::study(&file, &request(k.value, k.u95));
    for critical in study.critical.iter().filter(|critical| critical.model == BodyModel::Body) {
        println!("{:?}: largest at {:.1}°", critical.criterion, critical.angle_deg);
    }
    Ok(ExitCode::SUCCESS)
}

/// Where between 0 and 90° the slap-down is largest with the k that was measured.
fn request(k: f64, u95: f64) -> StudyRequest {
    StudyRequest {
        contacts: vec![Contact::Rough],
        ks: vec![k],
        angle_deg: 15.0,
        sweeps: Vec::new(),
        angles_deg: (0..=180).map(|half| f64::from(half) / 2.0).collect(),
        band_percent: 5.0,
        uncertain: Uncertain { k: (k - u95, k + u95), draws: 1000, seed: 1, ..Uncertain::default() },
    }
}
