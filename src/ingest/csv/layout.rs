//! The beginning of a text to its layout: delimiter, decimal mark, header, units, where the rows begin.

use super::input::{self, Input};
use super::stamp;
use super::time_column::{self, Scale};
use crate::ingest::{number, time_unit};

/// One column of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Column {
    /// Its header as written, or its number from 1.
    pub header: String,
    /// The header without its unit.
    pub name: String,
    /// Its unit, from the header or the row of units.
    pub unit: Option<String>,
    /// Whether its cells are numbers.
    pub is_numeric: bool,
    /// Whether its cells are date-time stamps or clock times.
    pub is_stamped: bool,
    /// Its cell in the first row.
    pub example: String,
}

/// How a text is laid out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    /// Between cells; a space stands for any run of blanks.
    pub delimiter: u8,
    /// Decimal mark.
    pub decimal: u8,
    /// The columns.
    pub columns: Vec<Column>,
    /// Whether they are headed.
    pub has_header: bool,
    /// Line of the header, from 1; 0 without one.
    pub header_line: u64,
    /// Lines before the header (or the rows).
    pub preamble_lines: u64,
    /// Line of the first row, from 1.
    pub data_line: u64,
    /// Where the first row begins in [`Input::head`].
    pub data_offset: usize,
    /// The column of times, where one was found.
    pub time_column: Option<usize>,
    is_decimal_seen: bool,
    mean_row_bytes: usize,
}

/// Delimiter and decimal mark, likeliest first where a file fits several.
const DIALECTS: [(u8, u8); 8] = [
    (b';', b','),
    (b';', b'.'),
    (b'\t', b'.'),
    (b'\t', b','),
    (b',', b'.'),
    (b',', b','),
    (b' ', b'.'),
    (b' ', b','),
];

/// So many of the last lines of the head decide on the dialect.
const JUDGED_LINES: usize = 200;

/// Units beside those of time that a row of units may hold, in lower case.
const UNITS: [&str; 40] = [
    "g", "mg", "gn", "m/s2", "m/s^2", "m/s²", "m/s**2", "mm/s2", "mm/s^2", "v", "mv", "µv", "n", "kn", "hz",
    "khz", "°c", "degc", "k", "bar", "pa", "kpa", "mpa", "%", "-", "1", "mm", "m", "rad/s", "deg/s", "°/s",
    "deg", "°", "a", "ma", "µm/m", "um/m", "kg", "nm", "rad",
];

struct Line<'a> {
    offset: usize,
    text: std::borrow::Cow<'a, str>,
}

/// What the judged lines say under one dialect.
struct Judged {
    score: i64,
    columns: usize,
    is_numeric: Vec<bool>,
    is_stamped: Vec<bool>,
}

impl Layout {
    /// The layout of `input`; `None` where its head holds no rows of numbers.
    pub(super) fn of(input: &Input) -> Option<Self> {
        let lines = lines(input);
        let judged_lines = &lines[lines.len().saturating_sub(JUDGED_LINES)..];
        let mut best: Option<((u8, u8), Judged)> = None;
        for dialect in DIALECTS {
            let Some(judged) = judge(judged_lines, dialect) else { continue };
            if best.as_ref().is_none_or(|(_, held)| judged.score > held.score) {
                best = Some((dialect, judged));
            }
        }
        let ((delimiter, decimal), judged) = best?;
        let first = lines.iter().position(|line| is_row(&split(&line.text, delimiter), decimal, &judged))?;
        let rows = &lines[first..];
        let cells: Vec<Vec<&str>> = rows.iter().map(|line| split(&line.text, delimiter)).collect();
        let header = header(&lines[..first], delimiter, &judged);
        let last = &lines[lines.len() - 1];
        let row_bytes = (last.offset + last.text.len() + 1).saturating_sub(rows[0].offset);
        let mut columns = columns(header.as_ref(), &judged, &cells[0]);
        if columns.len() > 1 && columns.last().is_some_and(|c| c.header.is_empty() && !c.is_numeric) {
            columns.pop();
        }
        let above = header.as_ref().map_or(first, |header| header.line);
        Some(Self {
            delimiter,
            decimal,
            has_header: header.is_some(),
            header_line: header.as_ref().map_or(0, |header| header.line as u64 + 1),
            preamble_lines: above as u64,
            data_line: first as u64 + 1,
            data_offset: rows[0].offset,
            is_decimal_seen: cells
                .iter()
                .flatten()
                .any(|cell| cell.as_bytes().contains(&decimal) && is_number(cell, decimal)),
            time_column: time_column::find(
                &columns,
                header.is_none() && is_first_rising(&cells, decimal),
                decimal,
                |column| cells.iter().filter_map(move |cells| cells.get(column).copied()),
            ),
            mean_row_bytes: (row_bytes / rows.len()).max(2),
            columns,
        })
    }

    /// The columns whose header, or header without unit, is `wanted`.
    pub(super) fn find(&self, wanted: &str) -> Vec<usize> {
        let wanted = wanted.trim();
        let matching = |of: fn(&Column) -> &str| -> Vec<usize> {
            (0..self.columns.len()).filter(|&i| of(&self.columns[i]) == wanted).collect()
        };
        let exact = matching(|column| &column.header);
        if exact.is_empty() { matching(|column| &column.name) } else { exact }
    }

    /// Every header.
    pub(super) fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.header.clone()).collect()
    }

    /// What the numbers of a column of times count.
    pub(super) fn time_scale(&self, column: usize) -> Scale {
        self.columns.get(column).map_or(Scale::Unknown, Scale::of)
    }

    /// The other decimal mark, where rows seen so far hold neither and it is no delimiter.
    pub(super) fn other_decimal(&self) -> Option<u8> {
        let other = if self.decimal == b',' { b'.' } else { b',' };
        (!self.is_decimal_seen && self.delimiter != other).then_some(other)
    }

    /// About how many rows a file of so many bytes holds, a little more.
    pub(super) fn rows_expected(&self, bytes: u64) -> usize {
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        (bytes / self.mean_row_bytes).saturating_add(bytes / self.mean_row_bytes / 32 + 16)
    }
}

/// The whole lines of the head.
fn lines(input: &Input) -> Vec<Line<'_>> {
    let mut lines = Vec::new();
    let mut offset = 0;
    for line in input.head.split_inclusive(|&b| b == b'\n') {
        // Past the head's end the line goes on.
        if line.ends_with(b"\n") || input.is_whole {
            let bare = line.strip_suffix(b"\n").unwrap_or(line);
            let bare = bare.strip_suffix(b"\r").unwrap_or(bare);
            lines.push(Line { offset, text: input::text(bare) });
        }
        offset += line.len();
    }
    lines
}

/// Cells of a line, without blanks and quotes around them.
fn split(line: &str, delimiter: u8) -> Vec<&str> {
    if delimiter == b' ' {
        return line.split_ascii_whitespace().collect();
    }
    let mut cells = Vec::new();
    let (mut from, mut is_quoted) = (0, false);
    for (at, byte) in line.bytes().enumerate() {
        if byte == b'"' {
            is_quoted = !is_quoted;
        } else if byte == delimiter && !is_quoted {
            cells.push(bare(&line[from..at]));
            from = at + 1;
        }
    }
    cells.push(bare(&line[from..]));
    cells
}

fn bare(cell: &str) -> &str {
    let cell = cell.trim();
    cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).map_or(cell, str::trim)
}

fn is_number(cell: &str, decimal: u8) -> bool {
    number::of_cell(cell.as_bytes(), decimal).is_some()
}

fn is_value(cell: &str, decimal: u8) -> bool {
    is_number(cell, decimal) || stamp::is_stamp(cell.as_bytes())
}

fn judge(lines: &[Line], (delimiter, decimal): (u8, u8)) -> Option<Judged> {
    let rows: Vec<Vec<&str>> = lines
        .iter()
        .map(|line| split(&line.text, delimiter))
        .filter(|cells| cells.iter().any(|cell| is_value(cell, decimal)))
        .collect();
    // The commonest number of cells, the larger where two are as common.
    let mut counts: Vec<usize> = rows.iter().map(Vec::len).collect();
    counts.sort_unstable();
    let columns = counts.chunk_by(|a, b| a == b).max_by_key(|same| same.len())?.first().copied()?;
    let rows: Vec<&Vec<&str>> = rows.iter().filter(|cells| cells.len() == columns).collect();
    let mut score = 0;
    let (mut values, mut stamps) = (vec![0_usize; columns], vec![0_usize; columns]);
    let mut words = vec![0_i64; columns];
    for cells in &rows {
        for (column, cell) in cells.iter().enumerate() {
            if is_value(cell, decimal) {
                score += 1;
                values[column] += 1;
                stamps[column] += usize::from(stamp::is_stamp(cell.as_bytes()));
            } else if number::is_grouped(cell) {
                // A number too, though it is not read: other delimiters would cut it to pieces that are.
                score += 1;
            } else if !number::is_missing(cell.as_bytes()) {
                words[column] += 1;
            }
        }
    }
    // A word among numbers speaks against the dialect, a column of words does not.
    score -= (0..columns).filter(|&c| values[c] > 0).map(|c| 2 * words[c]).sum::<i64>();
    let filled = |column: usize| {
        rows.iter().filter(|cells| !number::is_missing(cells[column].as_bytes())).count().max(1)
    };
    let is_numeric: Vec<bool> = (0..columns).map(|c| 2 * values[c] > filled(c)).collect();
    let is_stamped = (0..columns).map(|c| 2 * stamps[c] > filled(c)).collect();
    is_numeric.contains(&true).then_some(Judged { score, columns, is_numeric, is_stamped })
}

/// Whether a line is a row: as many cells, numbers (or nothing) in the columns of numbers, and more numbers than not.
///
/// Stamps count only where there is nothing else: one that cannot be read makes a line no header.
fn is_row(cells: &[&str], decimal: u8, judged: &Judged) -> bool {
    if cells.len() != judged.columns {
        return false;
    }
    let is_plain = |c: usize| judged.is_numeric[c] && !judged.is_stamped[c];
    let has_plain = (0..judged.columns).any(is_plain);
    let decisive: Vec<&str> = (0..judged.columns)
        .filter(|&c| if has_plain { is_plain(c) } else { judged.is_numeric[c] })
        .map(|c| cells[c])
        .collect();
    let values = decisive.iter().filter(|cell| is_value(cell, decimal)).count();
    2 * values >= decisive.len()
        && decisive.iter().all(|cell| is_value(cell, decimal) || number::is_missing(cell.as_bytes()))
}

fn is_first_rising(rows: &[Vec<&str>], decimal: u8) -> bool {
    let firsts: Option<Vec<f64>> = rows
        .iter()
        .filter(|cells| !matches!(cells[..], [] | [""]))
        .map(|cells| cells.first().and_then(|cell| number::of_cell(cell.as_bytes(), decimal)))
        .collect();
    firsts.is_some_and(|firsts| firsts.len() > 1 && firsts.windows(2).all(|w| w[0] < w[1]))
}

struct Header {
    /// Index of its line.
    line: usize,
    cells: Vec<String>,
    units: Option<Vec<String>>,
}

/// The header above the rows, with the row of units where there is one.
fn header(above: &[Line], delimiter: u8, judged: &Judged) -> Option<Header> {
    // A delimiter may end the rows and not the header; a header short of a column of numbers would head the wrong ones.
    let is_last_empty = judged.is_numeric.last() == Some(&false);
    let fitting = |index: usize| {
        let cells = header_cells(&above[index].text, delimiter);
        (cells.len() == judged.columns || (is_last_empty && cells.len() + 1 == judged.columns))
            .then_some(cells)
    };
    let mut filled = (0..above.len()).rev().filter(|&i| !above[i].text.trim().is_empty());
    let nearest = filled.next()?;
    let cells = fitting(nearest)?;
    let is_units = cells.iter().any(|cell| !cell.is_empty()) && cells.iter().all(|cell| is_unit(cell));
    if is_units
        && let Some(line) = filled.next()
        && let Some(names) = fitting(line)
        && names.iter().any(|name| !name.is_empty())
    {
        return Some(Header { line, cells: names, units: Some(cells) });
    }
    Some(Header { line: nearest, cells, units: None })
}

/// A header's cells by the rules of CSV (quotes, doubled quotes), without the mark of a comment.
fn header_cells(line: &str, delimiter: u8) -> Vec<String> {
    let line = line.trim_start_matches(['#', '%']).trim_start_matches(' ');
    if delimiter == b' ' {
        return line.split_ascii_whitespace().map(str::to_owned).collect();
    }
    let mut reader = ::csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .trim(::csv::Trim::All)
        .from_reader(line.as_bytes());
    let record = reader.records().next().and_then(Result::ok).unwrap_or_default();
    record.iter().map(str::to_owned).collect()
}

fn is_unit(cell: &str) -> bool {
    let bare = cell.trim_matches(['[', ']', '(', ')']).to_lowercase();
    // "A1 [g]" is a name with its unit.
    let is_bracketed = cell.starts_with(['[', '(']) && cell.ends_with([']', ')']);
    // "hh:mm:ss.000".
    let is_clock = bare.contains(':') && bare.bytes().all(|b| b"dmyhsf0:.,/- ".contains(&b));
    cell.is_empty()
        || is_bracketed
        || is_clock
        || time_unit::seconds(&bare).is_some()
        || UNITS.contains(&bare.as_str())
}

fn columns(header: Option<&Header>, judged: &Judged, first_row: &[&str]) -> Vec<Column> {
    (0..judged.columns)
        .map(|index| {
            let header_text = match header {
                Some(header) => header.cells.get(index).cloned().unwrap_or_default(),
                None => (index + 1).to_string(),
            };
            let (name, own_unit) = name_and_unit(&header_text);
            let row_unit = header.and_then(|h| h.units.as_ref()).and_then(|units| units.get(index));
            let row_unit = row_unit.map(|unit| unit.trim_matches(['[', ']', '(', ')']).to_owned());
            Column {
                name: name.to_owned(),
                unit: row_unit.or_else(|| own_unit.map(str::to_owned)).filter(|unit| !unit.is_empty()),
                header: header_text,
                is_numeric: judged.is_numeric[index],
                is_stamped: judged.is_stamped[index],
                example: first_row.get(index).map_or("", |cell| cell).to_owned(),
            }
        })
        .collect()
}

/// "A1 [g]", "A1 (g)" or "A1 / g" to "A1" and "g".
fn name_and_unit(header: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(rest) = header.strip_suffix(close)
            && let Some((name, unit)) = rest.rsplit_once(open)
            && !name.trim().is_empty()
        {
            // "time[0]" counts the columns.
            let is_index = unit.bytes().all(|b| b.is_ascii_digit());
            return (name.trim(), (!is_index).then(|| unit.trim()));
        }
    }
    match header.rsplit_once(" / ") {
        Some((name, unit)) if is_unit(unit.trim()) => (name.trim(), Some(unit.trim())),
        _ => (header, None),
    }
}
