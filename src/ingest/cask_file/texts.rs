//! A text, a date or a list of a cask or scene file to itself, or to the diagnostic that says what it is
//! instead.

use super::section::{Placed, Section};
use super::wording::{described, nearest};
use crate::data::keys::FILL_IN;
use crate::ingest::IngestError;
use toml::Spanned;
use toml::de::DeValue;

impl Section<'_> {
    /// A word or name, not empty.
    pub(crate) fn text(&self, key: &str) -> Result<Option<Placed<String>>, IngestError> {
        self.text_such_as(key, &self.example(key))
    }

    /// The same without its place.
    pub(crate) fn words(&self, key: &str) -> Result<Option<String>, IngestError> {
        Ok(self.text(key)?.map(|text| text.value))
    }

    /// As [`Section::text`]; `such_as` is what to write in place of what `dropcheck init` leaves to be filled
    /// in.
    fn text_such_as(&self, key: &str, such_as: &str) -> Result<Option<Placed<String>>, IngestError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::String(text) if text == FILL_IN => Err(self.unfilled(key, such_as)),
            DeValue::String(text) if !text.trim().is_empty() => {
                Ok(Some(Placed { value: text.to_string(), span: value.span() }))
            }
            DeValue::String(_) => Err(self.wrong(
                value.span(),
                format!("{key} is empty"),
                "a name".into(),
                &format!("write a name between the quotes, or delete {key}"),
            )),
            other => Err(self.wrong(
                value.span(),
                format!("{key} is {}, not a text", described(other)),
                "a text in quotes".into(),
                &format!("put it in quotes: {key} = \"…\""),
            )),
        }
    }

    pub(crate) fn required_text(&self, key: &str) -> Result<Placed<String>, IngestError> {
        self.text(key)?.ok_or_else(|| self.without(key))
    }

    /// That a key is missing, with a line such as it could have.
    pub(super) fn without(&self, key: &str) -> IngestError {
        self.missing(key, &format!("add a line such as {}", self.example(key)))
    }

    /// A line that the key could have.
    pub(super) fn example(&self, key: &str) -> String {
        format!("{key} = {}", self.row(key).map_or("…", |row| row.example))
    }

    /// That the form of `dropcheck init` was left as it is here.
    pub(super) fn unfilled(&self, key: &str, such_as: &str) -> IngestError {
        let message = format!("{key} is \"{FILL_IN}\": what it is only you know");
        let label = "this line is still to be filled in".to_owned();
        self.wrong(self.place(key), message, label, &format!("write what it is, such as {such_as}"))
    }

    /// `true` or `false`.
    pub(crate) fn flag(&self, key: &str, mend: &str) -> Result<Option<bool>, IngestError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        let told = value.get_ref().as_bool().ok_or_else(|| {
            let message = format!("{key} is neither true nor false");
            self.wrong(value.span(), message, "true or false".into(), mend)
        })?;
        Ok(Some(told))
    }

    /// A date, or a date and a time, as TOML writes it.
    pub(super) fn date(&self, key: &str) -> Result<Option<String>, IngestError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Datetime(when) if when.date.is_some() => Ok(Some(when.to_string())),
            other => Err(self.wrong(
                value.span(),
                format!("{key} is {}, not a date", described(other)),
                "a date".into(),
                &format!("write year, month and day without quotes: {}", self.example(key)),
            )),
        }
    }

    /// A list of texts; empty where there is none.
    pub(super) fn texts(&self, key: &str) -> Result<Vec<Placed<String>>, IngestError> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let text = |item: &Spanned<DeValue>| match item.get_ref() {
            DeValue::String(text) if !text.trim().is_empty() => {
                Some(Placed { value: text.to_string(), span: item.span() })
            }
            _ => None,
        };
        let texts = value.get_ref().as_array().and_then(|items| items.iter().map(text).collect());
        texts.ok_or_else(|| {
            let mend = format!("write a list of texts in quotes: {}", self.example(key));
            self.wrong(value.span(), format!("{key} is no list of texts"), "a list of texts".into(), &mend)
        })
    }

    /// Its names, each with what stands behind it; a text or a number alone.
    pub(super) fn own_names(&self) -> Result<Vec<(String, String)>, IngestError> {
        let named = |(name, value): (&Spanned<toml::de::DeString>, &Spanned<DeValue>)| {
            let words = match value.get_ref() {
                DeValue::String(text) => text.to_string(),
                DeValue::Integer(number) => number.as_str().to_owned(),
                DeValue::Float(number) => number.as_str().to_owned(),
                other => {
                    let message = format!("{} is {}", name.get_ref(), described(other));
                    let mend = format!("write \"{}\" = \"…\"", name.get_ref());
                    return Err(self.wrong(value.span(), message, "a text or a number".into(), &mend));
                }
            };
            Ok((name.get_ref().to_string(), words))
        };
        self.table.iter().map(named).collect()
    }

    /// One of a few words.
    pub(crate) fn word<T: Copy>(
        &self,
        key: &str,
        words: &[(&str, T)],
        mend: &str,
    ) -> Result<Option<T>, IngestError> {
        let Some(text) = self.text_such_as(key, mend)? else { return Ok(None) };
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == text.value) {
            return Ok(Some(*value));
        }
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        let quoted: Vec<String> = known.iter().map(|word| format!("\"{word}\"")).collect();
        let mend = match nearest(&text.value.to_lowercase(), &known) {
            Some(near) => format!("did you mean \"{near}\"? {mend}"),
            None => mend.to_owned(),
        };
        let message = format!("{key} cannot be \"{}\"", text.value);
        Err(self.wrong(text.span, message, quoted.join(" or "), &mend))
    }
}
