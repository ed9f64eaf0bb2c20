//! Sets a document as text for a terminal of a given width, with SGR colours that the caller strips if they
//! cannot be shown.

use super::document::{
    CellKind, ChapterPart, Fact, Medium, PartContent, ReportColumn, ReportDocument, ReportTable,
    SentenceRole, TableCell, TableShape, Tone,
};
use super::rounding::MISSING;
use super::text::{Style, lines, paint, sanitize, styled_lines, wrap};
use comfy_table::ColumnConstraint::LowerBoundary;
use comfy_table::{CellAlignment, ContentArrangement, TableStyle, Width};

/// Columns that a name takes, and its value.
const FACT_WIDTH: usize = 22;

/// The whole document, in lines of at most `width` columns; its tables without their captions.
pub(crate) fn text(document: &ReportDocument, width: usize) -> String {
    write_document(document, width, false)
}

/// The document with all parts of its page, in lines of at most `width` columns.
pub(crate) fn full_text(document: &ReportDocument, width: usize) -> String {
    write_document(document, width, true)
}

fn write_document(document: &ReportDocument, width: usize, has_captions: bool) -> String {
    let mut out = String::new();
    for chapter in &document.chapters {
        out.extend(chapter.heading(Medium::Terminal).map(|words| heading(words, width)));
        out.extend(
            chapter.parts_on(Medium::Terminal).into_iter().map(|part| passage(part, width, has_captions)),
        );
    }
    out
}

fn heading(words: &str, width: usize) -> String {
    "\n".to_owned() + &styled_lines(Style::Bold, &wrap(words, width, 0))
}

fn passage(passage: &ChapterPart, width: usize, has_captions: bool) -> String {
    match &passage.content {
        PartContent::Sentence(role, words) => {
            let words = words.text_on(Medium::Terminal);
            match role {
                SentenceRole::Title => styled_lines(Style::Bold, &wrap(words, width, 0)),
                SentenceRole::Line => wrap(words, width, 0),
                SentenceRole::Lead | SentenceRole::Text | SentenceRole::Note => wrap(words, width, 2),
            }
        }
        PartContent::Banner(Tone(style, word), sentence) => {
            let indent = word.chars().count() + 2;
            let words = wrap(sentence, width, indent);
            format!("\n{}{}", paint(*style, word), &words[word.len().min(indent)..])
        }
        PartContent::Facts(caption, facts) => {
            let head = if caption.is_empty() { String::new() } else { heading(caption, width) };
            let names = facts.iter().map(|one| one.name.chars().count() + 2).max().unwrap_or(0);
            head + &lines(facts.iter().map(|one| fact(one, names.clamp(FACT_WIDTH, width / 2), width)))
        }
        PartContent::ReportTable(table) => {
            let caption = sanitize(&table.caption).replace('`', "");
            let is_captioned = has_captions && !caption.is_empty() && !table.chosen.is_empty();
            let caption = if is_captioned { wrap(&caption, width, 2) } else { String::new() };
            styled_lines(Style::Dim, &caption) + &self::table(table, width)
        }
        PartContent::Beside(columns) => columns
            .iter()
            .flatten()
            .filter(|passage| passage.is_shown(Medium::Terminal))
            .map(|part| self::passage(part, width, has_captions))
            .collect(),
        // A terminal shows no pictures.
        _ => String::new(),
    }
}

/// A name, its value and the remark beside one another, or below the name if they do not fit.
fn fact(fact: &Fact, names: usize, width: usize) -> String {
    let words = fact.shown_note();
    let line = format!("  {:<names$}{:<FACT_WIDTH$}", fact.name, fact.value);
    let line = if line.trim_end().chars().count() > width {
        format!("  {}\n{}", fact.name, wrap(&fact.value, width, 6).trim_end())
    } else {
        line
    };
    if words.is_empty() {
        return line.trim_end().to_owned();
    }
    let note = paint(fact.note.0, words);
    // A note that does not fit beside the value goes below it.
    let is_beside = line.chars().count() + words.chars().count() <= width;
    if is_beside { line + &note } else { format!("{}\n      {note}", line.trim_end()) }
}

fn table(table: &ReportTable, width: usize) -> String {
    let columns = table.columns_on(Medium::Terminal);
    let (rows, left_out) = table.rows(Medium::Terminal);
    let gap =
        if table.shape == TableShape::Fitting && !fits(&columns, rows, width, longest_line) { 1 } else { 2 };
    // A row with many cells that does not fit a line becomes a list, as on a phone.
    let longest_word = |head: &str| head.split_whitespace().map(|word| word.chars().count()).max();
    let is_stacked = columns.len() > 3 && !fits(&columns, rows, width, longest_word);
    let apart = if table.shape == TableShape::ApartItems { "\n" } else { "" };
    let mut out = match &table.shape {
        TableShape::Columns if is_stacked => (0..rows).map(|row| stack(&columns, row, width)).collect(),
        TableShape::Columns | TableShape::Fitting => lines(align(&columns, rows, gap, width).concat()),
        TableShape::Groups(names) => group(&columns, rows, names, width),
        TableShape::Items | TableShape::ApartItems => {
            (0..rows).map(|row| apart.to_owned() + &item(&columns, row, width)).collect()
        }
    };
    if let Some(sentence) = left_out {
        out += &wrap(&sentence, width, 2);
    }
    out
}

/// The words of a cell; `None` if the table has no such row.
fn cell(column: &ReportColumn, row: usize) -> String {
    let words = |cell: &TableCell| sanitize(cell.words.text_on(Medium::Terminal)) + cell.mark;
    column.cells.get(row).map_or_else(String::new, words)
}

/// The longest line of words.
fn longest_line(words: &str) -> Option<usize> {
    words.lines().map(|line| line.chars().count()).max()
}

/// True if columns two apart, with heads as wide as `of_head` gives, are narrower than the terminal.
fn fits(columns: &[&ReportColumn], rows: usize, most: usize, of_head: fn(&str) -> Option<usize>) -> bool {
    let widest = |column: &&ReportColumn| {
        let cells = (0..rows).map(|row| longest_line(&cell(column, row)));
        cells.chain([of_head(column.head.text_on(Medium::Terminal))]).flatten().max().unwrap_or(0)
    };
    columns.iter().map(|column| widest(column) + 2).sum::<usize>() <= most - 2
}

/// The lines of the heads, and those of each row, with `gap` between the columns; cells that are too wide are
/// wrapped.
fn align(columns: &[&ReportColumn], rows: usize, gap: u16, width: usize) -> Vec<Vec<String>> {
    /// Marks the beginning of a row in a separate column, which is then removed: a row may have several
    /// lines.
    const BEGINS: char = '•';
    let mut table = comfy_table::Table::new();
    table.load_style(TableStyle::new());
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(u16::try_from(width - 1).unwrap_or(79));
    let row = |cells: Vec<String>| [BEGINS.to_string()].into_iter().chain(cells);
    table.set_header(row(columns.iter().map(|c| c.head.text_on(Medium::Terminal).to_owned()).collect()));
    for i in 0..rows {
        table.add_row(row(columns.iter().map(|column| cell(column, i)).collect()));
    }
    let is_narrow = !fits(columns, rows, width, longest_line);
    for (i, set) in table.column_iter_mut().enumerate() {
        set.set_padding((0, if i == 0 { 0 } else { gap }));
        let column = i.checked_sub(1).map(|i| columns[i]);
        let Some(column) = column.filter(|column| column.kind == CellKind::Number) else { continue };
        set.set_cell_alignment(CellAlignment::Right);
        if is_narrow {
            // A number must not be broken across lines, since its parts would be other numbers.
            let longest = (0..rows).map(|row| cell(column, row).chars().count()).max().unwrap_or(0);
            let most = (width / 2).min(longest + usize::from(gap));
            set.set_constraint(LowerBoundary(Width::Fixed(u16::try_from(most).unwrap_or(40))));
        }
    }
    let mut found: Vec<Vec<String>> = Vec::new();
    for line in table.lines() {
        let own = line.strip_prefix(BEGINS);
        let text = format!("  {}", own.or(line.strip_prefix(' ')).unwrap_or_default().trim_end());
        match found.last_mut().filter(|_| own.is_none()) {
            Some(row) => row.push(text),
            None => found.push(vec![text]),
        }
    }
    found
}

/// Writes a table with the name of each group on a separate line above its rows.
fn group(columns: &[&ReportColumn], rows: usize, names: &[String], width: usize) -> String {
    let mut out = Vec::new();
    let mut before = "";
    for (i, row) in align(columns, rows, 2, width).into_iter().enumerate() {
        // Index 0 belongs to the heads.
        let name = i.checked_sub(1).and_then(|i| names.get(i)).map_or("", String::as_str);
        if name != before {
            out.push(format!("  {}", sanitize(name)).trim_end().to_owned());
        }
        out.extend(row);
        before = name;
    }
    lines(out)
}

/// Writes the first cell, and below it the others that are not missing, each after its head.
fn stack(columns: &[&ReportColumn], row: usize, width: usize) -> String {
    let [first, others @ ..] = columns else { return String::new() };
    let cells = others.iter().map(|column| (column.head.text_on(Medium::Terminal), cell(column, row)));
    let cells = cells.filter(|(_, words)| words != MISSING && !words.is_empty());
    let cells: Vec<String> = cells.map(|(head, words)| format!("{head}: {words}")).collect();
    let head = wrap(&cell(first, row), width, 2);
    styled_lines(Style::Bold, &head) + &wrap(&cells.join(" · "), width, 6)
}

/// The first cell in its colour, those that are not missing beside it, the last one below.
fn item(columns: &[&ReportColumn], row: usize, width: usize) -> String {
    let [first, middle @ .., last] = columns else { return String::new() };
    let style = first.cells[row].style.unwrap_or(Style::Bold);
    let place: Vec<String> =
        middle.iter().map(|column| cell(column, row)).filter(|words| words != MISSING).collect();
    let head = format!("  {}  {}\n", paint(style, &cell(first, row)), place.join(" · "));
    head + &wrap(&cell(last, row), width, 6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_cell_is_wrapped_within_the_width() {
        let rows = [("A1", "word ".repeat(40), "1.0")];
        let rows = ReportTable::from_rows(&rows)
            .text("name", |r| r.0)
            .text("words", |r| &r.1[..])
            .number("number", |r| r.2);
        let rows: ReportTable = rows.into();
        for width in [60, 80, 200] {
            let text = table(&rows, width);
            assert!(text.lines().all(|line| line.chars().count() <= width), "{text}");
            assert_eq!(text.matches("word").count(), 41);
        }
    }

    #[test]
    fn groups_are_named_whatever_wraps() {
        let names = ["/cask/first_end/imu", "/cask/first_end/imu", "", "/cask/second_end/imu"];
        let fields = ["  .linear_acceleration.of_the_upper_sensor.x", "  .y", "A column with a name", "  .z"];
        let table: ReportTable = ReportTable::from_rows(&fields)
            .head("source", |f| *f)
            .text("words", |f| if *f == "  .y" { "word ".repeat(30) } else { "–".into() })
            .number("samples", |_| "200000")
            .into();
        let names = names.map(str::to_owned);
        for width in [60, 80] {
            let text = group(&table.columns_on(Medium::Terminal), fields.len(), &names, width);
            assert!(text.lines().all(|line| line.chars().count() <= width), "{text}");
            let at = |part: &str| text.lines().position(|line| line.trim_start().starts_with(part));
            let [first, second] = ["/cask/first_end/imu", "/cask/second_end/imu"].map(at);
            assert_eq!(text.matches("/imu").count(), 2, "each once: {text}");
            assert!(first.is_some() && first < at(".linear") && at(".y") < at("A column"), "{text}");
            assert!(at("A column") < second && second.map(|at| at + 1) == at(".z"), "{text}");
        }
    }
}
