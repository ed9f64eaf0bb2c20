//! A number of a cask or scene file to itself, or to the diagnostic that names its range.

use super::CaskFileError;
use super::section::Section;
use crate::ingest::time_base::short;
use std::ops::RangeInclusive;

impl Section<'_> {
    /// A number within `range`; `why` says what lies beyond or what the key means.
    pub(crate) fn within(
        &self,
        key: &str,
        range: &RangeInclusive<f64>,
        why: &str,
    ) -> Result<Option<f64>, CaskFileError> {
        match self.number(key)? {
            Some(number) if !range.contains(&number.value) => {
                Err(self.outside(number.span, &format!("{key} is {}", short(number.value)), range, why))
            }
            number => Ok(number.map(|number| number.value)),
        }
    }

    /// The same of a key that must be there.
    pub(crate) fn required_within(
        &self,
        key: &str,
        example: &str,
        range: &RangeInclusive<f64>,
        why: &str,
    ) -> Result<f64, CaskFileError> {
        let missing = || self.missing(key, &format!("add a line such as {key} = {example}"));
        self.within(key, range, why)?.ok_or_else(missing)
    }

    /// The refusal of `what`, which lies outside `range`.
    pub(crate) fn outside(
        &self,
        span: std::ops::Range<usize>,
        what: &str,
        range: &RangeInclusive<f64>,
        why: &str,
    ) -> CaskFileError {
        let allowed = format!("{} to {}", short(*range.start()), short(*range.end()));
        self.wrong(span, format!("{what}, outside {allowed}"), allowed, why)
    }
}
