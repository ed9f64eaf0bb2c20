//! The beginning of a text to its layout: delimiter, decimal mark, header, units, where the rows begin.

use super::super::lines::Text;
use super::dialect::Dialect;
use super::header::{self, TableColumn};
use super::preamble::{self, Preamble};
use super::sensors::{self, Sensors};
use super::{stamp, time_column};
use crate::ingest::counting::{self, Counter};
use crate::ingest::{factors, number};

/// How a text is laid out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// How cells and numbers are written.
    pub dialect: Dialect,
    /// The columns.
    pub columns: Vec<TableColumn>,
    /// Line of the header, from 1; else why a line that looks like one is none, in brackets, or nothing.
    pub header: Result<u64, String>,
    /// Lines before the header (or the rows).
    pub preamble_lines: u64,
    /// Line of the first row, from 1.
    pub data_line: u64,
    /// Where the first row begins in [`Text::head`].
    pub data_offset: usize,
    /// The columns of times.
    pub times: time_column::Found,
    /// Columns that name the sensor of each row.
    pub sensors: Vec<Sensors>,
    /// The column that counts the rows.
    pub counter: Option<usize>,
    /// What else is stated above the rows.
    pub preamble: Preamble,
    /// Columns of one number, or with one in their names, that may be factors of the samples.
    constants: Vec<String>,
    mean_row_bytes: usize,
}

impl Layout {
    /// The layout of `text`; `None` where its head holds no rows of numbers.
    pub(super) fn of(text: &Text) -> Option<Self> {
        let lines = text.lines();
        let begin = preamble::labview_lines(&lines);
        let (dialect, judged) = Dialect::likeliest(&lines[begin..])?;
        let delimiter = dialect.delimiter;
        let rows = lines[begin..].iter();
        let first =
            begin + rows.clone().position(|line| dialect.is_row(&delimiter.cells(&line.text), &judged))?;
        let rows: Vec<Vec<&str>> = lines[first..].iter().map(|line| delimiter.cells(&line.text)).collect();
        let has_row_names = delimiter.is_run() && lines[first].text.trim_start().starts_with('"');
        let header = header::header(&lines[..first], delimiter, &judged, has_row_names);
        let mut columns = header::columns(header.as_ref().ok(), &judged, &rows[0]);
        for (index, column) in columns.iter_mut().enumerate().filter(|(_, column)| !column.is_numeric) {
            let mut cells = rows.iter().filter_map(|cells| cells.get(index));
            let grouped = cells.find(|cell| number::is_grouped(cell, Some(dialect.decimal)));
            column.example = grouped.map_or_else(|| column.example.clone(), |cell| (*cell).to_owned());
        }
        // A pair of columns may have ended before the judged rows begin.
        let ended = (0..columns.len()).filter(|&column| judged.is_empty[column]);
        for column in ended {
            columns[column].is_numeric = dialect.is_value(rows[0][column]);
            columns[column].is_stamped = stamp::is_stamp(rows[0][column].as_bytes());
        }
        while columns.len() > 1 && columns.last().is_some_and(|c| c.header.is_empty() && !c.is_numeric) {
            columns.pop();
        }
        let is_nameless = header.is_err() || columns[0].header.is_empty();
        for (index, column) in columns.iter_mut().enumerate().filter(|(_, column)| column.header.is_empty()) {
            column.header = (index + 1).to_string();
        }
        let above = header.as_ref().map_or(first, |header| header.line);
        let interval = header.as_ref().ok().and_then(|header| header.interval.as_deref());
        let preamble = Preamble::of(&lines[..first], delimiter, interval);
        let times = time_column::find(
            &columns,
            is_nameless && is_first_rising(&rows, dialect.decimal),
            dialect.decimal,
            |column| rows.iter().filter_map(move |cells| cells.get(column).copied()),
        );
        let is_time = |column| times.taken == Some(column) || times.sure.contains(&column);
        let first_rows = |column: usize| -> Vec<f64> {
            let cells = rows.iter().filter_map(|cells| cells.get(column));
            cells.map(|cell| number::of_cell(cell.as_bytes(), dialect.decimal).unwrap_or(f64::NAN)).collect()
        };
        let sensors = sensors::find(&columns, is_time, &rows, first_rows);
        let is_open = |column: &usize| !is_time(*column) && sensors.iter().all(|it| it.column != *column);
        let counts = |column: &usize| {
            let cells = rows.iter().filter_map(|cells| cells.get(*column));
            let numbers = cells.map(|cell| counting::of_words(cell).unwrap_or(f64::NAN));
            let is_numeric = columns[*column].is_numeric;
            let numbers = if is_numeric { first_rows(*column) } else { numbers.collect() };
            !columns[*column].is_stamped && Counter::of(&numbers).is_some()
        };
        let open = || (0..columns.len()).filter(is_open);
        let counter = open().find(counts);
        let constant = |column: usize| {
            let name = &columns[column].name;
            let cell =
                rows[0].get(column).filter(|cell| rows.iter().all(|row| row.get(column) == Some(cell)));
            let text = cell.map_or_else(String::new, |cell| cell.replace(',', "."));
            factors::unexplained(name, &text)
        };
        let constants = open().filter(|column| columns[*column].is_numeric).filter_map(constant).collect();
        let last = &lines[lines.len() - 1];
        let row_bytes = (last.offset + last.text.len() + 1).saturating_sub(lines[first].offset);
        Some(Self {
            dialect,
            header: header.map(|header| header.line as u64 + 1),
            preamble_lines: above as u64,
            data_line: first as u64 + 1,
            data_offset: lines[first].offset,
            times,
            sensors,
            counter,
            preamble,
            constants,
            mean_row_bytes: (row_bytes / rows.len()).max(2),
            columns,
        })
    }

    /// The column of times of a channel: where several head columns of their own, the nearest on its left.
    pub(super) fn time_of(&self, column: usize) -> Option<usize> {
        let found = self.times.taken.filter(|&found| found != column)?;
        let is_alike =
            |c: &usize| self.columns[*c].is_numeric && self.columns[*c].header == self.columns[found].header;
        let is_it = |c: &usize| is_alike(c) || self.is_clock(*c);
        Some((0..column).rev().find(is_it).unwrap_or(found))
    }

    /// Whether a column of times heads columns of its own, as the second one of `Zeit 1, A1, Zeit 2, A2`.
    fn is_clock(&self, column: usize) -> bool {
        let is_time = |column: usize| self.times.sure.contains(&column);
        let is_first = column == 0 || !is_time(column - 1);
        let mut behind = (column + 1..self.columns.len()).skip_while(|c| is_time(*c));
        self.times.clocks.contains(&column)
            && is_first
            && behind.next().is_some_and(|behind| self.columns[behind].is_numeric)
    }

    /// Whether a column is certain to hold times.
    pub(super) fn holds_times(&self, column: usize) -> bool {
        self.times.sure.contains(&column) || self.times.nanoseconds == Some(column)
    }

    /// Whether a column is the first that names the sensor of each row.
    pub(super) fn tells_sensors(&self, column: usize) -> bool {
        self.sensors.first().is_some_and(|sensors| sensors.column == column)
    }

    /// The column to be added to that of times, which holds whole seconds.
    pub(super) fn nanoseconds(&self, time: usize) -> Option<usize> {
        self.times.nanoseconds.filter(|_| self.times.taken == Some(time))
    }

    /// The other columns of times, which have to bear out those of column `time`; each with whether other
    /// columns stand between.
    ///
    /// One of the same header, or each at the left of its own columns, is the clock of those.
    pub(super) fn witnesses(&self, time: usize) -> Vec<(usize, bool)> {
        let is_apart =
            |&c: &usize| (c.min(time)..c.max(time)).any(|i| i != time && !self.times.sure.contains(&i));
        let others = self.times.sure.iter().filter(|&&c| c != time).map(|c| (*c, is_apart(c)));
        let is_other = |c: usize| self.is_clock(c) && self.is_clock(time);
        let is_alike = |c: usize| self.columns[c].header == self.columns[time].header;
        others.filter(|&(c, is_apart)| !is_apart || !(is_alike(c) || is_other(c))).collect()
    }

    /// A column, none of `taken`, by which the rows are of several sensors, with these; `own` is the column
    /// and word that tell one apart.
    pub(super) fn mixed(&self, own: Option<(usize, &str)>, taken: &[usize]) -> Option<(&str, Vec<&str>)> {
        let by = own.and_then(|(column, is)| Some((self.sensors.iter().find(|it| it.column == column)?, is)));
        let open = self
            .sensors
            .iter()
            .filter(|it| !taken.contains(&it.column) && own.is_none_or(|own| own.0 != it.column));
        let mut named = open.map(|it| (self.columns[it.column].header.as_str(), it.named(by)));
        named.find(|(_, named)| named.len() > 1)
    }

    /// Numbers above the rows, or the same in each of them, that may be factors of the samples.
    pub(super) fn factors(&self) -> Vec<String> {
        self.preamble.factors.iter().chain(&self.constants).cloned().collect()
    }

    /// The columns whose header, or header without unit, is `wanted`.
    pub(super) fn find(&self, wanted: &str) -> Vec<usize> {
        let wanted = wanted.trim();
        let matching = |is: fn(&TableColumn, &str) -> bool| -> Vec<usize> {
            (0..self.columns.len()).filter(|&i| is(&self.columns[i], wanted)).collect()
        };
        // A column of another name may be called by its number.
        let number = wanted.parse().ok().filter(|number| (1..=self.columns.len()).contains(number));
        let found = [matching(|it, wanted| it.header == wanted), matching(|it, wanted| it.name == wanted)];
        let found = found.into_iter().find(|found| !found.is_empty());
        found.unwrap_or_else(|| number.map(|number| number - 1).into_iter().collect())
    }

    /// What a cask file calls a column: its header, or its number where others have the same.
    pub(super) fn unique_name(&self, column: usize) -> String {
        let header = &self.columns[column].header;
        if self.find(header).len() == 1 { header.clone() } else { (column + 1).to_string() }
    }

    /// Every header.
    pub(super) fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.header.clone()).collect()
    }

    /// About how many rows a file of so many bytes holds, a little more.
    pub(super) fn rows_expected(&self, bytes: u64) -> usize {
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        (bytes / self.mean_row_bytes).saturating_add(bytes / self.mean_row_bytes / 32 + 16)
    }
}

fn is_first_rising(rows: &[Vec<&str>], decimal: u8) -> bool {
    let first = |cells: &Vec<&str>| cells.first().and_then(|cell| number::of_cell(cell.as_bytes(), decimal));
    let firsts: Vec<f64> = rows.iter().filter_map(first).collect();
    firsts.len() > 1 && firsts.windows(2).all(|pair| pair[0] < pair[1])
}
