//! Simulated drops of elastic bodies to the balances and limits that they must meet.

use super::super::body::SceneBody;
use super::super::example::{anf18, channel, just_before};
use super::super::{simulate, specific_force_m_s2};
use super::*;
use crate::data::{Axis, Contact};
use crate::lab::data::{ElasticBody, LooseMass, SceneChannel, SimulatedMotion};
use std::f64::consts::TAU;

/// ANF-18, elastic, frictionless.
fn scene(first_bending_hz: f64, damping: f64) -> Scene {
    let elastic = Some(ElasticBody { first_bending_hz, damping });
    Scene { elastic, contact: Contact::Smooth, ..anf18() }
}

/// The whole state at step `i`.
fn state(motion: &SimulatedMotion, i: usize) -> Vec<f64> {
    let count = motion.modes.len() / motion.steps.len();
    let modes = motion.modes[i * count..(i + 1) * count].iter();
    motion.steps[i].state.into_iter().chain(modes.flat_map(|mode| [mode.q_m, mode.rate_m_s])).collect()
}

/// Energy of motion, height and bending, J: ½ m Σ (q̇² + ω² q²).
fn energy_j(scene: &Scene, motion: &SimulatedMotion, i: usize) -> f64 {
    let [_, z, _, vx, vz, w] = motion.steps[i].state;
    let (cask, modes) = (&scene.cask, modes(scene));
    let steps = &motion.modes[i * modes.len()..];
    let bending = modes
        .iter()
        .zip(steps)
        .map(|(BodyMode { mode, .. }, at)| at.rate_m_s.powi(2) + (TAU * mode.frequency_hz * at.q_m).powi(2));
    0.5 * cask.mass_kg * (vx * vx + vz * vz + bending.sum::<f64>())
        + 0.5 * cask.inertia_kg_m2 * w * w
        + cask.mass_kg * scene.drop.gravity_m_s2 * z
}

#[test]
fn modes_follow_from_the_slenderness_up_to_the_band() {
    let slender = modes(&scene(100.0, 0.01));
    assert!((slender[0].mode.frequency_hz - 100.0).abs() < 1e-9 && slender.len() > 5);
    // ANF-18 is seven heights long: slower than the 2.757 of a slender beam, faster than a thick one's 2.
    let ratio = slender[1].mode.frequency_hz / 100.0;
    assert!((2.3..2.7).contains(&ratio), "{ratio}");
    let mut thick = scene(600.0, 0.01);
    thick.cask.height_m = thick.cask.length_m / 2.0;
    let thick = modes(&thick);
    assert!(thick.iter().all(|mode| mode.mode.frequency_hz <= BAND_HZ));
    // Measured on casks two to three heights long: 1.6 to 1.9.
    assert!(thick[1].mode.frequency_hz < 2.0 * 600.0);
    assert_eq!(modes(&scene(5e3, 0.01)).len(), 1);
}

/// None of these presses L anew before it has left, which its settling would damp.
#[test]
fn an_elastic_drop_keeps_its_energy() {
    for (first_hz, contents) in [(120.0, 0.0), (250.0, 0.0), (120.0, 200.0)] {
        let mut scene = scene(first_hz, 0.0);
        scene.first_end.unloading_n_m = scene.first_end.loading_n_m;
        let loose = LooseMass {
            mass_kg: contents,
            position_m: 4.0,
            gap_m: 2e-3,
            play_m: 5e-3,
            pulse_s: 2e-3,
            damping_s_m: 0.0,
        };
        scene.extras.contents = (contents > 0.0).then_some(loose).into_iter().collect();
        let motion = simulate(&scene);
        let slap_s = motion.truth.slap_t.expect("R strikes");
        let [first, last] = [0, just_before(&motion, slap_s)].map(|i| energy_j(&scene, &motion, i));
        let lost_j = first - last;
        if contents > 0.0 {
            // The energy of the contents is not counted; they cannot return more than they brought.
            assert!(lost_j > -0.5 * contents * scene.drop.impact_velocity_m_s.powi(2), "{lost_j} J");
        } else {
            assert!(lost_j.abs() < 1e-4 * first, "{first_hz} Hz: {lost_j} of {first} J");
            let bent = motion.modes.iter().map(|mode| mode.q_m.abs()).fold(0.0, f64::max);
            assert!(bent > 1e-3, "{bent} m");
        }
    }
}

#[test]
fn the_impulses_are_the_change_of_the_rigid_bodys_momenta() {
    let scene = Scene { contact: Contact::Coulomb(0.3), ..scene(120.0, 0.01) };
    let (motion, body) = (simulate(&scene), SceneBody::new(&scene));
    let last = just_before(&motion, motion.truth.contact_s.expect("L leaves"));
    let moments: Vec<[f64; 3]> = (0..=last)
        .map(|i| {
            let ((t, n), at) = (motion.steps[i].loads_n[0], body.corner(0, &state(&motion, i)));
            [t, n, at.x_m * n - at.z_m * t]
        })
        .collect();
    let (first, after) = (&motion.steps[0], &motion.steps[last]);
    let gained = |i: usize| after.state[3 + i] - first.state[3 + i];
    let cask = &scene.cask;
    let fell_m_s = scene.drop.gravity_m_s2 * after.time_s;
    let wanted =
        [cask.mass_kg * gained(0), cask.mass_kg * (gained(1) + fell_m_s), cask.inertia_kg_m2 * gained(2)];
    for (i, wanted) in wanted.into_iter().enumerate() {
        let steps = motion.steps[..=last].windows(2).zip(moments.windows(2));
        let impulse: f64 =
            steps.map(|(s, f)| (s[1].time_s - s[0].time_s) * f64::midpoint(f[0][i], f[1][i])).sum();
        // Trapezoids on steps of ω h ≤ 0.1: h² ω²/12 = 8e-4 of the impulse.
        assert!((impulse / wanted - 1.0).abs() < 8e-4, "{i}: {impulse}, not {wanted}");
    }
}

#[test]
fn the_first_mode_rings_at_its_frequency_in_the_flight() {
    let scene = scene(120.0, 0.0);
    let motion = simulate(&scene);
    let count = modes(&scene).len();
    let (from_s, to_s) = (motion.truth.contact_s.expect("left"), motion.truth.slap_t.expect("struck"));
    let first: Vec<(f64, f64)> = (0..motion.steps.len())
        .map(|i| (motion.steps[i].time_s, motion.modes[i * count].q_m))
        .filter(|(time_s, _)| (from_s..to_s).contains(time_s))
        .collect();
    let rises = first.windows(2).filter(|pair| pair[0].1 < 0.0 && pair[1].1 >= 0.0);
    let zeros: Vec<f64> =
        rises.map(|pair| pair[0].0 - pair[0].1 * (pair[1].0 - pair[0].0) / (pair[1].1 - pair[0].1)).collect();
    let periods = u32::try_from(zeros.len() - 1).expect("few");
    let frequency_hz = f64::from(periods) / (zeros[zeros.len() - 1] - zeros[0]);
    // The chord of a sine over ω h of 0.03 is off by less than (ω h)³/15 of a radian, in 2 π.
    assert!(periods >= 3 && (frequency_hz / 120.0 - 1.0).abs() < 1e-5, "{frequency_hz} Hz");
}

#[test]
fn a_stiff_body_is_a_rigid_one() {
    let rigid = Scene { elastic: None, ..scene(1.0, 0.0) };
    let stiff = simulate(&scene(3000.0, 0.01)).truth;
    // The share of the contact's energy that bends the body is its compliance over that of the end, K C, with
    // C = Σ ψ²/(m ω²) and ψ = 2 of a first mode at 3 kHz; k and the speed follow its root at the most.
    let compliance_m_n = 4.0 / (rigid.cask.mass_kg * (TAU * 3000.0).powi(2));
    let share = rigid.first_end.unloading_n_m * compliance_m_n;
    let rigid = simulate(&rigid).truth;
    assert!(share < 0.01, "{share}");
    for (stiff, rigid) in [(stiff.k, rigid.k), (stiff.speed, rigid.speed), (stiff.contact_s, rigid.contact_s)]
    {
        let (stiff, rigid) = (stiff.expect("both"), rigid.expect("both"));
        assert!((stiff / rigid - 1.0).abs() < share, "{stiff}, not {rigid}: {share}");
    }
}

#[test]
fn a_sensor_on_the_corner_moves_as_the_corner_does() {
    let scene = scene(100.0, 0.01);
    let (motion, body) = (simulate(&scene), SceneBody::new(&scene));
    let last = just_before(&motion, motion.truth.slap_t.expect("R strikes"));
    let end_s = motion.steps[last].time_s;
    let steps = 40_000_u32;
    let times_s: Vec<f64> = (0..=steps).map(|i| end_s * f64::from(i) / f64::from(steps)).collect();
    let share = scene.cask.length_m;
    let read = |axis| {
        let at: SceneChannel = channel(axis, share, -scene.cask.height_m / 2.0);
        specific_force_m_s2(&scene, &motion, &at, &times_s)
    };
    let (along, across) = (read(Axis::Axial), read(Axis::Transverse));
    // φ + θ of the section there, from what a rate sensor reads.
    let rates = super::super::rotation_rad_s(&scene, &motion, share, &times_s);
    let step_s = end_s / f64::from(steps);
    let mut angle = scene.drop.angle_rad;
    let mut gained = [0.0; 2];
    for i in 1..along.len() {
        angle -= step_s * f64::midpoint(rates[i - 1], rates[i]);
        let (sin, cos) = angle.sin_cos();
        gained[0] += step_s * (along[i] * cos - across[i] * sin);
        gained[1] += step_s * (along[i] * sin + across[i] * cos - scene.drop.gravity_m_s2);
    }
    let corners = [0, last].map(|i| body.corner(1, &state(&motion, i)));
    // The corner stands on its section to the first order in θ: θ θ̇ h/2 is below 0.02 · 4 rad/s · 0.4 m.
    let wanted =
        [corners[1].sliding_m_s - corners[0].sliding_m_s, corners[1].rising_m_s - corners[0].rising_m_s];
    for (gained, wanted) in gained.into_iter().zip(wanted) {
        assert!((gained - wanted).abs() < 0.04, "{gained}, not {wanted} m/s");
    }
    let rigid = body.bent_corner(&[], 1, &state(&motion, last));
    assert!((rigid.rising_m_s - corners[1].rising_m_s).abs() > 0.1, "it rings");
}
