//! A cask file and what its recording says to every key with its value, in the file's own units, and where
//! that is from.

use super::section::with_ascii_minus;
use crate::data::keys::{self, Key, TABLES};
use crate::data::{CaskFile, Contact, OtherSpec, Recording, TOLERANCES};
use serde_json::{Map, Value, json};

/// Every key of every table, each `{"value", "from"}`; `from` is "stated", "default", "recording", or
/// "command line" for a correction that is switched off there. `channel` is a list. What has no value is
/// null.
#[must_use]
pub fn settings(file: &CaskFile, recording: &Recording) -> Value {
    let text = with_ascii_minus(file.text.trim_start_matches('\u{feff}'));
    let stated: toml::Table = text.parse().unwrap_or_default();
    let stated_table = |table: &str| stated.get(table).and_then(toml::Value::as_table);
    let single =
        TABLES.iter().filter(|table| table.name != "channel" && !keys::INNER_TABLES.contains(&table.name));
    let mut all: Map<String, Value> = single
        .map(|table| {
            let from = |key: &str| match key {
                "angular_velocity_deg_s" if file.is_rotation_measured && table.name == "drop" => "recording",
                _ => "default",
            };
            let default = |key: &Key| (default(file, table.name, key.name), from(key.name));
            (table.name.to_owned(), entries(stated_table(table.name), table.keys, &default))
        })
        .collect();
    let mut made = file.corrections;
    for (key, is_made) in made.switches() {
        // The file says otherwise, or nothing, where the command line has switched it off.
        if !*is_made && all["corrections"][key]["value"] != json!(false) {
            all["corrections"][key] = json!({"value": false, "from": "command line"});
        }
    }
    let channels = stated.get("channel").and_then(toml::Value::as_array).map_or(&[][..], Vec::as_slice);
    let channels = channels.iter().filter_map(toml::Value::as_table);
    let channel = |table: &toml::Table| {
        let name = table.get("name").and_then(toml::Value::as_str);
        let mut all = recording.channels.iter().chain(&recording.others.channels);
        let read = all.find(|c| Some(c.name.as_str()) == name);
        let spec = file.channels.iter().find(|spec| Some(&*spec.name) == name);
        let is_other = |other: &OtherSpec| other.rate.is_none() && Some(&*other.read.name) == name;
        let is_other = file.others.iter().any(is_other);
        let default = |key: &Key| match key.name {
            "unit" => (json!(read.map(|c| &c.unit)), "recording"),
            "sample_rate_hz" => (json!(read.map(|c| c.sample_rate_hz)), "recording"),
            "time" => (json!(file.time), "default"),
            // No key of the motion has a value.
            _ if is_other => (Value::Null, "default"),
            "offset_m" => (json!(spec.map_or(0.0, |spec| spec.offset_m)), "default"),
            "lateral_m" => (json!(spec.map_or(0.0, |spec| spec.lateral_m)), "default"),
            "polarity" => (json!(1), "default"),
            "scale" => (json!(1.0), "default"),
            "coupling" => (json!("dc"), "default"),
            "calibration_percent" => (default(file, "tolerance", key.name), "default"),
            _ => (Value::Null, "default"),
        };
        entries(Some(table), &keys::CHANNEL, &default)
    };
    all.insert("channel".into(), channels.map(channel).collect());
    Value::Object(all)
}

fn entries(
    stated: Option<&toml::Table>,
    keys: &[Key],
    default: &dyn Fn(&Key) -> (Value, &'static str),
) -> Value {
    let entry = |key: &Key| {
        let own = stated.and_then(|table| table.get(key.name));
        let plain = |own: &toml::Value| match own {
            toml::Value::Datetime(when) => json!(when.to_string()),
            own => serde_json::to_value(own).unwrap_or_default(),
        };
        let (value, from) = match own.map(plain) {
            Some(own) => (own, "stated"),
            None => default(key),
        };
        (key.name.to_owned(), json!({"value": value, "from": from}))
    };
    Value::Object(keys.iter().map(entry).collect())
}

/// What holds of a key that the file leaves out, in the file's unit.
fn default(file: &CaskFile, table: &str, key: &str) -> Value {
    let CaskFile { cask, drop, .. } = file;
    if let Some(tolerance) = TOLERANCES.iter().find(|of| table == "tolerance" && of.key == key) {
        // Free of the last digits of the conversion.
        return json!((1e9 * tolerance.value_in_file(file.tolerances, cask)).round() / 1e9);
    }
    match (table, key) {
        ("cask", "name") => json!(cask.name),
        ("cask", "height_m") => json!(cask.height_m),
        ("cask", "cog_m") => json!(cask.cog_m),
        ("cask", "inertia_kg_m2") => json!(cask.inertia_kg_m2),
        ("drop", "height_m") => json!(drop.height_m),
        ("drop", "impact_velocity_m_s") => json!(drop.impact_velocity_m_s),
        ("drop", "gravity_m_s2") => json!(drop.gravity_m_s2),
        ("drop", "angular_velocity_deg_s") => json!(drop.angular_velocity_rad_s.to_degrees()),
        ("drop", "horizontal_velocity_m_s") => json!(0.0),
        ("contact", "friction") => json!(Contact::Unknown.to_string()),
        ("corrections", _) => json!(true),
        _ => Value::Null,
    }
}
