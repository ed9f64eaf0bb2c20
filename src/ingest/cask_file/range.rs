//! A number of a cask or scene file to itself, or to the diagnostic that names its range.

use super::section::Section;
use super::texts::A_NUMBER;
use super::wording::unit_of;
use crate::data::keys::{Allowed, Takes};
use crate::data::shown::show;
use crate::ingest::IngestError;
use std::ops::RangeInclusive;
use toml::de::DeValue;

impl Section<'_> {
    /// A number within what its row allows.
    pub(crate) fn given(&self, key: &str) -> Result<Option<f64>, IngestError> {
        let number = self.typed(key, A_NUMBER, |value| {
            let digits = match value {
                DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str(),
                DeValue::Float(float) => float.as_str(),
                _ => return None,
            };
            digits.replace('_', "").parse().ok().filter(|number: &f64| number.is_finite())
        })?;
        number.map_or(Ok(()), |number| self.allows(key, number, &format!("{key} is {}", show(number))))?;
        Ok(number)
    }

    /// The same of a key that must be there.
    pub(crate) fn required_number(&self, key: &str) -> Result<f64, IngestError> {
        self.given(key)?.ok_or_else(|| self.without(key))
    }

    /// Whether the range of `key` holds `number`, of which the refusal says `what`.
    pub(super) fn allows(&self, key: &str, number: f64, what: &str) -> Result<(), IngestError> {
        let Some(Takes::Number(allowed)) = self.row(key).map(|row| row.takes) else { return Ok(()) };
        let in_unit = |unit| format!("check the value, in {unit}");
        let check = &unit_of(key).map_or("check the value".into(), in_unit)[..];
        let (must, mend) = match allowed {
            _ if allowed.holds(number) => return Ok(()),
            Allowed::Within(_, _, why) | Allowed::ZeroOrWithin(_, _, why) => {
                let unit = if key.ends_with("_deg") { " degrees" } else { "" };
                (format!(", outside {}{unit}", allowed.words()), why)
            }
            Allowed::FromZero => (": it must not be below 0".into(), check),
            _ => (": it must be above 0".into(), check),
        };
        Err(self.refuse(key, format!("{what}{must}"), mend))
    }

    /// The refusal of a number of which `what` is said, outside what other keys leave it.
    pub(crate) fn outside(
        &self,
        key: &str,
        what: &str,
        range: &RangeInclusive<f64>,
        why: &str,
    ) -> IngestError {
        let (least, most) = (show(*range.start()), show(*range.end()));
        self.refuse(key, format!("{what}, outside {least} to {most}"), why)
    }
}
