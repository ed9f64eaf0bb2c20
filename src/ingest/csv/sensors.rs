//! The first rows of a long table to the columns that name the sensor of each row.

use super::header::TableColumn;
use crate::ingest::counting::are_ids_by_turns;
use crate::ingest::limits::MOST_SENSORS;
use crate::ingest::{number, vocabulary};
use std::hash::{DefaultHasher, Hash, Hasher};

/// A column whose cells name the sensor of their row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sensors {
    pub column: usize,
    /// Of each of the first rows.
    cells: Vec<String>,
}

/// Words change at least once in so many rows where they name sensors; those of a state stay longer.
const ROWS_A_CHANGE: usize = 16;

/// Fewer rows without a value are samples that are missing.
const LEAST_OTHERS: usize = 16;

/// What stands for the cell of a sensor: its number, or one made of its word.
#[allow(clippy::cast_precision_loss, reason = "53 bits")]
pub(super) fn value(cell: &[u8], decimal: u8) -> f64 {
    number::of_cell(cell, decimal).unwrap_or_else(|| {
        let mut hasher = DefaultHasher::new();
        cell.hash(&mut hasher);
        (hasher.finish() >> 11) as f64
    })
}

/// The rows in which a channel has a value.
#[derive(Debug, Clone, Default)]
pub(super) struct Filled {
    count: usize,
    first: usize,
    last: usize,
    /// In how many stretches they lie.
    stretches: usize,
}

impl Filled {
    /// Takes the next.
    pub(super) fn take(&mut self, row: usize) {
        let is_first = self.count == 0;
        self.first = if is_first { row } else { self.first };
        self.stretches += usize::from(is_first || row > self.last + 1);
        self.count += 1;
        self.last = row;
    }

    /// Whether the rows without a value are those of other topics: from the first value to the last there are
    /// many, and the channel's own lie among them in many stretches.
    pub(super) fn lie_between(&self) -> bool {
        let all = self.last + 1 - self.first;
        let others = all - self.count;
        others >= LEAST_OTHERS && 16 * others > all && 8 * self.stretches > self.count.min(others)
    }
}

/// The columns that name sensors; of the others `is_time` hold times.
pub(super) fn find(
    columns: &[TableColumn],
    is_time: impl Fn(usize) -> bool,
    rows: &[Vec<&str>],
    numbers: impl Fn(usize) -> Vec<f64>,
) -> Vec<Sensors> {
    let rows: Vec<&Vec<&str>> = rows.iter().filter(|cells| cells.len() >= columns.len()).collect();
    let is_value = |column: &usize| columns[*column].is_numeric && !is_time(*column);
    let of_column = |column: usize| {
        let TableColumn { name, unit, is_numeric, .. } = &columns[column];
        let is_named = vocabulary::is_sensor_of_rows(name);
        let has_others = (0..columns.len()).any(|other| other != column && is_value(&other));
        // Numbers of any name that return one after another are ids, unless they count.
        let is_by_turns = *is_numeric
            && unit.is_none()
            && !vocabulary::may_count(name)
            && are_ids_by_turns(&numbers(column));
        if is_time(column) || !has_others || (*is_numeric && !is_named && !is_by_turns) {
            return None;
        }
        let cells: Vec<String> = rows.iter().map(|cells| cells[column].to_owned()).collect();
        let ids: Vec<&String> = cells.iter().filter(|cell| !number::is_missing(cell.as_bytes())).collect();
        let mut different = ids.clone();
        different.sort_unstable();
        different.dedup();
        let changes = ids.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let returns = changes >= different.len();
        // Numbers that never fall count; a word that does not return may still be a sensor's.
        let is_so =
            (is_named && !is_numeric) || (returns && (*is_numeric || ROWS_A_CHANGE * changes >= ids.len()));
        let counts = (2..=MOST_SENSORS).contains(&different.len()) && 2 * different.len() <= ids.len();
        (is_so && counts && 2 * ids.len() >= cells.len()).then_some(Sensors { column, cells })
    };
    (0..columns.len()).filter_map(of_column).collect()
}

impl Sensors {
    /// The sensors of the first rows, those alone in which `of` names the sensor `is`.
    pub(super) fn named(&self, of: Option<(&Self, &str)>) -> Vec<&str> {
        let mut named: Vec<&str> = Vec::new();
        for (row, cell) in self.cells.iter().enumerate().filter(|(_, cell)| !cell.is_empty()) {
            let is_own = of.is_none_or(|(other, is)| other.cells[row] == is);
            if is_own && !named.contains(&cell.as_str()) {
                named.push(cell);
            }
        }
        named
    }
}
