//! A source to a channel as it is taken: its column, what is said of it, its times, its samples on one base.
//! Reading and listing share it.

use super::account::Account;
use super::attributes::Attributes;
use super::clocks;
use super::column::DatasetColumn;
use super::find;
use super::sensors::RecordSensors;
use super::starts::{LATEST_S, Start};
use crate::data::{ChannelSpec, RowsOf, Samples};
use crate::ingest::clock::Claims;
use crate::ingest::counting::{RowCounter, with_missing};
use crate::ingest::refusal::Refusal;
use crate::ingest::time_base::{self, ChannelTimes, Uniform};

/// A channel before its samples are read.
pub(super) struct DatasetChannel {
    pub column: DatasetColumn,
    pub attributes: Attributes,
    /// What cask file and attributes say of its rate.
    pub claims: Claims,
    /// The times to take, and behind them all others beside the samples.
    pub times: Vec<DatasetColumn>,
    /// Which of its samples are taken, where it holds those of several sensors.
    rows: Option<Vec<usize>>,
    /// What counts its samples, where it shows some to be missing.
    counter: Option<RowCounter>,
}

/// Samples on one base.
pub(super) struct Based {
    pub uniform: Uniform,
    /// What is said of its start.
    pub start: Start,
}

impl DatasetChannel {
    /// As `spec` asks for it, with the times of the name that the cask file gives, else those beside the
    /// samples that have a usual one; `sensors` are those by which its samples are told apart.
    ///
    /// # Errors
    /// Attributes that contradict each other, times that are none, no sensor picked of several.
    pub(super) fn of(
        column: DatasetColumn,
        spec: &ChannelSpec,
        time: Option<&str>,
        sensors: Option<&RecordSensors>,
        account: &mut Account,
    ) -> Result<Self, Refusal> {
        let at = |fault: Refusal| fault.at(&column.source);
        let mut attributes = Attributes::of(&column, spec.scale.is_some()).map_err(at)?;
        let clocks = &mut account.clocks;
        if let Some(since_s) = &mut attributes.start.since_s {
            *since_s -= *clocks.zero_s.get_or_insert(*since_s);
        }
        let mut times = clocks.of(&column);
        if let Some(name) = time {
            let named = named_beside(&column, name)?;
            times.retain(|other| other.source != named.source);
            times.insert(0, named);
        }
        let stated = std::mem::take(&mut attributes.stated);
        let claims = Claims { cask_hz: spec.sample_rate_hz, are_times_named: time.is_some(), stated };
        let rows = sensors.map(|sensors| sensors.rows(spec.rows.as_ref())).transpose().map_err(at)?;
        let is_other = |other: &DatasetColumn| times.iter().all(|time| time.source != other.source);
        let counters = if rows.is_none() { clocks::counters_beside(&column) } else { Vec::new() };
        let mut counters =
            counters.into_iter().filter(|other| is_other(other) && account.has_for_a_while(other));
        let counter = counters.find_map(|it| RowCounter::of(&it.source, &it.samples().ok()?.into_f64()));
        let counter = counter.filter(RowCounter::shows_loss);
        drop(counters);
        Ok(Self { column, attributes, claims, times, rows, counter })
    }

    /// Its numbers, scaled.
    ///
    /// # Errors
    /// They cannot be read.
    pub(super) fn samples(&self) -> Result<Samples, Refusal> {
        let samples = self.attributes.scaled(self.column.samples()?);
        Ok(match &self.rows {
            Some(rows) => samples.select(rows),
            None => samples,
        })
    }

    /// Whether the recording says nothing of its clock.
    pub(super) fn has_no_clock(&self) -> bool {
        self.times.is_empty() && self.claims.is_empty() && self.attributes.no_rate.is_none()
    }

    /// Its samples at their times, or at the rate that is stated; of others beside the times those are held
    /// against them for which there is room.
    ///
    /// # Errors
    /// Nothing says when the samples were taken, or what does contradicts itself.
    pub(super) fn on_base(&self, samples: Samples, account: &mut Account) -> Result<Based, Refusal> {
        let at = |fault: Refusal| fault.at(&self.column.source);
        // A rate that is stated tells the unit of times that state none.
        let stated_hz = self.claims.cask_hz.or(self.claims.stated.first().map(|stated| stated.rate_hz));
        let (mut others, mut unfit) = (self.times.iter(), None);
        while let Some(time) = others.next() {
            if unfit.is_some() && !account.has_for_a_while(time) {
                continue;
            }
            let mut counted = clocks::counted(time).map_err(at)?;
            if let Some(rows) = self.rows.as_ref().filter(|_| counted.0.len() == self.column.length) {
                counted.0 = rows.iter().map(|row| counted.0[*row]).collect();
            }
            let why = clocks::why_unfit(time, &counted).filter(|_| !self.claims.are_times_named);
            if why.is_some() {
                unfit = unfit.or(why);
                continue;
            }
            let mut times_s = clocks::seconds(time, counted, stated_hz).map_err(at)?;
            // They count from 1970 themselves, or from what is said of the start.
            let start =
                Some(&self.attributes.start).filter(|_| times_s.first().is_none_or(|t| *t < LATEST_S));
            let start = start.cloned().unwrap_or_default();
            if let Some(since_s) = start.since_s {
                for t in &mut times_s {
                    *t += since_s;
                }
            }
            let told = self.counter.as_ref().map_or(Ok(None), |counter| {
                counter.beside(&times_s, &time.source, self.claims.are_times_named)
            });
            let told = told.map_err(at)?;
            let placed = ChannelTimes::new(&times_s).place(samples, &self.claims);
            let mut uniform = placed.map_err(at)?;
            uniform.issues.extend(told);
            // A rate that bears the times out decides between them and others.
            let is_decided = !self.claims.is_empty() || self.claims.are_times_named;
            for other in others.filter(|other| self.rows.is_none() && account.has_for_a_while(other)) {
                let told = clocks::witness((time, &times_s), other, is_decided);
                uniform.issues.extend(told.map_err(at)?);
            }
            return Ok(Based { uniform, start });
        }
        self.by_rate(samples, unfit)
    }

    fn by_rate(&self, mut samples: Samples, unfit: Option<String>) -> Result<Based, Refusal> {
        let Attributes { no_rate, start, .. } = &self.attributes;
        let mut told = None;
        if let Some(counter) = &self.counter {
            told = Some(counter.finding());
            samples = samples.match_precision(with_missing(&samples.clone().into_f64(), &counter.jumps));
        }
        let unclear = no_rate.clone().filter(|_| self.claims.cask_hz.is_none());
        let none = || unfit.unwrap_or_else(|| clocks::why_none(&self.column));
        let nothing = || format!("no attribute sample_rate_hz, and {}", none());
        let placed = match unclear.or_else(|| self.claims.is_empty().then(nothing)) {
            Some(why) => Err(Refusal::new(
                format!("nothing says when its samples were taken: {why}"),
                "give sample_rate_hz in this channel of the cask file, or time = \"/path/of/times\"",
            )),
            None => time_base::from_claims(start.first_s(), &self.claims, samples),
        };
        let mut uniform = placed.map_err(|fault| fault.at(&self.column.source))?;
        uniform.issues.extend(told);
        Ok(Based { uniform, start: start.clone() })
    }
}

/// The sensors by which the samples of a column are told apart: by what is `picked` for it, or by what stands
/// beside it.
///
/// # Errors
/// What is picked is not there.
pub(super) fn sensors_of(
    column: &DatasetColumn,
    picked: Option<&RowsOf>,
    account: &mut Account,
) -> Result<Option<RecordSensors>, Refusal> {
    let named = picked.map(|picked| named_beside(column, &picked.column)).transpose()?;
    let beside = named.map_or_else(|| clocks::sensors_beside(column), |named| vec![named]);
    let mut beside = beside.iter().filter(|ids| ids.length == column.length && account.has_for_a_while(ids));
    let sensors = beside.find_map(|ids| RecordSensors::by(ids, picked.is_some()));
    Ok(sensors.or_else(|| picked.map(|_| RecordSensors::default())))
}

/// What a cask file names; a bare name is looked for beside the samples first, in their own records before
/// all.
fn named_beside(column: &DatasetColumn, name: &str) -> Result<DatasetColumn, Refusal> {
    let found = clocks::places(column).find_map(|place| find::find(&column.file, &(place + name)).ok()?);
    found.filter(|_| !name.starts_with('/')).map_or_else(|| find::locate(&column.file, name), Ok)
}
