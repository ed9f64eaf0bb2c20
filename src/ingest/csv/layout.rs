//! The beginning of a text to its layout: delimiter, decimal mark, header, units, where the rows begin.

use super::header;
use super::input::{self, Input};
use super::preamble::Preamble;
use super::stamp;
use super::time_column;
use crate::ingest::number;
use crate::ingest::stated_rate::{Agreement, StatedRate};
use crate::ingest::time_reading::Scale;

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
#[derive(Debug, Clone, PartialEq)]
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
    /// Columns that are certain to hold times, that one and others.
    sure_times: Vec<usize>,
    /// Rates that a header of LabVIEW's states, by cell.
    rates: Vec<Option<StatedRate>>,
    /// What else is stated above the rows.
    pub preamble: Preamble,
    is_decimal_seen: bool,
    mean_row_bytes: usize,
    /// Whether blank lines stand between the rows, as doubled line breaks leave them.
    pub is_spaced: bool,
}

/// Delimiter and decimal mark, likeliest first where a file fits several.
const DIALECTS: [(u8, u8); 10] = [
    (b';', b','),
    (b';', b'.'),
    (b'\t', b'.'),
    (b'\t', b','),
    (b',', b'.'),
    (b',', b','),
    (b'|', b'.'),
    (b'|', b','),
    (b' ', b'.'),
    (b' ', b','),
];

/// So many of the last lines of the head decide on the dialect.
const JUDGED_LINES: usize = 200;

/// A line of the head.
pub(super) struct Line<'a> {
    offset: usize,
    pub text: std::borrow::Cow<'a, str>,
}

/// What the judged lines say under one dialect.
pub(super) struct Judged {
    score: i64,
    pub columns: usize,
    pub is_numeric: Vec<bool>,
    pub is_stamped: Vec<bool>,
    /// Columns without a single value or word.
    pub is_empty: Vec<bool>,
}

impl Layout {
    /// The layout of `input`; `None` where its head holds no rows of numbers.
    pub(super) fn of(input: &Input) -> Option<Self> {
        let lines = lines(input);
        let begin = header::labview_lines(&lines);
        let judged_lines = &lines[lines.len().saturating_sub(JUDGED_LINES).max(begin)..];
        let mut best: Option<((u8, u8), Judged)> = None;
        for dialect in DIALECTS {
            let Some(judged) = judge(judged_lines, dialect) else { continue };
            if best.as_ref().is_none_or(|(_, held)| judged.score > held.score) {
                best = Some((dialect, judged));
            }
        }
        let ((delimiter, decimal), judged) = best?;
        let is_row = |line: &Line| is_row(&split(&line.text, delimiter), decimal, &judged);
        let first = begin + lines[begin..].iter().position(is_row)?;
        let cells: Vec<Vec<&str>> = lines[first..].iter().map(|line| split(&line.text, delimiter)).collect();
        let header = header::header(&lines[..first], delimiter, &judged);
        let mut columns = header::columns(header.as_ref(), &judged, &cells[0]);
        // A pair of columns may have ended before the judged rows begin.
        for ((column, cell), _) in
            columns.iter_mut().zip(&cells[0]).zip(&judged.is_empty).filter(|(_, e)| **e)
        {
            column.is_numeric = is_value(cell, decimal);
            column.is_stamped = stamp::is_stamp(cell.as_bytes());
        }
        while columns.len() > 1 && columns.last().is_some_and(|c| c.header.is_empty() && !c.is_numeric) {
            columns.pop();
        }
        let times = time_column::find(
            &columns,
            header.is_none() && is_first_rising(&cells, decimal),
            decimal,
            |column| cells.iter().filter_map(move |cells| cells.get(column).copied()),
        );
        let extra = match (times.taken, &header) {
            (Some(column), Some(_)) => extremes(&cells, column, decimal),
            _ => 0,
        };
        let (first, cells) = (first + extra, &cells[extra..]);
        let last = &lines[lines.len() - 1];
        let row_bytes = (last.offset + last.text.len() + 1).saturating_sub(lines[first].offset);
        let above = header.as_ref().map_or(first, |header| header.line);
        Some(Self {
            delimiter,
            decimal,
            has_header: header.is_some(),
            header_line: header.as_ref().map_or(0, |header| header.line as u64 + 1),
            preamble_lines: above as u64,
            data_line: first as u64 + 1,
            data_offset: lines[first].offset,
            is_decimal_seen: cells
                .iter()
                .flatten()
                .any(|cell| cell.as_bytes().contains(&decimal) && is_number(cell, decimal)),
            time_column: times.taken,
            sure_times: times.sure,
            rates: header::labview_rates(&lines[..above.max(begin)], delimiter),
            preamble: Preamble::of(&lines[..above.max(begin)], delimiter),
            mean_row_bytes: (row_bytes / cells.len()).max(2),
            // Rows that lost their values are fewer.
            is_spaced: lines[first..].iter().filter(|line| line.text.trim().is_empty()).count() * 3
                > lines.len() - first,
            columns,
        })
    }

    /// The column of times of a channel: where several have the header of times, the nearest on its left.
    pub(super) fn time_of(&self, column: usize) -> Option<usize> {
        let found = self.time_column.filter(|&found| found != column)?;
        let is_alike =
            |c: &usize| self.columns[*c].is_numeric && self.columns[*c].header == self.columns[found].header;
        Some((0..column).rev().find(is_alike).unwrap_or(found))
    }

    /// Whether a column is certain to hold times.
    pub(super) fn holds_times(&self, column: usize) -> bool {
        self.sure_times.contains(&column)
    }

    /// The other columns of times, which have to bear out those of column `time`; each with whether other columns stand between.
    ///
    /// One of the same header with columns between is the clock of those.
    pub(super) fn witnesses(&self, time: usize) -> Vec<(usize, bool)> {
        let is_apart =
            |&c: &usize| (c.min(time)..c.max(time)).any(|i| i != time && !self.sure_times.contains(&i));
        let others = self.sure_times.iter().filter(|&&c| c != time).map(|c| (*c, is_apart(c)));
        others
            .filter(|&(c, is_apart)| !is_apart || self.columns[c].header != self.columns[time].header)
            .collect()
    }

    /// The column that by its header counts the rows.
    pub(super) fn counter(&self) -> Option<usize> {
        const NAMES: [&str; 14] = [
            "sample",
            "samples",
            "sample no",
            "sample number",
            "index",
            "idx",
            "n",
            "no",
            "nr",
            "no.",
            "nr.",
            "#",
            "count",
            "counter",
        ];
        let is_it = |column: &Column| NAMES.iter().any(|name| column.name.trim().eq_ignore_ascii_case(name));
        self.columns.iter().position(|column| column.is_numeric && is_it(column))
    }

    /// The rate that LabVIEW states for a column above the rows; that of all where there is none of its own.
    pub(super) fn stated_rate(&self, column: usize) -> Option<&StatedRate> {
        let own = self.rates.get(column).and_then(Option::as_ref);
        own.or_else(|| {
            let mut all = self.rates.iter().flatten();
            let first = all.next()?;
            all.all(|other| other.agreement(first.rate_hz, first.rounding) == Agreement::Same)
                .then_some(first)
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
        self.columns.get(column).map_or(Scale::Unknown, time_column::scale)
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
    let (mut lines, mut offset) = (Vec::new(), 0);
    while offset < input.head.len() {
        // A carriage return may stand behind the line break; zero bytes are no end here.
        let returns = input.head[offset..].iter().take_while(|&&b| b == b'\r').count();
        let mut end = input::end_of_line(&input.head, offset + returns);
        while input.head.get(end) == Some(&0) {
            end = input::end_of_line(&input.head, end + 1);
        }
        // Past the head's end the line goes on.
        if end < input.head.len() || input.is_whole {
            let bare = &input.head[offset..end];
            let bare = bare.strip_suffix(b"\r").unwrap_or(bare);
            lines.push(Line { offset, text: input::text(bare) });
        }
        offset = end + 1;
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
            } else if is_number(cell, if decimal == b',' { b'.' } else { b',' }) {
                // Of the other dialect.
                score -= 2;
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
    let is_empty = (0..columns).map(|c| rows.iter().all(|cells| cells[c].is_empty())).collect();
    is_numeric.contains(&true).then_some(Judged { score, columns, is_numeric, is_stamped, is_empty })
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

/// How many rows of extremes stand before the samples: two or three whose times are, among others, those of the first row behind them
/// and of the end, where all rows behind rise.
fn extremes(rows: &[Vec<&str>], time_column: usize, decimal: u8) -> usize {
    /// Rows that are looked at, and the least that tell.
    const LOOKED_AT: usize = 64;
    const LEAST: usize = 4;
    let cell = |cells: &Vec<&str>| number::of_cell(cells.get(time_column)?.as_bytes(), decimal);
    let times: Vec<f64> = rows.iter().take(LOOKED_AT).map_while(cell).collect();
    #[allow(clippy::float_cmp, reason = "the same text gives the same number")]
    let is_so = |count: &usize| {
        let Some((head, rest)) = times.split_at_checked(*count) else { return false };
        rest.len() >= LEAST
            && rest.windows(2).all(|pair| pair[0] < pair[1])
            && head.contains(&rest[0])
            && head.iter().any(|&t| t >= rest[rest.len() - 1])
    };
    [2, 3].into_iter().find(is_so).unwrap_or(0)
}
