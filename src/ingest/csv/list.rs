//! Delimited text to the list of its columns, each as reading would take it.

use super::super::{error::IngestError, lines::Text, listed::count_from_first, number, shown};
use super::columns::HeldColumn;
use super::complaint::no_table;
use super::layout::Layout;
use super::plan::ColumnPlan;
use super::table::{Table, picked};
use super::wanted::Wanted;
use crate::data::{
    ClockFinding, Finding, IssueCode, ListedChannel, Listing, RecordingFormat, RowsOf, is_number,
};
use crate::ingest::ReadRequest;
use crate::ingest::refusal::Refusal;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashSet};

/// Lists the columns of a text.
///
/// # Errors
/// A file that cannot be read or holds no rows of numbers.
pub(in super::super) fn list(request: ReadRequest) -> Result<Listing, IngestError> {
    let (path, text) = (request.file.path, Text::open(request.file, request.limits)?);
    let (bytes, encoding) = (text.bytes, text.encoding);
    let layout = Layout::of(&text).ok_or_else(|| no_table(path))?;
    let clocks = clocks(&layout);
    let plans = plans(&layout, &clocks);
    let wanted = Wanted::of(&plans, &layout, true);
    let mut table = Table::new(&layout, &plans, &wanted).for_listing();
    let mut issues = Vec::from_iter(table.read(text, request)?.map(Finding::from));
    let blank = table.drop_blank();
    let rows = table.rows();
    // Times are listed as they stand there, before they are turned into s.
    let several = clocks.iter().flatten().filter(|_| clocks.len() > 1);
    let names: BTreeMap<usize, String> = several.map(|&time| (time, layout.unique_name(time))).collect();
    let of_column = |plan: &ColumnPlan| column(&table, plan, &names);
    let mut channels: Vec<ListedChannel> = plans.par_iter().map(of_column).collect();
    let with_missing = blank.and_then(|()| place(&mut table, &mut channels, &mut issues));
    let with_missing = with_missing.unwrap_or_else(|refusal| {
        issues.push(ClockFinding::Refused(refusal.beside("")).into());
        0
    });
    issues.extend(layout.preamble.of_rows(rows, with_missing));
    let mut listing = Listing {
        counts: BTreeMap::from([
            ("rows".into(), rows as u64),
            ("columns".into(), layout.columns.len() as u64),
            ("preamble_lines".into(), layout.preamble_lines),
        ]),
        facts: facts(&layout, encoding, &clocks),
        channels,
        issues,
        ..Listing::new(path, bytes, RecordingFormat::Csv)
    };
    count_from_first(&mut listing);
    Ok(listing)
}

/// The columns of times, that of most columns first; one that is none where there are none.
fn clocks(layout: &Layout) -> Vec<Option<usize>> {
    let taken = layout.times.taken;
    let mut clocks = vec![taken];
    // Other columns of times are none's.
    for column in (0..layout.columns.len()).filter(|column| !layout.holds_times(*column)) {
        let clock = layout.time_of(column);
        if clock.is_some() == taken.is_some() && !clocks.contains(&clock) {
            clocks.push(clock);
        }
    }
    clocks
}

/// Plans each column but that of times, and each sensor in it, as reading would take it.
fn plans(layout: &Layout, clocks: &[Option<usize>]) -> Vec<ColumnPlan> {
    let taken = layout.times.taken;
    let of_column = |column: usize| {
        let own = layout.time_of(column);
        let time_column = if clocks.contains(&own) { own } else { taken };
        let plan = ColumnPlan::of_column(column, time_column, layout);
        let sensors = layout.sensors.first().filter(|it| it.column != column);
        match sensors.filter(|_| layout.columns[column].is_numeric) {
            None => vec![plan],
            Some(sensors) => {
                let rows = sensors.named(None).into_iter().map(|is| Some((sensors.column, is.to_owned())));
                rows.map(|rows| ColumnPlan { rows, ..plan.clone() }).collect()
            }
        }
    };
    (0..layout.columns.len()).filter(|column| Some(*column) != taken).flat_map(of_column).collect()
}

/// Lists a channel but for its clock; `clocks` are the names of the columns of times where there are several.
fn column(table: &Table, plan: &ColumnPlan, clocks: &BTreeMap<usize, String>) -> ListedChannel {
    let (layout, rows) = (table.layout, table.rows());
    let column = &layout.columns[plan.column];
    let values = table.values(plan.column);
    let own = match table.rows_of(plan, &values) {
        Ok(None) => values,
        Ok(Some(is_own)) => picked(&values, &is_own).into(),
        Err(_) => Vec::new().into(),
    };
    let range = ListedChannel::value_range(own.iter().copied());
    let words = &table.words[plan.column];
    let tells_sensors = layout.tells_sensors(plan.column);
    let unreadable = if tells_sensors {
        Some("tells the rows of several sensors apart".to_owned())
    } else if column.is_stamped {
        Some("date-time stamps or clock times".to_owned())
    } else if let Some(word) = &words.first {
        let count = if range.is_none() { "its".to_owned() } else { format!("{} of {rows}", words.count) };
        let reason = if number::is_grouped(word, None) {
            ": the thousands are marked too, and only a decimal mark is read"
        } else {
            ""
        };
        Some(format!("{count} cells are no numbers, such as {word:?}{reason}"))
    } else {
        range.is_none().then(|| "empty".to_owned())
    };
    let time = plan.time_column.and_then(|time| clocks.get(&time).cloned());
    let is_of = |(column, is): &(usize, String)| RowsOf {
        column: layout.columns[*column].header.clone(),
        is: is.clone(),
    };
    ListedChannel {
        rows: plan.rows.as_ref().map(is_of),
        samples: Some(own.len() as u64),
        unit: column.unit.clone(),
        range: range.filter(|_| !tells_sensors && !column.is_stamped),
        encoding: time.as_ref().map_or("text".into(), |time| format!("text, times in {time:?}")),
        time,
        unreadable,
        ..ListedChannel::new(&column.header, "column")
    }
}

/// Adds to the channels when their samples were taken, and to the findings what speaks against it; how many
/// samples a channel has at most, with those that are missing.
fn place(
    table: &mut Table,
    channels: &mut [ListedChannel],
    issues: &mut Vec<Finding>,
) -> Result<usize, Refusal> {
    issues.extend(table.settle().map_err(|refused| refused.refusal)?);
    let (mut with_missing, mut clocks, mut refused) = (0, HashSet::new(), HashSet::new());
    let lacks_value = |column: &HeldColumn| column.each.iter().any(|value| !is_number(*value));
    let lacks_values: Vec<bool> = table.columns.par_iter().map(lacks_value).collect();
    for ((plan, channel), uniform) in table.plans.iter().zip(channels).zip(table.uniforms()) {
        match uniform {
            _ if table.layout.tells_sensors(plan.column) => {}
            Ok(uniform) => {
                with_missing = with_missing.max(uniform.samples.len());
                uniform.list(channel);
                // The times are those of other columns too; cells without a value are not.
                if channel.unreadable.is_none() && clocks.insert(plan.time_column) {
                    let is_of_cells = lacks_values[plan.column];
                    let of_times = |issue: &Finding| issue.code != IssueCode::NonFinite || !is_of_cells;
                    issues.extend(uniform.issues.into_iter().filter(of_times));
                }
            }
            // Too few samples, or such without a clock, are no fault of a recording.
            Err(_) if channel.samples < Some(2) => {}
            Err(_) if plan.time_column.is_none() && plan.claims.is_empty() => {}
            Err(refusal) => {
                let problem = refusal.beside("");
                issues.extend(refused.insert(problem.clone()).then(|| ClockFinding::Refused(problem).into()));
            }
        }
    }
    Ok(with_missing)
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
