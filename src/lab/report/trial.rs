//! A trial to its files: the pages that a site signs, those of single methods, JSON, Markdown, pictures and map.

mod document;
mod pictures;

use crate::lab::data::Trial;
use crate::report::{ReportError, as_html, as_markdown, as_text, json};

/// The files of a trial; the first is where a reader begins.
pub const TRIAL_NAMES: [&str; 7] = [
    "validation.html",
    "rivals.html",
    "validation.json",
    "validation.md",
    "speed.svg",
    "failures.svg",
    "rivals.svg",
];

/// The extract; `folder` is what leads from the document to the pictures ("" or ending in "/"), none leaves them out.
#[must_use]
pub fn trial_markdown(trial: &Trial, folder: Option<&str>) -> String {
    let [signed, rivals] = [document::document(trial), document::rivals(trial)];
    [signed, rivals].map(|document| as_markdown::markdown(&document, folder)).join("\n")
}

/// What a terminal shows at the end: the limits, and whether the program is accepted.
#[must_use]
pub fn trial_outcome(trial: &Trial) -> String {
    as_text::text(&document::verdict(trial))
}

/// Every file of a trial by name, in the order of [`TRIAL_NAMES`].
///
/// # Errors
/// [`ReportError`] where one of them cannot be made; then none is returned.
pub fn trial_files(trial: &Trial) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let pictures = [pictures::ways(trial), pictures::failures(trial), pictures::rivals(trial)];
    let pages = [document::document(trial), document::rivals(trial)];
    let [signed, rivals] = pages.map(|page| as_html::page(&page, &pictures).into_bytes());
    let [speed, failures, beside] = pictures.map(|picture| picture.svg.into_bytes());
    let extract = trial_markdown(trial, Some("")).into_bytes();
    let bytes = [signed, rivals, json::pretty(trial)?, extract, speed, failures, beside];
    Ok(TRIAL_NAMES.map(str::to_owned).into_iter().zip(bytes).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::data::{TrialMachine, TrialPoint, TrialRequest};

    fn trial() -> Trial {
        let point = |method: &str, is_default: bool, error: f64, time_ns: f64| TrialPoint {
            family: "filter".into(),
            method: method.into(),
            class: "order 2".into(),
            is_default,
            is_on_front: is_default,
            median_error: error,
            p95_error: 2.0 * error,
            error_unit: "of the peak".into(),
            time_ns,
            time_quartiles_ns: [0.9 * time_ns, 1.1 * time_ns],
            time_per: "sample".into(),
            cases: 3,
        };
        let size =
            |size, error, is_noticed| TrialSize { size, median_error: error, worst_error: error, is_noticed };
        let map = TrialMap {
            name: "rate".into(),
            what: "Rate".into(),
            unit: "Hz".into(),
            error: "error".into(),
            limit: 0.01,
            sizes: vec![
                size(100.0, Some(1e-3), true),
                size(1e3, Some(0.1), false),
                size(1e4, Some(1e9), true),
            ],
        };
        let machine = TrialMachine {
            processor: "processor".into(),
            cores: 2,
            system: "linux".into(),
            is_optimised: true,
        };
        Trial {
            schema: "dropcheck.validation/2",
            version: "0.1.0",
            request: TrialRequest { quick: true, seed: 1 },
            machine,
            points: vec![point("state-variable", true, 1e-14, 8.0), point("direct form", false, 1e-9, 19.0)],
            maps: vec![map],
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
        assert_eq!(back["points"][1]["method"], "direct form");
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
        let page = page(&trial);
        assert!(!page.contains("<img") && !page.contains('\u{1b}'));
        for call in ["href=", "url(", "@import", "<script", "https://"] {
            assert!(!page.contains(call), "{call}");
        }
    }

    #[test]
    fn a_beaten_default_is_named_and_a_map_says_where_it_fails() {
        let mut trial = trial();
        trial.points[0].is_on_front = false;
        let page = page(&trial);
        assert!(page.contains("off the front in: order 2"));
        assert!(
            trial_markdown(&trial, None).contains("| 1000 Hz | diverges | 1 of 2 |"),
            "{}",
            trial_markdown(&trial, None)
        );
    }
}
