//! Judges a flight, and compares its quantities with their prediction unless something contradicts them.

use super::flight::FlightResult;
use super::impact::Impact;
use super::impacts::ImpactTables;
use crate::data::{
    BodyModel, CaskFile, Comparison, DropFinding, Effect, Events, Finding, FlightFit, GRAZE_SHARE, IssueCode,
    ModelChoice, ResultPart, Severity,
};
use crate::motion::{self, Integrated};
use crate::{compare, judge, predict};

/// L still falls if its velocity down exceeds this share of v0: a rest of the force is then a stage of one
/// contact.
const FALLING_SHARE: f64 = 0.1;

/// Quantities of a flight that may be stated, beside their prediction.
pub(super) struct JudgedFlight {
    /// The simplest model that explains them; `None` without a slap-down to compare.
    pub model: Option<ModelChoice>,
    /// Measurement and prediction.
    pub comparison: Option<Comparison>,
}

impl JudgedFlight {
    /// Judges the flight; `None` if a finding removes the motion.
    pub fn judge(
        solution: &FlightResult,
        impact: &Impact,
        events: &Events,
        file: &CaskFile,
        findings: &mut Vec<Finding>,
    ) -> Option<Self> {
        let FlightResult { flight, method, .. } = solution;
        let (reconstruction, quantities) = (&method.choice, &method.quantities);
        findings.extend(judge::judge_coupling(&impact.signals, flight, file));
        findings.extend(judge::judge_rigid(
            judge::transverse_places(&impact.signals),
            flight,
            &file.tolerances,
            &file.drop,
            events,
        ));
        let known = (quantities.k, quantities.speed);
        let contact_s = impact.contact.time_s;
        let is_determined = judge::determines_lost_steps(reconstruction, known, impact.recorded(), contact_s);
        let is_step = |f: &Finding| is_determined && f.effect == Effect::VelocityStep;
        let takes_motion = |f: &Finding| f.removes(ResultPart::Motion) && !is_step(f);
        if !findings.iter().any(|f| f.severity == Severity::Error && takes_motion(f)) {
            let motion_findings = judge_motion(solution, impact, events, file);
            findings.extend(judge::judge_pressed(flight, &motion_findings));
            findings.extend(motion_findings);
            let landing = flight.landing.as_ref().zip(events.slap_down_s());
            findings.extend(landing.map(|(landing, struck_s)| {
                Finding::from(DropFinding::Landed { before_s: struck_s - landing.begin_s })
                    .span(landing.begin_s, landing.begin_s)
            }));
            // Each blow is reported once.
            if findings.iter().all(|f| f.code != IssueCode::SecondContact || f.effect == Effect::Nothing) {
                let blows = judge::judge_blows(impact.recorded(), flight, events, findings, &file.cask);
                findings.extend(blows.filter(|blows| change_motion(blows, flight, impact, events, file)));
            }
        }
        // In 741 simulated drops with a warning that removes the motion the intervals contained 74 %, in 410
        // with other warnings 91 %. A motion that is contradicted determines no velocity step either.
        if findings.iter().any(takes_motion) {
            return None;
        }
        findings.iter_mut().filter(|f| is_step(f)).for_each(|f| f.effect = Effect::Channel);
        judge::downgrade_harmless(findings, quantities.k, quantities.speed);
        let compared = compare::compare(&predict::bodies(&file.cask), file, quantities, &predict::predict_by);
        let (model, comparison) = compared.unzip();
        let comparison = comparison.flatten();
        findings.extend(comparison.as_ref().and_then(judge::judge_comparison));
        let tables = solution.tables.as_ref();
        let open = tables.and_then(|t| t.judge_undetermined(impact.recorded(), events));
        findings.extend(open.filter(|_| flight.landing.is_none()));
        findings.extend(tables.and_then(ImpactTables::judge_two_maxima));
        Some(Self { model, comparison })
    }
}

/// Judges the motion and its consistency checks.
fn judge_motion(solution: &FlightResult, impact: &Impact, events: &Events, file: &CaskFile) -> Vec<Finding> {
    let FlightResult { flight, motion, method, .. } = solution;
    let (reconstruction, quantities) = (&method.choice, &method.quantities);
    let mut found = judge::judge_motion(file, &impact.signals, flight, motion, quantities);
    // A channel that was reconstructed from the other end does not show where its end moves.
    found.retain(|f| !impact.is_one_ended() || f.code != IssueCode::Swings);
    let two_maxima = solution.tables.as_ref().and_then(ImpactTables::judge_two_maxima);
    found.extend(judge::judge_unresolved(flight, two_maxima));
    let left_s = events.separation_s().unwrap_or(flight.from_s);
    found.extend(judge::judge_separation(flight, left_s));
    let step = judge::judge_late_blow(flight, file.drop.impact_velocity_m_s, quantities.speed);
    let is_sharp = |at_s| judge::is_sharp(impact.recorded(), flight, events, &file.cask, at_s);
    found.extend(step.filter(|step| step.removes(ResultPart::Motion) || step.from_s.is_none_or(is_sharp)));
    // A limiter that yields in stages lets L fall between them; an end that leaves the target rises.
    let is_falling = |rest: &Finding| {
        let at = motion.curve.time_s.partition_point(|&t| Some(t) < rest.from_s);
        let up_m_s = motion.curve.first_end_vertical_m_s.get(at);
        up_m_s.is_some_and(|up_m_s| *up_m_s < -FALLING_SHARE * file.drop.impact_velocity_m_s)
    };
    found.extend(judge::judge_force_pause(impact.recorded(), events).filter(|rest| !is_falling(rest)));
    found.extend(judge::judge_strained(reconstruction, quantities.k));
    let missed = judge::judge_closures(reconstruction, &file.drop, events);
    found.extend(judge::judge_slowed(missed, &file.drop, &impact.rests, events, &file.tolerances));
    let touched_m_s = touch_effect_m_s(file, quantities.k.value);
    let is_followed = flight.landing.is_some();
    let judge_touch = || judge::judge_touch(motion, quantities, touched_m_s, &file.cask);
    found.extend((!is_followed).then(judge_touch).flatten());
    found
}

/// True if shocks in the flight change the motion at the first or the last of them, or if too little of the
/// flight is recorded to decide: modes that a prediction cannot include look like shocks and change nothing.
fn change_motion(
    shocks: &Finding,
    flight: &FlightFit,
    impact: &Impact,
    events: &Events,
    file: &CaskFile,
) -> bool {
    let (signals, drop) = (&impact.signals, &file.drop);
    let contact_s = impact.contact.time_s;
    let events_s = [contact_s, events.separation_s().unwrap_or(contact_s)];
    let window = motion::Window {
        from_s: flight.from_s,
        to_s: events.slap_down_s().map_or(flight.to_s, |struck_s| struck_s - motion::BEFORE_SLAP_DOWN_S),
        drift: flight.drift,
        angular_velocity_rad_s: motion::spin_rad_s(signals, flight, drop.angular_velocity_rad_s, events_s),
    };
    let integrated = Integrated::new(signals, contact_s);
    let step_m_s = |at_s| motion::step_m_s(flight, &integrated, &window, file.cask.cog_m, at_s);
    [shocks.from_s, shocks.to_s]
        .into_iter()
        .flatten()
        .any(|at_s| step_m_s(at_s).is_none_or(|by| judge::changes_motion(by, drop.impact_velocity_m_s)))
}

/// Change of the predicted slap-down speed by touches of L that are too shallow to count as impacts, m/s.
fn touch_effect_m_s(file: &CaskFile, k: f64) -> f64 {
    let body = predict::body(&file.cask, BodyModel::Body);
    let speed_m_s = |graze_share: f64| {
        let k = k.clamp(0.0, 1.0);
        predict::predict_grazing(&body, &file.drop, file.contact, k, graze_share).slap_down_speed_m_s
    };
    speed_m_s(GRAZE_SHARE).zip(speed_m_s(0.0)).map_or(0.0, |(grazed, struck)| (grazed - struck).abs())
}
