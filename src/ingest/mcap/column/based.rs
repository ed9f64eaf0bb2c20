//! What a column's messages gave, and what they say of its rate, to samples on a uniform base.

use super::{Column, StatedRate, seconds_from};
use crate::data::ListedChannel;
use crate::ingest::clock::Claims;
use crate::ingest::refusal::Refusal;
use crate::ingest::shown;
use crate::ingest::time_base::{self, Block, BlockContent, Uniform};
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
            let (value, unit) = (shown::short(rate.value), rate.unit.as_deref().unwrap_or_default());
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

    /// Adds to a listing when its samples were taken, as [`Column::uniform`] would have them; of blocks it
    /// needs no samples.
    ///
    /// # Errors
    /// As that.
    pub(crate) fn list_times(self, zero_ns: i64, listed: &mut ListedChannel) -> Result<(), Refusal> {
        let (start_s, sample_rate_hz, count, gaps) = match &self.extent {
            Some(extent) if !self.counts.is_empty() => {
                let content = BlockContent { samples: &self.samples, digests: Some(&extent.digests) };
                let laid = time_base::lay_blocks(&self.blocks_from(zero_ns), &self.claims(None)?, &content)?;
                (laid.start_s, laid.sample_rate_hz, laid.count(), laid.gaps.len() + extent.holes)
            }
            _ => {
                let uniform = self.uniform(zero_ns, None)?;
                (uniform.start_s, uniform.sample_rate_hz, uniform.samples.len(), uniform.gaps.len())
            }
        };
        listed.sample_rate_hz = Some(sample_rate_hz);
        listed.start_s = Some(start_s);
        listed.duration_s = Some(as_f64(count - 1) / sample_rate_hz);
        listed.gaps = Some(gaps as u64);
        Ok(())
    }
}
