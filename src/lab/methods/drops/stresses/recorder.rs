//! A fault of sensor, cable or recorder, growing, to the plan that has it.

use super::{COMMON, STANDARD_GRAVITY_M_S2, Stress};
use crate::lab::data::Chain;

pub(in super::super) const RECORDER: &[Stress] = &[
    Stress {
        name: "noise",
        title: "White noise on both channels",
        axis: "RMS of the noise, g",
        values: &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0],
        tells_k: true,
        apply: |plan, _, g| plan.each_chain(|c| c.white_noise_m_s2 = g * STANDARD_GRAVITY_M_S2),
        ..COMMON
    },
    Stress {
        name: "rate",
        title: "Few samples: a slow recorder with its anti-alias filter at a third of the rate",
        axis: "samples in the first contact",
        values: &[200.0, 150.0, 100.0, 60.0, 40.0, 25.0, 15.0, 10.0, 7.0, 5.0, 4.0, 3.0, 2.0],
        tells_k: true,
        apply: |plan, facts, samples| {
            let rate_hz = samples / facts.contact_s;
            plan.rate_hz = rate_hz;
            plan.each_chain(|c| c.anti_alias_hz = Some(rate_hz / 3.0));
        },
        ..COMMON
    },
    Stress {
        name: "zero-shift-first",
        title: "Zero shift of the first end's channel over the first contact",
        axis: "shift, % of the channel's peak",
        values: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0],
        tells_k: true,
        apply: |plan, facts, percent| plan.chains[0].zero_shift_m_s2 = percent / 100.0 * facts.peak_m_s2,
        ..COMMON
    },
    Stress {
        name: "zero-shift-second",
        title: "Zero shift of the second end's channel over the first contact",
        axis: "shift, % of the first channel's peak",
        values: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0],
        apply: |plan, facts, percent| plan.chains[1].zero_shift_m_s2 = -percent / 100.0 * facts.peak_m_s2,
        ..COMMON
    },
    Stress {
        name: "skew-late",
        title: "Second end's channel stamped late",
        axis: "delay, ms",
        values: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0],
        tells_k: true,
        apply: |plan, _, ms| plan.chains[1].skew_s = 1e-3 * ms,
        ..COMMON
    },
    Stress {
        name: "skew-early",
        title: "Second end's channel stamped early",
        axis: "advance, ms",
        values: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0],
        apply: |plan, _, ms| plan.chains[1].skew_s = -1e-3 * ms,
        ..COMMON
    },
    Stress {
        name: "gap-flight",
        title: "Samples of the first end's channel lost in the flight",
        axis: "share of the flight, %",
        is_log: false,
        values: &[1.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 95.0, 98.0, 100.0],
        apply: |plan, facts, percent| {
            let middle_s = facts.slap_s - 0.5 * facts.flight_s;
            lose(&mut plan.chains[0], plan.before_s + middle_s, percent / 100.0 * facts.flight_s);
        },
        ..COMMON
    },
    Stress {
        name: "gap-contact",
        title: "Samples of the first end's channel lost in the first contact",
        axis: "share of the contact, %",
        values: &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 70.0, 100.0],
        apply: |plan, facts, percent| {
            let middle_s = plan.before_s + 0.5 * facts.contact_s;
            lose(&mut plan.chains[0], middle_s, percent / 100.0 * facts.contact_s);
        },
        ..COMMON
    },
    Stress {
        name: "dropout-contact",
        title: "First end's channel held at its last value in the first contact",
        axis: "share of the contact, %",
        values: &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 70.0, 100.0],
        apply: |plan, facts, percent| {
            // Past the peak, where a held value does not look like a flat top.
            let from_s = plan.before_s + 0.6 * facts.contact_s;
            plan.chains[0].dropouts_s.push((from_s, from_s + percent / 100.0 * facts.contact_s));
        },
        ..COMMON
    },
    Stress {
        name: "clipped",
        title: "First end's channel cut off at its full scale",
        axis: "share of the peak cut off, %",
        values: &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0, 95.0],
        tells_k: true,
        apply: |plan, facts, percent| {
            plan.chains[0].full_scale_m_s2 = Some((1.0 - percent / 100.0) * facts.peak_m_s2);
        },
        ..COMMON
    },
    Stress {
        name: "hum",
        title: "Mains hum of 50 Hz on both channels",
        axis: "amplitude, g",
        values: &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0],
        apply: |plan, _, g| plan.each_chain(|c| c.hum = Some((g * STANDARD_GRAVITY_M_S2, 50.0))),
        ..COMMON
    },
    Stress {
        name: "ac-coupling",
        title: "AC coupling of both channels that the cask file does not state",
        axis: "corner frequency, Hz",
        values: &[1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0],
        apply: |plan, _, hz| {
            plan.each_chain(|c| c.ac_time_constant_s = Some(1.0 / (std::f64::consts::TAU * hz)));
        },
        ..COMMON
    },
    Stress {
        name: "record-end",
        title: "Record that ends soon after the slap-down",
        axis: "record after the slap-down, ms",
        values: &[50.0, 20.0, 10.0, 7.0, 5.0, 3.0, 2.0, 1.5, 1.0, 0.7, 0.5, 0.3, 0.1],
        apply: |plan, _, ms| plan.after_s = 1e-3 * ms,
        ..COMMON
    },
    Stress {
        name: "record-start",
        title: "Record that begins shortly before first contact",
        axis: "record before first contact, ms",
        values: &[200.0, 100.0, 50.0, 30.0, 20.0, 15.0, 10.0, 7.0, 5.0, 3.0, 2.0, 1.0, 0.5],
        apply: |plan, _, ms| {
            plan.before_s = 1e-3 * ms;
            // An offset that only the free fall can tell.
            plan.each_chain(|c| c.offset_m_s2 = 0.5 * STANDARD_GRAVITY_M_S2);
        },
        ..COMMON
    },
];

/// The recorder loses `length_s` about `middle_s` after the first sample.
fn lose(chain: &mut Chain, middle_s: f64, length_s: f64) {
    chain.gaps_s.push((middle_s - 0.5 * length_s, middle_s + 0.5 * length_s));
}
