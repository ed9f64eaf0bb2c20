//! Each element of the measuring chain against its definition, and the chain as a whole.

use super::super::example;
use super::*;
use crate::lab::data::Chain;
use std::f64::consts::FRAC_1_PI;

/// The record lasts 0.1 s before and 0.1 s after first contact; the first contact lasts 5 ms.
fn recorded(seat: SceneChannel, force: &dyn Fn(Axis, f64) -> f64) -> SyntheticChannel {
    let mut scene = example::anf18();
    scene.channels = vec![seat];
    through(&scene, force)
}

fn through(scene: &Scene, force: &dyn Fn(Axis, f64) -> f64) -> SyntheticChannel {
    let force = |seat: &SceneChannel, times_s: &[f64]| times_s.iter().map(|&t| force(seat.axis, t)).collect();
    let drive = SensedDrop { force_m_s2: &force, contacts_s: vec![(0.0, 5e-3)], end_s: 0.1 };
    channel(scene, &scene.channels[0], 0, &drive)
}

fn seat() -> SceneChannel {
    SceneChannel { sample_rate_hz: 1e4, ..example::channel(Axis::Transverse, 0.15, 0.0) }
}

fn with(change: impl FnOnce(&mut Chain)) -> SceneChannel {
    let mut seat = seat();
    change(&mut seat.chain);
    seat
}

fn near(value: f32, wanted: f64, within: f64) {
    assert!((f64::from(value) - wanted).abs() <= within, "{value}, not {wanted}");
}

/// Rounding to f32, of numbers up to a thousand.
const F32: f64 = 1e-4;

#[test]
fn a_perfect_chain_samples_the_force_at_its_times() {
    let out = recorded(seat(), &|_, t| 1000.0 * t);
    assert_eq!(out.samples.len(), 2000);
    for i in [0_u16, 1, 999, 1999] {
        near(out.samples[usize::from(i)], 1000.0 * (f64::from(i) * 1e-4 - 0.1), F32);
    }
    let in_g = recorded(SceneChannel { unit: "g".into(), ..seat() }, &|_, _| 9.806_65);
    near(in_g.samples[7], 1.0, 1e-7);
}

#[test]
fn tilt_and_cross_axis_let_the_other_axis_in() {
    let force = |axis, _| if axis == Axis::Transverse { 100.0 } else { 40.0 };
    let tilted = recorded(with(|c| c.tilt_rad = 30_f64.to_radians()), &force);
    near(tilted.samples[0], 100.0 * 30_f64.to_radians().cos() + 20.0, F32);
    near(recorded(with(|c| c.cross_axis = 0.05), &force).samples[0], 102.0, F32);
}

#[test]
fn scale_and_polarity_multiply_and_clipping_is_exact() {
    near(recorded(with(|c| c.scale = 1.1), &|_, _| 100.0).samples[0], 110.0, F32);
    near(recorded(with(|c| c.swapped_polarity = true), &|_, _| 100.0).samples[0], -100.0, F32);
    let clipped = recorded(with(|c| c.full_scale_m_s2 = Some(50.0)), &|_, t| 1000.0 * t);
    assert_eq!(clipped.samples[0].to_bits(), (-50.0_f32).to_bits());
    assert_eq!(clipped.samples[1999].to_bits(), 50.0_f32.to_bits());
    near(clipped.samples[1100], 10.0, F32);
}

#[test]
fn a_cable_whips_from_first_contact_on_and_fades() {
    let out = recorded(with(|c| c.whip = Some((100.0, 20.0))), &|_, _| 0.0).samples;
    assert!(out[..1000].iter().all(|x| x.abs() < f32::EPSILON));
    // Half a wave of 20 Hz later, 250 samples, it has turned and is e^(−0.1 π) of what it was; a quarter
    // after the start, e^(−0.05 π).
    for i in 1000..1750 {
        near(out[i + 250], -f64::from(out[i]) * (-0.1 * std::f64::consts::PI).exp(), 1e-3);
    }
    near(out[1125], 100.0 * (-0.05 * std::f64::consts::PI).exp(), 1e-3);
}

#[test]
fn the_converter_has_its_steps_and_rails() {
    // 4 bits over ± 80: steps of 10 from −80 to 70.
    let seat = with(|c| (c.full_scale_m_s2, c.bits) = (Some(80.0), Some(4)));
    let out = recorded(seat, &|_, t| 1000.0 * t);
    assert!(out.samples.iter().all(|x| (x / 10.0).fract().abs() < f32::EPSILON));
    assert_eq!(out.samples[0].to_bits(), (-80.0_f32).to_bits());
    assert_eq!(out.samples[1999].to_bits(), 70.0_f32.to_bits());
    near(out.samples[1126], 10.0, 0.0);
}

#[test]
fn dropouts_hold_gaps_lose_and_skew_moves_the_stamp() {
    let seat = with(|c| (c.dropouts_s, c.gaps_s) = (vec![(0.01, 0.02)], vec![(0.03, 0.031)]));
    let out = recorded(seat, &|_, t| 1000.0 * t);
    assert!(out.samples[99..200].iter().all(|x| x.to_bits() == out.samples[99].to_bits()));
    assert!(out.samples[200] > out.samples[199]);
    let lost: Vec<usize> = (0..2000).filter(|&i| out.samples[i].is_nan()).collect();
    assert_eq!((lost.len(), lost[0]), (10, 300));
    let mut scene = example::anf18();
    let late = with(|c| c.skew_s = 2e-3);
    let early = with(|c| c.skew_s = -1e-3);
    scene.channels = vec![late, early];
    let recording = record(&scene, &super::super::simulate(&scene));
    assert!((recording.channels[0].start_s - 3e-3).abs() < 1e-15);
    assert!(recording.channels[1].start_s.abs() < 1e-15);
    assert!((recording.first_contact_s - 0.101).abs() < 1e-12);
}

#[test]
fn a_fast_clock_takes_more_samples_of_the_same_drop() {
    let mut scene = example::anf18();
    scene.channels = vec![seat()];
    scene.clock_error = 0.01;
    let out = through(&scene, &|_, t| 1000.0 * t);
    assert_eq!(out.samples.len(), 2020);
    near(out.samples[2019], 1000.0 * (2019.0 / 10_100.0 - 0.1), F32);
    assert!((out.sample_rate_hz - 1e4).abs() < f64::EPSILON);
}

#[test]
fn ac_coupling_remembers_the_hanging_cask() {
    // Released 1.3546 s before contact, recorded from 0.1 s before: −g e^(−1.2546/0.318) = −0.19 m/s² is
    // left.
    let fall_s = (18.0_f64 / 9.81).sqrt();
    let seat = with(|c| c.ac_time_constant_s = Some(FRAC_1_PI));
    let out = recorded(seat, &|_, t| if t < -fall_s { 9.81 } else { 0.0 });
    let wanted = |since_s: f64| -9.81 * (-since_s / FRAC_1_PI).exp();
    near(out.samples[0], wanted(fall_s - 0.1), 1e-4);
    near(out.samples[1999], wanted(fall_s + 0.0999), 1e-4);
}

#[test]
fn the_anti_alias_filter_takes_away_what_would_fold() {
    // 9 kHz sampled at 10 kHz would read as 1 kHz.
    let tone = |_: Axis, t: f64| (std::f64::consts::TAU * 9_000.0 * t).sin();
    let peak = |out: SyntheticChannel| out.samples[500..].iter().fold(0.0_f32, |p, x| p.max(x.abs()));
    assert!(peak(recorded(seat(), &tone)) > 0.9);
    // (1000/9000)⁴ = 1.5e-4.
    near(peak(recorded(with(|c| c.anti_alias_hz = Some(1_000.0)), &tone)), 0.0, 3e-4);
}

#[test]
fn the_same_seed_gives_the_same_bits_and_no_source_moves_another() {
    let noisy = || with(|c| (c.white_noise_m_s2, c.pink_noise_m_s2) = (1.0, 1.0));
    let samples_of = |seed, seat: SceneChannel| {
        let mut scene = example::anf18();
        (scene.seed, scene.channels) = (seed, vec![seat]);
        through(&scene, &|_, _| 0.0).samples
    };
    assert_eq!(samples_of(1, noisy()), samples_of(1, noisy()));
    assert_ne!(samples_of(1, noisy()), samples_of(2, noisy()));
    let mut hum = noisy();
    hum.chain.hum = Some((1.0, 50.0));
    for (with_hum, without) in samples_of(1, hum).iter().zip(samples_of(1, noisy())) {
        assert!((with_hum - without).abs() <= 1.0 + 1e-6);
    }
}

#[test]
fn exchanged_ends_read_each_others_places() {
    let mut scene = example::anf18();
    let far = SceneChannel { end: End::Second, position_m: 5.362, ..seat() };
    scene.channels = vec![seat(), far];
    let motion = super::super::simulate(&scene);
    let right = record(&scene, &motion);
    scene.swapped_ends = true;
    let swapped = record(&scene, &motion);
    assert_eq!(right.channels[0].samples, swapped.channels[1].samples);
    assert_eq!(right.channels[1].samples, swapped.channels[0].samples);
    assert_ne!(right.channels[0].samples, right.channels[1].samples);
}

#[test]
fn contacts_are_those_of_the_simulation() {
    let motion = super::super::simulate(&example::anf18());
    let spans = contacts_s(&motion);
    let truth = motion.truth;
    assert!((spans[0].0).abs() < 1e-4 && (spans[0].1 - truth.contact_s.unwrap()).abs() < 1e-4, "{spans:?}");
    assert!((spans[1].0 - truth.slap_t.unwrap()).abs() < 1e-4, "{spans:?}");
}
