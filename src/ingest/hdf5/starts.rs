//! What a recording says of the start of each channel to seconds, or to why two channels have no common
//! clock.

use crate::ingest::refusal::Refusal;
use crate::ingest::statement::number_and_unit;
use crate::ingest::times::{dated, since_1970_s};
use crate::ingest::vocabulary::{split, time_unit_s};

/// A start that is later counts from 1970, s: no recorder runs for three years.
pub(super) const LATEST_S: f64 = 1e8;

/// When the samples of a channel begin, as the recording says.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Start {
    /// The zero of its clock, s since 1970 or since the zero of another that states one.
    pub since_s: Option<f64>,
    /// Its first sample on that clock, s.
    after_s: Option<f64>,
    /// What is said of its start, where that is a time since 1970, or is not understood.
    words: Option<String>,
}

impl Start {
    /// Takes down what an attribute says, the nearest first: `at_s` as [`start_s`] has it.
    pub(super) fn note(&mut self, at_s: Option<f64>, words: String) {
        match at_s {
            Some(at_s) if at_s <= LATEST_S => self.after_s = self.after_s.or(Some(at_s)),
            since_s if self.since_s.is_none() => (self.since_s, self.words) = (since_s, Some(words)),
            _ => {}
        }
    }

    /// The first sample, s after the file's zero.
    pub(super) fn first_s(&self) -> f64 {
        self.since_s.unwrap_or_default() + self.after_s.unwrap_or_default()
    }
}

/// The time of a first sample, s after something or since 1970: in the unit that stands beside it or in the
/// name, else by its size; in s where `is_in_s`. `None` where nothing tells its unit.
pub(super) fn start_s(name: &str, text: &str, is_in_s: bool) -> Option<f64> {
    let number = number_and_unit(text).filter(|(_, unit)| unit.is_empty() || time_unit_s(unit).is_some());
    let Some((number, unit)) = number else {
        return Some(dated(text)?.0.as_duration().as_secs_f64());
    };
    let number: f64 = number.parse().ok()?;
    let unit_s = time_unit_s(unit).or_else(|| time_unit_s(split(name).1?));
    let is_known = is_in_s || number.abs() < f64::EPSILON;
    unit_s.map(|unit_s| number * unit_s).or(since_1970_s(number)).or(is_known.then_some(number))
}

/// Refuses sources that are to be taken together where their starts differ, and one is not understood or does
/// not count from 1970 as another does.
///
/// # Errors
/// There are such.
pub(super) fn require_common(starts: &[(String, Start)]) -> Result<(), Refusal> {
    let is_dated = starts.iter().any(|(_, start)| start.since_s.is_some());
    let is_lost = |start: &Start| start.since_s.is_none() && (is_dated || start.words.is_some());
    if let Some((lost, start)) = starts.iter().find(|(_, start)| is_lost(start))
        && let Some((other, known)) = starts.iter().find(|(_, other)| other.words != start.words)
    {
        let [one, two] = [start, known].map(|start| start.words.as_deref().unwrap_or("nothing"));
        let problem =
            format!("states {one} of its start, and {other} {two}: nothing tells how far they are apart");
        return Err(Refusal::of(
            lost,
            problem,
            "write into a copy, to each of the two, the attribute start_time_s: when its first sample was \
             taken, in s from one zero",
        ));
    }
    Ok(())
}
