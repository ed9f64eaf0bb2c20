//! Judges the consistency checks: those that fail contradict scales, positions, angle or height.

use crate::data::{
    CONSISTENT_U, CheckKind, Consistency, Drop, DropFinding, Estimate, Events, Finding, MISSED_U, Method,
    MethodChoice, Signal,
};
use crate::numerics::pooled::chi_square_quantile;

/// A check that fails by this many standard uncertainties removes the numbers: angle, height or a scale is
/// not as stated.
const GROSS_U: f64 = 12.0;

/// Limit for the rotation of the second impact, which chance exceeds in one of 400 drops: only this check
/// shows a length off by 5 %, and by no more than this in half of the drops.
const LENGTH_U: f64 = 3.0;

/// Normal quantile of the limit on χ², exceeded by chance as often as a single check exceeds [`MISSED_U`]: a
/// normal deviate is above 3.31 as often as it is beyond ± 3.5.
const CHANCE: f64 = 3.31;

/// A check that fails by this many standard uncertainties casts doubt on a k with at least this 95 %
/// half-width, three times the usual: chance alone causes that for one in 60 of such k, and an overloaded
/// channel had k 3.9 half-widths off.
const STRAINED_U: f64 = 2.4;
const OPEN_U95_K: f64 = 0.075;

/// A gap this near to the first contact may hide the contact, s.
const CONTACT_S: f64 = 1e-3;
/// Largest 95 % half-widths of a useful number: k ± 0.25 spans half of 0 to 1; for a speed, as a share, 20 ±
/// 3 m/s.
pub const MOST_U95_K: f64 = 0.25;
pub const MOST_U95_SPEED: f64 = 0.15;

/// Reports each check that fails by more than noise and tolerances explain.
pub fn judge_closures(choice: &MethodChoice, drop: &Drop, events: &Events) -> Vec<Finding> {
    let missed = choice.closures.iter().filter(|c| c.miss_in_u.abs() > MISSED_U);
    let mut findings: Vec<Finding> = missed.map(|closure| judge_missed(closure, drop, events)).collect();
    if findings.is_empty() {
        findings.extend(judge_together(choice));
    }
    findings
}

/// Reports a check that is met only because k is uncertain: no contradiction, but no confirmation either.
pub fn judge_strained(choice: &MethodChoice, k: Estimate) -> Option<Finding> {
    let strained = choice.closures.iter().find(|c| c.largest_residual() > STRAINED_U)?;
    let is_missed = choice.closures.iter().any(|c| c.miss_in_u.abs() > MISSED_U);
    let finding = DropFinding::RestitutionDoubted { k, strained: Some(strained.clone()) };
    (k.u95 > OPEN_U95_K && k.value >= 0.0 && !is_missed).then(|| finding.into())
}

/// True if the checks determine the velocity steps that channels lost to clipping or gaps: R's height at the
/// slap-down determines the step of one end, rotation against impulse that of the other.
///
/// A gap at the first contact hides the time from which both checks count. If a check fails although the lost
/// steps are free, more is wrong than the steps.
pub fn determines_lost_steps(
    choice: &MethodChoice,
    (k, speed): (Estimate, Option<Estimate>),
    signals: &[Signal],
    contact_s: f64,
) -> bool {
    let has = |kind| choice.closures.iter().any(|c| c.kind == kind);
    let are_all_met = choice.closures.iter().all(|c| c.largest_residual() < CONSISTENT_U);
    let shows_contact =
        signals.iter().all(|s| !s.overlaps(&s.gaps, contact_s - CONTACT_S, contact_s + CONTACT_S));
    let says_something =
        k.u95 < MOST_U95_K && speed.is_some_and(|speed| speed.u95 < MOST_U95_SPEED * speed.value);
    choice.rung == Method::Joint
        && has(CheckKind::Height)
        && has(CheckKind::Turning)
        && are_all_met
        && shows_contact
        && says_something
}

/// Reports several checks that fail together: chance allows one failure of 3 u, but not three.
fn judge_together(choice: &MethodChoice) -> Option<Finding> {
    let (chi_square, degrees) = choice.chi_square?;
    let most_u = |c: &Consistency| if c.kind == CheckKind::SecondTurning { LENGTH_U } else { MISSED_U };
    let is_any_far = choice.closures.iter().any(|c| c.largest_residual() > most_u(c));
    (is_any_far || chi_square > chi_square_quantile(degrees, CHANCE)).then(|| {
        let closures = choice.closures.iter().filter(|c| c.largest_residual() > 1.0).cloned().collect();
        DropFinding::AllMissed { chi_square, degrees, closures }.into()
    })
}

/// Reports a check that fails.
pub(super) fn judge_missed(closure: &Consistency, drop: &Drop, events: &Events) -> Finding {
    let fall_s = events.release_s.zip(events.fall_end_s).map_or(0.0, |(release_s, end_s)| end_s - release_s);
    let is_gross = closure.miss_in_u.abs() > GROSS_U;
    let found =
        Finding::from(DropFinding::Missed { closure: closure.clone(), is_gross, drop: *drop, fall_s });
    Finding { channel: closure.channel.clone(), ..found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{IssueCode, Severity};

    fn choice(kind: CheckKind, miss_in_u: f64) -> MethodChoice {
        let closure = Consistency {
            name: "a closure".into(),
            kind,
            channel: (kind == CheckKind::Rest).then(|| "A1".into()),
            miss: "+30 mm".into(),
            miss_in_u,
            beside_others_in_u: 0.0,
        };
        MethodChoice {
            rung: Method::Joint,
            reason: String::new(),
            candidates: vec![],
            closures: vec![closure],
            chi_square: None,
            adjustments: vec![],
        }
    }

    fn judged(choice: &MethodChoice) -> Vec<Finding> {
        let drop = Drop { impact_velocity_m_s: 13.288, ..Drop::from_height(9.0, 0.2) };
        let events = Events { release_s: Some(0.5), fall_end_s: Some(1.0), ..Events::default() };
        judge_closures(choice, &drop, &events)
    }

    #[test]
    fn chance_is_not_mentioned_and_more_is_named_by_its_kind() {
        let severities =
            |kind| -> Vec<Severity> { judged(&choice(kind, -3.4)).iter().map(|i| i.severity).collect() };
        assert!(severities(CheckKind::Rest).is_empty());
        assert!(severities(CheckKind::Height).is_empty());
        for (kind, code) in [
            (CheckKind::Height, IssueCode::Geometry),
            (CheckKind::Turning, IssueCode::NotRigid),
            (CheckKind::Rest, IssueCode::Scale),
            (CheckKind::Fall, IssueCode::Geometry),
        ] {
            let findings = judged(&choice(kind, -4.0));
            assert_eq!((findings[0].code, findings[0].severity), (code, Severity::Warning));
            let said = &findings[0].message;
            assert_eq!(said.contains("+30 mm (4.0 standard uncertainties)"), kind != CheckKind::Fall);
            assert_eq!(said.contains("0.500 s, which is 1.23 m"), kind == CheckKind::Fall);
        }
        assert_eq!(judged(&choice(CheckKind::Rest, 4.0))[0].channel.as_deref(), Some("A1"));
    }

    #[test]
    fn steps_are_told_by_both_closures_where_neither_is_missed_and_the_interval_says_something() {
        let told = |misses: [f64; 2], u95: f64| {
            let [height, turning] = misses;
            let mut choice = choice(CheckKind::Height, height);
            choice.closures.extend(self::choice(CheckKind::Turning, turning).closures);
            let speed = Estimate::new(20.0, 0.2, "m/s");
            determines_lost_steps(&choice, (Estimate::new(0.5, u95, "1"), Some(speed)), &[], 0.1)
        };
        assert!(told([0.5, -1.5], 0.1));
        assert!(!told([0.5, -2.5], 0.1), "missed though a step is free to move");
        assert!(!told([0.5, -1.5], 0.3), "k may be anything");
        let alone = choice(CheckKind::Height, 0.5);
        let k = Estimate::new(0.5, 0.1, "1");
        assert!(!determines_lost_steps(&alone, (k, Some(Estimate::new(20.0, 0.2, "m/s"))), &[], 0.1));
    }

    #[test]
    fn a_gross_miss_takes_the_numbers_away() {
        assert_eq!(judged(&choice(CheckKind::Turning, 20.0))[0].severity, Severity::Error);
    }
}
