//! Rows of anything to CSV: a head beside what makes its cells, column by column.

use super::ReportError;
use super::text::printable;
use rayon::prelude::*;

/// A head, and what makes a cell below it.
pub(crate) type CsvColumn<R> = (&'static str, fn(R) -> String);

/// Rows that one core writes at a time: enough that handing them out costs nothing.
pub(super) const CHUNK: usize = 2048;

/// The heads and a line a row.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub(crate) fn records<R: Copy + Send + Sync>(
    columns: &[CsvColumn<R>],
    rows: impl IntoIterator<Item = R>,
) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| column.0))?;
    let lines = |rows: &[R]| {
        let mut writer = csv::Writer::from_writer(Vec::new());
        rows.iter().try_for_each(|row| writer.write_record(columns.iter().map(|column| column.1(*row))))?;
        finished(writer)
    };
    let rows: Vec<R> = rows.into_iter().collect();
    let chunks: Result<Vec<Vec<u8>>, ReportError> = rows.par_chunks(CHUNK).map(lines).collect();
    Ok([finished(writer)?, chunks?.concat()].concat())
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
    value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string())
}

/// Words of a file as a cell that no spreadsheet takes for a formula.
pub(super) fn text_cell(text: &str) -> String {
    let text = printable(text);
    // Some spreadsheets skip blanks, and some take the full-width signs of a Japanese keyboard likewise.
    let is_formula = text.trim_start().starts_with(['=', '+', '-', '@', '＝', '＋', '－', '＠']);
    if is_formula { format!("'{text}") } else { text }
}
