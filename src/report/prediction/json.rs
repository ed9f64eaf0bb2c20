//! A study to JSON: an entry of a list on a line of its own, null for what is not a number.

use super::super::ReportError;
use crate::data::Study;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{json, to_vec};

/// `prediction.json`.
///
/// # Errors
/// [`ReportError::Json`] where the writer fails.
pub fn study_json(study: &Study) -> Result<Vec<u8>, ReportError> {
    let file = &study.cask_file;
    let input = json!({"cask": file.path.display().to_string(), "cask_sha256": file.sha256});
    let members = [
        ("schema", to_vec("dropcheck.prediction/1")?),
        ("version", to_vec(env!("CARGO_PKG_VERSION"))?),
        ("predictions", entries(&study.rows)?),
        ("input", to_vec(&input)?),
        ("ladders", entries(&study.ladders)?),
        ("critical_angles", entries(&study.critical)?),
        ("monte_carlo", to_vec(&study.monte_carlo)?),
        ("plan", to_vec(&study.plan)?),
    ];
    let members = members.map(|(key, value)| [format!("  \"{key}\": ").as_bytes(), &value].concat());
    Ok([b"{\n", &members.join(&b",\n"[..])[..], b"\n}\n"].concat())
}

/// A list, a line an entry; of seventy thousand predictions each core writes some.
fn entries<T: Serialize + Sync>(list: &[T]) -> Result<Vec<u8>, serde_json::Error> {
    let lines: Result<Vec<Vec<u8>>, serde_json::Error> = list.par_iter().map(to_vec).collect();
    let lines = lines?.join(&b",\n    "[..]);
    Ok(if lines.is_empty() { b"[]".into() } else { [b"[\n    ", &lines[..], b"\n  ]"].concat() })
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
        assert_eq!(
            json["monte_carlo"]["quantiles"][0]["q50"].as_array().unwrap().len(),
            study.request.angles_deg.len()
        );
    }

    #[test]
    fn what_is_not_a_number_is_null() {
        let mut study = sample_study::study();
        study.rows[1].prediction.slap_down_speed_m_s = None;
        study.monte_carlo.quantiles[0].q50[3] = f64::NAN;
        let json = read(&study_json(&study).unwrap());
        assert!(json["predictions"][1]["slap_down_speed_m_s"].is_null());
        assert!(json["monte_carlo"]["quantiles"][0]["q50"][3].is_null());
    }

    #[test]
    fn an_entry_stands_on_a_line() {
        let study = sample_study::study();
        let text = String::from_utf8(study_json(&study).unwrap()).unwrap();
        // The mark by which the command line knows a file as its own lies within the first 64 bytes.
        assert!(text[..64].contains("\"schema\": \"dropcheck."));
        let entries = text.lines().filter(|line| line.starts_with("    {\"angle_deg\":")).count();
        assert_eq!(entries, study.rows.len() + study.ladders.len(), "{text}");
    }

    #[test]
    fn no_predictions_are_an_empty_list() {
        let study = Study { rows: Vec::new(), ..sample_study::study() };
        assert_eq!(read(&study_json(&study).unwrap())["predictions"], Value::Array(Vec::new()));
    }
}
