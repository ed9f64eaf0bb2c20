//! Finds the one mistake in the cask file that explains an analysis which contradicts itself.

use super::analyse_once;
use super::flight_search::SearchEffort;
use super::second_look::{Inconsistency, is_consistent, is_too_large};
use crate::data::shown::digits;
use crate::data::{
    Analysis, Axis, CaskFile, Channel, ChannelFinding, ChannelSpec, DECISIVE_CHI_SQUARE, DropFinding,
    DropResult, Effect, End, Events, Finding, FindingKind, FlightFit, IssueCode, Mistake, OpenedInput,
    Recording, RecordingFormat, ResultPart, STANDARD_GRAVITY_M_S2 as G, Samples, Severity, StatedCause,
    StatedRemedy,
};
use crate::numerics::robust;
use crate::{events, judge};
use rayon::prelude::*;
use std::borrow::Cow;
use std::cmp::Ordering;
use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

/// Range of k with a correction: no crushed end rebounds otherwise, and if only one of two mistakes is
/// corrected, k is often outside.
const LIKELY_K: RangeInclusive<f64> = 0.02..=0.98;
/// Largest 95 % half-widths with a correction, of k and of the speed as a share: sound drops have 0.067 and
/// all but one 0.05 (docs/validation.md); if only one of two mistakes is corrected they reach 0.3 and more.
const MOST_U95_K: f64 = 0.08;
const MOST_U95_SPEED: f64 = 0.06;
/// Units that a number in metres may really have.
const LENGTH_UNITS_M: [(&str, f64); 3] = [("in cm", 0.01), ("in mm", 1e-3), ("in ft", 0.3048)];
/// Smallest drop height and length of a cask for which a unit of length is tried, m.
const LEAST_M: f64 = 0.1;
/// Largest velocity lost to clipping, in v0: a cask cannot lose more in its impacts, so that the unit is
/// wrong.
const MOST_LOST_V0: f64 = 3.0;
/// Clocks at most this far apart may be explained by another number just as well, s.
const NEAR_S: f64 = 8e-3;
/// Clocks count as different if they seem more than [`APART_S`] apart, s: less does not change an analysis.
/// In a soft impact an end seems to answer later than it does, by one of [`SOFT_DELAYS_S`]. Differences
/// closer than [`SAME_CLOCK_S`] are one.
const APART_S: f64 = 2e-3;
const SOFT_DELAYS_S: [f64; 3] = [0.0, 2e-3, 4e-3];
const SAME_CLOCK_S: f64 = 1.5e-3;
/// Places that differ by less are one, m.
const SAME_M: f64 = 0.01;
/// Largest number of opened inputs that are tried, those with a χ² up to this factor times the least plus
/// three times [`DECISIVE_CHI_SQUARE`]; and the rounds of each: a place 0.7 m off is found in the second one.
const MOST_TRIED: usize = 5;
const CHI_SQUARE_FACTOR: f64 = 2.0;
const ROUNDS: usize = 2;
/// Largest number of equally good causes that are named; more are only listed.
const MOST_NAMED: usize = 2;
/// Likely factors of a scale or a clock that do not come from a unit.
const LIKELY_FACTOR: RangeInclusive<f64> = 0.1..=10.0;

/// A remedy, and the inconsistency that remains with it.
type RatedRemedy = (Inconsistency, StatedRemedy);

/// Adds the explanations if something contradicts the analysis: the usual mistakes whose correction makes
/// everything consistent, else the stated numbers of which another one does.
pub(super) fn name_causes(recording: &Recording, file: &CaskFile, found: &mut Analysis) {
    let doubt = severity_of_doubt(&found.result.quality, file.drop.impact_velocity_m_s);
    let removed = warnings_remove_motion(&found.result.quality).then_some(Severity::Warning);
    let Some(severity) = doubt.or(removed).filter(|_| !is_too_large(recording)) else { return };
    let search = CauseSearch { recording, file };
    // If everything is consistent without one channel, nothing else is wrong.
    let left_out = found.result.quality.iter().find(|f| is_left_out(f)).and_then(|f| f.channel.as_ref());
    let may_be = |m: &Mistake| left_out.is_none_or(|name| m.names.contains(name));
    let steps = step_samples(recording, &found.result);
    let may_help = |all: &Vec<Mistake>| steps.as_ref().is_none_or(|steps| is_rigid(all, steps, file));
    let usual = usual_mistakes(recording, file).into_par_iter().filter(may_help);
    let by_usual = usual.filter(|all| all.iter().any(may_be)).filter_map(|all| search.try_mistakes(all));
    // A small shift is one more free number; other numbers may explain as much.
    let clocks = search.clocks_behind_s(found).into_iter().map(|behind_s| search.clock_mistake(behind_s));
    let (far, near): (Vec<_>, Vec<_>) = clocks.filter(may_be).partition(|m| m.offset.abs() > NEAR_S);
    // The same clock may be found from several estimates.
    let by_clock = |clocks: Vec<Mistake>| {
        clocks.into_par_iter().filter_map(|m| search.try_clock(m)).min_by(compare_remedies)
    };
    let by_mistakes = keep_best(by_usual.chain(by_clock(far)).collect());
    let is_usual = !by_mistakes.is_empty();
    let by_number = || {
        let numbers = search.numbers_to_try(found).into_par_iter().filter(|(mistake, _)| may_be(mistake));
        keep_best(numbers.filter_map(|number| search.try_number(number)).chain(by_clock(near)).collect())
    };
    // Another number explains a contradiction; without one it would only remove a finding.
    let remedies = if is_usual || doubt.is_none() { by_mistakes } else { by_number() };
    if remedies.len() <= MOST_NAMED {
        found.result.causes = remedies.iter().flat_map(|remedy| remedy.causes.clone()).collect();
    }
    let cause = match (remedies.len(), is_usual) {
        (0, _) => return,
        (..=MOST_NAMED, true) => DropFinding::UsualMistake { remedies, severity },
        (..=MOST_NAMED, false) => DropFinding::OneNumber { remedies, severity },
        _ => DropFinding::SeveralCauses { remedies, severity },
    };
    found.result.quality.push(cause.into());
}

/// Recording and cask file of an analysis that contradicts itself.
struct CauseSearch<'a> {
    recording: &'a Recording,
    file: &'a CaskFile,
}

impl CauseSearch<'_> {
    /// Repeats the analysis with mistakes corrected.
    fn analyze_corrected(&self, mistakes: &[Mistake], effort: SearchEffort) -> Analysis {
        let (mut recording, mut file) = (self.recording.clone(), self.file.clone());
        for mistake in mistakes {
            apply_correction(mistake, &mut recording, &mut file);
        }
        analyse_once(&recording, &file, effort)
    }

    fn try_mistakes(&self, mistakes: Vec<Mistake>) -> Option<RatedRemedy> {
        let analysis = self.analyze_corrected(&mistakes, SearchEffort::FirstStart);
        is_remedied(&analysis, [MOST_U95_K, MOST_U95_SPEED]).then(|| self.remedy(mistakes, &analysis))
    }

    /// Delays by which the clock of the second end's channels may be behind, s: from their answers to the
    /// first impact, and roughly from the drop as both ends show it.
    fn clocks_behind_s(&self, found: &Analysis) -> Vec<f64> {
        let roughly =
            events::Changes::new(&self.recording.channels).delays_s(self.file.drop.impact_velocity_m_s);
        let apart = roughly.into_iter().filter(|behind_s| behind_s.abs() > APART_S);
        let sooner_s = apart.flat_map(|behind_s| SOFT_DELAYS_S.map(|later_s| behind_s - later_s));
        let late_s = median_delay_s(found, &self.far_names());
        let mut all_s: Vec<f64> = late_s.into_iter().chain(sooner_s).collect();
        all_s.sort_by(f64::total_cmp);
        all_s.dedup_by(|a, b| (*a - *b).abs() < SAME_CLOCK_S);
        all_s
    }

    fn far_names(&self) -> Vec<String> {
        let far = self.recording.channels.iter().filter(|c| c.end == End::Second);
        far.map(|c| c.name.clone()).collect()
    }

    /// Sets the clock of the second end's channels earlier.
    fn clock_mistake(&self, by_s: f64) -> Mistake {
        let way = if by_s > 0.0 { "earlier" } else { "later" };
        let correction = format!("{:.2} ms {way}", 1e3 * by_s.abs());
        mistake("time", self.far_names(), correction, [-by_s, 1.0])
    }

    /// Tries a clock, and sets it again from the answers that the channels then give to the first impact.
    fn try_clock(&self, mut mistake: Mistake) -> Option<RatedRemedy> {
        for _ in 0..ROUNDS {
            let analysis = self.analyze_corrected(std::slice::from_ref(&mistake), SearchEffort::FirstStart);
            if is_remedied(&analysis, [MOST_U95_K, MOST_U95_SPEED]) {
                return Some(self.remedy(vec![mistake], &analysis));
            }
            mistake = self.clock_mistake(median_delay_s(&analysis, &mistake.names)? - mistake.offset);
        }
        None
    }

    /// Tries another number, and again the number that the new analysis suggests, with the same effort.
    fn try_number(&self, (mut mistake, effort): (Mistake, SearchEffort)) -> Option<RatedRemedy> {
        for _ in 0..ROUNDS {
            let analysis = self.analyze_corrected(std::slice::from_ref(&mistake), effort);
            // All checks and steps are met: only intervals that say nothing are too wide.
            if is_remedied(&analysis, [judge::MOST_U95_K, judge::MOST_U95_SPEED]) {
                return Some(self.remedy(vec![mistake], &analysis));
            }
            let names = &mistake.names;
            let is_same =
                |o: &&OpenedInput| o.key == mistake.key && o.channel.iter().all(|n| names.contains(n));
            mistake = self.with_number(&mistake, analysis.opened_inputs.iter().find(is_same)?);
            if !is_possible(&mistake, self.file) {
                return None;
            }
        }
        None
    }

    fn remedy(&self, mistakes: Vec<Mistake>, analysis: &Analysis) -> RatedRemedy {
        let (speed, k) = (analysis.result.slap_down.speed, analysis.result.k);
        let cause = |mistake: &Mistake| {
            let [stated, explains] = self.numbers(mistake).map_or([None; 2], |numbers| numbers.map(Some));
            StatedCause { key: mistake.key, names: mistake.names.clone(), stated, explains, speed, k }
        };
        let causes = mistakes.iter().map(cause).collect();
        (Inconsistency::measure(analysis), StatedRemedy { mistakes, causes })
    }

    /// Lists other numbers that come near to explaining the drop, and offsets to the other side, which change
    /// little.
    fn numbers_to_try(&self, found: &Analysis) -> Vec<(Mistake, SearchEffort)> {
        let first = |input: &OpenedInput| {
            let names = match input.key {
                "sample_rate_hz" => self.recording.channels.iter().map(|c| c.name.clone()).collect(),
                _ => input.channel.iter().cloned().collect(),
            };
            (input.chi_square, self.with_number(&mistake(input.key, names, "", [0.0, 1.0]), input))
        };
        let possible = found.opened_inputs.iter().map(first).filter(|(_, m)| is_possible(m, self.file));
        let mut most = f64::INFINITY;
        let near = possible.take_while(|(chi_square, _)| {
            most = most.min(CHI_SQUARE_FACTOR * chi_square + 3.0 * DECISIVE_CHI_SQUARE);
            *chi_square < most
        });
        let channels = &self.recording.channels;
        let off_axis = channels.iter().filter(|c| c.offset_m != 0.0);
        let reversed = off_axis.map(|c| mistake("offset_m", vec![c.name.clone()], "reversed", [0.0, -1.0]));
        let on_axis =
            channels.iter().filter(|c| c.offset_m == 0.0 && is_doubted_place(&found.result, &c.name));
        let as_others = on_axis.flat_map(|c| self.places_of_others(c));
        let offsets = skin_mistakes(channels, self.file.cask.height_m).into_iter();
        let offsets = offsets.chain(reversed).chain(as_others).map(|m| (m, SearchEffort::FirstStart));
        near.take(MOST_TRIED).map(|(_, m)| (m, SearchEffort::EveryStart)).chain(offsets).collect()
    }

    /// Places off the axis for a sensor that is stated on it: those of the other sensors, or the skin.
    fn places_of_others(&self, channel: &Channel) -> Vec<Mistake> {
        let others_m = self.recording.channels.iter().map(|c| c.offset_m.abs());
        let mut all_m: Vec<f64> =
            others_m.chain([self.file.cask.height_m / 2.0]).filter(|m| *m > 0.0).collect();
        all_m.sort_by(f64::total_cmp);
        all_m.dedup_by(|a, b| (*a - *b).abs() < SAME_M);
        let place = |offset_m: f64| {
            let correction = format!("{} in place of 0", digits(offset_m, 4));
            mistake("offset_m", vec![channel.name.clone()], correction, [offset_m, 0.0])
        };
        all_m.into_iter().flat_map(|offset_m| [place(offset_m), place(-offset_m)]).collect()
    }

    /// Sets a mistake to the number of an opened input, which was found with `mistake` corrected.
    fn with_number(&self, mistake: &Mistake, input: &OpenedInput) -> Mistake {
        let ratio = input.explains / input.stated;
        let [offset, factor] = match mistake.key {
            "scale" | "cask.inertia_kg_m2" | "drop.impact_velocity_m_s" => [0.0, mistake.factor * ratio],
            // A longer second contains fewer samples.
            "sample_rate_hz" => [0.0, mistake.factor / ratio],
            // v0 is proportional to the root of the height.
            "drop.height_m" => [0.0, mistake.factor * ratio * ratio],
            _ => [input.explains, 0.0],
        };
        let mistake = Mistake { offset, factor, ..mistake.clone() };
        let words = |[stated, explains]: [f64; 2]| {
            format!("{} in place of {}", digits(explains, 4), digits(stated, 4))
        };
        let correction = self.numbers(&mistake).map_or_else(String::new, words).into();
        Mistake { correction, ..mistake }
    }

    /// Returns the number that the key of a mistake states and the corrected one, in the key's unit; for a
    /// polarity or scale the factor. `None` for anything else than one number.
    fn numbers(&self, mistake: &Mistake) -> Option<[f64; 2]> {
        let CaskFile { cask, drop, .. } = self.file;
        let channel = self.recording.channels.iter().find(|c| mistake.names.first() == Some(&c.name));
        let alone = channel.filter(|_| mistake.names.len() == 1);
        let degree = 1_f64.to_degrees();
        let (stated, unit) = match mistake.key {
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
                let is_own = |spec: &&ChannelSpec| mistake.names.first() == Some(&spec.name);
                (self.file.channels.iter().find(is_own)?.scale.unwrap_or(1.0), 1.0)
            }
            "polarity" => (1.0, 1.0),
            _ => return None,
        };
        Some([stated * unit, (mistake.offset + mistake.factor * stated) * unit])
    }
}

/// Median delay of these channels' answers to the first impact behind the struck one, s, of those that a
/// finding names.
fn median_delay_s(analysis: &Analysis, names: &[String]) -> Option<f64> {
    let delay_s = |f: &Finding| match f.what {
        FindingKind::Channel(
            ChannelFinding::AnswersEarly { delay_s, .. }
            | ChannelFinding::AnswersLate { delay_s, .. }
            | ChannelFinding::AnswersAsAWave { delay_s, .. },
        ) if f.channel.as_ref().is_some_and(|name| names.contains(name)) => Some(delay_s),
        _ => None,
    };
    let mut delays_s: Vec<f64> = analysis.result.quality.iter().filter_map(delay_s).collect();
    (!delays_s.is_empty()).then(|| robust::median(&mut delays_s))
}

/// True if a finding says that a channel may sit elsewhere.
fn is_doubted_place(result: &DropResult, name: &str) -> bool {
    let doubts = |f: &Finding| f.effect == Effect::DoubtfulPlace && f.severity > Severity::Note;
    result.quality.iter().any(|f| doubts(f) && f.channel.as_deref() == Some(name))
}

fn compare_remedies((a, _): &RatedRemedy, (b, _): &RatedRemedy) -> Ordering {
    a.partial_cmp(b).unwrap_or(Ordering::Equal)
}

/// Keeps the remedies that are as good as the best, in order.
fn keep_best(mut tried: Vec<RatedRemedy>) -> Vec<StatedRemedy> {
    tried.sort_by(compare_remedies);
    let Some(&(least, _)) = tried.first() else { return Vec::new() };
    let most = Inconsistency { chi_square: least.chi_square + DECISIVE_CHI_SQUARE, ..least };
    tried.retain(|(inconsistency, _)| *inconsistency < most);
    tried.into_iter().map(|(_, remedy)| remedy).collect()
}

/// True if a drop can have the number to which a mistake is corrected.
fn is_possible(mistake: &Mistake, file: &CaskFile) -> bool {
    let (length_m, is_factor) = (file.cask.length_m, mistake.factor != 0.0);
    match mistake.key {
        // A recorded time base confirms its rate.
        "sample_rate_hz" if file.channels.iter().any(|c| c.sample_rate_hz.is_none()) => false,
        _ if is_factor => LIKELY_FACTOR.contains(&mistake.factor),
        "position_m" | "cask.cog_m" => (0.0..=length_m).contains(&mistake.offset),
        "offset_m" => mistake.offset.abs() <= file.cask.height_m,
        "drop.angle_deg" => (0.0..FRAC_PI_2).contains(&mistake.offset),
        "cask.length_m" | "cask.height_m" => mistake.offset > LEAST_M,
        _ => true,
    }
}

/// True if everything is consistent, k and its intervals are those of a sound drop, and no finding remains
/// that suggests another mistake.
fn is_remedied(analysis: &Analysis, [most_u95_k, most_u95_speed]: [f64; 2]) -> bool {
    let result = &analysis.result;
    let (Some(k), Some(speed)) = (result.k, result.slap_down.speed) else { return false };
    let is_doubted = |f: &Finding| {
        f.removes(ResultPart::Motion) || f.effect.doubts_cask_file() || f.code == IssueCode::Skew
    };
    let mut left = result.quality.iter().filter(|f| f.severity > Severity::Note);
    let is_usual = k.u95 < most_u95_k && speed.u95 < most_u95_speed * speed.value;
    is_usual && LIKELY_K.contains(&k.value) && is_consistent(analysis) && !left.any(is_doubted)
}

fn is_left_out(finding: &Finding) -> bool {
    matches!(finding.what, FindingKind::Channel(ChannelFinding::LeftOut { .. }))
}

/// Severity of the findings that a mistake may explain: errors that remove no channel, or a warning on the
/// cask file's statements about channels.
fn severity_of_doubt(findings: &[Finding], v0_m_s: f64) -> Option<Severity> {
    // A channel was left out, and its end may have none now.
    if findings.iter().any(is_left_out) {
        return Some(Severity::Warning);
    }
    // No correction restores the samples of a clipped or dead channel.
    let is_lost = |f: &Finding| match f.what {
        FindingKind::Channel(ChannelFinding::Clipped { lost_m_s, .. }) => lost_m_s <= MOST_LOST_V0 * v0_m_s,
        _ => f.removes(ResultPart::Channel),
    };
    let mut errors = findings.iter().filter(|f| f.severity == Severity::Error).peekable();
    if errors.peek().is_some() {
        return (!errors.any(is_lost)).then_some(Severity::Error);
    }
    let warns = |f: &Finding| f.severity == Severity::Warning && f.effect.doubts_cask_file();
    findings.iter().any(warns).then_some(Severity::Warning)
}

/// True if warnings remove the motion but no channel: ends on two clocks seem to ring as no cask does.
fn warnings_remove_motion(findings: &[Finding]) -> bool {
    let warns = |part| findings.iter().any(move |f| f.severity > Severity::Note && f.removes(part));
    warns(ResultPart::Motion) && !warns(ResultPart::Channel)
}

/// Lists the usual mistakes that the statements do not exclude.
fn usual_mistakes(recording: &Recording, file: &CaskFile) -> Vec<Vec<Mistake>> {
    let channels = &recording.channels;
    let across: Vec<&Channel> = channels.iter().filter(|c| c.axis == Axis::Transverse).collect();
    let names_of = |channels: &[&Channel]| channels.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    let all_of = (across.len() > 1).then_some(&across[..]);
    let reversed = |group: &[&Channel]| mistake("polarity", names_of(group), "reversed", [0.0, -1.0]);
    let mut all = number_mistakes(recording, file);
    for (i, one) in channels.iter().enumerate() {
        // Channels of the two ends, or of the two axes of an end, may be exchanged.
        let may_be = |c: &&Channel| (c.axis == one.axis) != (c.end == one.end);
        for other in channels[i + 1..].iter().filter(may_be) {
            let exchanged = mistake("source", names_of(&[one, other]), "exchanged", [0.0, 1.0]);
            let pairs: [&[&Channel]; 3] = [&[one], &[other], &[one, other]];
            let analyze_corrected = |group: &&[&Channel]| vec![exchanged.clone(), reversed(group)];
            all.extend(pairs.iter().filter(|_| one.axis == other.axis).map(analyze_corrected));
            all.push(vec![exchanged]);
        }
    }
    let along = channels.iter().filter(|c| c.axis == Axis::Axial);
    all.extend(along.map(|axial| vec![reversed(&[axial])]));
    for group in across.chunks(1).chain(all_of) {
        // Message types imply m/s², which not all samples in them have.
        let may_be_implied = |c: &Channel| c.unit != "g" && recording.format == RecordingFormat::Mcap;
        let is_said = |c: &&Channel| c.is_unit_recorded && !may_be_implied(c);
        let as_unit = |factor, correction| vec![mistake("unit", names_of(group), correction, [0.0, factor])];
        let units = [("g", as_unit(G, "taken as g")), ("m/s^2", as_unit(1.0 / G, "taken as m/s²"))];
        let is_open = |unit| group.iter().all(|c| c.unit != unit) && !group.iter().any(is_said);
        all.extend(units.into_iter().filter(|(unit, _)| is_open(*unit)).map(|(_, mistakes)| mistakes));
        let correction = "counted from the other end";
        let from_end = mistake("position_m", names_of(group), correction, [file.cask.length_m, -1.0]);
        all.extend([vec![reversed(group)], vec![from_end]]);
    }
    all
}

/// Sensors on the upper or lower skin that are stated on the axis; the axial channels show it.
fn skin_mistakes(channels: &[Channel], section_m: f64) -> Vec<Mistake> {
    let is_stated = channels.iter().any(|c| c.offset_m != 0.0);
    if is_stated || section_m <= 0.0 || channels.iter().all(|c| c.axis == Axis::Transverse) {
        return Vec::new();
    }
    let names: Vec<String> = channels.iter().map(|c| c.name.clone()).collect();
    let on_skin = |correction, offset_m| mistake("offset_m", names.clone(), correction, [offset_m, 0.0]);
    let half_m = section_m / 2.0;
    let above = on_skin("as half the section (upper skin)", half_m);
    vec![above, on_skin("as minus half the section (lower skin)", -half_m)]
}

/// States a mistake in a key.
fn mistake<C: Into<Cow<'static, str>>>(
    key: &'static str,
    names: Vec<String>,
    correction: C,
    [offset, factor]: [f64; 2],
) -> Mistake {
    Mistake { key, names, correction: correction.into(), offset, factor }
}

/// Lists the angle, heights, lengths and rates that may have another unit or origin.
fn number_mistakes(recording: &Recording, file: &CaskFile) -> Vec<Vec<Mistake>> {
    let angle = |correction, change| vec![mistake("drop.angle_deg", Vec::new(), correction, change)];
    let mut all = vec![angle("counted from the horizontal", [FRAC_PI_2, -1.0])];
    let degrees = 1_f64.to_degrees();
    all.extend((file.drop.angle_rad * degrees < FRAC_PI_2).then(|| angle("in rad", [0.0, degrees])));
    let names: Vec<String> = recording.channels.iter().map(|c| c.name.clone()).collect();
    // Times that the cask file names, or that every message has, confirm a rate unless they contradict it.
    let is_contradicted = |f: &Finding| f.code == IssueCode::Clock && f.severity == Severity::Warning;
    let mut named = file.channels.iter().map(|c| &c.time).chain([&file.time]);
    let is_timed = recording.format == RecordingFormat::Mcap || named.any(Option::is_some);
    let is_stated = file.channels.iter().all(|c| c.sample_rate_hz.is_some());
    if is_stated && (!is_timed || recording.issues.iter().any(is_contradicted)) {
        let rate = |words, factor| vec![mistake("sample_rate_hz", names.clone(), words, [0.0, factor])];
        all.extend([rate("halved", 0.5), rate("doubled", 2.0)]);
    }
    for (correction, factor) in LENGTH_UNITS_M {
        if !file.drop.impact_velocity_given && factor * file.drop.height_m > LEAST_M {
            all.push(vec![mistake("drop.height_m", Vec::new(), correction, [0.0, factor])]);
        }
        let length_m = factor * file.cask.length_m;
        // A place off the cask is refused: if places lie beyond the shorter cask, they have the same unit.
        let is_off = recording.channels.iter().any(|c| c.position_m > length_m);
        let lengths = [("[cask]", Vec::new()), ("position_m", names.clone())];
        let off = lengths.into_iter().take(1 + usize::from(is_off));
        let mistakes = off.map(|(key, names)| mistake(key, names, correction, [0.0, factor])).collect();
        all.extend((length_m > LEAST_M).then_some(mistakes));
    }
    all
}

/// Corrects a mistake.
fn apply_correction(mistake: &Mistake, recording: &mut Recording, file: &mut CaskFile) {
    let Mistake { key, names, offset, factor, .. } = mistake;
    let correct = |x: &mut f64| *x = offset + factor * *x;
    let (cask, drop, channels) = (&mut file.cask, &mut file.drop, &mut recording.channels);
    let own = channels.iter_mut().filter(|c| names.contains(&c.name));
    match *key {
        "drop.angle_deg" => correct(&mut drop.angle_rad),
        "drop.height_m" => {
            drop.height_m *= factor;
            drop.impact_velocity_m_s *= factor.sqrt();
        }
        "[cask]" => {
            [&mut cask.length_m, &mut cask.height_m, &mut cask.cog_m].into_iter().for_each(correct);
            let is_default = file.defaults.iter().any(|key| key == "cask.inertia_kg_m2");
            cask.inertia_kg_m2 *= if is_default { factor * factor } else { 1.0 };
        }
        "source" => exchange(own),
        "cask.length_m" => correct(&mut cask.length_m),
        "cask.height_m" => correct(&mut cask.height_m),
        "cask.cog_m" => correct(&mut cask.cog_m),
        "cask.inertia_kg_m2" => correct(&mut cask.inertia_kg_m2),
        "drop.impact_velocity_m_s" => correct(&mut drop.impact_velocity_m_s),
        "drop.angular_velocity_deg_s" => {
            *drop = drop.add_rotation(cask, offset - drop.angular_velocity_rad_s);
        }
        "offset_m" => own.for_each(|c| correct(&mut c.offset_m)),
        "position_m" => own.for_each(|c| correct(&mut c.position_m)),
        "scale" => own.for_each(|c| correct(&mut c.scale_m_s2)),
        "sample_rate_hz" => own.for_each(|c| correct(&mut c.sample_rate_hz)),
        "time" => own.for_each(|c| correct(&mut c.start_s)),
        // The sensor's limit may be stated in the right or in the wrong unit: the larger value counts.
        _ => own.for_each(|c| {
            correct(&mut c.scale_m_s2);
            c.full_scale = c.full_scale.map(|full_scale| full_scale / factor.abs().min(1.0));
        }),
    }
}

/// Velocity steps of a flight as samples, with the flight and its events.
#[derive(Clone)]
struct StepSamples {
    recording: Recording,
    flight: FlightFit,
    events: Events,
}

/// Stores the velocity steps of the flight as a recording of two samples per channel, the step and its
/// standard uncertainty: a correction changes them without a new analysis.
///
/// A rigid body has such steps in any interval that all channels share; the residual of the fit counts as
/// uncertainty.
fn step_samples(recording: &Recording, result: &DropResult) -> Option<StepSamples> {
    let (flight, events) = (result.flight.clone()?, result.events);
    let mut steps = recording.clone();
    for channel in &mut steps.channels {
        let own = flight.plateau(&channel.name).map(|p| [p.velocity_step_m_s, p.u_m_s.hypot(p.residual_m_s)]);
        let in_unit = own.unwrap_or([f64::NAN; 2]).map(|x| x / channel.scale_m_s2);
        channel.samples = Samples::F64(in_unit.to_vec());
    }
    Some(StepSamples { recording: steps, flight, events })
}

/// True if these steps, with the mistakes corrected, may be those of one rigid body.
fn is_rigid(mistakes: &[Mistake], step_samples: &StepSamples, file: &CaskFile) -> bool {
    let StepSamples { recording: mut steps, mut flight, events } = step_samples.clone();
    let mut stated = file.clone();
    for mistake in mistakes {
        apply_correction(mistake, &mut steps, &mut stated);
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

/// Exchanges the samples of two channels; the cask file's statements on each channel remain, its polarity
/// too.
fn exchange<'a>(mut channels: impl Iterator<Item = &'a mut Channel>) {
    let (Some(one), Some(other)) = (channels.next(), channels.next()) else { return };
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
