//! Headers and first rows to the column of times and to what its numbers count.

use super::header::TableColumn;
use super::stamp::Stamps;
use crate::ingest::times::Scale;
use crate::ingest::{number, vocabulary};

/// What the numbers of a column of times count, as the header, the row of units or the name says.
pub(super) fn scale(column: &TableColumn) -> Scale {
    if column.is_stamped { Scale::Known(1.0) } else { Scale::of(&column.name, column.unit.as_deref()) }
}

/// The columns of times: by their headers, by their stamps, or the first of a table without header where it
/// rises.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Found {
    /// Of several the first whose times rise with every row; where none does, the one whose times rise most
    /// often.
    pub taken: Option<usize>,
    /// What is to be added to it where it holds whole seconds.
    pub nanoseconds: Option<usize>,
    /// All that a name, a unit or stamps show to be times.
    pub sure: Vec<usize>,
    /// Those of them that rise with every row up to their end.
    pub clocks: Vec<usize>,
}

/// Finds them; `cells` gives a column's cells of the first rows.
pub(super) fn find<'a, Cells: Iterator<Item = &'a str>>(
    columns: &[TableColumn],
    is_first_rising: bool,
    decimal: u8,
    cells: impl Fn(usize) -> Cells,
) -> Found {
    let bare: Vec<String> = columns.iter().map(bare_name).collect();
    let all = || 0..columns.len();
    // Beside times of receipt, the sensor's own; those of several topics are none of all.
    let is_stamp = |i: &usize| vocabulary::is_stamp(&bare[*i]);
    let mut stamps = bare.iter().filter(|bare| vocabulary::is_stamp(bare));
    let has_stamp = stamps.next().is_some_and(|first| stamps.all(|other| other == first));
    let is_named = |i: &usize| is_named(&columns[*i], &bare[*i]);
    let begins_so = |i: &usize| begins_so(&bare[*i]);
    let mut found: Vec<(usize, Vec<f64>)> = Vec::new();
    let ranked = all()
        .filter(is_named)
        .chain(all().filter(begins_so))
        .chain(all().filter(|&i| columns[i].is_stamped))
        .chain((is_first_rising && columns.len() > 1).then_some(0));
    for i in ranked.filter(|i| !has_stamp || is_stamp(i)) {
        // Words are no times, nor is what has another unit or falls in more than one row of ten, whatever
        // they are headed.
        if columns[i].is_numeric && scale(&columns[i]) != Scale::Unknown && found.iter().all(|it| it.0 != i) {
            let times = times(cells(i), decimal);
            found.extend((10 * steps(&times, f64::gt) <= times.len().max(20)).then_some((i, times)));
        }
    }
    let is_in = |i: usize, unit_s: f64| scale(&columns[i]) == Scale::Known(unit_s);
    // `sec` and `nanosec` are names and units at once.
    let is_both = |i: usize| vocabulary::time_unit_s(&bare[i]).is_some();
    let rest = |seconds: usize| {
        let is_below = |j: usize| !times(cells(j), decimal).iter().any(|n| *n < 0.0 || *n >= 1e9);
        let is_beside = |j: usize| bare[j] == bare[seconds] || (is_both(seconds) && is_both(j));
        all().find(|&j| is_in(j, 1e-9) && is_beside(j) && is_below(j))
    };
    let mut whole =
        found.iter().filter(|(i, times)| is_in(*i, 1.0) && !times.iter().any(|t| t.fract().abs() > 0.0));
    if let Some((seconds, rest)) = whole.find_map(|(i, _)| Some((*i, rest(*i)?))) {
        return Found {
            taken: Some(seconds),
            nanoseconds: Some(rest),
            sure: vec![seconds],
            clocks: Vec::new(),
        };
    }
    let is_known = |i: &usize| matches!(scale(&columns[*i]), Scale::Known(_));
    let is_sure = |i: &usize| is_named(i) || (begins_so(i) && is_known(i)) || columns[*i].is_stamped;
    let sure = || found.iter().filter(|it| is_sure(&it.0));
    let is_clock = |(_, times): &&(usize, Vec<f64>)| {
        let last = times.windows(2).rposition(|pair| pair[0] < pair[1]).map_or(0, |at| at + 2);
        10 * (steps(&times[..last], f64::lt) + 1) >= 9 * last.max(2)
    };
    let clocks = sure().filter(is_clock).map(|it| it.0).collect();
    let sure = sure().map(|it| it.0).collect();
    // Nine of ten: as where the time base takes times for coarse.
    let is_fine = |(_, times): &&(usize, Vec<f64>)| 10 * (steps(times, f64::lt) + 1) >= 9 * times.len();
    let finest = found.iter().rev().max_by_key(|(_, times)| steps(times, f64::lt));
    let taken = found.iter().find(is_fine).or(finest).map(|it| it.0);
    Found { taken, nanoseconds: None, sure, clocks }
}

/// Whether a column is headed as one of times.
pub(super) fn is_headed(column: &TableColumn) -> bool {
    let bare = bare_name(column);
    is_named(column, &bare) || begins_so(&bare)
}

fn is_named(column: &TableColumn, bare: &str) -> bool {
    vocabulary::is_time(bare)
        || vocabulary::is_stamp(bare)
        || (vocabulary::is_axis(bare) && matches!(scale(column), Scale::Known(_)))
}

fn bare_name(column: &TableColumn) -> String {
    vocabulary::split(&column.name).0.to_lowercase()
}

fn begins_so(name: &str) -> bool {
    name.starts_with("time") || name.starts_with("zeit")
}

/// The times in cells, those of stamps from the first; NaN where a cell holds none.
fn times<'a>(cells: impl Iterator<Item = &'a str>, decimal: u8) -> Vec<f64> {
    let mut stamps = Stamps::default();
    let mut time = |cell: &[u8]| number::of_cell(cell, decimal).or_else(|| stamps.seconds(0, cell));
    cells.map(|cell| time(cell.as_bytes()).unwrap_or(f64::NAN)).collect()
}

/// How many steps from a time to the next go so.
fn steps(times: &[f64], go: fn(&f64, &f64) -> bool) -> usize {
    times.windows(2).filter(|pair| go(&pair[0], &pair[1])).count()
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
