//! What the messages of a column state twice to whether it is the same.

use crate::data::{Issue, IssueCode, Severity, acceleration_unit_m_s2};
use crate::ingest::stated_rate::{Agreement, StatedRate, rounding, shown_hz};
use crate::ingest::time_base::RATE_TOLERANCE;

/// An interval that is further than this factor off one over the rate, in any unit, is one of something else, as of whole blocks.
const ALIKE: f64 = 1.2;

/// A number that is further than this factor off is no rate of these samples: `fs` may be a full scale.
const MEANT: f64 = 100.0;

/// Two rates that one message states, the one taken first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rates(StatedRate, StatedRate);

impl Rates {
    /// Of fields with their values, the nearest first, and of intervals in a unit that only their size tells.
    pub(super) fn of<'a>(
        mut rates: impl Iterator<Item = (&'a str, f64)>,
        intervals: impl Iterator<Item = (&'a str, f64)>,
    ) -> Option<Self> {
        let first = rates.next()?;
        let of_interval = |(name, interval): (&'a str, f64)| {
            let hz = [1.0, 1e-3, 1e-6, 1e-9].into_iter().map(|unit_s| 1.0 / (interval * unit_s));
            let hz = hz.into_iter().find(|hz| (1.0 / ALIKE..ALIKE).contains(&(hz / first.1)))?;
            Some((name, interval, hz))
        };
        let others = rates.map(|(name, hz)| (name, hz, hz)).chain(intervals.filter_map(of_interval));
        let stated = |(name, value, rate_hz): (&str, f64, f64)| StatedRate {
            place: format!("{name} = {value}"),
            rate_hz,
            rounding: rounding(&value.to_string()),
        };
        let is_apart = |(.., hz): &(&str, f64, f64)| {
            let ratio = first.1 / hz;
            (1.0 / MEANT..MEANT).contains(&ratio) && (ratio - 1.0).abs() > RATE_TOLERANCE
        };
        others.filter(is_apart).find_map(|other| {
            let (first, other) = (stated((first.0, first.1, first.1)), stated(other));
            let is_same = first.agreement(other.rate_hz, other.rounding) == Agreement::Same;
            (!is_same).then_some(Self(first, other))
        })
    }

    /// A warning that nothing tells which of the two is right.
    pub(super) fn issue(&self) -> Issue {
        let message = format!(
            "its messages state {} and {}: one of the two is wrong, the stamps do not tell which, and every velocity goes with the rate; write the \
             right one into this channel of the cask file: sample_rate_hz = {} or sample_rate_hz = {}",
            self.0.shown(),
            self.1.shown(),
            shown_hz(self.0.rate_hz),
            shown_hz(self.1.rate_hz)
        );
        Issue::new(IssueCode::Clock, Severity::Warning, message)
    }
}

/// The units that messages state, each once, as they come.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Units(Vec<String>);

impl Units {
    /// So many tell that they change.
    const MOST: usize = 4;

    /// Takes one.
    pub(super) fn take(&mut self, unit: &str) {
        if self.0.len() < Self::MOST && !self.0.iter().any(|own| own == unit) {
            self.0.push(unit.to_owned());
        }
    }

    /// Takes those that were stated later.
    pub(super) fn append(&mut self, later: &Self) {
        later.0.iter().for_each(|unit| self.take(unit));
    }

    /// The first.
    pub(super) fn first(&self) -> Option<&str> {
        self.0.first().map(String::as_str)
    }

    /// A warning where one is another than the first.
    pub(super) fn issue(&self) -> Option<Issue> {
        let (first, others) = self.0.split_first()?;
        let is_other = |unit: &&String| match (acceleration_unit_m_s2(first), acceleration_unit_m_s2(unit)) {
            (Some(one), Some(other)) => one.total_cmp(&other).is_ne(),
            _ => !unit.trim().eq_ignore_ascii_case(first.trim()),
        };
        let other = others.iter().find(is_other)?;
        let message = format!(
            "the unit changes between its messages, from {first:?} to {other:?}, and all samples were taken in one: cut the recording where it changes, \
             or where only the word is wrong correct it in a copy"
        );
        Some(Issue::new(IssueCode::Scale, Severity::Warning, message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_rates_of_a_message_are_told_apart() {
        let of = |rates: &[(&'static str, f64)], interval: Option<f64>| {
            Rates::of(rates.iter().copied(), interval.map(|interval| ("dt", interval)).into_iter())
        };
        let message = of(&[("sample_rate_hz", 97e3), ("fs", 1e5)], None).unwrap().issue().message;
        for part in ["sample_rate_hz = 97000, which", "fs = 100000", "or sample_rate_hz = 100000"] {
            assert!(message.contains(part), "{message} without {part}");
        }
        let message = of(&[("fs", 97e3)], Some(10.0)).unwrap().issue().message;
        assert!(message.contains("dt = 10, which is 100000 Hz"), "{message}");
        for (rates, interval) in [
            (&[("fs", 1e5), ("sample_rate", 100_050.0)][..], None),
            (&[("fs", 1e5)], Some(1e-5)),
            (&[("fs", 51_200.0)], Some(1.953e-5)),
            (&[("fs", 1e5)], Some(0.01)),
            (&[("fs", 1e5)], Some(5.12)),
            (&[("fs", 1e5), ("sample_rate", 0.0)], Some(0.0)),
            (&[("sample_rate", 1e5), ("fs", 50.0)], None),
            (&[("fs", f64::NAN), ("sample_rate", 1e5)], None),
            (&[], Some(1e-5)),
        ] {
            assert_eq!(of(rates, interval), None, "{rates:?} {interval:?}");
        }
    }

    #[test]
    fn units_that_change_are_told() {
        let issue = |stated: &[&str]| {
            let mut units = Units::default();
            for unit in stated {
                units.take(unit);
            }
            units.issue()
        };
        for stated in [&[][..], &["g", "g", "G"], &["m/s^2", "m/s²"], &["V", "v "]] {
            assert_eq!(issue(stated), None, "{stated:?}");
        }
        assert!(issue(&["g", "gn", "m/s^2"]).unwrap().message.contains("from \"g\" to \"m/s^2\""));
        assert!(issue(&["g", "V"]).is_some());
    }
}
