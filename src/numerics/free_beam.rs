//! Deflection of a mode of the free uniform beam at a position along it.

/// Shapes that [`shape`] knows.
pub const MOST_MODES: usize = 3;

/// Roots β of cosh β cos β = 1, one for each order: wave number times length of the free-free uniform beam.
pub const WAVE_NUMBERS: [f64; MOST_MODES] =
    [4.730_040_744_862_704, 7.853_204_624_095_838, 10.995_607_838_001_671];

/// Deflection of the mode of this order, from 1 on, at `share` of the length; ±2 at the ends, mean square 1,
/// so that its modal mass is the body's.
///
/// An order beyond the available shapes uses the last one.
pub fn shape(order: u8, share: f64) -> f64 {
    let beta = WAVE_NUMBERS[usize::from(order).clamp(1, MOST_MODES) - 1];
    let sigma = (beta.cosh() - beta.cos()) / (beta.sinh() - beta.sin());
    let at = beta * share;
    at.cosh() + at.cos() - sigma * (at.sinh() + at.sin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::quadrature::simpson;

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
