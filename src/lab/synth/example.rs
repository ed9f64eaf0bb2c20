//! Scenes for the tests of the simulation.

use crate::data::{Axis, Cask, Contact, Drop, End, block_inertia_kg_m2};
use crate::lab::data::{CrushableEnd, Scene, SceneChannel, SimulatedMotion};

/// The scene of `fixtures/examples/anf18-json`: ANF-18, 9 m, 15°, rough; its stiffnesses follow `crush_for`
/// of `fixtures/reference/simulate.py`.
pub(super) fn anf18() -> Scene {
    let (mass_kg, length_m, height_m, angle_rad) = (4466.0_f64, 5.512_f64, 0.792_f64, 15.0_f64.to_radians());
    let inertia_kg_m2 = block_inertia_kg_m2(mass_kg, length_m, height_m);
    let arm_m = length_m / 2.0 * angle_rad.cos();
    let effective_kg = 1.0 / (1.0 / mass_kg + arm_m * arm_m / inertia_kg_m2);
    let crush = |pulse_s: f64, k: f64| {
        let loading_n_m = effective_kg * (std::f64::consts::FRAC_PI_2 * (1.0 + k) / pulse_s).powi(2);
        CrushableEnd { loading_n_m, unloading_n_m: loading_n_m / (k * k), ..CrushableEnd::default() }
    };
    Scene {
        name: "ANF-18".to_owned(),
        seed: 1,
        cask: Cask::block("ANF-18", mass_kg, length_m, height_m),
        drop: Drop::from_height(9.0, angle_rad),
        contact: Contact::Rough,
        first_end: crush(5e-3, 0.55),
        second_end: crush(4e-3, 0.3),
        before_s: 0.1,
        after_s: 0.04,
        ..Scene::default()
    }
}

/// A channel with a perfect chain.
pub(super) fn channel(axis: Axis, position_m: f64, offset_m: f64) -> SceneChannel {
    SceneChannel {
        axis,
        offset_m,
        unit: "m/s^2".to_owned(),
        sample_rate_hz: 1e5,
        ..SceneChannel::perfect("A1", End::First, position_m)
    }
}

/// Place in the motion of the last state before `at_s`.
pub(super) fn just_before(motion: &SimulatedMotion, at_s: f64) -> usize {
    motion.count_before(|t| t < at_s).saturating_sub(1)
}
