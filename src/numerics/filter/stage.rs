//! Samples through a second-order low-pass in one direction.

/// A second-order low-pass with gain 1 at frequency 0: two trapezoidal integrators (26).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateVariable {
    /// g (g + 2R) / (1 + g (g + 2R)).
    decay: f64,
    /// g / (1 + g (g + 2R)).
    second: f64,
    /// g times that.
    third: f64,
}

impl StateVariable {
    /// By g = tan(π f/f_s) and 2R.
    pub(crate) fn new(g: f64, damping: f64) -> Self {
        let first = 1.0 / (1.0 + g * (g + damping));
        Self { decay: g * (g + damping) * first, second: g * first, third: g * g * first }
    }

    /// The samples in the given order through it, from and to the state of its integrators.
    pub(crate) fn run<'a>(&self, samples: impl Iterator<Item = &'a mut f64>, state: &mut [f64; 2]) {
        let Self { decay, second, third } = *self;
        let [mut band, mut low] = *state;
        for x in samples {
            // Only what is added is rounded at its own size: 2 v1 − band and 2 v2 − low would round the states twice.
            let v3 = *x - low;
            let added = second * band + third * v3;
            band += 2.0 * (second * v3 - decay * band);
            *x = low + added;
            low += 2.0 * added;
        }
        *state = [band, low];
    }
}

/// All samples forward, then all back; each way started in the steady state of its first sample.
pub(crate) fn forward_and_back(stage: &StateVariable, samples: &mut [f64]) {
    let start = samples.first().copied().unwrap_or(0.0);
    stage.run(samples.iter_mut(), &mut [0.0, start]);
    let start = samples.last().copied().unwrap_or(0.0);
    stage.run(samples.iter_mut().rev(), &mut [0.0, start]);
}
