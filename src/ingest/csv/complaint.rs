//! What is wrong with a table's rows, columns or times, in words.

use super::super::error::{self, IngestError};
use super::super::refusal::Refusal;
use super::super::{ReadRequest, RecordingFile};
use super::layout::Layout;
use super::rows::RowError;
use super::wanted::Wanted;
use std::path::Path;

/// No table at all.
pub(super) fn no_table(path: &Path) -> IngestError {
    let mend = "export one row a sample with comma, semicolon or tab between the columns, and no quotes \
                around a whole row";
    error::of_file(path, Refusal::new("no rows of numbers were found", mend).at("the first 64 KiB"))
}

/// A row that cannot be read.
pub(super) fn row_error(
    ReadRequest { file: RecordingFile { path, .. }, limits, .. }: ReadRequest,
    (layout, wanted): (&Layout, &Wanted),
    error: RowError,
) -> IngestError {
    let column = |slot: usize| wanted.columns.get(slot).and_then(|&column| layout.columns.get(column));
    let headed = |slot| format!("column {:?}", column(slot).map_or("", |column| &column.header));
    let (line, problem, mend) = match error {
        RowError::Io(source) => return error::io(path, &source),
        RowError::TooMany => {
            return limits.refusal(path, "the samples of the columns read take", limits.samples_bytes());
        }
        RowError::TooLong { line } => {
            return limits.refusal(path, &format!("line {line} takes"), limits.line_bytes());
        }
        RowError::Word { line, slot, cell }
            if wanted.is_time.get(slot) == Some(&true) && !cell.contains(|c: char| c.is_ascii_digit()) =>
        (
            line,
            format!("{} holds {cell:?}, which is no time: another table begins there", headed(slot)),
            "delete that line and those below it in a copy; a remark between two rows alone".to_owned(),
        ),
        RowError::Word { line, slot, cell } if wanted.is_time.get(slot) == Some(&true) => (
            line,
            format!("{} holds {cell:?}, which is no time, or not written as the ones before", headed(slot)),
            "times are numbers, date-time stamps (2026-11-20T12:34:56.789, 20.11.2026 12:34:56,789) or clock \
             times (12:34:56.789); correct the cell in a copy, or name another column of times"
                .to_owned(),
        ),
        RowError::Word { line, slot, cell } => (
            line,
            format!("{} holds {cell:?}, which is no number", headed(slot)),
            format!(
                "the decimal mark of this file is taken as {:?}, without thousands separators; correct the \
                 cell in a copy, or empty it: an empty cell counts as missing",
                char::from(layout.dialect.decimal)
            ),
        ),
        RowError::Short { line, cells } => (
            line,
            format!(
                "it has {cells} of {} cells, and between blanks nothing says which one is missing",
                layout.columns.len()
            ),
            "write NaN for the missing value in a copy, or export with commas or semicolons between the cells"
                .to_owned(),
        ),
        RowError::NoTime { line, slot } => (
            line,
            format!("{} holds no time for this row", headed(slot)),
            "fill the time in, or empty the cells of the channels that it times in that row of a copy; or \
             name another column of times"
                .to_owned(),
        ),
    };
    error::of_file(path, Refusal::new(problem, mend).at(&format!("line {line}")))
}
