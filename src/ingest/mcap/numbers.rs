//! Numbers of either precision to one run of samples.

use crate::data::Samples;
use crate::numerics::single;

/// One more number; single precision as long as all are narrow.
pub(super) fn push(samples: &mut Samples, value: f64, is_narrow: bool) {
    match samples {
        Samples::F32(narrow) if is_narrow => narrow.push(single(value)),
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
