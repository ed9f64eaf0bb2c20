//! A trial to the pages that a site signs.

use super::pictures::{fate_words, largest_words, pooled, reading};
use crate::data::Program;
use crate::lab::data::{Trial, TrialLimit, TrialMap, TrialPoint};
use crate::lab::methods::{ALL_CLASSES, WAYS};
use crate::report::document::{
    Chapter, ChapterPart, Fact, Frame, Medium, PartContent, ReportDocument, ReportTable, TableCell,
    TableShape, Tone, Words,
};
use crate::report::record;
use crate::report::rounding::{optional, optional_fixed, plain, significant};
use crate::report::text::Style;

/// Document to sign: outcome, picture, map, limits.
pub(super) fn document(trial: &Trial) -> ReportDocument {
    let [within, choice] = choice(trial);
    let chapters = vec![
        outcome(trial),
        Chapter::new("What is silent, and what to do at the site").with_all(silent_section(trial)),
        Chapter::new("Speed against accuracy")
            .then(ChapterPart::lead(within))
            .then(ChapterPart::picture("speed", ""))
            .then(ChapterPart::text(choice))
            .then(class_table(trial)),
        Chapter::new("What becomes of damages").then(ChapterPart::picture("failures", "")),
        Chapter::new("What is accepted")
            .then(ChapterPart::lead(LIMITS))
            .then(limits(&trial.limits))
            .then(record::signatures(&["Carried out", "Checked"]).only_on(Medium::Page)),
    ];
    ReportDocument {
        page: Frame {
            title: HEADING.to_owned(),
            product: "Validation",
            heading: HEADING.to_owned(),
            about: trial.machine.when.clone(),
            footer: ACCEPTANCE_FOOT,
            style: include_str!("trial.css"),
            ..Frame::default()
        },
        chapters,
    }
}

const HEADING: &str = "Acceptance of dropcheck on this machine";

const LIMITS: &str = "Recordings: of another program. Campaign: random sound drops, the 95th percentile of \
                      each error in half-widths of its interval. Map: the damages. Held: the share of \
                      intervals that hold the truth. All else: the 95th percentile of the error of what the \
                      program takes.";

const ACCEPTANCE_FOOT: &str = "Errors are against truths from outside the methods: drops that another \
                               program simulated, simulated drops that share no formula with \
     the analysis, closed forms. Accepted: every limit holds. A limit that cannot be measured does not hold.";

/// Document for a terminal: the limits, then the outcome.
pub(super) fn verdict(trial: &Trial) -> ReportDocument {
    let chapters = vec![Chapter::new("What is accepted").then(limits(&trial.limits)), banner(trial)];
    ReportDocument { chapters, ..ReportDocument::default() }
}

/// Accepted or not.
fn banner(trial: &Trial) -> Chapter {
    let beyond: Vec<&str> = trial.limits.iter().filter(|l| !l.is_met()).map(|l| &l.name[..]).collect();
    let (kept, all) = (trial.limits.len() - beyond.len(), trial.limits.len());
    let (style, word, words) = if trial.is_accepted() {
        let (silent, seen) = (hidden_damages(trial).len(), seen_words(trial));
        let words = format!(
            "All {all} limits hold, on simulated drops; {silent} kinds of damage can go unnoticed{seen}: \
             check these on site."
        );
        (Style::Green, "ACCEPTED", words)
    } else {
        (Style::Red, "NOT ACCEPTED", format!("{kept} of {all} limits hold. Beyond: {}.", beyond.join("; ")))
    };
    Chapter::new("").then(PartContent::Banner(Tone(style, word.to_owned()), words))
}

/// Accepted or not, with the machine and the program.
fn outcome(trial: &Trial) -> Chapter {
    let slow = "This program was built without optimisation: its times say nothing.";
    let slow = (!trial.machine.is_optimised).then(|| ChapterPart::note(slow));
    let (quick, seed) = (trial.request.choose(" --quick", ""), trial.request.seed);
    let program =
        Program { version: trial.version, commit: trial.machine.program_commit, ..Program::current() };
    let facts = vec![
        Fact::words("program", program.words()),
        Fact::code("its SHA-256", &trial.machine.program_sha256[..]),
        Fact::words("machine", format!("{}, {} threads", trial.machine.processor, trial.machine.cores)),
        Fact::words("system", &trial.machine.system[..]),
        Fact::words("run", format!("{}, {}", trial.request.choose("quick", "full"), trial.machine.when)),
        Fact::code("again", format!("dropcheck validate{quick} --seed {seed} --out validation")),
    ];
    banner(trial).then(ChapterPart::facts("", facts)).with_all(slow)
}

/// Damages that a recording may hide: those of this run, and in a quick one all of the recorded full run.
fn hidden_damages(trial: &Trial) -> Vec<&TrialMap> {
    trial.maps.iter().filter(|map| map.known.is_some() || map.has_silent_drop()).collect()
}

/// Says how many of them a quick run saw; empty for a full one.
fn seen_words(trial: &Trial) -> String {
    let count = trial.maps.iter().filter(|map| map.has_silent_drop()).count();
    trial.request.choose(format!(" (known from a full run; this quick one saw {count})"), String::new())
}

/// Section on the damages that a recording may hide, with the check at the site.
fn silent_section(trial: &Trial) -> [ChapterPart; 2] {
    let hidden = hidden_damages(trial);
    let (count, all, seen) = (hidden.len(), trial.maps.len(), seen_words(trial));
    let words =
        format!("{count} of {all} damages can leave an interval wrong although the data look sound{seen}:");
    let table = ReportTable::from_rows(&hidden)
        .class("many")
        .code("damage", |map| &map.name[..])
        .text("what it is", |map| &map.what[..])
        .text("what becomes of the drops tried (another cask differs)", |map| {
            map.known.map_or_else(|| fate_words(map), |known| known.becomes.into())
        })
        .number("off by, half-widths", |map| {
            map.known.map_or_else(|| largest_words(map), |known| known.off.into())
        })
        .text("in this run", |map| if map.has_silent_drop() { "silent" } else { "not seen" })
        .show_if(trial.request.quick)
        .text("at the site", |map| &map.instead[..]);
    [ChapterPart::lead(words), table.into()]
}

/// Says how accurate the program is, and what the picture means for the user.
fn choice(trial: &Trial) -> [String; 2] {
    let taken = |family| pooled(trial, family).find(|p| p.is_default);
    let Some((speed, k)) = taken(WAYS[0]).zip(taken(WAYS[1])) else {
        return ["No way of working was tried.".to_owned(), String::new()];
    };
    let ms = |time_ns: f64| significant(1e-6 * time_ns, 2);
    let within = format!(
        "What the program takes is within {} % of the speed and {} of k in 95 of 100 drops, {} ms after the \
         file is opened ({} of them reading).",
        significant(speed.p95_error, 2),
        significant(k.p95_error, 2),
        ms(speed.time_ns),
        reading(trial, WAYS[0]).map_or_else(String::new, |p| ms(p.time_ns)),
    );
    let is_class = |p: &&TrialPoint| p.family == WAYS[0] && p.is_default && p.class != ALL_CLASSES;
    let classes: Vec<&str> = trial.points.iter().filter(is_class).map(|p| &p.class[..]).collect();
    // Counts the classes in which both speed and k are as accurate as a verdict needs.
    let met = |way: &TrialPoint| {
        let is_near = |p: &TrialPoint| p.method == way.method && p.p95_error <= p.matters;
        let on = |class: &str, family| {
            trial.points.iter().any(|p| p.class == class && p.family == family && is_near(p))
        };
        classes.iter().filter(|class| on(class, WAYS[0]) && on(class, WAYS[1])).count()
    };
    let Some(other) = pooled(trial, WAYS[0]).find(|p| !p.is_default) else {
        return [within, "No other way was tried: no Python here has numpy and scipy.".to_owned()];
    };
    let choice = format!(
        "Use the program for its intervals and checks, not for accuracy alone: what a verdict needs ({} % of \
         the speed, {} of k) is met in {} of {} classes by the program and in {} by another way ({}; {} ms), \
         which never says when it is not.",
        plain(speed.matters, 2),
        plain(k.matters, 2),
        met(speed),
        classes.len(),
        met(other),
        other.method,
        ms(other.time_ns)
    );
    [within, choice]
}

/// Table of the 95th percentile of each method on each class, for speed and k; coverage of intervals; times.
fn class_table(trial: &Trial) -> ReportTable {
    let rows: Vec<&TrialPoint> = trial.points.iter().filter(|p| p.is_default).collect();
    let mut table = ReportTable::from_rows(&rows)
        .class("many")
        .caption(
            "95th percentile of the error, % of the slap-down speed, and of k as it is; the median \
             half-width that is promised, % of the \
             intervals that hold the truth; no answer in so many drops.",
        )
        .mark_chosen(|row| row.class == ALL_CLASSES)
        .text("", |row| row.family.split(',').next().unwrap_or_default())
        .text("class", |row| &row.class[..]);
    for way in pooled(trial, WAYS[0]) {
        let error = move |row: &&TrialPoint| {
            let is_so = |q: &&TrialPoint| {
                q.family == row.family && q.class == row.class && q.method == way.method && q.cases > 0
            };
            optional(trial.points.iter().find(is_so).map(|q| q.p95_error), 2)
        };
        table = table.number(format!("{}, {} ms", way.method, significant(1e-6 * way.time_ns, 2)), error);
    }
    table
        .number("promised", |row| optional(row.promised, 2))
        .number("held", |row| optional_fixed(row.held.map(|held| 100.0 * held), 0))
        .number("none", |row| row.missing.to_string())
        .into()
}

/// Table of every limit with the measured value; failed limits come first.
fn limits(limits: &[TrialLimit]) -> ReportTable {
    let mut limits: Vec<&TrialLimit> = limits.iter().collect();
    limits.sort_by_key(|limit| limit.is_met());
    // A terminal has no heads.
    let sentence = |word: &str, number: Option<String>| match number {
        Some(number) => Words::with_short(&number[..], format!("{word} {number}")),
        None => "–".into(),
    };
    let bound = |word: &str, bound: Option<f64>| sentence(word, bound.map(|bound| plain(bound, 3)));
    let held = |limit: &TrialLimit| {
        let (style, word) = if limit.is_met() { (Style::Green, "holds") } else { (Style::Red, "BEYOND") };
        TableCell::tone(style, word)
    };
    let why = |limit: &TrialLimit| match &limit.which[..] {
        "" => limit.reason.clone(),
        which => format!("{which}. {}", limit.reason),
    };
    ReportTable::from_rows(&limits)
        .class("many")
        .text("what", |limit| &limit.name[..])
        .number("least", |limit| bound("least", limit.least))
        .number("found", |limit| sentence("found", limit.value.map(|value| significant(value, 3))))
        .number("most", |limit| bound("most", limit.most))
        .text("unit", |limit| &limit.unit[..])
        .line("", |limit| held(limit))
        .text("why", |limit| why(limit))
        .shape(TableShape::Items)
        .into()
}
