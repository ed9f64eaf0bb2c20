//! A document to the text that a terminal shows, 80 columns wide, with SGR colours that the caller strips where none are read.

use super::document::{Content, Document, Fact, Passage, Role, Tone};
use super::medium::Medium;
use super::rounding::MISSING;
use super::table::{Table, TableColumn, TableShape};
use super::text::{Style, WIDTH, lines, printable, styled, styled_lines, wrap};
use comfy_table::{CellAlignment, ContentArrangement, TableStyle};

/// Columns that a name takes, and its value.
const FACT_WIDTH: usize = 22;

/// The whole document.
pub(crate) fn text(document: &Document) -> String {
    let mut out = String::new();
    for chapter in &document.chapters {
        out.extend(chapter.heading(Medium::Terminal).map(heading));
        out.extend(chapter.shown(Medium::Terminal).into_iter().map(passage));
    }
    out
}

fn heading(words: &str) -> String {
    format!("\n{}\n", styled(Style::Bold, &printable(words)))
}

fn passage(passage: &Passage) -> String {
    match &passage.content {
        Content::Sentence(role, words) => {
            let words = words.on(Medium::Terminal);
            match role {
                Role::Title => styled_lines(Style::Bold, &wrap(words, WIDTH, 0)),
                Role::Line => wrap(words, WIDTH, 0),
                Role::Lead | Role::Text | Role::Note => wrap(words, WIDTH, 2),
            }
        }
        Content::Banner(Tone(style, word), sentence) => format!("\n{}  {sentence}\n", styled(*style, word)),
        Content::Facts(caption, facts) => {
            let head = if caption.is_empty() { String::new() } else { heading(caption) };
            head + &lines(facts.iter().map(fact))
        }
        Content::Table(table) => self::table(table),
        Content::Beside(columns) => columns
            .iter()
            .flatten()
            .filter(|passage| passage.is_shown(Medium::Terminal))
            .map(self::passage)
            .collect(),
        Content::Figures(_) | Content::Picture(..) | Content::List(_) => String::new(),
    }
}

fn fact(fact: &Fact) -> String {
    let words = fact.shown_note();
    let note = if words.is_empty() { String::new() } else { styled(fact.note.0, words) };
    let line = format!("  {:<FACT_WIDTH$}{:<FACT_WIDTH$}{note}", fact.name, fact.value);
    line.trim_end().to_owned()
}

fn table(table: &Table) -> String {
    let columns = table.shown(Medium::Terminal);
    let (rows, left_out) = table.rows(Medium::Terminal);
    let mut out = match &table.shape {
        TableShape::Columns => aligned(&columns, rows, 2),
        TableShape::Fitting => aligned(&columns, rows, if fits(&columns, rows) { 2 } else { 1 }),
        TableShape::Groups(names) => grouped(&columns, rows, names),
        TableShape::Items => (0..rows).map(|row| item(&columns, row)).collect(),
        TableShape::ApartItems => (0..rows).flat_map(|row| ["\n".to_owned(), item(&columns, row)]).collect(),
    };
    if let Some(sentence) = left_out {
        out += &wrap(&sentence, WIDTH, 2);
    }
    out
}

/// The words of a cell; `None` where the table has no such row.
fn cell(column: &TableColumn, row: usize) -> String {
    column.cells.get(row).map_or_else(String::new, |cell| printable(cell.words.on(Medium::Terminal)))
}

/// Whether columns two apart are narrower than the terminal.
fn fits(columns: &[&TableColumn], rows: usize) -> bool {
    let width = |text: &str| text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    let widest = |column: &&TableColumn| {
        let cells = (0..rows).map(|row| width(&cell(column, row)));
        cells.chain([width(column.head.on(Medium::Terminal))]).max().unwrap_or(0)
    };
    columns.iter().map(|column| widest(column) + 2).sum::<usize>() <= WIDTH - 2
}

/// A line of heads and the rows, the columns `gap` apart; cells too wide are wrapped.
fn aligned(columns: &[&TableColumn], rows: usize, gap: u16) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(TableStyle::new());
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(u16::try_from(WIDTH - 2).unwrap_or(78));
    table.set_header(columns.iter().map(|column| column.head.on(Medium::Terminal)));
    for row in 0..rows {
        table.add_row(columns.iter().map(|column| cell(column, row)));
    }
    for (set, column) in table.column_iter_mut().zip(columns) {
        set.set_padding((0, gap));
        if column.is_number() {
            set.set_cell_alignment(CellAlignment::Right);
        }
    }
    lines(table.lines().map(|line| format!("  {}", line.trim_end())))
}

/// The table with the name of each group on a line of its own above its rows.
fn grouped(columns: &[&TableColumn], rows: usize, names: &[String]) -> String {
    let table = aligned(columns, rows, 2);
    let head = table.lines().count().saturating_sub(rows);
    // A cell that is wrapped all the same has more lines than rows: then only the first group can be placed.
    let is_aligned = head == aligned(columns, 0, 2).lines().count();
    let mut out = Vec::new();
    for (i, text) in table.lines().enumerate() {
        if let Some(row) = i.checked_sub(head).filter(|_| is_aligned)
            && (row == 0 || names.get(row) != names.get(row - 1))
        {
            out.push(format!("  {}", printable(&names[row])));
        }
        out.push(text.to_owned());
    }
    lines(out)
}

/// The first cell in its colour, those that are not missing beside it, the last one below.
fn item(columns: &[&TableColumn], row: usize) -> String {
    let [first, middle @ .., last] = columns else { return String::new() };
    let style = first.cells[row].style.unwrap_or(Style::Bold);
    let place: Vec<String> =
        middle.iter().map(|column| cell(column, row)).filter(|words| words != MISSING).collect();
    let head = format!("  {}  {}\n", styled(style, &cell(first, row)), place.join(" · "));
    head + &wrap(&cell(last, row), WIDTH, 6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_cell_is_wrapped_within_the_width() {
        let rows = [("A1", "word ".repeat(40), "1.0")];
        let rows =
            Table::of(&rows).text("name", |r| r.0).text("words", |r| &r.1[..]).number("number", |r| r.2);
        let text = table(&rows.into());
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert_eq!(text.matches("word").count(), 41);
    }
}
