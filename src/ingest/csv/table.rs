//! The columns of a table to the samples of its channels on their time base.

use super::columns::HeldColumn;
use super::complaint;
use super::even::Even;
use super::layout::Layout;
use super::pieces::Sizes;
use super::plan::{self, ColumnPlan};
use super::preamble;
use super::rows::{self, RowsPart, Sink};
use super::sensors;
use super::stamp::Stamps;
use super::time_column;
use super::wanted::Wanted;
use crate::data::{Finding, Samples, TableFinding};
use crate::ingest::ReadRequest;
use crate::ingest::clock::Clock;
use crate::ingest::counting::{self, Counter, RowCounter};
use crate::ingest::error::IngestError;
use crate::ingest::lines::{self, Text};
use crate::ingest::refusal::Refusal;
use crate::ingest::time_base::{self, ChannelTimes, Uniform};
use crate::ingest::times::{self, Carrier, Scale};
use crate::numerics::robust;
use rayon::prelude::*;
use std::borrow::Cow;

/// The wanted columns of a table, kept whole, with what is said of them.
#[derive(Debug)]
pub(super) struct Table<'a> {
    pub layout: &'a Layout,
    pub plans: &'a [ColumnPlan],
    pub wanted: &'a Wanted,
    pub columns: Vec<HeldColumn>,
    pub stamps: Stamps,
    /// What remarks among the rows say that may be a factor of the samples.
    pub factors: Vec<String>,
    /// The words of each column for a listing; where there are none a word is a fault.
    pub words: Vec<CellWords>,
    /// Of columns that bear out others.
    other_stamps: Stamps,
}

/// Cells of a column that are no numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct CellWords {
    pub count: u64,
    /// The first of them, or its beginning.
    pub first: Option<String>,
}

/// Why the times of a channel are refused.
pub(super) struct Refused {
    /// The place of its plan.
    pub plan: usize,
    pub refusal: Refusal,
}

/// The times of channels, as they are held.
enum Base<'a> {
    Even(Even),
    Each(ChannelTimes<'a>),
}

impl Sink for Table<'_> {
    fn word(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        let number = self.number_of(slot, cell);
        let Some(words) = self.words.get_mut(slot).filter(|_| !self.wanted.is_time[slot]) else {
            return number;
        };
        let number = number.unwrap_or(f64::NAN);
        if number.is_nan() {
            words.count += 1;
            words.first.get_or_insert_with(|| rows::shown(cell));
        }
        Some(number)
    }

    fn append(&mut self, parts: &mut [RowsPart]) {
        // A table of one piece is held as it is.
        let may_keep_rule = parts.len() > 1;
        // Most of the time the system hands out the memory, a page after the other.
        self.columns.par_iter_mut().zip(&self.wanted.is_time).enumerate().for_each(
            |(slot, (column, is_time))| {
                for part in &*parts {
                    column.extend(&part.0[slot], *is_time && may_keep_rule);
                }
            },
        );
        parts.iter_mut().for_each(RowsPart::clear);
    }

    fn remark(&mut self, line: &str) {
        self.factors.extend(preamble::factor_in(line, self.layout.dialect.delimiter));
    }

    fn held_bytes(&self) -> u64 {
        self.columns.iter().map(|column| 8 * column.each.len() as u64).sum()
    }
}

impl<'a> Table<'a> {
    /// Before the first row.
    pub(super) fn new(layout: &'a Layout, plans: &'a [ColumnPlan], wanted: &'a Wanted) -> Self {
        let columns = vec![HeldColumn::default(); wanted.columns.len()];
        let (stamps, other_stamps) = (Stamps::default(), Stamps::default());
        Self { layout, plans, wanted, columns, stamps, factors: Vec::new(), words: Vec::new(), other_stamps }
    }

    /// With words that are no fault.
    pub(super) fn for_listing(self) -> Self {
        Self { words: vec![CellWords::default(); self.columns.len()], ..self }
    }

    /// Takes the rows of `text`; how they ended, where they broke off.
    pub(super) fn read(
        &mut self,
        text: Text,
        request: ReadRequest,
    ) -> Result<Option<TableFinding>, IngestError> {
        let Self { layout, wanted, columns, .. } = self;
        // What is set aside is a guess from the first rows; more is taken as it comes.
        let most_rows = request.limits.samples_bytes() / (8 * columns.len().max(1) as u64);
        let rows = layout.rows_expected(text.bytes).min(usize::try_from(most_rows).unwrap_or(usize::MAX));
        for column in columns.iter_mut() {
            column.each.reserve(rows);
        }
        let (layout, wanted, sizes) = (*layout, *wanted, Sizes::of(request.limits, text.bytes));
        rows::read(text, (layout, wanted), self, sizes, request.progress)
            .map_err(|error| complaint::row_error(request, (layout, wanted), error))
    }

    /// The value of a cell that is no number, where it stands for one.
    fn number_of(&mut self, slot: usize, cell: &[u8]) -> Option<f64> {
        if self.wanted.is_sensor[slot] {
            return Some(sensors::value(cell, b'.'));
        }
        if self.wanted.counter == Some(self.wanted.columns[slot]) {
            return Some(counting::of_words(&lines::text(cell)).unwrap_or(f64::NAN));
        }
        if self.wanted.is_witness[slot] {
            return Some(self.other_stamps.seconds(slot, cell).unwrap_or(f64::NAN));
        }
        if self.wanted.is_time[slot] { self.stamps.seconds(slot, cell) } else { None }
    }

    /// The values of a column that is held.
    pub(super) fn values(&self, column: usize) -> Cow<'_, [f64]> {
        self.columns[self.wanted.slot(column)].values()
    }

    /// Turns the times into s, and holds them against other columns of times and the one that counts the
    /// rows; warnings where those do not bear them out.
    ///
    /// # Errors
    /// The times are none, or what stands beside them contradicts them.
    pub(super) fn settle(&mut self) -> Result<Vec<Finding>, Refused> {
        let mut issues = self.settle_times()?;
        issues.extend(self.place_by_counter()?);
        Ok(issues)
    }

    fn settle_times(&mut self) -> Result<Vec<Finding>, Refused> {
        let mut issues = Vec::new();
        let mut clocks: Vec<usize> = self.plans.iter().filter_map(|plan| plan.time_column).collect();
        clocks.sort_unstable();
        clocks.dedup();
        for &time in &clocks {
            self.scale_times(time)?;
        }
        let named = self.plans.iter().filter(|plan| plan.claims.are_times_named);
        let named: Vec<usize> = named.filter_map(|plan| plan.time_column).collect();
        for &time in &clocks {
            let others = self.layout.witnesses(time).into_iter();
            // Where the cask file gives each of two its channels, both are right.
            let others = others.filter(|(other, _)| !(named.contains(&time) && named.contains(other)));
            for (other, is_apart) in others {
                issues.extend(self.borne_out(time, other, is_apart)?);
            }
        }
        Ok(issues)
    }

    /// The numbers of the times in column `time` to s.
    fn scale_times(&mut self, time: usize) -> Result<(), Refused> {
        let is_user = |plan: &ColumnPlan| plan.time_column == Some(time);
        let plan = self.plans.iter().position(is_user).unwrap_or_default();
        let refused = |refusal| Refused { plan, refusal };
        let rest = self
            .layout
            .nanoseconds(time)
            .map(|rest| self.columns[self.wanted.slot(rest)].values().into_owned());
        let column = &mut self.columns[self.wanted.slot(time)];
        if let Some(nanoseconds) = rest {
            let seconds = column.each_mut();
            // Seconds since 1970 leave no room for a nanosecond.
            let zero_s = 1e5 * (seconds.first().unwrap_or(&0.0) / 1e5).floor();
            seconds.iter_mut().zip(nanoseconds).for_each(|(s, ns)| *s = *s - zero_s + 1e-9 * ns);
        }
        let header = self.layout.columns[time].header.as_str();
        if let Some((row, [problem, mend])) = odd_fall(&column.each) {
            let line = self.layout.data_line + row as u64;
            let problem = format!("the times in column {header:?} fall back at line {line}: {problem}");
            return Err(refused(Refusal::new(problem, mend)));
        }
        if !self.stamps.are_in(self.wanted.slot(time)) {
            let mut users = self.plans.iter().filter(|plan| is_user(plan));
            let stated_hz = users.find_map(|plan| plan.claims.cask_hz);
            let scale = time_column::scale(&self.layout.columns[time]);
            // A clock or a counter of few bits begins anew at a number that shows it.
            let each = column.each.as_slice();
            let falls = each.windows(2).any(|pair| pair[1] < pair[0]);
            let counter = if falls { Counter::of(each) } else { None };
            if let Some(each) = counter.and_then(|counter| counter.unwrapped(each)) {
                column.each = each;
            }
            let unit_s =
                times::seconds_a_unit(scale, Carrier::Column(header), || column.counted(), stated_hz);
            column.scale(unit_s.map_err(refused)?);
        }
        // Each of several sensors may have a clock of its own.
        if column.each.len() > LEAST_FALLING && column.each.windows(2).all(|pair| pair[1] < pair[0]) {
            let problem =
                format!("the times in column {header:?} fall from row to row: the last one stands first");
            return Err(refused(Refusal::new(problem, "sort the rows of a copy by their times")));
        }
        let fall = begins_anew(&column.each).filter(|_| self.plans.iter().all(|plan| plan.rows.is_none()));
        fall.map_or(Ok(()), |row| {
            let problem = format!(
                "the times in column {header:?} fall back to where they began at line {}, as below rows of \
                 extremes (minimum, maximum) or at the beginning of another record",
                self.layout.data_line + row as u64
            );
            Err(refused(Refusal::new(problem, "delete the rows above that line in a copy")))
        })
    }

    /// What the times in column `other` say of those in column `time`; columns that they may be the clock of
    /// stand between where they are `apart`.
    fn borne_out(&self, time: usize, other: usize, is_apart: bool) -> Result<Option<Finding>, Refused> {
        let [own_s, others] = [time, other].map(|column| self.columns[self.wanted.slot(column)].values());
        let slot = self.wanted.slot(other);
        let is_in_s = self.wanted.is_time[slot] || self.layout.columns[other].is_stamped;
        let scale = if is_in_s { Scale::Known(1.0) } else { time_column::scale(&self.layout.columns[other]) };
        let both = || own_s.iter().zip(&*others).filter(|(own, other)| own.is_finite() && other.is_finite());
        let Some((first, last)) = both().next().zip(both().next_back()) else { return Ok(None) };
        let Some(unit_s) = scale.beside(last.0 - first.0, &others) else { return Ok(None) };
        let others_s: Vec<f64> = others.iter().map(|other| other * unit_s).collect();
        let names = [time, other].map(|column| format!("{:?}", self.layout.columns[column].header));
        let is_open = |plan: &ColumnPlan| plan.time_column == Some(time) && !plan.is_decided();
        let open = self.plans.iter().position(is_open);
        let own = Clock { name: &names[0], times_s: &own_s };
        let other = Clock { name: &names[1], times_s: &others_s };
        let said = own.borne_out_by(&other, is_apart, open.is_none());
        said.map_err(|refusal| Refused { plan: open.unwrap_or_default(), refusal })
    }

    /// Rows that a column which counts them shows to be missing: without times they are put in, empty; beside
    /// times that go on over them the two contradict each other.
    ///
    /// # Errors
    /// They do, and the cask file does not name the times.
    fn place_by_counter(&mut self) -> Result<Option<Finding>, Refused> {
        let values = |column: usize| self.columns[self.wanted.slot(column)].values();
        let header = |column: usize| self.layout.columns[column].header.as_str();
        let counter = self.wanted.counter.filter(|_| self.plans.iter().all(|plan| plan.rows.is_none()));
        let counter = counter.and_then(|column| RowCounter::of(header(column), &values(column)));
        let Some(counter) = counter.filter(RowCounter::shows_loss) else { return Ok(None) };
        let timed = self.plans.iter().enumerate().find_map(|(plan, of)| Some((plan, of.time_column?)));
        if let Some((plan, time)) = timed {
            let said = counter.beside(&values(time), header(time), self.plans[plan].claims.are_times_named);
            return said.map_err(|refusal| Refused { plan, refusal });
        }
        self.columns.iter_mut().for_each(|column| column.put_in(&counter.jumps));
        Ok(Some(counter.finding()))
    }

    /// How many rows it has.
    pub(super) fn rows(&self) -> usize {
        self.columns.first().map_or(0, HeldColumn::len)
    }

    /// Where no times tell what is missing, leaves out blank lines behind the table.
    ///
    /// # Errors
    /// Over a third of the lines before are blank too, as doubled line breaks leave them.
    pub(super) fn drop_blank(&mut self) -> Result<(), Refusal> {
        if self.wanted.is_time.contains(&true) {
            return Ok(());
        }
        let is_row = |row: &usize| self.columns.iter().any(|column| !column.each[*row].is_nan());
        let rows = (0..self.rows()).rev().find(is_row).map_or(0, |last| last + 1);
        let blank = rows - (0..rows).filter(is_row).count();
        self.columns.iter_mut().for_each(|column| column.each_mut().truncate(rows));
        if blank > rows / 3 {
            return Err(Refusal::new(
                format!(
                    "of its {rows} lines {blank} are empty, and no times tell whether samples are missing \
                     there"
                ),
                "delete the empty lines in a copy, or name a column of times",
            ));
        }
        Ok(())
    }

    /// Which rows are samples of a channel with such `values` where not all are: those with a time, as in
    /// `Time;A1;Time;A2` one pair may end before the other, of its own sensor, and with a value where each
    /// topic has rows of its own.
    ///
    /// # Errors
    /// No row is of the sensor that the cask file names.
    pub(super) fn rows_of(&self, plan: &ColumnPlan, values: &[f64]) -> Result<Option<Vec<bool>>, Refusal> {
        let has_none = |values: &[f64]| values.iter().filter(|value| value.is_nan()).count() > 0;
        let each = |time: usize| &self.columns[self.wanted.slot(time)].each;
        let lacks_times = plan.time_column.is_some_and(|time| has_none(each(time)));
        let lacks_values = has_none(values) && plan.time_column != Some(plan.column);
        if plan.rows.is_none() && !lacks_times && !lacks_values {
            return Ok(None);
        }
        let times = plan.time_column.map(|time| self.values(time));
        let mut is_own: Vec<bool> = match &times {
            Some(times) => times.iter().map(|time| !time.is_nan()).collect(),
            None => vec![true; values.len()],
        };
        if let Some((column, is)) = &plan.rows {
            let own = sensors::value(is.trim().as_bytes(), self.layout.dialect.decimal);
            let ids = self.values(*column);
            is_own.iter_mut().zip(&*ids).for_each(|(is_own, id)| *is_own &= id.total_cmp(&own).is_eq());
            if !is_own.contains(&true) {
                return Err(plan::no_such_sensor(self.layout, *column, is));
            }
        }
        if lacks_values && times.is_some() && is_sparse(values, &is_own) {
            is_own.iter_mut().zip(values).for_each(|(is_own, value)| *is_own &= !value.is_nan());
        }
        if times.is_none() && plan.ends_alone {
            let end = values.iter().rposition(|value| !value.is_nan()).map_or(0, |last| last + 1);
            is_own[end..].fill(false);
        }
        Ok(Some(is_own))
    }

    /// The samples of each channel on their base, for which they are taken out of the table.
    ///
    /// # Errors
    /// None of the rows is a channel's own, or their times make no record.
    pub(super) fn uniforms(&mut self) -> Vec<Result<Uniform, Refusal>> {
        let mut users = vec![0; self.columns.len()];
        for plan in self.plans {
            let beside = plan.time_column.into_iter().chain(plan.rows.as_ref().map(|rows| rows.0));
            beside.chain([plan.column]).for_each(|column| users[self.wanted.slot(column)] += 1);
        }
        let mut take = |plan: &ColumnPlan| {
            let slot = self.wanted.slot(plan.column);
            (users[slot] == 1).then(|| std::mem::take(self.columns[slot].each_mut()))
        };
        let samples: Vec<Option<Vec<f64>>> = self.plans.iter().map(&mut take).collect();
        let Self { plans, wanted, columns, .. } = &*self;
        // Columns of times are fitted once, however many channels use them.
        let times = columns.iter().zip(&wanted.is_time);
        let bases: Vec<Option<Base>> = times.map(|(column, is_time)| is_time.then(|| base(column))).collect();
        let base_of = |plan: &ColumnPlan| bases[wanted.slot(plan.time_column?)].as_ref();
        let uniform = |(samples, plan): (Option<Vec<f64>>, &ColumnPlan)| {
            let samples = samples.map_or_else(|| self.values(plan.column), Cow::Owned);
            let Some(is_own) = self.rows_of(plan, &samples)? else {
                return on_base(samples.into_owned(), base_of(plan), plan);
            };
            let times = plan.time_column.map(|time| picked(&self.values(time), &is_own));
            let base = times.as_deref().map(|times| Base::Each(ChannelTimes::new(times)));
            on_base(picked(&samples, &is_own), base.as_ref(), plan)
        };
        samples.into_par_iter().zip(*plans).map(uniform).collect()
    }
}

fn base(column: &HeldColumn) -> Base<'_> {
    column.even.map_or_else(|| Base::Each(ChannelTimes::new(&column.each)), Base::Even)
}

fn on_base(samples: Vec<f64>, base: Option<&Base>, plan: &ColumnPlan) -> Result<Uniform, Refusal> {
    let samples = Samples::F64(samples);
    match base {
        Some(Base::Even(times)) => times.place(samples, &plan.claims),
        Some(Base::Each(times)) => times.place(samples, &plan.claims),
        None => time_base::from_claims(plan.start_s, &plan.claims, samples),
    }
}

/// The values of these rows.
pub(super) fn picked(values: &[f64], is_own: &[bool]) -> Vec<f64> {
    values.iter().zip(is_own).filter(|(_, is_own)| **is_own).map(|(value, _)| *value).collect()
}

/// Whether rows without a value are those of other topics, and no samples that are missing.
fn is_sparse(values: &[f64], is_own: &[bool]) -> bool {
    let mut filled = sensors::Filled::default();
    let values = picked(values, is_own);
    // A channel that begins late or ends early has no row of another's.
    let present = values.iter().enumerate().filter(|(_, value)| !value.is_nan());
    present.for_each(|(row, _)| filled.take(row));
    filled.lie_between()
}

/// Times that fall in fewer rows than this tell no order.
const LEAST_FALLING: usize = 4;

/// Where numbers fall back that were written wrongly, why, and what to do: those of a fraction without its
/// leading zeros, of which the steps become ten times as short, and those of two units.
fn odd_fall(times: &[f64]) -> Option<(usize, [&'static str; 2])> {
    if times.windows(2).all(|pair| pair[1] >= pair[0]) {
        return None;
    }
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let falls: Vec<usize> = (1..times.len().saturating_sub(1)).filter(|&at| steps[at - 1] < 0.0).collect();
    let &first = falls.first()?;
    let is_ratio = |one: f64, other: f64, ratio: f64| (one / other / ratio - 1.0).abs() < 0.01;
    let is_unpadded = |&at: &usize| {
        let (before, after) = (times[at - 1], times[at]);
        at > 1
            && before.trunc().total_cmp(&after.trunc()).is_eq()
            && before.fract() > 0.89
            && (0.1..0.2).contains(&after.fract())
            && is_ratio(steps[at - 2], steps[at], 10.0)
    };
    if falls.iter().all(is_unpadded) {
        let why = "the fraction of a second stands without its leading zeros, as `%d.%d` prints it";
        return Some((first, [why, "write it with all its digits in a copy: 0.000100 for 100 µs"]));
    }
    let mut finite: Vec<f64> = steps.iter().copied().filter(|step| step.is_finite()).collect();
    let usual = robust::median(&mut finite);
    let of_unit = |unit: f64| steps.iter().filter(|step| is_ratio(**step, usual, unit)).count();
    let counts = [1.0, 1e-3, 1e3, 1e-6, 1e6].map(of_unit);
    let others: usize = counts[1..].iter().sum();
    let is_of_two = others >= LEAST_FALLING && 50 * (steps.len() - others - counts[0]) < steps.len();
    let why = "their steps become a thousand times as long or short there, as where the unit changes";
    is_of_two.then_some((first, [why, "write all of them in one unit in a copy"]))
}

/// Where times, within the first four rows, fall back to the first of them.
fn begins_anew(times: &[f64]) -> Option<usize> {
    (1..times.len().min(4)).find(|&row| times[row] < times[row - 1] && times[row] <= times[0])
}
