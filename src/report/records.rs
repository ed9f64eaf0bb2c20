//! Rows of cells to CSV, and words and numbers to cells.

use super::ReportError;
use super::text::printable;

/// Rows of cells, each a line.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub(crate) fn records<C: AsRef<[u8]>>(
    rows: impl IntoIterator<Item = impl IntoIterator<Item = C>>,
) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.into_iter().try_for_each(|row| writer.write_record(row))?;
    finished(writer)
}

/// What was written.
///
/// # Errors
/// [`ReportError::Csv`] where the writer failed.
pub(super) fn finished(writer: csv::Writer<Vec<u8>>) -> Result<Vec<u8>, ReportError> {
    writer.into_inner().map_err(|error| ReportError::Csv(csv::Error::from(error.into_error())))
}

/// A number; nothing where there is none.
pub(super) fn number(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string())
}

/// Words of a file as a cell that no spreadsheet takes for a formula.
pub(super) fn text_cell(text: &str) -> String {
    let text = printable(text);
    // Some spreadsheets skip blanks, and some take the full-width signs of a Japanese keyboard likewise.
    let is_formula = text.trim_start().starts_with(['=', '+', '-', '@', '＝', '＋', '－', '＠']);
    if is_formula { format!("'{text}") } else { text }
}
