//! Rows of text to aligned columns of at most the table's width.

use super::text::{WIDTH, lines, printable};
use comfy_table::{CellAlignment, ContentArrangement, Table, TableStyle};

/// A heading, a rule and the rows; the columns in `right` are set to the right, cells too wide are wrapped.
pub(super) fn columns(header: &[&str], rows: &[Vec<String>], right: &[usize]) -> String {
    spaced_columns(header, rows, right, 2)
}

/// [`columns`], closer together where they would not fit otherwise.
pub(super) fn fitting_columns(header: &[&str], rows: &[Vec<String>], right: &[usize]) -> String {
    let width = |text: &str| text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    let widest = |i: usize| {
        let cells = rows.iter().filter_map(|row| row.get(i)).map(|cell| width(cell));
        cells.chain(header.get(i).map(|head| width(head))).max().unwrap_or(0)
    };
    let needed: usize = (0..header.len()).map(|i| widest(i) + 2).sum();
    spaced_columns(header, rows, right, if needed > WIDTH - 2 { 1 } else { 2 })
}

fn spaced_columns(header: &[&str], rows: &[Vec<String>], right: &[usize], gap: u16) -> String {
    let mut table = Table::new();
    table.load_style(TableStyle::new());
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(u16::try_from(WIDTH - 2).unwrap_or(78));
    table.set_header(header.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>());
    for row in rows {
        table.add_row(row.iter().map(|cell| printable(cell)).collect::<Vec<_>>());
    }
    for (i, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, gap));
        if right.contains(&i) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    lines(table.lines().map(|line| format!("  {}", line.trim_end())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_cell_is_wrapped_within_the_width() {
        let rows = vec![vec!["A1".to_owned(), "word ".repeat(40), "1.0".to_owned()]];
        let text = columns(&["name", "words", "number"], &rows, &[2]);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert_eq!(text.matches("word").count(), 41);
    }
}
