//! Delimited text to the list of its columns, on the clock that reading one of them would take.

use super::super::{clock::Claims, error::IngestError, lines::Text, refusal::Refusal};
use super::super::{number, shown};
use super::columns::HeldColumn;
use super::complaint::{no_table, row_error};
use super::header::TableColumn;
use super::layout::Layout;
use super::pieces::Sizes;
use super::plan::ColumnPlan;
use super::rows::{self, RowsPart, Sink};
use super::sensors::{self, Filled, Sensors};
use super::table::Table;
use super::wanted::Wanted;
use crate::data::{ClockFinding, Finding, ListedChannel, Listing, RecordingFormat, RowsOf, is_number};
use crate::ingest::ReadRequest;
use crate::ingest::assemble::shifted;
use crate::ingest::time_base::Uniform;
use crate::numerics::{as_f64, extent};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What is known of a column, or of its rows of one sensor, after one pass.
#[derive(Debug, Clone, Default)]
struct Range {
    words: u64,
    /// The first of the words, or its beginning.
    word: Option<String>,
    /// The rows of the numbers.
    rows: Filled,
}

/// Keeps the columns that one channel would take, and of all columns what they hold.
#[derive(Debug)]
pub(super) struct Survey<'a> {
    kept: Table<'a>,
    /// The places among all columns of those that are kept.
    slots: Vec<usize>,
    /// The slot of the column that names sensors, and what stands for each of them.
    sensors: Option<(usize, Vec<f64>)>,
    /// Of each column, of each sensor.
    ranges: Vec<Vec<Range>>,
    rows: usize,
    /// Rows up to the last that holds a number.
    filled: usize,
}

impl<'a> Survey<'a> {
    /// Before the first row; `all` are read, and those of `kept` kept.
    pub(super) fn of(all: &Wanted, kept: Table<'a>) -> Self {
        let layout = kept.layout;
        let value = |name: &&str| sensors::value(name.as_bytes(), layout.dialect.decimal);
        let sensors = layout.sensors.first();
        let sensors = sensors.map(|it| (all.slot(it.column), it.named(None).iter().map(value).collect()));
        let count = sensors.as_ref().map_or(1, |(_, sensors): &(usize, Vec<f64>)| sensors.len());
        Self {
            sensors,
            slots: kept.wanted.columns.iter().map(|&column| all.slot(column)).collect(),
            kept,
            ranges: vec![vec![Range::default(); count]; all.columns.len()],
            rows: 0,
            filled: 0,
        }
    }
}

impl Sink for Survey<'_> {
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        let kept = self.slots.iter().position(|&kept| kept == slot);
        let value = kept.and_then(|kept| self.kept.word(kept, cell));
        let is_time = kept.is_some_and(|kept| self.kept.wanted.is_time[kept]);
        if !is_time && value.is_none_or(f64::is_nan) {
            let range = &mut self.ranges[slot][0];
            range.words += 1;
            range.word.get_or_insert_with(|| rows::shown(cell));
        }
        value.or((!is_time).then_some(f64::NAN))
    }

    fn append(&mut self, parts: &mut [RowsPart]) {
        let (sensors, before) = (&self.sensors, self.rows);
        let of_column = |(slot, ranges): (usize, &mut Vec<Range>)| {
            let (mut rows, mut filled) = (before, 0);
            for part in &*parts {
                let values = &part.0[slot];
                for (row, &value) in values.iter().enumerate().filter(|(_, value)| is_number(**value)) {
                    filled = rows + row + 1;
                    let sensor = sensors.as_ref().map_or(Some(0), |(slot, sensors)| {
                        sensors.iter().position(|own| own.total_cmp(&part.0[*slot][row]).is_eq())
                    });
                    if let Some(sensor) = sensor {
                        ranges[sensor].rows.take(rows + row, value);
                    }
                }
                rows += values.len();
            }
            filled
        };
        let filled = self.ranges.par_iter_mut().enumerate().map(of_column).max();
        self.filled = self.filled.max(filled.unwrap_or_default());
        self.rows += parts.iter().map(|part| part.0.first().map_or(0, Vec::len)).sum::<usize>();
        self.kept.extend(parts, |slot| self.slots[slot]);
        parts.iter_mut().for_each(RowsPart::clear);
    }

    fn held_bytes(&self) -> u64 {
        self.kept.held_bytes()
    }
}

/// Lists the columns of a text.
///
/// # Errors
/// A file that cannot be read or holds no rows of numbers.
pub(in super::super) fn list(request: ReadRequest) -> Result<Listing, IngestError> {
    let ReadRequest { file, limits, .. } = request;
    let (path, text) = (file.path, Text::open(file, limits)?);
    let (bytes, encoding) = (text.bytes, text.encoding);
    let layout = Layout::of(&text).ok_or_else(|| no_table(path))?;
    let time_column = layout.times.taken;
    // Other columns of times are none's: a pair of columns may end before others.
    let is_timed = |column: usize| !layout.holds_times(column);
    let time_of =
        |column: usize| layout.time_of(column).filter(|time| Some(*time) == time_column && is_timed(column));
    let values: Vec<(usize, Option<usize>)> =
        (0..layout.columns.len()).map(|column| (column, time_of(column))).collect();
    let all = Wanted::new(&values, &[]);
    let mut clocks = vec![time_column];
    for clock in (0..layout.columns.len()).filter(|c| is_timed(*c)).map(|c| layout.time_of(c)) {
        if clock.is_some() == time_column.is_some() && !clocks.contains(&clock) {
            clocks.push(clock);
        }
    }
    let plans: Vec<ColumnPlan> = clocks.iter().map(|clock| plan(&layout, *clock)).collect();
    let kept = Wanted::of(&plans, &layout);
    let columns = vec![HeldColumn::default(); kept.columns.len()];
    let mut survey = Survey::of(&all, Table::new(&layout, &plans, &kept, columns));
    let sizes = Sizes::of(limits, text.bytes);
    let ending = rows::read(text, (&layout, &all), &mut survey, sizes, request.progress)
        .map_err(|error| row_error(request, (&layout, &all), error))?;
    let Survey { kept: table, ranges, filled: rows, .. } = survey;
    let mut issues = Vec::from_iter(ending.map(Finding::from));
    let mut listed_clocks = ListedClock::all(table, &mut issues).unwrap_or_else(|refusal| {
        issues.push(ClockFinding::Refused(refusal.beside("")).into());
        Vec::new()
    });
    listed_clocks.resize_with(clocks.len(), ListedClock::default);
    for (clock, column) in listed_clocks.iter_mut().zip(&clocks).filter(|_| clocks.len() > 1) {
        clock.shown.time = column.map(|column| layout.unique_name(column));
    }
    issues.extend(layout.preamble.of_rows(rows, listed_clocks[0].samples));
    let mut channels = Vec::new();
    for (index, column) in layout.columns.iter().enumerate().filter(|(index, _)| Some(*index) != time_column)
    {
        let own = clocks.iter().position(|clock| *clock == layout.time_of(index)).unwrap_or_default();
        let clock = &listed_clocks[own];
        let sensors = layout.sensors.first();
        let is_of = |sensors: &Sensors, is: &str| RowsOf {
            column: layout.columns[sensors.column].header.clone(),
            is: is.to_owned(),
        };
        let named = sensors.filter(|it| it.column != index && column.is_numeric).map_or_else(
            || vec![None],
            |it| it.named(None).into_iter().map(|is| Some(is_of(it, is))).collect(),
        );
        for (sensor, rows_of) in named.into_iter().enumerate() {
            let mut listed = listed(column, &ranges[index], sensor, clock, rows);
            if layout.preamble.has_several_rates() && time_column.is_none() {
                let stated = layout.preamble.statements(index);
                listed.sample_rate_hz = stated.first().map(|stated| stated.rate_hz);
                let last = ranges[index][0].rows.last;
                listed.samples = Some(last as u64 + 1);
                listed.duration_s = listed.sample_rate_hz.map(|rate_hz| as_f64(last) / rate_hz);
            }
            if sensors.is_some_and(|it| it.column == index) {
                listed.unreadable = Some("tells the rows of several sensors apart".to_owned());
                listed.range = None;
            }
            channels.push(ListedChannel { rows: rows_of, ..listed });
        }
    }
    Ok(Listing {
        counts: BTreeMap::from([
            ("rows".into(), rows as u64),
            ("columns".into(), layout.columns.len() as u64),
            ("preamble_lines".into(), layout.preamble_lines),
        ]),
        facts: facts(&layout, encoding, &clocks),
        channels,
        issues,
        ..Listing::new(path, bytes, RecordingFormat::Csv)
    })
}

/// What a channel would take whose cask file says nothing but its source: the first column of numbers on
/// those times.
fn plan(layout: &Layout, time_column: Option<usize>) -> ColumnPlan {
    let sensors = layout.sensors.first();
    let is_taken =
        |column: usize| layout.holds_times(column) || sensors.is_some_and(|it| it.column == column);
    let is_numbers = |&column: &usize| layout.columns[column].is_numeric && !is_taken(column);
    let mut found =
        (0..layout.columns.len()).filter(is_numbers).filter(|column| Some(*column) != time_column);
    let column =
        found.find(|column| layout.time_of(*column) == time_column).or(time_column).unwrap_or_default();
    let claims = Claims { stated: layout.preamble.statements(column), ..Claims::default() };
    let rows = sensors.map(|it| (it.column, it.named(None)[0].to_owned()));
    ColumnPlan { column, time_column, rows, start_s: 0.0, ends_alone: false, claims }
}

/// When the samples of every column were taken.
#[derive(Default)]
struct ListedClock {
    /// As the listing shows it.
    shown: ListedChannel,
    first_s: f64,
    times_s: Vec<f64>,
    /// With those that times show to be missing.
    samples: usize,
}

impl ListedClock {
    /// As reading takes them, one a plan; what speaks against them goes to `issues`.
    fn all(mut table: Table, issues: &mut Vec<Finding>) -> Result<Vec<Self>, Refusal> {
        let plans = table.plans;
        table.drop_blank()?;
        issues.extend(table.settle_times().map_err(|refused| refused.refusal)?);
        issues.extend(table.place_by_counter().map_err(|refused| refused.refusal)?);
        if plans.iter().any(|plan| plan.time_column.is_none() && plan.claims.is_empty()) {
            return Ok(Vec::new());
        }
        let own_rows = table.own_rows().map_err(|refused| refused.refusal)?;
        let times_of = |plan: &ColumnPlan| {
            let column = &table.columns[table.wanted.slot(plan.time_column?)];
            Some(column.values().into_owned())
        };
        let times: Vec<Option<Vec<f64>>> = plans.iter().map(times_of).collect();
        for plan in plans.iter().filter(|plan| plan.time_column != Some(plan.column)) {
            // A value that is missing is no gap of the times.
            let column = &mut table.columns[table.wanted.slot(plan.column)];
            column.each_mut().iter_mut().filter(|value| !is_number(**value)).for_each(|value| *value = 0.0);
        }
        let count = |own: &Option<Vec<bool>>| {
            own.as_ref().map_or(table.rows(), |own| own.iter().filter(|is_own| **is_own).count())
        };
        if own_rows.iter().any(|own| count(own) < 2) {
            return Ok(Vec::new());
        }
        let uniforms = table.uniforms(&own_rows).into_iter().zip(times);
        uniforms.map(|(uniform, times)| Ok(Self::of(uniform?, times, issues))).collect()
    }

    fn of(uniform: Uniform, times: Option<Vec<f64>>, issues: &mut Vec<Finding>) -> Self {
        let (first_s, last_s) = extent(times.iter().flatten().copied());
        let mut shown = ListedChannel::default();
        uniform.list(times.as_ref().map(|_| (first_s, last_s)), &mut shown);
        issues.extend(uniform.issues.into_iter().map(|issue| shifted(issue, first_s)));
        Self {
            shown: ListedChannel { start_s: Some(0.0), ..shown },
            samples: uniform.samples.len(),
            first_s,
            times_s: times.unwrap_or_default(),
        }
    }
}

/// A column of `ranges`, its rows of one sensor; where those of other sensors or topics lie between, on the
/// clock of its own.
fn listed(
    column: &TableColumn,
    ranges: &[Range],
    sensor: usize,
    clock: &ListedClock,
    rows: usize,
) -> ListedChannel {
    let (range, own) = (&ranges[0], &ranges[sensor]);
    let is_empty = own.rows.count == 0;
    let is_short = clock.shown.time.is_some() && own.rows.count < rows;
    let is_apart = !is_empty && (column.is_numeric && ranges.len() > 1 || own.rows.lie_between() || is_short);
    let time_s = |row: usize| clock.times_s.get(row).filter(|_| is_apart).copied();
    let (first_s, last_s) = (time_s(own.rows.first), time_s(own.rows.last));
    let duration_s = first_s.zip(last_s).map(|(first_s, last_s)| last_s - first_s);
    let own_hz = duration_s.filter(|span_s| *span_s > 0.0).map(|span_s| as_f64(own.rows.count - 1) / span_s);
    let unreadable = if column.is_stamped {
        Some("date-time stamps or clock times".to_owned())
    } else if let Some(word) = &range.word {
        let count = if is_empty { "its".to_owned() } else { format!("{} of {rows}", range.words) };
        let reason = if number::is_grouped(word, None) {
            ": the thousands are marked too, and only a decimal mark is read"
        } else {
            ""
        };
        Some(format!("{count} cells are no numbers, such as {word:?}{reason}"))
    } else if is_empty {
        Some("empty".to_owned())
    } else {
        None
    };
    ListedChannel {
        samples: Some(if is_apart { own.rows.count } else { rows } as u64),
        sample_rate_hz: own_hz.or(clock.shown.sample_rate_hz),
        unit: column.unit.clone(),
        start_s: first_s.map(|first_s| first_s - clock.first_s).or(clock.shown.start_s),
        duration_s: duration_s.or(clock.shown.duration_s),
        gaps: clock.shown.gaps.filter(|_| !is_apart),
        range: (!is_empty && !column.is_stamped).then_some(own.rows.range),
        encoding: clock.shown.time.as_ref().map_or("text".into(), |time| format!("text, times in {time:?}")),
        time: clock.shown.time.clone(),
        unreadable,
        ..ListedChannel::new(&column.header, "column")
    }
}

fn facts(layout: &Layout, encoding: &str, clocks: &[Option<usize>]) -> BTreeMap<String, String> {
    let delimiter = match layout.dialect.delimiter.0 {
        b';' => "semicolon",
        b'\t' => "tab",
        b',' => "comma",
        b'|' => "vertical bar",
        _ => "blanks",
    };
    let decimal = if layout.dialect.decimal == b',' { "comma" } else { "point" };
    let header = match &layout.header {
        Ok(line) => format!("line {line}"),
        Err(unfit) => format!("none: columns count 1, 2, …{unfit}"),
    };
    let names = clocks.iter().flatten().map(|clock| layout.columns[*clock].header.clone());
    let time = Some(names.collect::<Vec<String>>().join(", ")).filter(|names| !names.is_empty());
    let time = time.unwrap_or_else(|| none_found(layout));
    BTreeMap::from([
        ("delimiter".into(), delimiter.into()),
        ("decimal mark".into(), decimal.into()),
        ("encoding".into(), encoding.into()),
        ("header".into(), header),
        ("time column".into(), time),
    ])
}

fn none_found(layout: &Layout) -> String {
    let stated = layout.preamble.statements(usize::MAX);
    let stated =
        stated.first().map(|stated| format!("; {} states {} Hz", stated.place, shown::hz(stated.rate_hz)));
    let like = super::plan::no_times(layout).map(|why| format!(": {why}"));
    format!("none found{}{}", like.unwrap_or_default(), stated.unwrap_or_default())
}
