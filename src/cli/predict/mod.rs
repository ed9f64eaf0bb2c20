//! `predict`: predicts the slap-down analytically at one angle or over sweeps, with the critical angles;
//! prints a table and writes a report.

mod request;
mod sweep;
mod words;

use super::Ending;
use super::output::{Folder, JsonTarget, columns, print};
use crate::data::{CaskFile, Contact, StudyRequest, Sweep};
use crate::report;
use clap::Args;
use std::path::PathBuf;

const CASES: &str = "What to predict";
const CRITICAL: &str = "Critical angles and what uncertainty makes of them";
const OUTPUT: &str = "Output";

#[derive(Args)]
#[command(after_help = include_str!("../help/predict.txt"))]
pub struct Arguments {
    /// The cask file (TOML); it needs no [[channel]]
    #[arg(short, long)]
    cask: PathBuf,
    /// Inclination at first contact, 0 to 90 degrees [default: the cask file's]
    #[arg(long, value_name = "DEG", help_heading = CASES, allow_hyphen_values = true,
        value_parser = words::angle)]
    angle: Option<f64>,
    /// Coefficient of restitution, 0 to 1
    #[arg(long, value_name = "K", help_heading = CASES, allow_hyphen_values = true,
        value_parser = words::restitution)]
    k: Option<f64>,
    /// Contact of the first end: rough, smooth or a Coulomb coefficient
    #[arg(long, value_name = "C", help_heading = CASES, allow_hyphen_values = true,
        value_parser = words::contact)]
    contact: Option<Contact>,
    /// How long the first impact lasts, seconds: 20 ms are 0.02 [default: the cask file's, else an impulse,
    /// and 5 to 30 ms in the draws]
    #[arg(long, value_name = "S", help_heading = CASES, allow_hyphen_values = true,
        value_parser = words::duration)]
    duration: Option<f64>,
    /// Sweep angle (degrees; where no VARIABLE stands), k, friction, length (m) or height (of the drop, m);
    /// several times for every combination
    #[arg(long, value_name = "[VARIABLE=]FROM:TO:STEP", help_heading = CASES, allow_hyphen_values = true,
        value_parser = sweep::parse)]
    sweep: Vec<Sweep>,
    /// An angle is critical where the slap-down comes within this of its largest, percent
    #[arg(long, value_name = "PERCENT", help_heading = CRITICAL, default_value = "5",
        allow_hyphen_values = true, value_parser = words::band)]
    band: f64,
    /// Range of k, such as 0.3:0.7 [default: --k or its sweep, else 0:1]
    #[arg(long, value_name = "FROM:TO", help_heading = CRITICAL, allow_hyphen_values = true,
        value_parser = words::restitution_range)]
    k_range: Option<(f64, f64)>,
    /// Range of the Coulomb coefficient, such as 0.2:0.6 [default: --contact or its sweep, else the cask
    /// file's]
    #[arg(long, value_name = "FROM:TO", help_heading = CRITICAL, allow_hyphen_values = true,
        value_parser = words::friction_range)]
    friction_range: Option<(f64, f64)>,
    /// Tolerance of the angle, degrees [default: the cask file's]
    #[arg(long, value_name = "DEG", help_heading = CRITICAL, allow_hyphen_values = true,
        value_parser = words::angle_tolerance)]
    angle_tolerance: Option<f64>,
    /// Tolerance of length, section and centre of gravity, percent (the last of the length) [default: the
    /// cask file's]
    #[arg(long, value_name = "PERCENT", help_heading = CRITICAL, allow_hyphen_values = true,
        value_parser = words::geometry_tolerance)]
    geometry_tolerance: Option<f64>,
    /// Casks and drops that Monte Carlo draws; 0 for none
    #[arg(long, value_name = "N", help_heading = CRITICAL, default_value = "1000",
        allow_hyphen_values = true, value_parser = words::draws)]
    draws: u32,
    /// Seed of the draws: the same seed gives the same draws everywhere [default: 1]
    #[arg(long, value_name = "N", help_heading = CRITICAL)]
    seed: Option<u64>,
    /// Folder for prediction.html, prediction.json, prediction.csv and the pictures
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT)]
    out: Option<PathBuf>,
    /// Write the predictions as JSON to a file; with - to standard output, and nothing else there
    #[arg(short, long, value_name = "FILE|-", help_heading = OUTPUT)]
    json: Option<PathBuf>,
}

/// Reads the cask file and the request of the study.
pub fn read_request(arguments: &Arguments) -> miette::Result<(CaskFile, StudyRequest)> {
    let mut file = crate::ingest::cask_file::parse(&arguments.cask)?;
    if let Some(lasts_s) = arguments.duration {
        (file.contact_duration_s, file.drop.contact_duration_s) = (Some(lasts_s), lasts_s);
    }
    let request = request::request(arguments, &file)?;
    Ok((file, request))
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let inputs = [arguments.cask.as_path()];
    let (file, request) = read_request(arguments)?;
    let names = report::study_file_names(&request);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let folder = arguments.out.as_deref().map(|dir| Folder::prepare(dir, &names, &inputs)).transpose()?;
    let json = JsonTarget::prepare(arguments.json.as_deref(), &inputs)?;

    let study = crate::analysis::study(&file, &request);

    if let Some(folder) = &folder {
        folder.write(&report::study_files(&study)?)?;
    }
    json.write(|| report::study_json(&study))?;
    if !json.is_standard_output() {
        print(&report::study_table(&study, columns()))?;
        if let Some(folder) = &folder {
            print(&format!("\nReport: {}\n", report::sanitize(&folder.file("prediction.html"))))?;
        }
    }
    Ok(Ending::Clear)
}
