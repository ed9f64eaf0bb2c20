//! Channels with their times and witnesses to the columns that are read.

use super::layout::Layout;
use super::plan::ColumnPlan;

/// Which columns to read.
#[derive(Debug)]
pub(super) struct Wanted {
    /// Their indices, rising; a slot is a place in this list.
    pub columns: Vec<usize>,
    /// For each slot, whether it holds times.
    pub is_time: Vec<bool>,
    /// For each slot, whether it only bears times out: its words are no fault.
    pub is_witness: Vec<bool>,
    /// For each slot, whether it names the sensors of rows.
    pub is_sensor: Vec<bool>,
    /// The column that counts the rows, where it is none of values or times.
    pub counter: Option<usize>,
    /// For each slot, that of the times of its values.
    clocks: Vec<Option<usize>>,
}

impl Wanted {
    /// What channels take, the columns that bear their times out, and the one that counts the rows.
    pub(super) fn of(plans: &[ColumnPlan], layout: &Layout) -> Self {
        let values: Vec<_> = plans.iter().map(|plan| (plan.column, plan.time_column)).collect();
        let times: Vec<usize> = plans.iter().filter_map(|plan| plan.time_column).collect();
        let is_own = |column: &usize| values.iter().any(|(own, _)| own == column) || times.contains(column);
        let counter = layout.counter.filter(|column| !is_own(column));
        let of_times = times.iter().flat_map(|&time| layout.witnesses(time)).map(|(column, _)| column);
        let rest = times.iter().filter_map(|&time| layout.nanoseconds(time));
        let sensors: Vec<usize> = plans.iter().filter_map(|plan| Some(plan.rows.as_ref()?.0)).collect();
        let beside = of_times.chain(rest).chain(counter).chain(sensors.iter().copied());
        let mut wanted = Self::new(&values, &beside.collect::<Vec<_>>());
        wanted.counter = counter;
        wanted.is_sensor = wanted.columns.iter().map(|column| sensors.contains(column)).collect();
        wanted
    }

    /// All columns, for a listing, with those of times. A row may lack a time that is not of the first of
    /// these: a pair of columns may end before others.
    pub(super) fn all(clocks: &[Option<usize>], layout: &Layout) -> Self {
        let (taken, times) = (layout.times.taken, || clocks.iter().flatten().copied());
        let columns: Vec<usize> = (0..layout.columns.len()).collect();
        let mark = |marked: &mut dyn Iterator<Item = usize>| {
            let mut is_marked = vec![false; columns.len()];
            marked.for_each(|column| is_marked[column] = true);
            is_marked
        };
        let is_time = mark(&mut times());
        let witnesses = times().flat_map(|time| layout.witnesses(time)).map(|(column, _)| column);
        let mut witnesses = witnesses.chain(layout.times.nanoseconds).filter(|column| !is_time[*column]);
        let is_timed = |column: usize| layout.time_of(column) == taken && !layout.holds_times(column);
        Self {
            is_witness: mark(&mut witnesses),
            is_sensor: mark(&mut layout.sensors.iter().take(1).map(|sensors| sensors.column)),
            counter: layout.counter.filter(|column| !is_time[*column]),
            clocks: columns.iter().map(|column| taken.filter(|_| is_timed(*column))).collect(),
            is_time,
            columns,
        }
    }

    /// The columns of values, each with that of its times, and those that bear times out.
    pub(super) fn new(values: &[(usize, Option<usize>)], witnesses: &[usize]) -> Self {
        let times: Vec<usize> = values.iter().filter_map(|(_, time)| *time).collect();
        let own = values.iter().map(|(column, _)| *column);
        let mut columns: Vec<usize> = own.chain(times.iter().chain(witnesses).copied()).collect();
        columns.sort_unstable();
        columns.dedup();
        let is_time: Vec<bool> = columns.iter().map(|column| times.contains(column)).collect();
        let is_value = |column: &usize| values.iter().any(|(own, _)| own == column);
        let is_witness = columns.iter().map(|c| !times.contains(c) && !is_value(c)).collect();
        let clock = |column: &usize| values.iter().find(|(own, _)| own == column).and_then(|(_, time)| *time);
        let clocks = columns.iter().map(|column| columns.binary_search(&clock(column)?).ok()).collect();
        let is_sensor = vec![false; columns.len()];
        Self { columns, is_time, is_witness, is_sensor, clocks, counter: None }
    }

    /// The slot of a wanted column.
    pub(super) fn slot(&self, column: usize) -> usize {
        self.columns.binary_search(&column).unwrap_or(0)
    }

    /// Whether a row holds a value for which these times hold none; a pair of columns may end before others.
    pub(super) fn lacks_time(&self, time_slot: usize, values: &[f64]) -> bool {
        let mut timed = self.clocks.iter().zip(values).filter(|(clock, _)| **clock == Some(time_slot));
        values[time_slot].is_nan() && timed.any(|(_, value)| !value.is_nan())
    }
}
