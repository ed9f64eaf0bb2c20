//! The lines above a table to what they state of it: how many rows it has, and at what rate they were taken.

use super::super::lines::Line;
use super::cells::Delimiter;
use super::header::{header_cells, name_and_unit};
use crate::data::{Finding, TableFinding};
use crate::ingest::vocabulary::{Meaning, meaning, rate_unit_hz, time_unit_s};
use crate::ingest::{factors, number, statement::Statement, statement::number_and_unit};

/// What closes the header of LabVIEW's measurement files, and that of the first segment in it.
const END_OF_HEADER: &str = "***End_of_Header***";

/// What is stated above a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Preamble {
    /// Of the rows.
    counts: Vec<u64>,
    /// Of all columns.
    rates: Vec<Statement>,
    /// Of each column, by the cells of LabVIEW's `Delta_X`.
    intervals: Vec<Option<Statement>>,
    /// When each column begins, s, by the cells of LabVIEW's `X0`.
    starts_s: Vec<f64>,
    /// Numbers that may be factors of the samples.
    pub factors: Vec<String>,
}

/// How many lines the header of a measurement file of LabVIEW has; 0 in others.
pub(super) fn labview_lines(lines: &[Line]) -> usize {
    let is_end = |line: &Line| line.text.trim_start().starts_with(END_OF_HEADER);
    // A further one closes the header of a further segment, whose rows are another table.
    let ends = lines.iter().enumerate().filter(|(_, line)| is_end(line)).map(|(i, _)| i + 1).take(2);
    ends.last().unwrap_or(0)
}

impl Preamble {
    /// Of the lines above the header, and the `interval` in s that it states itself.
    pub(super) fn of(above: &[Line], delimiter: Delimiter, interval: Option<&str>) -> Self {
        let interval = interval.and_then(|text| Statement::of("Increment", text, Meaning::Interval(1.0)));
        let rates = interval.into_iter().map(|stated| stated.at(1)).collect();
        let starts = labview_cells(above, delimiter, "X0");
        // Without columns of times the names of these lines may head none of the samples.
        let is_no = labview_cells(above, delimiter, "X_Columns").get(1).is_some_and(|word| word == "No");
        let first = usize::from(is_no && labview_cells(above, delimiter, "X_Value").is_empty());
        let start_s = |cell: &String| cell.replace(',', ".").parse().unwrap_or(0.0);
        let starts_s = starts.iter().skip(first).map(start_s).collect();
        let intervals = labview_rates(above, delimiter).split_off(first.min(starts.len()));
        let mut preamble = Self { rates, intervals, starts_s, ..Self::default() };
        for line in above {
            preamble.factors.extend(factor_in(&line.text, delimiter));
            let Some((name, value)) = entry(&line.text, delimiter) else { continue };
            let Some((number, unit)) = number_and_unit(&value) else { continue };
            // DASYLab's interval: `Delta : 0.0001 sec.`.
            match meaning(if name == "Delta" { "dt" } else { &name }) {
                Some(Meaning::Count) => preamble.counts.extend(number.parse::<u64>()),
                // A bare number may be in Hz or kHz, in s or ms; that of Yokogawa's oscilloscopes is in s.
                Some(meaning) if !unit.is_empty() || ends_in_unit(&name) || name == "HResolution" => {
                    preamble.rates.extend(Statement::of(&name, &value, meaning).map(|stated| stated.at(1)));
                }
                _ => {}
            }
        }
        preamble
    }

    /// When a column without times begins, s.
    pub(super) fn start_s(&self, column: usize) -> f64 {
        self.starts_s.get(column).copied().unwrap_or_default()
    }

    /// What is stated of the rate of a column; of all columns by `Delta_X` where the column has none of its
    /// own.
    pub(super) fn statements(&self, column: usize) -> Vec<Statement> {
        let own = self.intervals.get(column).cloned().flatten();
        let mut stated =
            own.map_or_else(|| self.intervals.iter().flatten().cloned().collect(), |own| vec![own]);
        stated.dedup_by(|one, other| one.place == other.place);
        stated.extend(self.rates.iter().cloned());
        stated
    }

    /// Whether columns have rates of their own, so that one may end before another.
    pub(super) fn has_several_rates(&self) -> bool {
        let mut rates = self.intervals.iter().flatten();
        rates.next().is_some_and(|first| rates.any(|other| other.place != first.place))
    }

    /// A warning where fewer rows are there than every count that is stated, also with the samples between
    /// that times show to be missing.
    pub(super) fn of_rows(&self, rows: usize, with_missing: usize) -> Option<Finding> {
        let stated = *self.counts.iter().min()?;
        let is_short = (rows.max(with_missing) as u64) < stated;
        is_short.then(|| TableFinding::RowsMissing { stated, rows }.into())
    }
}

fn labview_cells(lines: &[Line], delimiter: Delimiter, name: &str) -> Vec<String> {
    let mut cells = lines.iter().rev().map(|line| header_cells(&line.text, delimiter));
    cells.find(|cells| cells.first().is_some_and(|first| first == name)).unwrap_or_default()
}

/// The rate that each cell of `Delta_X` states, which stands above the rows of LabVIEW's files.
fn labview_rates(lines: &[Line], delimiter: Delimiter) -> Vec<Option<Statement>> {
    let dimensions = labview_cells(lines, delimiter, "X_Dimension");
    let is_time = |cell: usize| {
        let dimension = dimensions.get(cell).or(dimensions.last());
        dimension.is_none_or(|dimension| ["", "Time", "X_Dimension"].contains(&dimension.as_str()))
    };
    let rate = |cell: &String| Statement::of("Delta_X", &cell.replace(',', "."), Meaning::Interval(1.0));
    labview_cells(lines, delimiter, "Delta_X")
        .iter()
        .enumerate()
        .map(|(i, cell)| rate(cell).filter(|_| is_time(i)))
        .collect()
}

/// `Sample rate [Hz]: 50000`, `Abtastrate;50;kHz` or `dt = 20 us` to its name and "50000 Hz", "50 kHz", "20
/// us"; `None` where several numbers differ, as those of several channels.
fn entry(line: &str, delimiter: Delimiter) -> Option<(String, String)> {
    let cells = if delimiter.is_run() { vec![line.to_owned()] } else { header_cells(line, delimiter) };
    let (first, rest) = cells.split_first()?;
    let (key, value) =
        first.trim_start_matches(['#', '%', ' ']).split_once([':', '=']).unwrap_or((first, ""));
    let (name, unit) = name_and_unit(key.trim());
    let values = [value].into_iter().chain(rest.iter().map(String::as_str)).map(str::trim);
    let values: Vec<String> =
        values.filter(|value| !value.is_empty()).map(|value| value.replace(',', ".")).collect();
    let (first, rest) = values.split_first()?;
    // `10,000` is ten thousand, or ten with three decimals.
    let is_open = |number: &str| !number.starts_with('0') && number::is_grouped(number, Some(b'.'));
    if value.split_whitespace().next().is_some_and(is_open) {
        return None;
    }
    let is_number = |value: &String| value.parse::<f64>().is_ok();
    let unit = unit.or_else(|| rest.first().filter(|next| !is_number(next)).map(String::as_str));
    let is_one = rest.iter().all(|other| other == first || !is_number(other));
    let value =
        if is_number(first) { format!("{first} {}", unit.unwrap_or_default()) } else { first.clone() };
    is_one.then(|| (name.to_owned(), value.trim().to_owned()))
}

/// What a line says that may be a factor of the samples: `Scale factor;0,9;0,8`, `1 LSB = 0.9 g`, `# gain 2`.
pub(super) fn factor_in(line: &str, delimiter: Delimiter) -> Option<String> {
    // Lines above the rows may be parted otherwise than these.
    let parted_by = [b';', b'\t'].into_iter().find(|mark| line.as_bytes().contains(mark));
    let cells = match parted_by.map(Delimiter) {
        Some(own) => header_cells(line, own),
        None if delimiter.is_run() => vec![line.to_owned()],
        None => header_cells(line, delimiter),
    };
    let (first, rest) = cells.split_first()?;
    let first = first.trim_start_matches(['#', '%', ' ']);
    let (name, value) = first.split_once([':', '=']).unwrap_or((first, ""));
    let values = [value].into_iter().chain(rest.iter().map(String::as_str)).map(str::trim);
    let values: Vec<&str> = values.filter(|value| !value.is_empty()).collect();
    factors::unexplained(name.trim(), &values.join(" ").replace(',', "."))
}

/// Whether a unit stands in a name: `sample_rate_hz`.
fn ends_in_unit(name: &str) -> bool {
    let last = name.rsplit(['_', ' ']).next().filter(|last| last.len() < name.len());
    last.is_some_and(|last| rate_unit_hz(last).or_else(|| time_unit_s(last)).is_some())
}
