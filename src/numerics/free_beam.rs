//! A mode of the free uniform beam and a place on it to its deflection there, and what shear and the inertia
//! of its sections make of the mode.

#[cfg(any(test, feature = "lab"))]
use std::f64::consts::PI;

/// Shapes that [`shape`] knows.
pub const MOST_MODES: usize = 3;

/// Roots β of cosh β cos β = 1, one for each order: wave number times length of the free-free uniform beam.
const WAVE_NUMBERS: [f64; MOST_MODES] =
    [4.730_040_744_862_704, 7.853_204_624_095_838, 10.995_607_838_001_671];

/// Deflection of the mode of this order, from 1 on, at `share` of the length; ±2 at the ends, mean square 1,
/// so that its modal mass is the body's.
///
/// An order beyond the shapes there are takes the last one.
pub fn shape(order: u8, share: f64) -> f64 {
    let beta = WAVE_NUMBERS[usize::from(order).clamp(1, MOST_MODES) - 1];
    let sigma = (beta.cosh() - beta.cos()) / (beta.sinh() - beta.sin());
    let at = beta * share;
    at.cosh() + at.cos() - sigma * (at.sinh() + at.sin())
}

#[cfg(any(test, feature = "lab"))]
/// Wave number times length of the mode of any order from 1 on: β = (n + ½) π − (−1)ⁿ/cosh((n + ½) π) but for
/// the first three, within 1e-11.
pub fn wave_number(order: u8) -> f64 {
    let asymptote = (f64::from(order) + 0.5) * PI;
    let beyond = if order.is_multiple_of(2) { -1.0 } else { 1.0 } / asymptote.cosh();
    WAVE_NUMBERS.get(usize::from(order.max(1)) - 1).copied().unwrap_or(asymptote + beyond)
}

#[cfg(any(test, feature = "lab"))]
/// [`shape`] of any order: about the middle, u = share − ½, sines and hyperbolic sines each over its value at
/// the end. There the form of the first orders would be a difference of numbers of e^β.
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

#[cfg(any(test, feature = "lab"))]
/// What shear and the inertia of the sections make of a mode (Timoshenko 1921): of a wave of its wave number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThickBeam {
    /// Frequency over that of the slender beam of the same bending stiffness.
    pub slowing: f64,
    /// How far a section turns over the slope of the axis: the rest is shear.
    pub turning: f64,
}

#[cfg(any(test, feature = "lab"))]
impl ThickBeam {
    /// Of a rectangular section of `height` lengths; `shear` is E/(κG): with a = β² height²/12 and u the
    /// squared slowing, 1 − u (1 + a (1 + shear)) + shear a² u² = 0.
    pub fn of(order: u8, height: f64, shear: f64) -> Self {
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
        let slender = ThickBeam::of(1, 0.0, 3.0);
        assert_eq!(slender, ThickBeam { slowing: 1.0, turning: 1.0 });
        // ASTM E1876, 8.2: a bar four heights long, ν 0.3: f²/f∞² = 1/1.42. Its ends are not in a wave.
        let bar = ThickBeam::of(1, 0.25, 2.0 * 1.3 / (5.0 / 6.0));
        assert!((bar.slowing - (1.0 / 1.42_f64).sqrt()).abs() < 0.015, "{bar:?}");
        let high = ThickBeam::of(8, 0.25, 3.0);
        assert!(high.slowing < 0.3 && (0.0..0.2).contains(&high.turning), "{high:?}");
    }

    #[test]
    fn shapes_are_two_at_the_ends_orthonormal_and_carry_no_rigid_motion() {
        for order in 1..=3_u8 {
            let end = if order % 2 == 1 { 2.0 } else { -2.0 };
            assert!((shape(order, 0.0) - 2.0).abs() < 1e-9);
            assert!((shape(order, 1.0) - end).abs() < 1e-9);
            // Simpson on 2000 panels: β⁴ h⁴/180 of a shape of size 2 is below 1e-8.
            assert!(simpson(|x| shape(order, x), 0.0, 1.0, 2000).abs() < 1e-8);
            assert!(simpson(|x| x * shape(order, x), 0.0, 1.0, 2000).abs() < 1e-8);
            for other in 1..=3_u8 {
                let product = simpson(|x| shape(order, x) * shape(other, x), 0.0, 1.0, 2000);
                let wanted = f64::from(u8::from(order == other));
                assert!((product - wanted).abs() < 1e-8, "{order} {other}: {product}");
            }
        }
    }
}
