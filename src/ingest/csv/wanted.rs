//! Channels with their times and witnesses to the columns that are read.

use super::layout::Layout;
use super::plan::ColumnPlan;
use std::collections::BTreeSet;

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
    /// What channels take, the columns that bear their times out, and the one that counts the rows; of a
    /// listing, whose channels are all columns, these may be channels too.
    ///
    /// A row of a listing may lack a time that is not that of most columns: a pair of columns may end before
    /// others.
    pub(super) fn of(plans: &[ColumnPlan], layout: &Layout, is_listed: bool) -> Self {
        let set = |all: &mut dyn Iterator<Item = usize>| all.collect::<BTreeSet<usize>>();
        let values = set(&mut plans.iter().map(|plan| plan.column));
        let first = layout.times.taken.filter(|_| is_listed);
        let times = set(&mut plans.iter().filter_map(|plan| plan.time_column).chain(first));
        let sensors = set(&mut plans.iter().filter_map(|plan| Some(plan.rows.as_ref()?.0)));
        let is_beside = |column: &usize| !times.contains(column) && (is_listed || !values.contains(column));
        let counter = layout.counter.filter(is_beside);
        let witnesses = times.iter().flat_map(|&time| layout.witnesses(time)).map(|(column, _)| column);
        let rest = times.iter().filter_map(|&time| layout.nanoseconds(time));
        let witnesses = set(&mut witnesses.chain(rest).filter(is_beside));
        let mut all = [&values, &times, &witnesses, &sensors].into_iter().flatten().copied().chain(counter);
        let columns = Vec::from_iter(set(&mut all));
        let mark = |marked: &BTreeSet<usize>| columns.iter().map(|column| marked.contains(column)).collect();
        let is_timed = |column: usize, time: usize| {
            !is_listed || layout.times.taken == Some(time) && !layout.holds_times(column)
        };
        let clock = |column: &usize| {
            let plan = plans.iter().find(|plan| plan.column == *column)?;
            columns.binary_search(&plan.time_column.filter(|time| is_timed(*column, *time))?).ok()
        };
        let clocks = columns.iter().map(clock).collect();
        let (is_time, is_witness, is_sensor) = (mark(&times), mark(&witnesses), mark(&sensors));
        Self { columns, is_time, is_witness, is_sensor, counter, clocks }
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
