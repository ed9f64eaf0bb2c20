//! Files of a trial: the pages that a site signs, JSON, Markdown, pictures and map.

mod document;
mod pictures;

use crate::lab::data::Trial;
use crate::report::{ReportError, as_html, as_markdown, as_text, json};

/// Names of the files; a reader begins with the first.
pub const TRIAL_NAMES: [&str; 5] =
    ["validation.html", "validation.json", "validation.md", "speed.svg", "failures.svg"];

/// Text for a terminal at the end: the limits, and if the program is accepted.
pub fn trial_outcome(trial: &Trial, width: usize) -> String {
    as_text::text(&document::verdict(trial), width)
}

/// Every file of a trial by name, in the order of [`TRIAL_NAMES`].
///
/// # Errors
///
/// [`ReportError`] if one of them cannot be made; then none is returned.
pub fn trial_files(trial: &Trial) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let pictures = [pictures::ways_picture(trial), pictures::failures(trial)];
    let document = document::document(trial);
    let page = as_html::page(&document, &pictures).into_bytes();
    let [speed, failures] = pictures.map(|picture| picture.svg.into_bytes());
    let bytes = [page, json::pretty(trial)?, as_markdown::markdown(&document).into_bytes(), speed, failures];
    Ok(TRIAL_NAMES.map(str::to_owned).into_iter().zip(bytes).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::data::{
        KnownSilence, TrialDrop, TrialFate, TrialLimit, TrialMachine, TrialMap, TrialPoint, TrialRequest,
        TrialSize,
    };
    use crate::lab::methods::{ALL_CLASSES, WAYS};

    fn trial() -> Trial {
        let point = |method: &str, is_default: bool, error: f64, time_ns: f64| TrialPoint {
            family: WAYS[0].into(),
            method: method.into(),
            class: ALL_CLASSES.into(),
            is_default,
            median_error: error,
            p95_error: 2.0 * error,
            error_unit: "%".into(),
            time_ns,
            cases: 3,
            matters: 1.0,
            ..TrialPoint::default()
        };
        let points = [point("as taken", true, 0.1, 1.5e7), point("by hand", false, 9.0, 5e6)];
        let k = points.iter().map(|p| TrialPoint { family: WAYS[1].into(), ..p.clone() });
        let drop = |fate, off| TrialDrop { fate, half_widths_off: off, is_named: true, is_elastic: false };
        let size =
            |size, fate, off| TrialSize { size, drops: vec![drop(TrialFate::Inside, None), drop(fate, off)] };
        let map = TrialMap {
            name: "rate".into(),
            what: "Rate".into(),
            unit: "Hz".into(),
            told_by: vec![],
            instead: "with a gauge".into(),
            known: None,
            sizes: vec![
                size(100.0, TrialFate::Warned, Some(1.2)),
                size(1e3, TrialFate::Silent, Some(3.2)),
                size(1e4, TrialFate::Refused, None),
            ],
        };
        let limit = TrialLimit {
            name: "held".into(),
            unit: "%".into(),
            value: Some(95.0),
            least: Some(90.0),
            most: None,
            reason: "Because".into(),
            which: String::new(),
        };
        let machine = TrialMachine {
            processor: "processor".into(),
            cores: 2,
            system: "linux".into(),
            program_sha256: "0123".into(),
            program_commit: Some("4567abc"),
            when: "2026-11-24 12:00 UTC".into(),
            is_optimised: true,
        };
        Trial {
            schema: "dropcheck.validation/3",
            version: "0.1.0",
            request: TrialRequest { quick: true, seed: 1 },
            machine,
            points: points.iter().cloned().chain(k).collect(),
            maps: vec![map],
            limits: vec![limit],
        }
    }

    /// The page as text.
    fn page(trial: &Trial) -> String {
        String::from_utf8(trial_files(trial).unwrap().swap_remove(0).1).unwrap()
    }

    #[test]
    fn the_files_are_whole_and_named() {
        let trial = trial();
        let files = trial_files(&trial).unwrap();
        assert!(files.iter().zip(TRIAL_NAMES).all(|(file, name)| file.0 == name && !file.1.is_empty()));
        assert_eq!(trial_files(&trial).unwrap(), files);
        let back: serde_json::Value = serde_json::from_slice(&files[1].1).unwrap();
        assert_eq!(back["points"][1]["method"], "by hand");
        let nothing = Trial { points: vec![], maps: vec![], ..trial };
        assert_eq!(trial_files(&nothing).unwrap().len(), TRIAL_NAMES.len());
    }

    #[test]
    fn the_page_stands_alone_and_words_are_escaped() {
        let mut trial = trial();
        let evil = "<img src=x onerror=alert(1)>\u{1b}[2J";
        trial.points[0].method = evil.into();
        trial.maps[0].what = evil.into();
        trial.machine.processor = evil.into();
        trial.limits[0].which = evil.into();
        let page = page(&trial);
        assert!(!page.contains("<img") && !page.contains('\u{1b}'));
        for call in ["href=", "url(", "@import", "<script", "https://"] {
            assert!(!page.contains(call), "{call}");
        }
    }

    #[test]
    fn what_is_silent_comes_with_what_to_measure_and_a_limit_that_is_not_kept_is_named() {
        let mut trial = trial();
        let text = page(&trial);
        assert!(text.contains("unnoticed from 1000, warned from 100, refused from 10000 Hz"), "{text}");
        assert!(text.contains("with a gauge") && text.contains("ACCEPTED") && !text.contains("NOT ACCEPTED"));
        assert!(
            text.contains("within 0.20 % of the speed") && text.contains("another way (by hand; 5.0 ms)")
        );
        // The result of the recorded full run is shown although three drops did not reproduce it.
        let known = Some(KnownSilence { becomes: "unnoticed from 7 mm", off: "4.5" });
        let unseen = TrialMap { name: "play".into(), sizes: vec![], known, ..trial.maps[0].clone() };
        trial.maps.push(unseen);
        let text = page(&trial);
        for words in ["2 of 2 damages", "quick one saw 1)", "unnoticed from 7 mm", "not seen"] {
            assert!(text.contains(words), "{words} in {text}");
        }
        assert!(trial_outcome(&trial, 80).contains("2 kinds of damage"));
        for value in [Some(80.0), None, Some(f64::NAN)] {
            trial.limits[0].value = value;
            assert!(!trial.is_accepted());
            let outcome = trial_outcome(&trial, 80);
            assert!(outcome.contains("NOT ACCEPTED") && outcome.contains("Beyond: held"), "{outcome}");
        }
    }
}
