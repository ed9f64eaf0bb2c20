//! A trial to the pages that a site signs, and to the page of single methods beside their rivals.

use super::pictures::fate_words;
use crate::lab::campaign;
use crate::lab::data::{Trial, TrialFate, TrialLimit, TrialMap, TrialPoint};
use crate::lab::methods::{ALL_CLASSES, READING, WAYS};
use crate::report::document::{Chapter, ChapterPart, Fact, Frame, PartContent, ReportDocument, Tone};
use crate::report::medium::Medium;
use crate::report::rounding::{optional_fixed, plain, significant};
use crate::report::table::{ReportTable, TableCell, TableShape};
use crate::report::text::Style;

/// Errors from here on are words: the method diverged.
const DIVERGED: f64 = 1e6;

/// What is signed: outcome, picture, map, limits.
pub(super) fn document(trial: &Trial) -> ReportDocument {
    let chapters = vec![
        outcome(trial),
        Chapter::new("What is silent, and what to measure instead").with_all(silent(trial)),
        Chapter::new("Speed against accuracy")
            .with(ChapterPart::lead(choice(trial)))
            .with(ChapterPart::picture("speed", "Speed against accuracy", ""))
            .with(by_class(trial)),
        Chapter::new("What becomes of damages").with(ChapterPart::picture(
            "failures",
            "What becomes of damages",
            "",
        )),
        Chapter::new("No more than a scene needs")
            .with(ChapterPart::lead(RUNGS))
            .with_all(campaign::rungs(&trial.campaign)),
        Chapter::new("What is accepted").with(limits(&trial.limits)).with(signatures().only(Medium::Page)),
    ];
    ReportDocument {
        page: frame(trial, "Acceptance of dropcheck on this machine", ACCEPTANCE_FOOT),
        chapters,
    }
}

const RUNGS: &str = "Random sound drops: for each scene the rungs of the reconstruction that were taken; then, for each rung taken, what it and \
                     every higher one say.";

const ACCEPTANCE_FOOT: &str = "Errors are against truths from outside the methods: drops that another program simulated, simulated drops that share no formula with \
     the analysis, closed forms, arithmetic of 106 bits. Accepted: every limit holds. A limit that cannot be measured does not hold.";

/// What a terminal shows: the limits, then the outcome.
pub(super) fn verdict(trial: &Trial) -> ReportDocument {
    let chapters = vec![Chapter::new("What is accepted").with(limits(&trial.limits)), banner(trial)];
    ReportDocument { chapters, ..ReportDocument::default() }
}

/// The page of single methods.
pub(super) fn rivals(trial: &Trial) -> ReportDocument {
    let picture = ChapterPart::picture("rivals", "Methods and their rivals", "");
    let chapters =
        vec![Chapter::new("").with(picture).with(ChapterPart::note("All points: validation.json."))];
    ReportDocument { page: frame(trial, "Single methods beside their rivals", ACCEPTANCE_FOOT), chapters }
}

fn frame(trial: &Trial, heading: &str, footer: &'static str) -> Frame {
    Frame {
        title: heading.to_owned(),
        product: "Validation",
        version: trial.version.to_owned(),
        heading: heading.to_owned(),
        about: run_words(trial),
        footer,
        style: include_str!("trial.css"),
    }
}

fn run_words(trial: &Trial) -> String {
    let (run, machine) = (trial.request.either("Quick", "Full"), &trial.machine);
    format!(
        "{run} run of {}, seed {}, version {}. {}, {} threads, {}.",
        machine.when, trial.request.seed, trial.version, machine.processor, machine.cores, machine.system
    )
}

/// Accepted or not.
fn banner(trial: &Trial) -> Chapter {
    let beyond: Vec<&str> = trial.limits.iter().filter(|l| !l.is_kept()).map(|l| &l.name[..]).collect();
    let (kept, all) = (trial.limits.len() - beyond.len(), trial.limits.len());
    let (style, word, words) = match trial.is_accepted() {
        true => (Style::Green, "ACCEPTED", format!("All {all} limits hold.")),
        false => (
            Style::Red,
            "NOT ACCEPTED",
            format!("{kept} of {all} limits hold. Beyond: {}.", beyond.join("; ")),
        ),
    };
    Chapter::new("").with(PartContent::Banner(Tone(style, word.to_owned()), words))
}

/// Accepted or not, and on what.
fn outcome(trial: &Trial) -> Chapter {
    let slow = "This program was built without optimisation: its times say nothing.";
    let slow = (!trial.machine.is_optimised).then(|| ChapterPart::note(slow));
    let (quick, seed) = (trial.request.either(" --quick", ""), trial.request.seed);
    let facts = vec![
        Fact::words("program", format!("dropcheck {}", trial.version)),
        Fact::words("machine", format!("{}, {} threads", trial.machine.processor, trial.machine.cores)),
        Fact::words("system", &trial.machine.system[..]),
        Fact::words("run", format!("{}, {}", trial.request.either("quick", "full"), trial.machine.when)),
        Fact::code("again", format!("dropcheck validate{quick} --seed {seed} --out validation")),
    ];
    banner(trial).with(ChapterPart::facts("", facts)).with_all(slow)
}

/// The damages that a recording may hide, with what tells them at the site.
fn silent(trial: &Trial) -> [ChapterPart; 2] {
    let hidden: Vec<&TrialMap> =
        trial.maps.iter().filter(|map| map.first(TrialFate::Silent).is_some()).collect();
    let words = match hidden.len() {
        0 => "Nothing that was tried is silent.".to_owned(),
        count => format!(
            "{count} of {} damages can leave an interval wrong although the data look sound. They have to be measured at the site:",
            trial.maps.len()
        ),
    };
    let table = ReportTable::of(&hidden)
        .class("many")
        .code("damage", |map| &map.name[..])
        .text("what it is", |map| &map.what[..])
        .text("silent from", |map| fate_words(map))
        .text("measure instead", |map| &map.instead[..]);
    [ChapterPart::lead(words), table.into()]
}

/// The points of all classes together of a family of ways.
fn pooled<'a>(trial: &'a Trial, family: &'a str) -> impl Iterator<Item = &'a TrialPoint> + Clone {
    trial.points.iter().filter(move |p| p.family == family && p.class == ALL_CLASSES)
}

/// What follows for the user from the picture.
fn choice(trial: &Trial) -> String {
    let ways = pooled(trial, WAYS[0]).filter(|p| p.cases > 0);
    let Some(taken) = ways.clone().find(|p| p.is_default) else {
        return "No way of working was tried.".to_owned();
    };
    let reading = pooled(trial, WAYS[0]).find(|p| p.method == READING).map_or(0.0, |p| p.time_ns);
    let ms = |ns: f64| significant(1e-6 * ns, 2);
    let good: Vec<&TrialPoint> = ways.clone().filter(|p| p.p95_error <= p.matters && !p.is_default).collect();
    let others = match good.iter().min_by(|a, b| a.time_ns.total_cmp(&b.time_ns)) {
        None => format!("no other way keeps within the {} % that a verdict needs", plain(taken.matters, 2)),
        Some(other) => format!(
            "of the others only {} keep within the {} % that a verdict needs, the fastest, {}, in {} ms with {} %",
            good.iter().map(|p| &p.method[..]).collect::<Vec<_>>().join(", "),
            plain(taken.matters, 2),
            other.method,
            ms(other.time_ns),
            significant(other.p95_error, 2)
        ),
    };
    format!(
        "Use what the program takes: within {} % of the speed in 95 of 100 drops, {} ms from file to answer, {} of them for reading alone; {others}.",
        significant(taken.p95_error, 2),
        ms(taken.time_ns),
        ms(reading)
    )
}

/// The 95th percentile of each way on each class.
fn by_class(trial: &Trial) -> ReportTable {
    let ways: Vec<&TrialPoint> =
        WAYS.iter().flat_map(|family| pooled(trial, family)).filter(|p| p.cases > 0).collect();
    let mut classes: Vec<&str> = Vec::new();
    let all = trial.points.iter().filter(|p| p.family == WAYS[0] && p.class != ALL_CLASSES);
    all.for_each(|p| {
        if !classes.contains(&&p.class[..]) {
            classes.push(&p.class)
        }
    });
    let error = |p: &TrialPoint, class: &str| {
        let of =
            trial.points.iter().find(|q| q.family == p.family && q.method == p.method && q.class == class);
        error_words(of.filter(|q| q.cases > 0).map(|q| q.p95_error))
    };
    let mut table = ReportTable::of(&ways)
        .class("many")
        .chosen(|p| p.is_default)
        .text("what", |p| p.family.split(',').next().unwrap_or_default())
        .text("way", |p| &p.method[..]);
    for class in classes {
        table = table.number(class, move |p| error(p, class));
    }
    table
        .number("all", |p| error_words(Some(p.p95_error)))
        .number("held", |p| optional_fixed(p.held.map(|held| 100.0 * held), 0))
        .number("none given", |p| format!("{} of {}", p.missing, p.missing + p.cases))
        .number("ms", |p| significant(1e-6 * p.time_ns, 2))
        .caption("95th percentile of the error: % of the slap-down speed, k as it is. Held: % of the intervals that hold the truth.")
        .into()
}

/// Every limit beside what was found; what is beyond comes first.
fn limits(limits: &[TrialLimit]) -> ReportTable {
    let mut limits: Vec<&TrialLimit> = limits.iter().collect();
    limits.sort_by_key(|limit| limit.is_kept());
    let bound = |bound: Option<f64>| bound.map_or_else(String::new, |bound| plain(bound, 3));
    let held = |limit: &TrialLimit| match limit.is_kept() {
        true => TableCell::toned(Style::Green, "holds"),
        false => TableCell::toned(Style::Red, "BEYOND"),
    };
    let why = |limit: &TrialLimit| match &limit.which[..] {
        "" => limit.reason.clone(),
        which => format!("{which}. {}", limit.reason),
    };
    ReportTable::of(&limits)
        .class("many")
        .text("what", |limit| &limit.name[..])
        .number("least", |limit| bound(limit.least))
        .number("found", |limit| limit.value.map_or_else(|| "–".to_owned(), |value| significant(value, 3)))
        .number("most", |limit| bound(limit.most))
        .text("unit", |limit| &limit.unit[..])
        .text("", |limit| held(limit))
        .text("why", |limit| why(limit))
        .shape(TableShape::Items)
        .into()
}

/// Lines for a pen.
fn signatures() -> ChapterPart {
    ReportTable::of(&["Carried out", "Checked"])
        .class("signatures")
        .head("", |who| *who)
        .text("name", |_| "")
        .text("date", |_| "")
        .text("signature", |_| "")
        .into()
}

/// A number, or that the method diverged.
fn error_words(error: Option<f64>) -> String {
    match error {
        Some(error) if error.is_nan() || error >= DIVERGED => "diverges".to_owned(),
        Some(error) => significant(error, 2),
        None => optional_fixed(None, 0),
    }
}
