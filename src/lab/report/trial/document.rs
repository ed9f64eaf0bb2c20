//! A trial to the document that `validation.html` shows, and whose extract stands in another document; charts first.

use super::breaks;
use super::failure_chart;
use super::families::{Family, families};
use super::reasons::reason;
use crate::lab::data::{Trial, TrialMap, TrialPoint};
use crate::report::document::{Chapter, ChapterPart, Fact, Frame, PartContent, ReportDocument};
use crate::report::medium::{Medium, Words};
use crate::report::rounding::significant;
use crate::report::table::{ReportTable, TableCell};

/// Errors from here on are words: the method diverged.
const DIVERGED: f64 = 1e6;

/// The whole document.
pub(super) fn document(trial: &Trial) -> ReportDocument {
    let families = families(trial);
    let slow = "This program was built without optimisation: its times say nothing.";
    let slow = (!trial.machine.is_optimised).then(|| ChapterPart::note(slow));
    let opening = Chapter::new("")
        .with(PartContent::Figures(figures(trial, &families)))
        .with(ChapterPart::text(extract(trial)).only(Medium::Markdown))
        .with_all(slow);
    let mut chapters = vec![opening, Chapter::part("Speed against accuracy")];
    chapters.extend(families.iter().map(family_chapter));
    chapters.push(Chapter::part("Where methods fail"));
    chapters.extend(trial.maps.iter().map(map_chapter));
    let points = families.iter().map(|family| points(family, &family.points));
    chapters.push(Chapter::new("All points").only(Medium::Page).with_all(points));
    chapters.push(provenance(trial));
    ReportDocument {
        page: Frame {
            title: "Validation of dropcheck's methods".to_owned(),
            product: "Validation of the methods",
            version: trial.version.clone(),
            heading: "Speed against accuracy, and where each method fails".to_owned(),
            about: request_words(trial),
            footer: "Errors are against truths from outside the methods: arithmetic of 106 bits, closed forms, simulated drops that share no \
                     formula with the analysis. A method is on the front where no other of its class is at least as accurate (95th percentile) \
                     and as fast, and better in one; what differs by less than 10 %, and times whose quartiles overlap, count as equal.",
            style: include_str!("../trial.css"),
        },
        chapters,
    }
}

fn machine_words(trial: &Trial) -> String {
    format!("{}, {} threads, {}.", trial.machine.processor, trial.machine.cores, trial.machine.system)
}

fn request_words(trial: &Trial) -> String {
    let run = if trial.request.quick { "Quick" } else { "Full" };
    format!("{run} run, seed {}. {}", trial.request.seed, machine_words(trial))
}

fn extract(trial: &Trial) -> String {
    let run = if trial.request.quick { "quick" } else { "full" };
    format!(
        "{} points of methods and classes, {} failure maps; {run} run, seed {}, version {}. {} {} Again: `{}`.",
        trial.points.len(),
        trial.maps.len(),
        trial.request.seed,
        trial.version,
        machine_words(trial),
        trial.peers,
        again(trial)
    )
}

fn figures(trial: &Trial, families: &[Family]) -> Vec<[String; 3]> {
    let defaults = trial.points.iter().filter(|p| p.is_default).count();
    let beaten: usize = families.iter().map(|f| f.beaten().len()).sum();
    let lines = || trial.maps.iter().flat_map(|map| map.lines.iter().map(move |line| breaks::of(map, line)));
    let unnoticed = lines().filter(|b| b.noticed.is_some_and(|(_, not)| not > 0)).count();
    let passing = lines().filter(|b| b.at.is_some()).count();
    [
        ["Methods × classes", &trial.points.len().to_string(), &format!("{} families", families.len())],
        [
            "Defaults on the front",
            &format!("{} of {defaults}", defaults.saturating_sub(beaten)),
            "the others with their reason",
        ],
        [
            "Failure maps",
            &trial.maps.len().to_string(),
            &format!("{passing} of {} lines pass their limit", lines().count()),
        ],
        ["Failures without notice", &unnoticed.to_string(), "lines of methods that could have said so"],
    ]
    .map(|figure| figure.map(str::to_owned))
    .to_vec()
}

/// The chart of a family, what is best in it, and whether the default is, or why it is taken all the same.
fn family_chapter(family: &Family) -> Chapter {
    let (beaten, never) = (family.beaten(), family.never_on_front());
    let title = format!("Speed against accuracy: {}", family.name);
    // The front and the default; all points are in points.csv.
    let best: Vec<(&TrialPoint, bool)> =
        family.points.iter().filter(|(p, on_front)| *on_front || p.is_default).copied().collect();
    let place = if beaten.is_empty() {
        ChapterPart::text("The default is on the front in every class.").only(Medium::Page)
    } else {
        let why = reason(family.name).unwrap_or("No reason is written for this.");
        ChapterPart::text(format!("The default is off the front in: {}. {why}", beaten.join("; ")))
    };
    let never = (!never.is_empty())
        .then(|| ChapterPart::note(format!("On no front, and not offered: {}.", never.join("; "))));
    Chapter::new(family.name)
        .below()
        .with(ChapterPart::picture(&family.file_name(), &title, ""))
        .with(points(family, &best).only(Medium::Markdown))
        .with(place)
        .with_all(never)
}

/// A point a row.
fn points(family: &Family, points: &[(&TrialPoint, bool)]) -> ChapterPart {
    let default =
        |p: &TrialPoint| TableCell::marked(&p.method[..], if p.is_default { "default" } else { "" });
    let quartiles = |p: &TrialPoint| p.time_quartiles_ns.map(|time_ns| significant(time_ns, 3)).join(" to ");
    ReportTable::of(points)
        .class("many")
        .caption(format!("{}: error {}, time of a {}", family.name, family.error_unit, family.time_per))
        .chosen(|(p, _)| p.is_default)
        .text(Words::or("Class", "class"), |(p, _)| &p.class[..])
        .text(Words::or("Method", "method"), |(p, _)| default(p))
        .number(Words::or("Median error", format!("median error, {}", family.error_unit)), |(p, _)| {
            error_words(Some(p.median_error))
        })
        .number("95 %", |(p, _)| error_words(Some(p.p95_error)))
        .number(Words::or("Time, ns", format!("ns a {}", family.time_per)), |(p, _)| {
            significant(p.time_ns, 3)
        })
        .number("Quartiles, ns", |(p, _)| quartiles(p))
        .only(Medium::Page)
        .number("Cases", |(p, _)| p.cases.to_string())
        .only(Medium::Page)
        .text(Words::or("Front", "front"), |(_, on_front)| if *on_front { "yes" } else { "no" })
        .into()
}

/// The chart of a map, and where each line breaks. One stress may have a map for each quantity.
fn map_chapter(map: &TrialMap) -> Chapter {
    let rows: Vec<_> = map.lines.iter().map(|line| (&line.method[..], breaks::of(map, line))).collect();
    let limit = significant(map.limit, 2);
    let noticed = |b: &breaks::Break| {
        let words = b.noticed_words();
        match b.silent {
            0 => words.into(),
            n => Words::or(format!("{words} · no number at {n} of {}", map.stresses.len()), words),
        }
    };
    let passes = format!("{} passes {limit} at: {}", map.error, map.stress);
    let table = ReportTable::of(&rows)
        .class("whole breaks")
        .text(Words::or("Method", "method"), |(method, _)| *method)
        .number(Words::or(format!("Passes {limit} at"), passes), |(_, b)| b.at_words())
        .number(Words::or("Largest error", "largest"), |(_, b)| error_words(b.worst))
        .text(Words::or("Noticed", "noticed"), |(_, b)| noticed(b));
    Chapter::new(format!("{}: {}", map.title, map.error))
        .below()
        .with(ChapterPart::picture(&failure_chart::file_name(map), &map.title, ""))
        .with(table)
}

/// A number, or that the method diverged.
fn error_words(error: Option<f64>) -> String {
    match error {
        Some(error) if error.is_nan() || error >= DIVERGED => "diverges".to_owned(),
        Some(error) => significant(error, 2),
        None => "–".to_owned(),
    }
}

fn provenance(trial: &Trial) -> Chapter {
    let machine = &trial.machine;
    let optimised = if machine.is_optimised { "optimised" } else { "not optimised" };
    let facts = vec![
        Fact::words("Processor", format!("{}, {} threads", machine.processor, machine.cores)),
        Fact::words("System", &machine.system[..]),
        Fact::words("Program", format!("dropcheck {}, {optimised}", trial.version)),
        Fact::words("Seed", trial.request.seed.to_string()),
        Fact::words("Programs of others", &trial.peers[..]),
        Fact::code("Again", again(trial)),
    ];
    let note = "The same seed and version give the same errors; times differ from run to run and from machine to machine.";
    Chapter::new("Machine, and how to run it again")
        .only(Medium::Page)
        .with(ChapterPart::facts("", facts))
        .with(ChapterPart::note(note))
}

/// The command that makes the same again.
fn again(trial: &Trial) -> String {
    let quick = if trial.request.quick { " --quick" } else { "" };
    format!("dropcheck validate{quick} --seed {} --out validation", trial.request.seed)
}

#[cfg(test)]
mod tests {
    use super::super::{charts, sample};
    use super::*;
    use crate::report::as_html;

    #[test]
    fn it_stands_alone_and_words_are_escaped() {
        let mut trial = sample::trial();
        let evil = "<img src=x onerror=alert(1)>\u{1b}[2J";
        trial.points[0].method = evil.into();
        trial.maps[0].title = evil.into();
        trial.machine.processor = evil.into();
        let page = as_html::page(&document(&trial), &charts(&trial));
        assert!(!page.contains("<img") && !page.contains('\u{1b}'));
        for call in ["href=", "url(", "@import", "<script", "https://"] {
            assert!(!page.contains(call), "{call}");
        }
    }

    #[test]
    fn a_beaten_default_has_its_reason() {
        let mut trial = sample::trial();
        trial.is_on_front = vec![false, true];
        let page = as_html::page(&document(&trial), &charts(&trial));
        assert!(page.contains("off the front") && page.contains("keeps 13 digits"));
    }
}
