//! A flight to what may be stated of the impacts: the quantities, unless something speaks against them, and
//! their prediction.

use super::flight::FlightResult;
use super::impact::Impact;
use super::impacts::Tabulated;
use crate::data::{
    BodyModel, CaskFile, Comparison, DropFinding, Effect, Events, Finding, FlightFit, GRAZE_SHARE, IssueCode,
    ModelChoice, ResultPart, Severity,
};
use crate::motion::{self, Integrated};
use crate::{compare, judge, predict};

/// L falls on with more than this share of v0: what is left of it is a stage of one contact.
const FALLS_ON: f64 = 0.1;

/// What is measured beside what is predicted.
pub(super) struct Measured {
    /// The simplest model that explains it; `None` where there is no slap-down to compare.
    pub model: Option<ModelChoice>,
    /// Measured beside predicted.
    pub comparison: Option<Comparison>,
}

impl Measured {
    /// Judges the flight; `None` where a finding takes the motion away.
    pub fn of(
        flown: &FlightResult,
        impact: &Impact,
        events: &Events,
        file: &CaskFile,
        findings: &mut Vec<Finding>,
    ) -> Option<Self> {
        let FlightResult { flight, reconstruction, quantities, .. } = flown;
        findings.extend(judge::judge_coupling(&impact.signals, flight, file));
        findings.extend(judge::judge_rigid(
            judge::places(&impact.signals),
            flight,
            &file.tolerances,
            &file.drop,
            events,
        ));
        let known = (quantities.k, quantities.speed);
        let contact_s = impact.contact.time_s;
        let is_told = judge::tells_lost_steps(reconstruction, known, impact.recorded(), contact_s);
        let is_step = |f: &Finding| is_told && f.effect == Effect::VelocityStep;
        let takes_motion = |f: &Finding| f.removes(ResultPart::Motion) && !is_step(f);
        if !findings.iter().any(|f| f.severity == Severity::Error && takes_motion(f)) {
            let of_motion = of_motion(flown, impact, events, file);
            findings.extend(judge::judge_pressed(flight, &of_motion));
            findings.extend(of_motion);
            let landed = flight.landing.as_ref().zip(events.slap_down_s());
            findings.extend(landed.map(|(landing, struck_s)| {
                Finding::from(DropFinding::Landed { before_s: struck_s - landing.begin_s })
                    .span(landing.begin_s, landing.begin_s)
            }));
            // One blow is told once.
            if findings.iter().all(|f| f.code != IssueCode::SecondContact || f.effect == Effect::Nothing) {
                let blows = judge::judge_blows(impact.recorded(), flight, events, findings, &file.cask);
                findings.extend(blows.filter(|blows| change_the_motion(blows, flight, impact, events, file)));
            }
        }
        // Of 741 simulated drops with a warning that takes the motion the intervals held 74 %, of 410 with
        // other warnings 91 %. A motion that is contradicted determines no velocity step either.
        if findings.iter().any(takes_motion) {
            return None;
        }
        findings.iter_mut().filter(|f| is_step(f)).for_each(|f| f.effect = Effect::Channel);
        judge::note_what_is_held(findings, quantities.k, quantities.speed);
        let compared = compare::compare(&predict::bodies(&file.cask), file, quantities, &predict::predict_by);
        let (model, comparison) = compared.unzip();
        let comparison = comparison.flatten();
        findings.extend(comparison.as_ref().and_then(judge::judge_comparison));
        let tabulated = flown.tabulated.as_ref();
        let untold = tabulated.and_then(|t| t.untold(impact.recorded(), events));
        findings.extend(untold.filter(|_| flight.landing.is_none()));
        findings.extend(tabulated.and_then(Tabulated::two_maxima));
        Some(Self { model, comparison })
    }
}

/// What the motion itself and its closures say.
fn of_motion(flown: &FlightResult, impact: &Impact, events: &Events, file: &CaskFile) -> Vec<Finding> {
    let FlightResult { flight, motion, quantities, reconstruction, .. } = flown;
    let mut found = judge::judge_motion(file, &impact.signals, flight, motion, quantities);
    // An end whose channel was made of the other's does not show where it goes.
    found.retain(|f| impact.stand_in.is_none() || f.code != IssueCode::Swings);
    found.extend(judge::judge_unresolved(flight, flown.tabulated.as_ref().and_then(Tabulated::two_maxima)));
    let left_s = events.separation_s().unwrap_or(flight.from_s);
    found.extend(judge::judge_separation(flight, left_s));
    let step = judge::judge_late_blow(flight, file.drop.impact_velocity_m_s, quantities.speed);
    let is_sharp = |at_s| judge::is_sharp(impact.recorded(), flight, events, &file.cask, at_s);
    found.extend(step.filter(|step| step.removes(ResultPart::Motion) || step.from_s.is_none_or(is_sharp)));
    // A limiter that yields in stages lets L fall on between them: what leaves the target goes up.
    let falls_on = |rest: &Finding| {
        let at = motion.curve.time_s.partition_point(|&t| Some(t) < rest.from_s);
        let up_m_s = motion.curve.first_end_vertical_m_s.get(at);
        up_m_s.is_some_and(|up_m_s| *up_m_s < -FALLS_ON * file.drop.impact_velocity_m_s)
    };
    found.extend(judge::judge_rest(impact.recorded(), events).filter(|rest| !falls_on(rest)));
    found.extend(judge::judge_strained(reconstruction, quantities.k));
    let missed = judge::judge_closures(reconstruction, &file.drop, events);
    found.extend(judge::judge_slowed(missed, &file.drop, &impact.rests, events, &file.tolerances));
    let touched_m_s = touch_effect_m_s(file, quantities.k.value);
    let is_followed = flight.landing.is_some();
    let left_out = || judge::judge_touch(motion, quantities, touched_m_s, &file.cask);
    found.extend((!is_followed).then(left_out).flatten());
    found
}

/// Whether shocks in the flight change the motion where the first or the last of them is, or too little of
/// the flight is there to tell: modes that a prediction has no room for look like shocks and change nothing.
fn change_the_motion(
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
        .any(|at_s| step_m_s(at_s).is_none_or(|by| judge::moves_the_cask(by, drop.impact_velocity_m_s)))
}

/// What touches of L that are too shallow to count as impacts change of the predicted slap-down speed, m/s.
fn touch_effect_m_s(file: &CaskFile, k: f64) -> f64 {
    let body = predict::body(&file.cask, BodyModel::Body);
    let speed_m_s = |graze_share: f64| {
        let k = k.clamp(0.0, 1.0);
        predict::predict_grazing(&body, &file.drop, file.contact, k, graze_share).slap_down_speed_m_s
    };
    speed_m_s(GRAZE_SHARE).zip(speed_m_s(0.0)).map_or(0.0, |(grazed, struck)| (grazed - struck).abs())
}
