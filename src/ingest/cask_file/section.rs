//! A TOML table to values that know their place, each wrong one to a diagnostic under its line.

use super::cells::{ExpandedCaskFile, ListPlace, SENSORS};
use super::fault::WrongLine;
use super::wording::{described, line_of, nearest, number_with_unit, unit_mend};
use crate::data::keys::{self, Key, KeyTable};
use crate::ingest::IngestError;
use miette::NamedSource;
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A kind of file: what a person calls it, its keys that stand in no table, and its tables with their keys.
pub(crate) struct Kind {
    /// "the cask file".
    pub name: &'static str,
    pub root: &'static [&'static str],
    pub tables: &'static [KeyTable],
}

/// The key of the cask file that names the house file.
pub(super) const HOUSE: &str = "house";

/// The cask file.
pub(crate) const CASK_FILE: Kind =
    Kind { name: "the cask file", root: &[SENSORS, HOUSE], tables: &keys::TABLES };
/// The file of a house, which cask files name.
pub(super) const HOUSE_FILE: Kind = Kind { name: "the house file", root: &[], tables: &keys::OF_HOUSE };

/// The tables of which a file may have any number.
const LISTS: [&str; 2] = ["channel", "mode"];

/// Tables that only scenes have.
const OF_SCENES: [&str; 4] = ["first_end", "second_end", "mode", "body"];

/// Quotes that an editor for letters sets.
const TYPOGRAPHIC: [char; 7] = ['“', '”', '„', '‘', '’', '«', '»'];

/// The tables whose keys are the user's own.
const OWN_NAMES: [&str; 2] = ["more", "columns"];

/// A table as a person finds it in a file.
fn titled(name: &str) -> String {
    match name {
        "" => "the file".into(),
        name if LISTS.contains(&name) => format!("[[{name}]]"),
        name @ ("source" | "where") => format!("{name} = {{ … }}"),
        "observation" => "{ value = …, u95 = … }".into(),
        "limit" => "{ least = …, most = … }".into(),
        "more" => "[test.more]".into(),
        "columns" => "{ CHANNEL = \"column\" }".into(),
        name => format!("[{name}]"),
    }
}

/// A file's text with its name and its kind.
pub(crate) struct Document<'a> {
    kind: &'static Kind,
    path: &'a Path,
    text: Cow<'a, str>,
    /// The sensor list whose tables stand at the end of the text.
    expanded: Option<&'a ExpandedCaskFile>,
}

/// The text with U+2212, which reports print before numbers, as the minus that TOML knows. Every other byte
/// keeps its place.
#[must_use]
pub fn with_ascii_minus(text: &str) -> Cow<'_, str> {
    const PRINTED: &str = "−";
    let mut ascii = Cow::Borrowed(text);
    let refused = DeTable::parse_recoverable(text).1.into_iter().filter_map(|error| error.span());
    for at in refused
        .map(|span| span.start)
        .filter(|at| text.get(*at..).is_some_and(|rest| rest.starts_with(PRINTED)))
    {
        ascii.to_mut().replace_range(at..at + PRINTED.len(), "  -");
    }
    ascii
}

/// A table of the file whose keys are all known.
pub(crate) struct Section<'a> {
    document: &'a Document<'a>,
    name: &'static str,
    pub(super) table: DeTable<'a>,
    span: Range<usize>,
}

impl<'a> Document<'a> {
    pub(crate) fn new(kind: &'static Kind, path: &'a Path, text: &'a str) -> Self {
        Self { kind, path, text: with_ascii_minus(text), expanded: None }
    }

    /// The file with the tables of its sensor list, where it has one.
    pub(super) fn with_list(
        kind: &'static Kind,
        path: &'a Path,
        text: &'a str,
        expanded: Option<&'a ExpandedCaskFile>,
    ) -> Self {
        let text = expanded.map_or(text, |expanded| &expanded.text);
        Self { expanded, ..Self::new(kind, path, text) }
    }

    /// The cell of the sensor list that a place in the text comes from.
    fn in_list(&self, at: usize) -> Option<(&'a ExpandedCaskFile, ListPlace)> {
        let expanded = self.expanded?;
        Some((expanded, expanded.list.place(at.checked_sub(expanded.from)?)))
    }

    /// The file's top level.
    pub(crate) fn root(&'a self) -> Result<Section<'a>, IngestError> {
        match DeTable::parse(&self.text) {
            Ok(table) => self.section("", table.into_inner(), 0..0),
            Err(error) => Err(self.syntax(&error)),
        }
    }

    fn section(
        &'a self,
        name: &'static str,
        table: DeTable<'a>,
        span: Range<usize>,
    ) -> Result<Section<'a>, IngestError> {
        let section = Section { document: self, name, table, span };
        if OWN_NAMES.contains(&name) {
            return Ok(section);
        }
        match section.table.keys().find(|key| !section.keys().contains(&key.get_ref().as_ref())) {
            Some(key) => Err(section.unknown_key(key)),
            None => Ok(section),
        }
    }

    fn wrong(&self, span: Range<usize>, message: String, mend: String) -> IngestError {
        let start = span.start.min(self.text.len());
        let (path, text, place) = if let Some((whole, place)) = self.in_list(start) {
            (&*whole.list.path, &*whole.list.text, place)
        } else {
            let span = start..span.end.clamp(start, self.text.len());
            let line = line_of(self.text.as_bytes(), start);
            (self.path, &*self.text, ListPlace { line, words: String::new(), span })
        };
        let (ListPlace { line, words, span }, path) = (place, path.display().to_string());
        let (text, message) = (NamedSource::new(&path, text.to_owned()), [words, message].concat());
        Box::new(WrongLine { path, line, message, text, span: span.into(), mend }).into()
    }

    /// What the parser of TOML objects to, with the slips that are usual in files written by hand.
    fn syntax(&self, error: &toml::de::Error) -> IngestError {
        const FORM: &str = "each line is `key = value` or a table's name in brackets such as [cask], each \
                            once; words stand between two quotes, name = \"A1\", numbers have a decimal \
                            point";
        let span = error.span().unwrap_or(0..0);
        let start = span.start.min(self.text.len());
        let from = self.text.as_bytes()[..start].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        let line = self.text.get(from..).unwrap_or("").lines().next().unwrap_or("");
        let (key, value) = line.split_once('=').unwrap_or_default();
        let value = value.split('#').next().unwrap_or("").trim();
        let point = value.replace(',', ".");
        let (message, mend) = if value.contains(',') && point.parse::<f64>().is_ok() {
            (format!("{value} has a decimal comma"), format!("write a decimal point: {point}"))
        } else if let Some((number, unit)) = number_with_unit(value) {
            (format!("{value} has a unit behind the number"), unit_mend(key.trim(), number, unit))
        } else if let Some(quote) = line.chars().find(|c| TYPOGRAPHIC.contains(c)) {
            (
                format!("{quote} is a typographic quote"),
                "write straight ones, such as name = \"A1\"".to_owned(),
            )
        } else if line.starts_with('[') && error.message().starts_with("duplicate key") {
            let mend = "each of several has two brackets, as [[channel]]; keep one of any other table";
            (format!("{} stands more than once", line.trim()), mend.to_owned())
        } else {
            let said = error.message().lines().next().unwrap_or("this is no TOML");
            (format!("this is not TOML: {said}"), FORM.to_owned())
        };
        self.wrong(span, message, mend)
    }
}

impl<'a> Section<'a> {
    /// The names of its keys, and those of the tables in the file itself.
    fn keys(&self) -> Vec<&'static str> {
        let Kind { root, tables, .. } = self.document.kind;
        if let Some(table) = tables.iter().find(|table| table.name == self.name) {
            return table.keys.iter().map(|key| key.name).collect();
        }
        let names = tables.iter().map(|table| table.name);
        root.iter().copied().chain(names.filter(|name| !keys::INNER_TABLES.contains(name))).collect()
    }

    /// The row of a key.
    pub(crate) fn row(&self, key: &str) -> Option<&'static Key> {
        let table = self.document.kind.tables.iter().find(|table| table.name == self.name)?;
        table.keys.iter().find(|row| row.name == key)
    }

    /// Where a key's value stands; where it is left out, its table.
    pub(super) fn place(&self, key: &str) -> Range<usize> {
        self.value(key).map_or_else(|| self.span.clone(), Spanned::span)
    }

    pub(crate) fn value(&self, key: &str) -> Option<&Spanned<DeValue<'a>>> {
        self.table.get(key)
    }

    /// A diagnostic at `span`.
    pub(super) fn wrong(&self, span: Range<usize>, message: String, mend: &str) -> IngestError {
        self.document.wrong(span, message, mend.to_owned())
    }

    /// The refusal of what stands behind `key`, or of the table that lacks it.
    pub(crate) fn refuse(&self, key: &str, message: impl Into<String>, mend: &str) -> IngestError {
        self.wrong(self.place(key), message.into(), mend)
    }

    /// The line of a key.
    pub(crate) fn line(&self, key: &str) -> usize {
        let at = self.place(key).start;
        let in_list = self.document.in_list(at).map(|(_, place)| place.line);
        in_list.unwrap_or_else(|| line_of(self.document.text.as_bytes(), at))
    }

    pub(crate) fn missing(&self, key: &str, mend: &str) -> IngestError {
        self.refuse(key, format!("{} has no {key}", titled(self.name)), mend)
    }

    fn unknown_key(&self, key: &Spanned<toml::de::DeString<'a>>) -> IngestError {
        let word: &str = key.get_ref();
        let what = if self.name.is_empty() { "table" } else { "key" };
        let known = self.keys();
        let tables = self.document.kind.tables;
        let others: Vec<String> = tables
            .iter()
            .filter(|table| table.name != self.name && !keys::INNER_TABLES.contains(&table.name))
            .filter(|table| table.keys.iter().any(|key| key.name == word))
            .map(|table| titled(table.name))
            .collect();
        let (title, all) = (titled(self.name), known.join(", "));
        let hint = match nearest(word, &known) {
            _ if self.name.is_empty() && OF_SCENES.contains(&word) => {
                "a file with it is a scene, of which `dropcheck synth` makes a recording and its cask file; "
                    .into()
            }
            _ if !others.is_empty() => format!("{word} belongs in {}; ", others.join(" or ")),
            Some(near) => format!("did you mean {near}? "),
            None => String::new(),
        };
        let message = format!("{title} knows no {what} {word}");
        self.wrong(key.span(), message, &format!("{hint}{title} takes: {all}"))
    }

    /// The table `key`; an empty one where there is none.
    pub(crate) fn table(&self, key: &'static str) -> Result<Section<'a>, IngestError> {
        self.table_as(key, key)
    }

    /// The same, whose keys are those of the table `name`.
    pub(super) fn table_as(&self, key: &str, name: &'static str) -> Result<Section<'a>, IngestError> {
        let Some(value) = self.value(key) else {
            return Ok(Section { document: self.document, name, table: DeTable::new(), span: 0..0 });
        };
        match value.get_ref() {
            DeValue::Table(table) => self.document.section(name, table.clone(), value.span()),
            found => {
                let mend = if name == key {
                    format!("write [{key}] once, on a line of its own, and its keys on the lines below")
                } else {
                    self.form(key)
                };
                let message = format!("{key} is {}, not a table {}", described(found), titled(name));
                Err(self.refuse(key, message, &mend))
            }
        }
    }

    pub(crate) fn required_table(&self, key: &'static str) -> Result<Section<'a>, IngestError> {
        let table = self.table(key)?;
        if self.value(key).is_some() {
            return Ok(table);
        }
        let message = format!("{} has no [{key}]", self.document.kind.name);
        let mend = format!("add a line [{key}] and below it its keys: {}", table.keys().join(", "));
        Err(self.refuse(key, message, &mend))
    }

    /// The tables `[[key]]`.
    pub(crate) fn tables(&self, key: &'static str) -> Result<Vec<Section<'a>>, IngestError> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let section = |item: &Spanned<DeValue<'a>>| {
            let table = item.get_ref().as_table()?;
            Some(self.document.section(key, table.clone(), item.span()))
        };
        let sections = value.get_ref().as_array().and_then(|items| items.iter().map(section).collect());
        sections.unwrap_or_else(|| {
            let mend = format!("each {key} begins with a line [[{key}]], with two brackets");
            Err(self.refuse(key, format!("{key} is not a list of tables"), &mend))
        })
    }
}
