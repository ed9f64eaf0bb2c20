//! What speaks against the times of a recording, with its numbers, to code, severity and sentence.

use super::{IssueCode as Code, Severity};
use crate::data::shown::{digits, hz};

/// A finding about the times of rows or blocks, in any format.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit, the variant's words the rest")]
pub enum TimesFinding {
    /// So many times rise to one, and begin anew at an earlier one.
    Restarted { count: usize, rise_to_s: f64, next_s: f64 },
    /// Times that run backward, first from one to another.
    Backward { count: usize, from_s: f64, to_s: f64 },
    /// Samples of equal times, some with different values.
    CameTwice { samples: usize, different: usize },
    /// Samples that are no numbers.
    NonFinite { samples: usize },
    /// One gap.
    Gap { lost: usize, over_s: f64 },
    /// Many gaps, the longest of them over a span.
    Gaps { lost: usize, gaps: usize, longest: usize, over_s: f64 },
    /// Times off an even base, onto which the samples were interpolated.
    Jitter(Jitter),
    /// Times coarser than the samples, which tell the rate by when they change; `off_s` where they do so unevenly.
    Coarse { step_s: f64, rate_hz: f64, uncertainty: f64, off_s: Option<f64>, is_sure: bool },
    /// Coarse times beside a stated rate; `off_s` where they contradict it.
    CoarseBesideRate { step_s: f64, rate_hz: f64, off_s: Option<f64> },
    /// Equal times beside a stated rate.
    AllEqual { rate_hz: f64 },
    /// Blocks that come after a later one.
    BlocksBackward { count: usize },
    /// Blocks shorter than all others by less than their stamps tell.
    ShortBlocks { count: usize, lacking: f64, off_s: f64 },
    /// Stamps of blocks that are cut, and agree with the stated rate; if they were exact they might tell another.
    StampsCut { cut_s: f64, rate_hz: f64, if_exact_hz: Option<f64> },
    /// Stamps of blocks that run at another rate than the stated one, far off or not.
    StampsRunOff { stamps_hz: f64, stated_hz: f64, rms_s: f64, is_far: bool },
    /// A few blocks that are stamped as at another rate than the one that was taken.
    FewBlocks { stamps_hz: f64, taken_hz: f64 },
    /// Blocks over times that are there already, some with different samples.
    BlocksTwice { count: usize, different: usize },
}

/// How far times lie off an even base, and what interpolating onto it may add.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jitter {
    /// Interval of the base, s.
    pub period_s: f64,
    /// RMS of the distances, s.
    pub rms_s: f64,
    /// The largest distance, s.
    pub max_s: f64,
    /// Cubic less linear interpolation, RMS, percent of the largest sample.
    pub rms_percent: f64,
    /// The same at most.
    pub max_percent: f64,
    /// Rates of two parts of the times, Hz, where they differ.
    pub rates_hz: Option<(f64, f64)>,
}

impl Jitter {
    /// In intervals: late stamps, with a gap or two that they make up, stay below; a clock 2 % off for a thousand samples is beyond.
    const MOST_LATE: f64 = 2.0;

    fn is_late(&self) -> bool {
        self.rms_s > Self::MOST_LATE * self.period_s
    }
}

impl TimesFinding {
    /// The check that speaks, and how much it weighs.
    pub(super) fn code(&self) -> (Code, Severity) {
        use Severity::{Note, Warning};
        match *self {
            Self::Backward { .. } | Self::BlocksBackward { .. } => (Code::DisorderedBlocks, Note),
            Self::CameTwice { different: 0, .. } | Self::BlocksTwice { different: 0, .. } => {
                (Code::DuplicateBlocks, Note)
            }
            Self::CameTwice { .. } | Self::BlocksTwice { .. } => (Code::DuplicateBlocks, Warning),
            Self::NonFinite { .. } => (Code::NonFinite, Warning),
            Self::Gap { .. } | Self::Gaps { .. } | Self::ShortBlocks { .. } => (Code::Gap, Warning),
            Self::Jitter(jitter) if jitter.is_late() || jitter.rates_hz.is_some() => (Code::Clock, Warning),
            Self::Jitter(_) => (Code::TimeJitter, Note),
            Self::Restarted { .. }
            | Self::Coarse { is_sure: false, .. }
            | Self::CoarseBesideRate { off_s: Some(_), .. }
            | Self::StampsCut { if_exact_hz: Some(_), .. }
            | Self::FewBlocks { .. }
            | Self::StampsRunOff { is_far: true, .. } => (Code::Clock, Warning),
            Self::Coarse { .. }
            | Self::CoarseBesideRate { .. }
            | Self::AllEqual { .. }
            | Self::StampsCut { .. }
            | Self::StampsRunOff { .. } => (Code::Clock, Note),
        }
    }

    /// What was found, its size, and what to do.
    pub(super) fn sentence(&self) -> String {
        match self {
            Self::Restarted { count, rise_to_s, next_s } => format!(
                "the times begin anew: {count} rise to {rise_to_s} s, the next is {next_s} s. The clock was started again, or two recordings follow one another; both parts lie on the same times, and the samples were mixed: cut the recording there in a copy"
            ),
            Self::Backward { count, from_s, to_s } => format!(
                "times run backward {count} time(s), first from {from_s} s to {to_s} s; the samples were sorted by time"
            ),
            Self::CameTwice { samples, different: 0 } => {
                format!("{samples} sample(s) came twice with the same time: the copies were dropped")
            }
            Self::CameTwice { samples, different } => format!(
                "{samples} sample(s) came twice with the same time: {different} of them with different values, of which the first was kept"
            ),
            Self::NonFinite { samples } => {
                format!("{samples} sample(s) are empty, NaN or infinite and count as missing")
            }
            Self::Gap { lost, over_s } => format!("{lost} sample(s) are missing over {:.2} ms", 1e3 * over_s),
            Self::Gaps { lost, gaps, longest, over_s } => format!(
                "{lost} samples are missing in {gaps} gaps, the longest of {longest} samples over {over_s:.3e} s (the span given)"
            ),
            Self::Jitter(jitter) => jitter.sentence(),
            Self::Coarse { step_s, rate_hz, uncertainty, off_s, is_sure } => {
                let off = off_s.map_or_else(String::new, |off_s| {
                    let off = digits(off_s, 2);
                    format!("; the times change up to {off} s off even steps, so that samples may be missing")
                });
                let step = digits(*step_s, 3);
                format!(
                    "the times are cut to {step} s, about {} samples each; the samples were taken as evenly spaced at {} Hz, a rate that is uncertain by {} %, and the channel's start is known to {step} s only{off}{}",
                    digits(step_s * rate_hz, 3),
                    digits(*rate_hz, 6),
                    digits(100.0 * uncertainty, 2),
                    if *is_sure { "" } else { "; give sample_rate_hz for this channel" }
                )
            }
            Self::CoarseBesideRate { step_s, rate_hz, off_s } => {
                let (step, rate) = (digits(*step_s, 3), digits(*rate_hz, 6));
                let off = off_s.map_or_else(String::new, |off_s| {
                    let off = digits(off_s, 2);
                    format!(" and change up to {off} s off even steps at the declared {rate} Hz: samples are missing, or the rate is another")
                });
                format!(
                    "the times are cut to {step} s{off}; the samples were taken as evenly spaced at the declared {rate} Hz"
                )
            }
            Self::AllEqual { rate_hz } => format!(
                "all times are equal; the samples were taken as evenly spaced at the declared {} Hz",
                digits(*rate_hz, 6)
            ),
            Self::BlocksBackward { count } => {
                format!("{count} block(s) came after a later one; they were put in order by their stamps")
            }
            Self::ShortBlocks { count, lacking, off_s } => format!(
                "{count} block(s) hold fewer samples than all others, {lacking} at most, and the stamps, off by up to {:.3} ms, do not tell whether samples are missing there; the blocks were joined",
                1e3 * off_s
            ),
            Self::StampsCut { cut_s, rate_hz, if_exact_hz } => {
                let doubt = if_exact_hz.map_or_else(String::new, |exact_hz| {
                    format!(", but would tell {exact_hz:.6} Hz if they were exact")
                });
                format!(
                    "the blocks' stamps are cut to {cut_s} s and agree with {rate_hz:.6} Hz, which was taken{doubt}; blocks that follow one another were joined"
                )
            }
            Self::StampsRunOff { stamps_hz, stated_hz, rms_s, .. } => format!(
                "the blocks' stamps run at {stamps_hz:.6} Hz, {:.1} ppm off the stated {stated_hz:.6} Hz, and scatter by {rms_s:.3e} s RMS about that; blocks that follow one another were joined, and the stamps' rate was taken",
                1e6 * (stamps_hz / stated_hz - 1.0)
            ),
            Self::FewBlocks { stamps_hz, taken_hz } => format!(
                "its few blocks are stamped as at {} Hz, and {} Hz is stated: samples between them are missing, or the rate is wrong, and every velocity with it",
                hz(*stamps_hz),
                hz(*taken_hz)
            ),
            Self::BlocksTwice { count, different: 0 } => {
                format!("{count} block(s) repeat samples that are there already; the copies were dropped")
            }
            Self::BlocksTwice { count, different } => format!(
                "{count} block(s) cover times that are there already, {different} of them with different samples; the first to start was kept; where they follow on one another in truth, the stamps are too coarse for such blocks"
            ),
        }
    }
}

impl Jitter {
    fn sentence(&self) -> String {
        let &Self { period_s, rms_s, max_s, rms_percent, max_percent, rates_hz } = self;
        let asked = match rates_hz {
            Some((one_hz, other_hz)) => format!(
                "; they rise at {one_hz:.6} Hz in one part and at {other_hz:.6} Hz in another, which is no jitter but a clock that changed its rate: look at the times; where the samples were taken evenly, take the times out in a copy and state sample_rate_hz"
            ),
            None if self.is_late() => "; so far off is no jitter but a clock that ran at another rate for a while, was set or began anew: look at the times".into(),
            None => String::new(),
        };
        format!(
            "times lie {rms_s:.3e} s (RMS, {:.1} % of the sample interval) off a uniform base at {:.6} Hz, {max_s:.3e} s at most; the samples were interpolated onto it. Cubic and linear interpolation differ by {rms_percent:.2} % of the largest sample RMS, {max_percent:.2} % at most, which bounds the error of doing so{asked}",
            100.0 * rms_s / period_s,
            1.0 / period_s
        )
    }
}
