//! A TOML table to values that know their place, each wrong one to a diagnostic under its line.

use super::fault::{THE_CASK_FILE, WrongLine};
use super::wording::{described, line_of, nearest, number_with_unit, unit_mend};
use crate::data::keys::{self, FILL_IN, Key, KeyTable};
use crate::ingest::IngestError;
use miette::NamedSource;
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

/// The cask file.
pub(crate) const CASK_FILE: Kind = Kind { name: THE_CASK_FILE, root: &[], tables: &keys::TABLES };

/// The tables of which a file may have any number.
const LISTS: [&str; 2] = ["channel", "mode"];

/// The table whose keys are the user's own.
const OWN_NAMES: &str = "more";

/// A table as a person finds it in a file.
fn titled(name: &str) -> String {
    match name {
        "" => "the file".into(),
        name if LISTS.contains(&name) => format!("[[{name}]]"),
        name @ ("source" | "where") => format!("{name} = {{ … }}"),
        "observation" => "{ value = …, u95 = … }".into(),
        "limit" => "{ least = …, most = … }".into(),
        "more" => "[test.more]".into(),
        name => format!("[{name}]"),
    }
}

/// A file's text with its name and its kind.
pub(crate) struct Document<'a> {
    kind: &'static Kind,
    path: &'a Path,
    text: &'a str,
}

/// A value with its place in the text.
#[derive(Debug, Clone)]
pub(crate) struct Placed<T> {
    pub value: T,
    pub span: Range<usize>,
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
        Self { kind, path, text }
    }

    /// The file's top level.
    pub(crate) fn root(&'a self) -> Result<Section<'a>, IngestError> {
        match DeTable::parse(self.text) {
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
        if name == OWN_NAMES {
            return Ok(section);
        }
        match section.table.keys().find(|key| !section.keys().contains(&key.get_ref().as_ref())) {
            Some(key) => Err(section.unknown_key(key)),
            None => Ok(section),
        }
    }

    fn wrong(&self, span: Range<usize>, message: String, expected: String, mend: String) -> IngestError {
        let start = span.start.min(self.text.len());
        let end = span.end.clamp(start, self.text.len());
        let line = line_of(self.text.as_bytes(), start);
        let path = self.path.display().to_string();
        Box::new(WrongLine {
            text: NamedSource::new(&path, self.text.to_owned()),
            path,
            line,
            message,
            expected,
            span: (start..end).into(),
            mend,
        })
        .into()
    }

    /// What the parser of TOML objects to, with the slips that are usual in files written by hand.
    fn syntax(&self, error: &toml::de::Error) -> IngestError {
        let span = error.span().unwrap_or(0..0);
        let start = span.start.min(self.text.len());
        let from = self.text.as_bytes()[..start].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        let line = self.text.get(from..).unwrap_or("").lines().next().unwrap_or("");
        let value = line.split_once('=').map_or("", |(_, value)| value);
        let value = value.split('#').next().unwrap_or("").trim();
        let point = value.replace(',', ".");
        let (message, mend) = if value.contains(',') && point.parse::<f64>().is_ok() {
            (format!("{value} has a decimal comma"), format!("write a decimal point: {point}"))
        } else if line.matches('"').count() % 2 == 1 {
            ("a quote is missing".to_owned(), "words stand between two quotes: name = \"A1\"".to_owned())
        } else if error.message().contains("duplicate") {
            (
                format!("{} stands here a second time", line.split('=').next().unwrap_or(line).trim()),
                "delete one of the two; further channels each begin with a line [[channel]]".to_owned(),
            )
        } else if value.starts_with(|c: char| c.is_alphabetic() || c == '/') {
            (format!("{value} stands without quotes"), format!("write words in quotes: \"{value}\""))
        } else if let Some((number, unit)) = number_with_unit(value) {
            (format!("{value} has a unit behind the number"), unit_mend(number, unit))
        } else {
            let said = error.message().lines().next().unwrap_or("this is no TOML").to_owned();
            (
                said,
                "each line is `key = value` or a table's name in brackets such as [cask]; words stand in \
                    quotes, numbers have a decimal point"
                    .to_owned(),
            )
        };
        self.wrong(span, message, "this is not TOML".into(), mend)
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

    /// The table as a person finds it in the file.
    fn title(&self) -> String {
        titled(self.name)
    }

    /// Where the section stands.
    pub(crate) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Where a key's value stands; where it is left out, its table.
    pub(crate) fn place(&self, key: &str) -> Range<usize> {
        self.value(key).map_or_else(|| self.span(), Spanned::span)
    }

    pub(crate) fn value(&self, key: &str) -> Option<&Spanned<DeValue<'a>>> {
        self.table.get(key)
    }

    /// A diagnostic at `span`.
    pub(crate) fn wrong(
        &self,
        span: Range<usize>,
        message: String,
        expected: String,
        mend: &str,
    ) -> IngestError {
        self.document.wrong(span, message, expected, mend.to_owned())
    }

    /// The line number of a place.
    pub(crate) fn line(&self, at: usize) -> usize {
        line_of(self.document.text.as_bytes(), at)
    }

    pub(crate) fn missing(&self, key: &str, mend: &str) -> IngestError {
        let message = format!("{} has no {key}", self.title());
        self.wrong(self.span(), message, format!("{key} is missing here"), mend)
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
        let all = known.join(", ");
        let mend = if others.is_empty() {
            match nearest(word, &known) {
                Some(near) => format!("did you mean {near}? {} takes: {all}", self.title()),
                None => format!("{} takes: {all}", self.title()),
            }
        } else {
            format!("{word} belongs in {}; {} takes: {all}", others.join(" or "), self.title())
        };
        let message = format!("{} knows no {what} {word}", self.title());
        self.wrong(key.span(), message, format!("unknown {what}"), &mend)
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
            _ if name != key => Err(self.wrong(
                value.span(),
                format!("{key} is {}, not a table {}", described(value.get_ref()), titled(name)),
                titled(name),
                &format!("write it as in {}", self.example(key)),
            )),
            _ => Err(self.wrong(
                value.span(),
                format!("{key} is {}, not a table", described(value.get_ref())),
                format!("the table [{key}]"),
                &format!("write [{key}] once, on a line of its own, and its keys on the lines below"),
            )),
        }
    }

    pub(crate) fn required_table(&self, key: &'static str) -> Result<Section<'a>, IngestError> {
        let table = self.table(key)?;
        if self.value(key).is_some() {
            return Ok(table);
        }
        Err(self.wrong(
            self.span(),
            format!("{} has no [{key}]", self.document.kind.name),
            format!("[{key}] is missing"),
            &format!("add a line [{key}] and below it its keys: {}", table.keys().join(", ")),
        ))
    }

    /// The tables `[[key]]`.
    pub(crate) fn tables(&self, key: &'static str) -> Result<Vec<Section<'a>>, IngestError> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let wrong = |span| {
            self.wrong(
                span,
                format!("{key} is not a list of tables"),
                format!("[[{key}]]"),
                &format!("each {key} begins with a line [[{key}]], with two brackets"),
            )
        };
        let DeValue::Array(items) = value.get_ref() else { return Err(wrong(value.span())) };
        items
            .iter()
            .map(|item| match item.get_ref() {
                DeValue::Table(table) => self.document.section(key, table.clone(), item.span()),
                _ => Err(wrong(item.span())),
            })
            .collect()
    }

    /// A finite number.
    pub(super) fn finite(&self, key: &str) -> Result<Option<Placed<f64>>, IngestError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        let number = match value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => {
                integer.as_str().replace('_', "").parse().ok()
            }
            DeValue::Float(float) => float.as_str().replace('_', "").parse::<f64>().ok(),
            _ => None,
        };
        if let Some(number) = number.filter(|number| number.is_finite()) {
            return Ok(Some(Placed { value: number, span: value.span() }));
        }
        let mend = match value.get_ref() {
            DeValue::String(text) if text == FILL_IN => return Err(self.unfilled(key, &self.example(key))),
            DeValue::String(text) => {
                let plain = text.trim().replace(',', ".");
                match number_with_unit(&plain) {
                    Some((number, unit)) => unit_mend(number, unit),
                    None if plain.parse::<f64>().is_ok() => {
                        format!("write it without quotes: {key} = {plain}")
                    }
                    None => format!("write the number only, without quotes: {key} = 1.0"),
                }
            }
            DeValue::Float(float) if float.as_str().ends_with("nan") => {
                format!("write what it is: `dropcheck init` leaves nan where only you know it, as {key}")
            }
            DeValue::Float(_) => "write a finite number".to_owned(),
            _ => format!("write the number only: {key} = 1.0"),
        };
        let message = format!("{key} is {}, not a number", described(value.get_ref()));
        Err(self.wrong(value.span(), message, "a number".into(), &mend))
    }
}
