//! Files of an analysis as bytes: table, JSON, HTML, pictures, curves. Nothing here writes a report's file.

mod acceleration_sources;
mod analysis;
#[cfg(test)]
mod analysis_tests;
pub(crate) mod as_html;
#[cfg(feature = "lab")]
pub(crate) mod as_markdown;
pub(crate) mod as_text;
mod campaign;
mod check;
mod complaint;
#[cfg(feature = "native")]
pub(crate) mod curves_h5;
#[cfg(feature = "native")]
mod curves_mcap;
pub(crate) mod document;
mod first_look;
mod first_screen;
mod grid;
mod impacts;
pub(crate) mod json;
mod kind;
mod latex;
mod listing;
pub(crate) mod pictures;
mod prediction;
mod reconstruction;
pub(crate) mod record;
pub(crate) mod records;
pub(crate) mod rounding;
#[cfg(test)]
mod sample;
#[cfg(test)]
mod sample_reconstruction;
#[cfg(test)]
mod sample_study;
mod shocks;
mod simulation;
mod srs;
pub(crate) mod table;
mod template;
pub(crate) mod text;
mod words;

pub use campaign::{
    Batch, BatchRow, CampaignColumn, CampaignFiles, PredictedCurve, campaign_columns, drop_curves,
    folder_name, impossible,
};
pub use check::{CHECK_NAMES, CheckedSetup, check_files, table as check_table};
#[cfg(feature = "native")]
pub(crate) use complaint::{in_lines, message_text};
pub use complaint::{message, sentence};
pub use first_look::{FIRST_LOOK_NAMES, FirstLook, drawn_sources};
pub use first_screen::{first_screen, why_not_strict};
pub use grid::in_german;
pub use json::{pretty as pretty_json, to_line};
pub use listing::table as listing_table;
pub use pictures::setup_picture;
pub use prediction::{study_file_names, study_files, study_json, study_table};
pub use template::{cask_file as cask_file_template, cask_file_with_list, sensor_list};
pub use text::sanitize;

use crate::data::{Analysis, ChannelCurve};
use crate::numerics::{as_f64, spectrum::magnitude};

/// Reason why a part of the report could not be made.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ReportError {
    /// The JSON writer failed.
    #[error("the JSON of the result could not be written")]
    Json(#[from] serde_json::Error),
    /// The CSV writer failed.
    #[error("the CSV table could not be written")]
    Csv(#[from] csv::Error),
    /// The MCAP writer failed.
    #[cfg(feature = "native")]
    #[error("the MCAP file could not be written")]
    Mcap(#[from] mcap::McapError),
    /// The HDF5 library failed.
    #[cfg(feature = "native")]
    #[error("the HDF5 file could not be written")]
    Hdf5(#[from] hdf5_metno::Error),
    /// The scratch file of the HDF5 library failed.
    #[cfg(feature = "native")]
    #[error("the HDF5 file needs a scratch file in {folder}, and that failed")]
    #[diagnostic(help("make room there, or set TMPDIR to a folder with room"))]
    Scratch {
        /// The folder for temporary files.
        folder: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Frequencies, Hz, and magnitude |∫ f e^(−iωt) dt|, m/s, of a channel's unfiltered force over the range
/// shown.
fn spectrum(curve: &ChannelCurve) -> (Vec<f64>, Vec<f64>) {
    let (Some(first_s), Some(last_s)) = (curve.time_s.first(), curve.time_s.last()) else {
        return (Vec::new(), Vec::new());
    };
    let sample_rate_hz = as_f64(curve.time_s.len().max(2) - 1) / (last_s - first_s);
    magnitude(curve.raw_m_s2.iter().copied(), sample_rate_hz)
}

/// Formats all tables of an analysis in lines of at most `width` columns, with SGR colours that the caller
/// strips if no terminal shows it.
pub fn table(analysis: &Analysis, width: usize) -> String {
    as_text::full_text(&analysis::document(analysis), width)
}

/// Names of the files of a report, in the order of [`files`]; the last one exists if a channel takes no part
/// in the motion.
pub const FILE_NAMES: &[&str] = &[
    "report.html",
    "result.json",
    "results.tex",
    "curves.csv",
    "srs.csv",
    #[cfg(feature = "native")]
    "curves.h5",
    #[cfg(feature = "native")]
    "curves.mcap",
    "setup.svg",
    "accelerations.svg",
    "impacts.svg",
    "crush.svg",
    "velocities.svg",
    "fit.svg",
    "motion.svg",
    "spectra.svg",
    "comparison.svg",
    "other_channels.svg",
];

/// The names of the files of this report.
fn file_names(analysis: &Analysis) -> &'static [&'static str] {
    let is_last = usize::from(analysis.result.other_channels.is_empty());
    &FILE_NAMES[..FILE_NAMES.len() - is_last]
}

/// Every file of a report by name, in the order for a reader.
///
/// # Errors
///
/// [`ReportError`] if one of them cannot be made; then none is returned.
pub fn files(analysis: &Analysis) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let (binary, ((curves_csv, spectra), pictures)) = rayon::join(
        || binary_curves(analysis),
        || {
            let tables = || (grid::table_bytes(&analysis.curves), srs::table_bytes(analysis));
            rayon::join(tables, || pictures::draw(analysis))
        },
    );
    let page = as_html::page(&analysis::document(analysis), &pictures).into_bytes();
    let (result, table) = (json::pretty(&analysis.result)?, latex::table(&analysis.result));
    let text = [page, result, table, curves_csv?, spectra?];
    let bytes =
        text.into_iter().chain(binary?).chain(pictures.into_iter().map(|picture| picture.svg.into_bytes()));
    Ok(file_names(analysis).iter().map(|name| (*name).to_owned()).zip(bytes).collect())
}

/// `curves.h5` and `curves.mcap`.
#[cfg(feature = "native")]
fn binary_curves(analysis: &Analysis) -> Result<Vec<Vec<u8>>, ReportError> {
    // curves.mcap takes as long as all the others together.
    let (mcap, h5) = rayon::join(|| curves_mcap::bytes(analysis), || curves_h5::bytes(analysis));
    Ok(vec![h5?, mcap?])
}

/// A page writes no file that it cannot show.
#[cfg(not(feature = "native"))]
#[allow(clippy::unnecessary_wraps, reason = "as where there are some")]
fn binary_curves(_: &Analysis) -> Result<Vec<Vec<u8>>, ReportError> {
    Ok(Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_holds_every_file_of_the_contract() {
        let files = files(&sample::with_other()).unwrap();
        assert!(files.iter().map(|(name, _)| name.as_str()).eq(FILE_NAMES.iter().copied()));
        assert!(files.iter().all(|(_, bytes)| !bytes.is_empty()));
    }

    #[test]
    fn an_analysis_without_a_single_curve_still_makes_a_report() {
        let files = files(&sample::without_anything()).unwrap();
        assert_eq!(files.len(), FILE_NAMES.len() - 1);
    }

    #[test]
    fn the_same_analysis_gives_the_same_bytes() {
        let analysis = sample::analysis();
        for (first, second) in files(&analysis).unwrap().iter().zip(&files(&analysis).unwrap()) {
            assert!(first.0 == "curves.h5" || first == second, "{} differs", first.0);
        }
    }
}
