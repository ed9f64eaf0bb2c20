//! An analysis to `report.html`: one file without network, for the desk and for A4 paper.

use super::html_reconstruction::{budget, reconstruction};
use super::html_sections as sections;
use super::pictures::Picture;
use super::rounding::{interval, percent};
use super::table::SLAP_DOWN_CODES;
use super::text::{printable, reason, verdict_sentence, verdict_word};
use crate::data::{Analysis, DropResult};
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("report.css");

/// The page; every word that comes from a file is escaped.
pub(super) fn page(analysis: &Analysis, pictures: &[Picture]) -> String {
    let result = &analysis.result;
    let name = printable(&analysis.cask_file.cask.name);
    let title = format!("Drop test of {name} – {}", verdict_word(result.verdict));
    let content = html! {
        header {
            div class="product" { "Drop test report · dropcheck " (result.version) }
            h1 { (name) ": slap-down drop test" }
            p class="soft" { (printable(&result.input.recording)) }
            (banner(result))
            (figures(result))
        }
        (sections::tested(&analysis.cask_file, "What was tested"))
        (sections::quantities(result))
        (picture(pictures, "comparison"))
        (sections::findings(result))
        h2 { "Curves" }
        @for name in ["accelerations", "velocities", "motion", "spectra"] {
            (picture(pictures, name))
        }
        (reconstruction(result))
        (sections::flight(result))
        (budget(result, &analysis.cask_file))
        (sections::models(result))
        (sections::predictions(result))
        (sections::channels(result))
        (sections::provenance(result, &analysis.cask_file))
        footer {
            "An interval holds the value with 95 % probability. Times count from the recording's first sample unless an \
             axis says otherwise. Body axes: axial from the first end to the second, transverse away from the target."
        }
    };
    document(&title, result.version, "", &content)
}

/// A page of its own around `content`, whose words are escaped already; `style` is added to what all pages share.
pub(crate) fn document(title: &str, version: &str, style: &str, content: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                // Whatever a file smuggled in could neither run nor call out.
                meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'";
                meta name="generator" content=(format!("dropcheck {version}"));
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(style)) }
            }
            body { main { (content) } }
        }
    }
    .into_string()
}

fn banner(result: &DropResult) -> Markup {
    let word = verdict_word(result.verdict);
    html! {
        div class=(format!("banner {}", word.to_lowercase())) role="status" {
            strong { (word) }
            span { (verdict_sentence(result)) }
        }
    }
}

fn figures(result: &DropResult) -> Markup {
    let model = result.model.as_ref().map_or("no model taken", |m| m.rung.words());
    html! {
        dl class="figures" {
            div { dt { "Slap-down speed, measured" }
                dd { (interval(result.slap_down.speed.as_ref()))
                    @if result.slap_down.speed.is_none() { small { (printable(reason(result, &SLAP_DOWN_CODES))) } } } }
            div { dt { "Slap-down speed, predicted" }
                @match &result.comparison {
                    Some(c) => dd { (super::rounding::pair(c.predicted, c.predicted_u95, "m/s")) small { (model) ", measured k" } },
                    None => dd { "–" },
                }
            }
            div { dt { "Measured against predicted" }
                @match &result.comparison {
                    Some(c) => dd { (percent(c.difference_percent))
                        small { @if c.agrees { "within both intervals" } @else { "beyond both intervals" } } },
                    None => dd { "–" },
                }
            }
            div { dt { "Coefficient of restitution k" } dd { (interval(result.k.as_ref())) } }
        }
    }
}

/// The picture of this name with its caption.
pub(crate) fn picture(pictures: &[Picture], name: &str) -> Markup {
    html! {
        @for picture in pictures.iter().filter(|p| p.name == name) {
            figure aria-label=(printable(&picture.alt)) {
                (PreEscaped(&picture.svg))
                figcaption { strong { (picture.title) ". " } (printable(&picture.caption)) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{pictures, sample};
    use super::*;

    fn made(analysis: &Analysis) -> String {
        page(analysis, &pictures::draw(analysis).unwrap())
    }

    #[test]
    fn it_stands_alone() {
        let page = made(&sample::analysis());
        for call in ["src=", "href=", "url(", "@import", "<script", "http://", "https://"] {
            let hits = page.matches(call).count();
            // The only address is the name of the SVG vocabulary.
            let allowed =
                if call == "http://" { page.matches("http://www.w3.org/2000/svg").count() } else { 0 };
            assert_eq!(hits, allowed, "{call}");
        }
        assert!(page.len() < 2_500_000, "{} bytes", page.len());
    }

    #[test]
    fn it_says_what_the_result_says() {
        let page = made(&sample::analysis());
        for words in [
            "REVIEW",
            "20.56 ± 0.11 m/s",
            "0.559 ± 0.010",
            "clipped",
            "9f86d081884c7d65",
            "CFC 180",
            "95.0",
            "calibration of A2",
        ] {
            assert!(page.contains(words), "{words}");
        }
    }

    #[test]
    fn words_from_files_are_escaped() {
        let mut analysis = sample::analysis();
        let evil = "<img src=x onerror=alert(1)>\"'\u{1b}[2J";
        analysis.cask_file.cask.name = evil.into();
        analysis.result.input.recording = evil.into();
        analysis.result.channels[0].name = evil.into();
        analysis.result.channels[0].source = evil.into();
        analysis.result.channels[0].unit = evil.into();
        analysis.curves.channels[0].channel = evil.into();
        analysis.result.quality[0].message = evil.into();
        analysis.result.quality[0].channel = Some(evil.into());
        analysis.result.settings[0].value = evil.into();
        if let Some(model) = &mut analysis.result.model {
            model.reason = evil.into();
        }
        let page = made(&analysis);
        assert!(!page.contains("<img") && !page.contains('\u{1b}'));
    }

    #[test]
    fn what_is_missing_is_explained() {
        let page = made(&sample::without_anything());
        assert!(page.contains("FAIL") && page.contains("no impact was found"));
    }
}
