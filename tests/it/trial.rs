//! The quick trial of filters, ends, integrals and cut-offs to its errors, held by bounds that theory gives.

use dropcheck::lab::data::{TrialPoint, TrialRequest};
use dropcheck::lab::methods::FAMILIES;
use std::sync::OnceLock;

/// The families whose methods turn samples into samples.
const WITHOUT_DROPS: [&str; 4] = ["filters", "record-ends", "integration", "cut-off"];

fn accuracy() -> &'static [TrialPoint] {
    static POINTS: OnceLock<Vec<TrialPoint>> = OnceLock::new();
    POINTS.get_or_init(|| {
        let families = FAMILIES.iter().filter(|family| WITHOUT_DROPS.contains(&family.0));
        families.flat_map(|family| family.1(&TrialRequest { quick: true, seed: 1 })).collect()
    })
}

fn points(family: &str, method: &str) -> Vec<&'static TrialPoint> {
    let wanted = |p: &&TrialPoint| p.family == family && p.method == method;
    let found: Vec<_> = accuracy().iter().filter(wanted).collect();
    assert!(!found.is_empty(), "{family}: {method}");
    found
}

fn point(family: &str, method: &str, class: &str) -> &'static TrialPoint {
    points(family, method).into_iter().find(|p| p.class == class).expect(class)
}

#[test]
fn the_state_variable_filter_keeps_thirteen_digits() {
    for p in points("filter", "state-variable") {
        // Round-off grows as the root of the samples in the memory, 3.1e5 at 1e-5: 560 · 1.1e-16 in each of two passes.
        assert!(p.p95_error < 1.2e-13, "{}: {:e}", p.class, p.p95_error);
    }
    // The accuracy that is asked for at 1e-5.
    let narrowest = point("filter", "state-variable", "order 2, f/fs = 1e-5").p95_error;
    assert!(narrowest <= 1e-13, "{narrowest:e}");
}

#[test]
fn direct_forms_lose_what_theory_says() {
    // (f_s / 2π f)² of 1.1e-16 at f/f_s = 1e-5 is 2.8e-8, give or take the luck of rounding: the reference tells forms apart.
    let section = point("filter", "direct-form sections", "order 2, f/fs = 1e-5").p95_error;
    assert!((1e-9..1e-6).contains(&section), "{section:e}");
    assert!(point("filter", "direct-form sections, f32", "order 2, f/fs = 1e-4").p95_error > 0.01);
}

#[test]
fn the_corrected_trapezoid_follows_pulses() {
    let of = |class| point("integration", "corrected trapezoid", class).p95_error;
    // sin⁴ of T = 8 ms: the slopes are off by h²/6 of the third derivative, at most 12 (π/T)³; times h²/12, of 3/8 T: 2.6e-7
    // at 10 kHz. Euler's and Maclaurin's next term, h⁴/720 of it, and the start of the record add less than a half.
    assert!(of("smooth pulse, 10 kHz") < 4e-7, "{:e}", of("smooth pulse, 10 kHz"));
    assert!(of("smooth pulse, 100 kHz") < 4e-11, "{:e}", of("smooth pulse, 100 kHz"));
    // A kink of slope π/T between two samples: at most h²/8 of it, of the step 2T/π: 0.62 (h/T)².
    assert!(of("kinked pulse, 10 kHz") < 1e-4, "{:e}", of("kinked pulse, 10 kHz"));
    assert!(of("kinked pulse, 100 kHz") < 1e-6, "{:e}", of("kinked pulse, 100 kHz"));
    // The plain trapezoid loses h²/12 of the slope, 1.3 π/T, of 3/8 T: 6e-5. The class tells rules apart.
    let plain = point("integration", "trapezoid", "smooth pulse, 10 kHz").p95_error;
    assert!((1e-5..2e-4).contains(&plain), "{plain:e}");
}

#[test]
fn even_reflection_and_gustafsson_leave_the_filters_own_noise_at_the_ends() {
    for method in ["even", "Gustafsson"] {
        let p = point("record ends", method, "noise");
        // What an end adds is noise of about the filter's own size; over a quarter of 1/f it is one normal value at each end.
        assert!(p.median_error < 1.0 && p.p95_error < 2.5, "{method}: {} {}", p.median_error, p.p95_error);
    }
    // Odd reflection pins the end sample: noise of 1/√(2 · 0.833 f/f_s) = 24.5 of the filter's own, one normal value at each end:
    // their root mean square has a median of 0.83 of that, and the pin is let go over the quarter of 1/f.
    let odd = point("record ends", "odd", "noise").median_error;
    assert!((8.0..25.0).contains(&odd), "{odd}");
}

#[test]
fn sums_of_doubles_lose_nothing_that_matters() {
    let of = |method| point("integration", method, "smooth pulse on an offset, 1e6 samples").p95_error;
    // 1e6 roundings of 1.1e-16 at most, of a sum that grows to 1.
    assert!(of("corrected trapezoid") < 1.2e-10 && of("trapezoid") < 1.2e-10);
    // Parts of 1e-6 are added to a sum near 1 in steps of 6e-8: each is off by up to 3 %.
    assert!(of("trapezoid, f32") > 1e-4, "{:e}", of("trapezoid, f32"));
}

#[test]
fn the_default_cutoff_keeps_the_peak_of_any_pulse() {
    let of = |method| point("cut-off", method, "4.5 t, pulse of 1 ms alone").p95_error;
    // 3/T keeps a half sine's peak within 1 %   (28)
    assert!(of("larger of mass and pulse") < 0.01, "{:e}", of("larger of mass and pulse"));
    assert!(of("CFC 60") > 0.1);
}
