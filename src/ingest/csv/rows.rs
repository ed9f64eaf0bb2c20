//! Lines of a table to rows of numbers, only the wanted columns, in one pass with bounded memory.

use super::super::{Limits, Progress};
use super::input::{Input, breaks, breaks_to_end, end_of_line};
use super::layout::Layout;
use super::pieces::{Batch, Cut, Sizes};
pub(super) use super::wanted::Wanted;
use crate::ingest::number;
use rayon::prelude::*;
use std::ops::Range;

/// What takes rows.
pub(super) trait Rows {
    /// The value of a cell that is no number; `None`: there is none.
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64>;
    /// One row, a value a slot, NaN where missing.
    fn row(&mut self, values: &[f64]);
}

/// Where the rows of the whole table go.
pub(super) trait Sink: Rows {
    /// Takes the rows of one piece; it has no value for a word whose value hangs on rows of other pieces.
    type Part: Rows + Send;
    /// A part without rows.
    fn part(&self) -> Self::Part;
    /// Takes over the rows of `parts`, which follow those taken so far in their order, and leaves them without rows.
    fn append(&mut self, parts: &mut [Self::Part]);
    /// Memory that the rows taken so far hold.
    fn held_bytes(&self) -> u64;
}

/// How the table ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Ending {
    /// Lines read.
    pub lines: u64,
    /// The line that was cut off and dropped.
    pub cut_line: Option<u64>,
    /// Whether zero bytes stand there, after whole lines or in that one.
    pub is_zeros: bool,
    /// Lines behind the zero bytes, which are not read.
    pub lines_behind: u64,
}

/// Why rows could not be read.
#[derive(Debug)]
pub(super) enum RowError {
    Io(std::io::Error),
    Word { line: u64, slot: usize, cell: String },
    NoTime { line: u64, slot: usize },
    TooLong { line: u64 },
    TooMany,
}

/// Reads every row into `sink`.
pub(super) fn read(
    input: Input,
    layout: &Layout,
    wanted: &Wanted,
    sink: &mut impl Sink,
    (limits, progress): (Limits, Progress),
) -> Result<Ending, RowError> {
    let sizes = Sizes::of(limits, input.bytes);
    read_by(input, (layout, wanted), sink, sizes, progress)
}

/// The same by pieces and batches of any size; the sizes leave the rows, the error and the ending as they are.
pub(super) fn read_by(
    mut input: Input,
    (layout, wanted): (&Layout, &Wanted),
    sink: &mut impl Sink,
    sizes: Sizes,
    progress: Progress,
) -> Result<Ending, RowError> {
    let mut table = Table::of(layout, wanted, layout.data_line - 1);
    let text = input.head.split_off(layout.data_offset.min(input.head.len()));
    let (mut batch, mut next) = (Batch { text, is_last: false }, Batch::default());
    let rest = input.rest.as_mut();
    batch.fill(rest, sizes).map_err(RowError::Io)?;
    let mut parts = Vec::new();
    let mut done = 0_u64;
    loop {
        let cut = Cut::of(&batch.text, sizes);
        next.text.clear();
        next.text.extend_from_slice(&batch.text[cut.end..]);
        let mut fill_next = || if batch.is_last { Ok(()) } else { next.fill(rest, sizes) };
        let (filled, lines) = if cut.pieces.len() > 1 {
            parts.resize_with(cut.pieces.len().max(parts.len()), || sink.part());
            rayon::join(fill_next, || side_by_side(&batch.text, &cut.pieces, (layout, wanted), &mut parts))
        } else {
            (fill_next(), None)
        };
        if let Some(lines) = lines {
            sink.append(&mut parts);
            table.line += lines;
            sizes.check(sink)?;
        } else {
            parts.clear();
            for piece in &cut.pieces {
                if let Some(at) = table.lines(&batch.text[piece.clone()], sink)? {
                    filled.map_err(RowError::Io)?;
                    let more = breaks_to_end(&next.text, rest).map_err(RowError::Io)?;
                    let lines_behind =
                        breaks(&batch.text[piece.start + at..cut.end]).saturating_sub(1) + more;
                    let cut_line = Some(table.line);
                    return Ok(Ending { lines: table.line, cut_line, is_zeros: true, lines_behind });
                }
                sizes.check(sink)?;
            }
        }
        if cut.is_too_long {
            return Err(RowError::TooLong { line: table.line + 1 });
        }
        done += cut.end as u64;
        #[allow(clippy::cast_precision_loss, reason = "a fraction for a progress bar")]
        progress((done as f64 / input.bytes.max(1) as f64).min(1.0));
        if batch.is_last {
            let last = &batch.text[cut.end..];
            // Lines that end in a carriage return alone; what stands behind the last is the last.
            let before = &last[..last.len().saturating_sub(1)];
            let whole = before.iter().rposition(|&byte| byte == b'\r').map_or(0, |at| at + 1);
            let is_whole = table.lines(&last[..whole], sink)?.is_none();
            let last = &last[whole..];
            let cut_line = if is_whole { table.last_line(last, layout, sink)? } else { Some(table.line) };
            let is_zeros = !is_whole || last.first() == Some(&0);
            return Ok(Ending { lines: table.line, cut_line, is_zeros, lines_behind: 0 });
        }
        filled.map_err(RowError::Io)?;
        std::mem::swap(&mut batch, &mut next);
    }
}

/// How many lines the pieces have; their rows in the parts of the same number.
///
/// `None` where a piece holds a word, a row at fault or the table's end: only row by row can tell what comes of it.
fn side_by_side(
    text: &[u8],
    pieces: &[Range<usize>],
    (layout, wanted): (&Layout, &Wanted),
    parts: &mut [impl Rows + Send],
) -> Option<u64> {
    let lines = pieces.par_iter().zip(parts).map(|(piece, part)| {
        let mut table = Table::of(layout, wanted, 0);
        matches!(table.lines(&text[piece.clone()], part), Ok(None)).then_some(table.line)
    });
    lines.sum()
}

impl Sizes {
    fn check(self, sink: &impl Sink) -> Result<(), RowError> {
        if sink.held_bytes() > self.samples_bytes { Err(RowError::TooMany) } else { Ok(()) }
    }
}

struct Table<'a> {
    delimiter: u8,
    decimal: u8,
    /// The other mark, where the head of the file does not tell which it is.
    other_decimal: Option<u8>,
    is_runs: bool,
    wanted: &'a Wanted,
    /// Whether a line without any value is a sample that is missing: no times tell that it is.
    keeps_empty: bool,
    values: Vec<f64>,
    line: u64,
}

impl<'a> Table<'a> {
    /// A table of which `line` lines are behind.
    fn of(layout: &Layout, wanted: &'a Wanted, line: u64) -> Self {
        Self {
            delimiter: layout.delimiter,
            decimal: layout.decimal,
            other_decimal: layout.other_decimal(),
            is_runs: layout.delimiter == b' ',
            wanted,
            keeps_empty: !layout.is_spaced && !wanted.is_time.contains(&true),
            values: vec![f64::NAN; wanted.columns.len()],
            line,
        }
    }

    /// Whole lines into `sink`; where the line begins whose zero bytes end the table.
    fn lines(&mut self, text: &[u8], sink: &mut impl Rows) -> Result<Option<usize>, RowError> {
        let mut at = 0;
        while at < text.len() {
            if let Some(next) = self.plain_line(text, at) {
                self.line += 1;
                sink.row(&self.values);
                at = next;
                continue;
            }
            match self.line(text, at, sink)? {
                Some(next) => at = next,
                None => return Ok(Some(at)),
            }
        }
        Ok(None)
    }

    /// The values of a line that begins with the wanted columns, all of them numbers with nothing around them; where the next line begins.
    fn plain_line(&mut self, text: &[u8], mut at: usize) -> Option<usize> {
        let last = self.values.len().checked_sub(1)?;
        if self.is_runs || self.wanted.columns[last] != last {
            return None;
        }
        for (slot, value) in self.values.iter_mut().enumerate() {
            let (number, used) = number::leading(text.get(at..)?, self.decimal)?;
            *value = number;
            at += used;
            let byte = *text.get(at)?;
            if slot < last && byte != self.delimiter {
                return None;
            }
            at += 1;
            if slot == last {
                return match byte {
                    b'\n' => Some(at),
                    b'\r' => (text.get(at) == Some(&b'\n')).then_some(at + 1),
                    _ if byte == self.delimiter => {
                        let end = end_of_line(text, at);
                        (text.get(end) != Some(&0)).then_some(end + 1)
                    }
                    _ => None,
                };
            }
        }
        None
    }

    /// The line at `at` into `sink`; where the next begins, `None` where a block of zero bytes ends the table.
    fn line(&mut self, text: &[u8], mut at: usize, sink: &mut impl Rows) -> Result<Option<usize>, RowError> {
        self.line += 1;
        // Some write the carriage return behind the line break.
        while text.get(at) == Some(&b'\r') && text.get(at + 1) != Some(&b'\n') {
            at += 1;
        }
        if self.is_runs {
            at = skip(text, at, |b| b == b' ' || b == b'\t');
        }
        match text.get(at) {
            Some(0) => return Ok(None),
            Some(b'\n') if !self.keeps_empty => return Ok(Some(at + 1)),
            _ => {}
        }
        self.values.fill(f64::NAN);
        let from = at;
        let mut column = 0;
        'row: for slot in 0..self.wanted.columns.len() {
            while column < self.wanted.columns[slot] {
                at = self.end_of_cell(text, at);
                if !self.is_delimiter(text.get(at)) {
                    break 'row;
                }
                at = self.after_delimiter(text, at);
                column += 1;
            }
            at = self.cell(text, at, slot, sink)?;
        }
        let end = end_of_line(text, at);
        if text.get(end) == Some(&0) {
            return Ok(None);
        }
        self.finish(text.get(from..end).unwrap_or_default(), sink)?;
        Ok(Some(end + 1))
    }

    /// Hands the row of `line` on. A row without any value is none where times tell that it is missing, or between doubled line breaks.
    fn finish(&self, line: &[u8], sink: &mut impl Rows) -> Result<(), RowError> {
        if !self.keeps_empty && self.values.iter().all(|value| value.is_nan()) {
            let is_bare = |byte: &u8| *byte == self.delimiter || matches!(byte, b' ' | b'\t' | b'\r' | b'"');
            if self.wanted.is_time.contains(&true) || line.iter().all(is_bare) {
                return Ok(());
            }
        }
        let no_time =
            |slot: &usize| self.wanted.is_time[*slot] && self.wanted.lacks_time(*slot, &self.values);
        if let Some(slot) = (0..self.values.len()).find(no_time) {
            return Err(RowError::NoTime { line: self.line, slot });
        }
        sink.row(&self.values);
        Ok(())
    }

    /// The number at `at` into its slot; where the cell ends.
    fn cell(&mut self, text: &[u8], at: usize, slot: usize, sink: &mut impl Rows) -> Result<usize, RowError> {
        let from = if text.get(at) == Some(&b' ') { skip(text, at, |b| b == b' ') } else { at };
        if let Some((value, used)) = number::leading(&text[from..], self.decimal) {
            let end = from + used;
            if self.ends_cell(text.get(end)) {
                self.values[slot] = value;
                return Ok(end);
            }
        }
        let end = self.end_of_cell(text, at);
        let cell = text[at..end].trim_ascii();
        let cell = cell.strip_prefix(b"\"").and_then(|c| c.strip_suffix(b"\"")).unwrap_or(cell).trim_ascii();
        // A number before zero bytes may have lost its last digits; its row is not taken.
        let value = if number::is_missing(cell) || text.get(end) == Some(&0) {
            Some(f64::NAN)
        } else {
            number::of_cell(cell, self.decimal)
                .or_else(|| self.other_decimal.and_then(|mark| number::of_cell(cell, mark)))
                .or_else(|| sink.word(slot, cell))
        };
        let Some(value) = value else {
            return Err(RowError::Word { line: self.line, slot, cell: shown(cell) });
        };
        self.values[slot] = value;
        Ok(end)
    }

    /// What stands after the last line break: a row, or one that was cut off.
    fn last_line(
        &mut self,
        text: &[u8],
        layout: &Layout,
        sink: &mut impl Rows,
    ) -> Result<Option<u64>, RowError> {
        if text.trim_ascii().is_empty() {
            return Ok(None);
        }
        let mut cells = 1;
        let mut at = self.end_of_cell(text, 0);
        while self.is_delimiter(text.get(at)) {
            at = self.end_of_cell(text, self.after_delimiter(text, at));
            cells += 1;
        }
        if cells < layout.columns.len() {
            self.line += 1;
            return Ok(Some(self.line));
        }
        match self.line(text, 0, sink) {
            Ok(Some(_)) => Ok(None),
            // A number that breaks off ("1.2e", "-") is the sign of a cut.
            Ok(None) | Err(RowError::Word { .. }) => Ok(Some(self.line)),
            Err(error) => Err(error),
        }
    }

    fn is_delimiter(&self, byte: Option<&u8>) -> bool {
        byte.is_some_and(|&b| b == self.delimiter || (self.is_runs && b == b'\t'))
    }

    fn ends_cell(&self, byte: Option<&u8>) -> bool {
        self.is_delimiter(byte) || matches!(byte, None | Some(b'\n' | b'\r'))
    }

    fn after_delimiter(&self, text: &[u8], at: usize) -> usize {
        if self.is_runs { skip(text, at, |b| b == b' ' || b == b'\t') } else { at + 1 }
    }

    /// The delimiter or line break after the cell at `at`; delimiters in quotes are text.
    fn end_of_cell(&self, text: &[u8], mut at: usize) -> usize {
        if text.get(at) == Some(&b'"') {
            at = skip(text, at + 1, |b| b != b'"' && b != b'\n');
            // A doubled quote inside, and what may follow the closing one.
            while text.get(at) == Some(&b'"') && text.get(at + 1) == Some(&b'"') {
                at = skip(text, at + 2, |b| b != b'"' && b != b'\n');
            }
        }
        while let Some(&byte) = text.get(at) {
            if matches!(byte, b'\n' | 0) || self.is_delimiter(Some(&byte)) {
                break;
            }
            if byte == b'\r' {
                // At once past a run of them, which would be looked through again from each.
                return end_of_line(text, at);
            }
            at += 1;
        }
        at
    }
}

/// A cell for people, cut to what fits a line.
pub(super) fn shown(cell: &[u8]) -> String {
    super::input::text(&cell[..cell.len().min(40)]).into_owned()
}

/// The first place from `at` on where `passes` fails.
fn skip(text: &[u8], at: usize, passes: impl Fn(u8) -> bool) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    at + rest.iter().position(|&b| !passes(b)).unwrap_or(rest.len())
}
