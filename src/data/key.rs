//! A row of a file's keys: the values that the key accepts, its default, and its line in the form that `init`
//! writes.

use super::shown::show;

/// Type of the value of a key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Takes {
    /// Text in quotes; if only some words are valid, the parser lists them.
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
    /// A table with the user's own keys.
    Table,
    /// A value with its interval, or limits: { value = …, u95 = …, by = "…" }, { least = …, most = … }.
    Observation,
    /// A number.
    Number(Allowed),
}

/// Numbers that a key accepts by itself; the parser checks limits that depend on another key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Allowed {
    /// Every finite one.
    Any,
    /// 0 and more.
    FromZero,
    /// More than 0.
    AboveZero,
    /// A range from the first to the second; the text says what lies beyond, or the meaning of the key.
    Within(f64, f64, &'static str),
    /// 0, or as [`Allowed::Within`].
    ZeroOrWithin(f64, f64, &'static str),
}

impl Allowed {
    /// True if the range contains a number.
    pub(crate) fn holds(self, number: f64) -> bool {
        match self {
            Self::Any => true,
            Self::FromZero => number >= 0.0,
            Self::AboveZero => number > 0.0,
            Self::Within(least, most, _) => (least..=most).contains(&number),
            Self::ZeroOrWithin(least, most, _) => number == 0.0 || (least..=most).contains(&number),
        }
    }

    /// The range in words.
    pub fn words(self) -> String {
        match self {
            Self::Any => "a number".into(),
            Self::FromZero => "0 or more".into(),
            Self::AboveZero => "a number above 0".into(),
            Self::Within(least, most, _) => format!("{} to {}", show(least), show(most)),
            Self::ZeroOrWithin(least, most, _) => format!("0, or {} to {}", show(least), show(most)),
        }
    }
}

/// A key of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Name as written in the file; the name of a quantity ends in its unit.
    pub name: &'static str,
    /// Type of its value.
    pub takes: Takes,
    /// Value if the key is absent, as docs/formats.md states it; "required" if there is none.
    pub default: &'static str,
    /// A value as it could stand in a file; "" if the form has no line for the key.
    pub example: &'static str,
    /// Remark in the form.
    pub remark: &'static str,
    /// True if the form asks for it, since only the user knows it.
    pub is_asked: bool,
}

/// A table of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyTable {
    /// The word in its brackets.
    pub name: &'static str,
    /// Remark in the form.
    pub remark: &'static str,
    /// Keys of the table, in the order of the form.
    pub keys: &'static [Key],
}

/// Placeholder in the form of `init` for a text that only the user knows; no key accepts it as a value.
pub const FILL_IN: &str = "FILL IN";

/// Marks a key as required.
pub const REQUIRED: &str = "required";

pub(crate) const ANY: Takes = Takes::Number(Allowed::Any);
pub(crate) const FROM_ZERO: Takes = Takes::Number(Allowed::FromZero);
pub(crate) const ABOVE_ZERO: Takes = Takes::Number(Allowed::AboveZero);

pub(crate) const fn range(least: f64, most: f64, why: &'static str) -> Takes {
    Takes::Number(Allowed::Within(least, most, why))
}

/// Declares the keys of tables. A row has the name, the default, the type of the value, and, for a file that
/// has a form, its value and remark in the form that `init` writes; `ask` if the form asks for it.
macro_rules! keys {
    (@is_asked) => { false };
    (@is_asked ask) => { true };
    (@said) => { "" };
    (@said $words:literal) => { $words };
    ($($(#[$about:meta])* $table:ident {$(
        $name:literal: $default:expr, $takes:expr $(, $($ask:ident)? $example:literal, $remark:literal)?;
    )*})*) => {$(
        $(#[$about])*
        pub const $table: [$crate::data::keys::Key; [$($name),*].len()] = [$($crate::data::keys::Key {
            name: $name,
            takes: $takes,
            default: $default,
            example: keys!(@said $($example)?),
            remark: keys!(@said $($remark)?),
            is_asked: keys!(@is_asked $($($ask)?)?),
        }),*];
    )*};
}
pub(crate) use keys;

impl Key {
    /// True if a value that the file omits enters the result all the same.
    pub(crate) fn is_assumed(&self) -> bool {
        let is_number = matches!(self.takes, Takes::Number(_) | Takes::TextOrNumber);
        is_number && !self.default.starts_with(REQUIRED) && !["", "–"].contains(&self.default)
    }
}
