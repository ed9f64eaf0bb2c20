//! Numbers of either precision to one run of samples, and to what a listing shows of them: how many, and
//! their range.

use crate::data::{ListedChannel, Samples};
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

/// What a listing shows of samples that it need not hold.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Extent {
    pub(super) samples: usize,
    /// The least and the largest that is a number.
    pub(super) range: Option<(f64, f64)>,
}

impl Extent {
    pub(super) fn of(samples: &Samples) -> Self {
        let each = (0..samples.len()).map(|i| samples.get(i));
        Self { samples: samples.len(), range: ListedChannel::value_range(each) }
    }

    /// The extent of both together.
    pub(super) fn with(self, more: Option<&Self>) -> Self {
        let Some(more) = more else { return self };
        let ends = [self.range, more.range].into_iter().flatten().flat_map(<[f64; 2]>::from);
        Self { samples: self.samples + more.samples, range: ListedChannel::value_range(ends) }
    }
}
