//! Samples through a second-order low-pass in one direction.

use rustfft::FftNum;
use rustfft::num_traits::ToPrimitive;

/// A number that samples are held and filtered in: f32 or f64.
pub trait Sample: FftNum + ToPrimitive {}

impl<T: FftNum + ToPrimitive> Sample for T {}

/// A constant in the arithmetic of the samples.
pub(crate) fn constant<T: Sample>(value: f64) -> T {
    T::from_f64(value).unwrap_or_else(T::zero)
}

/// A second-order low-pass with gain 1 at frequency 0: two trapezoidal integrators (26).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateVariable<T> {
    /// g (g + 2R) / (1 + g (g + 2R)).
    decay: T,
    /// g / (1 + g (g + 2R)).
    second: T,
    /// g times that.
    third: T,
}

impl<T: Sample> StateVariable<T> {
    /// By g = tan(π f/f_s) and 2R.
    pub(crate) fn new(g: f64, damping: f64) -> Self {
        let first = 1.0 / (1.0 + g * (g + damping));
        Self {
            decay: constant(g * (g + damping) * first),
            second: constant(g * first),
            third: constant(g * g * first),
        }
    }

    /// The samples in the given order through it, from and to the state of its integrators.
    pub(crate) fn run<'a>(&self, samples: impl Iterator<Item = &'a mut T>, state: &mut [T; 2])
    where
        T: 'a,
    {
        let two = constant::<T>(2.0);
        let Self { decay, second, third } = self;
        let [mut band, mut low] = *state;
        for x in samples {
            // Only what is added is rounded at its own size: 2 v1 − band and 2 v2 − low would round the states twice.
            let v3 = *x - low;
            let added = *second * band + *third * v3;
            band = band + two * (*second * v3 - *decay * band);
            *x = low + added;
            low = low + two * added;
        }
        *state = [band, low];
    }
}

/// All samples forward, then all back; each way started in the steady state of its first sample.
pub(super) fn forward_and_back<T: Sample>(stage: &StateVariable<T>, samples: &mut [T]) {
    let start = samples.first().copied().unwrap_or_else(T::zero);
    stage.run(samples.iter_mut(), &mut [T::zero(), start]);
    let start = samples.last().copied().unwrap_or_else(T::zero);
    stage.run(samples.iter_mut().rev(), &mut [T::zero(), start]);
}
