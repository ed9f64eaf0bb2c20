//! Headers and first rows to the column of times and to what its numbers count.

use super::header::TableColumn;
use super::stamp::Stamps;
use crate::ingest::times::Scale;
use crate::ingest::{number, vocabulary};

/// What the numbers of a column of times count, as the header, the row of units or the name says.
pub(super) fn scale(column: &TableColumn) -> Scale {
    if column.is_stamped { Scale::Known(1.0) } else { Scale::of(&column.name, column.unit.as_deref()) }
}

/// The columns of times: by their headers, by their stamps, or the first of a table without header where it rises.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Found {
    /// Of several the first whose times rise with every row; where none does, the one whose times rise most often.
    pub taken: Option<usize>,
    /// All that a name, a unit or stamps show to be times.
    pub sure: Vec<usize>,
}

/// Finds them; `cells` gives a column's cells of the first rows.
pub(super) fn find<'a, Cells: Iterator<Item = &'a str>>(
    columns: &[TableColumn],
    is_first_rising: bool,
    decimal: u8,
    cells: impl Fn(usize) -> Cells,
) -> Found {
    let bare: Vec<String> = columns.iter().map(bare_name).collect();
    let is_named = |i: &usize| is_named(&columns[*i], &bare[*i]);
    let begins_so = |i: &usize| begins_so(&bare[*i]);
    let all = || 0..columns.len();
    let mut found: Vec<usize> = Vec::new();
    let ranked = all()
        .filter(is_named)
        .chain(all().filter(begins_so))
        .chain(all().filter(|&i| columns[i].is_stamped))
        .chain((is_first_rising && columns.len() > 1).then_some(0));
    for i in ranked {
        // Words are no times, whatever they are headed.
        if columns[i].is_numeric && !found.contains(&i) {
            found.push(i);
        }
    }
    let is_known = |i: &usize| matches!(scale(&columns[*i]), Scale::Known(_));
    let is_sure = |i: &usize| is_named(i) || (begins_so(i) && is_known(i)) || columns[*i].is_stamped;
    let sure = found.iter().copied().filter(is_sure).collect();
    if found.len() < 2 {
        return Found { taken: found.first().copied(), sure };
    }
    let rises: Vec<(usize, usize)> = found.iter().map(|&i| rises(cells(i), decimal)).collect();
    // Nine of ten: as where the time base takes times for coarse.
    let is_fine = |(rises, pairs): &(usize, usize)| 10 * rises >= 9 * pairs;
    let finest = rises.iter().map(|(rises, _)| *rises).max();
    let place = rises.iter().position(is_fine).or_else(|| rises.iter().position(|(r, _)| Some(*r) == finest));
    Found { taken: place.map(|place| found[place]), sure }
}

/// Whether a column is headed as one of times.
pub(super) fn is_headed(column: &TableColumn) -> bool {
    let bare = bare_name(column);
    is_named(column, &bare) || begins_so(&bare)
}

fn is_named(column: &TableColumn, bare: &str) -> bool {
    vocabulary::is_time(bare) || (vocabulary::is_axis(bare) && matches!(scale(column), Scale::Known(_)))
}

fn bare_name(column: &TableColumn) -> String {
    vocabulary::split(&column.name).0.to_lowercase()
}

fn begins_so(name: &str) -> bool {
    name.starts_with("time") || name.starts_with("zeit")
}

/// How many of the cells are later than the one before, and how many have one before.
fn rises<'a>(cells: impl Iterator<Item = &'a str>, decimal: u8) -> (usize, usize) {
    let mut stamps = Stamps::default();
    let times: Vec<Option<f64>> = cells
        .map(|cell| number::of_cell(cell.as_bytes(), decimal).or_else(|| stamps.seconds(0, cell.as_bytes())))
        .collect();
    let rises = |pair: &&[Option<f64>]| pair[0].zip(pair[1]).is_some_and(|(one, next)| one < next);
    (times.windows(2).filter(rises).count(), times.len().saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_names_are_understood() {
        for (header, name, scale) in [
            ("time_ms", "time", Scale::Known(1e-3)),
            ("Zeit in ms", "Zeit", Scale::Known(1e-3)),
            ("TimeMs", "Time", Scale::Known(1e-3)),
            ("timeInMs", "time", Scale::Known(1e-3)),
            ("t/ms", "t", Scale::Known(1e-3)),
            ("t / ms", "t", Scale::Known(1e-3)),
            ("Time msec", "Time", Scale::Known(1e-3)),
            ("t_us", "t", Scale::Known(1e-6)),
            ("Zeit in µs", "Zeit", Scale::Known(1e-6)),
            ("timestamp_ns", "timestamp", Scale::Known(1e-9)),
            ("time_s", "time", Scale::Known(1.0)),
            ("Time in seconds", "Time", Scale::Known(1.0)),
            ("Zeit in min", "Zeit", Scale::Known(60.0)),
            ("ms", "ms", Scale::Known(1e-3)),
            ("Zeit", "Zeit", Scale::Open),
            ("Times", "Times", Scale::Open),
            ("TimeStamp", "TimeStamp", Scale::Open),
            ("t", "t", Scale::Open),
        ] {
            assert_eq!(vocabulary::split(header).0, name, "{header}");
            let column = TableColumn {
                header: header.into(),
                name: header.into(),
                unit: None,
                is_numeric: true,
                is_stamped: false,
                example: String::new(),
            };
            assert_eq!(super::scale(&column), scale, "{header}");
            let stated = TableColumn { unit: Some("s".into()), ..column };
            let expected = match scale {
                Scale::Known(named_s) if named_s.total_cmp(&1.0).is_ne() => Scale::Twofold(named_s, 1.0),
                _ => Scale::Known(1.0),
            };
            assert_eq!(super::scale(&stated), expected, "{header}: a stated unit goes with the name's");
        }
    }
}
