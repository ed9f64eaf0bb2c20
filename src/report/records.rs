//! Rows of anything to CSV: a head beside what makes its cells, column by column.

use super::ReportError;
use super::text::printable;

/// A head, and what makes a cell below it.
pub(crate) type CsvColumn<R> = (&'static str, fn(R) -> String);

/// The heads and a line a row.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub(crate) fn records<R: Copy>(
    columns: &[CsvColumn<R>],
    rows: impl IntoIterator<Item = R>,
) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| column.0))?;
    for row in rows {
        writer.write_record(columns.iter().map(|column| column.1(row)))?;
    }
    finished(writer)
}

/// What was written.
///
/// # Errors
/// [`ReportError::Csv`] where the writer failed.
pub(crate) fn finished(writer: csv::Writer<Vec<u8>>) -> Result<Vec<u8>, ReportError> {
    writer.into_inner().map_err(|error| ReportError::Csv(csv::Error::from(error.into_error())))
}

/// A number; nothing where there is none.
pub(crate) fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |v| v.to_string())
}

/// Words of a file as a cell that no spreadsheet takes for a formula.
pub(super) fn text_cell(text: &str) -> String {
    let text = printable(text);
    // Some spreadsheets skip blanks, and some take the full-width signs of a Japanese keyboard likewise.
    let is_formula = text.trim_start().starts_with(['=', '+', '-', '@', '＝', '＋', '－', '＠']);
    if is_formula { format!("'{text}") } else { text }
}
