//! Columns of a campaign's line, a result or the reason why there is none: one name for each input and
//! result.

use crate::data::Estimate;
use crate::data::keys::{TABLES, Takes};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Columns by name.
pub(super) type Columns = BTreeMap<String, Value>;

/// A column of `campaign.csv`, or columns that belong together: value and half-width of a measured quantity.
#[derive(Debug)]
pub struct CampaignColumn {
    /// The names.
    pub names: Vec<String>,
    /// Content of the column.
    pub meaning: &'static str,
    /// Path of the value in a line; "-" if it combines several values.
    place: String,
}

/// The columns of every `campaign.csv`: those of the table, and the keys of the cask file except those of
/// channels. Columns of the manifest follow.
pub fn campaign_columns() -> &'static [CampaignColumn] {
    static ALL: LazyLock<Vec<CampaignColumn>> = LazyLock::new(|| {
        let mut all: Vec<CampaignColumn> = Vec::new();
        for line in include_str!("columns.tsv").lines().filter(|line| !line.starts_with('#')) {
            let [names, place, meaning] = [0, 1, 2].map(|i| line.split('\t').nth(i).unwrap_or_default());
            let names = names.split(' ').map(str::to_owned).collect();
            all.push(CampaignColumn { names, meaning, place: place.to_owned() });
        }
        let is_listed = |place: &String| all.iter().any(|column| column.place == *place);
        let tables = TABLES.iter().take_while(|table| table.name != "channel");
        let keys = tables.flat_map(|table| table.keys.iter().map(move |key| (table.name, key)));
        let keys =
            keys.filter(|(_, key)| !matches!(key.takes, Takes::Observation | Takes::Table | Takes::Texts));
        let stated = keys.map(|(table, key)| CampaignColumn {
            names: vec![format!("{table}.{}", key.name)],
            meaning: if key.remark.is_empty() { "key of the cask file" } else { key.remark },
            place: format!("/settings/{table}/{}/value", key.name),
        });
        let stated: Vec<CampaignColumn> = stated.filter(|column| !is_listed(&column.place)).collect();
        all.into_iter().chain(stated).collect()
    });
    &ALL
}

/// The names of all of them.
pub(super) fn names<'a>() -> impl Iterator<Item = &'a str> {
    campaign_columns().iter().flat_map(|column| &column.names).map(String::as_str)
}

/// Columns of the manifest, except those whose name is in use.
pub(super) fn extras(line: &Value) -> impl Iterator<Item = (&String, &Value)> {
    let own = line["campaign"]["carried"].as_object().into_iter().flatten();
    own.filter(|(name, _)| names().all(|taken| taken != *name))
}

/// All columns of a line except those of its row.
pub(super) fn line_columns(line: &Value) -> Columns {
    let mut columns: Columns = extras(line).map(|(name, value)| (name.clone(), value.clone())).collect();
    let mut put = |name: &str, value: Option<&Value>| {
        columns.extend(value.filter(|value| is_cell(value)).map(|value| (name.to_owned(), value.clone())));
    };
    for CampaignColumn { names, place, .. } in campaign_columns() {
        match &names[..] {
            [value, u95] => {
                put(value, line.pointer(&format!("{place}/value")));
                put(u95, line.pointer(&format!("{place}/u95")));
            }
            names => put(&names[0], line.pointer(place)),
        }
    }
    for seen in line["observed"].as_array().into_iter().flatten() {
        let name = format!("observed_{}", seen["name"].as_str().unwrap_or_default());
        for (end, from) in [("", "/observed/value"), ("_u95", "/observed/u95"), ("_e_n", "/e_n")] {
            put(&format!("{name}{end}"), seen.pointer(from).filter(|value| value.is_number()));
        }
    }
    // For rod and body the borderline cases come first, rough and smooth with k of 0 and 1, then the drop's
    // own k.
    let mut cases = [0; 2];
    for case in line["predictions"].as_array().into_iter().flatten() {
        let [model, contact] = ["model", "contact"].map(|key| case[key].as_str().unwrap_or_default());
        let count = &mut cases[usize::from(model == "rod")];
        *count += 1;
        let name = match *count {
            ..=4 => format!("borderline_{model}_{contact}_k{}_m_s", case["k"].as_f64().unwrap_or(f64::NAN)),
            _ => format!("predicted_{model}_own_k_m_s"),
        };
        put(&name, case.get("slap_down_speed_m_s"));
    }
    columns
}

/// A measured quantity with its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NamedQuantity {
    pub(super) name: &'static str,
    pub(super) estimate: Estimate,
}

/// All measured quantities of a line; times that count from its first sample do not belong to the drop.
pub(super) fn quantities(line: &Value) -> Vec<NamedQuantity> {
    let is_of_drop =
        |column: &&CampaignColumn| !["/time", "/start"].iter().any(|end| column.place.ends_with(end));
    let quantity = |column: &CampaignColumn| {
        let estimate = Estimate::deserialize(line.pointer(&column.place)?).ok()?;
        Some(NamedQuantity { name: column.meaning, estimate })
    };
    campaign_columns().iter().filter(is_of_drop).filter_map(quantity).collect()
}

/// True if a value fits in a cell.
fn is_cell(value: &Value) -> bool {
    value.is_number() || value.is_boolean() || value.as_str().is_some_and(|text| !text.is_empty())
}
