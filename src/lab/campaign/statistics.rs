//! Rows to shares, quantiles and classes of right and wrong, which add up exactly in whatever order and parts
//! they are counted.

use crate::data::{ReconstructionRung, Verdict};
use crate::lab::data::{CampaignRow, Scored, Stated};
use crate::numerics::{as_count, as_f64};
use std::collections::BTreeMap;

/// An error above this many half-widths on a result that passed is a miss: the interval ends half its width,
/// which is one half-width, short of the truth.
const MISSED_BY: f64 = 2.0;

/// Names, as they are scored and as they are shown; whether in percent of the truth; decimals.
pub(super) const QUANTITIES: [(&str, &str, bool, usize); 10] = [
    ("speed", "slap-down speed, %", true, 2),
    ("k", "k", false, 4),
    ("vertical", "vertical velocity, m/s", false, 3),
    ("horizontal", "horizontal velocity, m/s", false, 3),
    ("omega", "ω after the impact, %", true, 2),
    ("flight", "flight time, %", true, 2),
    ("angle", "angle at slap-down, °", false, 3),
    ("duration", "duration of the first contact, %", true, 2),
    ("contact_time", "time of the first contact, s", false, 6),
    ("slap_down_time", "time of the slap-down, s", false, 6),
];

/// What became of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SceneOutcome {
    /// Passed, and right.
    Right,
    /// Not passed, but its numbers hold.
    Covered,
    /// Not passed, and without numbers or with wrong ones.
    Caught,
    /// Passed, and wrong.
    Missed,
}

impl SceneOutcome {
    /// From the best to the worst.
    pub(super) const ALL: [Self; 4] = [Self::Right, Self::Covered, Self::Caught, Self::Missed];

    /// "right", "covered" and so on.
    pub fn word(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

/// What became of the scene of this row, by speed and k.
pub fn outcome(row: &CampaignRow) -> SceneOutcome {
    let off = ["speed", "k"].map(|name| row.quantities.get(name).and_then(half_widths_off));
    let worst = off.iter().flatten().fold(0.0_f64, |worst, off| worst.max(*off));
    let has_both = off.iter().all(Option::is_some);
    match row.verdict {
        Some(Verdict::Pass) if worst > MISSED_BY => SceneOutcome::Missed,
        Some(Verdict::Pass) if has_both => SceneOutcome::Right,
        Some(_) if has_both && worst <= 1.0 => SceneOutcome::Covered,
        _ => SceneOutcome::Caught,
    }
}

/// Whether the row passed and is wrong.
pub(in crate::lab) fn is_missed(row: &CampaignRow) -> bool {
    outcome(row) == SceneOutcome::Missed
}

/// Distance from the truth in half-widths, where both are known.
pub(in crate::lab) fn half_widths_off(scored: &Scored) -> Option<f64> {
    let (stated, truth) = scored.stated.zip(scored.truth)?;
    Some(half_widths_between(stated, truth))
}

/// The same of a statement.
pub(in crate::lab) fn half_widths_between(stated: Stated, truth: f64) -> f64 {
    // No number at all is as far off as can be.
    let off = (stated.value - truth).abs() / stated.u95.max(f64::MIN_POSITIVE);
    if off.is_nan() { f64::INFINITY } else { off }
}

/// Magnitudes counted in bins a five-hundredth of themselves wide: what is read off is right to a thousandth,
/// and of however many there are some thousand counts are kept.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Magnitudes {
    bins: BTreeMap<u32, u32>,
    count: usize,
    largest: f64,
}

/// Bits of a number that are left out of its bin: all but sign, exponent and nine of its fraction.
const BITS_LEFT_OUT: u32 = 43;

impl Magnitudes {
    fn add(&mut self, value: f64) {
        let value = if value.is_nan() { f64::INFINITY } else { value.abs() };
        // Bits of positive numbers are in their order.
        let bin = u32::try_from(value.to_bits() >> BITS_LEFT_OUT).unwrap_or(u32::MAX);
        *self.bins.entry(bin).or_default() += 1;
        self.count += 1;
        self.largest = self.largest.max(value);
    }

    /// The value below which this share lies; the largest is known as it is. NaN of none.
    pub(super) fn quantile(&self, share: f64) -> f64 {
        let Some(last) = self.count.checked_sub(1) else { return f64::NAN };
        let place = share * as_f64(last);
        let below = as_count(place).min(last);
        let (low, high) = (self.at(below), self.at((below + 1).min(last)));
        // Equal neighbours may be infinite.
        let beyond = place - as_f64(below);
        if beyond > 0.0 && low < high { low + beyond * (high - low) } else { low }
    }

    /// The value of this rank: the middle of its bin.
    fn at(&self, rank: usize) -> f64 {
        if rank + 1 == self.count {
            return self.largest;
        }
        let mut seen = 0;
        let bin = self.bins.iter().find(|(_, count)| {
            seen += **count as usize;
            seen > rank
        });
        let middle = |bin: &u32| f64::from_bits((2 * u64::from(*bin) + 1) << (BITS_LEFT_OUT - 1));
        bin.map_or(f64::NAN, |(bin, _)| middle(bin).min(self.largest))
    }
}

/// Errors, half-widths and coverage of one quantity over many scenes.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Spread {
    /// Magnitudes of the errors.
    pub errors: Magnitudes,
    /// Half-widths.
    pub half_widths: Magnitudes,
    /// How many intervals hold the truth.
    pub held: usize,
}

impl Spread {
    /// Counts one statement beside its truth, where there are both; `relative`: in percent of the truth.
    pub(super) fn add(&mut self, both: Option<(Stated, f64)>, relative: bool) {
        let Some((stated, truth)) = both else { return };
        let scale = if relative { 100.0 / truth.abs().max(f64::MIN_POSITIVE) } else { 1.0 };
        let off = (stated.value - truth).abs();
        self.held += usize::from(off <= stated.u95);
        self.errors.add(scale * off);
        self.half_widths.add(scale * stated.u95);
    }

    /// How many statements there are.
    pub(super) fn count(&self) -> usize {
        self.errors.count
    }
}

/// What is said of a scene in a word each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SceneWords {
    /// None where the recording was refused.
    pub verdict: Option<Verdict>,
    pub outcome: SceneOutcome,
    /// Whether speed and k are stated.
    pub has_numbers: bool,
    /// The rung of the reconstruction taken.
    pub rung: Option<ReconstructionRung>,
}

/// Some scenes of a campaign, counted.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct SceneGroup {
    counts: BTreeMap<SceneWords, usize>,
    /// In the order of [`QUANTITIES`].
    spreads: Vec<Spread>,
}

impl SceneGroup {
    /// Counts a scene, and of its quantities so many.
    pub(super) fn add(&mut self, row: &CampaignRow, quantities: usize) {
        let (outcome, has_numbers) = (outcome(row), row.has_numbers());
        let words = SceneWords { verdict: row.verdict, outcome, has_numbers, rung: row.rung };
        *self.counts.entry(words).or_default() += 1;
        self.spreads.resize(quantities, Spread::default());
        for (spread, (name, _, relative, _)) in self.spreads.iter_mut().zip(QUANTITIES) {
            spread.add(row.stated(name).zip(row.truth(name)), relative);
        }
    }

    /// How many scenes there are of which this is said.
    pub(super) fn count(&self, is_said: impl Fn(&SceneWords) -> bool) -> usize {
        self.counts.iter().filter(|(words, _)| is_said(words)).map(|(_, count)| count).sum()
    }

    /// How many scenes there are.
    pub(super) fn len(&self) -> usize {
        self.count(|_| true)
    }

    /// How many have this outcome.
    pub(super) fn with(&self, outcome: SceneOutcome) -> usize {
        self.count(|words| words.outcome == outcome)
    }

    /// What is counted of a quantity.
    pub(super) fn spread(&self, name: &str) -> Spread {
        let place = QUANTITIES.iter().position(|(own, ..)| *own == name);
        place.and_then(|place| self.spreads.get(place)).cloned().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::robust::quantile;

    fn counted(values: impl IntoIterator<Item = f64>) -> Magnitudes {
        let mut all = Magnitudes::default();
        for value in values {
            all.add(value);
        }
        all
    }

    #[test]
    fn quantiles_lie_between_their_neighbours() {
        let values = [1.0, 2.0, 4.0];
        assert!((quantile(&values, 0.5) - 2.0).abs() < 1e-15);
        assert!((quantile(&values, 0.75) - 3.0).abs() < 1e-15);
        assert!((quantile(&values, 1.0) - 4.0).abs() < 1e-15);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn counted_quantiles_are_right_to_a_thousandth_whatever_the_order() {
        let values: Vec<f64> = (0..997).map(|i| f64::from(i * i % 997).powi(3) / 1e6).collect();
        let mut ascending = values.clone();
        ascending.sort_by(f64::total_cmp);
        let counted_values = counted(values.iter().copied());
        assert_eq!(counted_values, counted(values.iter().rev().copied()));
        for share in [0.05, 0.5, 0.95, 0.999] {
            let exact = quantile(&ascending, share);
            // Half a bin: 2^-10 of the value.
            assert!((counted_values.quantile(share) / exact - 1.0).abs() < 1e-3, "{share}");
        }
        assert_eq!(counted_values.quantile(1.0).to_bits(), ascending[996].to_bits());
        assert!(Magnitudes::default().quantile(0.5).is_nan());
        assert!(counted([f64::NAN, f64::INFINITY, 1.0]).quantile(0.9).is_infinite());
        assert!(counted([0.0, 0.0, 0.0]).quantile(0.5) < 1e-300);
    }

    #[test]
    fn a_statement_is_held_against_its_own_half_width() {
        let off = |value, u95| {
            let stated = Some(Stated { value, u95 });
            half_widths_off(&Scored { stated, truth: Some(0.5) }).expect("both known")
        };
        assert!((off(0.53, 0.02) - 1.5).abs() < 1e-9);
        assert!(off(f64::NAN, 0.02).is_infinite());
        assert!(off(0.5, 0.0).abs() < 1e-15);
        assert!(half_widths_off(&Scored { stated: None, truth: Some(0.5) }).is_none());
    }
}
