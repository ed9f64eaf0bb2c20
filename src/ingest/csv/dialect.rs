//! The lines at the beginning of a text to its delimiter and decimal mark, and which columns hold numbers.

use super::super::lines::Line;
use super::cells::Delimiter;
use super::stamp;
use crate::ingest::number;

/// How cells and their numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Dialect {
    /// What stands between cells.
    pub delimiter: Delimiter,
    /// Decimal mark.
    pub decimal: u8,
}

/// Delimiters, each with both decimal marks, likeliest first where a file fits several.
const DIALECTS: [(u8, [u8; 2]); 5] =
    [(b';', *b",."), (b'\t', *b".,"), (b',', *b".,"), (b'|', *b".,"), (b' ', *b".,")];

/// So many of the last lines of the head decide on the dialect.
const JUDGED_LINES: usize = 200;

/// What the judged lines say under one dialect.
pub(super) struct Judged {
    score: i64,
    pub columns: usize,
    pub is_numeric: Vec<bool>,
    pub is_stamped: Vec<bool>,
    /// Columns without a single value or word.
    pub is_empty: Vec<bool>,
    /// Whether the first column is empty but for a word in one of ten rows at most.
    begins_empty: bool,
}

impl Dialect {
    /// The dialect under which the last of `lines` hold most numbers and fewest words, with what they say
    /// under it.
    pub(super) fn likeliest(lines: &[Line]) -> Option<(Self, Judged)> {
        let filled = lines.iter().rev().filter(|line| !line.text.trim().is_empty());
        let lines: Vec<&Line> = filled.take(JUDGED_LINES).collect();
        let mut best: Option<(Self, Judged)> = None;
        for (delimiter, decimal) in DIALECTS.iter().flat_map(|(own, marks)| marks.map(|mark| (*own, mark))) {
            let dialect = Self { delimiter: Delimiter(delimiter), decimal };
            let Some(judged) = dialect.judge(&lines) else { continue };
            // A tab behind the last value is an empty cell: a column of a slower rate has ended.
            let is_more = |held: &Judged| delimiter == b'\t' && judged.columns > held.columns;
            let is_better = |held: &Judged| judged.score + i64::from(is_more(held)) > held.score;
            if best.as_ref().is_none_or(|(_, held)| is_better(held)) {
                best = Some((dialect, judged));
            }
        }
        best
    }

    /// Whether a cell is a number, a date-time stamp or a clock time.
    pub(super) fn is_value(self, cell: &str) -> bool {
        number::of_cell(cell.as_bytes(), self.decimal).is_some() || stamp::is_stamp(cell.as_bytes())
    }

    /// What `lines` say under this dialect; `None` where no column holds numbers.
    fn judge(self, lines: &[&Line]) -> Option<Judged> {
        let rows: Vec<Vec<&str>> = lines
            .iter()
            .map(|line| self.delimiter.cells(&line.text))
            .filter(|cells| cells.iter().any(|cell| self.is_value(cell)))
            .collect();
        // The commonest number of cells, the larger where two are as common.
        let mut counts: Vec<usize> = rows.iter().map(Vec::len).collect();
        counts.sort_unstable();
        let columns = counts.chunk_by(|a, b| a == b).max_by_key(|same| same.len())?.first().copied()?;
        let rows: Vec<&Vec<&str>> = rows.iter().filter(|cells| cells.len() == columns).collect();
        let mut score = 0;
        let (mut values, mut stamps) = (vec![0_usize; columns], vec![0_usize; columns]);
        let mut words = vec![0_i64; columns];
        let is_number =
            |cell: &str| b".,".iter().any(|&mark| number::of_cell(cell.as_bytes(), mark).is_some());
        for cells in &rows {
            for (column, cell) in cells.iter().enumerate() {
                if self.is_value(cell) {
                    score += 1;
                    values[column] += 1;
                    stamps[column] += usize::from(stamp::is_stamp(cell.as_bytes()));
                } else if number::is_grouped(cell, None) {
                    // A number too, though it is not read: other delimiters would cut it to pieces that are.
                    score += 1;
                } else if cell.split(';').all(is_number) {
                    // Of the other decimal mark, or several in one cell.
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
        let begins_empty = 10 * filled(0) < rows.len();
        is_numeric.contains(&true).then_some(Judged {
            score,
            columns,
            is_numeric,
            is_stamped,
            is_empty,
            begins_empty,
        })
    }

    /// Whether a line is a row: as many cells, numbers (or nothing) in the columns of numbers, and more
    /// numbers than not.
    ///
    /// Stamps count only where there is nothing else: one that cannot be read makes a line no header.
    pub(super) fn is_row(self, cells: &[&str], judged: &Judged) -> bool {
        // Oscilloscopes leave the first column to the words of facts above.
        let is_fact =
            judged.begins_empty && cells.first().is_some_and(|cell| !cell.is_empty() && !self.is_value(cell));
        if cells.len() != judged.columns || is_fact {
            return false;
        }
        let is_plain = |c: usize| judged.is_numeric[c] && !judged.is_stamped[c];
        let has_plain = (0..judged.columns).any(is_plain);
        let decisive: Vec<&str> = (0..judged.columns)
            .filter(|&c| if has_plain { is_plain(c) } else { judged.is_numeric[c] })
            .map(|c| cells[c])
            .collect();
        // A clock time above numbers is no value: loggers state when they began.
        let is_value = |cell: &str| self.is_value(cell) && !(has_plain && stamp::is_stamp(cell.as_bytes()));
        let values = decisive.iter().filter(|cell| is_value(cell)).count();
        2 * values >= decisive.len()
            && decisive.iter().all(|cell| is_value(cell) || number::is_missing(cell.as_bytes()))
    }
}
