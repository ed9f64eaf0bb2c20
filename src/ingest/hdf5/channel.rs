//! A source to a channel as it is taken: its column, what is said of it, its times, its samples on one base.
//! ReadRequest and listing share it.

use super::attributes::Attributes;
use super::clocks::{self, Clocks};
use super::column::DatasetColumn;
use super::find;
use super::sensors::RecordSensors;
use super::starts::{LATEST_S, Start};
use crate::data::{RowsOf, Samples};
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
    /// With the times of the name that the cask file gives, else those beside the samples that have a usual
    /// one; `cask_hz` is its rate, and
    /// `is_settled` where the file states its scale.
    ///
    /// # Errors
    /// Attributes that contradict each other, times that are none.
    pub(super) fn of(
        column: DatasetColumn,
        (cask_hz, is_settled): (Option<f64>, bool),
        time: Option<&str>,
        clocks: &mut Clocks,
    ) -> Result<Self, Refusal> {
        let mut attributes =
            Attributes::of(&column, is_settled).map_err(|refusal| refusal.at(&column.source))?;
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
        let claims = Claims { cask_hz, are_times_named: time.is_some(), stated };
        Ok(Self { column, attributes, claims, times, rows: None, counter: None })
    }

    /// Takes the samples of one sensor alone.
    ///
    /// # Errors
    /// None is picked of several, or none that is there.
    pub(super) fn pick(
        &mut self,
        picked: Option<&RowsOf>,
        mut may_read: impl FnMut(&DatasetColumn) -> bool,
    ) -> Result<(), Refusal> {
        let named = picked.map(|picked| named_beside(&self.column, &picked.column)).transpose()?;
        let beside = named.map_or_else(|| clocks::sensors_beside(&self.column), |named| vec![named]);
        let mut beside = beside.iter().filter(|ids| ids.length == self.column.length && may_read(ids));
        let sensors = beside.find_map(|ids| RecordSensors::by(ids, picked.is_some()));
        let sensors = sensors.or_else(|| picked.map(|_| RecordSensors::default()));
        let rows = sensors.map(|sensors| sensors.rows(picked)).transpose();
        self.rows = rows.map_err(|fault| fault.at(&self.column.source))?;
        Ok(())
    }

    /// Looks beside the samples for a counter of them that shows some to be missing.
    pub(super) fn count_rows(&mut self, mut may_read: impl FnMut(&DatasetColumn) -> bool) {
        let counter =
            |column: DatasetColumn| RowCounter::of(&column.source, &column.samples().ok()?.into_f64());
        let is_own = |other: &DatasetColumn| self.times.iter().any(|time| time.source == other.source);
        let beside = clocks::counters_beside(&self.column).into_iter().filter(|other| !is_own(other));
        let found = beside.filter(|column| may_read(column)).find_map(counter);
        self.counter = found.filter(|counter| self.rows.is_none() && counter.shows_loss());
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
    /// against them for which `may_read` has room.
    ///
    /// # Errors
    /// Nothing says when the samples were taken, or what does contradicts itself.
    pub(super) fn on_base(
        &self,
        samples: Samples,
        mut may_read: impl FnMut(&DatasetColumn) -> bool,
    ) -> Result<Based, Refusal> {
        let at = |fault: Refusal| fault.at(&self.column.source);
        // A rate that is stated tells the unit of times that state none.
        let stated_hz = self.claims.cask_hz.or(self.claims.stated.first().map(|stated| stated.rate_hz));
        let (mut others, mut unfit) = (self.times.iter(), None);
        while let Some(time) = others.next() {
            if unfit.is_some() && !may_read(time) {
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
            for other in others.filter(|other| self.rows.is_none() && may_read(other)) {
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

/// What a cask file names; a bare name is looked for beside the samples first, in their own records before
/// all.
fn named_beside(column: &DatasetColumn, name: &str) -> Result<DatasetColumn, Refusal> {
    let found = clocks::places(column).find_map(|place| find::find(&column.file, &(place + name)).ok()?);
    found.filter(|_| !name.starts_with('/')).map_or_else(|| find::locate(&column.file, name), Ok)
}
