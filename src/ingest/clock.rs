//! What a cask file, the recorded times and the recording's own words say of a rate to the one that is taken,
//! or to a refusal.
//!
//! A rate is stated, borne out by times, or asked for; it is never guessed. Readers collect [`Claims`]; only
//! this file compares rates:
//!
//! | cask file | times | other statements | outcome |
//! |---|---|---|---|
//! | rate | any | any | the cask file's; a warning for each other that is off |
//! | – | fine | none, or they agree | the times' |
//! | – | fine | one 0.1 to 1 % off | the times', warning |
//! | – | fine | one farther off, of these samples alone | refusal, unless the cask file names the times |
//! | – | coarse | one that agrees within the coarseness | the statement's |
//! | – | coarse | none | the times', and how far they may be off |
//! | – | none | one, or several that agree | the nearest to the samples |
//! | – | none | two, as near, that differ | refusal |
//! | – | none | none | refusal |

use super::refusal::Refusal;
use super::shown;
use super::statement::Statement;
use crate::data::{ClockFinding, Finding, RatesApart, TimeDisagreement, TimesApart};
use crate::numerics::robust;

/// A rate off by more than this part of itself is told: oscillators keep 1e-4, and every velocity is off by
/// as much.
pub(super) const RATE_TOLERANCE: f64 = 1e-3;

/// Rates further apart than this are no two clocks: one of the statements is wrong, and nothing tells which.
const FAR: f64 = 1e-2;

/// What is said of a channel's rate apart from its times.
#[derive(Debug, Clone, Default)]
pub struct Claims {
    /// `sample_rate_hz` of the channel in the cask file, Hz.
    pub(super) cask_hz: Option<f64>,
    /// Whether the cask file names the times (`time = …`), so that they go before what the recording states.
    pub(super) are_times_named: bool,
    /// What the recording states, nearest to the samples first.
    pub(super) stated: Vec<Statement>,
}

/// The rate that a channel is taken at.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Taken {
    /// Hz.
    pub rate_hz: f64,
    /// Whether it is that of the recorded times.
    pub is_of_times: bool,
    /// What else contradicts it.
    pub issues: Vec<Finding>,
}

/// Whether two rates differ by more than this part of themselves, and than their rounding explains.
fn are_apart(one: &Statement, other: &Statement, tolerance: f64) -> bool {
    (one.rate_hz / other.rate_hz - 1.0).abs() > tolerance.max(one.rounding + other.rounding)
}

/// The rate that recorded times tell in Hz, and how uncertain it is as a part of itself.
pub(super) fn of_times(rate_hz: f64, uncertainty: f64) -> Statement {
    Statement::by("the recorded times", rate_hz, uncertainty)
}

impl Claims {
    /// Of a rate in the cask file alone.
    pub(super) fn of_cask(sample_rate_hz: Option<f64>) -> Self {
        Self { cask_hz: sample_rate_hz, ..Self::default() }
    }

    /// Whether nothing but times can tell a rate.
    pub(super) fn is_empty(&self) -> bool {
        self.cask_hz.is_none() && self.stated.is_empty()
    }

    /// The rate by the table above; `times` is what the recorded times tell, where they tell one.
    ///
    /// # Errors
    /// [`Refusal`] where nothing states a rate, or two that contradict each other have nothing between them
    /// to decide.
    pub(super) fn weigh(&self, times: Option<&Statement>) -> Result<Taken, Refusal> {
        let by_cask_file = |rate_hz| Statement::by("sample_rate_hz of the cask file", rate_hz, 0.0);
        let cask_file = self.cask_hz.map(by_cask_file);
        let is_decided = cask_file.is_some() || self.are_times_named;
        let nearest = self.stated.first();
        // Times that are coarse tell a rate less well than a statement that they bear out.
        let is_better = |stated: &&Statement| {
            times.is_none_or(|times| {
                times.rounding > RATE_TOLERANCE && !are_apart(stated, times, RATE_TOLERANCE)
            })
        };
        let taken = cask_file.or_else(|| nearest.filter(is_better).cloned()).or_else(|| times.cloned());
        let Some(taken) = taken else {
            return Err(Refusal::new(
                "nothing says when its samples were taken",
                "give sample_rate_hz in this channel of the cask file, or name its times: time = \"…\"",
            ));
        };
        let mut issues: Vec<Finding> = Vec::new();
        for other in times.into_iter().chain(&self.stated).filter(|other| **other != taken) {
            let is_open = !is_decided && other.distance <= taken.distance;
            if is_open && are_apart(&taken, other, if times.is_some() { FAR } else { RATE_TOLERANCE }) {
                return Err(contradiction(&taken, other));
            }
            if are_apart(&taken, other, RATE_TOLERANCE) {
                issues.push(ClockFinding::Rates(apart(&taken, other)).into());
            }
        }
        let is_of_times = times == Some(&taken);
        Ok(Taken { rate_hz: taken.rate_hz, is_of_times, issues })
    }
}

fn apart(taken: &Statement, other: &Statement) -> RatesApart {
    let (taken_hz, taken_by) = (taken.rate_hz, taken.place.clone());
    RatesApart { taken_hz, taken_by, other_hz: other.rate_hz, other_by: other.place.clone() }
}

fn contradiction(taken: &Statement, other: &Statement) -> Refusal {
    let [one, two] = [taken, other].map(|said| shown::hz(said.rate_hz));
    Refusal::new(
        format!("{}: one of the two is wrong, and every velocity goes with the rate", apart(taken, other)),
        format!(
            "write the right one into this channel of the cask file: sample_rate_hz = {one} or \
             sample_rate_hz = {two}"
        ),
    )
}

/// A column or dataset of times, s.
#[derive(Clone, Copy)]
pub(super) struct Clock<'a> {
    /// For people: `column "t"`, `/daq/time`.
    pub name: &'a str,
    /// NaN where a row holds none.
    pub times_s: &'a [f64],
}

impl Clock<'_> {
    /// Whether another column of times bears these out: from the first row to the last, and at the row where
    /// they are farthest apart, by 0.1 % of the record and a row of each. A warning where it does not;
    /// `is_start_shared` where both count from the same event.
    ///
    /// # Errors
    /// [`Refusal`] beyond 1 % of the record, unless the cask file says which times to take (`is_decided`).
    pub(super) fn borne_out_by(
        &self,
        other: &Self,
        is_start_shared: bool,
        is_decided: bool,
    ) -> Result<Option<Finding>, Refusal> {
        let rows = self.times_s.iter().zip(other.times_s).enumerate();
        let mut rows = rows.filter(|(_, (own_s, other_s))| own_s.is_finite() && other_s.is_finite());
        let Some((_, (&first_s, &other_first_s))) = rows.next() else { return Ok(None) };
        let (mut last, mut count) = ((first_s, other_first_s), 0_u32);
        // A common start within the record; the time of day is no start.
        let offset_s = other_first_s - first_s;
        let (mut worst_row, mut worst_s) = (0, 0.0_f64);
        for (row, (&own_s, &other_s)) in rows {
            let apart_s = other_s - own_s - offset_s;
            if apart_s.abs() > worst_s.abs() {
                (worst_row, worst_s) = (row, apart_s);
            }
            // A second column that falls counts something else.
            if other_s < last.1 {
                return Ok(None);
            }
            last = (own_s, other_s);
            count += 1;
        }
        let (span_s, other_span_s) = (last.0 - first_s, last.1 - other_first_s);
        if count == 0 || span_s <= 0.0 || other_span_s <= 0.0 {
            return Ok(None);
        }
        // A time is known to its interval, or to what it is cut to where that is longer.
        let row_s = usual_step(self.times_s) + usual_step(other.times_s);
        let part = |apart_s: f64| ((apart_s.abs() - row_s) / span_s).max(0.0);
        let (whole, worst) = (part(other_span_s - span_s), part(worst_s));
        let start = if is_start_shared && offset_s.abs() < span_s { part(offset_s) } else { 0.0 };
        if whole.max(worst).max(start) <= RATE_TOLERANCE {
            return Ok(None);
        }
        let how = if whole > RATE_TOLERANCE {
            TimeDisagreement::Lasting { taken_s: span_s, other_s: other_span_s }
        } else if worst > RATE_TOLERANCE {
            TimeDisagreement::InRow { row: worst_row + 1, apart_s: worst_s.abs() }
        } else {
            TimeDisagreement::AtStart { apart_s: offset_s.abs() }
        };
        let (one, two) = (self.name, other.name);
        let apart = TimesApart { taken: one.to_owned(), other: two.to_owned(), how };
        if whole.max(worst).max(start) > FAR && !is_decided {
            let remedy = format!(
                "write which is right into the cask file, under [recording] or in the [[channel]]: time = \
                 {one} or time = {two}; or sample_rate_hz in each [[channel]]"
            );
            return Err(Refusal::new(apart.to_string(), remedy));
        }
        Ok(Some(ClockFinding::Times(apart).into()))
    }
}

/// The usual step from a time to a later one: their interval, or what they are cut to where that is longer; 0
/// without any.
pub(super) fn usual_step(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0).collect();
    if steps.is_empty() { 0.0 } else { robust::median(&mut steps) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(rate_hz: f64, distance: usize) -> Statement {
        Statement { place: format!("fs = {rate_hz}"), rate_hz, rounding: 0.0, distance }
    }

    /// Cask file, whether it names the times, statements, times: the rate taken with the number of warnings,
    /// or a part of the refusal.
    type Row<'a> = (Option<f64>, bool, &'a [Statement], Option<Statement>, Result<(f64, usize), &'a str>);

    #[test]
    fn a_rate_is_weighed_by_the_table() {
        let claims = |cask_hz, are_times_named, stated: &[Statement]| Claims {
            cask_hz,
            are_times_named,
            stated: stated.to_vec(),
        };
        let fine = |rate_hz| Some(of_times(rate_hz, 0.0));
        let coarse = |rate_hz| Some(of_times(rate_hz, 5e-3));
        let rows: [Row; 19] = [
            (Some(1e4), false, &[stated(9e3, 0), stated(1e4, 0)], fine(8e3), Ok((1e4, 2))),
            (Some(1e4), false, &[], fine(10_005.0), Ok((1e4, 0))),
            (None, false, &[], fine(9_999.0), Ok((9_999.0, 0))),
            (None, false, &[stated(1e4, 0)], fine(9_995.0), Ok((9_995.0, 0))),
            (None, false, &[stated(1e4, 0)], fine(9_950.0), Ok((9_950.0, 1))),
            (None, false, &[stated(1e4, 0)], fine(9_500.0), Err("9500 Hz by the recorded times")),
            (None, true, &[stated(1e4, 0)], fine(9_500.0), Ok((9_500.0, 1))),
            (None, false, &[stated(1e4, 1)], fine(9_500.0), Ok((9_500.0, 1))),
            (None, false, &[stated(1e4, 0)], coarse(9_970.0), Ok((1e4, 0))),
            (None, false, &[stated(1e4, 1)], coarse(9_970.0), Ok((1e4, 0))),
            (None, false, &[stated(1e4, 0)], coarse(9_500.0), Err("10000 Hz by fs")),
            (None, false, &[], coarse(9_500.0), Ok((9_500.0, 0))),
            (None, false, &[stated(1e4, 0)], None, Ok((1e4, 0))),
            (None, false, &[stated(1e4, 1)], None, Ok((1e4, 0))),
            (None, false, &[stated(1e4, 0), stated(10_005.0, 0)], None, Ok((1e4, 0))),
            (None, false, &[stated(1e4, 0), stated(10_050.0, 0)], None, Err("10050 Hz by fs")),
            (None, false, &[stated(1e4, 1), stated(2e4, 1)], None, Err("20000 Hz by fs")),
            (None, false, &[stated(1e4, 0), stated(2e4, 1)], None, Ok((1e4, 1))),
            (None, true, &[], None, Err("nothing says when")),
        ];
        for (number, (cask_hz, are_times_named, stated, times, expected)) in rows.into_iter().enumerate() {
            let taken = claims(cask_hz, are_times_named, stated).weigh(times.as_ref());
            match (taken, expected) {
                (Ok(taken), Ok(expected)) => {
                    assert!(taken.rate_hz.total_cmp(&expected.0).is_eq(), "row {number}: {taken:?}");
                    assert_eq!(taken.issues.len(), expected.1, "row {number}: {taken:?}");
                }
                (Err(refusal), Err(part)) => {
                    assert!(refusal.problem.contains(part), "row {number}: {refusal:?}");
                    assert!(refusal.remedy.contains("sample_rate_hz"), "row {number}: {refusal:?}");
                }
                (taken, _) => panic!("row {number}: {taken:?}"),
            }
        }
    }

    #[test]
    fn what_rounding_explains_is_no_contradiction() {
        let rounded = Statement { rounding: 0.03, ..stated(1e4, 0) };
        for (rate_hz, is_apart) in [(9_800.0, false), (9_600.0, true), (9_500.0, true)] {
            let found = [RATE_TOLERANCE, FAR].map(|part| are_apart(&rounded, &stated(rate_hz, 0), part));
            assert_eq!(found, [is_apart; 2], "{rate_hz}");
        }
    }

    #[test]
    fn a_second_column_of_times_bears_the_first_out_or_is_told() {
        let times_s: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-3).collect();
        let with = |other: &dyn Fn(f64) -> f64, is_start_shared, is_decided| {
            let others: Vec<f64> = times_s.iter().map(|t| other(*t)).collect();
            let clock = Clock { name: "\"t\"", times_s: &times_s };
            clock.borne_out_by(&Clock { name: "\"u\"", times_s: &others }, is_start_shared, is_decided)
        };
        assert_eq!(with(&|t| t + 3600.0, true, false), Ok(None));
        assert_eq!(with(&|t| (t * 100.0).floor() / 100.0, false, false), Ok(None));
        assert_eq!(with(&|t| 1.0 - t, false, false), Ok(None), "it counts down");
        assert!(with(&|t| 1.005 * t, false, false).unwrap().is_some(), "a clock half a per cent off");
        assert!(with(&|t| 1.1 * t, false, false).is_err());
        assert!(with(&|t| 1.1 * t, false, true).unwrap().is_some());
        assert!(with(&|t| t + 0.1, true, false).unwrap_err().problem.contains("begin 0.1 s apart"));
        let bulge = with(&|t| if (0.4..0.6).contains(&t) { t.mul_add(0.5, 0.2) } else { t }, false, false);
        assert!(bulge.unwrap_err().problem.contains("in row 600"));
    }
}
