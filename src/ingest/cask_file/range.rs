//! A number of a cask or scene file to itself, or to the diagnostic that names its range.

use super::CaskFileError;
use super::section::{Placed, Section};
use super::wording::unit_of;
use crate::data::keys::{Allowed, Takes};
use crate::data::shown::short;
use std::ops::{Range, RangeInclusive};

type Stated = Result<Option<Placed<f64>>, CaskFileError>;

impl Section<'_> {
    /// A number within what its row allows.
    pub(crate) fn number(&self, key: &str) -> Stated {
        match self.row(key).map(|row| row.takes) {
            Some(Takes::Number(Allowed::FromZero)) => self.not_negative(key),
            Some(Takes::Number(Allowed::AboveZero)) => self.positive(key),
            _ => {
                let number = self.finite(key)?;
                if let Some(number) = &number {
                    self.allows(key, number, &format!("{key} is {}", short(number.value)))?;
                }
                Ok(number)
            }
        }
    }

    /// Whether the range of `key` holds `number`, of which the refusal says `what`.
    pub(super) fn allows(&self, key: &str, number: &Placed<f64>, what: &str) -> Result<(), CaskFileError> {
        match self.row(key).map(|row| row.takes) {
            Some(Takes::Number(Allowed::Within(least, most, why)))
                if !(least..=most).contains(&number.value) =>
            {
                let allowed = format!("{} to {}", short(least), short(most));
                let degrees = if key.ends_with("_deg") { " degrees" } else { "" };
                let message = format!("{what}, outside {allowed}");
                Err(self.wrong(number.span.clone(), message, allowed + degrees, why))
            }
            _ => Ok(()),
        }
    }

    /// The same of a key that must be there.
    pub(crate) fn required_number(&self, key: &str) -> Result<Placed<f64>, CaskFileError> {
        self.number(key)?.ok_or_else(|| self.without(key))
    }

    /// A number above 0.
    fn positive(&self, key: &str) -> Stated {
        self.bounded(key, |number| number > 0.0, ["be above 0", "a number above 0"])
    }

    /// A number of 0 or above.
    fn not_negative(&self, key: &str) -> Stated {
        self.bounded(key, |number| number >= 0.0, ["not be below 0", "0 or more"])
    }

    fn bounded(&self, key: &str, is_allowed: fn(f64) -> bool, [must, expected]: [&str; 2]) -> Stated {
        match self.finite(key)? {
            Some(number) if !is_allowed(number.value) => Err(self.wrong(
                number.span,
                format!("{key} is {}: it must {must}", number.value),
                expected.into(),
                &format!("check the value{}", unit_of(key)),
            )),
            number => Ok(number),
        }
    }

    /// The refusal of `what`, which lies outside `range`.
    pub(crate) fn outside(
        &self,
        span: Range<usize>,
        what: &str,
        range: &RangeInclusive<f64>,
        why: &str,
    ) -> CaskFileError {
        let allowed = format!("{} to {}", short(*range.start()), short(*range.end()));
        self.wrong(span, format!("{what}, outside {allowed}"), allowed, why)
    }
}
