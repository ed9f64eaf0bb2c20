//! The filter to its errors, held by bounds that theory gives.

use dropcheck::stages::LowPass;
use std::f64::consts::{PI, SQRT_2};

#[test]
fn the_filter_keeps_thirteen_digits_of_sines() {
    for design in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let filter = LowPass::with_design_hz(design, 1.0).expect("a design frequency below the rate's half");
        // e^(−R 2π f t) = 1e-16 after 5.9 / (R f), R = sin 45°; half as much again where the frequency axis
        // is warped.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of samples")]
        let silence = (9.0 * SQRT_2 / design) as u32;
        let gain = (PI * design).tan();
        // |H|² = 1/(1 + (tan(π f/f_s)/g)⁴) of both passes together.
        let sines = [1.0 / 3.0, 1.0, 3.0].map(|times: f64| {
            let share = times * design;
            (share, 1.0 / (1.0 + ((PI * share).tan() / gain).powi(4)))
        });
        let sum = |i: u32, left: bool| -> f64 {
            // Turns are taken off before the multiplication.
            let sine = |share: f64| (2.0 * PI * (share * f64::from(i)).fract() + 1.0).sin();
            sines.iter().map(|(share, kept)| if left { kept * sine(*share) } else { sine(*share) }).sum()
        };
        let count = 3 * silence;
        let filtered = filter.apply(&(0..count).map(|i| sum(i, false)).collect::<Vec<_>>());
        let off = |i: u32| (filtered[i as usize] - sum(i, true)).abs();
        let worst = (silence..2 * silence).map(off).fold(0.0, f64::max);
        // Round-off grows as the root of the samples in the memory, 3.1e5 at 1e-5: 560 · 1.1e-16 in each of
        // two passes. A product of up to 115 turns is rounded by 7e-15 of one: 4.5e-14 of each of three
        // sines.
        assert!(worst < 3e-13, "f/fs = {design:e}: {worst:e}");
    }
}
