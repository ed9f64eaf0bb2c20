//! A source to a channel as it is taken: its column, what is said of it, its times, its samples on one base. Reading and listing share it.

use super::attributes::Attributes;
use super::clocks::{self, Clocks};
use super::column::Column;
use super::fault::Fault;
use super::find;
use crate::data::{ChannelSpec, Samples};
use crate::ingest::clock::{Claims, Refusal};
use crate::ingest::time_base::{self, TimeBaseError, Times, Uniform};

/// What a cask file says of the clock of a channel; nothing where it is listed.
#[derive(Default)]
pub(super) struct Asked<'a> {
    rate_hz: Option<f64>,
    time: Option<&'a str>,
}

impl<'a> Asked<'a> {
    /// By the channel's table, else by `time` of `[recording]`.
    pub(super) fn by(spec: &'a ChannelSpec, time: Option<&'a str>) -> Self {
        Self { rate_hz: spec.sample_rate_hz, time: spec.time.as_deref().or(time) }
    }
}

/// A channel before its samples are read.
pub(super) struct Channel {
    pub column: Column,
    pub attributes: Attributes,
    /// The times to take, and behind them all others beside the samples.
    pub times: Vec<Column>,
}

/// Samples on one base.
pub(super) struct Based {
    pub uniform: Uniform,
    /// The first and the last of their times, s, where they have times.
    pub span_s: Option<(f64, f64)>,
}

impl Channel {
    /// With the times that are asked for, else those beside the samples that have a usual name.
    ///
    /// # Errors
    /// Attributes that contradict each other, times that are none.
    pub(super) fn of(column: Column, asked: &Asked, clocks: &mut Clocks) -> Result<Self, Fault> {
        let attributes =
            Attributes::of(&column).map_err(|refusal| Fault::from(refusal).at(&column.source))?;
        let mut times = clocks.of(&column);
        if let Some(name) = asked.time {
            let named = named_times(&column, name)?;
            times.retain(|other| other.source != named.source);
            times.insert(0, named);
        }
        Ok(Self { column, attributes, times })
    }

    /// Its numbers, scaled.
    ///
    /// # Errors
    /// They cannot be read.
    pub(super) fn samples(&self) -> Result<Samples, Fault> {
        Ok(self.attributes.scaled(self.column.samples()?))
    }

    /// Whether the recording says nothing of its clock.
    pub(super) fn has_no_clock(&self) -> bool {
        let Attributes { stated, no_rate, .. } = &self.attributes;
        self.times.is_empty() && stated.is_empty() && no_rate.is_none()
    }

    /// Its samples at their times; of others beside them those are held against them for which `may_read` has room.
    ///
    /// # Errors
    /// Nothing says when the samples were taken, or what does contradicts itself.
    pub(super) fn on_base(
        &self,
        samples: Samples,
        asked: &Asked,
        mut may_read: impl FnMut(&Column) -> bool,
    ) -> Result<Based, Fault> {
        let at = |fault: Fault| fault.at(&self.column.source);
        let refused = |error: TimeBaseError| {
            at(error
                .refusal("check the dataset of times (`time` in the cask file), or give sample_rate_hz")
                .into())
        };
        let Attributes { stated, no_rate, start_s, .. } = &self.attributes;
        let claims =
            Claims { cask_hz: asked.rate_hz, are_times_named: asked.time.is_some(), stated: stated.clone() };
        let Some((time, others)) = self.times.split_first() else {
            let unclear = no_rate.clone().filter(|_| asked.rate_hz.is_none());
            let nothing = || format!("no attribute sample_rate_hz, and {}", clocks::why_none(&self.column));
            if let Some(why) = unclear.or_else(|| claims.is_empty().then(nothing)) {
                let refusal = Refusal::new(
                    format!("nothing says when its samples were taken: {why}"),
                    "give sample_rate_hz in this channel of the cask file, or time = \"/path/of/times\"",
                );
                return Err(at(refusal.into()));
            }
            let uniform =
                time_base::from_claims(start_s.unwrap_or(0.0), &claims, samples).map_err(refused)?;
            return Ok(Based { uniform, span_s: None });
        };
        // A rate that is stated tells the unit of times that state none.
        let stated_hz = asked.rate_hz.or(stated.first().map(|stated| stated.rate_hz));
        let times_s = clocks::seconds(time, stated_hz).map_err(at)?;
        let mut uniform = Times::new(&times_s).place(samples, &claims).map_err(refused)?;
        // A rate that bears the times out decides between them and others.
        let is_decided = !claims.is_empty() || claims.are_times_named;
        for other in others.iter().filter(|other| may_read(other)) {
            let told =
                clocks::witness((time, &times_s), other, is_decided).map_err(|refusal| at(refusal.into()))?;
            uniform.issues.extend(told);
        }
        Ok(Based { uniform, span_s: Some(clocks::span_s(&times_s)) })
    }
}

/// The times that a cask file names; a bare name is looked for beside the samples first, in their own records before all.
fn named_times(column: &Column, name: &str) -> Result<Column, Fault> {
    let records = column.is_field().then(|| format!("{}.{name}", column.path));
    let mut beside = records.into_iter().chain([format!("{}/{name}", column.group())]);
    let found = beside.find_map(|source| find::find(&column.file, &source).ok()?);
    found.filter(|_| !name.starts_with('/')).map_or_else(|| find::locate(&column.file, name), Ok)
}
