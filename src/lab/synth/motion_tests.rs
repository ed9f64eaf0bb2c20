//! Simulated drops to balances, limits and independent numbers that they must meet.

use super::*;
use crate::data::Contact;
use crate::lab::data::{BendingMode, CrushableEnd, LooseMass};
use crate::lab::synth::example::{anf18, just_before};

/// Kinetic and potential energy, J, of a kept time.
fn energy_j(scene: &Scene, motion: &SimulatedMotion, i: usize) -> f64 {
    let [_, z, _, vx, vz, w] = motion.steps[i].state;
    let cask = &scene.cask;
    0.5 * (cask.mass_kg * (vx * vx + vz * vz) + cask.inertia_kg_m2 * w * w)
        + cask.mass_kg * scene.drop.gravity_m_s2 * z
}

#[test]
fn the_fixture_simulated_in_another_language_is_met() {
    // fixtures/reference/anf18-json.truth.json, by fixed steps in Python.
    let truth = simulate(&anf18()).truth;
    let near = |name: &str, value: Option<f64>, wanted: f64| {
        let value = value.expect(name);
        assert!((value / wanted - 1.0).abs() < 1e-3, "{name}: {value}, not {wanted}");
    };
    near("speed", truth.speed, 20.559_910);
    near("k", truth.k, 0.559_507_1);
    near("contact", truth.contact_s, 5.826_257e-3);
    near("slap-down", truth.slap_t, 71.054_116e-3);
    near("omega", truth.omega, 5.154_103);
    near("angle at separation", truth.angle_sep_deg, 14.214_712);
    near("angle at slap-down", truth.angle_hit_deg, -5.047_620);
    near("energy ratio", truth.energy_ratio, 0.795_318);
    assert!(truth.relands == 0 && !truth.first_down_at_slap);
    // Rough: sliding begins only where N is below a hundredth of the holding force, for microseconds.
    assert!(truth.vx_corner_after.expect("left").abs() < 1e-3);
}

#[test]
fn an_elastic_frictionless_impact_keeps_its_energy() {
    let mut scene = anf18();
    scene.contact = Contact::Smooth;
    scene.first_end.unloading_n_m = scene.first_end.loading_n_m;
    let motion = simulate(&scene);
    let slap_s = motion.truth.slap_t.expect("R strikes");
    let (first, last) =
        (energy_j(&scene, &motion, 0), energy_j(&scene, &motion, just_before(&motion, slap_s)));
    assert!((last / first - 1.0).abs() < 1e-6, "{first} J, {last} J");
    assert!(motion.steps.iter().map(|step| step.loads_n[0]).all(|f| f.0 == 0.0 && f.1 >= 0.0));
}

#[test]
fn the_impulses_are_the_change_of_momentum() {
    let scene = anf18();
    let motion = simulate(&scene);
    let left_s = motion.truth.contact_s.expect("L leaves");
    let last = just_before(&motion, left_s);
    // Trapezoids on steps of ω h ≤ 0.1: h² ω²/12 = 8e-4 of the impulse.
    let impulse = |of: fn((f64, f64)) -> f64| -> f64 {
        let force = |step: &MotionStep| of(step.loads_n[0]);
        let steps = motion.steps[..=last].windows(2);
        steps.map(|s| (s[1].time_s - s[0].time_s) * f64::midpoint(force(&s[0]), force(&s[1]))).sum()
    };
    let mass_kg = scene.cask.mass_kg;
    let along = mass_kg * motion.steps[last].state[3];
    let upwards = mass_kg
        * (motion.steps[last].state[4] - motion.steps[0].state[4]
            + scene.drop.gravity_m_s2 * motion.steps[last].time_s);
    assert!((impulse(|f| f.0) / along - 1.0).abs() < 8e-4);
    assert!((impulse(|f| f.1) / upwards - 1.0).abs() < 8e-4);
}

#[test]
fn the_flight_is_ballistic() {
    let scene = anf18();
    let motion = simulate(&scene);
    let (left_s, slap_s) = (motion.truth.contact_s.expect("left"), motion.truth.slap_t.expect("struck"));
    let from = motion.count_before(|t| t <= left_s) - 1;
    let to = just_before(&motion, slap_s);
    let tau = motion.steps[to].time_s - motion.steps[from].time_s;
    let ([x, z, angle, vx, vz, w], then) = (motion.steps[from].state, motion.steps[to].state);
    // Tolerance: 1e-11 of 10 m/s in each of some hundred steps, most of which are far better.
    assert!((then[0] - (x + vx * tau)).abs() < 1e-8);
    assert!((then[1] - (z + vz * tau - 0.5 * 9.81 * tau * tau)).abs() < 1e-8);
    assert!((then[2] - (angle + w * tau)).abs() < 1e-8);
}

#[test]
fn a_central_impact_shows_the_ends_own_restitution() {
    for k in [0.05, 0.3, 0.9] {
        // A square body, 2 m by 2 m, on its corner at 45°: S is above L.
        let mut scene = anf18();
        scene.cask.length_m = 2.0;
        scene.cask.height_m = 2.0;
        scene.cask.cog_m = 1.0;
        scene.cask.inertia_kg_m2 = scene.cask.mass_kg * 8.0 / 12.0;
        scene.drop.angle_rad = 45.0_f64.to_radians();
        scene.contact = Contact::Smooth;
        let loading_n_m = scene.cask.mass_kg * (std::f64::consts::FRAC_PI_2 * (1.0 + k) / 1e-4).powi(2);
        scene.first_end =
            CrushableEnd { loading_n_m, unloading_n_m: loading_n_m / (k * k), ..CrushableEnd::default() };
        let truth = simulate(&scene).truth;
        // Gravity during the pulse: g T of 13.3 m/s is 7.4e-5.
        assert!((truth.k.expect("L leaves") - k).abs() < 7.4e-5, "{k}: {:?}", truth.k);
        assert!((truth.contact_s.expect("L leaves") / 1e-4 - 1.0).abs() < 2e-4);
    }
}

#[test]
fn friction_lies_between_smooth_and_rough_and_keeps_to_its_bound() {
    let with = |contact| {
        let mut scene = anf18();
        scene.contact = contact;
        simulate(&scene)
    };
    let sliding = with(Contact::Coulomb(0.2));
    let left = just_before(&sliding, sliding.truth.contact_s.expect("L leaves"));
    assert!(
        sliding.steps[..left]
            .iter()
            .map(|step| step.loads_n[0])
            .all(|f| f.0.abs() <= 0.2 * f.1 * (1.0 + 1e-12))
    );
    let omega = |motion: &SimulatedMotion| motion.truth.omega_rebound.expect("L leaves");
    let (smooth, rough) = (omega(&with(Contact::Smooth)), omega(&with(Contact::Rough)));
    assert!(rough < omega(&sliding) && omega(&sliding) < smooth);
    // Far more friction than the 0.6 that sticking needs: rough but for the last instant, when N vanishes.
    assert!((omega(&with(Contact::Coulomb(5.0))) / rough - 1.0).abs() < 5e-3);
}

#[test]
fn a_finer_tolerance_changes_nothing() {
    let mode = BendingMode { order: 1, frequency_hz: 62.0, damping: 0.03, strength: 1.0 };
    for (k, degrees, contact) in
        [(0.55, 15.0, Contact::Rough), (0.02, 30.0, Contact::Coulomb(0.3)), (0.98, 20.0, Contact::Rough)]
    {
        let mut scene = anf18();
        scene.modes = vec![mode];
        scene.contact = contact;
        scene.drop.angle_rad = f64::to_radians(degrees);
        scene.first_end.unloading_n_m = scene.first_end.loading_n_m / (k * k);
        let [coarse, fine] =
            [TOLERANCE, TOLERANCE / 2.0].map(|tolerance| follow(&scene, tolerance, usize::MAX).truth);
        for (a, b) in [(coarse.k, fine.k), (coarse.speed, fine.speed), (coarse.slap_t, fine.slap_t)] {
            let (a, b) = (a.expect("an event"), b.expect("an event"));
            assert!((a / b - 1.0).abs() < 1e-6, "k {k} at {degrees}°: {a}, {b}");
        }
    }
}

#[test]
fn a_hundredth_of_the_tolerance_changes_nothing_of_an_elastic_body() {
    let elastic = Some(crate::lab::data::ElasticBody { first_bending_hz: 90.0, damping: 0.01 });
    for contact in [Contact::Rough, Contact::Coulomb(0.3)] {
        let scene = Scene { contact, elastic, ..anf18() };
        let [coarse, fine] =
            [1.0, 0.01].map(|share| follow(&scene, share * ELASTIC_TOLERANCE, usize::MAX).truth);
        for (a, b) in [(coarse.k, fine.k), (coarse.speed, fine.speed), (coarse.local_speed, fine.local_speed)]
        {
            let (a, b) = (a.expect("an event"), b.expect("an event"));
            assert!((a / b - 1.0).abs() < 1e-5, "{contact}: {a}, {b}");
        }
    }
}

#[test]
fn the_same_scene_gives_the_same_bits() {
    let scene = anf18();
    assert_eq!(simulate(&scene), simulate(&scene));
}

#[test]
fn a_steep_drop_has_no_slap_down_and_says_so() {
    let mut scene = anf18();
    scene.drop.angle_rad = 88.0_f64.to_radians();
    let motion = simulate(&scene);
    assert!(motion.truth.k.is_some());
    assert!(motion.truth.slap_t.is_none() && motion.truth.speed.is_none() && motion.truth.flight_s.is_none());
    assert!(motion.steps.last().is_some_and(|step| step.time_s <= LONGEST_S));
}

#[test]
fn the_motion_ends_as_long_after_the_slap_down_as_asked() {
    let motion = simulate(&anf18());
    let last_s = motion.steps.last().expect("times").time_s;
    assert!((last_s - motion.truth.slap_t.expect("R strikes") - 0.04).abs() < 1e-12);
    assert!(motion.steps.is_sorted_by_key(|step| step.time_s));
}

#[test]
fn a_blow_of_loose_contents_is_that_of_two_bodies() {
    let mut scene = anf18();
    let (mass_kg, arm_m) = (200.0, 1.5);
    let position_m = scene.cask.cog_m + arm_m;
    scene.extras.contents =
        vec![LooseMass { mass_kg, position_m, gap_m: 1e-3, play_m: 1.0, pulse_s: 1e-3, damping_s_m: 0.0 }];
    let body = SceneBody::new(&scene);
    let mut y = SVector::<f64, WHOLE_STATE>::zeros();
    // Flat and far above the target; the mass comes down on its lower pad at 2 m/s.
    (y[1], y[CASK_STATE], y[CASK_STATE + 1], y[CASK_STATE + 3]) = (10.0, arm_m, 10.0, -2.0);
    let segment = Segment { body: &body, tolerance: TOLERANCE, watched: false };
    let after = segment.integrate(&y, 5e-3, MOST_STEPS).0.y_out().last().copied().expect("steps");
    let cask = &scene.cask;
    let shared_kg = 1.0 / (1.0 / mass_kg + 1.0 / cask.mass_kg + arm_m * arm_m / cask.inertia_kg_m2);
    let impulse_n_s = 2.0 * 2.0 * shared_kg;
    let near =
        |value: f64, wanted: f64| assert!((value / wanted - 1.0).abs() < 1e-3, "{value}, not {wanted}");
    near(after[5], -impulse_n_s * arm_m / cask.inertia_kg_m2);
    near(after[4] + 9.81 * 5e-3, -impulse_n_s / cask.mass_kg);
    near(after[CASK_STATE + 3] + 9.81 * 5e-3, impulse_n_s / mass_kg - 2.0);
}

#[test]
fn a_footprint_takes_its_arm_off_the_turning() {
    let mut scene = anf18();
    scene.contact = Contact::Smooth;
    let (k, pulse_s, footprint) = (0.5, 2e-4, 20.0);
    let pulse = crate::lab::data::WantedImpact { duration_s: pulse_s, restitution: k, yield_share: None };
    let (cask, drop) = (&scene.cask, &scene.drop);
    let end = crate::lab::synth::crushable_end(cask, drop, scene.contact, crate::data::End::First, pulse);
    scene.first_end = CrushableEnd { footprint, ..end };
    let motion = simulate(&scene);
    let after = motion.steps[just_before(&motion, motion.truth.contact_s.expect("L leaves"))];
    let (sin, cos) = scene.drop.angle_rad.sin_cos();
    let a_m = scene.cask.cog_m * cos - scene.cask.height_m / 2.0 * sin;
    let impulse_n_s = scene.cask.mass_kg * (after.state[4] - motion.steps[0].state[4] + 9.81 * after.time_s);
    let lost_n_m_s = a_m * impulse_n_s + scene.cask.inertia_kg_m2 * after.state[5];
    // ∫ N s dt with s = f δ on the way in, δ = δ0 sin ωt, and f δ0 on the way out: f K δ0² (π/4 + k)/ω. The
    // arm itself changes by s/a = 0.8 %, and by the turn within the pulse by half a millimetre of s = 22 mm.
    let omega = std::f64::consts::FRAC_PI_2 * (1.0 + k) / pulse_s;
    let deepest_m = scene.drop.impact_velocity_m_s / omega;
    let wanted = footprint * end.loading_n_m * deepest_m.powi(2) * (std::f64::consts::FRAC_PI_4 + k) / omega;
    assert!((lost_n_m_s / wanted - 1.0).abs() < 0.05, "{lost_n_m_s}, not {wanted}");
}

#[test]
fn friction_changes_at_the_greatest_crush_and_falls_with_the_speed() {
    let ratios = |change: fn(&mut Scene)| {
        let mut scene = anf18();
        scene.contact = Contact::Coulomb(0.2);
        change(&mut scene);
        let motion = simulate(&scene);
        let pressed = motion.steps.iter().take_while(|step| Some(step.time_s) < motion.truth.contact_s);
        let loads = pressed.map(|step| step.loads_n[0]).filter(|load| load.1 > 1e3);
        loads.map(|(along, up)| (up, along.abs() / up)).collect::<Vec<_>>()
    };
    let changing = ratios(|scene| scene.extras.returning_friction = Some(0.05));
    let peak = (0..changing.len()).max_by(|a, b| changing[*a].0.total_cmp(&changing[*b].0)).expect("loads");
    assert!(changing[..peak].iter().all(|(_, ratio)| (ratio - 0.2).abs() < 1e-9));
    assert!(changing[peak + 2..].iter().all(|(_, ratio)| (ratio - 0.05).abs() < 1e-9));
    let falling = ratios(|scene| scene.extras.falling_friction = Some((0.1, 1.0)));
    assert!(falling.iter().all(|(_, ratio)| (0.1..=0.2).contains(ratio)));
    // It begins at rest and slides by metres a second at the end.
    assert!(falling[0].1 > 0.19 && falling[falling.len() - 1].1 < 0.15);
}

#[test]
fn one_flight_ends_where_the_first_end_comes_back() {
    let mut scene = anf18();
    assert_eq!(simulate_one_flight(&scene), simulate(&scene));
    // L leaves at a fiftieth of its speed, and is back long before R has come down from 60°.
    scene.drop.angle_rad = f64::to_radians(60.0);
    scene.first_end.unloading_n_m = scene.first_end.loading_n_m / 0.02_f64.powi(2);
    let (whole, one) = (simulate(&scene), simulate_one_flight(&scene));
    assert!(whole.truth.relands > 0 && whole.truth.slap_t.is_some(), "{:?}", whole.truth);
    assert!(one.truth.slap_t.is_none() && one.truth.k == whole.truth.k);
    assert_eq!(one.steps, whole.steps[..one.steps.len()]);
}
