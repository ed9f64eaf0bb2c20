//! Forces of one and of several humps, and sensors that ring behind them, to contacts that begin and end
//! where the force does.

use crate::run::fixture;
use dropcheck::data::{CaskFile, Contact, DropResult, Estimate, Recording, Samples, Verdict};
use dropcheck::ingest;
use std::f64::consts::{PI, TAU};

const RATE_HZ: u32 = 50_000;
/// Steps of the motion a sample.
const STEPS: u32 = 8;
/// First contact, s.
const STRUCK_S: f64 = 0.1;
/// Impulse of the first end over the mass, m/s: the corner comes back with a third to a half of its speed.
const IMPULSE_M_S: f64 = 5.0;
/// What a sensor's seat rings with, and its damping.
const SEAT_HZ: f64 = 1500.0;
const SEAT_DAMPING: f64 = 0.015;

/// Half sines: beginning and length, ms, and height beside the others.
type Humps<'a> = &'a [(f64, f64, f64)];

/// What happened.
struct Simulated {
    contact_s: f64,
    flight_s: f64,
    speed_m_s: f64,
    k: f64,
}

/// A rigid body that falls on a smooth target: a given force at its first end, then a free flight, then a
/// pulse of 4 ms at its second end. The recording is the fixture's with these samples.
fn simulated(humps: Humps, rings: f64) -> (Recording, CaskFile, Simulated) {
    let mut file = ingest::cask_file(&fixture("anf18-german.toml")).expect("a cask file");
    let mut recording = dropcheck::read(&fixture("anf18-german.csv"), &file, &|_| ()).expect("a recording");
    file.contact = Contact::Smooth;
    let (cask, drop) = (&file.cask, &file.drop);
    let (g, inertia_m2) = (drop.gravity_m_s2, (cask.length_m.powi(2) + cask.height_m.powi(2)) / 12.0);
    let half_sine = |t_s: f64, from_ms: f64, length_ms: f64| {
        let x = (1e3 * t_s - from_ms) / length_ms;
        if (0.0..1.0).contains(&x) { (PI * x).sin() } else { 0.0 }
    };
    let area: f64 = humps.iter().map(|(_, length_ms, height)| 2.0 / PI * 1e-3 * length_ms * height).sum();
    let contact_s = 1e-3 * humps.iter().map(|h| h.0 + h.1).fold(0.0, f64::max);
    // Place of a corner from the centre of gravity, m: along the target and up.
    let corner = |along_m: f64, phi: f64| {
        let below_m = -cask.height_m / 2.0;
        (along_m * phi.cos() - below_m * phi.sin(), along_m * phi.sin() + below_m * phi.cos())
    };
    let step_s = 1.0 / f64::from(RATE_HZ * STEPS);
    let (mut phi, mut turn) = (drop.angle_rad, 0.0);
    let (mut up_m, mut up_m_s) = (-corner(-cask.cog_m, phi).1, -drop.impact_velocity_m_s);
    let mut struck: Option<(f64, f64)> = None;
    let mut k = 0.0;
    let mut seats = [(0.0, 0.0); 2];
    let mut samples = [vec![], vec![]];
    for i in 0.. {
        let t_s = f64::from(i) * step_s - STRUCK_S;
        if struck.is_some_and(|(at_s, _)| t_s > at_s + 0.02) {
            break;
        }
        let ahead_m = cask.length_m - cask.cog_m;
        let first =
            humps.iter().map(|(from, length, height)| height * half_sine(t_s, *from, *length)).sum::<f64>()
                * IMPULSE_M_S
                / area;
        let second = struck.map_or(0.0, |(at_s, _)| 6000.0 * half_sine(t_s - at_s, 0.0, 4.0));
        let turning = (corner(-cask.cog_m, phi).0 * first + corner(ahead_m, phi).0 * second) / inertia_m2;
        for (channel, (samples, seat)) in recording.channels.iter().zip(samples.iter_mut().zip(&mut seats)) {
            let read = (first + second) * phi.cos() + turning * (channel.position_m - cask.cog_m);
            let omega = TAU * SEAT_HZ;
            seat.1 += (omega * omega * (read - seat.0) - 2.0 * SEAT_DAMPING * omega * seat.1) * step_s;
            seat.0 += seat.1 * step_s;
            if i % STEPS == 0 {
                let noise = f64::from((i / STEPS).wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
                samples.push((read + rings * (seat.0 - read)) / channel.scale_m_s2 + 0.3 * noise);
            }
        }
        if t_s < 0.0 {
            continue;
        }
        (up_m_s, turn) = (up_m_s + (first + second - g) * step_s, turn + turning * step_s);
        (up_m, phi) = (up_m + up_m_s * step_s, phi + turn * step_s);
        let of_corner = |along_m: f64| {
            let (x_m, z_m) = corner(along_m, phi);
            (up_m + z_m, f64::hypot(-turn * z_m, up_m_s + turn * x_m), up_m_s + turn * x_m)
        };
        if t_s < contact_s {
            k = of_corner(-cask.cog_m).2 / drop.impact_velocity_m_s;
        } else if of_corner(ahead_m).0 < 0.0 && struck.is_none() {
            struck = Some((t_s, of_corner(ahead_m).1));
        }
    }
    for (channel, samples) in recording.channels.iter_mut().zip(samples) {
        (channel.sample_rate_hz, channel.start_s) = (f64::from(RATE_HZ), 0.0);
        channel.samples = Samples::F64(samples);
    }
    let (at_s, speed_m_s) = struck.expect("a slap-down");
    (recording, file, Simulated { contact_s, flight_s: at_s - contact_s, speed_m_s, k })
}

#[track_caller]
fn assert_holds(result: &DropResult, truth: &Simulated, name: &str) {
    assert_eq!(result.verdict, Verdict::Pass, "{name}: {:#?}", result.quality);
    let known = [
        ("duration", result.first_impact.duration, truth.contact_s),
        ("flight", result.slap_down.flight_time, truth.flight_s),
        ("speed", result.slap_down.speed, truth.speed_m_s),
        ("k", result.k, truth.k),
    ];
    for (what, found, truth) in known {
        let Estimate { value, u95, .. } = found.expect("a whole result");
        assert!((value - truth).abs() <= u95, "{name}: {what} {value} ± {u95} for {truth}");
    }
}

#[test]
fn a_contact_in_stages_is_one_contact() {
    let contacts: [(&str, f64, Humps); 5] = [
        ("one hump", 0.0, &[(0.0, 5.0, 1.0)]),
        ("one hump before sensors that ring", 0.9, &[(0.0, 4.0, 1.0)]),
        ("a soft layer, a gap and a stiff one", 0.0, &[(0.0, 3.0, 0.22), (6.0, 4.0, 1.0)]),
        ("two soft layers and a stiff one", 0.3, &[(0.0, 3.0, 0.2), (4.0, 3.0, 0.25), (9.0, 4.0, 1.0)]),
        ("a strong layer before a long one", 0.0, &[(0.0, 8.0, 1.0), (11.0, 18.0, 0.8)]),
    ];
    for (name, rings, humps) in contacts {
        let (recording, file, truth) = simulated(humps, rings);
        assert_holds(&dropcheck::analyze(&recording, &file).result, &truth, name);
    }
}

#[test]
fn no_event_comes_before_the_one_that_leads_to_it() {
    let (mut recording, mut file, _) = simulated(&[(0.0, 5.0, 1.0)], 0.0);
    file.drop.impact_velocity_m_s = 4.0;
    file.drop.impact_velocity_given = true;
    // A body that falls flat into water and far below on a stop, its second end 0.7 ms before the first, one
    // sensor slow, the other fast.
    let read = |t_s: f64| match t_s {
        t if t < 0.5 => 9.81,
        t if t < 0.91 => 0.0,
        t if t < 0.913 => 200.0 * (PI * (t - 0.91) / 0.003).sin(),
        t if t < 1.09 => 17.0,
        t => 17.0 + if t < 1.11 { 380.0 * (PI * (t - 1.09) / 0.02).sin() } else { -8.0 },
    };
    for (channel, (rate_hz, early_s)) in recording.channels.iter_mut().zip([(2_009_u32, 0.0), (20_000, 7e-4)])
    {
        channel.sample_rate_hz = f64::from(rate_hz);
        let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let samples = (0..2 * rate_hz).map(|i| read(f64::from(i) / f64::from(rate_hz) + early_s) + noise(i));
        channel.samples = Samples::F64(samples.map(|x| x / channel.scale_m_s2).collect());
    }
    file.drop.angle_rad = 0.5_f64.to_radians();
    let result = dropcheck::analyze(&recording, &file).result;
    let events = result.events;
    let times = [events.first_contact, events.separation, events.slap_down];
    let times_s: Vec<f64> = times.into_iter().flatten().map(|at| at.time_s).collect();
    assert!(times_s.is_sorted(), "{times_s:?}");
    assert_eq!(result.verdict, Verdict::Fail);
}
