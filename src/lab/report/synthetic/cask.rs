//! The scene as stated to a cask file that `analyze` reads with the recording.

use super::place::SyntheticPlace;
use crate::data::{Axis, CaskFile, ChannelSpec, Contact, Coupling, End, Unit};
use std::fmt::{Display, Write};

/// TOML as far as it is written.
struct CaskText(String);

impl CaskText {
    fn table(&mut self, brackets: &str) {
        // Writing to a string does not fail.
        let _ = writeln!(self.0, "\n{brackets}");
    }

    fn line(&mut self, key: &str, value: impl Display) {
        let _ = writeln!(self.0, "{key} = {value}");
    }

    fn given(&mut self, key: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.line(key, value);
        }
    }
}

/// The text; `places` are those of the channels.
pub(super) fn text(file: &CaskFile, places: &[SyntheticPlace], recording_name: &str) -> String {
    let mut text = CaskText(format!("# For {}, a synthetic recording.\n", quoted(recording_name)));
    let given =
        |key: &str, value| Some(value).filter(|_| !file.defaults.iter().any(|default| default == key));
    let (cask, drop) = (&file.cask, &file.drop);
    text.table("[cask]");
    text.line("name", quoted(&cask.name));
    text.line("mass_kg", cask.mass_kg);
    text.line("length_m", cask.length_m);
    text.given("height_m", given("cask.height_m", cask.height_m));
    text.given("cog_m", given("cask.cog_m", cask.cog_m));
    text.given("inertia_kg_m2", given("cask.inertia_kg_m2", cask.inertia_kg_m2));
    text.given("width_m", cask.width_m);
    text.table("[drop]");
    text.line("height_m", drop.height_m);
    text.line("angle_deg", degrees(drop.angle_rad));
    text.given("impact_velocity_m_s", drop.impact_velocity_given.then_some(drop.impact_velocity_m_s));
    text.given("gravity_m_s2", given("drop.gravity_m_s2", drop.gravity_m_s2));
    if given("contact.friction", 0.0).is_some() {
        text.table("[contact]");
        match file.contact {
            Contact::Coulomb(coefficient) => text.line("friction", coefficient),
            word => text.line("friction", quoted(&word.to_string())),
        }
    }
    for (spec, place) in file.channels.iter().zip(places) {
        channel(&mut text, spec, place);
    }
    text.0
}

fn channel(text: &mut CaskText, spec: &ChannelSpec, place: &SyntheticPlace) {
    text.table("[[channel]]");
    text.line("name", quoted(&spec.name));
    text.line("end", quoted(if spec.end == End::First { "first" } else { "second" }));
    text.line("axis", quoted(if spec.axis == Axis::Transverse { "transverse" } else { "axial" }));
    text.line("source", quoted(&place.source));
    text.line("unit", quoted(if spec.unit == Some(Unit::MetrePerSecondSquared) { "m/s^2" } else { "g" }));
    text.line("position_m", spec.position_m);
    text.given("offset_m", Some(spec.offset_m).filter(|offset_m| offset_m.abs() > 0.0));
    if spec.polarity < 0.0 {
        text.line("polarity", -1);
    }
    text.given("full_scale", spec.full_scale);
    if let Some(time) = &place.time {
        text.line("time", quoted(time));
    }
    if let Coupling::Ac { time_constant_s } = spec.coupling {
        text.line("coupling", quoted("ac"));
        text.line("time_constant_s", time_constant_s);
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
