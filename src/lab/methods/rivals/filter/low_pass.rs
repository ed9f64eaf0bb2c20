//! A Butterworth low-pass of any even order forward and back, in any of its forms and with any continuation of the ends.

use super::ends::EndPadding;
use super::stage::{Stage, forward_and_back};
use super::{fourier, gustafsson};
use crate::numerics::filter::ends::cut;
use crate::numerics::filter::stage::Sample;
use std::f64::consts::PI;

/// Highest order of a pass: 20 poles within a factor of two of the cut-off are more than any recorder's filter has.
const MOST_ORDER: u32 = 20;

/// How a low-pass is computed; the transfer function is the same, the round-off is not.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum FilterForm {
    /// One fraction of the whole order, b over a, transposed direct form II.
    TransferFunction,
    /// Second-order sections in transposed direct form II.
    DirectSections,
    /// Second-order sections of two trapezoidal integrators (26).
    #[default]
    StateVariable,
    /// |H|² on the lines of the spectrum.
    Fourier,
}

impl FilterForm {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::TransferFunction, Self::DirectSections, Self::StateVariable, Self::Fourier];

    /// Its name.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::TransferFunction => "transfer function",
            Self::DirectSections => "direct-form sections",
            Self::StateVariable => "state-variable",
            Self::Fourier => "FFT",
        }
    }
}

/// Two passes of a Butterworth low-pass; [`crate::numerics::filter::ZeroPhaseLowPass`] is this of second order with both defaults.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    gain: f64,
    dampings: Vec<f64>,
    memory: usize,
    form: FilterForm,
    ends: EndPadding,
}

impl LowPass {
    /// By the order of one pass (even, 2 to 20) and its design frequency over the sample rate.
    ///
    /// `None` for another order, for a frequency that is not below half the rate, and for Gustafsson's ends in any but the
    /// state-variable form: the states of the others are so large that their small differences drown.
    #[must_use]
    pub fn new(order: u32, design_over_rate: f64, form: FilterForm, ends: EndPadding) -> Option<Self> {
        let known = order.is_multiple_of(2) && (2..=MOST_ORDER).contains(&order);
        let unfit = form != FilterForm::StateVariable && ends == EndPadding::Gustafsson;
        if !known || unfit || !(design_over_rate > 0.0 && design_over_rate < 0.5) {
            return None;
        }
        // Poles of a Butterworth of order n: 2R_i = 2 sin((2i + 1) π / 2n).
        let damping = |i: u32| 2.0 * (f64::from(2 * i + 1) * PI / f64::from(2 * order)).sin();
        let dampings: Vec<f64> = (0..order / 2).map(damping).collect();
        // The slowest pole decays as e^(−R 2π f t): 1e-6 of it is left after 2.2 / (R f).
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive and cut to the signal's length when used"
        )]
        let memory = (3.1 * 2.0_f64.sqrt() / (dampings[0] * design_over_rate)).ceil() as usize;
        Some(Self { gain: (PI * design_over_rate).tan(), dampings, memory, form, ends })
    }

    /// The filtered samples, computed in their own type.
    #[must_use]
    pub fn apply<T: Sample>(&self, samples: &[T]) -> Vec<T> {
        if samples.len() < 2 {
            return samples.to_vec();
        }
        let stages = self.stages::<T>();
        if self.ends == EndPadding::Gustafsson {
            return gustafsson::filtered(&stages, samples, self.memory);
        }
        let (mut work, mut head) = self.ends.extended(samples, self.memory);
        if self.form == FilterForm::Fourier {
            if self.ends == EndPadding::Zero {
                let nothing = vec![T::zero(); self.memory];
                work = [&nothing[..], &work, &nothing].concat();
                head = self.memory;
            }
            work = fourier::filtered(work, |warped| self.gain_at(warped));
        } else {
            forward_and_back(&stages, &mut work, self.ends != EndPadding::Zero);
        }
        cut(work, head, samples.len())
    }

    /// |H| of both passes at tan(π f/f_s): 1 / (1 + (tan(π f/f_s)/g)^2n).
    fn gain_at(&self, warped: f64) -> f64 {
        let order = i32::try_from(2 * self.dampings.len()).unwrap_or(i32::MAX);
        1.0 / (1.0 + (warped / self.gain).powi(2 * order))
    }

    fn stages<T: Sample>(&self) -> Vec<Stage<T>> {
        match self.form {
            FilterForm::TransferFunction => vec![Stage::transfer(self.gain, &self.dampings)],
            FilterForm::DirectSections => {
                self.dampings.iter().map(|d| Stage::direct(self.gain, *d)).collect()
            }
            FilterForm::StateVariable => {
                self.dampings.iter().map(|d| Stage::state_variable(self.gain, *d)).collect()
            }
            FilterForm::Fourier => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::filter::ZeroPhaseLowPass;

    /// A pulse in the middle of 4000 samples, 0 at both ends.
    fn pulse() -> Vec<f64> {
        let at = |i: i32| (-0.5 * (f64::from(i - 2000) / 60.0).powi(2)).exp();
        (0..4000).map(at).collect()
    }

    #[test]
    fn the_defaults_are_the_programs_filter() {
        let ours = LowPass::new(2, 0.004, FilterForm::default(), EndPadding::default()).unwrap();
        let programs = ZeroPhaseLowPass::with_design_hz(4.0, 1000.0).unwrap();
        let x: Vec<f64> = (0..3000).map(|i: i32| (f64::from(i) * 0.01).sin() + 0.1).collect();
        // 2 sin(π/4) and √2 differ by a rounding; so do the results.
        assert!(ours.apply(&x).iter().zip(programs.apply(&x)).all(|(a, b)| (a - b).abs() < 1e-13));
    }

    #[test]
    fn every_form_and_every_end_gives_the_same_away_from_the_ends() {
        let x = pulse();
        for order in [2, 4, 8] {
            let wanted = LowPass::new(order, 0.01, FilterForm::Fourier, EndPadding::Zero).unwrap().apply(&x);
            for form in FilterForm::ALL {
                for ends in EndPadding::ALL {
                    let Some(filter) = LowPass::new(order, 0.01, form, ends) else {
                        assert!(form != FilterForm::StateVariable && ends == EndPadding::Gustafsson);
                        continue;
                    };
                    let y = filter.apply(&x);
                    // A fraction of order 8: a coefficient of 70, rounded by 1.1e-16, over (2π 0.01)^8 = 2.4e-10; nine of them, two passes.
                    let bound = if form == FilterForm::TransferFunction { 6e-4 } else { 1e-10 };
                    let worst = y.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(worst < bound, "{order} {form:?} {ends:?}: {worst:e}");
                }
            }
        }
    }

    #[test]
    fn a_constant_passes_every_form_and_end_but_rest() {
        for form in FilterForm::ALL {
            for ends in [EndPadding::Odd, EndPadding::OddNine, EndPadding::Even, EndPadding::Gustafsson] {
                let Some(filter) = LowPass::new(4, 0.02, form, ends) else { continue };
                for count in [0, 1, 2, 3, 10, 1000] {
                    let y = filter.apply(&vec![7.0_f64; count]);
                    assert_eq!(y.len(), count);
                    // Fewer samples than states at both ends do not tell Gustafsson's states.
                    let told = ends != EndPadding::Gustafsson || count > 100;
                    // As above with order 4: 6 · 1.1e-16 / (2π 0.02)^4 = 3e-12 a coefficient and unit.
                    let worst = y.iter().map(|y| (y - 7.0).abs()).fold(0.0, f64::max);
                    // What Gustafsson's memory of 1e-6 leaves of either end meets where both are cut.
                    let bound = if ends == EndPadding::Gustafsson { 1e-5 } else { 1e-9 };
                    assert!(!told || worst < bound, "{form:?} {ends:?} {count}: {worst:e}");
                }
            }
        }
    }

    #[test]
    fn gustafsson_ends_do_not_depend_on_the_direction() {
        let x: Vec<f64> = (0..700).map(|i: i32| f64::from((i * 7919) % 1000) / 500.0 - 1.0).collect();
        let reversed: Vec<f64> = x.iter().rev().copied().collect();
        for design in [0.02, 0.002] {
            let filter = LowPass::new(2, design, FilterForm::StateVariable, EndPadding::Gustafsson).unwrap();
            let (y, z) = (filter.apply(&x), filter.apply(&reversed));
            // Left to find: what the memory of 1e-6 leaves, of samples up to 1.
            assert!(y.iter().zip(z.iter().rev()).all(|(a, b)| (a - b).abs() < 1e-5), "{design}");
        }
    }

    #[test]
    fn what_is_no_filter_is_refused() {
        let made = |order, design| LowPass::new(order, design, FilterForm::default(), EndPadding::Odd);
        assert!(made(3, 0.1).is_none() && made(0, 0.1).is_none() && made(22, 0.1).is_none());
        assert!(made(2, 0.5).is_none() && made(2, 0.0).is_none() && made(2, f64::NAN).is_none());
    }
}
