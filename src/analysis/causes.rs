//! An analysis that something speaks against to the one mistake in the cask file with which everything
//! closes.

use super::analyse_once;
use super::flight_search::Patience;
use super::second_look::{Doubt, closes, is_too_large};
use crate::data::shown::digits;
use crate::data::{
    Analysis, Axis, CaskFile, Channel, ChannelFinding, Cure, DECISIVE_CHI_SQUARE, DropFinding, DropResult,
    Effect, End, Events, Finding, FindingKind, FlightFit, IssueCode, Opening, Recording, RecordingFormat,
    ResultPart, STANDARD_GRAVITY_M_S2 as G, Samples, Severity, Slip, StatedCause,
};
use crate::numerics::robust;
use crate::{events, judge};
use rayon::prelude::*;
use std::cmp::Ordering;
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
/// Clocks that are farther apart are no number that is a little off, s.
const NEAR_S: f64 = 8e-3;
/// Clocks are apart where they seem so by more, s: within it an analysis comes to the same. A soft impact has
/// an end seem to answer by so much later than it does; clocks nearer to one another are one.
const APART_S: f64 = 2e-3;
const SEEM_LATER_S: [f64; 3] = [0.0, 2e-3, 4e-3];
const SAME_CLOCK_S: f64 = 1.5e-3;
/// Places that differ by less are one, m.
const SAME_M: f64 = 0.01;
/// Openings that are tried: no more than so many, of a χ² up to this many times the least and three times
/// [`DECISIVE_CHI_SQUARE`] more; and how often: a place 0.7 m off is found by the second time.
const MOST_OPENED: usize = 5;
const NEARLY: f64 = 2.0;
const ROUNDS: usize = 2;
/// More causes that do as well are listed, and none is named.
const MOST_NAMED: usize = 2;
/// A scale or a clock is wrong by no more than this factor where it is no unit.
const LIKELY_FACTOR: RangeInclusive<f64> = 0.1..=10.0;

/// Adds what explains the analysis where something speaks against it: the usual slips with which everything
/// closes, or else the stated numbers of which another one does it.
pub(super) fn name_causes(recording: &Recording, file: &CaskFile, found: &mut Analysis) {
    let doubt = severity_of_doubt(&found.result.quality, file.drop.impact_velocity_m_s);
    let taken = is_motion_taken(&found.result.quality).then_some(Severity::Warning);
    let Some(severity) = doubt.or(taken).filter(|_| !is_too_large(recording)) else { return };
    let stated = Contradicted { recording, file };
    // Where all closes without one channel, nothing else is wrong.
    let left_out = found.result.quality.iter().find(|f| is_left_out(f)).and_then(|f| f.channel.as_ref());
    let is_of_it = |slips: &[Slip]| left_out.is_none_or(|name| slips.iter().any(|s| s.names.contains(name)));
    let steps = of_steps(recording, &found.result);
    let may_cure = |slips: &Vec<Slip>| steps.as_ref().is_none_or(|steps| is_rigid(slips, steps, file));
    let usual = hypotheses(recording, file).into_par_iter().filter(may_cure);
    let by_usual = usual.filter(|slips| is_of_it(slips)).filter_map(|slips| stated.cured_by_slips(slips));
    // A small shift is one number more, which other numbers may do as well as.
    let clocks = stated.clocks_behind_s(found).into_iter().map(|behind_s| stated.earlier(behind_s));
    let own_clocks = clocks.filter(|slip| is_of_it(std::slice::from_ref(slip)));
    let (far, near): (Vec<Slip>, Vec<Slip>) = own_clocks.partition(|slip| slip.from.abs() > NEAR_S);
    // One clock is sought from several sides.
    let by_clock = |slips: Vec<Slip>| {
        slips.into_par_iter().filter_map(|slip| stated.cured_by_clock(slip)).min_by(less_doubted)
    };
    let by_slips = best(by_usual.chain(by_clock(far)).collect());
    let is_usual = !by_slips.is_empty();
    let by_number = || {
        let numbers = stated.numbers_to_try(found).into_par_iter();
        let own = numbers.filter(|(slip, _)| is_of_it(std::slice::from_ref(slip)));
        best(own.filter_map(|number| stated.cured_by_number(number)).chain(by_clock(near)).collect())
    };
    // A number that is a little off contradicts something; without that it only has a finding go away.
    let cures = if is_usual || doubt.is_none() { by_slips } else { by_number() };
    if cures.len() <= MOST_NAMED {
        found.result.causes = cures.iter().flat_map(|cure| cure.causes.clone()).collect();
    }
    let cause = match (cures.len(), is_usual) {
        (0, _) => return,
        (..=MOST_NAMED, true) => DropFinding::UsualSlip { cures, severity },
        (..=MOST_NAMED, false) => DropFinding::OneNumber { cures, severity },
        _ => DropFinding::SeveralCauses { cures, severity },
    };
    found.result.quality.push(cause.into());
}

/// What an analysis was made of that contradicts itself.
struct Contradicted<'a> {
    recording: &'a Recording,
    file: &'a CaskFile,
}

impl Contradicted<'_> {
    /// The analysis with slips put right.
    fn with(&self, slips: &[Slip], patience: Patience) -> Analysis {
        let (mut recording, mut file) = (self.recording.clone(), self.file.clone());
        for slip in slips {
            put_right(slip, &mut recording, &mut file);
        }
        analyse_once(&recording, &file, patience)
    }

    fn cured_by_slips(&self, slips: Vec<Slip>) -> Option<(Doubt, Cure)> {
        let analysis = self.with(&slips, Patience::OneBeginning);
        is_cured(&analysis, [MOST_U95_K, MOST_U95_SPEED]).then(|| self.cure(slips, &analysis))
    }

    /// How far the clock of the second end's channels may be behind, s: as they answer the first impact, and
    /// roughly as both ends show the drop.
    fn clocks_behind_s(&self, found: &Analysis) -> Vec<f64> {
        let roughly =
            events::Changes::new(&self.recording.channels).delays_s(self.file.drop.impact_velocity_m_s);
        let apart = roughly.into_iter().filter(|behind_s| behind_s.abs() > APART_S);
        let sooner_s = apart.flat_map(|behind_s| SEEM_LATER_S.map(|later_s| behind_s - later_s));
        let mut all_s: Vec<f64> = late_s(found, &self.far_names()).into_iter().chain(sooner_s).collect();
        all_s.sort_by(f64::total_cmp);
        all_s.dedup_by(|a, b| (*a - *b).abs() < SAME_CLOCK_S);
        all_s
    }

    fn far_names(&self) -> Vec<String> {
        let far = self.recording.channels.iter().filter(|c| c.end == End::Second);
        far.map(|c| c.name.clone()).collect()
    }

    /// The clock of the second end's channels, set so much earlier.
    fn earlier(&self, by_s: f64) -> Slip {
        let way = if by_s > 0.0 { "earlier" } else { "later" };
        let right = format!("{:.2} ms {way}", 1e3 * by_s.abs());
        Slip { right: right.into(), ..slip("time", self.far_names(), "", [-by_s, 1.0]) }
    }

    /// By a clock, which is set again as the channels then answer the first impact.
    fn cured_by_clock(&self, mut slip: Slip) -> Option<(Doubt, Cure)> {
        for _ in 0..ROUNDS {
            let analysis = self.with(std::slice::from_ref(&slip), Patience::OneBeginning);
            if is_cured(&analysis, [MOST_U95_K, MOST_U95_SPEED]) {
                return Some(self.cure(vec![slip], &analysis));
            }
            slip = self.earlier(late_s(&analysis, &slip.names)? - slip.from);
        }
        None
    }

    /// By another number, which is opened again where a large mistake leaves it open, as patiently.
    fn cured_by_number(&self, (mut slip, patience): (Slip, Patience)) -> Option<(Doubt, Cure)> {
        for _ in 0..ROUNDS {
            let analysis = self.with(std::slice::from_ref(&slip), patience);
            // All closures and steps are met: only intervals that say nothing are too wide.
            if is_cured(&analysis, [judge::MOST_U95_K, judge::MOST_U95_SPEED]) {
                return Some(self.cure(vec![slip], &analysis));
            }
            let is_own =
                |o: &&Opening| o.key == slip.key && o.channel.as_ref().is_none_or(|n| slip.names.contains(n));
            slip = self.opened(&slip, analysis.openings.iter().find(is_own)?);
            if !is_possible(&slip, self.file) {
                return None;
            }
        }
        None
    }

    fn cure(&self, slips: Vec<Slip>, analysis: &Analysis) -> (Doubt, Cure) {
        let (speed, k) = (analysis.result.slap_down.speed, analysis.result.k);
        let cause = |slip: &Slip| {
            let [stated, explains] = self.numbers(slip).map_or([None; 2], |both| both.map(Some));
            StatedCause { key: slip.key, names: slip.names.clone(), stated, explains, speed, k }
        };
        let causes = slips.iter().map(cause).collect();
        (Doubt::of(analysis), Cure { slips, causes })
    }

    /// Other numbers of a drop that come near to explaining it, and offsets to the other side, which move
    /// little.
    fn numbers_to_try(&self, found: &Analysis) -> Vec<(Slip, Patience)> {
        let first = |opening: &Opening| {
            let names = match opening.key {
                "sample_rate_hz" => self.recording.channels.iter().map(|c| c.name.clone()).collect(),
                _ => opening.channel.iter().cloned().collect(),
            };
            let as_stated = Slip { key: opening.key, names, right: "".into(), from: 0.0, by: 1.0 };
            (opening.chi_square, self.opened(&as_stated, opening))
        };
        let possible = found.openings.iter().map(first).filter(|(_, slip)| is_possible(slip, self.file));
        let mut most = f64::INFINITY;
        let near = possible.take_while(|(chi_square, _)| {
            most = most.min(NEARLY * chi_square + 3.0 * DECISIVE_CHI_SQUARE);
            *chi_square < most
        });
        let channels = &self.recording.channels;
        let off_axis = channels.iter().filter(|c| c.offset_m != 0.0);
        let reversed = off_axis.map(|c| slip("offset_m", vec![c.name.clone()], "reversed", [0.0, -1.0]));
        let on_axis =
            channels.iter().filter(|c| c.offset_m == 0.0 && is_doubted_place(&found.result, &c.name));
        let as_others = on_axis.flat_map(|c| self.places_of_others(c));
        let offsets = of_skin(channels, self.file.cask.height_m).into_iter().chain(reversed).chain(as_others);
        let opened = near.take(MOST_OPENED).map(|(_, slip)| (slip, Patience::EachBeginning));
        opened.chain(offsets.map(|slip| (slip, Patience::OneBeginning))).collect()
    }

    /// A sensor that is stated on the axis as far off it as the others, or on the skin.
    fn places_of_others(&self, channel: &Channel) -> Vec<Slip> {
        let others_m = self.recording.channels.iter().map(|c| c.offset_m.abs());
        let mut all_m: Vec<f64> =
            others_m.chain([self.file.cask.height_m / 2.0]).filter(|m| *m > 0.0).collect();
        all_m.sort_by(f64::total_cmp);
        all_m.dedup_by(|a, b| (*a - *b).abs() < SAME_M);
        let slip = |offset_m: f64| {
            let right = format!("{} in place of 0", digits(offset_m, 4));
            Slip { right: right.into(), ..slip("offset_m", vec![channel.name.clone()], "", [offset_m, 0.0]) }
        };
        all_m.into_iter().flat_map(|offset_m| [slip(offset_m), slip(-offset_m)]).collect()
    }

    /// The slip with the number that an opening has, found where it was put right as `slip` has it.
    fn opened(&self, slip: &Slip, opening: &Opening) -> Slip {
        let factor = opening.explains / opening.stated;
        let [from, by] = match slip.key {
            "scale" | "cask.inertia_kg_m2" | "drop.impact_velocity_m_s" => [0.0, slip.by * factor],
            // A longer second puts fewer samples into it.
            "sample_rate_hz" => [0.0, slip.by / factor],
            // v0 is that of the root of the height.
            "drop.height_m" => [0.0, slip.by * factor * factor],
            _ => [opening.explains, 0.0],
        };
        let slip = Slip { from, by, ..slip.clone() };
        let words = |[stated, explains]: [f64; 2]| {
            format!("{} in place of {}", digits(explains, 4), digits(stated, 4))
        };
        let right = self.numbers(&slip).map_or_else(String::new, words).into();
        Slip { right, ..slip }
    }

    /// The number that a slip's key states and the one that is right, in the key's unit; of a polarity or
    /// scale the factor. `None` where it is no number, or one for each of several channels.
    fn numbers(&self, slip: &Slip) -> Option<[f64; 2]> {
        let CaskFile { cask, drop, .. } = self.file;
        let channel = self.recording.channels.iter().find(|c| slip.names.first() == Some(&c.name));
        let alone = channel.filter(|_| slip.names.len() == 1);
        let degree = 1_f64.to_degrees();
        let (stated, unit) = match slip.key {
            "drop.angle_deg" => (drop.angle_rad, degree),
            "drop.angular_velocity_deg_s" => (drop.angular_velocity_rad_s, degree),
            "drop.height_m" => (drop.height_m, 1.0),
            "drop.impact_velocity_m_s" => (drop.impact_velocity_m_s, 1.0),
            "cask.length_m" => (cask.length_m, 1.0),
            "cask.height_m" => (cask.height_m, 1.0),
            "cask.cog_m" => (cask.cog_m, 1.0),
            "cask.inertia_kg_m2" => (cask.inertia_kg_m2, 1.0),
            "sample_rate_hz" => (channel?.sample_rate_hz, 1.0),
            "position_m" => (alone?.position_m, 1.0),
            "offset_m" => (alone?.offset_m, 1.0),
            "scale" => {
                let spec = self.file.channels.iter().find(|spec| slip.names.first() == Some(&spec.name))?;
                (spec.scale.unwrap_or(1.0), 1.0)
            }
            "polarity" => (1.0, 1.0),
            _ => return None,
        };
        Some([stated * unit, (slip.from + slip.by * stated) * unit])
    }
}

/// How late these channels answer the first impact beside the struck one, s: the median of those that a
/// finding names.
fn late_s(analysis: &Analysis, names: &[String]) -> Option<f64> {
    let delay_s = |f: &Finding| match f.what {
        FindingKind::Channel(
            ChannelFinding::AnswersEarly { delay_s, .. }
            | ChannelFinding::AnswersLate { delay_s, .. }
            | ChannelFinding::AnswersAsAWave { delay_s, .. },
        ) if f.channel.as_ref().is_some_and(|name| names.contains(name)) => Some(delay_s),
        _ => None,
    };
    let mut late_s: Vec<f64> = analysis.result.quality.iter().filter_map(delay_s).collect();
    (!late_s.is_empty()).then(|| robust::median(&mut late_s))
}

/// Whether a finding says that a channel may sit elsewhere.
fn is_doubted_place(result: &DropResult, name: &str) -> bool {
    let doubts = |f: &Finding| f.effect == Effect::DoubtfulPlace && f.severity > Severity::Note;
    result.quality.iter().any(|f| doubts(f) && f.channel.as_deref() == Some(name))
}

fn less_doubted((a, _): &(Doubt, Cure), (b, _): &(Doubt, Cure)) -> Ordering {
    a.partial_cmp(b).unwrap_or(Ordering::Equal)
}

/// Those that do as well as the best, in their order.
fn best(mut tried: Vec<(Doubt, Cure)>) -> Vec<Cure> {
    tried.sort_by(less_doubted);
    let clearly = |doubt: &Doubt| Doubt { chi_square: doubt.chi_square + DECISIVE_CHI_SQUARE, ..*doubt };
    let least = tried.first().map(|(doubt, _)| clearly(doubt));
    tried.retain(|(doubt, _)| least.is_some_and(|least| *doubt < least));
    tried.into_iter().map(|(_, cure)| cure).collect()
}

/// Whether a drop can have the number that a slip is put right to.
fn is_possible(slip: &Slip, file: &CaskFile) -> bool {
    let (length_m, is_factor) = (file.cask.length_m, slip.by != 0.0);
    match slip.key {
        // Times that a recording has bear its rate out.
        "sample_rate_hz" if file.channels.iter().any(|c| c.sample_rate_hz.is_none()) => false,
        _ if is_factor => LIKELY_FACTOR.contains(&slip.by),
        "position_m" | "cask.cog_m" => (0.0..=length_m).contains(&slip.from),
        "offset_m" => slip.from.abs() <= file.cask.height_m,
        "drop.angle_deg" => (0.0..FRAC_PI_2).contains(&slip.from),
        "cask.length_m" | "cask.height_m" => slip.from > LEAST_M,
        _ => true,
    }
}

/// Whether all closes, at a k and with intervals that a sound drop has, and nothing is left that speaks of
/// more than this slip.
fn is_cured(analysis: &Analysis, [most_u95_k, most_u95_speed]: [f64; 2]) -> bool {
    let result = &analysis.result;
    let (Some(k), Some(speed)) = (result.k, result.slap_down.speed) else { return false };
    let is_doubted = |f: &Finding| {
        f.removes(ResultPart::Motion) || f.effect.doubts_cask_file() || f.code == IssueCode::Skew
    };
    let mut left = result.quality.iter().filter(|f| f.severity > Severity::Note);
    let is_usual = k.u95 < most_u95_k && speed.u95 < most_u95_speed * speed.value;
    is_usual && LIKELY_K.contains(&k.value) && closes(analysis) && !left.any(is_doubted)
}

fn is_left_out(finding: &Finding) -> bool {
    matches!(finding.what, FindingKind::Channel(ChannelFinding::LeftOut { .. }))
}

/// How severe the findings are that a mistake may explain: errors of which none takes a channel, or a warning
/// on what the cask file says of the channels.
fn severity_of_doubt(findings: &[Finding], v0_m_s: f64) -> Option<Severity> {
    // The end that a channel was left out of may lack one now.
    if findings.iter().any(is_left_out) {
        return Some(Severity::Warning);
    }
    // No slip gives back what a clipped or dead channel lost.
    let is_lost = |f: &Finding| match f.what {
        FindingKind::Channel(ChannelFinding::Clipped { lost_m_s, .. }) => lost_m_s <= MOST_LOST * v0_m_s,
        _ => f.removes(ResultPart::Channel),
    };
    let mut errors = findings.iter().filter(|f| f.severity == Severity::Error).peekable();
    if errors.peek().is_some() {
        return (!errors.any(is_lost)).then_some(Severity::Error);
    }
    let warns = |f: &Finding| f.severity == Severity::Warning && f.effect.doubts_cask_file();
    findings.iter().any(warns).then_some(Severity::Warning)
}

/// Whether warnings take the motion and no channel, as where ends on two clocks seem to ring as no cask does.
fn is_motion_taken(findings: &[Finding]) -> bool {
    let warns = |part| findings.iter().any(move |f| f.severity > Severity::Note && f.removes(part));
    warns(ResultPart::Motion) && !warns(ResultPart::Channel)
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
    let along = channels.iter().filter(|c| c.axis == Axis::Axial);
    all.extend(along.map(|axial| vec![reversed(&[axial])]));
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
fn of_skin(channels: &[Channel], section_m: f64) -> Vec<Slip> {
    let is_stated = channels.iter().any(|c| c.offset_m != 0.0);
    if is_stated || section_m <= 0.0 || channels.iter().all(|c| c.axis == Axis::Transverse) {
        return Vec::new();
    }
    let names: Vec<String> = channels.iter().map(|c| c.name.clone()).collect();
    let on_skin = |right, offset_m| slip("offset_m", names.clone(), right, [offset_m, 0.0]);
    let half_m = section_m / 2.0;
    let above = on_skin("as half the section (upper skin)", half_m);
    vec![above, on_skin("as minus half the section (lower skin)", -half_m)]
}

fn slip(key: &'static str, names: Vec<String>, right: &'static str, [from, by]: [f64; 2]) -> Slip {
    Slip { key, names, right: right.into(), from, by }
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
        "cask.length_m" => mend(&mut cask.length_m),
        "cask.height_m" => mend(&mut cask.height_m),
        "cask.cog_m" => mend(&mut cask.cog_m),
        "cask.inertia_kg_m2" => mend(&mut cask.inertia_kg_m2),
        "drop.impact_velocity_m_s" => mend(&mut drop.impact_velocity_m_s),
        "drop.angular_velocity_deg_s" => *drop = drop.add_rotation(cask, from - drop.angular_velocity_rad_s),
        "offset_m" => own.for_each(|c| mend(&mut c.offset_m)),
        "position_m" => own.for_each(|c| mend(&mut c.position_m)),
        "scale" => own.for_each(|c| mend(&mut c.scale_m_s2)),
        "sample_rate_hz" => own.for_each(|c| mend(&mut c.sample_rate_hz)),
        "time" => own.for_each(|c| mend(&mut c.start_s)),
        // The limit that a sensor has is stated in the right unit or in the wrong one: the larger counts.
        _ => own.for_each(|c| {
            mend(&mut c.scale_m_s2);
            c.full_scale = c.full_scale.map(|full_scale| full_scale / by.abs().min(1.0));
        }),
    }
}

/// The velocity steps of a flight, as samples, and its events.
#[derive(Clone)]
struct StepSamples {
    recording: Recording,
    flight: FlightFit,
    events: Events,
}

/// The velocity steps of the flight, as a recording of two samples a channel, the step and its standard
/// uncertainty: what a slip put right makes of them is told without a whole analysis.
///
/// One body has them in any stretch of time that all channels share; what the fit leaves counts as uncertain.
fn of_steps(recording: &Recording, result: &DropResult) -> Option<StepSamples> {
    let (flight, events) = (result.flight.clone()?, result.events);
    let mut steps = recording.clone();
    for channel in &mut steps.channels {
        let own = flight.plateau(&channel.name).map(|p| [p.velocity_step_m_s, p.u_m_s.hypot(p.residual_m_s)]);
        let in_unit = own.unwrap_or([f64::NAN; 2]).map(|x| x / channel.scale_m_s2);
        channel.samples = Samples::F64(in_unit.to_vec());
    }
    Some(StepSamples { recording: steps, flight, events })
}

/// Whether these steps may be those of one rigid body with these slips put right.
fn is_rigid(slips: &[Slip], of_steps: &StepSamples, file: &CaskFile) -> bool {
    let StepSamples { recording: mut steps, mut flight, events } = of_steps.clone();
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
    judge::judge_rigid(places, &flight, &stated.tolerances, &stated.drop, &events).is_none()
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
