//! The text of a cask file to what it states, and to a text that states one thing otherwise.

use dropcheck::stages::{Key, KeyTable, TABLES, Takes};
use miette::{IntoDiagnostic, Report, miette};
use serde_json::{Value, json};
use toml_edit::{DocumentMut, Item, Table};

/// The keys of a cask file, each table with its own.
pub fn keys() -> Value {
    let table = |table: &KeyTable| {
        let keys: Vec<Value> = table.keys.iter().map(key).collect();
        json!({ "table": table.name, "remark": table.remark, "keys": keys })
    };
    TABLES.iter().map(table).collect()
}

fn key(key: &Key) -> Value {
    let (takes, allowed) = match key.takes {
        Takes::Number(allowed) => ("number", allowed.words()),
        Takes::Flag => ("flag", String::new()),
        Takes::Date => ("date", String::new()),
        Takes::Texts => ("texts", String::new()),
        Takes::Text => ("text", String::new()),
        Takes::TextOrNumber | Takes::TextOrTable | Takes::Table | Takes::Observation => {
            ("other", String::new())
        }
    };
    json!({
        "name": key.name,
        "takes": takes,
        "allowed": allowed,
        "default": key.default,
        "example": key.example,
        "remark": key.remark,
        "asked": key.is_asked,
    })
}

/// What a cask file states, as JSON.
///
/// # Errors
/// It is no TOML.
pub fn values(text: &str) -> Result<Value, Report> {
    toml::from_str(text).into_diagnostic()
}

/// The text with the key at `path` as `value`, or without it; all else stays as it is written.
///
/// # Errors
/// The text or the value is no TOML, or the path leads nowhere.
pub fn edited(text: &str, path: &str, value: Option<&str>) -> Result<String, Report> {
    let mut document: DocumentMut = text.parse().into_diagnostic()?;
    let nowhere = || miette!("the cask file has no place {path}");
    let (table, key) = match path.split('.').collect::<Vec<_>>()[..] {
        ["channel", number] if value.is_none() => {
            let channels = document["channel"].as_array_of_tables_mut().ok_or_else(nowhere)?;
            let number = number.parse().ok().filter(|number| *number < channels.len());
            channels.remove(number.ok_or_else(nowhere)?);
            return Ok(document.to_string());
        }
        ["channel", number, key] => {
            let channels = document["channel"].as_array_of_tables_mut().ok_or_else(nowhere)?;
            let number = number.parse().into_diagnostic()?;
            (channels.get_mut(number).ok_or_else(nowhere)?, key)
        }
        [table, key] => {
            let table = document.entry(table).or_insert(Item::Table(Table::new()));
            (table.as_table_mut().ok_or_else(nowhere)?, key)
        }
        _ => return Err(nowhere()),
    };
    match (value, table.get_mut(key)) {
        (None, _) => drop(table.remove(key)),
        (Some(value), stated) => {
            let mut value: toml_edit::Value = value.parse().into_diagnostic()?;
            match stated.and_then(Item::as_value_mut) {
                // The remark behind the line stays.
                Some(stated) => {
                    *value.decor_mut() = stated.decor().clone();
                    *stated = value;
                }
                None => drop(table.insert(key, Item::Value(value))),
            }
        }
    }
    Ok(document.to_string())
}

/// The key that a line of the text states, as `table.key` or `channel.0.key`.
pub fn key_at(text: &str, line: usize) -> Option<String> {
    let (mut table, mut channels) = (String::new(), 0_usize);
    let mut key = None;
    for text in text.lines().take(line).map(str::trim) {
        if let Some(name) = text.strip_prefix('[') {
            let name = name.trim_start_matches('[');
            name[..name.find(']')?].clone_into(&mut table);
            if text.starts_with("[[") {
                table = format!("{table}.{channels}");
                channels += 1;
            }
            key = None;
        } else {
            key = text.split_once('=').map(|(key, _)| key.trim().to_owned());
        }
    }
    key.map(|key| format!("{table}.{key}"))
}
