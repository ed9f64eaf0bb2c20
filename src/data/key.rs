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
    /// 0, or as [`Allowed::Within`].
    ZeroOrWithin(f64, f64, &'static str),
}

impl Allowed {
    /// Whether a number is among them.
    pub(crate) fn holds(self, number: f64) -> bool {
        match self {
            Self::Any => true,
            Self::FromZero => number >= 0.0,
            Self::AboveZero => number > 0.0,
            Self::Within(least, most, _) => (least..=most).contains(&number),
            Self::ZeroOrWithin(least, most, _) => number == 0.0 || (least..=most).contains(&number),
        }
    }

    /// Those numbers, in words.
    pub fn words(self) -> String {
        match self {
            Self::Any => "a number".into(),
            Self::FromZero => "0 or more".into(),
            Self::AboveZero => "a number above 0".into(),
            Self::Within(least, most, _) => format!("{} to {}", short(least), short(most)),
            Self::ZeroOrWithin(least, most, _) => format!("0, or {} to {}", short(least), short(most)),
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

pub(crate) const ANY: Takes = Takes::Number(Allowed::Any);
pub(crate) const FROM_ZERO: Takes = Takes::Number(Allowed::FromZero);
pub(crate) const ABOVE_ZERO: Takes = Takes::Number(Allowed::AboveZero);

pub(crate) const fn within(least: f64, most: f64, why: &'static str) -> Takes {
    Takes::Number(Allowed::Within(least, most, why))
}

/// Declares the keys of tables. A row has the name, the default, what stands behind the key, and, for a file
/// that has a form, its value and remark in the form that `init` writes; `ask` where the form asks for it.
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
    /// Whether a value that the file leaves out enters the result all the same.
    pub(crate) fn is_assumed(&self) -> bool {
        let is_number = matches!(self.takes, Takes::Number(_) | Takes::TextOrNumber);
        is_number && !self.default.starts_with(REQUIRED) && !["", "–"].contains(&self.default)
    }
}
