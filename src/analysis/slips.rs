//! An analysis that something speaks against to the usual slip in the cask file, or the angle, with which
//! everything closes.

use super::analyzed;
use super::flight_search::Patience;
use super::second_look::{CLEARLY, Doubt, closes, is_too_large};
use crate::data::{
    Analysis, Axis, CaskFile, Channel, ChannelFinding, ClosureKind, Cure, DropFinding, DropResult, Finding,
    FindingKind, FlightFit, IssueCode, MISSED_U, Recording, RecordingFormat, ResultPart,
    STANDARD_GRAVITY_M_S2 as G, Samples, Severity, Slip,
};
use crate::judge;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

/// k of a cure: no crushed end rebounds otherwise, and two slips of which one is put right often come to
/// another.
const LIKELY_K: RangeInclusive<f64> = 0.02..=0.98;
/// 95 % half-widths that a cure has at the most, of k and of the speed as a share: sound drops have 0.067 and
/// all but one 0.05 (docs/validation.md), two slips of which one is put right up to 0.3 and more.
const MOST_U95_K: f64 = 0.08;
const MOST_U95_SPEED: f64 = 0.06;
/// Units of length that a number in metres may be in.
const LENGTHS_M: [(&str, f64); 3] = [("in cm", 0.01), ("in mm", 1e-3), ("in ft", 0.3048)];
/// The least drop height and length of a cask that a unit of length is tried for, m.
const LEAST_M: f64 = 0.1;
/// More velocity than a cask can lose in its impacts, in v0: what is cut off beyond it was never there, and
/// the unit is wrong.
const MOST_LOST: f64 = 3.0;
/// The first step of the search for an angle, rad, how many there are, and when its closure is met, in u.
const STEP_RAD: f64 = 0.01;
const STEPS: usize = 4;
const MET: f64 = 0.3;

/// Adds the usual slip with which everything closes, where an error stands, or else the angle with which it
/// does.
pub(super) fn name_slip(recording: &Recording, file: &CaskFile, found: &mut Analysis) {
    let doubt = severity_of_doubt(&found.result.quality, file.drop.impact_velocity_m_s);
    let Some(severity) = doubt.filter(|_| !is_too_large(recording)) else { return };
    let steps = of_steps(recording, &found.result);
    let may_cure = |slips: &Vec<Slip>| steps.as_ref().is_none_or(|steps| is_rigid(slips, steps, file));
    let cured = |slips: Vec<Slip>| {
        let (mut other, mut stated) = (recording.clone(), file.clone());
        for slip in &slips {
            put_right(slip, &mut other, &mut stated);
        }
        let analysis = analyzed(&other, &stated, Patience::OneBeginning);
        let (speed, k) = (analysis.result.slap_down.speed, analysis.result.k);
        is_cured(&analysis).then(|| (Doubt::of(&analysis), Cure { slips, speed, k }))
    };
    // Where all closes without one channel, nothing else is wrong.
    let left_out = found.result.quality.iter().find(|f| is_left_out(f)).and_then(|f| f.channel.as_ref());
    let is_of_it =
        |slips: &Vec<Slip>| left_out.is_none_or(|name| slips.iter().any(|slip| slip.names.contains(name)));
    let may_be = hypotheses(recording, file).into_par_iter().filter(is_of_it).filter(may_cure);
    let tried: Vec<(Doubt, Cure)> = may_be.filter_map(cured).collect();
    let clearly = |doubt: &Doubt| Doubt { chi_square: doubt.chi_square + CLEARLY, ..*doubt };
    let least = tried.iter().map(|(doubt, _)| clearly(doubt)).reduce(|a, b| if b < a { b } else { a });
    let as_good = tried.into_iter().filter(|(doubt, _)| least.is_some_and(|least| *doubt < least));
    let cures: Vec<Cure> = as_good.map(|(_, cure)| cure).collect();
    // Where more than two do as well the recording tells none.
    let told = match cures.len() {
        0 => closing_angle_deg(recording, file, found)
            .map(|angle_deg| DropFinding::AngleCloses { angle_deg, severity }),
        1 | 2 => Some(DropFinding::UsualSlip { cures, severity }),
        _ => None,
    };
    found.result.quality.extend(told.map(Finding::from));
}

/// Whether all closes, at a k and with intervals that a sound drop has, and nothing is left that speaks of
/// more than this slip.
fn is_cured(analysis: &Analysis) -> bool {
    let result = &analysis.result;
    let (Some(k), Some(speed)) = (result.k, result.slap_down.speed) else { return false };
    let is_doubted =
        |f: &Finding| f.takes(ResultPart::Motion) || f.effect.doubts_cask_file() || f.code == IssueCode::Skew;
    let mut left = result.quality.iter().filter(|f| f.severity > Severity::Note);
    let is_usual = k.u95 < MOST_U95_K && speed.u95 < MOST_U95_SPEED * speed.value;
    is_usual && LIKELY_K.contains(&k.value) && closes(analysis) && !left.any(is_doubted)
}

fn is_left_out(finding: &Finding) -> bool {
    matches!(finding.what, FindingKind::Channel(ChannelFinding::LeftOut { .. }))
}

/// How severe the findings are that a slip may explain: errors of which none takes a channel, or a warning on
/// what the cask file says of the channels.
fn severity_of_doubt(findings: &[Finding], v0_m_s: f64) -> Option<Severity> {
    // No slip gives back what a clipped or dead channel lost.
    let is_lost = |f: &Finding| match f.what {
        FindingKind::Channel(ChannelFinding::Clipped { lost_m_s, .. }) => lost_m_s <= MOST_LOST * v0_m_s,
        _ => f.takes(ResultPart::Channel),
    };
    let mut errors = findings.iter().filter(|f| f.severity == Severity::Error).peekable();
    if errors.peek().is_some() {
        return (!errors.any(is_lost)).then_some(Severity::Error);
    }
    let warns =
        |f: &Finding| f.severity == Severity::Warning && (f.effect.doubts_cask_file() || is_left_out(f));
    findings.iter().any(warns).then_some(Severity::Warning)
}

/// What is usually confused, as far as it may be by what is stated.
fn hypotheses(recording: &Recording, file: &CaskFile) -> Vec<Vec<Slip>> {
    let channels = &recording.channels;
    let across: Vec<&Channel> = channels.iter().filter(|c| c.axis == Axis::Transverse).collect();
    let names_of = |channels: &[&Channel]| channels.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    let all_of = (across.len() > 1).then_some(&across[..]);
    let reversed = |group: &[&Channel]| slip("polarity", names_of(group), "reversed", [0.0, -1.0]);
    let mut all = of_numbers(recording, file);
    for (i, one) in channels.iter().enumerate() {
        // The two ends of the cask, or the two axes of an end.
        let may_be = |c: &&Channel| (c.axis == one.axis) != (c.end == one.end);
        for other in channels[i + 1..].iter().filter(may_be) {
            let exchanged = slip("source", names_of(&[one, other]), "exchanged", [0.0, 1.0]);
            let pairs: [&[&Channel]; 3] = [&[one], &[other], &[one, other]];
            let with = |group: &&[&Channel]| vec![exchanged.clone(), reversed(group)];
            all.extend(pairs.iter().filter(|_| one.axis == other.axis).map(with));
            all.push(vec![exchanged]);
        }
    }
    all.extend(of_skin(channels, file.cask.height_m));
    for group in across.chunks(1).chain(all_of) {
        // Message types imply m/s², which fewer samples are in than carry it.
        let may_be_implied = |c: &Channel| c.unit != "g" && recording.format == RecordingFormat::Mcap;
        let is_said = |c: &&Channel| c.is_unit_recorded && !may_be_implied(c);
        let as_unit = |by, right| vec![slip("unit", names_of(group), right, [0.0, by])];
        let units = [("g", as_unit(G, "taken as g")), ("m/s^2", as_unit(1.0 / G, "taken as m/s²"))];
        let is_open = |unit| group.iter().all(|c| c.unit != unit) && !group.iter().any(is_said);
        all.extend(units.into_iter().filter(|(unit, _)| is_open(*unit)).map(|(_, slips)| slips));
        let right = "counted from the other end";
        let from_end = slip("position_m", names_of(group), right, [file.cask.length_m, -1.0]);
        all.extend([vec![reversed(group)], vec![from_end]]);
    }
    all
}

/// Sensors on the skin, above or below, that are stated on the axis: the axial ones tell.
fn of_skin(channels: &[Channel], section_m: f64) -> Vec<Vec<Slip>> {
    let is_stated = channels.iter().any(|c| c.offset_m != 0.0);
    if is_stated || section_m <= 0.0 || channels.iter().all(|c| c.axis == Axis::Transverse) {
        return Vec::new();
    }
    let names: Vec<String> = channels.iter().map(|c| c.name.clone()).collect();
    let on_skin = |right, offset_m| vec![slip("offset_m", names.clone(), right, [offset_m, 0.0])];
    let half_m = section_m / 2.0;
    let above = on_skin("as half the section (upper skin)", half_m);
    vec![above, on_skin("as minus half the section (lower skin)", -half_m)]
}

fn slip(key: &'static str, names: Vec<String>, right: &'static str, [from, by]: [f64; 2]) -> Slip {
    Slip { key, names, right, from, by }
}

/// An angle, heights, lengths and rates that may be in another unit, or counted otherwise.
fn of_numbers(recording: &Recording, file: &CaskFile) -> Vec<Vec<Slip>> {
    let angle = |right, change| vec![slip("drop.angle_deg", Vec::new(), right, change)];
    let mut all = vec![angle("counted from the horizontal", [FRAC_PI_2, -1.0])];
    let degrees = 1_f64.to_degrees();
    all.extend((file.drop.angle_rad * degrees < FRAC_PI_2).then(|| angle("in rad", [0.0, degrees])));
    let names: Vec<String> = recording.channels.iter().map(|c| c.name.clone()).collect();
    // Times that the file names, or that every message has, bear a rate out unless they contradict it.
    let is_contradicted = |f: &Finding| f.code == IssueCode::Clock && f.severity == Severity::Warning;
    let mut named = file.channels.iter().map(|c| &c.time).chain([&file.time]);
    let is_timed = recording.format == RecordingFormat::Mcap || named.any(Option::is_some);
    let is_stated = file.channels.iter().all(|c| c.sample_rate_hz.is_some());
    if is_stated && (!is_timed || recording.issues.iter().any(is_contradicted)) {
        let rate = |right, by| vec![slip("sample_rate_hz", names.clone(), right, [0.0, by])];
        all.extend([rate("halved", 0.5), rate("doubled", 2.0)]);
    }
    for (right, by) in LENGTHS_M {
        if !file.drop.impact_velocity_given && by * file.drop.height_m > LEAST_M {
            all.push(vec![slip("drop.height_m", Vec::new(), right, [0.0, by])]);
        }
        let length_m = by * file.cask.length_m;
        // A place off the cask is refused: places beyond the shorter cask are in that unit too.
        let is_off = recording.channels.iter().any(|c| c.position_m > length_m);
        let lengths = [("[cask]", Vec::new()), ("position_m", names.clone())];
        let off = lengths.into_iter().take(1 + usize::from(is_off));
        let slips = off.map(|(key, names)| slip(key, names, right, [0.0, by])).collect();
        all.extend((length_m > LEAST_M).then_some(slips));
    }
    all
}

/// Puts a slip right.
fn put_right(slip: &Slip, recording: &mut Recording, file: &mut CaskFile) {
    let Slip { key, names, from, by, .. } = slip;
    let mend = |x: &mut f64| *x = from + by * *x;
    let (cask, drop, channels) = (&mut file.cask, &mut file.drop, &mut recording.channels);
    let own = channels.iter_mut().filter(|c| names.contains(&c.name));
    match *key {
        "drop.angle_deg" => mend(&mut drop.angle_rad),
        "drop.height_m" => {
            drop.height_m *= by;
            drop.impact_velocity_m_s *= by.sqrt();
        }
        "[cask]" => {
            [&mut cask.length_m, &mut cask.height_m, &mut cask.cog_m].into_iter().for_each(mend);
            let is_default = file.defaults.iter().any(|key| key == "cask.inertia_kg_m2");
            cask.inertia_kg_m2 *= if is_default { by * by } else { 1.0 };
        }
        "source" => exchange(own),
        "offset_m" => own.for_each(|c| mend(&mut c.offset_m)),
        "position_m" => own.for_each(|c| mend(&mut c.position_m)),
        "sample_rate_hz" => own.for_each(|c| mend(&mut c.sample_rate_hz)),
        // What the sensor can read stays what it is.
        _ => own.for_each(|c| {
            mend(&mut c.scale_m_s2);
            c.full_scale = c.full_scale.map(|full_scale| full_scale / by.abs());
        }),
    }
}

/// The velocity steps of a flight, as samples, and when the first contact began.
#[derive(Clone)]
struct StepSamples {
    recording: Recording,
    flight: FlightFit,
    contact_s: f64,
}

/// The velocity steps of the flight, as a recording of two samples a channel, the step and its standard
/// uncertainty: what a slip put right makes of them is told without a whole analysis.
///
/// One body has them in any stretch of time that all channels share; what the fit leaves counts as uncertain.
fn of_steps(recording: &Recording, result: &DropResult) -> Option<StepSamples> {
    let (flight, contact_s) = (result.flight.clone()?, result.first_impact.time?.value);
    let mut steps = recording.clone();
    for channel in &mut steps.channels {
        let own = flight.plateau(&channel.name).map(|p| [p.velocity_step_m_s, p.u_m_s.hypot(p.residual_m_s)]);
        let in_unit = own.unwrap_or([f64::NAN; 2]).map(|x| x / channel.scale_m_s2);
        channel.samples = Samples::F64(in_unit.to_vec());
    }
    Some(StepSamples { recording: steps, flight, contact_s })
}

/// Whether these steps may be those of one rigid body with these slips put right.
fn is_rigid(slips: &[Slip], of_steps: &StepSamples, file: &CaskFile) -> bool {
    let StepSamples { recording: mut steps, mut flight, contact_s } = of_steps.clone();
    let mut stated = file.clone();
    for slip in slips {
        put_right(slip, &mut steps, &mut stated);
    }
    for channel in &steps.channels {
        let own = flight.plateaus.iter_mut().find(|p| p.channel == channel.name);
        if let (Some(own), &[step_m_s, u_m_s]) = (own, &channel.force_m_s2(0, 2)[..]) {
            (own.velocity_step_m_s, own.u_m_s) = (step_m_s, u_m_s.abs());
        }
    }
    let across = steps.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let places =
        across.map(|c| judge::SensorPlace { name: &c.name, position_m: c.position_m, offset_m: c.offset_m });
    judge::judge_rigid(places, &flight, &stated.tolerances, &stated.drop, contact_s).is_none()
}

/// The samples of two channels change places, and what the cask file says of each channel stays, its polarity
/// too.
fn exchange<'a>(mut both: impl Iterator<Item = &'a mut Channel>) {
    let (Some(one), Some(other)) = (both.next(), both.next()) else { return };
    std::mem::swap(one, other);
    std::mem::swap(&mut one.name, &mut other.name);
    std::mem::swap(&mut one.end, &mut other.end);
    std::mem::swap(&mut one.axis, &mut other.axis);
    std::mem::swap(&mut one.position_m, &mut other.position_m);
    std::mem::swap(&mut one.offset_m, &mut other.offset_m);
    if one.scale_m_s2.is_sign_negative() != other.scale_m_s2.is_sign_negative() {
        one.scale_m_s2 *= -1.0;
        other.scale_m_s2 *= -1.0;
    }
}

/// The angle with which R meets the target as it strikes and everything else closes, by the secant, where
/// that closure is missed, degrees.
fn closing_angle_deg(recording: &Recording, file: &CaskFile, found: &Analysis) -> Option<f64> {
    let miss = |analysis: &Analysis| {
        let closures = &analysis.result.reconstruction.as_ref()?.closures;
        closures.iter().find(|c| c.kind == ClosureKind::Height).map(|c| c.miss_in_u)
    };
    let (mut last_rad, mut last) = (file.drop.angle_rad, miss(found).filter(|u| u.abs() > MISSED_U)?);
    // R too high as it strikes: the stated angle is too large.
    let mut step_rad = -last.signum() * STEP_RAD;
    for _ in 0..STEPS {
        let mut stated = file.clone();
        stated.drop.angle_rad = (last_rad + step_rad).clamp(0.0, FRAC_PI_2);
        let analysis = analyzed(recording, &stated, Patience::OneBeginning);
        let now = miss(&analysis)?;
        if now.abs() < MET {
            return is_cured(&analysis).then_some(stated.drop.angle_rad.to_degrees());
        }
        step_rad *= -now / (now - last);
        (last_rad, last) = (stated.drop.angle_rad, now);
    }
    None
}
