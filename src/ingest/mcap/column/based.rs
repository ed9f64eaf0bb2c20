//! What a column's messages gave, and what they say of its rate and times, to samples on a uniform base;
//! their log times to how their pace differs from that of the stamps.

use super::{Column, SEQUENCE, SentTimes, StatedRate, seconds_from};
use crate::data::{Finding, McapFinding};
use crate::ingest::clock::{Claims, RATE_TOLERANCE};
use crate::ingest::counting::RowCounter;
use crate::ingest::mcap::path::FieldPath;
use crate::ingest::mcap::topics::LOG_TIME;
use crate::ingest::refusal::Refusal;
use crate::ingest::shown;
use crate::ingest::time_base::{self, Block, Uniform};
use crate::ingest::times::{self, Carrier, Scale};
use crate::numerics::as_f64;

impl Column {
    /// The rate at which its samples came by the times of its messages, Hz.
    fn told_hz(&self) -> f64 {
        let before_last = as_f64(self.counts.iter().rev().skip(1).sum());
        self.span_ns().map_or(f64::NAN, |(from_ns, to_ns)| before_last / seconds_from(to_ns, from_ns))
    }

    /// What is said of its rate but by its stamps.
    fn claims(&self, cask_hz: Option<f64>) -> Result<Claims, Refusal> {
        let told_hz = self.told_hz();
        if let (None, Some(rate)) =
            (cask_hz, self.rates.iter().find(|rate| rate.statement(told_hz).is_none()))
        {
            let (value, unit) = (shown::show(rate.value), rate.unit.as_deref().unwrap_or_default());
            return Err(Refusal::new(
                format!(
                    "its messages state {} = {}, which is no rate or interval",
                    rate.name,
                    format!("{value} {unit}").trim()
                ),
                "write the true `sample_rate_hz` in this channel of the cask file: it overrides the \
                 recording",
            ));
        }
        let nearest = self.rates.iter().map(|rate| rate.level).min().unwrap_or(0);
        let mut rates: Vec<&StatedRate> = self.rates.iter().collect();
        rates.sort_by_key(|rate| rate.level);
        let statement = |rate: &StatedRate| Some(rate.statement(told_hz)?.at(rate.level - nearest));
        let stated = rates.into_iter().filter_map(statement).collect();
        Ok(Claims { cask_hz, stated, ..Claims::default() })
    }

    /// Its blocks, times counted from `zero_ns`.
    fn blocks_from(&self, zero_ns: i64) -> Vec<Block> {
        let each = self.times_ns.iter().zip(&self.counts);
        each.map(|(&time_ns, &count)| Block { start_s: seconds_from(time_ns, zero_ns), count }).collect()
    }

    /// The samples on a uniform base, times counted from `zero_ns`; `cask_hz` overrides what the messages
    /// say.
    ///
    /// # Errors
    /// Rate or times that give no base.
    pub(crate) fn uniform(self, zero_ns: i64, cask_hz: Option<f64>) -> Result<Uniform, Refusal> {
        self.heeded()?;
        if self.counts.is_empty() {
            // A rate in messages of single numbers is that of something else, such as blocks beside them.
            let times_s: Vec<f64> =
                self.times_ns.iter().map(|&time_ns| seconds_from(time_ns, zero_ns)).collect();
            return time_base::from_times(&times_s, self.samples, cask_hz);
        }
        let claims = self.claims(cask_hz)?;
        time_base::place_blocks(&self.blocks_from(zero_ns), &claims, self.samples)
    }

    /// Takes the numbers that messages carry for their times, in ns, where they rise as times do; `source`
    /// names what they are the times of.
    ///
    /// # Errors
    /// Nothing says their unit.
    pub(crate) fn settle_ticks(&mut self, source: &str, cask_hz: Option<f64>) -> Result<(), Refusal> {
        let Some(SentTimes { field, mut each }) = self.ticks.take() else { return Ok(()) };
        let (Some((from_ns, to_ns)), count) = (self.span_ns(), self.times_ns.len()) else { return Ok(()) };
        each.resize(count, f64::NAN);
        if !times::rise(&each) {
            self.bad_stamps = count as u64;
            return Ok(());
        }
        let samples_each = as_f64(self.samples.len()) / as_f64(count);
        let stated = || Some(self.rates.first()?.statement(f64::NAN)?.rate_hz);
        let stated_hz = cask_hz.or_else(stated);
        let path = FieldPath::parse(&field);
        let name = path.as_ref().and_then(FieldPath::last_name);
        let scale = name.map_or(Scale::Open, |name| Scale::of(name, None));
        let place = format!("the field {field} beside {source}");
        let (logged_s, counted) = (seconds_from(to_ns, from_ns), (scale, Carrier::Field(&place)));
        let unit_s = times::seconds_a_tick(&each, samples_each, logged_s, counted, stated_hz)?;
        let unit_ns = (unit_s * 1e9).round();
        #[allow(clippy::cast_possible_truncation, reason = "a float-to-integer cast saturates")]
        let ns = |tick: f64| {
            // Whole and rest apart: nanoseconds since 1970 are more than a double holds.
            let rest = ((tick - tick.trunc()) * unit_ns).round() as i64;
            (tick as i64).saturating_mul(unit_ns as i64).saturating_add(rest)
        };
        self.times_ns.iter_mut().zip(&each).for_each(|(time_ns, tick)| *time_ns = ns(*tick));
        (self.good_stamps, self.bad_stamps) = (count as u64, 0);
        Ok(())
    }

    /// What a counter beside the samples says against the times of its messages; `is_named` where the cask
    /// file names those, and `messages` have other channels, which may share a counter.
    ///
    /// # Errors
    /// Messages are missing over which times go on that nobody named.
    pub(crate) fn held_against_counter(
        &self,
        is_named: bool,
        messages: f64,
    ) -> Result<Option<Finding>, Refusal> {
        let Some((from_ns, _)) = self.span_ns() else { return Ok(None) };
        let times_s: Vec<f64> = self.times_ns.iter().map(|time| seconds_from(*time, from_ns)).collect();
        for (_, header, numbers) in &self.others {
            let counter = RowCounter::of(header, &numbers.values());
            let is_sequence = header == SEQUENCE;
            let is_own = |counter: &RowCounter| !is_sequence || counter.lost() > messages;
            let Some(counter) = counter.filter(RowCounter::shows_loss).filter(is_own) else { continue };
            let times = if self.good_stamps > 0 { "stamp" } else { LOG_TIME };
            match counter.beside(&times_s, times, is_named) {
                Ok(None) => {}
                Err(mut refusal) if is_sequence => {
                    refusal.remedy = "where messages were lost measure again, or cut the recording before \
                                      them; where they count something else write time = \"log_time\" \
                                      under [recording] of the cask file"
                        .into();
                    return Err(refusal);
                }
                said => return said,
            }
        }
        Ok(None)
    }

    /// That the log times of its messages run at another pace than their stamps.
    #[allow(clippy::float_cmp, reason = "slopes of the same numbers")]
    pub(crate) fn log_drift(&self) -> Option<Finding> {
        /// Fewer messages tell no pace.
        const FEWEST: usize = 16;
        let &(_, log_from_ns) =
            self.logged.first().filter(|_| self.good_stamps == self.times_ns.len() as u64)?;
        let from_ns = self.times_ns[self.logged[0].0];
        let late = |&(place, log_ns): &(usize, i64)| {
            let stamp_s = seconds_from(self.times_ns[place], from_ns);
            (stamp_s, seconds_from(log_ns, log_from_ns) - stamp_s)
        };
        let points: Vec<(f64, f64)> = self.logged.iter().map(late).collect();
        let ((mean_s, mean_late_s), slope) = time_base::line(&points);
        let off = |&(s, late_s): &(f64, f64)| (late_s - mean_late_s - slope * (s - mean_s)).abs();
        let scatter_s = points.iter().map(off).fold(0.0, f64::max);
        let span_s = points.iter().fold(0.0_f64, |m, point| m.max(point.0.abs()));
        // What was converted later was logged at any pace.
        let is_told = points.len() >= FEWEST
            && (RATE_TOLERANCE..0.5).contains(&slope.abs())
            && slope.abs() * span_s > 3.0 * scatter_s;
        is_told.then(|| McapFinding::LogDrift { percent: 100.0 * slope }.into())
    }
}
