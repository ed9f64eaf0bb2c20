//! A number of a cask or scene file to itself, or to the diagnostic that names its range.

use super::section::{Placed, Section};
use super::wording::unit_of;
use crate::data::keys::{Allowed, Takes};
use crate::data::shown::short;
use crate::ingest::IngestError;
use std::ops::{Range, RangeInclusive};

type Stated = Result<Option<Placed<f64>>, IngestError>;

impl Section<'_> {
    /// A number within what its row allows.
    pub(crate) fn number(&self, key: &str) -> Stated {
        let number = self.finite(key)?;
        if let Some(number) = &number {
            self.allows(key, number, &format!("{key} is {}", short(number.value)))?;
        }
        Ok(number)
    }

    /// The same without its place.
    pub(crate) fn given(&self, key: &str) -> Result<Option<f64>, IngestError> {
        Ok(self.number(key)?.map(|number| number.value))
    }

    /// Whether the range of `key` holds `number`, of which the refusal says `what`.
    pub(super) fn allows(&self, key: &str, number: &Placed<f64>, what: &str) -> Result<(), IngestError> {
        let Some(Takes::Number(allowed)) = self.row(key).map(|row| row.takes) else { return Ok(()) };
        let check = format!("check the value{}", unit_of(key));
        let mut expected = allowed.words();
        let (must, mend) = match allowed {
            _ if allowed.holds(number.value) => return Ok(()),
            Allowed::Within(_, _, why) => {
                let must = format!(", outside {expected}");
                expected.push_str(if key.ends_with("_deg") { " degrees" } else { "" });
                (must, why)
            }
            Allowed::FromZero => (": it must not be below 0".into(), &check[..]),
            _ => (": it must be above 0".into(), &check[..]),
        };
        Err(self.wrong(number.span.clone(), format!("{what}{must}"), expected, mend))
    }

    /// A number within what its row allows, of a key that must be there.
    pub(crate) fn required_number(&self, key: &str) -> Result<Placed<f64>, IngestError> {
        self.number(key)?.ok_or_else(|| self.without(key))
    }

    /// The refusal of `what`, which lies outside `range`.
    pub(crate) fn outside(
        &self,
        span: Range<usize>,
        what: &str,
        range: &RangeInclusive<f64>,
        why: &str,
    ) -> IngestError {
        let allowed = format!("{} to {}", short(*range.start()), short(*range.end()));
        self.wrong(span, format!("{what}, outside {allowed}"), allowed, why)
    }
}
