//! Made-up answers of known delay to the delay that is found.

use super::*;
use crate::data::example::{self, noise};
use std::f64::consts::{PI, TAU};

/// Response of the remaining body to a half sine of 5 ms from 20 ms on: its rigid share and one mode driven
/// by the force.
fn answer(rate_hz: f64, contact_s: f64, rigid: f64, bending: f64, seed: u64) -> Vec<f64> {
    driven(rate_hz, contact_s, (rigid, bending), seed, &|_| 1.0)
}

/// Response to a share of the force that `part` gives by the time since first contact.
fn driven(
    rate_hz: f64,
    contact_s: f64,
    (rigid, bending): (f64, f64),
    seed: u64,
    part: &dyn Fn(f64) -> f64,
) -> Vec<f64> {
    let (omega, damping, fine) = (TAU * 70.0, 0.03, 20_u32);
    let step_s = 1.0 / (rate_hz * f64::from(fine));
    let (mut q, mut v, mut out) = (0.0, 0.0, Vec::new());
    for i in 0..8000_u32 {
        let t = f64::from(i) / rate_hz - contact_s;
        let half_sine =
            |t: f64| if (0.0..0.005).contains(&t) { 3000.0 * (PI * t / 0.005).sin() } else { 0.0 };
        let force = |t: f64| part(t) * half_sine(t);
        let pull = |t: f64, q: f64, v: f64| force(t) - 2.0 * damping * omega * v - omega * omega * q;
        if t > 0.06 {
            break;
        }
        out.push(rigid * force(t) + bending * pull(t, q, v) + 0.5 * noise(i, seed));
        for n in 0..fine {
            let a = pull(t + f64::from(n) * step_s, q, v);
            v += a * step_s;
            q += v * step_s;
        }
    }
    out
}

fn signal(name: &str, end: End, force_m_s2: Vec<f64>) -> Signal {
    Signal {
        name: name.into(),
        end,
        position_m: if end == End::First { 0.2 } else { 5.3 },
        noise_m_s2: 0.5,
        free_fall_s: 0.02,
        ..example::signal(1e4, force_m_s2)
    }
}

fn found(rigid: f64, bending: f64, late_s: f64) -> Option<Onset> {
    let first = signal("A1", End::First, answer(1e4, 0.020_03, 1.0, 0.5, 1));
    let second = signal("A2", End::Second, answer(1e4, 0.020_03 + late_s, rigid, bending, 2));
    answers(&[first, second], 0.020_03).pop()
}

#[test]
fn a_body_answers_at_once() {
    for (rigid, bending) in [(-0.5, 0.0), (-0.5, 0.9), (-0.5, 0.3), (0.2, 0.2)] {
        let onset = found(rigid, bending, 0.0).expect("an answer");
        // A tenth of a sample beside twice what is claimed.
        assert!(onset.delay_s.abs() < 2.0 * onset.u_s + 1e-5, "{rigid} {bending}: {onset:?}");
        assert!(onset.u_s < 1.5e-4, "{onset:?}");
    }
}

#[test]
fn a_late_or_early_clock_is_measured_finer_than_a_third_of_a_millisecond() {
    for late_s in [-3.2e-3, -4.5e-4, 3.7e-4, 2e-3] {
        let onset = found(-0.5, 0.9, late_s).expect("an answer");
        assert!((onset.delay_s - late_s).abs() < 1e-4, "{late_s}: {onset:?}");
        assert!(onset.u_s < 1.5e-4, "{onset:?}");
    }
}

#[test]
fn a_force_that_turns_its_direction_at_first_is_no_clock() {
    // While L slides back for 0.25 ms, friction takes the answer of the first end away and adds to that of
    // the second.
    let holds = |t: f64| 1.0 / (1.0 + ((2.5e-4 - t) / 1e-4).exp());
    let rate_hz = 5e4;
    let first = driven(rate_hz, 0.020_03, (1.0, 0.3), 1, &holds);
    let held = driven(rate_hz, 0.020_03, (-0.5, 0.9), 2, &holds);
    let slid = driven(rate_hz, 0.020_03, (0.3, 0.0), 3, &|t| 1.0 - holds(t));
    let second = held.iter().zip(&slid).map(|(a, b)| a + b).collect();
    let at_rate =
        |name, end, force| Signal { sample_rate_hz: rate_hz, noise_m_s2: 0.7, ..signal(name, end, force) };
    let both = [at_rate("A1", End::First, first), at_rate("A2", End::Second, second)];
    let onset = answers(&both, 0.020_14).pop().expect("an answer");
    assert!(onset.delay_s.abs() <= 2.0 * onset.u_s + 3e-5, "{onset:?}");
}

#[test]
fn recorders_of_different_rates_are_compared_over_the_same_times() {
    for (cause_hz, answer_hz) in [(1e4, 2e5), (2e5, 1e4), (2e5, 2e5)] {
        for late_s in [0.0, 3.7e-4] {
            let of_rate =
                |name, end, rate_hz, force| Signal { sample_rate_hz: rate_hz, ..signal(name, end, force) };
            let cause = answer(cause_hz, 0.020_03, 1.0, 0.5, 1);
            let first = of_rate("A1", End::First, cause_hz, cause);
            let late = answer(answer_hz, 0.020_03 + late_s, -0.5, 0.9, 2);
            let second = of_rate("A2", End::Second, answer_hz, late);
            let onset = answers(&[first, second], 0.020_03).pop().expect("an answer");
            assert!((onset.delay_s - late_s).abs() < 1e-4, "{cause_hz} {answer_hz} {late_s}: {onset:?}");
        }
    }
}

#[test]
fn a_record_that_ends_with_the_contact_is_no_fault() {
    let cut = |name, end, rate_hz: f64| {
        let mut force = answer(rate_hz, 0.020_03, 1.0, 0.5, 1);
        force.truncate(force.iter().position(|f| f.abs() > 500.0).expect("a pulse"));
        Signal { sample_rate_hz: rate_hz, ..signal(name, end, force) }
    };
    for rates_hz in [(1e4, 2e5), (2e5, 1e4)] {
        let both = [cut("A1", End::First, rates_hz.0), cut("A2", End::Second, rates_hz.1)];
        assert!(answers(&both, 0.020_03).len() <= 1);
    }
}

#[test]
fn an_answer_that_begins_below_the_noise_claims_no_delay() {
    // Rigid body and bending cancel at first: the answer starts as the square of time.
    let onset = found(-0.05, 0.05, 0.0);
    assert!(onset.as_ref().is_none_or(|o| o.delay_s.abs() < 2.0 * o.u_s + 1e-5), "{onset:?}");
}

#[test]
fn a_sensor_at_the_centre_of_percussion_says_nothing() {
    assert_eq!(found(0.001, 0.0, 0.0), None);
    assert_eq!(answers(&[], 0.02), vec![]);
}
