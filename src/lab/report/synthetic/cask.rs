//! The scene as stated to a cask file that `analyze` reads with the recording.

use super::place::Place;
use crate::data::{Axis, CaskFile, ChannelSpec, Contact, Coupling, End, Unit};
use std::fmt::Write;

/// The text; `places` are those of the channels.
pub(super) fn text(file: &CaskFile, places: &[Place], recording_name: &str) -> String {
    let mut text = format!("# For {}, a synthetic recording.\n\n[cask]\n", quoted(recording_name));
    let cask = &file.cask;
    let mut line = |key: &str, value: String| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{key} = {value}");
    };
    let is_given = |key: &str| !file.defaults.iter().any(|default| default == key);
    line("name", quoted(&cask.name));
    line("mass_kg", cask.mass_kg.to_string());
    line("length_m", cask.length_m.to_string());
    for (key, value) in
        [("height_m", cask.height_m), ("cog_m", cask.cog_m), ("inertia_kg_m2", cask.inertia_kg_m2)]
    {
        if is_given(&format!("cask.{key}")) {
            line(key, value.to_string());
        }
    }
    if let Some(width_m) = cask.width_m {
        line("width_m", width_m.to_string());
    }
    text.push_str("\n[drop]\n");
    let drop = &file.drop;
    let mut line = |key: &str, value: String| {
        let _ = writeln!(text, "{key} = {value}");
    };
    line("height_m", drop.height_m.to_string());
    line("angle_deg", degrees(drop.angle_rad).to_string());
    if drop.impact_velocity_given {
        line("impact_velocity_m_s", drop.impact_velocity_m_s.to_string());
    }
    if is_given("drop.gravity_m_s2") {
        line("gravity_m_s2", drop.gravity_m_s2.to_string());
    }
    if is_given("contact.friction") {
        let friction = match file.contact {
            Contact::Coulomb(coefficient) => coefficient.to_string(),
            word => quoted(&word.to_string()),
        };
        let _ = write!(text, "\n[contact]\nfriction = {friction}\n");
    }
    for (spec, place) in file.channels.iter().zip(places) {
        channel(&mut text, spec, place);
    }
    text
}

fn channel(text: &mut String, spec: &ChannelSpec, place: &Place) {
    text.push_str("\n[[channel]]\n");
    let mut line = |key: &str, value: String| {
        let _ = writeln!(text, "{key} = {value}");
    };
    line("name", quoted(&spec.name));
    line("end", quoted(if spec.end == End::First { "first" } else { "second" }));
    line("axis", quoted(if spec.axis == Axis::Transverse { "transverse" } else { "axial" }));
    line("source", quoted(&place.source));
    line("unit", quoted(if spec.unit == Some(Unit::MetrePerSecondSquared) { "m/s^2" } else { "g" }));
    line("position_m", spec.position_m.to_string());
    if spec.offset_m.abs() > 0.0 {
        line("offset_m", spec.offset_m.to_string());
    }
    if spec.polarity < 0.0 {
        line("polarity", "-1".to_owned());
    }
    if let Some(full_scale) = spec.full_scale {
        line("full_scale", full_scale.to_string());
    }
    if let Some(time) = &place.time {
        line("time", quoted(time));
    }
    if let Coupling::Ac { time_constant_s } = spec.coupling {
        line("coupling", quoted("ac"));
        line("time_constant_s", time_constant_s.to_string());
    }
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Free of the last digits of the conversion, so that 15° is written as 15.
fn degrees(angle_rad: f64) -> f64 {
    (angle_rad.to_degrees() * 1e9).round() / 1e9
}
