//! What the motion must meet and misses, to what speaks against scales, positions, angle and height.

use crate::data::{Closure, ClosureKind, Issue, IssueCode, ReconstructionChoice, Severity};

/// A closure missed by this many standard uncertainties is not chance: one sound drop in 370 a closure.
const MISSED_U: f64 = 3.0;
/// Missed by this many, the stated things are not what the recording shows.
const GROSS_U: f64 = 12.0;

/// One issue a closure that is missed by more than noise and tolerances explain.
#[must_use]
pub fn judge_closures(choice: &ReconstructionChoice) -> Vec<Issue> {
    choice.closures.iter().filter(|c| c.miss_in_u.abs() > MISSED_U).map(issue).collect()
}

fn issue(closure: &Closure) -> Issue {
    let gross = closure.miss_in_u.abs() > GROSS_U;
    let severity = if gross { Severity::Error } else { Severity::Warning };
    let how_far = format!("{} ({:.1} standard uncertainties)", closure.miss, closure.miss_in_u.abs());
    let (code, message) = match closure.kind {
        ClosureKind::Height => (
            IssueCode::Geometry,
            format!(
                "the second end would be {how_far} from the target when it strikes: drop angle, drop height, a scale, the clock or a sensor position is not as stated"
            ),
        ),
        ClosureKind::Turning => (
            IssueCode::NotRigid,
            format!(
                "the cask turns by {how_far} otherwise than the first impact turns a rigid body of this section, centre of gravity and inertia: check each channel's scale and position, and state `inertia_kg_m2` and `cog_m`"
            ),
        ),
        ClosureKind::Rest => (
            IssueCode::Scale,
            format!(
                "{} is off by {how_far} at rest before the release: check its sensitivity, unit and the angle",
                closure.channel.as_deref().unwrap_or("a channel")
            ),
        ),
        ClosureKind::Fall => (
            IssueCode::Geometry,
            format!(
                "the free fall in the recording is off by {how_far} from the stated impact velocity: check the drop height and the recording's sample rate"
            ),
        ),
    };
    let issue = Issue::new(code, severity, message);
    match &closure.channel {
        Some(channel) => issue.on(channel),
        None => issue,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::ReconstructionRung;

    fn choice(kind: ClosureKind, miss_in_u: f64) -> ReconstructionChoice {
        let closure = Closure {
            name: "a closure".into(),
            kind,
            channel: (kind == ClosureKind::Rest).then(|| "A1".into()),
            miss: "+30 mm".into(),
            miss_in_u,
            left_in_u: 0.0,
        };
        ReconstructionChoice {
            rung: ReconstructionRung::Joint,
            reason: String::new(),
            candidates: vec![],
            closures: vec![closure],
            chi_square: None,
            adjustments: vec![],
        }
    }

    #[test]
    fn chance_is_not_mentioned_and_more_is_named_by_its_kind() {
        assert!(judge_closures(&choice(ClosureKind::Height, -2.9)).is_empty());
        for (kind, code) in [
            (ClosureKind::Height, IssueCode::Geometry),
            (ClosureKind::Turning, IssueCode::NotRigid),
            (ClosureKind::Rest, IssueCode::Scale),
            (ClosureKind::Fall, IssueCode::Geometry),
        ] {
            let issues = judge_closures(&choice(kind, -4.0));
            assert_eq!((issues[0].code, issues[0].severity), (code, Severity::Warning));
            assert!(issues[0].message.contains("+30 mm (4.0 standard uncertainties)"));
        }
        assert_eq!(judge_closures(&choice(ClosureKind::Rest, 4.0))[0].channel.as_deref(), Some("A1"));
    }

    #[test]
    fn a_gross_miss_takes_the_numbers_away() {
        assert_eq!(judge_closures(&choice(ClosureKind::Turning, 20.0))[0].severity, Severity::Error);
    }
}
