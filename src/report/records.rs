//! Writes rows of cells as CSV, and formats words and numbers as cells.

use super::ReportError;
use super::text::sanitize;

/// Writes rows of cells, one per line.
///
/// # Errors
///
/// [`ReportError::Csv`] if the writer fails.
pub(crate) fn records<C: AsRef<[u8]>>(
    rows: impl IntoIterator<Item = impl IntoIterator<Item = C>>,
) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.into_iter().try_for_each(|row| writer.write_record(row))?;
    finish(writer)
}

/// Returns the written bytes.
///
/// # Errors
///
/// [`ReportError::Csv`] if the writer failed.
pub(super) fn finish(writer: csv::Writer<Vec<u8>>) -> Result<Vec<u8>, ReportError> {
    writer.into_inner().map_err(|error| ReportError::Csv(csv::Error::from(error.into_error())))
}

/// Formats a number; empty if there is none.
pub(super) fn number(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string())
}

/// Formats words of a file as a cell that no spreadsheet treats as a formula.
pub(super) fn text_cell(text: &str) -> String {
    let text = sanitize(text);
    // Some spreadsheets skip blanks, and some accept the full-width signs of a Japanese keyboard too.
    let is_formula = text.trim_start().starts_with(['=', '+', '-', '@', '＝', '＋', '－', '＠']);
    if is_formula { format!("'{text}") } else { text }
}
