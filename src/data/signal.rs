//! One conditioned channel over the event window: the input of the analysis.

use super::cask::{Axis, End};
use super::channel::Span;

/// Velocity that clipping may remove before the slap-down without making the step useless, m/s: 2 % of that
/// of a 9 m fall.
pub const MOST_LOST_M_S: f64 = 0.27;

/// The flank of a clipped pulse must exceed the noise by this many standard deviations: then its slope is
/// known to a sixth.
const CLEAR_OF_NOISE: f64 = 6.0;

/// Fewest samples of a flank that the chain limits.
pub const LEAST_FLANK: usize = 8;
/// A limited level changes by less than this share, a limited flank by more; noise lets a flank exceed its
/// first sample by less than this factor.
const LEVEL_SHARE: f64 = 0.2;
const FIRST_SHARE: f64 = 1.05;

/// A channel around the event: specific force on the body axis with its offset removed, unfiltered.
///
/// Sample i was taken at `start_s + i / sample_rate_hz`. Missing samples are 0 and listed in `gaps`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Signal {
    /// The channel's name.
    pub name: String,
    /// End of the cask at which the sensor sits.
    pub end: End,
    /// Along which axis it reads.
    pub axis: Axis,
    /// Position along the axis from the first end, m.
    pub position_m: f64,
    /// Position across the axis, positive away from the target, m.
    pub offset_m: f64,
    /// Time of sample 0, s from the recording's first sample.
    pub start_s: f64,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Specific force, m/s².
    pub force_m_s2: Vec<f64>,
    /// Offset that was removed, m/s².
    pub removed_offset_m_s2: f64,
    /// Standard uncertainty of that offset, m/s².
    pub u_offset_m_s2: f64,
    /// RMS of the noise before first contact, m/s².
    pub noise_m_s2: f64,
    /// One-sided spectral density of that noise: bins of frequency, Hz, and (m/s²)²/Hz; empty if too little
    /// was recorded.
    pub noise_spectrum: Vec<(f64, f64)>,
    /// Length of the free fall from which offset and noise were determined, s; 0 if it was too short.
    pub free_fall_s: f64,
    /// Standard uncertainty of its scale from the angle of a sensor alone on the skin, as a share.
    pub u_around: f64,
    /// Samples at a limit of size or of slope.
    pub clipped: Vec<Span>,
    /// Stretches without samples.
    pub gaps: Vec<Span>,
}

impl Signal {
    /// Time of sample `index`, s from the recording's first sample.
    #[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
    pub fn time_s(&self, index: usize) -> f64 {
        self.start_s + index as f64 / self.sample_rate_hz
    }

    /// Position of `time_s` in samples, fractional, negative before the first.
    pub fn position_at(&self, time_s: f64) -> f64 {
        (time_s - self.start_s) * self.sample_rate_hz
    }

    /// Index of the first sample at or after `time_s`, limited to the available samples.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a negative or NaN position casts to 0, a large one is cut"
    )]
    pub fn index_from(&self, time_s: f64) -> usize {
        // A hair below the next sample counts as that sample.
        ((self.position_at(time_s) - 1e-6).ceil() as usize).min(self.force_m_s2.len())
    }

    /// Time of the last sample, s.
    pub fn end_s(&self) -> f64 {
        self.time_s(self.force_m_s2.len().saturating_sub(1))
    }

    /// The samples `from..to` alone; the range is limited to the available samples.
    pub fn cut(&self, from: usize, to: usize) -> Self {
        let to = to.min(self.force_m_s2.len());
        let from = from.min(to);
        self.cut_with(from, self.force_m_s2[from..to].to_vec())
    }

    /// The signal from `from` on, with its samples replaced by `force_m_s2`.
    pub fn cut_with(&self, from: usize, force_m_s2: Vec<f64>) -> Self {
        let to = from + force_m_s2.len();
        let shifted = |spans: &[Span]| {
            let inside = spans.iter().filter(|s| s.from < to && s.to > from);
            inside.map(|s| Span { from: s.from.max(from) - from, to: s.to.min(to) - from }).collect()
        };
        Self {
            name: self.name.clone(),
            start_s: self.time_s(from),
            force_m_s2,
            noise_spectrum: self.noise_spectrum.clone(),
            clipped: shifted(&self.clipped),
            gaps: shifted(&self.gaps),
            ..*self
        }
    }

    /// True if the chain limits the slope of the signal over a span, not its size: it falls from its first
    /// sample on.
    pub fn is_flank(&self, span: &Span) -> bool {
        let within = self.force_m_s2.get(span.from..span.to).unwrap_or_default();
        let sign = within.first().map_or(1.0, |first| first.signum());
        let [first, last] = [within.first(), within.last()].map(|f| f.map_or(0.0, |f| sign * f));
        let largest = within.iter().fold(0.0_f64, |most, f| most.max(sign * f));
        within.len() >= LEAST_FLANK && last < (1.0 - LEVEL_SHARE) * first && largest < FIRST_SHARE * first
    }

    /// Velocity that clipping between two times has cut off, m/s, estimated by a cubic over each flat top:
    /// (ṡ_in + ṡ_out) T² / 12. A limited flank would count all that lies under it, so half is used.
    #[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
    pub fn lost_to_clipping_m_s(&self, from_s: f64, to_s: f64) -> f64 {
        let force = |i: usize| self.force_m_s2.get(i).copied();
        self.clipped
            .iter()
            .filter(|span| self.time_s(span.from) < to_s && self.time_s(span.to) > from_s)
            .map(|span| {
                if self.is_flank(span) {
                    let under = self.force_m_s2.get(span.from..span.to).unwrap_or_default();
                    return under.iter().map(|f| f.abs()).sum::<f64>() / self.sample_rate_hz / 2.0;
                }
                let length_s = (span.to - span.from) as f64 / self.sample_rate_hz;
                let level = force(span.from).unwrap_or(0.0);
                // The slope uses enough samples beyond the span to exceed the noise.
                let slope = |beyond: &dyn Fn(usize) -> Option<usize>| {
                    let falls = (1..=(span.to - span.from).div_ceil(4)).map_while(|n| {
                        let fallen = (level - force(beyond(n)?)?).abs();
                        Some((fallen, fallen * self.sample_rate_hz / n as f64))
                    });
                    let falls: Vec<(f64, f64)> = falls.collect();
                    let clear = falls.iter().find(|(fallen, _)| *fallen > CLEAR_OF_NOISE * self.noise_m_s2);
                    clear.or(falls.last()).map_or(0.0, |(_, slope_m_s3)| *slope_m_s3)
                };
                let before = slope(&|n| span.from.checked_sub(n));
                (before + slope(&|n| Some(span.to + n - 1))) * length_s * length_s / 12.0
            })
            .sum()
    }

    /// Duration of the missing samples between two times, s.
    pub fn missing_s(&self, from_s: f64, to_s: f64) -> f64 {
        let inside_s = |gap: &Span| self.time_s(gap.to).min(to_s) - self.time_s(gap.from).max(from_s);
        self.gaps.iter().map(|gap| inside_s(gap).max(0.0)).sum()
    }

    /// True if any of `spans` lies in `from_s..to_s`.
    pub fn overlaps(&self, spans: &[Span], from_s: f64, to_s: f64) -> bool {
        spans.iter().any(|s| self.time_s(s.from) < to_s && self.time_s(s.to) > from_s)
    }
}

/// The transverse signal nearest to an end, which shows events there first.
pub(crate) fn transverse(signals: &[Signal], end: End) -> Option<&Signal> {
    let from_middle = |s: &Signal| if end == End::First { s.position_m } else { -s.position_m };
    signals
        .iter()
        .filter(|s| s.axis == Axis::Transverse && s.end == end)
        .min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)))
}

/// Approximate time of the event from a coarse search: good enough to cut out the window for the detailed
/// analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseEvent {
    /// Start of the steepest velocity change of L, s; first contact lies at most `spread_s` before.
    pub near_s: f64,
    /// Uncertainty of that time, s.
    pub spread_s: f64,
    /// Largest velocity change of L within the sliding window, m/s, signed.
    pub velocity_step_m_s: f64,
}
