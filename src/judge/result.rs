//! A reconstructed motion to what speaks against it.

use crate::data::{
    Axis, CaskFile, Comparison, Contact, End, FlightFit, GRAZE_SHARE, Issue, IssueCode, Motion, Quantities,
    Severity, Signal,
};

/// k this far outside 0 to 1 is an error whatever its interval.
const FAR_OUTSIDE: f64 = 0.25;
/// Zero shifts whose effect on the velocity over the contact is below this are a note, m/s: 0.5 % of a slap-down.
const SMALL_SHIFT_M_S: f64 = 0.1;
/// The same in a flight that does not show a period of each mode, where a drift is a part of the mode as well as of the sensor, m/s.
const SMALL_BEND_M_S: f64 = 0.5;
/// Velocity gained late in a flight beyond this share of v0 is another contact.
const LATE_SHARE: f64 = 0.03;
/// Sliding below this is sticking, m/s: 5 % cross-axis sensitivity of a 13 m/s step.
const SMALL_SLIP_M_S: f64 = 0.65;
/// L this share of the length below where it left is on the target again: 5 mm, what corner and target are even to.
const TOUCHED_SHARE: f64 = 0.001;
/// A flight fit that leaves more than this RMS has not explained the channel, m/s: 1.5 % of a slap-down.
const LARGE_RESIDUAL_M_S: f64 = 0.3;
/// The same as a share of v0 in a flight too short to tell its modes apart, which three of them may fit with a part of the contact in it.
const LARGE_RESIDUAL_SHORT: f64 = 0.015;
/// A velocity this far off its flight before R strikes is another contact, m/s: 1 % of a slap-down.
const LARGE_MISMATCH_M_S: f64 = 0.2;
/// A velocity step that is known no better than to this share of v0, as a standard uncertainty, says little, however well it is known how little.
const LARGE_U_SHARE: f64 = 0.1;

/// Checks the motion against what a dropped cask can do.
#[must_use]
pub fn judge_motion(
    cask_file: &CaskFile,
    signals: &[Signal],
    flight: &FlightFit,
    motion: &Motion,
    quantities: &Quantities,
) -> Vec<Issue> {
    let mut issues = Vec::new();
    issues.extend(signs(signals, flight));
    issues.extend(flight_issues(flight, quantities));
    let k = quantities.k;
    let beyond = k.value + k.u95 < 0.0 || k.value - k.u95 > 1.0;
    if beyond || !(-FAR_OUTSIDE..=1.0 + FAR_OUTSIDE).contains(&k.value) || k.u95 > 1.0 {
        issues.push(Issue::new(
            IssueCode::RestitutionRange,
            Severity::Error,
            format!(
                "k = {:.2} ± {:.2} {}: a scale, a unit, a polarity or the drop height is wrong",
                k.value,
                k.u95,
                if k.u95 > 1.0 { "says nothing of a number between 0 and 1" } else { "lies outside 0 to 1" }
            ),
        ));
    }
    if quantities.angular_velocity.value <= 0.0 {
        issues.push(Issue::new(
            IssueCode::EndsExchanged,
            Severity::Error,
            "the cask turns the wrong way (the second end rises): the ends are exchanged or a polarity is wrong in the cask file",
        ));
    }
    let slip = quantities.slip_velocity;
    let is_measured = signals.iter().any(|s| s.axis == Axis::Axial);
    if is_measured
        && cask_file.contact == Contact::Rough
        && slip.value.abs() > 2.0 * slip.u95 + SMALL_SLIP_M_S
    {
        issues.push(Issue::new(
            IssueCode::Friction,
            Severity::Warning,
            format!(
                "the axial channel has the first end slide at {:+.1} ± {:.1} m/s as it leaves, the cask file calls the contact rough: check the axial channel's polarity and cross-axis sensitivity, or set `friction`",
                slip.value, slip.u95
            ),
        ));
    }
    // What rebound and angle may be off lets L sink by as much more.
    let flown_s = quantities.flight_time.map_or(0.0, |t| t.value);
    let turned_rad = quantities.angle.map_or(0.0, |a| a.u95.to_radians());
    let open_m = quantities.rebound_velocity.u95 * flown_s + turned_rad * cask_file.cask.cog_m;
    if motion.lowest_first_end_m < -GRAZE_SHARE * cask_file.cask.length_m - open_m {
        issues.push(Issue::new(
            IssueCode::SecondContact,
            Severity::Warning,
            format!(
                "the first end would sink {:.0} mm below where it left the target before the second end strikes: it touched again, and the flight was not free",
                -1e3 * motion.lowest_first_end_m
            ),
        ));
    }
    issues
}

/// Touches of L that the flight leaves out: `effect_m_s` is what they change of the slap-down speed by the prediction with the measured k.
///
/// A touch so slow that it shows in no channel still carries the cask: L rests on the target, or lands as R strikes.
#[must_use]
pub fn judge_touch(
    motion: &Motion,
    quantities: &Quantities,
    effect_m_s: f64,
    length_m: f64,
) -> Option<Issue> {
    let interval_m_s = quantities.speed?.u95;
    (motion.lowest_first_end_m < -TOUCHED_SHARE * length_m && effect_m_s > interval_m_s).then(|| {
        Issue::new(
            IssueCode::SecondContact,
            Severity::Warning,
            format!(
                "the first end comes down to the target before the second end strikes ({:.0} mm below where it left): by the prediction for this k that changes the slap-down speed by {effect_m_s:.2} m/s, and the flight leaves it out",
                -1e3 * motion.lowest_first_end_m
            ),
        )
    })
}

/// Each end's own impact pushes it away from the target.
fn signs(signals: &[Signal], flight: &FlightFit) -> Vec<Issue> {
    signals
        .iter()
        .filter(|s| s.end == End::First && s.axis == Axis::Transverse)
        .filter(|s| flight.plateau(&s.name).is_some_and(|p| p.velocity_step_m_s < 0.0))
        .map(|s| {
            Issue::new(
                IssueCode::Polarity,
                Severity::Error,
                format!("{} reads the first impact as pulling towards the target: set `polarity = -1` for it, or its end is the other one", s.name),
            )
            .on(&s.name)
        })
        .collect()
}

fn flight_issues(flight: &FlightFit, quantities: &Quantities) -> Vec<Issue> {
    let v0_m_s = quantities.impact_velocity.value;
    let mut issues = Vec::new();
    issues.extend(unresolved(flight));
    if let Some(flown) = quantities.flight_time
        && flown.value < flown.u95
    {
        issues.push(Issue::new(
            IssueCode::FlightFit,
            Severity::Warning,
            format!(
                "the flight lasts {:.1} ± {:.1} ms: the first end may not have left the target when the second end struck, and k and the slap-down speed then mean nothing",
                1e3 * flown.value,
                1e3 * flown.u95
            ),
        ));
    }
    for plateau in &flight.plateaus {
        let effect_m_s = plateau.zero_shift_m_s2.abs() * quantities.duration.value;
        if flight.drift && plateau.zero_shift_m_s2.abs() > 3.0 * plateau.u_zero_shift_m_s2 {
            let small_m_s = if flight.periods() > 1.0 { SMALL_SHIFT_M_S } else { SMALL_BEND_M_S };
            let severity = if effect_m_s > small_m_s { Severity::Warning } else { Severity::Note };
            issues.push(
                Issue::new(
                    IssueCode::ZeroShift,
                    severity,
                    format!(
                        "{} reads {:+.2} ± {:.2} g more in the flight than before the impact (zero shift or droop); it was taken off, which moves the velocity by up to {effect_m_s:.2} m/s",
                        plateau.channel,
                        plateau.zero_shift_m_s2 / 9.806_65,
                        2.0 * plateau.u_zero_shift_m_s2 / 9.806_65
                    ),
                )
                .on(&plateau.channel)
                .between(flight.from_s, flight.to_s),
            );
        }
        if let Some(mismatch_m_s) = plateau.late_mismatch_m_s
            && mismatch_m_s.abs() > LARGE_MISMATCH_M_S.min(LATE_SHARE * quantities.impact_velocity.value)
        {
            issues.push(
                Issue::new(
                    IssueCode::SecondContact,
                    Severity::Warning,
                    format!(
                        "{} is {mismatch_m_s:+.2} m/s off its flight by the time the second end strikes: the first end touched again, or the sensor drifts",
                        plateau.channel
                    ),
                )
                .on(&plateau.channel),
            );
        }
        let short_m_s = if flight.is_told_apart() { f64::INFINITY } else { LARGE_RESIDUAL_SHORT * v0_m_s };
        if plateau.residual_m_s > LARGE_RESIDUAL_M_S.min(short_m_s) || plateau.u_m_s > LARGE_U_SHARE * v0_m_s
        {
            issues.push(
                Issue::new(
                    IssueCode::FlightFit,
                    Severity::Warning,
                    format!(
                        "the flight of {} is not explained by a plateau and {} modes: {:.2} m/s are left, and its velocity step is known to ± {:.2} m/s",
                        plateau.channel,
                        flight.modes.len(),
                        plateau.residual_m_s,
                        2.0 * plateau.u_m_s
                    ),
                )
                .on(&plateau.channel)
                .between(flight.from_s, flight.to_s),
            );
        }
    }
    issues
}

/// Modes that the flight is too short to tell from one another.
fn unresolved(flight: &FlightFit) -> Option<Issue> {
    let modes: Vec<String> = flight.modes.iter().map(|m| format!("{:.0}", m.frequency_hz)).collect();
    (!flight.resolves_modes()).then(|| {
        Issue::new(
            IssueCode::FlightFit,
            Severity::Warning,
            format!(
                "the {:.1} ms of flight are too short to tell the {} modes from one another that were fitted to it ({} Hz): they may stand for a contact that was not over, and the velocity steps, k and the slap-down speed be off by more than their intervals; look at the curves, and state only what they show",
                1e3 * (flight.to_s - flight.from_s),
                modes.len(),
                modes.join(", ")
            ),
        )
        .between(flight.from_s, flight.to_s)
    })
}

/// What a comparison that does not agree amounts to.
#[must_use]
pub fn judge_comparison(comparison: &Comparison) -> Option<Issue> {
    (!comparison.agrees).then(|| {
        Issue::new(
            IssueCode::Disagreement,
            Severity::Warning,
            format!(
                "measured {:.2} ± {:.2} m/s and predicted {:.2} ± {:.2} m/s lie apart beyond both intervals: check contact law, angle, mass properties and scales",
                comparison.measured, comparison.measured_u95, comparison.predicted, comparison.predicted_u95
            ),
        )
    })
}
