//! Rows to shares, quantiles and classes of right and wrong.

use crate::data::{Estimate, Verdict};
use crate::lab::data::{CampaignRow, Scored};
pub(in crate::lab) use crate::numerics::robust::quantile;

/// An error above this many half-widths on a result that passed is a miss: the interval ends half its width, which is one half-width, short of the truth.
const MISSED_BY: f64 = 2.0;

/// What became of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum SceneOutcome {
    /// Passed, and right.
    Right,
    /// Not passed, but its numbers hold.
    Covered,
    /// Not passed, and without numbers or with wrong ones.
    Caught,
    /// Passed, and wrong.
    Missed,
}

/// What became of the scene of this row, by speed and k.
pub(super) fn outcome(row: &CampaignRow) -> SceneOutcome {
    let off = [scored(row, "speed"), scored(row, "k")].map(|scored| scored.and_then(|s| half_widths_off(&s)));
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

/// By how many standard uncertainties the closure that is missed most is missed.
pub(super) fn largest_miss_u(row: &CampaignRow) -> Option<f64> {
    row.misses_u.iter().map(|miss| miss.abs()).max_by(f64::total_cmp)
}

/// The quantity of this name.
pub(super) fn scored(row: &CampaignRow, name: &str) -> Option<Scored> {
    row.quantities.iter().find(|scored| scored.name == name).copied()
}

/// Distance from the truth in half-widths, where both are known.
pub(in crate::lab) fn half_widths_off(scored: &Scored) -> Option<f64> {
    let (stated, truth) = scored.stated.zip(scored.truth)?;
    Some(half_widths_between(stated, truth))
}

/// The same of an estimate.
pub(in crate::lab) fn half_widths_between(stated: Estimate, truth: f64) -> f64 {
    // No number at all is as far off as can be.
    let off = (stated.value - truth).abs() / stated.u95.max(f64::MIN_POSITIVE);
    if off.is_nan() { f64::INFINITY } else { off }
}

/// Errors, half-widths and coverage of one quantity over many scenes.
pub(super) struct Spread {
    /// Magnitudes of the errors, ascending.
    pub errors: Vec<f64>,
    /// Half-widths, ascending.
    pub half_widths: Vec<f64>,
    /// How many intervals hold the truth.
    pub held: usize,
}

impl Spread {
    /// Of pairs of statement and truth; `relative`: in percent of the truth.
    pub(super) fn of(pairs: impl Iterator<Item = (Estimate, f64)>, relative: bool) -> Self {
        let mut spread = Self { errors: Vec::new(), half_widths: Vec::new(), held: 0 };
        for (stated, truth) in pairs {
            let scale = if relative { 100.0 / truth.abs().max(f64::MIN_POSITIVE) } else { 1.0 };
            let off = (stated.value - truth).abs();
            spread.held += usize::from(off <= stated.u95);
            spread.errors.push(scale * off);
            spread.half_widths.push(scale * stated.u95);
        }
        spread.errors.sort_by(f64::total_cmp);
        spread.half_widths.sort_by(f64::total_cmp);
        spread
    }

    /// How many statements there are.
    pub(super) fn count(&self) -> usize {
        self.errors.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_their_neighbours() {
        let values = [1.0, 2.0, 4.0];
        assert!((quantile(&values, 0.5) - 2.0).abs() < 1e-15);
        assert!((quantile(&values, 0.75) - 3.0).abs() < 1e-15);
        assert!((quantile(&values, 1.0) - 4.0).abs() < 1e-15);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn a_statement_is_held_against_its_own_half_width() {
        let off = |value, u95| {
            half_widths_off(&Scored {
                name: "k",
                stated: Some(Estimate::new(value, u95, "1")),
                truth: Some(0.5),
            })
            .expect("both known")
        };
        assert!((off(0.53, 0.02) - 1.5).abs() < 1e-9);
        assert!(off(f64::NAN, 0.02).is_infinite());
        assert!(off(0.5, 0.0).abs() < 1e-15);
        assert!(half_widths_off(&Scored { name: "k", stated: None, truth: Some(0.5) }).is_none());
    }
}
