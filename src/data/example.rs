//! Minimal values of the types that pass between stages, for tests: a test states the fields that matter and
//! leaves the others at these defaults (`Signal { noise_m_s2: 1.0, ..example::signal(1e4, force) }`).

use super::{
    At, Axis, Body, BodyModel, Cask, Channel, Coupling, End, Events, FlightFit, Plateau, Samples, Signal,
};

/// A transverse signal of the first end from 0 s on, without noise, spans or a free fall before it.
pub(crate) fn signal(sample_rate_hz: f64, force_m_s2: Vec<f64>) -> Signal {
    Signal { name: "A1".into(), position_m: 0.1, sample_rate_hz, force_m_s2, ..Signal::default() }
}

/// A transverse channel of the first end from 0 s on at 10 kHz, in m/s².
pub(crate) fn channel(samples: Vec<f64>) -> Channel {
    Channel {
        name: "A1".into(),
        end: End::First,
        axis: Axis::Transverse,
        source: "a".into(),
        position_m: 0.1,
        offset_m: 0.0,
        start_s: 0.0,
        sample_rate_hz: 1e4,
        samples: Samples::F64(samples),
        scale_m_s2: 1.0,
        unit: "m/s^2".into(),
        unit_origin: "cask file",
        is_unit_recorded: false,
        full_scale: None,
        gaps: vec![],
        time_jitter_s: 0.0,
        coupling: Coupling::Dc,
        rest: None,
    }
}

/// A channel in µm/m from 0 s on at 10 kHz that takes no part in the motion.
pub(crate) fn other(samples: Vec<f64>) -> Channel {
    Channel { name: "S1".into(), unit: "µm/m".into(), ..channel(samples) }
}

/// A channel's step in the flight, known exactly.
pub(crate) fn plateau(channel: &str, velocity_step_m_s: f64) -> Plateau {
    Plateau { channel: channel.into(), velocity_step_m_s, ..Plateau::default() }
}

/// A flight between two times without modes or drift.
pub(crate) fn flight(from_s: f64, to_s: f64, plateaus: Vec<Plateau>) -> FlightFit {
    FlightFit { from_s, to_s, plateaus, ..FlightFit::default() }
}

/// First contact and slap-down known exactly.
pub(crate) fn events(first_contact_s: f64, slap_down_s: f64) -> Events {
    Events {
        first_contact: Some(At::exact(first_contact_s)),
        slap_down: Some(At::exact(slap_down_s)),
        ..Events::default()
    }
}

/// A uniform cask; a section of 0 makes it the thin rod.
pub(crate) fn cask(mass_kg: f64, length_m: f64, height_m: f64) -> Cask {
    Cask::block("C", mass_kg, length_m, height_m)
}

/// The body of that cask.
pub(crate) fn body(mass_kg: f64, length_m: f64, height_m: f64) -> Body {
    let Cask { cog_m, inertia_kg_m2, is_body, .. } = cask(mass_kg, length_m, height_m);
    let model = if is_body { BodyModel::Body } else { BodyModel::Rod };
    Body { model, mass_kg, length_m, height_m, cog_m, inertia_kg_m2 }
}

/// ANF-18 as a body.
pub(crate) fn anf18() -> Body {
    body(4466.0, 5.512, 0.792)
}

/// Nearly normal noise of standard deviation 1: a sum of hashes.
pub(crate) fn noise(i: u32, seed: u64) -> f64 {
    let hash = |n: u64| {
        let mut x = (u64::from(i) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ (4 * seed + n + 1).wrapping_mul(0xD1B5_4A32_D192_ED03);
        x ^= x >> 32;
        x = x.wrapping_mul(0xD6E8_FEB8_6659_FD93);
        x ^= x >> 32;
        f64::from(u32::try_from(x >> 32).unwrap_or(0)) / f64::from(u32::MAX) - 0.5
    };
    (0..4).map(hash).sum::<f64>() * 3.0_f64.sqrt()
}
