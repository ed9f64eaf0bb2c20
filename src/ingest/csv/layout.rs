//! The beginning of a text to its layout: delimiter, decimal mark, header, units, where the rows begin.

use super::input::{self, Input};
use super::stamp;
use crate::ingest::number;

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
    is_decimal_seen: bool,
    is_first_rising: bool,
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

/// Words that head a column of times, without their unit.
const TIME_NAMES: [&str; 17] = [
    "time",
    "t",
    "zeit",
    "times",
    "timestamp",
    "time stamp",
    "zeitstempel",
    "messzeit",
    "uhrzeit",
    "elapsed time",
    "relative time",
    "rel. time",
    "sec",
    "seconds",
    "temps",
    "tempo",
    "tiempo",
];

/// Units that a row of units may hold, in lower case.
const UNITS: [&str; 49] = [
    "s", "sec", "ms", "us", "µs", "μs", "ns", "min", "h", "g", "mg", "gn", "m/s2", "m/s^2", "m/s²", "m/s**2",
    "mm/s2", "mm/s^2", "v", "mv", "µv", "n", "kn", "hz", "khz", "°c", "degc", "k", "bar", "pa", "kpa", "mpa",
    "%", "-", "1", "mm", "m", "rad/s", "deg/s", "°/s", "deg", "°", "a", "ma", "µm/m", "um/m", "kg", "nm",
    "rad",
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
        let header = header(&lines[..first], delimiter, judged.columns);
        let rows = &lines[first..];
        let last = &lines[lines.len() - 1];
        let row_bytes = (last.offset + last.text.len() + 1).saturating_sub(rows[0].offset);
        let mut columns = columns(header.as_ref(), &judged);
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
            is_decimal_seen: rows.iter().any(|line| {
                split(&line.text, delimiter)
                    .iter()
                    .any(|c| c.as_bytes().contains(&decimal) && is_number(c, decimal))
            }),
            is_first_rising: is_first_rising(rows, delimiter, decimal),
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

    /// The column of times: by its header, by its stamps, or the first of a table without header where it rises.
    pub(super) fn time_column(&self) -> Option<usize> {
        let bare: Vec<String> = self
            .columns
            .iter()
            .map(|column| without_unit_suffix(&column.name.to_lowercase()).0.to_owned())
            .collect();
        bare.iter()
            .position(|name| TIME_NAMES.contains(&name.as_str()))
            .or_else(|| bare.iter().position(|name| name.starts_with("time") || name.starts_with("zeit")))
            .or_else(|| self.columns.iter().position(|column| column.is_stamped))
            .or_else(|| (!self.has_header && self.columns.len() > 1 && self.is_first_rising).then_some(0))
    }

    /// Seconds per unit of a column of times; `None` where its unit is none of time.
    pub(super) fn time_scale_s(&self, column: usize) -> Option<f64> {
        let column = self.columns.get(column)?;
        let name = column.name.to_lowercase();
        let unit = column.unit.as_deref().or(without_unit_suffix(&name).1);
        match unit.map(|unit| unit.trim().to_lowercase()).as_deref() {
            None | Some("" | "s" | "sec" | "secs" | "second" | "seconds" | "sekunden" | "-") => Some(1.0),
            Some("ms" | "msec" | "milliseconds") => Some(1e-3),
            Some("us" | "µs" | "μs" | "usec" | "microseconds") => Some(1e-6),
            Some("ns" | "nsec" | "nanoseconds") => Some(1e-9),
            Some("min") => Some(60.0),
            Some(_) if column.is_stamped => Some(1.0),
            Some(_) => None,
        }
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
    for cells in &rows {
        for (column, cell) in cells.iter().enumerate() {
            if is_value(cell, decimal) {
                score += 1;
                values[column] += 1;
                stamps[column] += usize::from(stamp::is_stamp(cell.as_bytes()));
            } else if !number::is_missing(cell.as_bytes()) {
                score -= 2;
            }
        }
    }
    let filled = |column: usize| {
        rows.iter().filter(|cells| !number::is_missing(cells[column].as_bytes())).count().max(1)
    };
    let is_numeric: Vec<bool> = (0..columns).map(|c| 2 * values[c] > filled(c)).collect();
    let is_stamped = (0..columns).map(|c| 2 * stamps[c] > filled(c)).collect();
    is_numeric.contains(&true).then_some(Judged { score, columns, is_numeric, is_stamped })
}

/// Whether a line is a row: as many cells, numbers (or nothing) in the columns of numbers, and more numbers than not.
fn is_row(cells: &[&str], decimal: u8, judged: &Judged) -> bool {
    if cells.len() != judged.columns {
        return false;
    }
    let numeric = || cells.iter().zip(&judged.is_numeric).filter(|(_, is_numeric)| **is_numeric);
    let values = numeric().filter(|(cell, _)| is_value(cell, decimal)).count();
    2 * values >= numeric().count()
        && numeric().all(|(cell, _)| is_value(cell, decimal) || number::is_missing(cell.as_bytes()))
}

fn is_first_rising(rows: &[Line], delimiter: u8, decimal: u8) -> bool {
    let firsts: Option<Vec<f64>> = rows
        .iter()
        .filter(|line| !line.text.trim().is_empty())
        .map(|line| {
            split(&line.text, delimiter).first().and_then(|cell| number::of_cell(cell.as_bytes(), decimal))
        })
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
fn header(above: &[Line], delimiter: u8, columns: usize) -> Option<Header> {
    let fitting = |index: usize| {
        let cells = header_cells(&above[index].text, delimiter);
        (cells.len() == columns || cells.len() + 1 == columns).then_some(cells)
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
    cell.is_empty() || is_bracketed || UNITS.contains(&bare.as_str())
}

fn columns(header: Option<&Header>, judged: &Judged) -> Vec<Column> {
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

/// `time_ms` to `time` and `ms`.
fn without_unit_suffix(name: &str) -> (&str, Option<&str>) {
    match name.rsplit_once('_') {
        Some((bare, unit @ ("s" | "sec" | "ms" | "us" | "ns"))) => (bare, Some(unit)),
        _ => (name, None),
    }
}
