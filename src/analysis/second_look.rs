//! Repeats an analysis that contradicts itself without one of its channels, if the result is then consistent.

use super::analyse_once;
use super::flight_search::SearchEffort;
use crate::data::{
    Analysis, Axis, CaskFile, ChannelFinding, DECISIVE_CHI_SQUARE, DropFinding, Effect, Finding, FindingKind,
    IssueCode, MISSED_U, OpenedInput, Recording, Severity,
};
use crate::judge;

/// Largest recording that is analysed again, in samples: that takes as much memory once more, and some twenty
/// times as long.
const MOST_SAMPLES: usize = 5_000_000;
/// Largest number of channels for that: each is left out once, and exchanged with each of the other end.
const MOST_CHANNELS_TRIED: usize = 8;

/// Findings and failed checks that contradict an analysis.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(super) struct Inconsistency {
    pub errors: usize,
    pub warnings: usize,
    pub chi_square: f64,
}

impl Inconsistency {
    pub fn measure(analysis: &Analysis) -> Self {
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

fn lacks_end(finding: &Finding) -> bool {
    finding.code == IssueCode::MissingChannel
}

/// True if nothing contradicts the motion; with channels at one end only there is no slap-down to compare.
pub(super) fn is_consistent(analysis: &Analysis) -> bool {
    let result = &analysis.result;
    let is_one_ended = result.quality.iter().any(lacks_end);
    let agrees = is_one_ended || result.comparison.is_some_and(|comparison| comparison.agrees);
    let meets = |closures: &[crate::data::Consistency]| closures.iter().all(|c| c.miss_in_u.abs() < MISSED_U);
    let is_sound = result.quality.iter().all(|f| f.severity < Severity::Error || lacks_end(f));
    is_sound && agrees && result.reconstruction.as_ref().is_some_and(|choice| meets(&choice.closures))
}

/// Returns `found`, or the analysis without the one transverse channel that the others and the checks
/// contradict, independent of the order of all.
pub(super) fn leave_one_out(recording: &Recording, file: &CaskFile, found: Analysis) -> Analysis {
    // A warning that contradicts neither the motion nor the other channels has another reason.
    let result = &found.result;
    let is_off_line = |f: &Finding| f.code == IssueCode::NotRigid && f.severity > Severity::Note;
    let has_numbers = result.slap_down.speed.is_some() && result.k.is_some();
    let is_doubted = !has_numbers || !is_consistent(&found) || result.quality.iter().any(is_off_line);
    let across = recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let spare: Vec<&str> = across.map(|c| c.name.as_str()).collect();
    // A flight too short for its modes contradicts nothing; with one channel less it is fitted by fewer
    // modes.
    let is_short = |f: &Finding| matches!(f.what, FindingKind::Drop(DropFinding::Unresolved { .. }));
    let is_doubted = is_doubted && !result.quality.iter().any(is_short);
    if !is_doubted || spare.len() < 3 || is_too_large(recording) {
        return found;
    }
    let without = |name: &&str| {
        let mut others = recording.clone();
        others.channels.retain(|channel| channel.name != *name);
        others.issues.retain(|issue| issue.channel.as_deref() != Some(name));
        let analysis = analyse_once(&others, file, SearchEffort::FirstStart);
        (Inconsistency::measure(&analysis), (*name).to_owned(), analysis)
    };
    let mut tried: Vec<_> = spare.iter().map(without).collect();
    tried.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
    let before = Inconsistency::measure(&found);
    let is_alone = |best: &Inconsistency, next: &Inconsistency| {
        (next.errors, next.warnings) > (best.errors, best.warnings)
            || next.chi_square > best.chi_square + DECISIVE_CHI_SQUARE
    };
    let is_clear = tried.split_first().is_some_and(|((least, _, better), others)| {
        is_consistent(better)
            && (least.errors, least.warnings) < (before.errors, before.warnings)
            && others.iter().all(|(other, ..)| is_alone(least, other))
    });
    // If the scale or place of another channel explains much more, that channel disagrees.
    let is_other = |name: &str| {
        let least = |is_own: bool| {
            let counts = |o: &&OpenedInput| o.channel.as_deref().is_some_and(|n| (n == name) == is_own);
            found.opened_inputs.iter().filter(counts).map(|o| o.chi_square).fold(f64::INFINITY, f64::min)
        };
        least(false) + DECISIVE_CHI_SQUARE < least(true)
    };
    let remains = |(_, name, without): &(Inconsistency, String, Analysis)| {
        *name != tried[0].1 && is_alone_at_its_end(recording, name) && !is_refuted(without)
    };
    if !is_clear || is_other(&tried[0].1) || tried.iter().any(remains) {
        return found;
    }
    let (_, name, mut better) = tried.swap_remove(0);
    better.opened_inputs.clone_from(&found.opened_inputs);
    // A limit or a broken cable of the omitted channel is the reason why it disagrees.
    let is_cause = |f: &&Finding| {
        matches!(f.effect, Effect::VelocityStep | Effect::Disturbance) || f.code == IssueCode::Electrical
    };
    let causes = found.result.quality.iter().filter(|f| f.channel.as_ref() == Some(&name)).filter(is_cause);
    let as_warning = |f: &Finding| {
        let severity = f.severity.min(Severity::Warning);
        Finding { severity, effect: Effect::Channel, ..f.clone() }
    };
    better.result.quality.extend(causes.map(as_warning));
    let speed_and_k = |analysis: &Analysis| (analysis.result.slap_down.speed, analysis.result.k);
    let finding =
        ChannelFinding::LeftOut { with: speed_and_k(&found), without: speed_and_k(&better) }.tag(&name);
    better.result.quality.push(finding);
    better.result.verdict = judge::verdict(&mut better.result.quality);
    better
}

/// True if no other transverse channel sits on a channel's end.
fn is_alone_at_its_end(recording: &Recording, name: &str) -> bool {
    let mut across = recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let own = across.clone().find(|c| c.name == name);
    own.is_some_and(|own| across.all(|c| c.name == name || c.end != own.end))
}

/// True if the other channels contradict one another without the omitted one: otherwise, or if they are too
/// few to say, that one may be at fault as well.
fn is_refuted(without: &Analysis) -> bool {
    let contradicts = |f: &Finding| match f.severity {
        Severity::Error => !lacks_end(f),
        severity => severity > Severity::Note && matches!(f.code, IssueCode::NotRigid | IssueCode::Geometry),
    };
    without.result.quality.iter().any(contradicts)
}

pub(super) fn is_too_large(recording: &Recording) -> bool {
    let samples: usize = recording.channels.iter().map(|c| c.samples.len()).sum();
    recording.channels.len() > MOST_CHANNELS_TRIED || samples > MOST_SAMPLES
}
