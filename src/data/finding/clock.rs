//! What speaks against the rate or the times that a recording is read by, with its numbers, to code, severity
//! and sentence.

use super::{IssueCode as Code, Severity};
use crate::data::shown::{digits, hz};

findings! {
/// A finding about two things that say when samples were taken.
pub enum ClockFinding of Clock {
    /// A rate was taken, and another one is said.
    Rates(apart: RatesApart) => (Code::Clock, Warning, Nothing),
        ("{apart}; the first was taken, and every velocity goes with the rate: if the second is right, write \
         sample_rate_hz = {rate}", rate = hz(apart.other_hz));
    /// Times were taken, and another column or dataset does not bear them out.
    Times(apart: TimesApart) => (Code::Clock, Warning, Nothing),
        ("{apart}; the channels timed by {} have their velocities from it", apart.taken);
    /// A listing has no rate, for reading would refuse: the problem and its remedy.
    Refused(words: String) => (Code::Clock, Warning, Nothing),
        ("{words}");
}
}

/// Two rates that contradict each other, each in Hz with what says it.
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
    pub how: HowApart,
}

/// By what two columns of times contradict each other.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit, the variant's words the rest")]
pub enum HowApart {
    /// By how long they last.
    #[error("from the first row to the last they say {} s and {} \
             s", digits(*.taken_s, 5), digits(*.other_s, 5))]
    Lasting { taken_s: f64, other_s: f64 },
    /// By so much in a row, from 1.
    #[error("in row {row} of the table they are {} s apart", digits(*.apart_s, 5))]
    InRow { row: usize, apart_s: f64 },
    /// By where they begin.
    #[error("they begin {} s apart", digits(*.apart_s, 5))]
    AtStart { apart_s: f64 },
}
