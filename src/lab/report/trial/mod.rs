//! A trial of the methods to its files: page, JSON, CSV, Markdown and charts.

mod breaks;
mod csv;
mod document;
mod failure_chart;
mod families;
mod reasons;
#[cfg(test)]
mod sample;
mod speed_chart;

use crate::lab::data::Trial;
use crate::report::pictures::draw::Picture;
use crate::report::{ReportError, as_html, as_markdown, json};

/// The files of a trial that have the same name whatever was tried; the charts stand beside them.
pub const TRIAL_NAMES: [&str; 5] =
    ["validation.html", "validation.json", "points.csv", "maps.csv", "validation.md"];

/// The extract; `folder` is what leads from the document to the charts ("" or ending in "/"), none leaves them out.
#[must_use]
pub fn trial_markdown(trial: &Trial, folder: Option<&str>) -> String {
    as_markdown::markdown(&document::document(trial), folder)
}

/// Every file of a trial by name, in the order in which a reader meets them.
///
/// # Errors
/// [`ReportError`] where one of them cannot be made; then none is returned.
pub fn trial_files(trial: &Trial) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let pictures = charts(trial);
    let document = document::document(trial);
    let bytes = [
        as_html::page(&document, &pictures).into_bytes(),
        json::pretty(trial)?,
        csv::points(trial)?,
        csv::maps(trial)?,
        as_markdown::markdown(&document, Some("")).into_bytes(),
    ];
    let mut files: Vec<(String, Vec<u8>)> = TRIAL_NAMES.map(str::to_owned).into_iter().zip(bytes).collect();
    files.extend(pictures.into_iter().map(|p| (format!("{}.svg", p.name), p.svg.into_bytes())));
    Ok(files)
}

/// A chart for each family and each map.
fn charts(trial: &Trial) -> Vec<Picture> {
    let speed = families::families(trial);
    let speed = speed.iter().map(speed_chart::picture);
    speed.chain(trial.maps.iter().map(failure_chart::picture)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_are_whole_and_named() {
        let trial = sample::trial();
        let files = trial_files(&trial).unwrap();
        assert!(files.iter().zip(TRIAL_NAMES).all(|(file, name)| file.0 == name && !file.1.is_empty()));
        // A chart for the family and one for the map.
        assert_eq!(files.len(), TRIAL_NAMES.len() + 2);
        assert_eq!(trial_files(&trial).unwrap(), files);
        let back: Trial = serde_json::from_slice(&files[1].1).unwrap();
        // Numbers come back to a rounding.
        assert_eq!((back.request, back.maps.len()), (trial.request, trial.maps.len()));
        assert!(back.points.iter().map(|p| &p.method).eq(trial.points.iter().map(|p| &p.method)));
    }

    #[test]
    fn a_trial_of_nothing_still_makes_a_page() {
        let nothing = Trial { points: vec![], is_on_front: vec![], maps: vec![], ..sample::trial() };
        assert_eq!(trial_files(&nothing).unwrap().len(), TRIAL_NAMES.len());
    }
}
