//! An analysis that something speaks against to the same without one channel, or with one usual slip put right, where all then closes.

use super::analyzed;
use crate::data::{
    Analysis, Axis, CaskFile, ChannelFinding, DropFinding, End, Estimate, Finding, IssueCode, MISSED_U,
    Recording, STANDARD_GRAVITY_M_S2, Severity, Slip,
};
use crate::judge;
use std::f64::consts::FRAC_PI_2;

/// Recordings with more samples are not gone through again: that takes as much memory once more, and some twenty times as long.
const MOST_SAMPLES: usize = 5_000_000;
/// Nor are those of more channels: each is left out once, and exchanged with each of the other end.
const MOST_CHANNELS_TRIED: usize = 8;
/// χ² of the closures by which another channel must close worse: chance gives three standard deviations to one in 400.
const CLEARLY: f64 = 9.0;

/// How much speaks against an analysis.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Doubt {
    errors: usize,
    warnings: usize,
    chi_square: f64,
}

impl Doubt {
    fn of(analysis: &Analysis) -> Self {
        let result = &analysis.result;
        let count = |severity| result.quality.iter().filter(|f| f.severity == severity).count();
        let closures = result.reconstruction.as_ref().map(|choice| &choice.closures);
        Self {
            errors: count(Severity::Error),
            warnings: count(Severity::Warning),
            chi_square: closures.map_or(f64::INFINITY, |all| all.iter().map(|c| c.miss_in_u.powi(2)).sum()),
        }
    }
}

/// Whether nothing is left that the motion contradicts; an end without a channel shows no slap-down to compare.
fn closes(analysis: &Analysis) -> bool {
    let result = &analysis.result;
    let lacks_end = |f: &Finding| f.code == IssueCode::MissingChannel;
    let is_one_ended = result.quality.iter().any(lacks_end);
    let agrees = is_one_ended || result.comparison.is_some_and(|comparison| comparison.agrees);
    let meets = |closures: &[crate::data::Closure]| closures.iter().all(|c| c.miss_in_u.abs() < MISSED_U);
    let is_sound = result.quality.iter().all(|f| f.severity < Severity::Error || lacks_end(f));
    is_sound && agrees && result.reconstruction.as_ref().is_some_and(|choice| meets(&choice.closures))
}

/// `found`, or what is found without the one transverse channel that the others and the closures speak against, whatever the order of all.
pub(super) fn without_one(recording: &Recording, file: &CaskFile, found: Analysis) -> Analysis {
    let is_doubted = found.result.quality.iter().any(|f| f.severity > Severity::Note);
    let across = recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let spare: Vec<&str> = across.map(|c| c.name.as_str()).collect();
    if !is_doubted || spare.len() < 3 || is_too_large(recording) {
        return found;
    }
    let without = |name: &&str| {
        let mut others = recording.clone();
        others.channels.retain(|channel| channel.name != *name);
        others.issues.retain(|issue| issue.channel.as_deref() != Some(name));
        let analysis = analyzed(&others, file);
        (Doubt::of(&analysis), (*name).to_owned(), analysis)
    };
    let mut tried: Vec<_> = spare.iter().map(without).collect();
    tried.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
    let before = Doubt::of(&found);
    let is_alone = |best: &Doubt, next: &Doubt| {
        (next.errors, next.warnings) > (best.errors, best.warnings)
            || next.chi_square > best.chi_square + CLEARLY
    };
    let is_told = match &tried[..] {
        [(doubt, _, better), others @ ..] => {
            closes(better)
                && (doubt.errors, doubt.warnings) < (before.errors, before.warnings)
                && others.iter().all(|(other, ..)| is_alone(doubt, other))
        }
        [] => false,
    };
    if !is_told {
        return found;
    }
    let (_, name, mut better) = tried.swap_remove(0);
    let of = |analysis: &Analysis| (analysis.result.slap_down.speed, analysis.result.k);
    let finding = ChannelFinding::LeftOut { with: of(&found), without: of(&better) }.on(&name);
    add(&mut better, finding);
    better
}

/// Adds the usual slip with which everything closes, where an error stands.
pub(super) fn name_slip(recording: &Recording, file: &CaskFile, found: &mut Analysis) {
    let Some(severity) = severity_of_doubt(&found.result.quality).filter(|_| !is_too_large(recording)) else {
        return;
    };
    let mut tried = recording.clone();
    let mut best: Option<(Doubt, Slip, [Option<Estimate>; 2])> = None;
    for slip in slips(recording) {
        let mut stated = file.clone();
        put_right(&slip, &mut tried, &mut stated);
        let analysis = analyzed(&tried, &stated);
        // Every slip undoes itself.
        put_right(&slip.undone(), &mut tried, &mut stated);
        let doubt = Doubt::of(&analysis);
        if closes(&analysis) && best.as_ref().is_none_or(|(least, ..)| doubt < *least) {
            best = Some((doubt, slip, [analysis.result.slap_down.speed, analysis.result.k]));
        }
    }
    if let Some((_, slip, [speed, k])) = best {
        add(found, DropFinding::UsualSlip { slip, speed, k, severity }.into());
    }
}

/// How much weighs what a slip may be behind: errors of the motion and no other, or a warning on what the cask file says of the channels.
fn severity_of_doubt(findings: &[Finding]) -> Option<Severity> {
    use IssueCode::{
        EndsEarly, EndsExchanged, FlightFit, Geometry, NoImpact, NoSlapDown, NotRigid, Polarity,
        RestitutionRange, Scale, SensorPosition,
    };
    let is_stated = |f: &&Finding| matches!(f.code, Geometry | NotRigid | Scale | SensorPosition);
    let is_of_motion = |f: &Finding| {
        let code = f.code;
        is_stated(&f)
            || matches!(
                code,
                EndsEarly | EndsExchanged | FlightFit | NoImpact | NoSlapDown | Polarity | RestitutionRange
            )
    };
    let mut errors = findings.iter().filter(|f| f.severity == Severity::Error).peekable();
    if errors.peek().is_some() {
        // No slip gives back what a clipped or dead channel lost.
        return errors.all(is_of_motion).then_some(Severity::Error);
    }
    let warns = findings.iter().filter(is_stated).any(|f| f.severity == Severity::Warning);
    warns.then_some(Severity::Warning)
}

fn is_too_large(recording: &Recording) -> bool {
    let samples: usize = recording.channels.iter().map(|c| c.samples.len()).sum();
    recording.channels.len() > MOST_CHANNELS_TRIED || samples > MOST_SAMPLES
}

/// Adds a finding, and weighs all of them again.
fn add(analysis: &mut Analysis, finding: Finding) {
    analysis.result.quality.push(finding);
    analysis.result.verdict = judge::verdict(&mut analysis.result.quality);
}

/// What is usually confused, one at a time.
fn slips(recording: &Recording) -> Vec<Slip> {
    let across = || recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let names: Vec<String> = across().map(|c| c.name.clone()).collect();
    let mut all = vec![Slip::AngleFromVertical];
    let on = |end: End| across().filter(move |c| c.end == end);
    for first in on(End::First) {
        all.extend(on(End::Second).map(|second| Slip::Exchanged([first.name.clone(), second.name.clone()])));
    }
    let groups = names.iter().map(|name| vec![name.clone()]).chain((names.len() > 1).then(|| names.clone()));
    for group in groups {
        all.push(Slip::Polarity(group.clone()));
        all.push(Slip::FromOtherEnd(group.clone()));
        all.push(Slip::UnitIsG(group.clone()));
        all.push(Slip::UnitIsMetric(group));
    }
    all
}

/// Puts a slip right.
fn put_right(slip: &Slip, recording: &mut Recording, file: &mut CaskFile) {
    let length_m = file.cask.length_m;
    let channels = &mut recording.channels;
    let mut each = |names: &[String], change: &dyn Fn(&mut crate::data::Channel)| {
        channels.iter_mut().filter(|c| names.contains(&c.name)).for_each(change);
    };
    match slip {
        Slip::AngleFromVertical => file.drop.angle_rad = FRAC_PI_2 - file.drop.angle_rad,
        Slip::Polarity(names) => each(names, &|c| c.scale_m_s2 = -c.scale_m_s2),
        Slip::FromOtherEnd(names) => each(names, &|c| c.position_m = length_m - c.position_m),
        Slip::UnitIsG(names) => each(names, &|c| c.scale_m_s2 *= STANDARD_GRAVITY_M_S2),
        Slip::UnitIsMetric(names) => each(names, &|c| c.scale_m_s2 /= STANDARD_GRAVITY_M_S2),
        Slip::Exchanged([first, second]) => {
            let places = [first, second].map(|name| channels.iter().position(|c| c.name == *name));
            let [Some(a), Some(b)] = places else { return };
            let Ok([one, other]) = channels.get_disjoint_mut([a, b]) else { return };
            // The samples change places, and what was said of where they come from stays.
            std::mem::swap(one, other);
            std::mem::swap(&mut one.name, &mut other.name);
            std::mem::swap(&mut one.end, &mut other.end);
            std::mem::swap(&mut one.position_m, &mut other.position_m);
            std::mem::swap(&mut one.offset_m, &mut other.offset_m);
        }
    }
}
