//! What else beside a channel is named as times to whether it bears out those that were taken.

use super::super::time_reading::{Scale, UNITS};
use super::attributes;
use super::dataset::Column;
use super::fault::Fault;
use crate::data::{Issue, IssueCode, Samples, Severity};
use crate::ingest::clock_pair::{FAR, Pair};
use crate::ingest::time_base::RATE_TOLERANCE;

/// Other times that contradict those that were taken.
pub(super) struct Contradiction {
    /// Both, in words.
    pub fault: Fault,
    /// Whether they are apart by more than 1 %.
    pub is_far: bool,
}

impl Contradiction {
    /// As a warning, where something decides between them.
    pub(super) fn issue(self) -> Issue {
        let message = format!(
            "{}; those of the first were taken, and every velocity goes with them",
            self.fault.problem
        );
        Issue::new(IssueCode::Clock, Severity::Warning, message)
    }
}

/// Where `other`, as many values, contradicts `taken` and the seconds read from it by more than 0.1 % and what both are cut to.
///
/// Its values are read for that; `may_read` is asked before.
pub(super) fn contradiction(
    (taken, times_s): (&Column, &[f64]),
    other: &Column,
    may_read: impl FnOnce(&Column) -> bool,
) -> Option<Contradiction> {
    // What is no time by its unit says nothing.
    let (scale, factor, _) = attributes::time_scale(other).ok()?;
    if matches!(scale, Scale::Unknown | Scale::Twofold(..)) {
        return None;
    }
    let others = may_read(other).then(|| other.samples().ok())??;
    let others: Vec<f64> = match others {
        Samples::F32(times) => times.into_iter().map(|t| factor * f64::from(t)).collect(),
        Samples::F64(times) => times.into_iter().map(|t| factor * t).collect(),
    };
    if is_borne_out(times_s, &others, scale) {
        return None;
    }
    let (miss, says) = Pair::of(times_s, &others)?.contradiction(scale, false)?;
    let sources = [taken, other].map(Column::source);
    let fault = Fault {
        problem: format!("the times in {} and {} contradict each other: {says}", sources[0], sources[1]),
        mend: format!(
            "write which are right into the cask file, under [recording]: time = \"{}\" or time = \"{}\"; or sample_rate_hz in each [[channel]]",
            sources[0], sources[1]
        ),
    };
    Some(Contradiction { fault, is_far: miss > FAR })
}

/// Whether from the first to the last value the same time goes by in any unit that may be meant.
fn is_borne_out(times_s: &[f64], others: &[f64], scale: Scale) -> bool {
    let ([first, .., last], [first_s, .., last_s]) = (others, times_s) else { return false };
    let units = match scale {
        Scale::Known(unit_s) => &[("", unit_s)],
        _ => &UNITS[..],
    };
    let parts = units.iter().map(|unit| (last - first) * unit.1 / (last_s - first_s));
    parts.into_iter().any(|part| (part - 1.0).abs() <= RATE_TOLERANCE)
}
