//! Findings on the rate or the times of a recording: code, severity and sentence of each.

use super::{IssueCode as Code, Severity};
use crate::data::shown::{digits, hz};

findings! {
/// A finding on two sources of time or rate that disagree.
pub enum ClockFinding of Clock {
    /// Another source states a rate that differs from the one used.
    Rates(apart: RatesApart) => (Code::Clock, Warning, Nothing),
        ("{apart}; the first was taken, and every velocity goes with the rate: if the second is right, write \
         sample_rate_hz = {rate}", rate = hz(apart.other_hz));
    /// Another column or dataset does not confirm the times used.
    Times(apart: TimesApart) => (Code::Clock, Warning, Nothing),
        ("{apart}; the channels timed by {} have their velocities from it", apart.taken);
    /// A listing has no rate, because the reader would refuse it: the problem and its remedy.
    Refused(words: String) => (Code::Clock, Warning, Nothing),
        ("{words}");
}
}

/// Two rates that contradict each other, each in Hz with its source.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit")]
#[error("two rates contradict each other: {} Hz by {taken_by}, {} Hz by \
         {other_by}", hz(*.taken_hz), hz(*.other_hz))]
pub struct RatesApart {
    pub taken_hz: f64,
    pub taken_by: String,
    pub other_hz: f64,
    pub other_by: String,
}

/// Two columns or datasets of times that contradict each other.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "a field's name says what it is")]
#[error("the times in {taken} and {other} contradict each other: {how}")]
pub struct TimesApart {
    pub taken: String,
    pub other: String,
    pub how: TimeDisagreement,
}

/// Kind of disagreement between two columns of times.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit, the variant's words the rest")]
pub enum TimeDisagreement {
    /// Their durations differ.
    #[error("from the first row to the last they say {} s and {} \
             s", digits(*.taken_s, 5), digits(*.other_s, 5))]
    Lasting { taken_s: f64, other_s: f64 },
    /// They differ by this much in a row, counted from 1.
    #[error("in row {row} of the table they are {} s apart", digits(*.apart_s, 5))]
    InRow { row: usize, apart_s: f64 },
    /// They begin at different times.
    #[error("they begin {} s apart", digits(*.apart_s, 5))]
    AtStart { apart_s: f64 },
}
