//! Shape of a free beam's mode by its order, and the effect of shear and rotary inertia on it.

use super::free_beam::{MOST_MODES, WAVE_NUMBERS, shape};
use std::f64::consts::PI;

/// Wave number times length of the mode of any order from 1 on: β = (n + ½) π − (−1)ⁿ/cosh((n + ½) π) except
/// for the first three, within 1e-11.
pub fn wave_number(order: u8) -> f64 {
    let asymptote = (f64::from(order) + 0.5) * PI;
    let beyond = if order.is_multiple_of(2) { -1.0 } else { 1.0 } / asymptote.cosh();
    WAVE_NUMBERS.get(usize::from(order.max(1)) - 1).copied().unwrap_or(asymptote + beyond)
}

/// Like [`shape`] for any order: about the middle, u = share − ½, sines and hyperbolic sines each over its
/// value at the end. There the form of the first orders would be a difference of numbers of e^β.
pub fn high_shape(order: u8, share: f64) -> f64 {
    if usize::from(order) <= MOST_MODES {
        return shape(order, share);
    }
    let (half, at) = (wave_number(order) / 2.0, wave_number(order) * (share - 0.5));
    match order % 2 {
        1 => at.cos() / half.cos() + at.cosh() / half.cosh(),
        _ => -at.sin() / half.sin() - at.sinh() / half.sinh(),
    }
}

/// Effect of shear and rotary inertia on a mode (Timoshenko 1921), from a wave of its wave number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThickBeam {
    /// Frequency over that of the slender beam of the same bending stiffness.
    pub slowing: f64,
    /// Rotation of a section over the slope of the axis: the difference is shear.
    pub turning: f64,
}

impl ThickBeam {
    /// A beam with a rectangular section of `height` lengths; `shear` is E/(κG): with a = β² height²/12 and u
    /// the squared slowing, 1 − u (1 + a (1 + shear)) + shear a² u² = 0.
    pub fn new(order: u8, height: f64, shear: f64) -> Self {
        let a = (wave_number(order) * height).powi(2) / 12.0;
        let b = 1.0 + a * (1.0 + shear);
        let square = 2.0 / (b + (b * b - 4.0 * shear * a * a).sqrt());
        Self { slowing: square.sqrt(), turning: 1.0 - shear * a * square }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::quadrature::simpson;

    #[test]
    fn shapes_of_high_orders_are_as_those_of_low_ones() {
        assert!((wave_number(4) - 14.137_165_491_257_464).abs() < 1e-11);
        for order in 1..=12_u8 {
            assert!((high_shape(order, 0.0) - 2.0).abs() < 1e-9, "{order}");
            for other in 1..=12_u8 {
                let product = simpson(|x| high_shape(order, x) * high_shape(other, x), 0.0, 1.0, 4000);
                // Simpson on 4000 panels: (2 β)⁴ h⁴/180 of 4, 4e-9 at β of 40.
                assert!((product - f64::from(u8::from(order == other))).abs() < 1e-7, "{order} {other}");
            }
        }
    }

    #[test]
    fn a_thick_beam_is_slower_and_turns_less() {
        let slender = ThickBeam::new(1, 0.0, 3.0);
        assert_eq!(slender, ThickBeam { slowing: 1.0, turning: 1.0 });
        // ASTM E1876, 8.2: a bar four heights long, ν 0.3: f²/f∞² = 1/1.42. Its ends are not in a wave.
        let bar = ThickBeam::new(1, 0.25, 2.0 * 1.3 / (5.0 / 6.0));
        assert!((bar.slowing - (1.0 / 1.42_f64).sqrt()).abs() < 0.015, "{bar:?}");
        let high = ThickBeam::new(8, 0.25, 3.0);
        assert!(high.slowing < 0.3 && (0.0..0.2).contains(&high.turning), "{high:?}");
    }
}
