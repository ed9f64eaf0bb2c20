//! A trial to the document that `validation.html` shows, and whose extract stands in another document.

use super::failing;
use super::pictures::from_words;
use crate::lab::data::{Trial, TrialMap, TrialPoint};
use crate::report::document::{Chapter, ChapterPart, Frame, PartContent, ReportDocument};
use crate::report::rounding::significant;
use crate::report::table::{ReportTable, TableCell};

/// Errors from here on are words: the method diverged.
const DIVERGED: f64 = 1e6;

/// The whole document.
pub(super) fn document(trial: &Trial) -> ReportDocument {
    let slow = "This program was built without optimisation: its times say nothing.";
    let slow = (!trial.machine.is_optimised).then(|| ChapterPart::note(slow));
    let opening = Chapter::new("")
        .with(PartContent::Figures(figures(trial)))
        .with(ChapterPart::text(extract(trial)))
        .with_all(slow);
    let speed = Chapter::new("Speed against accuracy").with(ChapterPart::picture(
        "speed",
        "Speed against accuracy",
        "",
    ));
    let failures = Chapter::new("Where the program fails")
        .with(ChapterPart::picture("failures", "Where the program fails", ""))
        .with(maps(trial));
    let families = trial.points.chunk_by(|a, b| a.family == b.family).map(family);
    let chapters = [opening, speed].into_iter().chain(families).chain([failures]).collect();
    ReportDocument {
        page: Frame {
            title: "Validation of dropcheck's methods".to_owned(),
            product: "Validation of the methods",
            version: trial.version.to_owned(),
            heading: "Speed against accuracy, and where the program fails".to_owned(),
            about: run_words(trial),
            footer: "Errors are against truths from outside the methods: arithmetic of 106 bits, closed forms, simulated drops that share no \
                     formula with the analysis. A method is on the front where no other of its class is at least as accurate (95th percentile) \
                     and as fast, and better in one; what differs by less than 10 %, and times whose quartiles overlap, count as equal.",
            style: include_str!("trial.css"),
        },
        chapters,
    }
}

fn run_words(trial: &Trial) -> String {
    let (run, machine) = (trial.request.either("Quick", "Full"), &trial.machine);
    let (seed, version) = (trial.request.seed, trial.version);
    format!(
        "{run} run, seed {seed}, version {version}. {}, {} threads, {}.",
        machine.processor, machine.cores, machine.system
    )
}

fn extract(trial: &Trial) -> String {
    let (points, maps) = (trial.points.len(), trial.maps.len());
    let (quick, seed) = (trial.request.either(" --quick", ""), trial.request.seed);
    format!(
        "{points} points of methods and classes, {maps} failure maps. {} Again: `dropcheck validate{quick} --seed {seed} --out validation`.",
        run_words(trial)
    )
}

fn figures(trial: &Trial) -> Vec<[String; 3]> {
    let defaults = || trial.points.iter().filter(|p| p.is_default);
    let on_front = defaults().filter(|p| p.is_on_front).count();
    let failing_maps = trial.maps.iter().filter(|map| failing(map).next().is_some()).count();
    let unnoticed = trial.maps.iter().filter(|map| failing(map).any(|at| !at.is_noticed)).count();
    let figure = |name: &str, value: String, note: &str| [name.to_owned(), value, note.to_owned()];
    vec![
        figure("Methods × classes", trial.points.len().to_string(), "each beside its rivals"),
        figure("Defaults on the front", format!("{on_front} of {}", defaults().count()), "of their class"),
        figure("Failure maps", trial.maps.len().to_string(), &format!("{failing_maps} with a failure")),
        figure("Failures without notice", unnoticed.to_string(), "maps with a size of which nothing is said"),
    ]
}

/// What is best in a family, and where the default is not; all points are in validation.json.
fn family(points: &[TrialPoint]) -> Chapter {
    let TrialPoint { family, error_unit, time_per, .. } = &points[0];
    let shown: Vec<&TrialPoint> = points.iter().filter(|p| p.is_on_front || p.is_default).collect();
    let default =
        |p: &TrialPoint| TableCell::marked(p.method.clone(), if p.is_default { "default" } else { "" });
    let table = ReportTable::of(&shown)
        .class("many")
        .chosen(|p| p.is_default)
        .text("class", |p| &p.class[..])
        .text("method", |p| default(p))
        .number(format!("median error, {error_unit}"), |p| error_words(Some(p.median_error)))
        .number("95 %", |p| error_words(Some(p.p95_error)))
        .number(format!("ns a {time_per}"), |p| significant(p.time_ns, 3))
        .text("front", |p| if p.is_on_front { "yes" } else { "no" });
    let beaten = points.iter().filter(|p| p.is_default && !p.is_on_front).map(|p| &p.class[..]);
    let beaten = beaten.collect::<Vec<_>>().join("; ");
    let place = (!beaten.is_empty()).then(|| {
        ChapterPart::text(format!(
            "The default is off the front in: {beaten}. Why it is taken all the same: docs/validation.md, Methods."
        ))
    });
    Chapter::new(&family[..]).below().with(table).with_all(place)
}

/// From where on each map fails, and whether that was noticed.
fn maps(trial: &Trial) -> ChapterPart {
    let noticed = |map: &TrialMap| {
        let (all, said) = (failing(map).count(), failing(map).filter(|at| at.is_noticed).count());
        match (all, said) {
            (0, _) => "–".to_owned(),
            (all, said) if all == said => "yes".to_owned(),
            (_, 0) => "NO".to_owned(),
            (all, said) => format!("{said} of {all}"),
        }
    };
    let worst = |map: &TrialMap| map.sizes.iter().filter_map(|at| at.worst_error).reduce(f64::max);
    ReportTable::of(&trial.maps)
        .class("many")
        .text("map", |map| &map.name[..])
        .text("what", |map| &map.what[..])
        .text("what is off", |map| format!("{}, limit {}", map.error, significant(map.limit, 2)))
        .number("fails from", |map| {
            failing(map).next().map_or_else(|| "holds".to_owned(), |at| from_words(map, at))
        })
        .number("largest error", |map| error_words(worst(map)))
        .text("noticed", noticed)
        .into()
}

/// A number, or that the method diverged.
fn error_words(error: Option<f64>) -> String {
    match error {
        Some(error) if error.is_nan() || error >= DIVERGED => "diverges".to_owned(),
        Some(error) => significant(error, 2),
        None => "–".to_owned(),
    }
}
