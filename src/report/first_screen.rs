//! What stands first, on the terminal and at the head of the page: the verdict and its cause, the numbers,
//! what limits them, and what nothing in the recording tests.

use super::reconstruction::{defaults_that_weigh, largest, weighty_defaults};
use super::record::{LIMIT_EXCEEDED, limits_said};
use super::rounding::{fixed, interval, pair, percent, significant};
use super::text::{
    Style, causes, clamped, counted, determined, distinct, dropped, json_word, printable, styled,
    styled_lines, tail, true_minus, verdict_sentence, verdict_style, verdict_word,
};
use crate::data::{
    Analysis, CaskFile, ClosureKind, DropFinding, DropResult, Estimate, Finding, FindingKind, LimitState,
    ReconstructionRung, Rung, Severity, Untested,
};

/// Columns that the name of a row takes.
const NAME_WIDTH: usize = 16;

/// Lines of the first screen.
const MOST_LINES: usize = 16;

/// So many untested inputs are named with what a mistake in them does; the others by their names alone.
const MOST_WITH_EFFECT: usize = 3;

/// A move below this share of the half-width is not worth a number.
const WORTH_A_NUMBER: f64 = 0.1;

/// What nothing in the recording tests, by how much a mistake in it moves k and the speed, and what tests it;
/// `None` where all is tested.
pub(super) fn untested(result: &DropResult) -> Option<[String; 2]> {
    let effect = |input: &Untested| {
        let is_worth =
            |by: f64, stated: Option<Estimate>| stated.is_some_and(|e| by > WORTH_A_NUMBER * e.u95);
        let k = input.moves.k.filter(|k| is_worth(*k, result.k));
        let speed = input.moves.slap_down_speed_m_s.filter(|v| is_worth(*v, result.slap_down.speed));
        let moves = [
            k.map(|k| format!("k\u{a0}{}", significant(k, 1))),
            speed.map(|m_s| format!("{}\u{a0}m/s", significant(m_s, 1))),
        ];
        let moves: Vec<String> = moves.into_iter().flatten().collect();
        // No line ends between a number and its unit.
        format!("{} ({} off: {})", input.what, input.by.replace(' ', "\u{a0}"), moves.join(", "))
    };
    let all = &result.untested;
    let (first, others) = all.split_at(all.len().min(MOST_WITH_EFFECT));
    let others = by_channels(others.iter().map(|input| &input.what[..]));
    let named: Vec<String> = first.iter().map(effect).chain(others).collect();
    let remedies = distinct(all.iter().map(|input| input.remedy));
    (!named.is_empty()).then(|| [named.join(", "), remedies.join("; ")])
}

/// "tilt of A1", "tilt of A2" and "section" to "tilt of A1, A2" and "section".
fn by_channels<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut kinds: Vec<(&str, Vec<&str>)> = Vec::new();
    for name in names {
        let (kind, channel) = name.rsplit_once(" of ").unwrap_or((name, ""));
        match kinds.iter_mut().find(|(known, channels)| *known == kind && !channels[0].is_empty()) {
            Some((_, channels)) => channels.push(channel),
            None => kinds.push((kind, vec![channel])),
        }
    }
    let words = |(kind, channels): (&str, Vec<&str>)| match channels[..] {
        [""] => kind.to_owned(),
        _ => format!("{kind} of {}", channels.join(", ")),
    };
    kinds.into_iter().map(words).collect()
}

/// Measured beside predicted, in one sentence: the prediction is no second witness of what it takes from the
/// recording.
fn compared(result: &DropResult, file: &CaskFile) -> Option<String> {
    let c = result.comparison.as_ref()?;
    let predicted = pair(c.predicted, c.predicted_u95, "m/s");
    let agrees = if c.agrees { "agrees" } else { "disagrees" };
    let built_in = built_in(result).map_or("", |_| ", partly built in (the fit ties rotation to impulse)");
    let (by, percent) = (by_measured(result, file), percent(c.difference_percent));
    Some(format!("{predicted} {by}; {percent}: {agrees}{built_in}"))
}

/// What the prediction takes from the recording that it is held against: "by the measured k, friction".
pub(super) fn by_measured(result: &DropResult, file: &CaskFile) -> String {
    let rung = result.model.as_ref().map_or(Rung::Rod, |model| model.rung);
    let is_open = |f: &Finding| matches!(f.what, FindingKind::Drop(DropFinding::OpenContact { .. }));
    let friction = if !file.has_open_friction() || rung < Rung::Friction {
        ""
    } else if result.quality.iter().any(is_open) {
        ", the friction taken"
    } else {
        ", friction"
    };
    let time = if rung == Rung::FinitePulse { ", contact time" } else { "" };
    format!("by the measured k{friction}{time}")
}

/// What makes measurement and prediction agree by itself, and by how much: a joint fit turns the cask by the
/// impulse of the first impact, as the prediction does.
pub(super) fn built_in(result: &DropResult) -> Option<String> {
    result.comparison.filter(|comparison| comparison.agrees)?;
    let choice = result.reconstruction.as_ref().filter(|c| c.rung == ReconstructionRung::Joint)?;
    let tie = choice.closures.iter().find(|closure| closure.kind == ClosureKind::Turning)?;
    let (miss, in_u) = (true_minus(&tie.miss), fixed(tie.miss_in_u.abs(), 1));
    Some(format!("built in: the fit ties the rotation to the impulse ({miss}, {in_u} u without)"))
}

/// Whose speed the slap-down speed is.
pub(super) const RIGID: &str = "of the rigid cask";

/// Whether measured and predicted speed agree.
pub(super) fn agreement(agrees: bool) -> &'static str {
    if agrees { "within both intervals" } else { "beyond both intervals" }
}

/// "2 warnings (`zero_shift` A1, gap A2), 3 notes".
fn findings(result: &DropResult) -> String {
    let place = |f: &Finding| match &f.channel {
        Some(channel) => format!("{} {channel}", json_word(f.code)),
        None => json_word(f.code),
    };
    let of_severity = |severity| {
        let all = || result.quality.iter().filter(|f| f.severity == severity);
        let places = if severity == Severity::Note { Vec::new() } else { distinct(all().map(place)) };
        let places = if places.is_empty() { String::new() } else { format!(" ({})", places.join(", ")) };
        all().next().map(|_| counted(all().count(), &json_word(severity)) + &places)
    };
    let all: Vec<String> =
        [Severity::Error, Severity::Warning, Severity::Note].into_iter().filter_map(of_severity).collect();
    if all.is_empty() { "none".into() } else { all.join(", ") }
}

/// A line of the first screen, or as many as its words need and it may have.
fn row(name: &str, words: &str, width: usize, most: usize) -> String {
    let words = clamped(words, width, NAME_WIDTH, most);
    format!("{name:<NAME_WIDTH$}{}", &words[NAME_WIDTH..])
}

/// The speed of the corner that strikes where its ringing moves it off the interval of the rigid body's.
pub(super) fn of_corner(result: &DropResult) -> Option<String> {
    let (local, rigid) = result.slap_down.local_speed.zip(result.slap_down.speed)?;
    let is_apart = (local.value - rigid.value).abs() > rigid.u95;
    is_apart.then(|| interval(Some(&local)) + " as it strikes, ringing included")
}

/// The first screen, in at most 16 lines of 80 columns; `report` is where the page was written.
pub fn first_screen(analysis: &Analysis, report: Option<&str>, width: usize) -> String {
    let (result, file) = (&analysis.result, &analysis.cask_file);
    let recording = tail(&result.input.recording, 40);
    let title = format!("{} · {} · {recording}", file.cask.name, dropped(&file.drop));
    let kind = super::kind::words(result, file).map_or_else(String::new, |kind| clamped(&kind, width, 0, 3));
    let title = kind + &styled_lines(Style::Bold, &clamped(&title, width, 0, 1));
    let limits = limits_said(&result.limits, 3);
    let (alarm, limits) = if result.exceeds_a_limit() { (limits, None) } else { (None, limits) };
    let alarm = alarm.map_or_else(String::new, |said| row(LIMIT_EXCEEDED, &said, width, 5));
    let speed = result.slap_down.speed.as_ref();
    let holds = speed.map_or_else(String::new, |_| format!(" {RIGID} (± holds 95 %)"));
    let interval_by = defaults_that_weigh(result, file).unwrap_or_else(|| largest(&result.budget));
    let is_number = result.k.is_some() || speed.is_some();
    let rows = [
        ("Slap-down speed", Some(determined(interval(speed)) + &holds), 1),
        ("Speed of corner", of_corner(result), 1),
        ("Restitution k", Some(determined(interval(result.k.as_ref()))), 1),
        ("Predicted speed", compared(result, file), if result.exceeds_a_limit() { 1 } else { 2 }),
        ("Assumed", super::record::assumed(file, &result.budget), 2),
        ("Interval", Some(interval_by).filter(|_| is_number), if result.limits.is_empty() { 3 } else { 1 }),
        ("Limits", limits, 5),
    ];
    let said = rows.into_iter().filter_map(|(name, words, most)| Some((name, words?, most)));
    let numbers = said.filter(|(_, words, _)| !words.is_empty());
    let numbers: String = numbers.map(|(name, words, most)| row(name, &words, width, most)).collect();
    let foot = row("Findings", &findings(result), width, 1)
        // A path is whole, however long.
        + &report.map_or_else(String::new, |page| format!("{:<NAME_WIDTH$}{}\n", "Report", printable(page)));
    let lines = |text: &str| text.lines().count();
    // Where nothing else is to be said the causes have room for their remedies.
    let (untested, most) = (untested(result), if result.untested.is_empty() { MOST_LINES } else { 3 });
    let others = lines(&title) + lines(&alarm) + lines(&numbers) + lines(&foot);
    let others = others + if untested.is_some() { 2 } else { 0 };
    let word = verdict_word(result.verdict, result.k.or(result.slap_down.speed));
    let most = most.min(MOST_LINES.saturating_sub(others).max(1));
    let said = [vec![verdict_sentence(result)], causes(result)].concat().join(" ");
    let said = clamped(&said, width, word.len() + 2, most);
    let verdict = styled(verdict_style(result.verdict), word) + &said[word.len()..];
    let before = title + &styled_lines(Style::Red, &alarm) + &verdict + &numbers;
    let tested = untested.map_or_else(String::new, |[named, remedies]| {
        let named = format!("± covers tolerances; larger errors show nowhere: {named}");
        let left = MOST_LINES.saturating_sub(lines(&before) + lines(&foot)).max(2);
        let free = left.saturating_sub(lines(&row("", &named, width, left)));
        let remedies = row("To test them", &remedies, width, free.max(2).min(left - 1));
        row("Untested here", &named, width, left.saturating_sub(lines(&remedies)).max(1)) + &remedies
    });
    before + &tested + &foot
}

/// Why a formal report cannot rest on this result, beside its verdict; `None` where it can.
pub fn not_strict(analysis: &Analysis) -> Option<String> {
    let result = &analysis.result;
    let open = result.limits.iter().filter(|limit| limit.state != LimitState::Kept).count();
    let weighty = weighty_defaults(result, &analysis.cask_file).len();
    let reasons = [
        (result.untested.len(), "untested input", ""),
        (weighty, "default", " with over a tenth of the variance"),
        (open, "limit", " exceeded or undecided"),
    ];
    let reasons = reasons.iter().filter(|(count, ..)| *count > 0);
    let reasons: Vec<String> = reasons.map(|(count, noun, what)| counted(*count, noun) + what).collect();
    (!reasons.is_empty()).then(|| reasons.join(", "))
}
