//! What speaks against the rate or the times that a recording is read by, with its numbers, to code, severity and sentence.

use super::{IssueCode as Code, Severity};
use crate::data::shown::{digits, hz};
use std::fmt;

/// A finding about two things that say when samples were taken.
#[derive(Debug, Clone, PartialEq)]
pub enum ClockFinding {
    /// A rate was taken, and another one is said.
    Rates(RatesApart),
    /// Times were taken, and another column or dataset does not bear them out.
    Times(TimesApart),
    /// A listing has no rate, for reading would refuse: the problem and its remedy.
    Refused(String),
}

/// Two rates that contradict each other, each in Hz with what says it.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit")]
pub struct RatesApart {
    pub taken_hz: f64,
    pub taken_by: String,
    pub other_hz: f64,
    pub other_by: String,
}

impl fmt::Display for RatesApart {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { taken_hz, taken_by, other_hz, other_by } = self;
        let [taken, other] = [hz(*taken_hz), hz(*other_hz)];
        write!(f, "two rates contradict each other: {taken} Hz by {taken_by}, {other} Hz by {other_by}")
    }
}

/// Two columns or datasets of times that contradict each other.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "a field's name says what it is")]
pub struct TimesApart {
    pub taken: String,
    pub other: String,
    pub how: HowApart,
}

/// By what two columns of times contradict each other.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "a field's name says what it is and its unit, the variant's words the rest")]
pub enum HowApart {
    /// By how long they last.
    Lasting { taken_s: f64, other_s: f64 },
    /// By so much in a row, from 1.
    InRow { row: usize, apart_s: f64 },
    /// By where they begin.
    AtStart { apart_s: f64 },
}

impl fmt::Display for TimesApart {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let s = |s: f64| digits(s, 5);
        write!(f, "the times in {} and {} contradict each other: ", self.taken, self.other)?;
        match self.how {
            HowApart::Lasting { taken_s, other_s } => {
                write!(f, "from the first row to the last they say {} s and {} s", s(taken_s), s(other_s))
            }
            HowApart::InRow { row, apart_s } => {
                write!(f, "in row {row} of the table they are {} s apart", s(apart_s))
            }
            HowApart::AtStart { apart_s } => write!(f, "they begin {} s apart", s(apart_s)),
        }
    }
}

impl ClockFinding {
    /// The check that speaks, and how much it weighs.
    #[allow(clippy::unused_self, reason = "as those of the other kinds")]
    pub(super) fn code(&self) -> (Code, Severity) {
        (Code::Clock, Severity::Warning)
    }

    /// What was found, its size, and what to do.
    pub(super) fn sentence(&self) -> String {
        match self {
            Self::Rates(apart) => format!(
                "{apart}; the first was taken, and every velocity goes with the rate: if the second is right, write sample_rate_hz = {}",
                hz(apart.other_hz)
            ),
            Self::Times(apart) => format!("{apart}; the first was taken, and every velocity goes with it"),
            Self::Refused(words) => words.clone(),
        }
    }
}
