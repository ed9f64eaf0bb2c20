//! Numbers of either precision to one run of samples, and to what a listing shows of them: how many, their
//! range, and what stands for those of a block.

use super::plan::Value;
use crate::data::{Samples, is_number};
use crate::numerics::to_f32;

/// One more number; single precision as long as all are narrow.
pub(super) fn push(samples: &mut Samples, value: f64, is_narrow: bool) {
    match samples {
        Samples::F32(narrow) if is_narrow => narrow.push(to_f32(value)),
        Samples::F32(_) => append(samples, &mut Samples::F64(vec![value])),
        Samples::F64(wide) => wide.push(value),
    }
}

/// Moves more samples behind those there are; single precision as long as all are.
pub(super) fn append(samples: &mut Samples, more: &mut Samples) {
    match (samples, more) {
        (Samples::F32(own), Samples::F32(more)) => follow(own, more),
        (Samples::F64(own), Samples::F64(more)) => follow(own, more),
        (Samples::F64(own), Samples::F32(more)) => own.extend(more.drain(..).map(f64::from)),
        (own @ Samples::F32(_), Samples::F64(more)) => {
            let mut wide = (0..own.len()).map(|i| own.get(i)).collect();
            follow(&mut wide, more);
            *own = Samples::F64(wide);
        }
    }
}

/// Moves `more` behind `own`, or in its place where that has no memory yet.
fn follow<S>(own: &mut Vec<S>, more: &mut Vec<S>) {
    if own.capacity() == 0 { std::mem::swap(own, more) } else { own.append(more) }
}

/// What a listing shows of samples, which it does not keep of blocks.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Extent {
    pub(super) samples: usize,
    /// The least and the largest that is a number.
    pub(super) range: Option<(f64, f64)>,
    /// Stretches of blocks that are none.
    pub(super) holes: usize,
    /// A number for the samples of each block.
    pub(super) digests: Vec<u64>,
    /// Whether the times did not fit in memory.
    pub(super) is_without_times: bool,
}

impl Extent {
    /// Looks at the samples of a message; those of a block are told apart from others by a number.
    pub(super) fn see(&mut self, value: &Value, is_block: bool) {
        let digest = match value {
            Value::Number { value, .. } => self.see_all(std::iter::once(*value), is_block),
            Value::Array(samples) => self.see_all((0..samples.len()).map(|i| samples.get(i)), is_block),
            _ => return,
        };
        if is_block {
            self.digests.push(digest);
        }
    }

    fn see_all(&mut self, samples: impl ExactSizeIterator<Item = f64>, is_block: bool) -> u64 {
        /// FNV-1a, 64 bits at a time.
        const PRIME: u64 = 0x0100_0000_01b3;
        self.samples += samples.len();
        let (mut digest, mut was_finite) = (0xcbf2_9ce4_8422_2325_u64, true);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in samples {
            digest = (digest ^ value.to_bits()).wrapping_mul(PRIME);
            if is_number(value) {
                (low, high) = (low.min(value), high.max(value));
            }
            self.holes += usize::from(is_block && was_finite && !is_number(value));
            was_finite = is_number(value);
        }
        if low <= high {
            self.widen((low, high));
        }
        digest
    }

    fn widen(&mut self, (least, largest): (f64, f64)) {
        self.range =
            Some(self.range.map_or((least, largest), |(low, high)| (low.min(least), high.max(largest))));
    }

    /// Adds that of the messages that follow.
    pub(super) fn append(&mut self, mut more: Self) {
        self.samples += more.samples;
        more.range.into_iter().for_each(|range| self.widen(range));
        self.holes += more.holes;
        self.digests.append(&mut more.digests);
        self.is_without_times |= more.is_without_times;
    }
}
