//! The text of a cask file to what it states, and to a text that states one thing otherwise.

use dropcheck::cask_file::with_ascii_minus;
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
    toml::from_str(&with_ascii_minus(text)).into_diagnostic()
}

/// The text with the key at `path` as `value`, or without it; a path without a key takes a channel out. All else
/// stays as it is written: a line of the form that has the key behind # comes to hold it, and goes back there.
///
/// # Errors
/// The text or the value is no TOML, or the path leads nowhere.
pub fn edited(text: &str, path: &str, value: Option<&str>) -> Result<String, Report> {
    let text = &*with_ascii_minus(text);
    let nowhere = || miette!("the cask file has no place {path}");
    let place = match path.split('.').collect::<Vec<_>>()[..] {
        ["channel", number] => Place { table: "channel", number: number.parse().into_diagnostic()?, key: "" },
        ["channel", number, key] => {
            Place { table: "channel", number: number.parse().into_diagnostic()?, key }
        }
        [table, key] => Place { table, number: 0, key },
        _ => return Err(nowhere()),
    };
    let Some(value) = value else {
        let mut document: DocumentMut = text.parse().into_diagnostic()?;
        place.take_out(&mut document).ok_or_else(nowhere)?;
        let without = document.to_string();
        let behind = if place.key.is_empty() { place.cut(text) } else { place.turned(text, "", "# ") };
        return Ok(behind.filter(|behind| states(behind) == states(&without)).unwrap_or(without));
    };
    let turned = || place.turned(text, "# ", "").and_then(|turned| turned.parse().ok());
    let mut document: DocumentMut = text.parse().into_diagnostic()?;
    if !place.table_of(&mut document).is_some_and(|table| table.contains_key(place.key)) {
        document = turned().unwrap_or(document);
    }
    if place.table != "channel" {
        document.entry(place.table).or_insert(Item::Table(Table::new()));
    }
    let table = place.table_of(&mut document).ok_or_else(nowhere)?;
    let mut value: toml_edit::Value = value.parse().into_diagnostic()?;
    match table.get_mut(place.key).and_then(Item::as_value_mut) {
        // The remark behind the line stays.
        Some(stated) => {
            *value.decor_mut() = stated.decor().clone();
            *stated = value;
        }
        None => drop(table.insert(place.key, Item::Value(value))),
    }
    Ok(document.to_string())
}

/// A key in a cask file; "" for its whole table.
struct Place<'a> {
    table: &'a str,
    number: usize,
    key: &'a str,
}

impl Place<'_> {
    fn table_of<'d>(&self, document: &'d mut DocumentMut) -> Option<&'d mut Table> {
        match document.get_mut(self.table)? {
            Item::ArrayOfTables(tables) => tables.get_mut(self.number),
            other => other.as_table_mut(),
        }
    }

    fn take_out(&self, document: &mut DocumentMut) -> Option<()> {
        if self.key.is_empty() {
            let channels = document.get_mut(self.table)?.as_array_of_tables_mut()?;
            (self.number < channels.len()).then(|| drop(channels.remove(self.number)))
        } else {
            self.table_of(document).map(|table| drop(table.remove(self.key)))
        }
    }

    /// Where the lines of the table begin, the head behind # or not, and where those of the next one do.
    fn lines(&self, lines: &[&str]) -> Option<(usize, usize)> {
        // A channel behind # is none yet.
        let counts = |line: &str| self.table != "channel" || line.starts_with('[');
        let is_mine = |line: &str| head(line) == Some(self.table) && counts(line);
        let start = (0..lines.len()).filter(|i| is_mine(lines[*i])).nth(self.number)?;
        let end = (start + 1..lines.len()).find(|i| head(lines[*i]).is_some());
        Some((start, end.unwrap_or(lines.len())))
    }

    /// The text where the line of the key, and the head of its table, begin with `to` in place of `from`.
    fn turned(&self, text: &str, from: &str, to: &str) -> Option<String> {
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        let (start, end) = self.lines(&lines)?;
        let key = |line: &str| Some(line.strip_prefix(from)?.split_once('=')?.0.trim() == self.key);
        let mine = (start..end).find(|i| key(lines[*i]) == Some(true))?;
        let is_turned = |i: usize| i == mine || i == start && to.is_empty();
        let line = |(i, line): (usize, &&str)| match line.strip_prefix(from).filter(|_| is_turned(i)) {
            Some(rest) => format!("{to}{rest}"),
            None => (*line).to_owned(),
        };
        Some(lines.iter().enumerate().map(line).collect())
    }

    /// The text without the lines of the table, to the first empty one.
    fn cut(&self, text: &str) -> Option<String> {
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        let (start, end) = self.lines(&lines)?;
        let empty = (start..end).find(|i| lines[*i].trim().is_empty());
        Some([&lines[..start], &lines[empty.map_or(end, |empty| empty + 1)..]].concat().concat())
    }
}

/// The table that a line begins, behind # or not.
fn head(line: &str) -> Option<&str> {
    let (name, rest) = line.strip_prefix("# ").unwrap_or(line).strip_prefix('[')?.split_once(']')?;
    let rest = rest.trim_start_matches(']').trim();
    (rest.is_empty() || rest.starts_with('#')).then(|| name.trim_start_matches('['))
}

/// What a text states, to compare: nan equals nan.
fn states(text: &str) -> Option<String> {
    text.parse::<toml::Table>().ok().map(|table| table.to_string())
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
