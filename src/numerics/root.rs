//! A function to its first root.

/// First t in `0..=last` at which a function with |f″| ≤ `bound` comes down to zero, its value and slope
/// given by `f`.
///
/// From a point with value z and slope v it cannot reach zero before z + v s − bound s²/2 = 0: steps of that
/// s approach the first root from the left and never pass it. A start within `touch` of zero and rising is
/// left first.
pub fn first_root(f: impl Fn(f64) -> (f64, f64), bound: f64, last: f64, touch: f64) -> Option<f64> {
    let mut t = 0.0;
    // Each step gains at least √(2 touch / bound); the cap only guards against a wrong bound.
    for _ in 0..100_000 {
        if t > last {
            return None;
        }
        let (z, v) = f(t);
        // A slope this small reverses within `touch`.
        let falling = v < -(2.0 * bound * touch).sqrt();
        if z < -touch || (z <= touch && falling) {
            return Some(t);
        }
        t += if z > touch {
            (v + (v * v + 2.0 * bound * z).sqrt()) / bound
        } else {
            (2.0 * v / bound).max((2.0 * touch / bound).sqrt())
        };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_several_roots_is_taken() {
        // cos t + 0.2: roots at acos(−0.2) = 1.772…, then 4.511….
        let root = first_root(|t| (t.cos() + 0.2, -t.sin()), 1.0, 10.0, 1e-12).expect("a root");
        assert!((root - (-0.2_f64).acos()).abs() < 1e-11);
    }

    #[test]
    fn no_root_is_said() {
        assert!(first_root(|t| (t.cos() + 1.5, -t.sin()), 1.0, 10.0, 1e-12).is_none());
    }

    #[test]
    fn a_throw_from_the_ground_comes_down_again() {
        let root = first_root(|t| (3.0 * t - 5.0 * t * t, 3.0 - 10.0 * t), 10.0, 2.0, 1e-12).expect("a root");
        assert!((root - 0.6).abs() < 1e-9);
    }
}
