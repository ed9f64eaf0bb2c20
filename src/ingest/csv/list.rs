//! Delimited text to the list of its columns.

use super::super::error::IngestError;
use super::super::number;
use super::complaint::{ending_issues, no_table, row_error, twofold};
use super::input::Input;
use super::layout::{Column, Layout};
use super::rows::{self, Rows, Sink, Wanted};
use super::stamp::Stamps;
use super::{Limits, Progress, TimeBaseError, time_base, witness};
use crate::data::{Issue, IssueCode, ListedChannel, Listing, RecordingFormat, Samples, Severity};
use crate::ingest::time_reading::{Carrier, Reading, Scale};
use std::collections::BTreeMap;
use std::path::Path;

/// What is known of a column after one pass.
#[derive(Debug, Clone)]
struct Range {
    values: u64,
    words: u64,
    /// The first of the words, or its beginning.
    word: Option<String>,
    smallest: f64,
    largest: f64,
}

/// Keeps the times, and of the other columns their ranges.
#[derive(Debug)]
pub(super) struct Survey {
    seen: Seen,
    stamps: Stamps,
}

/// What some of the rows hold.
#[derive(Debug)]
pub(super) struct Seen {
    time_slot: Option<usize>,
    times: Vec<f64>,
    ranges: Vec<Range>,
    rows: u64,
}

impl Seen {
    fn nothing(time_slot: Option<usize>, columns: usize) -> Self {
        let range =
            Range { values: 0, words: 0, word: None, smallest: f64::INFINITY, largest: f64::NEG_INFINITY };
        Self { time_slot, times: Vec::new(), ranges: vec![range; columns], rows: 0 }
    }
}

impl Rows for Seen {
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        if self.time_slot == Some(slot) {
            return None;
        }
        let range = &mut self.ranges[slot];
        range.words += 1;
        range.word.get_or_insert_with(|| rows::shown(cell));
        Some(f64::NAN)
    }

    fn row(&mut self, values: &[f64]) {
        self.rows += 1;
        for (range, &value) in self.ranges.iter_mut().zip(values) {
            if value.is_finite() {
                range.values += 1;
                range.smallest = range.smallest.min(value);
                range.largest = range.largest.max(value);
            }
        }
        // A row for other columns than those with these times has none.
        if let Some(slot) = self.time_slot
            && !values[slot].is_nan()
        {
            self.times.push(values[slot]);
        }
    }
}

impl Survey {
    /// Before the first row.
    pub(super) fn of(time_slot: Option<usize>, columns: usize) -> Self {
        Self { seen: Seen::nothing(time_slot, columns), stamps: Stamps::default() }
    }
}

impl Rows for Survey {
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        if self.seen.time_slot == Some(slot) {
            self.stamps.seconds(slot, cell)
        } else {
            self.seen.word(slot, cell)
        }
    }

    fn row(&mut self, values: &[f64]) {
        self.seen.row(values);
    }
}

impl Sink for Survey {
    type Part = Seen;

    fn part(&self) -> Seen {
        Seen::nothing(self.seen.time_slot, self.seen.ranges.len())
    }

    fn append(&mut self, parts: &mut [Seen]) {
        for part in parts {
            let part = std::mem::replace(part, self.part());
            self.seen.rows += part.rows;
            self.seen.times.extend(part.times);
            for (range, more) in self.seen.ranges.iter_mut().zip(part.ranges) {
                range.values += more.values;
                range.words += more.words;
                range.word = range.word.take().or(more.word);
                range.smallest = range.smallest.min(more.smallest);
                range.largest = range.largest.max(more.largest);
            }
        }
    }

    fn held_bytes(&self) -> u64 {
        8 * self.seen.times.len() as u64
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
    let input = Input::open(path, limits)?;
    let (bytes, encoding) = (input.bytes, input.encoding);
    let layout = Layout::of(&input).ok_or_else(|| no_table(path))?;
    let time_column = layout.time_column;
    // Other columns of times are none's: a pair of columns may end before others.
    let is_timed = |column: usize| !layout.holds_times(column);
    let time_of =
        |column: usize| layout.time_of(column).filter(|time| Some(*time) == time_column && is_timed(column));
    let values: Vec<(usize, Option<usize>)> =
        (0..layout.columns.len()).map(|column| (column, time_of(column))).collect();
    let wanted = Wanted::new(&values, &[]);
    let mut survey = Survey::of(time_column, layout.columns.len());
    let ending = rows::read(input, &layout, &wanted, &mut survey, (limits, progress))
        .map_err(|error| row_error(path, limits, (&layout, &wanted), error))?;
    let Survey { mut seen, stamps } = survey;
    let mut issues = ending_issues(&ending);
    if let Some(column) = time_column.filter(|&column| !stamps.are_in(column)) {
        let reading = Reading::of(layout.time_scale(column), &seen.times, None);
        reading.apply(&mut seen.times);
        issues.extend(reading.issue(&layout.columns[column].header, Carrier::Column));
        if let Scale::Twofold(..) = layout.time_scale(column) {
            let (problem, mend) = twofold(&layout.columns[column]);
            issues.push(Issue::new(IssueCode::Clock, Severity::Warning, format!("{problem}: {mend}")));
        }
    }
    let stated = layout.stated_rate(usize::MAX);
    let clock = match stated.filter(|_| time_column.is_none()) {
        Some(stated) => Clock::at(stated.rate_hz, seen.rows),
        None => Clock::of(&seen.times),
    };
    if let Some(rate_hz) = clock.sample_rate_hz.filter(|_| time_column.is_some()) {
        issues.extend(witness::of_times(stated, rate_hz, &seen.times));
        issues.extend(layout.preamble.of_rate(rate_hz, Some(witness::rounding(&seen.times))));
    }
    let rows = usize::try_from(seen.rows).unwrap_or(usize::MAX);
    issues.extend(layout.preamble.of_rows((rows, clock.samples()), layout.columns.len()));
    let channels = layout
        .columns
        .iter()
        .enumerate()
        .filter(|(index, _)| Some(*index) != time_column)
        .map(|(index, column)| listed(column, &seen.ranges[index], &clock, seen.rows))
        .collect();
    issues.extend(clock.issues);
    Ok(Listing {
        schema: "dropcheck.inspect/1",
        recording: path.display().to_string(),
        bytes,
        format: RecordingFormat::Csv,
        counts: BTreeMap::from([
            ("rows".into(), seen.rows),
            ("columns".into(), layout.columns.len() as u64),
            ("preamble_lines".into(), layout.preamble_lines),
        ]),
        facts: facts(&layout, encoding),
        channels,
        issues,
    })
}

/// What the times say of every column.
#[derive(Default)]
struct Clock {
    sample_rate_hz: Option<f64>,
    start_s: Option<f64>,
    duration_s: Option<f64>,
    gaps: Option<u64>,
    issues: Vec<Issue>,
}

impl Clock {
    /// Samples from the first to the last, those in gaps among them.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast ends at the type's bounds"
    )]
    fn samples(&self) -> usize {
        let between = self.duration_s.zip(self.sample_rate_hz).map_or(0.0, |(s, hz)| s * hz);
        between.round() as usize + 1
    }

    /// Of rows that follow one another at a stated rate.
    #[allow(clippy::cast_precision_loss, reason = "row counts stay below 2^52")]
    fn at(rate_hz: f64, rows: u64) -> Self {
        Self {
            sample_rate_hz: Some(rate_hz),
            start_s: Some(0.0),
            duration_s: Some(rows.saturating_sub(1) as f64 / rate_hz),
            ..Self::default()
        }
    }

    fn of(times_s: &[f64]) -> Self {
        let repeated = times_s.windows(2).filter(|pair| pair[0] >= pair[1]).count();
        // The samples are not at hand: a few equal times are taken for rows that came twice, more for times that are coarse.
        let is_coarse = 10 * repeated > times_s.len();
        let samples = (0..times_s.len()).map(|i| if is_coarse && i % 2 == 1 { 1.0 } else { 0.0 }).collect();
        let uniform = match time_base::from_times(times_s, Samples::F32(samples), None) {
            Ok(uniform) => uniform,
            Err(TimeBaseError::TooFew { .. }) => return Self::default(),
            Err(error) => {
                let issue = Issue::new(IssueCode::Clock, Severity::Warning, error.to_string());
                return Self { issues: vec![issue], ..Self::default() };
            }
        };
        let is_gap = |issue: &&Issue| issue.code == IssueCode::Gap;
        let gaps = if uniform.issues.iter().any(|issue| is_gap(&issue)) { uniform.gaps.len() } else { 0 };
        let (first_s, last_s) =
            times_s.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)));
        Self {
            sample_rate_hz: Some(uniform.sample_rate_hz),
            start_s: Some(0.0),
            duration_s: Some(last_s - first_s),
            gaps: Some(gaps as u64),
            issues: uniform
                .issues
                .into_iter()
                .map(|mut issue| {
                    // The times alone were looked at: what interpolation does to the samples is not known here.
                    if let Some(at) = issue.message.find("; the samples were interpolated") {
                        issue.message.truncate(at);
                    }
                    issue.from_s = issue.from_s.map(|t| t - first_s);
                    issue.to_s = issue.to_s.map(|t| t - first_s);
                    issue
                })
                .collect(),
        }
    }
}

fn listed(column: &Column, range: &Range, clock: &Clock, rows: u64) -> ListedChannel {
    let is_empty = range.values == 0;
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
        range: (!is_empty).then_some((range.smallest, range.largest)),
        encoding: "text".into(),
        unreadable,
    }
}

fn facts(layout: &Layout, encoding: &str) -> BTreeMap<String, String> {
    let delimiter = match layout.delimiter {
        b';' => "semicolon",
        b'\t' => "tab",
        b',' => "comma",
        b'|' => "vertical bar",
        _ => "blanks",
    };
    let decimal = if layout.decimal == b',' { "comma" } else { "point" };
    let header = if layout.has_header {
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
    let stated =
        layout.stated_rate(usize::MAX).map(|stated| format!("; Delta_X states {} Hz", stated.rate_hz));
    format!("none found{}", stated.unwrap_or_default())
}
