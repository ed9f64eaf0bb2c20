//! The first screen, on the terminal and at the head of the page: verdict and cause, numbers, their limits,
//! and the inputs that the recording cannot check.

use super::reconstruction::{assumed, largest, weighty_assumptions};
use super::record::{LIMIT_EXCEEDED, limits_sentence};
use super::rounding::{fixed, interval, pair, percent, significant};
use super::text::{
    Style, causes, dedup, drop_words, grave_findings, or_unknown, paint, plural, sanitize, styled_lines,
    true_minus, verdict_sentence, verdict_style, verdict_word, wrap,
};
use crate::data::{
    Analysis, CaskFile, CheckKind, DropFinding, DropResult, Estimate, Finding, FindingKind, LimitState,
    Method, Rung, Untested,
};
use std::path::Path;

/// Columns that the name of a row takes.
const NAME_WIDTH: usize = 16;

/// Lines of the first screen, unless even its shortest words need more.
const MOST_LINES: usize = 10;

/// Most uncheckable inputs that are named with the effect of a mistake.
const MOST_WITH_EFFECT: usize = 3;

/// A change below this share of the half-width is stated without a number.
const WORTH_A_NUMBER: f64 = 0.1;

/// An input that the recording cannot check, with the change of k and the speed by a mistake in it; the first
/// of a list in full words.
fn with_effect(result: &DropResult, input: &Untested, is_first: bool) -> String {
    let is_worth = |by: f64, stated: Option<Estimate>| stated.is_some_and(|e| by > WORTH_A_NUMBER * e.u95);
    let k = input.moves.k.filter(|k| is_worth(*k, result.k)).map(|k| significant(k, 1));
    let speed = input.moves.slap_down_speed_m_s.filter(|v| is_worth(*v, result.slap_down.speed));
    let speed = speed.map(|m_s| format!("{}\u{a0}m/s", significant(m_s, 1)));
    let (of_k, of_speed, and) = if is_first { ("k by ", "the speed by ", " and ") } else { ("k ", "", ", ") };
    let moves = [k.map(|k| format!("{of_k}{k}")), speed.map(|v| format!("{of_speed}{v}"))];
    let moves = moves.into_iter().flatten().collect::<Vec<_>>().join(and);
    let moved = if is_first { " off moves " } else { ": " };
    // No line ends between a number and its unit.
    format!("{} ({}{moved}{moves})", input.what, input.by.replace(' ', "\u{a0}"))
}

/// Inputs that the recording cannot check, the largest effect first, and the measures that would check them;
/// `None` if all are checked.
pub(super) fn not_checkable(result: &DropResult) -> Option<[String; 2]> {
    let all = &result.untested;
    let (first, others) = all.split_at(all.len().min(MOST_WITH_EFFECT));
    let others = group_by_channel(others.iter().map(|input| &input.what[..]));
    let first = first.iter().enumerate().map(|(i, input)| with_effect(result, input, i == 0));
    let remedies = dedup(all.iter().map(|input| input.remedy));
    let named: Vec<String> = first.chain(others).collect();
    (!named.is_empty()).then(|| [named.join(", "), remedies.join("; ")])
}

/// Counts the inputs that the recording cannot check, and names the three with the largest effect.
fn largest_not_checkable(result: &DropResult, has_effects: bool) -> Option<String> {
    let all = &result.untested;
    let words =
        |(i, input)| if has_effects { with_effect(result, input, i == 0) } else { input.what.clone() };
    let named: Vec<String> = all.iter().take(MOST_WITH_EFFECT).enumerate().map(words).collect();
    let others = if all.len() > MOST_WITH_EFFECT { "; `--full` lists all" } else { "" };
    (!all.is_empty()).then(|| format!("{}: {}{others}", plural(all.len(), "input"), named.join(", ")))
}

/// Combines "tilt of A1", "tilt of A2" and "section" to "tilt of A1, A2" and "section".
fn group_by_channel<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
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

/// Compares measurement and prediction in one sentence: the prediction is not independent of inputs that come
/// from the recording.
fn compared(result: &DropResult, file: &CaskFile, is_short: bool) -> Option<String> {
    let c = result.comparison.as_ref()?;
    let predicted = pair(c.predicted, c.predicted_u95, "m/s");
    let agrees = if c.agrees { "agrees" } else { "disagrees" };
    if is_short {
        return Some(format!("{predicted} by k: {agrees}"));
    }
    let (by, percent) = (measured_inputs(result, file), percent(c.difference_percent));
    let built_in = built_in(result).map_or("", |_| ", partly built in");
    Some(format!("{predicted} {by}: {percent}, {agrees}{built_in}"))
}

/// Names the inputs of the prediction that come from the recording itself: "by measured k, friction".
pub(super) fn measured_inputs(result: &DropResult, file: &CaskFile) -> String {
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
    format!("by measured k{friction}{time}")
}

/// Says how far measurement and prediction agree by construction: a joint fit turns the cask by the impulse
/// of the first impact, as the prediction does.
pub(super) fn built_in(result: &DropResult) -> Option<String> {
    result.comparison.filter(|comparison| comparison.agrees)?;
    let choice = result.reconstruction.as_ref().filter(|c| c.rung == Method::Joint)?;
    let tie = choice.closures.iter().find(|closure| closure.kind == CheckKind::Turning)?;
    let (miss, in_u) = (true_minus(&tie.miss), fixed(tie.miss_in_u.abs(), 1));
    Some(format!("built in: the fit ties the rotation to the impulse ({miss}, {in_u} u without)"))
}

/// Whose speed the slap-down speed is.
pub(super) const RIGID: &str = "of the rigid cask";

/// Says if measured and predicted speed agree.
pub(super) fn agreement(agrees: bool) -> &'static str {
    if agrees { "within both intervals" } else { "beyond both intervals" }
}

/// Sentence on the speed of the corner that strikes, if its ringing moves it off the interval of the rigid
/// body's.
pub(super) fn corner_words(result: &DropResult) -> Option<String> {
    let (local, rigid) = result.slap_down.local_speed.zip(result.slap_down.speed)?;
    let is_apart = (local.value - rigid.value).abs() > rigid.u95;
    is_apart.then(|| interval(Some(&local)))
}

/// Layout of a first screen: the column of its second lines, the omitted parts, and the available lines.
struct Draft {
    indent: usize,
    has_effects: bool,
    is_short: bool,
    causes: usize,
    most_lines: usize,
}

impl Draft {
    /// All drafts, the longest first; if one cause takes more than a screen, `--full` shows it.
    const ALL: [Self; 6] =
        [Self::LONGEST, Self::AT_ONCE, Self::WIDE, Self::SHORT, Self::ONE_CAUSE, Self::LAST];
    const LONGEST: Self = Self {
        indent: NAME_WIDTH,
        has_effects: true,
        is_short: false,
        causes: usize::MAX,
        most_lines: MOST_LINES,
    };
    const AT_ONCE: Self = Self { has_effects: false, ..Self::LONGEST };
    const WIDE: Self = Self { indent: 2, ..Self::AT_ONCE };
    const SHORT: Self = Self { is_short: true, ..Self::WIDE };
    const ONE_CAUSE: Self = Self { causes: 1, most_lines: 16, ..Self::SHORT };
    const LAST: Self = Self { causes: 0, most_lines: usize::MAX, ..Self::SHORT };

    /// A row of as many lines as its words need.
    fn row(&self, name: &str, words: &str, width: usize) -> String {
        let (before, beside) = name.split_at(self.indent.min(name.len()));
        let text = beside.replace(' ', "\u{a0}") + words;
        before.to_owned() + &wrap(&text, width, before.len())[before.len()..]
    }

    fn screen(&self, analysis: &Analysis, report: Option<&str>, width: usize) -> String {
        let (result, file) = (&analysis.result, &analysis.cask_file);
        let row = |name: &str, words: String| self.row(&format!("{name:<NAME_WIDTH$}"), &words, width);
        let limits = limits_sentence(&result.limits, 3);
        let (alarm, limits) = if result.exceeds_a_limit() { (limits, None) } else { (None, limits) };
        let alarm = alarm.map_or_else(String::new, |said| row(LIMIT_EXCEEDED, said));
        let speed = result.slap_down.speed.as_ref();
        let rigid = speed.map_or("", |_| " (rigid cask)");
        let predicted = compared(result, file, self.is_short);
        let (beside, predicted) = if self.is_short {
            (predicted.map(|words| format!("; predicted {words}")), None)
        } else {
            (
                corner_words(result).map(|corner| format!("{rigid}; corner {corner}")).or(Some(rigid.into())),
                predicted,
            )
        };
        let interval_by = assumed(result, file, self.is_short).unwrap_or_else(|| largest(&result.budget));
        let is_number = result.k.is_some() || speed.is_some();
        let rows = [
            ("Slap-down speed", Some(or_unknown(interval(speed)) + &beside.unwrap_or_default())),
            ("Restitution k", Some(or_unknown(interval(result.k.as_ref())))),
            ("Predicted speed", predicted),
            ("Interval (95 %)", Some(interval_by).filter(|words| is_number && !words.is_empty())),
            ("Limits", limits),
            ("Not checkable", largest_not_checkable(result, self.has_effects)),
            // The sentence of a verdict on both numbers names them.
            ("Findings", grave_findings(result).filter(|_| result.k.is_none() || speed.is_none())),
        ];
        let rows = rows.into_iter().filter_map(|(name, words)| Some(row(name, words?)));
        // A path is whole, however long.
        let foot = report.map(|page| format!("{:<NAME_WIDTH$}{}\n", "Report", sanitize(page)));
        let foot = rows.chain(foot).collect::<String>();
        let kind = super::kind::words(result, file).map_or_else(String::new, |kind| wrap(&kind, width, 0));
        kind + &styled_lines(Style::Red, &alarm) + &self.verdict(analysis, width) + &foot
    }

    /// The verdict, the name of the recording, and the causes.
    fn verdict(&self, analysis: &Analysis, width: usize) -> String {
        let (result, file) = (&analysis.result, &analysis.cask_file);
        let word = verdict_word(result.verdict, result.k.or(result.slap_down.speed));
        let path = Path::new(&result.input.recording);
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let heading = if self.is_short {
            format!("{name}.")
        } else {
            format!("{name} ({}, {}).", file.cask.name, drop_words(&file.drop))
        };
        let causes = causes(result);
        let (said, others) = causes.split_at(self.causes.min(causes.len()));
        let others =
            (!others.is_empty()).then(|| format!("{} more with `--full`.", plural(others.len(), "cause")));
        let said = [vec![heading, verdict_sentence(result)], said.to_vec(), others.into_iter().collect()];
        let said = self.row(&format!("{word}  "), &said.concat().join(" "), width);
        paint(verdict_style(result.verdict), word) + &said[word.len()..]
    }
}

/// The first screen: the longest draft within ten lines; `report` is the path of the page.
pub fn first_screen(analysis: &Analysis, report: Option<&str>, width: usize) -> String {
    let drafts = Draft::ALL.iter().map(|draft| (draft, draft.screen(analysis, report, width)));
    let fits = |(draft, screen): &(&Draft, String)| screen.lines().count() <= draft.most_lines;
    drafts.into_iter().find(fits).map(|(_, screen)| screen).unwrap_or_default()
}

/// The reason why a formal report cannot rest on this result, beside its verdict; `None` if it can.
pub fn why_not_strict(analysis: &Analysis) -> Option<String> {
    let result = &analysis.result;
    let open = result.limits.iter().filter(|limit| limit.state != LimitState::Kept).count();
    let weighty = weighty_assumptions(result, &analysis.cask_file);
    let reasons = [
        (result.untested.len(), "untested input", ""),
        (weighty, "default", " with over a tenth of the variance"),
        (open, "limit", " exceeded or undecided"),
    ];
    let reasons = reasons.iter().filter(|(count, ..)| *count > 0);
    let reasons: Vec<String> = reasons.map(|(count, noun, what)| plural(*count, noun) + what).collect();
    (!reasons.is_empty()).then(|| reasons.join(", "))
}
