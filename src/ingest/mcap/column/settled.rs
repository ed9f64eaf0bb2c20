//! Numbers that messages carry as their times to ns, and log times to how their pace differs from that of the
//! stamps.

use super::{Column, SentTimes, seconds_from};
use crate::data::{Finding, McapFinding};
use crate::ingest::clock::RATE_TOLERANCE;
use crate::ingest::refusal::Refusal;
use crate::ingest::time_base;
use crate::ingest::times::{self, Carrier};
use crate::numerics::as_f64;

impl Column {
    /// Takes the numbers that messages carry for their times, in ns, where they rise as times do; `source`
    /// names what they are the times of.
    ///
    /// # Errors
    /// Nothing says their unit.
    pub(crate) fn settle_ticks(&mut self, source: &str, cask_hz: Option<f64>) -> Result<(), Refusal> {
        let Some(SentTimes { field, scale, mut each }) = self.ticks.take() else { return Ok(()) };
        let (Some((from_ns, to_ns)), count) = (self.span_ns(), self.times_ns.len()) else { return Ok(()) };
        each.resize(count, f64::NAN);
        if !times::rise(&each) {
            self.bad_stamps = count as u64;
            return Ok(());
        }
        let samples = self.extent.as_ref().map_or(self.samples.len(), |extent| extent.samples);
        let samples_each = as_f64(samples) / as_f64(count);
        let stated = || Some(self.rates.first()?.statement(f64::NAN)?.rate_hz);
        let stated_hz = cask_hz.or_else(stated);
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
