//! A value of a cask or scene file of any kind to itself, or to the diagnostic that says what it is instead.

use super::section::Section;
use super::wording::{described, nearest, number_with_unit, unit_mend};
use crate::data::keys::FILL_IN;
use crate::ingest::IngestError;
use toml::Spanned;
use toml::de::{DeString, DeValue};

/// What most keys take.
pub(super) const A_NUMBER: &str = "a number";

impl Section<'_> {
    /// What `take` finds in the value of a key, which is to be `what`.
    pub(super) fn typed<T>(
        &self,
        key: &str,
        what: &str,
        take: impl Fn(&DeValue) -> Option<T>,
    ) -> Result<Option<T>, IngestError> {
        let Some(value) = self.value(key).map(Spanned::get_ref) else { return Ok(None) };
        take(value).map(Some).ok_or_else(|| {
            if value.as_str() == Some(FILL_IN) {
                return self.unfilled(key, &self.example(key));
            }
            let mend = if what == A_NUMBER { self.number_mend(key, value) } else { self.form(key) };
            self.refuse(key, format!("{key} is {}, not {what}", described(value)), &mend)
        })
    }

    /// What to write in place of what is no number.
    fn number_mend(&self, key: &str, value: &DeValue) -> String {
        let plain = value.as_str().unwrap_or_default().trim().replace(',', ".");
        match number_with_unit(&plain) {
            Some((number, unit)) => unit_mend(key, number, unit),
            None if plain.parse::<f64>().is_ok() => format!("write it without quotes: {key} = {plain}"),
            None if is_left_open(value) => {
                "write what it is: `dropcheck init` leaves nan where only you know it".into()
            }
            None if matches!(value, DeValue::Float(_)) => "write a finite number".into(),
            None => self.form(key),
        }
    }

    /// How a value of the key is written.
    pub(super) fn form(&self, key: &str) -> String {
        format!("write it as in {}", self.example(key))
    }

    /// A word or name, not empty.
    pub(crate) fn text(&self, key: &str) -> Result<Option<String>, IngestError> {
        self.typed(key, "a text in quotes", |value| words(value).filter(|text| text != FILL_IN))
    }

    pub(crate) fn required_text(&self, key: &str) -> Result<String, IngestError> {
        self.text(key)?.ok_or_else(|| self.without(key))
    }

    /// That a key is missing, with a line such as it could have.
    pub(super) fn without(&self, key: &str) -> IngestError {
        self.missing(key, &format!("add a line such as {}", self.example(key)))
    }

    /// A line that the key could have.
    pub(super) fn example(&self, key: &str) -> String {
        let example = self.row(key).map(|row| row.example).filter(|example| !example.is_empty());
        format!("{key} = {}", example.unwrap_or("…"))
    }

    /// That the form of `dropcheck init` was left as it is here.
    fn unfilled(&self, key: &str, such_as: &str) -> IngestError {
        let message = format!("{key} is \"{FILL_IN}\": it is still to be filled in, for only you know it");
        self.refuse(key, message, &format!("write what it is, such as {such_as}"))
    }

    /// `true` or `false`.
    pub(crate) fn flag(&self, key: &str) -> Result<Option<bool>, IngestError> {
        self.typed(key, "true or false", |value| match value {
            DeValue::Boolean(flag) => Some(*flag),
            _ => None,
        })
    }

    /// A date, or a date and a time, as TOML writes it.
    pub(super) fn date(&self, key: &str) -> Result<Option<String>, IngestError> {
        self.typed(key, "a date without quotes", |value| match value {
            DeValue::Datetime(when) if when.date.is_some() => Some(when.to_string()),
            _ => None,
        })
    }

    /// A list of texts; empty where there is none.
    pub(super) fn texts(&self, key: &str) -> Result<Vec<String>, IngestError> {
        let text = |item: &Spanned<DeValue>| words(item.get_ref());
        let texts =
            self.typed(key, "a list of texts", |value| value.as_array()?.iter().map(text).collect())?;
        Ok(texts.unwrap_or_default())
    }

    /// Its names, each with what stands behind it; a text or a number alone.
    pub(super) fn own_names(&self) -> Result<Vec<(String, String)>, IngestError> {
        let named = |name: &Spanned<DeString>| {
            let stated = self.typed(name.get_ref(), "a text or a number", |value| match value {
                DeValue::String(text) => Some(text.to_string()),
                DeValue::Integer(number) => Some(number.as_str().to_owned()),
                DeValue::Float(number) => Some(number.as_str().to_owned()),
                _ => None,
            });
            Ok((name.get_ref().to_string(), stated?.unwrap_or_default()))
        };
        self.table.keys().map(named).collect()
    }

    /// One of a few words.
    pub(crate) fn word<T: Copy>(
        &self,
        key: &str,
        allowed: &[(&str, T)],
        mend: &str,
    ) -> Result<Option<T>, IngestError> {
        let Some(text) = self.typed(key, "a text in quotes", words)? else { return Ok(None) };
        if let Some((_, value)) = allowed.iter().find(|(word, _)| *word == text) {
            return Ok(Some(*value));
        }
        let known: Vec<&str> = allowed.iter().map(|(word, _)| *word).collect();
        if text == FILL_IN {
            return Err(self.unfilled(key, mend));
        }
        let near = nearest(&text.to_lowercase(), &known);
        let near = near.map_or_else(String::new, |near| format!("did you mean \"{near}\"? "));
        let message = format!("{key} cannot be \"{text}\", but \"{}\"", known.join("\" or \""));
        Err(self.refuse(key, message, &format!("{near}{mend}")))
    }
}

/// Whether the value is what `init` writes where only the user knows it.
pub(super) fn is_left_open(value: &DeValue) -> bool {
    match value {
        DeValue::Float(float) => float.as_str().ends_with("nan"),
        value => value.as_str() == Some(FILL_IN),
    }
}

/// A text that is not blank.
fn words(value: &DeValue) -> Option<String> {
    value.as_str().filter(|text| !text.trim().is_empty()).map(str::to_owned)
}
