//! A study of predictions to its files: page, JSON, CSV and pictures; and to the table of the terminal.

mod critical;
mod csv;
mod json;
mod models;
mod plan;
mod rows;
mod study;
#[cfg(test)]
mod study_tests;

pub use json::study_json;
pub(super) use rows::prediction_columns;

use super::ReportError;
use super::{as_html, as_text, pictures};
use crate::data::{Study, StudyRequest};

/// The names of the files that [`study_files`] makes for a study of this request, in its order.
pub fn study_file_names(request: &StudyRequest) -> Vec<String> {
    let own = ["prediction.html", "prediction.json", "prediction.csv"].map(str::to_owned);
    own.into_iter()
        .chain(pictures::study_names(request).into_iter().map(|name| format!("{name}.svg")))
        .collect()
}

/// The whole of a study for the terminal.
pub fn study_table(study: &Study, width: usize) -> String {
    as_text::text(&study::document(study), width)
}

/// Every file of a study by name, in the order in which a reader meets them.
///
/// # Errors
/// [`ReportError`] where one of them cannot be made; then none is returned.
pub fn study_files(study: &Study) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let (pictures, (json, csv)) = rayon::join(
        || pictures::draw_study(study),
        || rayon::join(|| json::study_json(study), || csv::csv(&study.rows)),
    );
    let page = as_html::page(&study::document(study), &pictures).into_bytes();
    let pictures = pictures.into_iter().map(|picture| picture.svg.into_bytes());
    let bytes = [page, json?, csv?].into_iter().chain(pictures);
    Ok(study_file_names(&study.request).into_iter().zip(bytes).collect())
}

#[cfg(test)]
mod tests {
    use super::super::sample_study;
    use super::*;

    #[test]
    fn the_files_are_those_that_the_request_names() {
        for study in [sample_study::study(), sample_study::swept(), sample_study::without_slap_down()] {
            let files = study_files(&study).unwrap();
            let names = study_file_names(&study.request);
            assert!(files.iter().map(|(name, _)| name).eq(&names), "{names:?}");
            assert!(files.iter().all(|(_, bytes)| !bytes.is_empty()));
        }
    }

    #[test]
    fn the_same_study_gives_the_same_bytes() {
        let study = sample_study::swept();
        assert_eq!(study_files(&study).unwrap(), study_files(&study).unwrap());
    }
}
