//! Delimited text to the list of its columns, on the clock that reading one of them would take.

use super::super::clock::{Claims, Refusal};
use super::super::error::IngestError;
use super::super::{number, shown};
use super::columns::{HeldColumn, Keep};
use super::complaint::{self, no_table, row_error};
use super::header;
use super::layout::Layout;
use super::lines::Text;
use super::plan::ColumnPlan;
use super::rows::{self, RowsPart, Sink};
use super::table::Table;
use super::wanted::Wanted;
use super::{Limits, Progress};
use crate::data::{ClockFinding, Finding, IssueCode, ListedChannel, Listing, RecordingFormat};
use crate::ingest::time_base::TimeBaseError;
use std::collections::BTreeMap;
use std::path::Path;

/// What is known of a column after one pass.
#[derive(Debug, Clone, Default)]
struct Range {
    words: u64,
    /// The first of the words, or its beginning.
    word: Option<String>,
    /// The smallest and the largest number.
    numbers: Option<(f64, f64)>,
}

/// Keeps the columns that one channel would take, and of all columns what they hold.
#[derive(Debug)]
pub(super) struct Survey<'a> {
    keep: Keep<'a>,
    /// The places among all columns of those that are kept.
    slots: Vec<usize>,
    ranges: Vec<Range>,
    rows: usize,
    /// Rows up to the last that holds a number.
    filled: usize,
}

impl<'a> Survey<'a> {
    /// Before the first row; `all` are read, and `kept` of them kept.
    pub(super) fn of(all: &Wanted, kept: &'a Wanted) -> Self {
        Self {
            keep: Keep::new(kept, vec![HeldColumn::default(); kept.columns.len()]),
            slots: kept.columns.iter().map(|&column| all.slot(column)).collect(),
            ranges: vec![Range::default(); all.columns.len()],
            rows: 0,
            filled: 0,
        }
    }
}

impl Sink for Survey<'_> {
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        let kept = self.slots.iter().position(|&kept| kept == slot);
        let value = kept.and_then(|kept| self.keep.word(kept, cell));
        let is_time = kept.is_some_and(|kept| self.keep.is_time(kept));
        if !is_time && value.is_none_or(f64::is_nan) {
            let range = &mut self.ranges[slot];
            range.words += 1;
            range.word.get_or_insert_with(|| rows::shown(cell));
        }
        value.or((!is_time).then_some(f64::NAN))
    }

    fn append(&mut self, parts: &mut [RowsPart]) {
        for part in &*parts {
            for (range, values) in self.ranges.iter_mut().zip(&part.0) {
                for (row, &value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
                    let (smallest, largest) = range.numbers.unwrap_or((value, value));
                    range.numbers = Some((smallest.min(value), largest.max(value)));
                    self.filled = self.filled.max(self.rows + row + 1);
                }
            }
            self.rows += part.0.first().map_or(0, Vec::len);
        }
        let mut take = |part: &mut RowsPart| {
            RowsPart(self.slots.iter().map(|&slot| std::mem::take(&mut part.0[slot])).collect())
        };
        let mut kept: Vec<RowsPart> = parts.iter_mut().map(&mut take).collect();
        self.keep.append(&mut kept);
        parts.iter_mut().for_each(RowsPart::clear);
    }

    fn held_bytes(&self) -> u64 {
        self.keep.held_bytes()
    }
}

/// Lists the columns of the text at `path`.
///
/// # Errors
/// A file that cannot be read or holds no rows of numbers.
pub(in super::super) fn list(
    path: &Path,
    limits: Limits,
    progress: Progress,
) -> Result<Listing, IngestError> {
    let text = Text::open(path, limits)?;
    let (bytes, encoding) = (text.bytes, text.encoding);
    let layout = Layout::of(&text).ok_or_else(|| no_table(path))?;
    let time_column = layout.time_column;
    // Other columns of times are none's: a pair of columns may end before others.
    let is_timed = |column: usize| !layout.holds_times(column);
    let time_of =
        |column: usize| layout.time_of(column).filter(|time| Some(*time) == time_column && is_timed(column));
    let values: Vec<(usize, Option<usize>)> =
        (0..layout.columns.len()).map(|column| (column, time_of(column))).collect();
    let all = Wanted::new(&values, &[]);
    let plans = [plan(&layout)];
    let kept = Wanted::of(&plans, &layout);
    let mut survey = Survey::of(&all, &kept);
    let ending = rows::read(text, &layout, &all, &mut survey, (limits, progress))
        .map_err(|error| row_error(path, limits, (&layout, &all), error))?;
    let Survey { keep: Keep { columns, stamps, .. }, ranges, filled: rows, .. } = survey;
    let mut issues = Vec::from_iter(ending.map(Finding::from));
    let table = Table { layout: &layout, plans: &plans, wanted: &kept, columns, stamps };
    let clock = ListedClock::of(table, &mut issues).unwrap_or_else(|Refusal { problem, remedy }| {
        issues.push(ClockFinding::Refused(format!("{problem}: {remedy}")).into());
        ListedClock::default()
    });
    issues.extend(layout.preamble.of_rows(rows, clock.samples));
    let channels = layout
        .columns
        .iter()
        .enumerate()
        .filter(|(index, _)| Some(*index) != time_column)
        .map(|(index, column)| listed(column, &ranges[index], &clock, rows as u64))
        .collect();
    Ok(Listing {
        schema: "dropcheck.inspect/1",
        recording: path.display().to_string(),
        bytes,
        format: RecordingFormat::Csv,
        counts: BTreeMap::from([
            ("rows".into(), rows as u64),
            ("columns".into(), layout.columns.len() as u64),
            ("preamble_lines".into(), layout.preamble_lines),
        ]),
        facts: facts(&layout, encoding),
        channels,
        issues,
    })
}

/// What a channel would take whose cask file says nothing but its source: the first column of numbers, on the times that were found.
fn plan(layout: &Layout) -> ColumnPlan {
    let time_column = layout.time_column;
    let is_numbers = |&column: &usize| layout.columns[column].is_numeric && !layout.holds_times(column);
    let mut found =
        (0..layout.columns.len()).filter(is_numbers).filter(|column| Some(*column) != time_column);
    let column =
        found.find(|column| layout.time_of(*column) == time_column).or(time_column).unwrap_or_default();
    let claims = Claims { stated: layout.preamble.statements(column), ..Claims::default() };
    ColumnPlan { column, time_column, claims }
}

/// When the samples of every column were taken.
#[derive(Default)]
struct ListedClock {
    sample_rate_hz: Option<f64>,
    start_s: Option<f64>,
    duration_s: Option<f64>,
    gaps: Option<u64>,
    /// With those that times show to be missing.
    samples: usize,
}

impl ListedClock {
    /// As reading takes it; what speaks against it goes to `issues`.
    #[allow(clippy::cast_precision_loss, reason = "row counts stay below 2^52")]
    fn of(mut table: Table, issues: &mut Vec<Finding>) -> Result<Self, Refusal> {
        let plan = &table.plans[0];
        table.drop_blank()?;
        issues.extend(table.counter_jumps());
        if plan.time_column.is_none() && plan.claims.is_empty() {
            return Ok(Self::default());
        }
        issues.extend(table.settle_times().map_err(|refused| refused.refusal)?);
        table.drop_untimed();
        let slot = |column: usize| table.wanted.slot(column);
        let times = plan.time_column.map(|time| table.columns[slot(time)].values().into_owned());
        let (first_s, last_s) = times
            .iter()
            .flatten()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)));
        if plan.time_column != Some(plan.column) {
            // A value that is missing is no gap of the times.
            let at = slot(plan.column);
            table.columns[at]
                .each_mut()
                .iter_mut()
                .filter(|value| value.is_nan())
                .for_each(|value| *value = 0.0);
        }
        let uniform = match table.uniforms().remove(0) {
            Err(TimeBaseError::TooFew { .. }) => return Ok(Self::default()),
            uniform => uniform.map_err(|error| error.refusal(complaint::TIMES_REMEDY))?,
        };
        let count = uniform.samples.len();
        let has_gaps = uniform.issues.iter().any(|issue| issue.code == IssueCode::Gap);
        issues.extend(uniform.issues.into_iter().map(|issue| Finding {
            from_s: issue.from_s.map(|t| t - first_s),
            to_s: issue.to_s.map(|t| t - first_s),
            ..issue
        }));
        let of_rate = count.saturating_sub(1) as f64 / uniform.sample_rate_hz;
        Ok(Self {
            sample_rate_hz: Some(uniform.sample_rate_hz),
            start_s: Some(0.0),
            duration_s: Some(if times.is_some() { last_s - first_s } else { of_rate }),
            gaps: times.is_some().then_some(if has_gaps { uniform.gaps.len() as u64 } else { 0 }),
            samples: count,
        })
    }
}

fn listed(column: &header::TableColumn, range: &Range, clock: &ListedClock, rows: u64) -> ListedChannel {
    let is_empty = range.numbers.is_none();
    let unreadable = if column.is_stamped {
        Some("date-time stamps or clock times".to_owned())
    } else if let Some(word) = &range.word {
        let count = if is_empty { "its".to_owned() } else { format!("{} of {rows}", range.words) };
        let reason = if number::is_grouped(word) {
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
        source: column.header.clone(),
        kind: "column".into(),
        samples: Some(rows),
        messages: None,
        sample_rate_hz: clock.sample_rate_hz,
        unit: column.unit.clone(),
        start_s: clock.start_s,
        duration_s: clock.duration_s,
        gaps: clock.gaps,
        range: range.numbers.filter(|_| !column.is_stamped),
        encoding: "text".into(),
        unreadable,
    }
}

fn facts(layout: &Layout, encoding: &str) -> BTreeMap<String, String> {
    let delimiter = match layout.dialect.delimiter.0 {
        b';' => "semicolon",
        b'\t' => "tab",
        b',' => "comma",
        b'|' => "vertical bar",
        _ => "blanks",
    };
    let decimal = if layout.dialect.decimal == b',' { "comma" } else { "point" };
    let header = if layout.header_line > 0 {
        format!("line {}", layout.header_line)
    } else {
        "none: columns count 1, 2, …".to_owned()
    };
    let time = layout
        .time_column
        .and_then(|index| layout.columns.get(index))
        .map_or_else(|| none_found(layout), |column| column.header.clone());
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
    format!("none found{}", stated.unwrap_or_default())
}
