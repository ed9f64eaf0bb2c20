//! A line of the tables that stand for the rows of a sensor list to the cell that it comes from.

use super::wording::line_of;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The key of the cask file that names the list.
pub(super) const SENSORS: &str = "sensors";

/// A sensor list, read.
pub(super) struct SensorList {
    pub path: PathBuf,
    pub text: String,
    /// The tables of its rows.
    pub tables: String,
    cells: Vec<ListCell>,
}

/// A line of those tables with the cell that it comes from; without a column it is a row.
struct ListCell {
    begins: usize,
    span: Range<usize>,
    column: String,
}

/// A cask file that names a sensor list, with the tables of the list behind its own.
pub(super) struct ExpandedCaskFile {
    pub text: String,
    /// Where the tables of the list begin in it.
    pub from: usize,
    pub list: SensorList,
}

impl SensorList {
    pub fn new(path: &Path, text: String) -> Self {
        Self { path: path.to_owned(), text, tables: String::new(), cells: Vec::new() }
    }

    /// Adds a line to the tables, of this span of the list.
    pub fn push(&mut self, line: &str, span: Range<usize>, column: &str) {
        self.cells.push(ListCell { begins: self.tables.len(), span, column: column.to_owned() });
        self.tables.push_str(line);
        self.tables.push('\n');
    }

    /// The line of the list, its column as words for a message, and the span of the cell that a byte of the
    /// tables comes from.
    pub fn place(&self, at: usize) -> ListPlace {
        let next = self.cells.partition_point(|cell| cell.begins <= at);
        let cell = &self.cells[next.saturating_sub(1)];
        let words = if cell.column.is_empty() { String::new() } else { format!("column {}: ", cell.column) };
        ListPlace { line: line_of(self.text.as_bytes(), cell.span.start), words, span: cell.span.clone() }
    }
}

/// A cell of a list.
pub(super) struct ListPlace {
    pub line: usize,
    /// "column plane_m: ".
    pub words: String,
    pub span: Range<usize>,
}
