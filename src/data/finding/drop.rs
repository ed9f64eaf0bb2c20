//! Findings on the drop as a whole: code, severity, effect and sentence of each.

use super::{Finding, IssueCode as Code, Severity};
use crate::data::keys::quantity_words;
use crate::data::shown::digits;
use crate::data::{
    CheckKind, CoarseEvent, Comparison, Consistency, Drop, End, Estimate, ObservedBeside, StatedRemedy,
};

findings! {
/// A finding about the drop, its motion or its prediction.
pub enum DropFinding of Drop {
    /// No channel changes its velocity by this much, or one does so `without_rise`; `doubt` is the finding on
    /// a clock that may be the cause.
    NoImpact { least_m_s: f64, doubt: Option<Box<Finding>>, without_rise: Option<CoarseEvent> }
        => (Code::NoImpact, Error, Everything),
        ("no impact was found: {}; check source, unit and that the recording covers the drop{}",
         search_words(*least_m_s, *without_rise), rate_doubt(doubt.as_deref()));
    /// A channel's noise changes its velocity within 25 ms nearly as much as an impact does.
    Hidden { channel: String, noise_m_s: f64, least_m_s: f64 } => (Code::NoImpact, Error, Everything),
        ("no impact can be told from noise and hum: those of {channel} change its velocity by ± {:.1} m/s \
          within 25 ms, the first impact by {least_m_s:.1} m/s at the least: look for a loose cable or \
          earth, or use a sensor with a smaller range", 2.0 * noise_m_s);
    /// The rate gives so few samples in 25 ms that no impact can be found.
    TooSlow { rate_hz: f64, samples: f64, least_hz: f64 } => (Code::LowRate, Error, ChannelAndMotion),
        ("{rate_hz:.0} Hz put {samples:.1} samples into the 25 ms that a first impact lasts at the most: too \
         few to tell whether the recording shows one; record with {least_hz:.0} Hz and more, or check \
         `sample_rate_hz`");
    /// An end has no transverse channel; the mass properties may replace it.
    MissingEnd { end: End, is_stood_in_for: bool }
        => (Code::MissingChannel, Error, if !is_stood_in_for { ChannelAndMotion }
            else if *end == End::First { Channel } else { SecondEnd }),
        ("no transverse channel on the {end} end: {}", missing_end_words(*end, *is_stood_in_for));
    /// The cask drops onto an end face without the channels that show its rebound.
    NoAxial => (Code::MissingChannel, Error, Motion),
        ("a drop onto the end face shows its rebound and k on axial channels, and the cask file has none: \
         add one with `axis = \"axial\"`");
    /// The recording ends this long after the separation, before a slap-down.
    EndsEarly { after_s: f64 } => (Code::EndsEarly, Error, SlapDown),
        ("no slap-down within {:.0} ms after the first end left the target: the recording ends before it",
         1e3 * after_s);
    /// There is no slap-down for this long after the separation.
    NoSlapDown { after_s: f64 } => (Code::NoSlapDown, Error, SlapDown),
        ("no slap-down within {:.0} ms after the first end left the target: the second end shows no impact",
         1e3 * after_s);
    /// A calculated curve cannot be aligned with the measured one.
    NotRated { why: String } => (Code::Simulation, Note, Nothing), ("the calculation is not rated: {why}");
    /// The finding concerns the file with the calculation.
    InCalculation { file: String, found: String } => (Code::Simulation, Note, Nothing),
        ("in the calculation, {file}: {found}");
    /// The file is the recording of another recorder, whose times were shifted by this much.
    Joined { file: String, shift_s: f64, u_s: f64 } => (Code::Skew, Note, Nothing),
        ("{file} is of another recorder: {:+.3} ± {:.3} ms were added to its times, so that both recordings \
         show the first contact at one time; one trigger for both would determine the times better",
         1e3 * shift_s, 2e3 * u_s);
    /// The flight is too short to be fitted.
    ShortFlight => (Code::FlightFit, Error, Motion),
        ("the free flight between the impacts is too short to be separated from them and from ringing");
    /// R comes down before L's impact is over.
    Overlap { strikes_by_s: f64, lasts_s: f64 } => (Code::SecondContact, Error, Motion),
        ("by the stated angle the second end strikes within {:.1} ms of the first, whose impact lasts {:.1} \
         ms: contacts that overlap are not followed; check `angle_deg`", 1e3 * strikes_by_s, 1e3 * lasts_s);
    /// R strikes while L still moves down.
    StrikeTogether { apart_s: f64 } => (Code::SecondContact, Error, Motion),
        ("the second end strikes {:.1} ms after the first, which is still moving down by then: no flight \
          lies between the impacts, and neither k nor a slap-down speed can be told; check `angle_deg` if a \
          slap-down was meant", 1e3 * apart_s);
    /// The recording holds another drop, this long after the analysed one.
    SeveralDrops { at_s: f64, later_s: f64, step_m_s: f64, first_step_m_s: f64 }
        => (Code::SeveralDrops, Warning, Nothing),
        ("the first end is struck once more at {at_s:.2} s, {later_s:.1} s after the impact found, and \
         changes its velocity by {step_m_s:.1} m/s ({first_step_m_s:.1} m/s there): that is another drop. \
         The first one was analysed; for the other, cut the recording between them in a copy");
    /// The free fall ends well before the impact.
    SoftTouch { end_s: f64, contact_s: f64 } => (Code::Geometry, Warning, Contradiction),
        ("the free fall ends at {end_s:.3} s, {:.0} ms before the impact found at {contact_s:.3} s: \
         something soft (water, a guide, a cable) was touched first, and the impact velocity is not that of \
         a free fall", 1e3 * (contact_s - end_s));
    /// The coefficient of restitution is physically impossible.
    Restitution { k: Estimate } => (Code::RestitutionRange, Error, Motion),
        ("k = {:.2} ± {:.2} {}: a scale, a unit, a polarity or the drop height is wrong",
         k.value, k.u95,
         if k.u95 > 1.0 { "says nothing of a number between 0 and 1" } else { "lies outside 0 to 1" });
    /// k may be below 0 within its interval, or must move far to satisfy a consistency check.
    RestitutionDoubted { k: Estimate, strained: Option<Consistency> }
        => (Code::RestitutionRange, Warning, Nothing),
        ("k = {:.3} ± {:.3} {}", k.value, k.u95, k_doubt(strained.as_ref()));
    /// The second end rises.
    TurnsTheWrongWay => (Code::EndsExchanged, Error, Motion),
        ("the cask turns the wrong way (the second end rises): the ends are exchanged or a polarity is wrong \
         in the cask file");
    /// The second end rises, because L's corner lies behind the centre of gravity.
    TooSteep { angle_deg: f64, limit_deg: f64 } => (Code::NoSlapDown, Error, SlapDown),
        ("the second end is not expected to strike: at {angle_deg:.1}° the first end's corner lies {} (from \
         {limit_deg:.1}° on for this section), and the cask {}; analyse the first impact alone",
         if angle_deg < limit_deg { "little before the centre of gravity, not yet under it" }
         else { "under the centre of gravity or behind it" },
         if angle_deg < limit_deg { "hardly turns" } else { "turns back" });
    /// The axial channel shows that L slides on a contact that is stated as rough.
    Slides { slip: Estimate } => (Code::Friction, Warning, Nothing),
        ("the axial channel has the first end slide at {:+.1} ± {:.1} m/s as it leaves, the cask file calls \
         the contact rough: check the axial channel's polarity and cross-axis sensitivity, or set `friction`",
         slip.value, slip.u95);
    /// The sliding of L is hardly determined: the slap-down speed if it sticks and if it meets no friction,
    /// and the friction that was used.
    OpenContact { sticking_m_s: f64, sliding_m_s: f64, taken: Estimate } => (Code::Friction, Note, Nothing),
        ("little tells how the first end slides: the slap-down speed would be {sticking_m_s:.2} m/s if it \
         sticks and {sliding_m_s:.2} m/s without friction; the intervals cover what lies between ({:.2} ± \
         {:.2} was taken), and the horizontal velocity rests on it: record an axial channel, or state \
         `friction`", taken.value, taken.u95);
    /// The force of the first contact falls to this share of the lower of two maxima around it.
    TwoMaxima { dip: f64, k: f64 } => (Code::SecondContact, Note, Nothing),
        ("the force of the first impact falls to {:.0} % between two maxima: the first end touched twice, or \
         a mode rings as fast as the contact lasts; it was taken as one contact, and k is that of the whole \
         ({k:.2} by then)",
         100.0 * dip.max(0.0));
    /// L would sink this far below the height at which it left the target.
    Sinks { depth_m: f64 } => (Code::SecondContact, Warning, Motion),
        ("the first end would sink {:.0} mm below where it left the target before the second end strikes: it \
         touched again, and the flight was not free", 1e3 * depth_m);
    /// L returns to the target so softly that no channel shows it.
    Settles { depth_m: f64, effect_m_s: f64 } => (Code::SecondContact, Warning, Motion),
        ("the first end comes down to the target before the second end strikes ({:.0} mm below where it \
         left): by the prediction for this k that changes the slap-down speed by {effect_m_s:.2} m/s, and \
         the flight leaves it out", 1e3 * depth_m);
    /// L may land as R strikes.
    MayLand { above_m: f64, u_m: f64, effect_m_s: f64 } => (Code::SecondContact, Note, Nothing),
        ("the first end comes down again as the second end strikes: by the motion it is then {:.0} ± {:.0} \
         mm above where it left, and a landing before that changes the slap-down speed by up to \
         {effect_m_s:.2} m/s, which is in its interval", 1e3 * above_m, 2e3 * u_m);
    /// The velocities step in the flight.
    Blow { step_m_s: f64, after_s: f64 } => (Code::SecondContact, Warning, Motion),
        ("the velocities step by up to {:.2} m/s about {:.1} ms into the flight, which explains it better \
         than ringing does: contents that strike the cask, a cable or a second touch; k and the slap-down \
         speed are not determined", step_m_s, 1e3 * after_s);
    /// The velocities step in the flight by less than the half-width of the speed.
    SmallBlow { step_m_s: f64, after_s: f64 } => (Code::SecondContact, Warning, Nothing),
        ("the velocities step by up to {step_m_s:.2} m/s about {:.1} ms into the flight, which explains it better \
         than ringing does: contents that strike the cask, a cable or a second touch; the intervals of k and \
         the slap-down speed hold as much", 1e3 * after_s);
    /// A mode that is no bending.
    Swings { frequency_hz: f64, size_m_s: f64 } => (Code::Swings, Warning, Contradiction),
        ("an oscillation of {size_m_s:.2} m/s at {frequency_hz:.0} Hz is slower than the cask bends: \
         contents or mounts move in it, or a sensor sits elsewhere than stated; k and the slap-down speed \
         are not determined");
    /// L is still pressed when R strikes; an error, listed before its consequences.
    Pressed { frequency_hz: f64, periods: f64 } => (Code::SecondContact, Error, Motion),
        ("between first contact and the strike of the second end the velocities curve as in no free flight \
         ({frequency_hz:.0} Hz, seen for {periods:.1} of a period): the first end is probably still pressed \
         on the target as the second end strikes; contacts that overlap are not followed: take the speed \
         from film");
    /// The target pushes L through the flight.
    Carried { rate_hz: f64 } => (Code::SecondContact, Warning, Motion),
        ("in the flight every transverse channel goes on gaining what it gained in the first impact, \
         {rate_hz:.0} % of it in 10 ms: the target still pushes the first end, and the flight is not free");
    /// L touches again, and the motion follows the touch.
    Landed { before_s: f64 } => (Code::SecondContact, Note, SecondImpact),
        ("the first end touches again {:.1} ms before the second one strikes: what that changes of the \
         motion is read off all channels; the speed of the corner and the second impact, which ring with it, \
         are not determined", 1e3 * before_s);
    /// The flight may have had no duration; an error, listed before its consequences.
    NoFlight { flight_time: Estimate } => (Code::SecondContact, Error, Motion),
        ("the flight lasts {:.1} ± {:.1} ms: the first end may not have left the target when the second end \
         struck; contacts that overlap are not followed: take the speed from film",
         1e3 * flight_time.value, 1e3 * flight_time.u95);
    /// The flight is too short to separate its modes.
    Unresolved { flight_s: f64, modes_hz: Vec<f64> } => (Code::FlightFit, Warning, Motion),
        ("the {:.1} ms of flight are too short for the modes that were fitted to it ({} Hz): they may stand \
         for a contact that was not over, so k and the slap-down speed are not determined; look at the \
         curves, and state only what they show",
         1e3 * flight_s, join(modes_hz, |f| format!("{f:.0}"), ", "));
    /// No flight after the slap-down determines the result of the second impact.
    SecondUndetermined { recorded_s: f64, is_open: bool } => (Code::SecondImpact, Note, SecondImpact),
        ("the {:.0} ms that are recorded after the slap-down do not show the end of the second end's impact: \
         it may not have left the target by then, or something else strikes meanwhile; {}", 1e3 * recorded_s,
         if *is_open {
             "its force, deceleration, crush and energy are those up to the greatest crush"
         } else {
             "record until the cask lies still"
         });
    /// Measured and predicted lie apart.
    Disagreement { comparison: Comparison, e_n: f64, severity: Severity }
        => (Code::Disagreement, *severity, Nothing),
        ("measured {:.2} ± {:.2} m/s and predicted {:.2} ± {:.2} m/s lie apart beyond both intervals (E_n = \
         {e_n:.1}): check contact law, angle, mass properties and scales",
         comparison.measured, comparison.measured_u95, comparison.predicted, comparison.predicted_u95);
    /// An independent observation disagrees with the result.
    ObservedApart { beside: ObservedBeside, e_n: f64, severity: Severity }
        => (Code::Observed, *severity, Nothing),
        ("by this recording the {} is {}, but was observed{} as {}: they lie apart beyond both intervals \
         (E_n = {e_n:.1}); check the observation, and the cask file",
        quantity_words(beside.name),
        beside.result.as_ref().map_or_else(String::new, plus_minus),
        beside.by.as_ref().map_or_else(String::new, |by| format!(" by {by}")),
        plus_minus(&beside.observed));
    /// A consistency check fails by more than chance; the numbers are removed if that `is_gross`. The
    /// recording shows a free fall of `fall_s`.
    Missed { closure: Consistency, is_gross: bool, drop: Drop, fall_s: f64 }
        => (closure_code(closure.kind), if *is_gross { Error } else { Warning }, Contradiction),
        ("{}", miss_words(closure, drop, *fall_s));
    /// The rest before the fall and the duration of the fall both show that something removed this share of
    /// g, so the drop height gives another v0.
    SlowedFall { share: f64, u95: f64, v0_m_s: f64, severity: Severity }
        => (Code::Geometry, *severity, Contradiction),
        ("the fall was slower than free by {:.1} ± {:.1} % of g, by what every transverse channel shows of \
         the rest before it and by its length alike: a guide, a rope or a brake; from the stated height that \
         makes an impact velocity of {v0_m_s:.2} m/s, by which all numbers are off: state it as \
         `impact_velocity_m_s`, with its tolerance", 100.0 * share, 100.0 * u95);
    /// All consistency checks together fail by more than chance.
    AllMissed { chi_square: f64, degrees: usize, closures: Vec<Consistency> }
        => (Code::Geometry, Warning, Contradiction),
        ("what the motion must meet is missed by more than chance, all together (χ² = {chi_square:.1} for \
         {degrees}): {}; check angle, height, length, scales, positions and mass properties of the cask file",
         join(closures, |c| format!("{} by {} ({:.1} u)", c.name, c.miss, c.largest_residual()), ", "));
    /// With the correction of a likely mistake everything is consistent; or with either of two, and nothing
    /// decides between them.
    UsualMistake { remedies: Vec<StatedRemedy>, severity: Severity } => (Code::UsualSlip, *severity, Hint),
        ("{}: check this first; it has not been applied", join(remedies, remedy_words, "; "));
    /// With one of these numbers in place of the stated one everything is consistent.
    OneNumber { remedies: Vec<StatedRemedy>, severity: Severity } => (Code::Geometry, *severity, Hint),
        ("if all else is as stated, {}: check this first; it has not been applied", join(remedies, remedy_words, "; "));
    /// More than two causes explain it as well.
    SeveralCauses { remedies: Vec<StatedRemedy>, severity: Severity } => (Code::Geometry, *severity, Hint),
        ("several mistakes would explain it, each alone: {}: check these", join(remedies, StatedRemedy::keys, "; "));
}
}

fn closure_code(closure: CheckKind) -> Code {
    match closure {
        CheckKind::Turning => Code::NotRigid,
        CheckKind::Rest | CheckKind::RateGained => Code::Scale,
        _ => Code::Geometry,
    }
}

/// Formats "with `drop.height_m` in ft everything is consistent, at 20.49 ± 0.11 m/s and k = 0.56 ± 0.01".
fn remedy_words(remedy: &StatedRemedy) -> String {
    let (speed, k) = remedy.causes.first().map_or((None, None), |cause| (cause.speed, cause.k));
    format!("with {} everything is consistent, at {}", remedy.keys(), numbers(speed, k))
}

fn join<T>(all: &[T], words: impl Fn(&T) -> String, between: &str) -> String {
    all.iter().map(words).collect::<Vec<_>>().join(between)
}

fn k_doubt(strained: Option<&Consistency>) -> String {
    match strained {
        None => "lies below 0, which no impact gives: a channel of the first end reads too little, or the \
                 drop height is wrong"
            .into(),
        Some(Consistency { name, miss, .. }) => {
            format!(
                "is open, and moved far so that the {name} is met ({miss} without): check the channels \
                     of the first end"
            )
        }
    }
}

fn search_words(least_m_s: f64, without_rise: Option<CoarseEvent>) -> String {
    let Some(CoarseEvent { near_s, velocity_step_m_s, .. }) = without_rise else {
        return format!("no transverse channel changes its velocity by {least_m_s:.1} m/s within 25 ms");
    };
    let step_m_s = velocity_step_m_s.abs();
    let since = if near_s < 0.0 {
        "from its first sample on, as where a recording begins in the impact".into()
    } else {
        format!("at {near_s:.3} s")
    };
    format!(
        "the velocity changes by {step_m_s:.1} m/s within 25 ms {since}, but no rise of the force begins that"
    )
}

fn rate_doubt(doubt: Option<&Finding>) -> String {
    let Some(finding) = doubt else { return String::new() };
    let of_channel = finding.channel.as_ref().map(|channel| format!(" of {channel}")).unwrap_or_default();
    format!(
        "; the rate{of_channel} is in doubt (clock), and a rate too high makes every velocity too small by \
         as much: clear that up first"
    )
}

fn missing_end_words(end: End, is_stood_in_for: bool) -> &'static str {
    match (is_stood_in_for, end) {
        (true, End::First) => {
            "rotation, k and speed rest on the inertia and centre of gravity of the cask file, and first \
             contact is seen a bending wave late; record both ends"
        }
        (true, End::Second) => {
            "rotation and k rest on the inertia and centre of gravity of the cask file, and nothing shows \
             the slap-down; record both ends"
        }
        (false, _) => "rotation, k and slap-down need one on each end",
    }
}

/// "20.62 ± 0.40 m/s".
fn plus_minus(Estimate { value, u95, unit }: &Estimate) -> String {
    format!("{} ± {} {}", digits(*value, 4), digits(*u95, 2), unit.trim_matches('1')).trim_end().to_owned()
}

/// Formats "20.49 ± 0.11 m/s and k = 0.56 ± 0.01", with the available numbers.
pub(super) fn numbers(speed: Option<Estimate>, k: Option<Estimate>) -> String {
    let speed = speed.map(|v| format!("{:.2} ± {:.2} m/s", v.value, v.u95));
    let k = k.map(|k| format!("k = {:.2} ± {:.2}", k.value, k.u95));
    let numbers: Vec<String> = speed.into_iter().chain(k).collect();
    if numbers.is_empty() { "no number".into() } else { numbers.join(" and ") }
}

fn miss_words(closure: &Consistency, drop: &Drop, fall_s: f64) -> String {
    let how_far = format!("{} ({:.1} standard uncertainties)", closure.miss, closure.miss_in_u.abs());
    match closure.kind {
        CheckKind::Height => format!(
            "the second end would be {how_far} from the target when it strikes: drop angle, drop height, a \
             scale, the clock or a sensor position is not as stated"
        ),
        CheckKind::Touch => format!(
            "the first end would be {how_far} from the target when it touches it again: drop angle, drop \
             height, a scale, the clock or a sensor position is not as stated"
        ),
        CheckKind::Turning => format!(
            "the measured rotation differs by {how_far} from what the first impact would give a rigid body \
             of this section, centre of gravity and inertia: check `length_m`, `height_m`, `cog_m` and \
             `inertia_kg_m2` or state what is left out, and check each channel's scale and position"
        ),
        CheckKind::SecondTurning => format!(
            "the rotation that the second impact gives differs by {how_far} from what its impulse would give \
             a rigid body of this length and inertia: check `length_m`, scales and positions; or the second \
             end struck twice, or the first end stood on the target meanwhile"
        ),
        CheckKind::Rest => format!(
            "{} is off by {how_far} at rest before the release: check its sensitivity, unit and the angle",
            closure.channel.as_deref().unwrap_or("a channel")
        ),
        CheckKind::Fall => fall(drop, fall_s),
        CheckKind::RateBefore => format!(
            "{} has the cask turn by {how_far} more before the first contact than is stated: correct \
             `angular_velocity_deg_s` under `[drop]`, or leave it out",
            closure.channel.as_deref().unwrap_or("a channel")
        ),
        CheckKind::RateGained => format!(
            "{} differs by {how_far} from the rotation that the accelerometers have the first impact give: \
             check the scale of each, and their positions",
            closure.channel.as_deref().unwrap_or("a channel")
        ),
    }
}

/// Compares the free fall of the recording with that of the cask file.
fn fall(drop: &Drop, fall_s: f64) -> String {
    let (height_m, velocity_m_s) = (0.5 * drop.gravity_m_s2 * fall_s * fall_s, drop.gravity_m_s2 * fall_s);
    let expected_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
    let stated = if drop.impact_velocity_given {
        format!("the impact velocity of {:.2} m/s", drop.impact_velocity_m_s)
    } else {
        format!("the drop height of {} m", drop.height_m)
    };
    let off = fall_s / expected_s - 1.0;
    let which = if off < 0.0 { "slow" } else { "fast" };
    format!(
        "the recording shows a free fall of {fall_s:.3} s, which is {height_m:.2} m and {velocity_m_s:.2} \
         m/s; {stated} in the cask file needs {expected_s:.3} s: check it; if it is right the recorder's \
         clock is {:.1} % {which}: state its true rate as `sample_rate_hz`",
        100.0 * off.abs()
    )
}
