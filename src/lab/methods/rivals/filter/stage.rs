//! Samples through a recursive low-pass in one direction, in one of three forms of the same transfer function.

use crate::numerics::filter::stage::{Sample, StateVariable, constant};

/// One stage of a low-pass with gain 1 at frequency 0.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Stage<T> {
    /// y = Σ b x − Σ a y of any order, transposed direct form II.
    Transfer {
        /// Of the input, from z⁰ on.
        b: Vec<T>,
        /// Of the output, from z⁰ (1) on.
        a: Vec<T>,
    },
    /// The same of second order.
    Direct {
        /// Of the input, from z⁰ on.
        b: [T; 3],
        /// Of the output, from z⁻¹ on.
        a: [T; 2],
    },
    /// Two trapezoidal integrators (26).
    StateVariable(StateVariable<T>),
}

impl<T: Sample> Stage<T> {
    /// Second order in state-variable form, by g = tan(π f/f_s) and 2R.
    pub(super) fn state_variable(g: f64, damping: f64) -> Self {
        Self::StateVariable(StateVariable::new(g, damping))
    }

    /// Second order in direct form, by the same.
    pub(super) fn direct(g: f64, damping: f64) -> Self {
        let (b, a) = polynomials(g, damping);
        Self::Direct { b: b.map(constant), a: [constant(a[1]), constant(a[2])] }
    }

    /// Sections of g and the given dampings multiplied out to one fraction.
    pub(super) fn transfer(g: f64, dampings: &[f64]) -> Self {
        let (mut b, mut a) = (vec![1.0], vec![1.0]);
        for damping in dampings {
            let section = polynomials(g, *damping);
            b = product(&b, &section.0);
            a = product(&a, &section.1);
        }
        Self::Transfer { b: b.into_iter().map(constant).collect(), a: a.into_iter().map(constant).collect() }
    }

    /// Numbers that it remembers.
    pub(super) fn order(&self) -> usize {
        match self {
            Self::Transfer { a, .. } => a.len() - 1,
            Self::Direct { .. } | Self::StateVariable(_) => 2,
        }
    }

    /// What it remembers of an input that was `start` for ever.
    fn steady(&self, start: T) -> Vec<T> {
        match self {
            Self::StateVariable(_) => vec![T::zero(), start],
            Self::Direct { b, a } => {
                let second = (b[2] - a[1]) * start;
                vec![(b[1] - a[0]) * start + second, second]
            }
            Self::Transfer { b, a } => {
                // s_k = b_k x − a_k y + s_(k+1) with y = x.
                let mut state = vec![T::zero(); self.order()];
                let mut next = T::zero();
                for k in (1..a.len()).rev() {
                    next = (b[k] - a[k]) * start + next;
                    state[k - 1] = next;
                }
                state
            }
        }
    }

    /// The samples in the given order through it, from and to `state`.
    pub(super) fn run<'a>(&self, samples: impl Iterator<Item = &'a mut T>, state: &mut [T]) {
        match self {
            Self::StateVariable(integrators) => {
                let mut both = [state[0], state[1]];
                integrators.run(samples, &mut both);
                state.copy_from_slice(&both);
            }
            Self::Direct { b, a } => {
                let (mut s1, mut s2) = (state[0], state[1]);
                for x in samples {
                    let y = b[0] * *x + s1;
                    s1 = b[1] * *x - a[0] * y + s2;
                    s2 = b[2] * *x - a[1] * y;
                    *x = y;
                }
                (state[0], state[1]) = (s1, s2);
            }
            Self::Transfer { b, a } => {
                let last = state.len() - 1;
                for x in samples {
                    let y = b[0] * *x + state[0];
                    for k in 0..last {
                        state[k] = b[k + 1] * *x - a[k + 1] * y + state[k + 1];
                    }
                    state[last] = b[last + 1] * *x - a[last + 1] * y;
                    *x = y;
                }
            }
        }
    }
}

/// Every stage over all samples forward, then every stage back; started in the steady state of the first sample, or at rest.
pub(super) fn forward_and_back<T: Sample>(stages: &[Stage<T>], samples: &mut [T], steady: bool) {
    for stage in stages {
        let start = samples.first().copied().filter(|_| steady).unwrap_or_else(T::zero);
        stage.run(samples.iter_mut(), &mut stage.steady(start));
    }
    for stage in stages {
        let start = samples.last().copied().filter(|_| steady).unwrap_or_else(T::zero);
        stage.run(samples.iter_mut().rev(), &mut stage.steady(start));
    }
}

/// b and a of (1 + z⁻¹)² g² / ((1 + 2R g + g²) + 2 (g² − 1) z⁻¹ + (1 − 2R g + g²) z⁻²), a from 1 on.
fn polynomials(g: f64, damping: f64) -> ([f64; 3], [f64; 3]) {
    let scale = 1.0 / (1.0 + damping * g + g * g);
    let b = g * g * scale;
    ([b, 2.0 * b, b], [1.0, 2.0 * (g * g - 1.0) * scale, (1.0 - damping * g + g * g) * scale])
}

fn product(left: &[f64], right: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; left.len() + right.len() - 1];
    for (i, l) in left.iter().enumerate() {
        for (j, r) in right.iter().enumerate() {
            out[i + j] += l * r;
        }
    }
    out
}
