//! A line of a campaign, a result or why there is none, to columns: every input and result by one name each.

use crate::data::Estimate;
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Columns by group and name, in the order of the tables.
pub(super) type Columns = BTreeMap<(u8, String), Value>;

/// A measured quantity by its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NamedQuantity {
    pub(super) name: String,
    pub(super) estimate: Estimate,
}

/// Groups in the order of the tables: what the manifest carries, results, what was stated, hashes.
const CARRIED: u8 = 1;
const RESULT: u8 = 2;
const STATED: u8 = 3;
const HASH: u8 = 4;

/// Parts of a result whose quantities are columns, and what their names begin with.
const PARTS: [(&str, &str); 6] = [
    ("/first_impact", "first_impact_"),
    ("/slap_down", "slap_down_"),
    ("/k", "k"),
    ("/amplification", "amplification"),
    ("/impacts/0", "impact_1_"),
    ("/impacts/1", "impact_2_"),
];

/// Every column of a line beyond those of the head.
pub(super) fn of(line: &Value) -> Columns {
    let mut columns = Columns::new();
    for (name, value) in objects(&line["campaign"]["carried"]) {
        columns.insert((CARRIED, name.clone()), value.clone());
    }
    for NamedQuantity { name, estimate: Estimate { value, u95, unit } } in quantities(line) {
        let unit = suffix(unit);
        columns.insert((RESULT, format!("{name}{unit}")), value.into());
        columns.insert((RESULT, format!("{name}_u95{unit}")), u95.into());
    }
    let notes = line["quality"].as_array().into_iter().flatten().filter(|found| found["severity"] == "note");
    let notes: BTreeSet<&str> = notes.filter_map(|found| found["code"].as_str()).collect();
    if !notes.is_empty() {
        columns.insert((RESULT, "notes".to_owned()), notes.into_iter().collect::<Vec<_>>().join(" ").into());
    }
    let mut put = |name: String, value: Option<&Value>| {
        columns.extend(value.filter(|value| is_cell(value)).map(|value| ((RESULT, name), value.clone())));
    };
    for (name, from) in [
        ("predicted_u95_m_s", "/comparison/predicted_u95"),
        ("rung", "/reconstruction/rung"),
        ("model_rung", "/model/rung"),
    ] {
        put(name.to_owned(), line.pointer(from));
    }
    for seen in line["observed"].as_array().into_iter().flatten() {
        let name = format!("observed_{}", seen["name"].as_str().unwrap_or_default());
        for (end, from) in [("", "/observed/value"), ("_u95", "/observed/u95"), ("_e_n", "/e_n")] {
            put(format!("{name}{end}"), seen.pointer(from).filter(|value| value.is_number()));
        }
    }
    // The borderlines: rod and body, rough and smooth, k of 0 and 1.
    for case in line["predictions"].as_array().into_iter().flatten() {
        let [model, contact] = ["model", "contact"].map(|key| case[key].as_str().unwrap_or_default());
        let name = format!("borderline_{model}_{contact}_k{}_m_s", case["k"].as_f64().unwrap_or(f64::NAN));
        put(name, case.get("slap_down_speed_m_s"));
    }
    for (table, keys) in objects(&line["settings"]) {
        let channels = keys.as_array().into_iter().flatten();
        let named = channels
            .map(|keys| (format!("channel.{}", keys["name"]["value"].as_str().unwrap_or_default()), keys));
        for (table, keys) in named.chain(keys.is_object().then(|| (table.clone(), keys))) {
            let stated = objects(keys).filter(|(_, entry)| is_cell(&entry["value"]));
            columns.extend(
                stated.map(|(key, entry)| ((STATED, format!("{table}.{key}")), entry["value"].clone())),
            );
        }
    }
    for name in ["recording_sha256", "cask_sha256", "format"] {
        columns.extend(line["input"].get(name).map(|value| ((HASH, name.to_owned()), value.clone())));
    }
    columns
}

/// Every measured quantity of a line, in the order of the result's names.
pub(super) fn quantities(line: &Value) -> Vec<NamedQuantity> {
    let mut found = Vec::new();
    for (place, prefix) in PARTS {
        line.pointer(place).into_iter().for_each(|part| collect(part, prefix, &mut found));
    }
    found
}

fn collect(part: &Value, name: &str, found: &mut Vec<NamedQuantity>) {
    if let Ok(estimate) = Estimate::deserialize(part) {
        found.push(NamedQuantity { name: name.to_owned(), estimate });
        return;
    }
    for (key, deeper) in objects(part).filter(|(_, deeper)| deeper.is_object()) {
        collect(deeper, &joined(name, key), found);
    }
    for channel in part["channels"].as_array().into_iter().flatten() {
        collect(channel, &joined(name, channel["name"].as_str().unwrap_or_default()), found);
    }
}

fn joined(name: &str, key: &str) -> String {
    if name.is_empty() || name.ends_with('_') { format!("{name}{key}") } else { format!("{name}_{key}") }
}

/// A unit as the end of a name: "m/s^2" is `_m_s2`, a number has none.
fn suffix(unit: &str) -> String {
    if unit == "1" {
        return String::new();
    }
    let plain = unit.to_lowercase().replace(['/', ' '], "_").replace('^', "");
    format!("_{plain}")
}

fn objects(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

/// Whether a value has room in a cell.
fn is_cell(value: &Value) -> bool {
    value.is_number() || value.is_boolean() || value.as_str().is_some_and(|text| !text.is_empty())
}
