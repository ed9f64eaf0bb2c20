//! A function to its root, bracketed or first, by a method that is named.

use crate::numerics::root::first_root;

/// Root of `f` in `low..high` by bisection to the last bit; `None` where the ends do not differ in sign.
pub fn bisect(f: impl Fn(f64) -> f64, low: f64, high: f64) -> Option<f64> {
    let (mut a, mut b) = (low, high);
    let sign_a = f(a) > 0.0;
    if sign_a == (f(b) > 0.0) {
        return None;
    }
    // 2^-64 of the bracket is below the spacing of doubles in it.
    for _ in 0..64 {
        let mid = f64::midpoint(a, b);
        if (f(mid) > 0.0) == sign_a { a = mid } else { b = mid }
    }
    Some(f64::midpoint(a, b))
}

/// How the first root of a function with a bounded second derivative is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RootMethod {
    /// Steps proved too short to pass a root: `first_root`.
    #[default]
    March,
    /// Halving what lies between the start and the last time: [`bisect`].
    Bisection,
    /// The same bracket by [`itp`].
    Itp,
    /// Newton's steps from where the march would step first.
    Newton,
}

impl RootMethod {
    /// All, the default first.
    pub const ALL: [Self; 4] = [Self::March, Self::Bisection, Self::Itp, Self::Newton];

    /// Its name for a person.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::March => "march",
            Self::Bisection => "bisection",
            Self::Itp => "ITP",
            Self::Newton => "Newton",
        }
    }
}

/// The root that `method` finds of what `first_root` is asked for; only the march promises that it is the first, or that there is none.
pub fn root_by(
    method: RootMethod,
    f: impl Fn(f64) -> (f64, f64),
    bound: f64,
    last: f64,
    touch: f64,
) -> Option<f64> {
    // Newton and the brackets begin where a function that starts at zero and rises has left it.
    let start = || {
        let (z, v) = f(0.0);
        if z > touch { 0.0 } else { (2.0 * v / bound).max((2.0 * touch / bound).sqrt()) }
    };
    match method {
        RootMethod::March => {
            let found = first_root(&f, bound, last, touch)?;
            let (z, v) = f(found);
            Some(if v < -(2.0 * bound * touch).sqrt() { found - z / v } else { found })
        }
        RootMethod::Bisection => bisect(|t| f(t).0, start(), last),
        RootMethod::Itp => itp(|t| f(t).0, start(), last, last * f64::EPSILON),
        RootMethod::Newton => {
            let begun = start();
            let (z, v) = f(begun);
            let guess = begun + (v + (v * v + 2.0 * bound * z.max(0.0)).sqrt()) / bound;
            newton(f, guess).filter(|root| (0.0..=last).contains(root))
        }
    }
}

/// Root of `f` in `low..high` to `tolerance` by interpolation, truncation and projection (Oliveira & Takahashi 2020, κ₁ = 0.2/(high − low),
/// κ₂ = 2, n₀ = 1): never more than one step above bisection; `None` where the ends do not differ in sign.
pub fn itp(f: impl Fn(f64) -> f64, low: f64, high: f64, tolerance: f64) -> Option<f64> {
    let (mut a, mut b) = (low, high);
    let (mut ya, mut yb) = (f(a), f(b));
    if (ya > 0.0) == (yb > 0.0) {
        return None;
    }
    let truncation = 0.2 / (b - a);
    let mut reach = tolerance * ((b - a) / tolerance).log2().ceil().exp2();
    while b - a > 2.0 * tolerance && reach > 0.0 {
        let middle = f64::midpoint(a, b);
        let secant = (yb * a - ya * b) / (yb - ya);
        let towards = (middle - secant).signum();
        let step = truncation * (b - a).powi(2);
        let truncated = if step <= (middle - secant).abs() { secant + towards * step } else { middle };
        let radius = (reach - 0.5 * (b - a)).max(0.0);
        let t = if (truncated - middle).abs() <= radius { truncated } else { middle - towards * radius };
        let y = f(t);
        if (y > 0.0) == (yb > 0.0) {
            (b, yb) = (t, y);
        } else {
            (a, ya) = (t, y);
        }
        reach *= 0.5;
    }
    Some(f64::midpoint(a, b))
}

/// Root by Newton's steps from `start`, value and slope given by `f`; `None` where they do not settle.
pub fn newton(f: impl Fn(f64) -> (f64, f64), start: f64) -> Option<f64> {
    let mut t = start;
    // Near a simple root six steps reach the last digit from one right digit; a start that needs more than 40 is lost.
    for _ in 0..40 {
        let (z, v) = f(t);
        let step = z / v;
        t -= step;
        if step.abs() <= 4.0 * f64::EPSILON * t.abs() {
            return Some(t);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisection_finds_the_root_of_two() {
        let root = bisect(|x| x * x - 2.0, 0.0, 2.0).expect("a bracket");
        assert!((root - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!(bisect(|x| x * x + 1.0, 0.0, 2.0).is_none());
    }

    /// Height 2 m, rising at 3 m/s, under 9.81 m/s²: a parabola, whose root is known in closed form.
    #[test]
    fn every_method_finds_the_root_of_a_throw() {
        let throw = |t: f64| (2.0 + 3.0 * t - 4.905 * t * t, 3.0 - 9.81 * t);
        let exact = (3.0 + (9.0_f64 + 8.0 * 4.905).sqrt()) / 9.81;
        for method in RootMethod::ALL {
            let root = root_by(method, throw, 9.81, 2.0, 1e-9).expect("a root");
            // Heights are rounded to 4e-16 of some metres, the slope there is −7 m/s.
            assert!((root - exact).abs() < 1e-15, "{method:?}: {}", root - exact);
        }
    }

    #[test]
    fn brackets_may_find_a_later_root_and_the_march_does_not() {
        // cos t + 0.2 over three roots: 1.772…, 4.511…, 8.055….
        let wave = |t: f64| (t.cos() + 0.2, -t.sin());
        let first = (-0.2_f64).acos();
        let found = |method| root_by(method, wave, 1.0, 9.5, 1e-12).expect("a root");
        assert!((found(RootMethod::March) - first).abs() < 1e-14);
        for method in [RootMethod::Bisection, RootMethod::Itp] {
            assert!(wave(found(method)).0.abs() < 1e-14);
        }
        assert!(found(RootMethod::Bisection) > first + 1.0);
    }

    #[test]
    fn no_method_invents_a_root() {
        let above = |t: f64| (t.cos() + 1.5, -t.sin());
        for method in RootMethod::ALL {
            assert_eq!(root_by(method, above, 1.0, 10.0, 1e-12), None, "{method:?}");
        }
    }
}
