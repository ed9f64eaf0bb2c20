//! Findings on a table of delimited text: code, severity and sentence of each.

use super::{IssueCode as Code, Severity};

findings! {
/// A finding about the rows of a table.
pub enum TableFinding of Table {
    /// The last line ends in the middle.
    CutLine { line: u64 } => (Code::Truncated, Warning, Nothing),
        ("line {line}, the last, ends in the middle and was dropped: the file was cut off while it was \
         written or copied");
    /// Zero bytes from a line on.
    ZeroBytes { line: u64 } => (Code::Truncated, Warning, Nothing),
        ("from line {line} on stand zero bytes, as where a logger was not closed or a copy failed: the rows \
         before are whole, what follows was not read; where rows stand behind, copy the file again");
    /// The header states more samples than the table has rows.
    RowsMissing { stated: u64, rows: usize } => (Code::Truncated, Warning, Nothing),
        ("the lines above the table state {stated} samples, and it has {rows} rows: what is missing was \
         lost, or the file was cut off; samples lost amid the rows would make all behind them early");
    /// A column that counts the rows jumps, first after a row (from 1) with this count.
    CounterJumps { header: String, lost: f64, count: f64, row: usize } => (Code::Gap, Warning, LostSamples),
        ("the column {header:?} counts the rows, and {lost} of them are missing, the first {count} behind \
         row {row} of the table; the others keep their places by it");
    /// A column that counts the rows jumps, but the times that the cask file names do not.
    CounterBesideTimes { header: String, lost: f64, row: usize, times: String } =>
        (Code::Gap, Warning, LostSamples),
        ("the column {header:?} counts the rows, and {lost} of them are missing, the first behind row {row} \
         of the table; the times in {times:?}, which the cask file names, go on without a gap and were \
         followed");
}
}
