//! A cask file and what a table of tests states instead of some of its keys to the cask file of one test.

use super::section::with_ascii_minus;
use super::{CASK_FILE, no_cask_file, of_bytes, read, text};
use crate::data::CaskFile;
use crate::data::keys::{CHANNEL, INNER_TABLES, Key, TABLES, Takes};
use crate::ingest::IngestError;
use std::path::Path;
use std::str::FromStr;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// The key that a column is named like: `drop.angle_deg`, or `channel.A1.polarity` of the channel A1. `None`:
/// it is named like no table.
///
/// # Errors
/// A sentence where it is named like a table, and like none of its keys.
pub fn key_of_column(column: &str) -> Result<Option<&'static Key>, String> {
    let Some((table, name)) = column.split_once('.') else { return Ok(None) };
    let (keys, name) = match table {
        "channel" => (&CHANNEL[..], name.rsplit_once('.').map_or("", |(_, key)| key)),
        _ => match TABLES.iter().find(|known| known.name == table && !INNER_TABLES.contains(&table)) {
            Some(known) => (known.keys, name),
            None => return Ok(None),
        },
    };
    if let Some(key) = keys.iter().find(|key| key.name == name) {
        return Ok(Some(key));
    }
    let near = keys
        .iter()
        .max_by(|a, b| strsim::jaro_winkler(a.name, name).total_cmp(&strsim::jaro_winkler(b.name, name)));
    let near = near.map_or("", |key| key.name);
    let example = if table == "channel" { format!("channel.A1.{near}") } else { format!("{table}.{near}") };
    Err(format!("{column} is no key of the cask file; did you mean {example}?"))
}

/// Reads and checks the cask file at `path` with these columns' values in place of its own; its text is then
/// the changed one.
///
/// # Errors
/// [`IngestError`], of the file or of a value.
pub fn with_columns(path: &Path, columns: &[(String, String)]) -> Result<CaskFile, IngestError> {
    let bytes = read(path, &CASK_FILE)?;
    let photos = Some(path.parent().unwrap_or(Path::new("")));
    if columns.is_empty() {
        return of_bytes(path, &bytes, photos);
    }
    let own = text(path, &bytes, &CASK_FILE)?;
    // What is no TOML the parser of the cask file says better.
    let Ok(mut document) = DocumentMut::from_str(&with_ascii_minus(own)) else {
        return of_bytes(path, &bytes, photos);
    };
    for (column, words) in columns {
        let mend = "mend the cell, or leave it empty: then the cask file's own value holds";
        set(&mut document, column, words).map_err(|problem| no_cask_file(path, &problem, mend))?;
    }
    of_bytes(path, document.to_string().as_bytes(), photos)
}

fn set(document: &mut DocumentMut, column: &str, words: &str) -> Result<(), String> {
    let Some(key) = key_of_column(column)? else { return Ok(()) };
    let (table, name) = column.split_once('.').unwrap_or_default();
    let place: Option<&mut dyn TableLike> = if table == "channel" {
        let channel = name.rsplit_once('.').map_or("", |(channel, _)| channel);
        let all = document.get_mut(table).and_then(Item::as_array_of_tables_mut);
        let named = |of: &&mut toml_edit::Table| of.get("name").and_then(Item::as_str) == Some(channel);
        let own = all.and_then(|all| all.iter_mut().find(named));
        Some(own.ok_or_else(|| format!("{column}: there is no [[channel]] with name = \"{channel}\""))?)
    } else {
        document.entry(table).or_insert_with(toml_edit::table).as_table_like_mut()
    };
    let place = place.ok_or_else(|| format!("{column}: {table} is no table there"))?;
    place.insert(key.name, Item::Value(value(key, words.trim())));
    Ok(())
}

/// A cell as the value that its key takes, where it can be; else a text, which is refused as that of a file.
pub(super) fn value(key: &Key, words: &str) -> Value {
    #[allow(clippy::cast_possible_truncation, reason = "whole and small, tested before")]
    let number = || {
        let number: f64 = words.replace(',', ".").parse().ok()?;
        let is_whole = number.fract() == 0.0 && number.abs() < 1e15;
        Some(if is_whole { Value::from(number as i64) } else { Value::from(number) })
    };
    let value = match key.takes {
        Takes::Text => None,
        Takes::TextOrTable => words.parse().ok().filter(Value::is_inline_table),
        Takes::TextOrNumber | Takes::Number(_) => number(),
        Takes::Flag => words.to_lowercase().parse::<bool>().ok().map(Value::from),
        Takes::Date | Takes::Texts | Takes::Table | Takes::Observation => words.parse().ok(),
    };
    value.unwrap_or_else(|| words.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASK: &str = "# ours\n[cask]\nmass_kg = 10.0\nlength_m = 2.0 # measured\nheight_m = 0.4\n[drop]\n\
                        height_m = 1\nangle_deg = 5.0\n[[channel]]\nname = \"A1\"\nend = \"first\"\naxis = \
                        \"transverse\"\nsource = \"a\"\nposition_m = 0.1\n";

    fn with(columns: &[(&str, &str)]) -> Result<CaskFile, IngestError> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), CASK).unwrap();
        let owned: Vec<_> = columns.iter().map(|(c, w)| ((*c).to_owned(), (*w).to_owned())).collect();
        with_columns(file.path(), &owned)
    }

    #[test]
    fn a_column_takes_the_place_of_a_key_and_the_rest_stays() {
        assert_eq!(with(&[]).unwrap().text, CASK);
        let file = with(&[
            ("drop.angle_deg", "12,5"),
            ("test.date", "2026-01-05"),
            ("channel.A1.polarity", "-1"),
            ("contact.friction", "smooth"),
        ])
        .unwrap();
        assert!((file.drop.angle_rad.to_degrees() - 12.5).abs() < 1e-12);
        assert_eq!((file.channels[0].polarity, file.test.date.as_deref()), (-1.0, Some("2026-01-05")));
        assert!(file.text.starts_with("# ours\n") && file.text.contains("2.0 # measured"), "{}", file.text);
        // The text alone gives the same again.
        let again = super::super::of_text(&file.path, &file.text).unwrap();
        assert_eq!(again.drop, file.drop);
    }

    #[test]
    fn what_cannot_be_is_said_with_its_column() {
        for (column, words, part) in [
            ("drop.angle_deg", "steep", "angle_deg is the text \"steep\", not a number"),
            ("drop.angle_deg", "95", "95"),
            ("drop.angel_deg", "5", "did you mean drop.angle_deg?"),
            ("channel.B9.polarity", "1", "no [[channel]] with name = \"B9\""),
            ("corrections.hum", "perhaps", "true or false"),
        ] {
            let error = with(&[(column, words)]).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        assert!(key_of_column("drop.comment").is_err() && key_of_column("remark.drop").unwrap().is_none());
    }
}
