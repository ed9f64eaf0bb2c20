//! A drop that grows harder to tell to its plan.

use super::{BendingMode, COMMON, Stress};

/// A flight shows so many periods of a mode that has to be told by itself.
const CLEAR_PERIODS: f64 = 3.0;

pub(in super::super) const DROPS: &[Stress] = &[
    Stress {
        name: "mode-frequency",
        title: "A strong bending mode that grows as slow as the flight",
        axis: "periods of the mode in the flight",
        values: &[8.0, 5.0, 3.0, 2.0, 1.5, 1.2, 1.0, 0.8, 0.7, 0.6, 0.5, 0.35, 0.2],
        tells_k: true,
        apply: |plan, facts, periods| plan.modes = vec![mode(1, periods / facts.flight_s, 0.03)],
        ..COMMON
    },
    Stress {
        name: "damping",
        title: "A strong bending mode with little damping",
        axis: "share of critical damping",
        values: &[0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4],
        apply: |plan, facts, damping| plan.modes = vec![mode(1, CLEAR_PERIODS / facts.flight_s, damping)],
        ..COMMON
    },
    Stress {
        name: "close-modes",
        title: "Two strong bending modes that grow alike in frequency",
        axis: "difference of their frequencies, %",
        values: &[100.0, 70.0, 50.0, 30.0, 20.0, 15.0, 10.0, 7.0, 5.0, 3.0, 2.0, 1.0, 0.1],
        apply: |plan, facts, percent| {
            let frequency_hz = CLEAR_PERIODS / facts.flight_s;
            plan.modes =
                vec![mode(1, frequency_hz, 0.03), mode(2, frequency_hz * (1.0 + percent / 100.0), 0.03)];
        },
        ..COMMON
    },
    Stress {
        name: "mode-strength",
        title: "A bending mode that grows stronger than a uniform beam's",
        axis: "strength over that of the uniform beam",
        values: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0],
        apply: |plan, facts, strength| {
            plan.modes = vec![BendingMode { strength, ..mode(1, CLEAR_PERIODS / facts.flight_s, 0.03) }];
        },
        ..COMMON
    },
    Stress {
        name: "k-small",
        title: "k towards 0",
        axis: "k",
        values: &[0.5, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01, 5e-3, 2e-3, 1e-3],
        tells_k: true,
        apply: |plan, _, k| plan.k = k,
        ..COMMON
    },
    Stress {
        name: "k-large",
        title: "k towards 1",
        axis: "1 − k",
        values: &[0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01, 5e-3, 1e-3],
        tells_k: true,
        apply: |plan, _, below| plan.k = 1.0 - below,
        ..COMMON
    },
    Stress {
        name: "pulse",
        title: "A first contact that grows long",
        axis: "length of the first contact, ms",
        values: &[0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 40.0],
        apply: |plan, _, ms| plan.pulse_s = 1e-3 * ms,
        ..COMMON
    },
    Stress {
        name: "angle-small",
        title: "Drop angle towards 0°",
        axis: "drop angle, degrees",
        values: &[15.0, 10.0, 7.0, 5.0, 4.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.7, 0.5, 0.3],
        apply: |plan, _, degrees| plan.angle_deg = degrees,
        ..COMMON
    },
    Stress {
        name: "angle-large",
        title: "Drop angle through 35.3° and 54.7° towards 90°",
        axis: "drop angle, degrees",
        is_log: false,
        values: &[20.0, 25.0, 30.0, 35.3, 40.0, 45.0, 54.7, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0],
        tells_k: true,
        apply: |plan, _, degrees| plan.angle_deg = degrees,
    },
    Stress {
        name: "recontact",
        title: "Steep drops with k = 0.1: from 52 to 70° on, by the cask, the first end lands again",
        axis: "drop angle, degrees",
        is_log: false,
        values: &[45.0, 48.0, 50.0, 52.0, 54.0, 55.0, 56.0, 57.0, 58.0, 60.0, 62.0, 65.0, 70.0],
        apply: |plan, _, degrees| {
            plan.k = 0.1;
            plan.angle_deg = degrees;
        },
        ..COMMON
    },
];

/// A mode as strong as the uniform beam's.
fn mode(order: u8, frequency_hz: f64, damping: f64) -> BendingMode {
    BendingMode { order, frequency_hz, damping, strength: 1.0 }
}
