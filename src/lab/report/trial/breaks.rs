//! A line of a failure map to where it breaks and whether that was noticed.

use crate::lab::data::{TrialLine, TrialMap};
use crate::report::rounding;

/// Where a method fails.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Break {
    /// The stress at which the error passes the limit, read between its neighbours; none where it does not.
    pub(super) at: Option<f64>,
    /// Largest error that was given.
    pub(super) worst: Option<f64>,
    /// Stresses beyond the limit at which the program said so, and at which it did not; none where it has no way to.
    pub(super) noticed: Option<(usize, usize)>,
    /// Stresses at which no number was given.
    pub(super) silent: usize,
}

/// Of one line.
pub(super) fn of(map: &TrialMap, line: &TrialLine) -> Break {
    let beyond = |error: &Option<f64>| error.is_some_and(|e| e.is_nan() || e > map.limit);
    let first = line.errors.iter().position(beyond);
    let at = first.and_then(|i| {
        let here = *map.stresses.get(i)?;
        let before = i.checked_sub(1).and_then(|b| Some((*map.stresses.get(b)?, line.errors[b]?)));
        let (Some((stress, error)), Some(worse)) = (before, line.errors[i]) else { return Some(here) };
        if !(error > 0.0 && worse.is_finite()) {
            return Some(here);
        }
        let share = ((map.limit / error).ln() / (worse / error).ln()).clamp(0.0, 1.0);
        Some(if map.is_log && stress > 0.0 {
            stress * (here / stress).powf(share)
        } else {
            stress + share * (here - stress)
        })
    });
    let words: Vec<bool> = line
        .errors
        .iter()
        .zip(&line.noticed)
        .filter(|(error, _)| beyond(error))
        .filter_map(|(_, noticed)| *noticed)
        .collect();
    let said = words.iter().filter(|said| **said).count();
    Break {
        at,
        worst: line.errors.iter().flatten().copied().reduce(f64::max),
        noticed: (!words.is_empty()).then_some((said, words.len() - said)),
        silent: line.errors.iter().filter(|e| e.is_none()).count(),
    }
}

impl Break {
    /// "at 3.2e4", or that it holds.
    pub(super) fn at_words(&self) -> String {
        match self.at {
            Some(at) => rounding::plain(at, 2),
            None if self.worst.is_none() => "no number given".to_owned(),
            None => "holds".to_owned(),
        }
    }

    /// Whether the program said so.
    pub(super) fn noticed_words(&self) -> String {
        match (self.at, self.noticed) {
            (None, _) => "–".to_owned(),
            (Some(_), None) => "no way to".to_owned(),
            (Some(_), Some((_, 0))) => "yes".to_owned(),
            (Some(_), Some((0, _))) => "NO".to_owned(),
            (Some(_), Some((said, not))) => format!("{said} of {}", said + not),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn a_break_lies_where_the_line_crosses_the_limit() {
        let map = &sample::trial().maps[0];
        let broken = of(map, &map.lines[0]);
        // 1e-3 at 100 and 1e-1 at 1000: 1e-2 half way on log axes.
        assert!((broken.at.unwrap() / 10_f64.powf(2.5) - 1.0).abs() < 1e-12);
        assert_eq!((broken.noticed, broken.noticed_words().as_str()), (Some((1, 1)), "1 of 2"));
        let holds = of(map, &map.lines[1]);
        assert_eq!((holds.at, holds.at_words().as_str(), holds.silent), (None, "holds", 1));
    }
}
