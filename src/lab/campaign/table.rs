//! Cells to a Markdown table, and numbers to cells.

use std::fmt::Write;

/// A table while it is filled.
pub(super) struct Table {
    text: String,
}

impl Table {
    /// With these heads.
    pub(super) fn new(heads: &[&str]) -> Self {
        let mut table = Self { text: String::new() };
        table.row(heads.iter().map(|&head| head.to_owned()));
        table.row(heads.iter().map(|_| "---".to_owned()));
        table
    }

    /// One more row.
    pub(super) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        for cell in cells {
            // Writing to a string does not fail.
            let _ = write!(self.text, "| {cell} ");
        }
        self.text.push_str("|\n");
    }

    /// The Markdown.
    pub(super) fn finish(self) -> String {
        self.text
    }
}

/// A number with this many decimals; a dash where there is none.
pub(super) fn number(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "–".to_owned() }
}

/// A share in percent.
#[allow(clippy::cast_precision_loss, reason = "counts of scenes")]
pub(super) fn share(part: usize, of: usize) -> String {
    if of == 0 { "–".to_owned() } else { format!("{:.1} %", 100.0 * part as f64 / of as f64) }
}
