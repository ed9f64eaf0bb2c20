//! The scene as stated to a cask file that `analyze` reads with the recording.

use super::SyntheticPlace;
use crate::data::{Axis, CaskFile, ChannelSpec, Contact, Coupling, Unit};
use crate::lab::chance::round;
use std::fmt::{Display, Write};

fn line(text: &mut String, key: &str, value: impl Display) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{key} = {value}");
}

fn given(text: &mut String, key: &str, value: Option<impl Display>) {
    if let Some(value) = value {
        line(text, key, value);
    }
}

/// The text; `places` are those of the channels.
pub(super) fn text(file: &CaskFile, places: &[SyntheticPlace], recording_name: &str) -> String {
    let mut whole = format!("# For {}, a synthetic recording.\n", quoted(recording_name));
    let text = &mut whole;
    let stated =
        |key: &str, value| Some(value).filter(|_| !file.defaults.iter().any(|default| default == key));
    let (cask, drop) = (&file.cask, &file.drop);
    *text += "\n[cask]\n";
    line(text, "name", quoted(&cask.name));
    line(text, "mass_kg", cask.mass_kg);
    line(text, "length_m", cask.length_m);
    line(text, "height_m", cask.height_m);
    given(text, "cog_m", stated("cask.cog_m", cask.cog_m));
    given(text, "inertia_kg_m2", stated("cask.inertia_kg_m2", cask.inertia_kg_m2));
    given(text, "width_m", cask.width_m);
    given(text, "scale", file.scale);
    *text += "\n[drop]\n";
    line(text, "height_m", drop.height_m);
    // Free of the last digits of the conversion, so that 15° is written as 15.
    line(text, "angle_deg", round(drop.angle_rad.to_degrees(), 9));
    given(text, "impact_velocity_m_s", drop.impact_velocity_given.then_some(drop.impact_velocity_m_s));
    given(text, "gravity_m_s2", stated("drop.gravity_m_s2", drop.gravity_m_s2));
    let turning = Some(drop.angular_velocity_rad_s.to_degrees()).filter(|turning| *turning != 0.0);
    given(text, "angular_velocity_deg_s", turning);
    given(text, "horizontal_velocity_m_s", Some(drop.horizontal_velocity_m_s).filter(|along| *along != 0.0));
    if stated("contact.friction", 0.0).is_some() {
        *text += "\n[contact]\n";
        match file.contact {
            Contact::Coulomb(coefficient) => line(text, "friction", coefficient),
            word => line(text, "friction", quoted(&word.to_string())),
        }
    }
    for (spec, place) in file.channels.iter().zip(places) {
        channel(text, spec, place);
    }
    // Angular-rate sensors.
    for (spec, place) in file.others.iter().zip(places.iter().skip(file.channels.len())) {
        head(text, &spec.read, place, "rate", spec.unit.as_deref().unwrap_or_default());
        given(text, "time", place.time.as_deref().map(quoted));
    }
    whole
}

/// What every table of a channel begins with.
fn head(text: &mut String, read: &ChannelSpec, place: &SyntheticPlace, axis: &str, unit: &str) {
    *text += "\n[[channel]]\n";
    let end = read.end.to_string();
    for (key, word) in
        [("name", &read.name[..]), ("end", &end), ("axis", axis), ("source", &place.source), ("unit", unit)]
    {
        line(text, key, quoted(word));
    }
}

fn channel(text: &mut String, spec: &ChannelSpec, place: &SyntheticPlace) {
    let axis = if spec.axis == Axis::Transverse { "transverse" } else { "axial" };
    let unit = if spec.unit == Some(Unit::MetrePerSecondSquared) { "m/s^2" } else { "g" };
    head(text, spec, place, axis, unit);
    line(text, "position_m", spec.position_m);
    given(text, "offset_m", Some(spec.offset_m).filter(|offset_m| offset_m.abs() > 0.0));
    given(text, "lateral_m", Some(spec.lateral_m).filter(|lateral_m| lateral_m.abs() > 0.0));
    given(text, "polarity", (spec.polarity < 0.0).then_some(-1));
    given(text, "full_scale", spec.full_scale);
    given(text, "time", place.time.as_deref().map(quoted));
    if let Coupling::Ac { time_constant_s } = spec.coupling {
        line(text, "coupling", quoted("ac"));
        line(text, "time_constant_s", time_constant_s);
    }
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
