//! A study to JSON: objects on lines of their own, numbers in line, null for what is not a number.

use super::super::ReportError;
use super::csv::CHUNK;
use crate::data::{
    Contact, Criterion, CriticalAngle, Ladder, MonteCarlo, PredictionRow, RegimeMap, Sensitivity, Study,
};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::ser::Formatter;
use std::io::{self, Write};

const SCHEMA: &str = "dropcheck.prediction/1";
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Predictions beyond this many stand on one line each: nobody reads them one by one, and it takes a third of the bytes.
const MOST_SPREAD: usize = 400;

/// What follows the predictions.
#[derive(Serialize)]
struct StudyFound<'a> {
    input: StudyInput,
    ladders: &'a [Ladder],
    critical_angles: &'a [CriticalAngle],
    critical_ranges: Vec<FoundRange<'a>>,
    monte_carlo: &'a MonteCarlo,
    sensitivities: &'a [Sensitivity],
    regime_maps: &'a [RegimeMap],
}

#[derive(Serialize)]
struct StudyInput {
    cask: String,
    cask_sha256: String,
}

/// A critical range with the worst case by name.
#[derive(Serialize)]
struct FoundRange<'a> {
    model: &'static str,
    criterion: Criterion,
    angle_deg: (f64, f64),
    largest: f64,
    worst: Worst,
    common_bands_deg: &'a [(f64, f64)],
    further_impacts: Option<(f64, f64)>,
}

#[derive(Serialize)]
struct Worst {
    angle_deg: f64,
    contact: Contact,
    k: f64,
}

/// `prediction.json`.
///
/// # Errors
/// [`ReportError::Json`] where the writer fails.
pub fn study_json(study: &Study) -> Result<Vec<u8>, ReportError> {
    let range = |range: &'_ crate::data::CriticalRange| Worst {
        angle_deg: range.worst.0,
        contact: range.worst.1,
        k: range.worst.2,
    };
    let found = StudyFound {
        input: StudyInput {
            cask: study.cask_file.path.display().to_string(),
            cask_sha256: study.cask_file.sha256.clone(),
        },
        ladders: &study.ladders,
        critical_angles: &study.critical,
        critical_ranges: study
            .ranges
            .iter()
            .map(|r| FoundRange {
                model: r.model.as_str(),
                criterion: r.criterion,
                angle_deg: r.angle_deg,
                largest: r.largest,
                worst: range(r),
                common_bands_deg: &r.common_bands_deg,
                further_impacts: r.further_impacts,
            })
            .collect(),
        monte_carlo: &study.monte_carlo,
        sensitivities: &study.sensitivities,
        regime_maps: &study.maps,
    };
    let mut bytes = head(&study.rows)?;
    // The object of what was found goes on where the predictions end: its own opening brace gives way to a comma.
    let found = spread(&found)?;
    bytes.push(b',');
    bytes.extend(&found[1..]);
    bytes.push(b'\n');
    Ok(bytes)
}

/// The document up to the end of the predictions, its brace still open.
fn head(rows: &[PredictionRow]) -> Result<Vec<u8>, ReportError> {
    let compact = rows.len() > MOST_SPREAD;
    let chunks: Result<Vec<Vec<u8>>, serde_json::Error> = rows
        .par_chunks(CHUNK)
        .map(|rows| {
            let mut bytes = Vec::with_capacity(rows.len() * 600);
            for row in rows {
                bytes.extend(b"\n    ");
                if compact {
                    serde_json::to_writer(&mut bytes, row)?;
                } else {
                    row.serialize(&mut serde_json::Serializer::with_formatter(
                        &mut bytes,
                        SpreadFormat::below(2),
                    ))?;
                }
                bytes.push(b',');
            }
            Ok(bytes)
        })
        .collect();
    let mut bytes =
        format!("{{\n  \"schema\": \"{SCHEMA}\",\n  \"version\": \"{VERSION}\",\n  \"predictions\": [")
            .into_bytes();
    for chunk in chunks? {
        bytes.extend(chunk);
    }
    if bytes.ends_with(b",") {
        bytes.pop();
    }
    bytes.extend(b"\n  ]");
    Ok(bytes)
}

fn spread(value: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = Vec::new();
    value.serialize(&mut serde_json::Serializer::with_formatter(&mut bytes, SpreadFormat::below(0)))?;
    Ok(bytes)
}

/// Every key and every array within an array on a line of its own, the plain values of an array on one line: a curve of 181
/// numbers is a line, not a page.
struct SpreadFormat {
    /// Steps of indentation of what surrounds the document.
    base: usize,
    /// For every open object or array whether anything in it stands on a line of its own, and whether it is an array.
    open: Vec<(bool, bool)>,
}

impl SpreadFormat {
    fn below(base: usize) -> Self {
        Self { base, open: Vec::new() }
    }

    fn line<W: ?Sized + Write>(&self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b"\n")?;
        (0..self.base + self.open.len()).try_for_each(|_| writer.write_all(b"  "))
    }

    fn begin<W: ?Sized + Write>(&mut self, writer: &mut W, is_array: bool) -> io::Result<()> {
        if let Some((spread, true)) = self.open.last_mut() {
            *spread = true;
            self.line(writer)?;
        }
        self.open.push((false, is_array));
        writer.write_all(if is_array { b"[" } else { b"{" })
    }

    fn end<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        let (spread, is_array) = self.open.pop().unwrap_or_default();
        if spread {
            self.line(writer)?;
        }
        writer.write_all(if is_array { b"]" } else { b"}" })
    }
}

impl Formatter for SpreadFormat {
    fn begin_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.begin(writer, true)
    }

    fn end_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.end(writer)
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.begin(writer, false)
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.end(writer)
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if !first {
            writer.write_all(b",")?;
        }
        if let Some((spread, _)) = self.open.last_mut() {
            *spread = true;
        }
        self.line(writer)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::sample_study;
    use super::*;
    use serde_json::Value;

    fn read(bytes: &[u8]) -> Value {
        serde_json::from_slice(bytes).unwrap()
    }

    #[test]
    fn it_holds_every_part_of_the_study() {
        let study = sample_study::study();
        let json = read(&study_json(&study).unwrap());
        assert_eq!(json["schema"], "dropcheck.prediction/1");
        assert_eq!(json["predictions"][0]["model"], "rod");
        assert_eq!(json["predictions"][0]["contact"], "rough");
        assert_eq!(json["predictions"][0]["angle_deg"], 15.0);
        assert_eq!(json["ladders"][0]["steps"][0]["rung"], "rod");
        assert_eq!(json["critical_angles"][0]["criterion"], "speed");
        assert_eq!(json["critical_ranges"][0]["worst"]["contact"], "rough");
        assert_eq!(
            json["monte_carlo"]["quantiles"][0]["q50"].as_array().unwrap().len(),
            study.request.angles_deg.len()
        );
        assert_eq!(json["sensitivities"].as_array().unwrap().len(), study.sensitivities.len());
        assert_eq!(json["regime_maps"][0]["regimes"][0][0], "lift_off");
    }

    #[test]
    fn what_is_not_a_number_is_null() {
        let mut study = sample_study::study();
        study.rows[1].prediction.slap_down_speed_m_s = None;
        study.sensitivities[0].by_k_m_s[3] = f64::NAN;
        let json = read(&study_json(&study).unwrap());
        assert!(json["predictions"][1]["slap_down_speed_m_s"].is_null());
        assert!(json["sensitivities"][0]["by_k_m_s"][3].is_null());
    }

    #[test]
    fn few_predictions_are_spread_and_many_stand_on_a_line_each() {
        let rows = sample_study::study().rows;
        let json = |rows| study_json(&Study { rows, ..sample_study::study() }).unwrap();
        let text = String::from_utf8(json(rows.clone())).unwrap();
        assert!(text.contains("\n      \"k\": "), "{text}");
        let many = vec![rows[0].clone(); CHUNK + 5];
        let found = read(&json(many.clone()));
        assert_eq!(found["predictions"].as_array().unwrap().len(), many.len());
        let text = String::from_utf8(json(many)).unwrap();
        assert!(text.lines().filter(|line| line.starts_with("    {\"")).count() >= CHUNK + 5, "{text}");
    }

    #[test]
    fn curves_stand_on_a_line() {
        let text = String::from_utf8(study_json(&sample_study::study()).unwrap()).unwrap();
        // The mark by which the command line knows a file as its own lies within the first 64 bytes.
        assert!(text[..64].contains("\"schema\": \"dropcheck."));
        assert!(
            text.lines().any(|line| line.contains("\"q50\": [") && line.trim_end().ends_with("],")),
            "{text}"
        );
    }

    #[test]
    fn no_predictions_are_an_empty_list() {
        let study = Study { rows: Vec::new(), ..sample_study::study() };
        assert_eq!(read(&study_json(&study).unwrap())["predictions"], Value::Array(Vec::new()));
    }
}
