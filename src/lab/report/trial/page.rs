//! A trial to `validation.html`: one file without network, for the desk and for A4 paper; charts first.

use super::breaks;
use super::families::{Family, families};
use super::reasons::reason;
use crate::lab::data::{Trial, TrialMap, TrialPoint};
use crate::report::html::{document, picture};
use crate::report::pictures::Picture;
use crate::report::rounding::significant;
use crate::report::text::printable;
use maud::{Markup, html};

const STYLE: &str = include_str!("../trial.css");

/// Errors from here on are words: the method diverged.
const DIVERGED: f64 = 1e6;

/// The page; every word that comes from elsewhere is escaped.
pub(super) fn page(trial: &Trial, pictures: &[Picture]) -> String {
    let families = families(trial);
    let maps = pictures.iter().skip(families.len());
    let content = html! {
        header {
            div class="product" { "Validation of the methods · dropcheck " (trial.version) }
            h1 { "Speed against accuracy, and where each method fails" }
            p class="soft" { (request_words(trial)) }
            (figures(trial, &families))
        }
        @if !trial.machine.is_optimised {
            p class="note" { strong { "This program was built without optimisation: its times say nothing." } }
        }
        h2 { "Speed against accuracy" }
        @for family in &families {
            h3 { (printable(family.name)) }
            (picture(pictures, &family.file_name()))
            (place_of_default(family))
        }
        h2 { "Where methods fail" }
        @for (map, chart) in trial.maps.iter().zip(maps) {
            (picture(std::slice::from_ref(chart), &chart.name))
            (breaks_table(map))
        }
        h2 { "All points" }
        @for family in &families { (points_table(family)) }
        (provenance(trial))
        footer {
            "Errors are against truths from outside the methods: arithmetic of 106 bits, closed forms, simulated drops that share no formula \
             with the analysis. A method is on the front where no other of its class is at least as accurate (95th percentile) and as fast, and \
             better in one; what differs by less than 10 %, and times whose quartiles overlap, count as equal."
        }
    };
    document("Validation of dropcheck's methods", &trial.version, STYLE, &content)
}

fn request_words(trial: &Trial) -> String {
    format!(
        "{} run, seed {}. {}, {} threads, {}.",
        if trial.request.quick { "Quick" } else { "Full" },
        trial.request.seed,
        printable(&trial.machine.processor),
        trial.machine.cores,
        printable(&trial.machine.system)
    )
}

fn figures(trial: &Trial, families: &[Family]) -> Markup {
    let defaults = trial.points.iter().filter(|p| p.is_default).count();
    let beaten: usize = families.iter().map(|f| f.beaten().len()).sum();
    let lines = || trial.maps.iter().flat_map(|map| map.lines.iter().map(move |line| breaks::of(map, line)));
    let unnoticed = lines().filter(|b| b.noticed.is_some_and(|(_, not)| not > 0)).count();
    html! {
        dl class="figures" {
            div { dt { "Methods × classes" } dd { (trial.points.len()) small { (families.len()) " families" } } }
            div { dt { "Defaults on the front" }
                dd { (defaults.saturating_sub(beaten)) " of " (defaults) small { "the others with their reason" } } }
            div { dt { "Failure maps" } dd { (trial.maps.len())
                small { (lines().filter(|b| b.at.is_some()).count()) " of " (lines().count()) " lines pass their limit" } } }
            div { dt { "Failures without notice" } dd { (unnoticed) small { "lines of methods that could have said so" } } }
        }
    }
}

/// Whether the default is on the front, or why it is taken all the same; and what is on no front.
fn place_of_default(family: &Family) -> Markup {
    let (beaten, never) = (family.beaten(), family.never_on_front());
    html! {
        p { @if beaten.is_empty() { "The default is on the front in every class." } @else {
            "The default is off the front in: " (printable(&beaten.join("; "))) ". "
            (reason(family.name).unwrap_or("No reason is written for this."))
        } }
        @if !never.is_empty() {
            p class="note" { "On no front: " (printable(&never.join("; "))) ". The command line offers none of these to choose." }
        }
    }
}

fn breaks_table(map: &TrialMap) -> Markup {
    html! {
        table class="whole breaks" {
            thead { tr { th { "Method" } th class="n" { "Passes " (significant(map.limit, 2)) " at" } th class="n" { "Largest error" } th { "Noticed" } } }
            tbody { @for line in &map.lines {
                @let broken = breaks::of(map, line);
                tr { td { (printable(&line.method)) } td class="n" { (broken.at_words()) } td class="n" { (error_words(broken.worst)) }
                    td { (broken.noticed_words())
                        @if broken.silent > 0 { span class="soft" { " · no number at " (broken.silent) " of " (map.stresses.len()) } } } }
            } }
        }
    }
}

/// A number, or that the method diverged.
pub(super) fn error_words(error: Option<f64>) -> String {
    match error {
        Some(error) if error.is_nan() || error >= DIVERGED => "diverges".to_owned(),
        Some(error) => significant(error, 2),
        None => "–".to_owned(),
    }
}

fn points_table(family: &Family) -> Markup {
    html! {
        table class="many" {
            caption { (printable(family.name)) ": error " (printable(family.error_unit)) ", time of a " (printable(family.time_per)) }
            thead { tr {
                th { "Class" } th { "Method" } th class="n" { "Median error" } th class="n" { "95 %" } th class="n" { "Time, ns" }
                th class="n" { "Quartiles, ns" } th class="n" { "Cases" } th { "Front" }
            } }
            tbody { @for (point, on_front) in &family.points { (point_row(point, *on_front)) } }
        }
    }
}

fn point_row(point: &TrialPoint, on_front: bool) -> Markup {
    let class = if point.is_default { "chosen" } else { "" };
    html! {
        tr class=(class) {
            td { (printable(&point.class)) }
            td { (printable(&point.method)) @if point.is_default { " " span class="default" { "default" } } }
            td class="n" { (error_words(Some(point.median_error))) }
            td class="n" { (error_words(Some(point.p95_error))) }
            td class="n" { (significant(point.time_ns, 3)) }
            td class="n" { (significant(point.time_quartiles_ns[0], 3)) " to " (significant(point.time_quartiles_ns[1], 3)) }
            td class="n" { (point.cases) }
            td { @if on_front { "yes" } }
        }
    }
}

fn provenance(trial: &Trial) -> Markup {
    html! {
        h2 { "Machine, and how to run it again" }
        table class="whole" { tbody {
            tr { th scope="row" { "Processor" } td { (printable(&trial.machine.processor)) ", " (trial.machine.cores) " threads" } }
            tr { th scope="row" { "System" } td { (printable(&trial.machine.system)) } }
            tr { th scope="row" { "Program" } td { "dropcheck " (trial.version) ", "
                @if trial.machine.is_optimised { "optimised" } @else { "not optimised" } } }
            tr { th scope="row" { "Seed" } td { (trial.request.seed) } }
            tr { th scope="row" { "Programs of others" } td { (printable(&trial.peers)) } }
            tr { th scope="row" { "Again" } td { code { (again(trial)) } } }
        } }
        p class="note" { "The same seed and version give the same errors; times differ from run to run and from machine to machine." }
    }
}

/// The command that makes the same again.
pub(super) fn again(trial: &Trial) -> String {
    let quick = if trial.request.quick { " --quick" } else { "" };
    format!("dropcheck validate{quick} --seed {} --out validation", trial.request.seed)
}

#[cfg(test)]
mod tests {
    use super::super::{charts, sample};
    use super::*;

    #[test]
    fn it_stands_alone_and_words_are_escaped() {
        let mut trial = sample::trial();
        let evil = "<img src=x onerror=alert(1)>\u{1b}[2J";
        trial.points[0].method = evil.into();
        trial.maps[0].title = evil.into();
        trial.machine.processor = evil.into();
        let page = page(&trial, &charts(&trial).unwrap());
        assert!(!page.contains("<img") && !page.contains('\u{1b}'));
        for call in ["href=", "url(", "@import", "<script", "https://"] {
            assert!(!page.contains(call), "{call}");
        }
    }

    #[test]
    fn a_beaten_default_has_its_reason() {
        let mut trial = sample::trial();
        trial.is_on_front = vec![false, true];
        let page = page(&trial, &charts(&trial).unwrap());
        assert!(page.contains("off the front") && page.contains("keeps 13 digits"));
    }
}
