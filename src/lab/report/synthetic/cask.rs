//! Writes the stated scene as a cask file that `analyze` reads with the recording.

use super::SyntheticPlace;
use crate::data::{Axis, CaskFile, ChannelSpec, Contact, Coupling, Unit};
use crate::lab::chance::round;
use std::fmt::{Display, Write};

fn line(text: &mut String, key: &str, value: impl Display) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{key} = {value}");
}

fn put(text: &mut String, key: &str, value: Option<impl Display>) {
    if let Some(value) = value {
        line(text, key, value);
    }
}

/// Text of the cask file; `places` locate the channels.
pub(super) fn text(file: &CaskFile, places: &[SyntheticPlace], recording_name: &str) -> String {
    let mut whole = format!("# For {}, a synthetic recording.\n", quote(recording_name));
    let text = &mut whole;
    let stated =
        |key: &str, value| Some(value).filter(|_| !file.defaults.iter().any(|default| default == key));
    let (cask, drop) = (&file.cask, &file.drop);
    *text += "\n[cask]\n";
    line(text, "name", quote(&cask.name));
    line(text, "mass_kg", cask.mass_kg);
    line(text, "length_m", cask.length_m);
    line(text, "height_m", cask.height_m);
    put(text, "cog_m", stated("cask.cog_m", cask.cog_m));
    put(text, "inertia_kg_m2", stated("cask.inertia_kg_m2", cask.inertia_kg_m2));
    put(text, "width_m", cask.width_m);
    put(text, "scale", file.scale);
    *text += "\n[drop]\n";
    line(text, "height_m", drop.height_m);
    // The last digits of the conversion are rounded off, so that 15° is written as 15.
    line(text, "angle_deg", round(drop.angle_rad.to_degrees(), 9));
    put(text, "impact_velocity_m_s", drop.impact_velocity_given.then_some(drop.impact_velocity_m_s));
    put(text, "gravity_m_s2", stated("drop.gravity_m_s2", drop.gravity_m_s2));
    let turning = Some(drop.angular_velocity_rad_s.to_degrees()).filter(|turning| *turning != 0.0);
    put(text, "angular_velocity_deg_s", turning);
    put(text, "horizontal_velocity_m_s", Some(drop.horizontal_velocity_m_s).filter(|along| *along != 0.0));
    if stated("contact.friction", 0.0).is_some() {
        *text += "\n[contact]\n";
        match file.contact {
            Contact::Coulomb(coefficient) => line(text, "friction", coefficient),
            word => line(text, "friction", quote(&word.to_string())),
        }
    }
    for (spec, place) in file.channels.iter().zip(places) {
        channel(text, spec, place);
    }
    // Angular-rate sensors.
    for (spec, place) in file.others.iter().zip(places.iter().skip(file.channels.len())) {
        head(text, &spec.read, place, "rate", spec.unit.as_deref().unwrap_or_default());
        put(text, "time", place.time.as_deref().map(quote));
    }
    whole
}

/// Writes the beginning of every table of a channel.
fn head(text: &mut String, read: &ChannelSpec, place: &SyntheticPlace, axis: &str, unit: &str) {
    *text += "\n[[channel]]\n";
    let end = read.end.to_string();
    for (key, word) in
        [("name", &read.name[..]), ("end", &end), ("axis", axis), ("source", &place.source), ("unit", unit)]
    {
        line(text, key, quote(word));
    }
}

fn channel(text: &mut String, spec: &ChannelSpec, place: &SyntheticPlace) {
    let axis = if spec.axis == Axis::Transverse { "transverse" } else { "axial" };
    let unit = if spec.unit == Some(Unit::MetrePerSecondSquared) { "m/s^2" } else { "g" };
    head(text, spec, place, axis, unit);
    line(text, "position_m", spec.position_m);
    put(text, "offset_m", Some(spec.offset_m).filter(|offset_m| offset_m.abs() > 0.0));
    put(text, "lateral_m", Some(spec.lateral_m).filter(|lateral_m| lateral_m.abs() > 0.0));
    put(text, "polarity", (spec.polarity < 0.0).then_some(-1));
    put(text, "full_scale", spec.full_scale);
    put(text, "time", place.time.as_deref().map(quote));
    if let Coupling::Ac { time_constant_s } = spec.coupling {
        line(text, "coupling", quote("ac"));
        line(text, "time_constant_s", time_constant_s);
    }
}

/// A text as TOML writes it.
fn quote(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
