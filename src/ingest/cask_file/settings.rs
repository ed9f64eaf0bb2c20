//! A cask file and what its recording says to every key with its value, in the file's own units, and where
//! that is from.

use crate::data::keys::{self, Key, TABLES};
use crate::data::{CaskFile, Contact, Recording};
use serde_json::{Map, Value, json};

/// Every key of every table, each `{"value", "from"}`; `from` is "stated", "default", "recording", or
/// "command line" for a correction that is switched off there. `channel` is a list. What has no value is
/// null.
#[must_use]
pub fn settings(file: &CaskFile, recording: &Recording) -> Value {
    let stated: toml::Table = file.text.trim_start_matches('\u{feff}').parse().unwrap_or_default();
    let of = |table: &str| stated.get(table).and_then(toml::Value::as_table);
    let single =
        TABLES.iter().filter(|table| table.name != "channel" && !keys::INNER_TABLES.contains(&table.name));
    let mut all: Map<String, Value> = single
        .map(|table| {
            let default = |key: &Key| (default(file, table.name, key.name), "default");
            (table.name.to_owned(), entries(of(table.name), table.keys, &default))
        })
        .collect();
    let made = file.corrections;
    for (key, is_made) in
        [("offset", made.offset), ("zero_shift", made.zero_shift), ("skew", made.skew), ("hum", made.hum)]
    {
        // The file says otherwise, or nothing, where the command line has switched it off.
        if !is_made && all["corrections"][key]["value"] != json!(false) {
            all["corrections"][key] = json!({"value": false, "from": "command line"});
        }
    }
    let channels = stated.get("channel").and_then(toml::Value::as_array).map_or(&[][..], Vec::as_slice);
    let channels = channels.iter().filter_map(toml::Value::as_table);
    let channel = |table: &toml::Table| {
        let name = table.get("name").and_then(toml::Value::as_str);
        let read = recording.channels.iter().find(|c| Some(c.name.as_str()) == name);
        let default = |key: &Key| match key.name {
            "unit" => (json!(read.map(|c| &c.unit)), "recording"),
            "sample_rate_hz" => (json!(read.map(|c| c.sample_rate_hz)), "recording"),
            "offset_m" | "lateral_m" => (json!(0.0), "default"),
            "polarity" => (json!(1), "default"),
            "coupling" => (json!("dc"), "default"),
            "calibration_percent" => (percent(file.tolerances.calibration), "default"),
            "time" => (json!(file.time), "default"),
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

/// A share in percent, free of the last digits of the conversion.
fn percent(share: f64) -> Value {
    rounded(100.0 * share)
}

fn rounded(value: f64) -> Value {
    json!((1e9 * value).round() / 1e9)
}

/// What holds of a key that the file leaves out, in the file's unit.
fn default(file: &CaskFile, table: &str, key: &str) -> Value {
    let CaskFile { cask, drop, tolerances: known, .. } = file;
    match (table, key) {
        ("cask", "name") => json!(cask.name),
        ("cask", "height_m") => json!(cask.height_m),
        ("cask", "cog_m") => json!(cask.cog_m),
        ("cask", "inertia_kg_m2") => json!(cask.inertia_kg_m2),
        ("drop", "height_m") => json!(drop.height_m),
        ("drop", "impact_velocity_m_s") => json!(drop.impact_velocity_m_s),
        ("drop", "gravity_m_s2") => json!(drop.gravity_m_s2),
        ("drop", "angular_velocity_deg_s" | "horizontal_velocity_m_s") => json!(0.0),
        ("contact", "friction") => json!(Contact::Unknown.to_string()),
        ("tolerance", "angle_deg") => rounded(known.angle_rad.to_degrees()),
        ("tolerance", "impact_velocity_percent") => percent(known.impact_velocity),
        ("tolerance", "calibration_percent") => percent(known.calibration),
        ("tolerance", "cross_axis_percent") => percent(known.cross_axis),
        ("tolerance", "position_m") => json!(known.position_m),
        ("tolerance", "length_m") => rounded(known.length * cask.length_m),
        ("tolerance", "height_m") => rounded(known.height * cask.height_m),
        ("tolerance", "angular_velocity_deg_s") => rounded(known.angular_velocity_rad_s.to_degrees()),
        ("tolerance", "horizontal_velocity_m_s") => json!(known.horizontal_velocity_m_s),
        ("tolerance", "cog_m") => json!(known.cog_m),
        ("tolerance", "inertia_percent") => percent(known.inertia),
        ("tolerance", "friction_percent") => percent(known.friction),
        ("tolerance", "clock_percent") => percent(known.clock),
        ("corrections", _) => json!(true),
        _ => Value::Null,
    }
}
