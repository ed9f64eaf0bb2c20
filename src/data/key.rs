//! What a row of a file's keys says: what the key takes, its default, and its line in the form that `init`
//! writes.

use super::shown::short;

/// What stands behind a key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Takes {
    /// Text in quotes; where only some words will do, the parser lists them.
    Text,
    /// A word or a number.
    TextOrNumber,
    /// A text or a table of two texts.
    TextOrTable,
    /// true or false.
    Flag,
    /// A date or a date and a time of TOML, without quotes.
    Date,
    /// A list of texts.
    Texts,
    /// A table of the user's own names.
    Table,
    /// A value with its interval, or limits: { value = …, u95 = …, by = "…" }, { least = …, most = … }.
    Observation,
    /// A number.
    Number(Allowed),
}

/// Which numbers a key allows by itself; what depends on another key is the parser's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Allowed {
    /// Every finite one.
    Any,
    /// 0 and more.
    FromZero,
    /// More than 0.
    AboveZero,
    /// From the first to the second; the text says what lies beyond, or what the key means.
    Within(f64, f64, &'static str),
}

impl Allowed {
    /// Whether a number is among them.
    pub(crate) fn holds(self, number: f64) -> bool {
        match self {
            Self::Any => true,
            Self::FromZero => number >= 0.0,
            Self::AboveZero => number > 0.0,
            Self::Within(least, most, _) => (least..=most).contains(&number),
        }
    }

    /// Those numbers, in words.
    pub fn words(self) -> String {
        match self {
            Self::Any => "a number".into(),
            Self::FromZero => "0 or more".into(),
            Self::AboveZero => "a number above 0".into(),
            Self::Within(least, most, _) => format!("{} to {}", short(least), short(most)),
        }
    }
}

/// A key of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// As it is written; a quantity's ends in its unit.
    pub name: &'static str,
    /// What stands behind it.
    pub takes: Takes,
    /// What holds where it is left out, as docs/formats.md says it; "required" where nothing does.
    pub default: &'static str,
    /// A value as it could stand in a file; "" where the form has no line of its own for the key.
    pub example: &'static str,
    /// What the form says of it.
    pub remark: &'static str,
    /// Whether the form asks for it, since only the user knows it.
    pub is_asked: bool,
}

/// A table of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyTable {
    /// The word in its brackets.
    pub name: &'static str,
    /// What the form says of it.
    pub remark: &'static str,
    /// Its keys, in the order of the form.
    pub keys: &'static [Key],
}

/// What the form that `init` writes has in place of a text that only the user knows; no key takes it for a
/// value.
pub const FILL_IN: &str = "FILL IN";

/// The default of a key that must be there.
pub const REQUIRED: &str = "required";

pub(crate) const fn text(name: &'static str, default: &'static str) -> Key {
    Key { name, takes: Takes::Text, default, example: "", remark: "", is_asked: false }
}

pub(crate) const fn number(name: &'static str, default: &'static str) -> Key {
    Key { takes: Takes::Number(Allowed::Any), ..text(name, default) }
}

pub(crate) const fn flag(name: &'static str) -> Key {
    Key { takes: Takes::Flag, ..text(name, "true") }
}

impl Key {
    pub(crate) const fn zero_or_more(self) -> Self {
        Self { takes: Takes::Number(Allowed::FromZero), ..self }
    }

    #[cfg(feature = "lab")]
    pub(crate) const fn above_zero(self) -> Self {
        Self { takes: Takes::Number(Allowed::AboveZero), ..self }
    }

    #[cfg(feature = "lab")]
    pub(crate) const fn within(self, least: f64, most: f64, why: &'static str) -> Self {
        Self { takes: Takes::Number(Allowed::Within(least, most, why)), ..self }
    }

    /// Whether a value that the file leaves out enters the result all the same.
    pub(crate) fn is_assumed(&self) -> bool {
        let is_number = matches!(self.takes, Takes::Number(_) | Takes::TextOrNumber);
        is_number && !self.default.starts_with(REQUIRED) && !["", "–"].contains(&self.default)
    }

    pub(crate) const fn shown(self, example: &'static str, remark: &'static str) -> Self {
        Self { example, remark, ..self }
    }
}
