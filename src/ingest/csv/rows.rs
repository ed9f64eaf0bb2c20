//! Lines of a table to rows of numbers, only the wanted columns, in one pass with bounded memory.

use super::super::Progress;
use super::super::lines::{self, Text};
use super::cells::{Delimiter, bare, skip};
use super::layout::Layout;
use super::pieces::{Cut, Sizes, TextBatch};
use super::wanted::Wanted;
use crate::data::TableFinding;
use crate::ingest::{number, vocabulary};
use rayon::prelude::*;
use std::ops::Range;

/// Some rows of the wanted columns: a list of values for each, NaN where missing.
pub(super) struct RowsPart(pub Vec<Vec<f64>>);

impl RowsPart {
    /// Without rows.
    fn of(wanted: &Wanted) -> Self {
        Self(vec![Vec::new(); wanted.columns.len()])
    }

    fn push(&mut self, values: &[f64]) {
        for (column, &value) in self.0.iter_mut().zip(values) {
            column.push(value);
        }
    }

    /// Leaves it without rows.
    pub(super) fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }
}

/// Where the rows of the whole table go.
pub(super) trait Sink {
    /// The value of a cell that is no number; `None`: there is none. Asked in the order of the rows.
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64>;
    /// Takes over the rows of `parts`, which follow those taken so far in their order, and leaves them
    /// without rows.
    fn append(&mut self, parts: &mut [RowsPart]);
    /// Takes a line among the rows that is none.
    fn remark(&mut self, _line: &str) {}
    /// Memory that the rows taken so far hold.
    fn held_bytes(&self) -> u64;
}

/// The value of a cell that is no number, by its slot.
type Word<'a> = &'a mut dyn FnMut(usize, &[u8]) -> Option<f64>;

/// Why rows could not be read.
#[derive(Debug)]
pub(super) enum RowError {
    Io(std::io::Error),
    Word { line: u64, slot: usize, cell: String },
    NoTime { line: u64, slot: usize },
    Short { line: u64, cells: usize },
    TooLong { line: u64 },
    TooMany,
}

/// Reads every row into `sink`, by pieces and batches of any size; how the table ended, where it broke off.
/// The sizes leave the rows, the error and the ending as they are.
pub(super) fn read(
    mut text: Text,
    (layout, wanted): (&Layout, &Wanted),
    sink: &mut impl Sink,
    sizes: Sizes,
    progress: Progress,
) -> Result<Option<TableFinding>, RowError> {
    let mut reader = RowReader::of(layout, wanted);
    let head = text.head.split_off(layout.data_offset.min(text.head.len()));
    let (mut batch, mut next) = (TextBatch { text: head, is_last: false }, TextBatch::default());
    batch.fill(&mut text.rest, sizes).map_err(RowError::Io)?;
    let mut parts = vec![RowsPart::of(wanted)];
    let mut done = 0_u64;
    loop {
        let cut = Cut::of(&batch.text, sizes);
        next.text.clear();
        next.text.extend_from_slice(&batch.text[cut.end..]);
        let mut fill_next = || if batch.is_last { Ok(()) } else { next.fill(&mut text.rest, sizes) };
        let (filled, lines) = if cut.pieces.len() > 1 {
            parts.resize_with(cut.pieces.len().max(parts.len()), || RowsPart::of(wanted));
            rayon::join(fill_next, || side_by_side(&batch.text, &cut.pieces, &reader, &mut parts))
        } else {
            (fill_next(), None)
        };
        if let Some(lines) = lines {
            sink.append(&mut parts);
            reader.line += lines;
            sizes.check(sink)?;
        } else {
            parts.iter_mut().for_each(RowsPart::clear);
            for piece in &cut.pieces {
                reader.lines(&batch.text[piece.clone()], &mut parts[0], &mut |slot, cell| {
                    sink.word(slot, cell)
                })?;
                sink.append(&mut parts[..1]);
                sizes.check(sink)?;
            }
        }
        if cut.is_too_long {
            return Err(RowError::TooLong { line: reader.line + 1 });
        }
        done += cut.end as u64;
        #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
        progress((done as f64 / text.bytes.max(1) as f64).min(1.0));
        if batch.is_last {
            // Before zero bytes a number may have lost its last digits.
            if text.rest.has_zeros {
                return Ok(Some(TableFinding::ZeroBytes { line: reader.line + 1 }));
            }
            let last = &batch.text[cut.end..];
            let cut_line = reader.last_line(last, &mut parts[0], &mut |slot, cell| sink.word(slot, cell))?;
            reader.remarks.iter().for_each(|line| sink.remark(line));
            sink.append(&mut parts[..1]);
            return Ok(cut_line.map(|line| TableFinding::CutLine { line }));
        }
        filled.map_err(RowError::Io)?;
        std::mem::swap(&mut batch, &mut next);
    }
}

/// How many lines the pieces have; their rows in the parts of the same number.
///
/// `None` where a piece holds a word, a remark or a row at fault: only row by row can tell what comes of it.
fn side_by_side(
    text: &[u8],
    pieces: &[Range<usize>],
    reader: &RowReader,
    parts: &mut [RowsPart],
) -> Option<u64> {
    let lines = pieces.par_iter().zip(parts).map(|(piece, part)| {
        let mut own = RowReader { line: 0, values: reader.values.clone(), remarks: Vec::new(), ..*reader };
        let read = own.lines(&text[piece.clone()], part, &mut |_, _| None);
        read.ok().filter(|()| own.remarks.is_empty()).map(|()| own.line)
    });
    lines.sum()
}

impl Sizes {
    fn check(self, sink: &impl Sink) -> Result<(), RowError> {
        if sink.held_bytes() > self.samples_bytes { Err(RowError::TooMany) } else { Ok(()) }
    }
}

/// So many remarks are looked into, each so far.
const MOST_REMARKS: usize = 16;
const LONGEST_REMARK: usize = 200;

struct RowReader<'a> {
    layout: &'a Layout,
    delimiter: Delimiter,
    decimal: u8,
    wanted: &'a Wanted,
    /// Whether the wanted columns are the first ones.
    is_dense: bool,
    /// Whether a line without any value is a sample that is missing: no times tell that it is.
    keeps_empty: bool,
    /// The last column of numbers, from 0.
    least_columns: usize,
    values: Vec<f64>,
    /// The first lines among the rows that are none.
    remarks: Vec<String>,
    line: u64,
}

impl<'a> RowReader<'a> {
    /// Before the first row.
    fn of(layout: &'a Layout, wanted: &'a Wanted) -> Self {
        Self {
            layout,
            delimiter: layout.dialect.delimiter,
            decimal: layout.dialect.decimal,
            wanted,
            is_dense: wanted.columns.iter().copied().eq(0..wanted.columns.len()),
            keeps_empty: !wanted.is_time.contains(&true),
            least_columns: layout.columns.iter().rposition(|column| column.is_numeric).unwrap_or_default(),
            values: vec![f64::NAN; wanted.columns.len()],
            remarks: Vec::new(),
            line: layout.data_line - 1,
        }
    }

    /// Whole lines into `part`.
    fn lines(&mut self, text: &[u8], part: &mut RowsPart, word: Word) -> Result<(), RowError> {
        let mut at = 0;
        while at < text.len() {
            self.line += 1;
            if let Some(next) = self.plain_line(text, at) {
                part.push(&self.values);
                at = next;
            } else if self.is_remark(text, at) {
                self.take_remark(text, at);
                at = skip(text, at, |byte| byte != b'\n') + 1;
            } else {
                let next = self.any_line(text, at, word)?;
                if !self.is_blank() {
                    part.push(&self.values);
                }
                at = next;
            }
        }
        Ok(())
    }

    /// The values of a line that begins with the wanted columns, all of them numbers with nothing around
    /// them; where the next line begins.
    fn plain_line(&mut self, text: &[u8], mut at: usize) -> Option<usize> {
        let last = self.values.len().checked_sub(1)?;
        if !self.is_dense || self.delimiter.is_run() {
            return None;
        }
        for (slot, value) in self.values.iter_mut().enumerate() {
            let (number, used) = number::leading(text.get(at..)?, self.decimal)?;
            *value = number;
            at += used;
            let byte = *text.get(at)?;
            at += 1;
            if slot == last && byte == b'\n' {
                return Some(at);
            }
            if byte != self.delimiter.0 {
                return None;
            }
        }
        Some(skip(text, at, |byte| byte != b'\n') + 1)
    }

    /// The values of the line at `at`; where the next begins.
    fn any_line(&mut self, text: &[u8], at: usize, word: Word) -> Result<usize, RowError> {
        self.values.fill(f64::NAN);
        let from = at;
        let (mut at, mut column) = (self.delimiter.first(text, at), 0);
        'row: for slot in 0..self.wanted.columns.len() {
            while column < self.wanted.columns[slot] {
                let end = self.delimiter.end(text, at);
                let Some(next) = self.delimiter.next(text, end) else { break 'row };
                (at, column) = (next, column + 1);
            }
            at = self.cell(text, at, slot, word)?;
        }
        // Between blanks nothing says which cell is missing.
        let has_value = self.values.iter().any(|value| !value.is_nan());
        if self.delimiter.is_run() && has_value && column < self.least_columns {
            let cells = self.cells_from(text, from);
            if cells <= self.least_columns {
                return Err(RowError::Short { line: self.line, cells });
            }
        }
        let no_time =
            |slot: &usize| self.wanted.is_time[*slot] && self.wanted.lacks_time(*slot, &self.values);
        match (0..self.values.len()).find(no_time) {
            Some(slot) => Err(RowError::NoTime { line: self.line, slot }),
            None => Ok(skip(text, at, |byte| byte != b'\n') + 1),
        }
    }

    /// Keeps the line at `at` for who looks into remarks.
    fn take_remark(&mut self, text: &[u8], at: usize) {
        let end = skip(text, at, |byte| byte != b'\n');
        if self.remarks.len() < MOST_REMARKS {
            self.remarks.push(lines::text(&text[at..end.min(at + LONGEST_REMARK)]).into_owned());
        }
    }

    /// How many cells the line at `at` has.
    fn cells_from(&self, text: &[u8], at: usize) -> usize {
        let mut at = self.delimiter.first(text, at);
        let mut cells = 1;
        while let Some(next) = self.delimiter.next(text, self.delimiter.end(text, at)) {
            (at, cells) = (next, cells + 1);
        }
        cells
    }

    /// Whether the line at `at` is no row: where a number should begin it stands a remark, a sum, or the
    /// Ctrl-Z that ends a text of DOS.
    fn is_remark(&self, text: &[u8], at: usize) -> bool {
        let begins_in_number = self.layout.columns[0].is_numeric;
        if !begins_in_number || matches!(text[at], b'0'..=b'9' | b'-' | b'+' | b'.' | b' ' | b'\n') {
            return false;
        }
        let cell = bare(&text[at..self.delimiter.end(text, at)]);
        match cell.first() {
            Some(b'#' | b'%' | b';' | b'\x1A') => !number::is_missing(cell),
            _ => vocabulary::is_summary(&lines::text(cell)),
        }
    }

    /// Whether the line is no row: it holds no value, and times tell whether one is missing.
    fn is_blank(&self) -> bool {
        !self.keeps_empty && self.values.iter().all(|value| value.is_nan())
    }

    /// The number at `at` into its slot; where the cell ends.
    fn cell(&mut self, text: &[u8], at: usize, slot: usize, word: Word) -> Result<usize, RowError> {
        let from = skip(text, at, |byte| byte == b' ');
        if let Some((value, used)) = number::leading(&text[from..], self.decimal)
            && text.get(from + used).is_none_or(|&byte| byte == b'\n' || self.delimiter.is(byte))
        {
            self.values[slot] = value;
            return Ok(from + used);
        }
        let end = self.delimiter.end(text, at);
        let cell = bare(&text[at..end]);
        let value = if number::is_missing(cell) {
            Some(f64::NAN)
        } else {
            number::of_cell(cell, self.decimal).or_else(|| word(slot, cell))
        };
        let Some(value) = value else {
            return Err(RowError::Word { line: self.line, slot, cell: shown(cell) });
        };
        self.values[slot] = value;
        Ok(end)
    }

    /// What stands after the last line break: a row, or one that broke off, whose line is given.
    fn last_line(&mut self, text: &[u8], part: &mut RowsPart, word: Word) -> Result<Option<u64>, RowError> {
        if text.trim_ascii().is_empty() {
            return Ok(None);
        }
        if self.is_remark(text, 0) {
            self.take_remark(text, 0);
            return Ok(None);
        }
        let is_short = self.delimiter.cells(&lines::text(text)).len() < self.layout.columns.len();
        if is_short {
            return Ok(Some(self.line + 1));
        }
        match self.lines(text, part, word) {
            Ok(()) => Ok(None),
            // A number that breaks off: "1.2e" or "-".
            Err(RowError::Word { line, .. }) => Ok(Some(line)),
            Err(error) => Err(error),
        }
    }
}

/// A cell for people, cut to what fits a line.
pub(super) fn shown(cell: &[u8]) -> String {
    lines::text(&cell[..cell.len().min(40)]).into_owned()
}
