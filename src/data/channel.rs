//! One accelerometer channel with uniform sampling.

use super::cask::{Axis, Coupling, End};
use serde::Serialize;

/// True if a sample is a value: finite, and not the number that SCPI 1999.0, 7.2.1.4, uses for an overrange
/// (9.9E+37) or for "not a number" (9.91E+37).
pub(crate) fn is_number(sample: f64) -> bool {
    sample.abs() < 9.89e37
}

/// Samples as the recording stores them: f32 values are converted only when they are used.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// Single precision, or integers of up to 16 bits.
    F32(Vec<f32>),
    /// Double precision, or wider integers.
    F64(Vec<f64>),
}

/// Evaluates one expression for samples of either precision.
macro_rules! of_either {
    ($samples:expr, $values:ident => $made:expr) => {
        match $samples {
            $crate::data::Samples::F32($values) => $made,
            $crate::data::Samples::F64($values) => $made,
        }
    };
}
pub(crate) use of_either;

fn widen<T: Copy + Into<f64>>(sample: &T) -> f64 {
    (*sample).into()
}

impl Default for Samples {
    fn default() -> Self {
        Self::F32(Vec::new())
    }
}

impl Samples {
    /// Number of samples.
    pub fn len(&self) -> usize {
        of_either!(self, v => v.len())
    }

    /// True if there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sample `index` as f64; panics beyond the end, as a slice does.
    pub fn get(&self, index: usize) -> f64 {
        of_either!(self, v => widen(&v[index]))
    }

    /// Converts all samples to f64.
    pub(crate) fn into_f64(self) -> Vec<f64> {
        match self {
            Self::F32(v) => v.into_iter().map(f64::from).collect(),
            Self::F64(v) => v,
        }
    }

    /// Other samples, as precise as these.
    pub(crate) fn match_precision(&self, samples: Vec<f64>) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "made of f32 samples")]
        match self {
            Self::F32(_) => Self::F32(samples.into_iter().map(|x| x as f32).collect()),
            Self::F64(_) => Self::F64(samples),
        }
    }

    /// Counts the samples that are not numbers.
    pub(crate) fn missing(&self) -> usize {
        of_either!(self, v => v.iter().filter(|x| !is_number(widen(*x))).count())
    }

    /// Marks the samples of a span as missing.
    pub(crate) fn erase(&mut self, span: Span) {
        match self {
            Self::F32(samples) => samples[span.from..span.to].fill(f32::NAN),
            Self::F64(samples) => samples[span.from..span.to].fill(f64::NAN),
        }
    }

    /// Replaces each sample by the value of `f`.
    pub(crate) fn change(&mut self, f: impl Fn(f64) -> f64) {
        #[allow(clippy::cast_possible_truncation, reason = "as precise as before")]
        match self {
            Self::F32(v) => v.iter_mut().for_each(|x| *x = f(f64::from(*x)) as f32),
            Self::F64(v) => v.iter_mut().for_each(|x| *x = f(*x)),
        }
    }

    /// Gives back the memory that they do not need.
    pub(crate) fn shrink(&mut self) {
        of_either!(self, v => v.shrink_to_fit());
    }

    /// Keeps the first `count` samples.
    pub(crate) fn truncate(&mut self, count: usize) {
        of_either!(self, v => v.truncate(count));
    }

    /// Returns the samples at the given indices, in that order.
    pub(crate) fn select(&self, indices: &[usize]) -> Self {
        match self {
            Self::F32(v) => Self::F32(indices.iter().map(|&i| v[i]).collect()),
            Self::F64(v) => Self::F64(indices.iter().map(|&i| v[i]).collect()),
        }
    }

    /// Copies spans of the samples to new positions among `count` samples, with NaN between.
    pub(crate) fn distribute(&self, count: usize, stretches: &[(Span, usize)]) -> Self {
        fn lay_out<T: Copy>(from: &[T], mut laid: Vec<T>, stretches: &[(Span, usize)]) -> Vec<T> {
            for (span, place) in stretches {
                let stretch = &from[span.from..span.to];
                laid[*place..][..stretch.len()].copy_from_slice(stretch);
            }
            laid
        }
        match self {
            Self::F32(v) => Self::F32(lay_out(v, vec![f32::NAN; count], stretches)),
            Self::F64(v) => Self::F64(lay_out(v, vec![f64::NAN; count], stretches)),
        }
    }
}

/// A value and when it was read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extreme {
    /// Value in the channel's unit.
    pub value: f64,
    /// Time, s; beside a motion it counts from the first sample of the accelerometers.
    pub time_s: f64,
}

/// A half-open range of sample indices `from..to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// First index.
    pub from: usize,
    /// Index after the last sample.
    pub to: usize,
}

/// One channel as read: uniform in time, samples in the recording's own unit, polarity not yet applied.
///
/// Sample i was taken at `start_s + i / sample_rate_hz`; its specific force along the sensor's axis, positive
/// on the body axis, is `samples[i] · scale_m_s2`. Missing samples are NaN and listed in `gaps`.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name in the cask file.
    pub name: String,
    /// End of the cask at which the sensor sits.
    pub end: End,
    /// Along which body axis it reads.
    pub axis: Axis,
    /// Path at which the samples were found, as the cask file says.
    pub source: String,
    /// Position along the axis from the first end, m.
    pub position_m: f64,
    /// Position across the axis, positive away from the target, m.
    pub offset_m: f64,
    /// Time of sample 0, s from the recording's first sample (over all channels read).
    pub start_s: f64,
    /// Sample rate of the uniform base, Hz.
    pub sample_rate_hz: f64,
    /// Samples in `unit`; times `scale_m_s2` they are in m/s².
    pub samples: Samples,
    /// m/s² per unit of `samples`, polarity included.
    pub scale_m_s2: f64,
    /// The unit the samples are in, as a person would write it ("g", "m/s^2", "mV").
    pub unit: String,
    /// Origin of that unit: "cask file" or "recording".
    pub unit_origin: &'static str,
    /// True if the recording itself states the unit.
    pub is_unit_recorded: bool,
    /// The cask file's clipping limit, in `unit` (of either sign).
    pub full_scale: Option<f64>,
    /// Stretches without samples; there `samples` is NaN.
    pub gaps: Vec<Span>,
    /// RMS distance of the recorded times from the uniform base, s; 0 where the base is the recording's own.
    pub time_jitter_s: f64,
    /// Coupling of the sensor.
    pub coupling: Coupling,
    /// Reading in a separate file that records the rest before the drop, including the offset.
    pub rest: Option<RestReading>,
}

/// A level at rest, in the unit of the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestReading {
    /// The level.
    pub level: f64,
    /// Standard uncertainty of that reading.
    pub u: f64,
}

impl Channel {
    /// Time of sample `index`, s from the recording's first sample.
    #[allow(clippy::cast_precision_loss, reason = "sample counts stay below 2^52")]
    pub fn time_s(&self, index: usize) -> f64 {
        self.start_s + index as f64 / self.sample_rate_hz
    }

    /// Clipping level, m/s², as far as it is stated.
    pub fn range_m_s2(&self) -> Option<f64> {
        Some(self.full_scale? * self.scale_m_s2.abs())
    }

    /// The samples `from..to` as specific force on the body axis, m/s²; the range is limited to the available
    /// samples.
    pub fn force_m_s2(&self, from: usize, to: usize) -> Vec<f64> {
        let to = to.min(self.samples.len());
        let from = from.min(to);
        of_either!(&self.samples, v => v[from..to].iter().map(|x| widen(x) * self.scale_m_s2).collect())
    }

    /// The smallest and the largest sample, in `unit`, each at its first occurrence; `None` if no sample is a
    /// number.
    pub fn extremes(&self) -> Option<[Extreme; 2]> {
        let at = |index| Extreme { value: self.samples.get(index), time_s: self.time_s(index) };
        let numbers = (0..self.samples.len()).map(at).filter(|sample| is_number(sample.value));
        numbers.map(|sample| [sample; 2]).reduce(|[smallest, largest], [next, _]| {
            [
                if next.value < smallest.value { next } else { smallest },
                if next.value > largest.value { next } else { largest },
            ]
        })
    }

    /// Index of the sample nearest to `time_s`, limited to the available samples.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "cut to 0..len before the cast"
    )]
    pub fn index_at(&self, time_s: f64) -> usize {
        let index = ((time_s - self.start_s) * self.sample_rate_hz).round();
        if index <= 0.0 { 0 } else { (index as usize).min(self.samples.len()) }
    }
}
