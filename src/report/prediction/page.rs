//! A study to `prediction.html`: one file without network, for the desk and for A4 paper.

use super::super::html::{document, picture};
use super::super::html_sections::tested;
use super::super::pictures::{Picture, study_names};
use super::super::rounding::{fixed, plain};
use super::super::text::printable;
use super::page_tables as tables;
use super::summary::{has_quantiles, nearest};
use super::words::{bands_words, case_words, criterion_value, degrees};
use crate::data::{Criterion, Study};
use maud::{Markup, html};

const VERSION: &str = env!("CARGO_PKG_VERSION");
const STYLE: &str = include_str!("../prediction.css");

/// A longer table of predictions stands at the end of the page, not between the reader and what was found.
const MOST_ROWS_AHEAD: usize = 40;

/// The page; every word that comes from a file is escaped.
pub(super) fn page(study: &Study, pictures: &[Picture]) -> String {
    let name = printable(&study.cask_file.cask.name);
    let long = study.rows.len() > MOST_ROWS_AHEAD;
    let content = html! {
        header {
            div class="product" { "Prediction report · dropcheck " (VERSION) }
            h1 { (name) ": slap-down prediction" }
            p class="soft" { (printable(&study.cask_file.path.display().to_string())) }
            (figures(study))
        }
        (tested(&study.cask_file, "What was asked"))
        (tables::asked(study))
        h2 { "Predictions" }
        @if long { p { "The " (study.rows.len()) " predictions stand at the end of this page." } } @else { (tables::predictions(study)) }
        (picture(pictures, "sweep"))
        (tables::ladders(study))
        h2 { "Critical angles" }
        (tables::critical(study))
        div class="tall" { (picture(pictures, "critical-angles")) }
        (tables::ranges(study))
        h2 { "Over the drop angle" }
        @for name in over_the_angle(study) { div class="short" { (picture(pictures, &name)) } }
        (tables::monte_carlo(study))
        div class="tall" { (picture(pictures, "monte-carlo")) }
        (tables::sensitivities(study))
        (picture(pictures, "sensitivity"))
        h2 { "Regimes" }
        (picture(pictures, "regimes"))
        (limits())
        @if long { h2 { "All predictions" } (tables::predictions(study)) }
        (tables::provenance(study))
        footer {
            "The drop angle is the inclination of the cask's axis above the horizontal at first contact. The first end is the low one, the \
             second end slaps down. Vertical velocities are positive up. [P]: the BAM paper on slap-down impacts of packagings (PATRAM)."
        }
    };
    document(&format!("Prediction for {name}"), VERSION, STYLE, &content)
}

/// The pictures over the angle, in the order of their files.
fn over_the_angle(study: &Study) -> Vec<String> {
    let wanted = |name: &String| {
        ["smooth-rough", "speeds", "energy-ratio", "section"].contains(&name.as_str())
            || name.starts_with("components-")
    };
    study_names(&study.request).into_iter().filter(wanted).collect()
}

/// The four figures that a reader looks for first.
fn figures(study: &Study) -> Markup {
    let drawn = &study.monte_carlo;
    let worst = study
        .critical
        .iter()
        .filter(|c| c.model == drawn.model && c.criterion == Criterion::Speed && c.largest.is_finite())
        .max_by(|a, b| a.largest.total_cmp(&b.largest));
    let speed = drawn.quantiles.iter().find(|q| q.criterion == Criterion::Speed && has_quantiles(drawn));
    let at = study.request.angle_deg;
    let here = |values: &[f64]| nearest(&drawn.angle_deg, values, at);
    let at_angle = speed.and_then(|q| Some((here(&q.q50)?, here(&q.q025)?, here(&q.q975)?)));
    html! {
        dl class="figures" {
            div { dt { "Largest slap-down speed" }
                @match worst {
                    Some(c) => dd { (criterion_value(c.criterion, c.largest))
                        small { (c.model.as_str()) ", " (case_words(c.contact, c.k)) ", at " (degrees(c.angle_deg)) "°" } },
                    None => dd { "–" },
                } }
            div { dt { "At " (plain(at, 4)) "°, inputs uncertain" }
                @match at_angle {
                    Some((median, low, high)) => dd { (fixed(median, 2)) " m/s"
                        small { "95 % of the draws " (fixed(low, 2)) " to " (fixed(high, 2)) " m/s" } },
                    None => dd { "–" },
                } }
            div { dt { "Critical angle, inputs uncertain" }
                @match speed {
                    Some(q) => dd { (degrees(q.critical_angle_deg[2])) "°"
                        small { "95 % of the draws " (bands_words(&[(q.critical_angle_deg[0], q.critical_angle_deg[4])])) "°" } },
                    None => dd { "–" },
                } }
            div { dt { "Critical in 95 % of the draws" }
                @match speed {
                    Some(q) => dd { (bands_words(&q.robust_bands_deg)) @if !q.robust_bands_deg.is_empty() { "°" }
                        small { "speed within " (plain(drawn.band_percent, 3)) " % of its largest" } },
                    None => dd { "–" },
                } }
        }
    }
}

/// What the models leave out.
fn limits() -> Markup {
    html! {
        h2 { "Limits" }
        ul class="limits" {
            li { "One plane, a rigid cask and a rigid target; an impact takes no time. A real first impact of some milliseconds lets the cask \
                  turn and fall while it lasts." }
            li { "k is given, not predicted. That of a real cask varies with the angle: do not carry it from one angle to another." }
            li { "\"Rough\" assumes that the first end does not slide; the friction that this needs stands with the predictions. Where the \
                  target gives less, the Coulomb coefficient is the better input." }
            li { "For k = 0 the closed form of [P] Table 2 holds the first end on the target whatever the contact force. Where the force would \
                  have to pull, the first end lifts off and the speeds here are those of the flight; the closed form stands beside them." }
            li { "A critical band is counted from the largest value of its own curve. It says nothing about what the cask withstands." }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{pictures, sample_study};
    use super::*;

    fn made(study: &Study) -> String {
        page(study, &pictures::draw_study(study).unwrap())
    }

    #[test]
    fn it_stands_alone() {
        let page = made(&sample_study::study());
        for call in ["src=", "href=", "url(", "@import", "<script", "http://", "https://"] {
            let hits = page.matches(call).count();
            // The only address is the name of the SVG vocabulary.
            let allowed =
                if call == "http://" { page.matches("http://www.w3.org/2000/svg").count() } else { 0 };
            assert_eq!(hits, allowed, "{call}");
        }
        assert!(page.len() < 1_500_000, "{} bytes", page.len());
    }

    #[test]
    fn it_shows_every_picture() {
        for study in [sample_study::study(), sample_study::swept(), sample_study::without_slap_down()] {
            let page = made(&study);
            assert_eq!(page.matches("<figure").count(), study_names(&study.request).len());
        }
    }

    #[test]
    fn words_from_files_are_escaped() {
        let mut study = sample_study::study();
        let evil = "<img src=x onerror=alert(1)>\"'\u{1b}[2J";
        study.cask_file.cask.name = evil.into();
        study.cask_file.path = evil.into();
        study.cask_file.sha256 = evil.into();
        let page = made(&study);
        assert!(!page.contains("<img") && !page.contains('\u{1b}'));
        assert!(page.contains("&lt;img"));
    }

    #[test]
    fn a_long_sweep_points_to_the_csv() {
        let study = sample_study::swept();
        let page = made(&study);
        assert!(study.rows.len() > tables::MOST_ROWS);
        assert!(page.contains(&format!("{} more", study.rows.len() - tables::MOST_ROWS)));
        assert!(page.contains("prediction.csv"));
        assert!(page.find("All predictions") > page.find("Sensitivity"));
    }

    #[test]
    fn without_a_slap_down_it_says_so() {
        assert!(made(&sample_study::without_slap_down()).contains("the second end never strikes"));
    }
}
