//! Delimited text to the channels that a cask file names, whatever its delimiter, decimal mark, encoding and preamble.

mod column;
mod complaint;
mod header;
mod input;
mod layout;
mod list;
mod pieces;
mod plan;
mod preamble;
mod rows;
mod stamp;
mod time_column;
mod wanted;
mod witness;

pub(super) use list::list;

use super::error::IngestError;
use super::time_base::{self, TimeBaseError, Times, Uniform};
use super::time_reading::{Carrier, Reading};
use super::{Limits, Progress, RawChannel, RawRecording};
use crate::data::{CaskFile, Issue, Samples};
use column::{Column, Even, Keep};
use input::Input;
use layout::Layout;
use plan::Plan;
use rayon::prelude::*;
use rows::{Ending, Wanted};
use stamp::Stamps;
use std::path::Path;

/// The channels of `cask_file` from the text at `path`.
///
/// # Errors
/// A column that is not there or holds words, rows that are no table, times that are none.
pub(super) fn read(
    path: &Path,
    cask_file: &CaskFile,
    limits: Limits,
    progress: Progress,
) -> Result<RawRecording, IngestError> {
    of_input(path, Input::open(path, limits)?, cask_file, (limits, progress))
}

/// The same of a text that is opened already.
fn of_input(
    path: &Path,
    input: Input,
    cask_file: &CaskFile,
    (limits, progress): (Limits, Progress),
) -> Result<RawRecording, IngestError> {
    let layout = Layout::of(&input).ok_or_else(|| complaint::no_table(path))?;
    let plans: Vec<Plan> = cask_file
        .channels
        .iter()
        .map(|spec| Plan::of(path, spec, cask_file.time.as_deref(), &layout))
        .collect::<Result<_, _>>()?;
    let mut clocks: Vec<usize> = plans.iter().filter_map(|plan| plan.time_column).collect();
    clocks.sort_unstable();
    clocks.dedup();
    let values: Vec<_> = plans.iter().map(|plan| (plan.column, plan.time_column)).collect();
    let is_value = |column: &usize| values.iter().any(|(own, _)| own == column);
    let counter = layout.counter().filter(|column| !clocks.contains(column) && !is_value(column));
    let of_clock = clocks.iter().flat_map(|&time| layout.witnesses(time)).map(|(column, _)| column);
    let witnesses: Vec<usize> = of_clock.chain(counter).collect();
    let wanted = Wanted::new(&values, &witnesses);
    let (mut held, stamps, ending) = columns(path, input, &layout, &wanted, (limits, progress))?;
    let mut issues = complaint::ending_issues(&ending);
    for (slot, times) in held.iter_mut().enumerate() {
        if wanted.is_time[slot] && !stamps.are_in(slot) {
            issues.extend(to_seconds(path, times, wanted.columns[slot], &layout, &plans)?);
        }
    }
    let first_clock =
        clocks.first().map(|&time| (layout.columns[time].header.as_str(), &held[wanted.slot(time)]));
    for &time in &clocks {
        let name = |spec: usize| cask_file.channels[spec].name.as_str();
        issues.extend(witness::of_columns(path, (time, &held), (&layout, &wanted), (&plans, &name))?);
    }
    let of_counter = |column: usize| {
        let counts = held[wanted.slot(column)].each();
        witness::of_counter(&layout.columns[column].header, counts, first_clock)
    };
    issues.extend(counter.and_then(of_counter));
    drop_untimed(&mut held, &wanted, &plans);
    let mut uses = vec![0_usize; wanted.columns.len()];
    for plan in &plans {
        uses[wanted.slot(plan.column)] += 1;
        plan.time_column.into_iter().for_each(|column| uses[wanted.slot(column)] += 1);
    }
    let samples: Vec<Vec<f64>> = plans
        .iter()
        .map(|plan| {
            let at = wanted.slot(plan.column);
            uses[at] -= 1;
            // The last channel to use a column takes it instead of copying it.
            let values = held[at].each_mut();
            if uses[at] == 0 { std::mem::take(values) } else { values.clone() }
        })
        .collect();
    let rows = samples.iter().map(Vec::len).max().unwrap_or_default();
    // Columns of times are fitted once, however many channels use them.
    let times: Vec<Option<Base>> =
        held.iter().zip(&wanted.is_time).map(|(column, is_time)| is_time.then(|| Base::of(column))).collect();
    let uniform: Vec<Result<Uniform, TimeBaseError>> = samples
        .into_par_iter()
        .zip(&plans)
        .map(|(samples, plan)| {
            on_base(samples, plan.time_column.and_then(|column| times[wanted.slot(column)].as_ref()), plan)
        })
        .collect();
    let mut channels = Vec::with_capacity(plans.len());
    for (spec, (uniform, plan)) in uniform.into_iter().zip(&plans).enumerate() {
        let name = &cask_file.channels[spec].name;
        let mut uniform = uniform.map_err(|error| complaint::time_error(path, name, &error))?;
        let times_s = plan.time_column.map(|column| &held[wanted.slot(column)]);
        uniform.issues.extend(witness::of_header(path, name, plan, (uniform.sample_rate_hz, times_s))?);
        channels.push(RawChannel { spec, uniform, unit: layout.columns[plan.column].unit.clone() });
    }
    let filled = channels.iter().map(|channel| channel.uniform.samples.len()).max().unwrap_or_default();
    issues.extend(layout.preamble.of_rows((rows, filled), layout.columns.len()));
    let rate_issue = |(channel, plan): (&RawChannel, &Plan)| {
        let rounding = plan.time_column.map(|column| held[wanted.slot(column)].rounding());
        layout.preamble.of_rate(channel.uniform.sample_rate_hz, rounding)
    };
    // Where channels have several rates the one stated is that of some.
    let all: Option<Vec<Issue>> = channels.iter().zip(&plans).map(rate_issue).collect();
    issues.extend(all.into_iter().flatten().next());
    Ok(RawRecording { channels, zero_unix_ns: stamps.zero_unix_ns(), issues })
}

/// The wanted columns, stamps among them in s; the stamps; and how the file ended.
fn columns(
    path: &Path,
    input: Input,
    layout: &Layout,
    wanted: &Wanted,
    (limits, progress): (Limits, Progress),
) -> Result<(Vec<Column>, Stamps, Ending), IngestError> {
    // What is set aside is a guess from the first rows; more is taken as it comes.
    let most_rows = limits.samples_bytes() / (8 * wanted.columns.len().max(1) as u64);
    let rows_expected =
        layout.rows_expected(input.bytes).min(usize::try_from(most_rows).unwrap_or(usize::MAX));
    let columns = wanted.columns.iter().map(|_| Column::with_capacity(rows_expected)).collect();
    let mut keep = Keep::new(wanted, columns);
    let ending = rows::read(input, layout, wanted, &mut keep, (limits, progress))
        .map_err(|error| complaint::row_error(path, limits, (layout, wanted), error))?;
    let Keep { mut columns, stamps, .. } = keep;
    if !wanted.is_time.contains(&true) {
        // Blank lines behind the table are no samples.
        let is_row = |row: &usize| columns.iter().any(|column| !column.each()[*row].is_nan());
        let rows = (0..columns.first().map_or(0, Column::len)).rev().find(is_row).map_or(0, |last| last + 1);
        for column in &mut columns {
            column.each_mut().truncate(rows);
        }
    }
    Ok((columns, stamps, ending))
}

/// Leaves the rows without a time, in which a pair of columns has ended before others, out of the times and of what they time.
fn drop_untimed(held: &mut [Column], wanted: &Wanted, plans: &[Plan]) {
    let mut is_kept: Vec<Option<Vec<bool>>> = vec![None; held.len()];
    for slot in (0..held.len()).filter(|&slot| wanted.is_time[slot]) {
        let times = held[slot].each();
        if times.iter().any(|time| time.is_nan()) {
            is_kept[slot] = Some(times.iter().map(|time| !time.is_nan()).collect());
        }
    }
    let retain = |column: &mut Column, is_kept: &[bool]| {
        let mut rows = is_kept.iter();
        column.each_mut().retain(|_| rows.next().copied().unwrap_or(true));
    };
    for plan in plans {
        let clock = plan.time_column.and_then(|time| is_kept[wanted.slot(time)].as_ref());
        if let Some(is_kept) = clock
            && !wanted.is_time[wanted.slot(plan.column)]
        {
            retain(&mut held[wanted.slot(plan.column)], is_kept);
        }
    }
    for (column, is_kept) in held.iter_mut().zip(&is_kept) {
        if let Some(is_kept) = is_kept {
            retain(column, is_kept);
        }
    }
}

/// The numbers in a column of times to s; a warning where nothing says that they are.
fn to_seconds(
    path: &Path,
    times: &mut Column,
    column: usize,
    layout: &Layout,
    plans: &[Plan],
) -> Result<Option<Issue>, IngestError> {
    let mut users = plans.iter().filter(|plan| plan.time_column == Some(column));
    let declared_rate_hz = users.find_map(|plan| plan.declared_rate_hz);
    let reading = Reading::by(layout.time_scale(column), || times.clock(), declared_rate_hz);
    let header = &layout.columns[column].header;
    if let Some(doubt) = reading.doubt.as_ref().filter(|doubt| doubt.is_grave()) {
        return Err(IngestError::Content {
            path: path.display().to_string(),
            place: format!("line {}", layout.data_line),
            problem: doubt.problem(header, Carrier::Column),
            mend: doubt.mend(Carrier::Column),
        });
    }
    times.scale(reading.scale_s);
    Ok(reading.issue(header, Carrier::Column))
}

/// The times of channels, as they are held.
enum Base<'a> {
    Even(Even),
    Each(Times<'a>),
}

impl<'a> Base<'a> {
    fn of(column: &'a Column) -> Self {
        column.even().map_or_else(|| Self::Each(Times::new(column.each())), Self::Even)
    }
}

fn on_base(samples: Vec<f64>, base: Option<&Base>, plan: &Plan) -> Result<Uniform, TimeBaseError> {
    match (base, plan.declared_rate_hz) {
        (Some(Base::Even(times)), declared_rate_hz) => times.place(Samples::F64(samples), declared_rate_hz),
        (Some(Base::Each(times)), declared_rate_hz) => times.place(Samples::F64(samples), declared_rate_hz),
        (None, Some(rate_hz)) => time_base::from_rate(0.0, rate_hz, Samples::F64(samples)),
        (None, None) => Err(TimeBaseError::Rate { sample_rate_hz: 0.0 }),
    }
}

#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod pair_tests;
#[cfg(test)]
mod piece_tests;
#[cfg(test)]
pub(super) mod tests;
#[cfg(test)]
mod time_tests;
