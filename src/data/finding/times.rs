//! Findings on the times of a recording: code, severity and sentence of each.

use super::{Effect, IssueCode as Code, Severity};
use crate::data::shown::{digits, hz};

findings! {
/// A finding about the times of rows or blocks, in any format.
pub enum TimesFinding of Times {
    /// The times run backward, first between these two.
    Backward { count: usize, from_s: f64, to_s: f64 } => (Code::DisorderedBlocks, Note, Nothing),
        ("times run backward {count} time(s), first from {from_s} s to {to_s} s; the samples were sorted by \
         time");
    /// Rows at the end repeat one time and one value.
    Unfilled { samples: usize } => (Code::DisorderedBlocks, Note, Nothing),
        ("{samples} rows at the end hold one value, and a time before the row above them: laid out and never \
         filled, they are no samples");
    /// Samples have equal times, some with different values.
    CameTwice { samples: usize, different: usize }
        => (Code::DuplicateBlocks, if *different == 0 { Note } else { Warning }, Local),
        ("{samples} sample(s) came twice with the same time: {}",
         if *different == 0 { "the copies were dropped".into() }
         else { format!("{different} of them with different values, of which the first was kept") });
    /// Samples repeat those of another time to the last digit.
    Repeated { samples: usize, of_s: f64, from_s: f64 } => (Code::DuplicateBlocks, Warning, LostSamples),
        ("{samples} samples from {} s on repeat those from {} s on to the last digit, in all channels of this \
         clock: a block was written twice, and the samples in whose place it stands are taken for lost; \
         export the recording again", digits(*from_s, 6), digits(*of_s, 6));
    /// Samples that are no numbers.
    NonFinite { samples: usize } => (Code::NonFinite, Warning, LostSamples),
        ("{samples} sample(s) are empty, NaN or infinite and count as missing");
    /// There is one gap.
    Gap { lost: usize, over_s: f64 } => (Code::Gap, Warning, LostSamples),
        ("{lost} sample(s) are missing over {:.2} ms", 1e3 * over_s);
    /// There are many gaps; the longest lasts for a span.
    Gaps { lost: usize, gaps: usize, longest: usize, over_s: f64 } => (Code::Gap, Warning, LostSamples),
        ("{lost} samples are missing in {gaps} gaps, the longest of {longest} samples over {over_s:.3e} s \
         (the span given)");
    /// The times deviate from a uniform base, onto which the samples were interpolated.
    Jitter(jitter: Jitter)
        => if jitter.is_clock_change() { (Code::Clock, Warning, Nothing) }
           else { (Code::TimeJitter, Note, Nothing) },
        ("{jitter}");
    /// The times are coarser than the samples; the rate follows from when they change; `off_s` if they change
    /// unevenly.
    Coarse { step_s: f64, rate_hz: f64, uncertainty: f64, off_s: Option<f64>, is_sure: bool }
        => (Code::Clock, if *is_sure { Note } else { Warning }, lost_rows_effect(*off_s)),
        ("the times are cut to {step} s, about {} samples each; the samples were taken as evenly spaced at \
         {} Hz, a rate that is uncertain by {} %, and the channel's start is known to {step} s only{}{}",
         digits(step_s * rate_hz, 3), digits(*rate_hz, 6), digits(100.0 * uncertainty, 2),
         off_s.map(|off_s| format!("; the times change up to {} s off even steps, so that samples may be \
                                    missing", digits(off_s, 2))).unwrap_or_default(),
         if *is_sure { "" } else { "; give sample_rate_hz for this channel" },
         step = digits(*step_s, 3));
    /// Steps of coarse times hold fewer samples than the others, or are missing.
    ShortSteps { missing: usize, step_s: f64, usual: usize } => (Code::Gap, Warning, LostSamples),
        ("{missing} sample(s) are missing: the times are cut to {} s and each stands at {usual} samples, but for \
         some that stand at fewer or are left out; all samples of those count as missing",
         digits(*step_s, 3));
    /// The times are coarse and a rate is stated; `off_s` if the times contradict it.
    CoarseBesideRate { step_s: f64, rate_hz: f64, off_s: Option<f64> }
        => (Code::Clock, if off_s.is_some() { Warning } else { Note }, lost_rows_effect(*off_s)),
        ("the times are cut to {} s{}; the samples were taken as evenly spaced at the declared {rate} Hz",
         digits(*step_s, 3),
         off_s.map(|off_s| format!(" and change up to {} s off even steps at the declared {} Hz: samples are \
                                    missing, or the rate is another", digits(off_s, 2), digits(*rate_hz, 6)))
             .unwrap_or_default(),
         rate = digits(*rate_hz, 6));
    /// Equal times beside a stated rate.
    AllEqual { rate_hz: f64 } => (Code::Clock, Note, Nothing),
        ("all times are equal; the samples were taken as evenly spaced at the declared {} Hz",
         digits(*rate_hz, 6));
    /// Blocks that come after a later one.
    BlocksBackward { count: usize } => (Code::DisorderedBlocks, Note, Nothing),
        ("{count} block(s) came after a later one; they were put in order by their stamps");
    /// Blocks are shorter than all others by less than their stamps resolve.
    ShortBlocks { count: usize, lacking: f64, off_s: f64 } => (Code::Gap, Warning, LostSamples),
        ("{count} block(s) hold fewer samples than all others, {lacking} at most, and the stamps, off by up \
         to {:.3} ms, do not tell whether samples are missing there; the blocks were joined", 1e3 * off_s);
    /// The stamps of blocks are truncated and agree with the stated rate; exact stamps might show another
    /// rate.
    StampsCut { cut_s: f64, rate_hz: f64, if_exact_hz: Option<f64> }
        => (Code::Clock, if if_exact_hz.is_some() { Warning } else { Note }, Nothing),
        ("the blocks' stamps are cut to {cut_s} s and agree with {rate_hz:.6} Hz, which was taken{}; blocks \
         that follow one another were joined",
        if_exact_hz.map(|hz| format!(", but would tell {hz:.6} Hz if they were exact")).unwrap_or_default());
    /// Stamps of blocks run at another rate than the stated one, with a large or a small difference.
    StampsRunOff { stamps_hz: f64, stated_hz: f64, rms_s: f64, is_far: bool }
        => (Code::Clock, if *is_far { Warning } else { Note }, Nothing),
        ("the blocks' stamps run at {stamps_hz:.6} Hz, {:.1} ppm off the stated {stated_hz:.6} Hz, and \
         scatter by {rms_s:.3e} s RMS about that; blocks that follow one another were joined, and the \
         stamps' rate was taken", 1e6 * (stamps_hz / stated_hz - 1.0));
    /// A few blocks are stamped as if at a rate other than the one used.
    FewBlocks { stamps_hz: f64, taken_hz: f64 } => (Code::Clock, Warning, Nothing),
        ("its few blocks are stamped as at {} Hz, and {} Hz is stated: samples between them are missing, or \
         the rate is wrong, and every velocity with it", hz(*stamps_hz), hz(*taken_hz));
    /// Blocks repeat times that already exist, some with different samples.
    BlocksTwice { count: usize, different: usize }
        => (Code::DuplicateBlocks, if *different == 0 { Note } else { Warning }, Local),
        ("{count} block(s) {}",
         if *different == 0 { "repeat samples that are there already; the copies were dropped".into() }
         else { format!("cover times that are there already, {different} of them with different samples; \
                         the first to start was kept; where they follow on one another in truth, the stamps \
                         are too coarse for such blocks") });
}
}

/// If coarse times change at uneven steps, rows may be missing anywhere, even during an impact.
fn lost_rows_effect(off_s: Option<f64>) -> Effect {
    if off_s.is_some() { Effect::Motion } else { Effect::Nothing }
}

/// Deviation of times from a uniform base, and the error that interpolating onto it may add.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("times lie {rms_s:.3e} s (RMS, {:.1} % of the sample interval) off a uniform base at {:.6} Hz, \
         {max_s:.3e} s at most; the samples were interpolated onto it. Cubic and linear interpolation differ \
         by {rms_percent:.2} % of the largest sample RMS, {max_percent:.2} % at most, which bounds the error \
         of doing so{}", 100.0 * .rms_s / .period_s, 1.0 / .period_s, self.clock_doubt())]
pub struct Jitter {
    /// Interval of the base, s.
    pub period_s: f64,
    /// RMS of the distances, s.
    pub rms_s: f64,
    /// The largest distance, s.
    pub max_s: f64,
    /// Cubic less linear interpolation, RMS, percent of the largest sample.
    pub rms_percent: f64,
    /// Largest deviation, in percent.
    pub max_percent: f64,
    /// Rates of two parts of the times, Hz, if they differ.
    pub rates_hz: Option<(f64, f64)>,
}

impl Jitter {
    /// Limit in sample intervals: late stamps with a gap or two to make up for stay below it; a clock 2 % off
    /// for a thousand samples exceeds it.
    const MOST_LATE: f64 = 2.0;

    fn is_late(&self) -> bool {
        self.rms_s > Self::MOST_LATE * self.period_s
    }

    /// True if a clock that changed its rate explains the deviation, rather than jitter.
    fn is_clock_change(&self) -> bool {
        self.is_late() || self.rates_hz.is_some()
    }

    fn clock_doubt(&self) -> String {
        match self.rates_hz {
            Some((one_hz, other_hz)) => format!(
                "; they rise at {one_hz:.6} Hz in one part and at {other_hz:.6} Hz in another, which is no \
                 jitter but a clock that changed its rate: look at the times; where the samples were taken \
                 evenly, take the times out in a copy and state sample_rate_hz"
            ),
            None if self.is_late() => "; so far off is no jitter but a clock that ran at another rate for a \
                                       while, was set or began anew: look at the times"
                .into(),
            None => String::new(),
        }
    }
}
