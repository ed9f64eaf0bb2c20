//! Texts of an analysis on a terminal and on its page.

use super::analysis::document;
use super::first_screen::first_screen;
use super::text::{WIDTH, causes, reasons};
use super::{as_html, pictures, sample, table};
use crate::data::{
    Analysis, CODES, ChannelFinding, DropFinding, Effect, Finding, IssueCode, Severity, SlapDown, Untested,
    Verdict,
};

fn text_of(analysis: &Analysis) -> String {
    first_screen(analysis, None, WIDTH) + &table(analysis, WIDTH)
}

/// Every run of white space as one space.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn bare(text: &str) -> String {
    anstream::adapter::strip_str(text).to_string()
}

#[test]
fn eighty_columns_hold_it() {
    for analysis in [sample::analysis(), sample::without_anything()] {
        for line in bare(&text_of(&analysis)).lines() {
            assert!(line.chars().count() <= WIDTH, "{} columns: {line}", line.chars().count());
        }
    }
}

#[test]
fn the_first_screen_holds_the_most_that_can_be_said() {
    let mut analysis = sample::analysis();
    let mut finding = analysis.result.quality[0].clone();
    finding.message = "a long cause ".repeat(40);
    analysis.result.quality.insert(0, finding);
    let input = analysis.result.untested[0].clone();
    let many = (1..40).map(|n| Untested { what: format!("calibration of A{n}"), ..input.clone() });
    analysis.result.untested = many.collect();
    for (width, most) in [(60, 16), (80, 16), (160, 10)] {
        let text = bare(&first_screen(&analysis, Some("a/folder/report.html"), width));
        assert!(text.lines().count() <= most && !text.contains('…'), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= width), "{text}");
        let (flat, last) = (flat(&text), text.lines().last().expect("a line"));
        let three =
            "Not checkable 39 inputs: calibration of A1, calibration of A2, calibration of A3; `--full`";
        assert!(flat.contains(three) && last.ends_with("report.html"), "{text}");
        assert!(flat.contains("a long cause a long") || flat.contains("with `--full`."), "{text}");
    }
}

#[test]
fn the_figures_are_there() {
    let text = bare(&text_of(&sample::analysis()));
    for words in
        ["REVIEW", "20.56 ± 0.11 m/s", "0.559 ± 0.010", "+0.3 %", "within both intervals", "clipped · A1"]
    {
        assert!(text.contains(words), "{words} is missing in\n{text}");
    }
    let flat = flat(&text);
    assert!(flat.contains("Closures: what the motion must meet") && flat.contains("−0.8 % of ω"), "{flat}");
    assert!(flat.contains("reconstructed Taken: planar motion with modes and drift"), "{flat}");
}

#[test]
fn a_missing_quantity_says_why() {
    let text = bare(&text_of(&sample::without_anything()));
    assert!(text.contains("NOT TO BE USED"));
    assert!(text.contains("– not determined: no impact was found"), "{text}");
}

/// One that looks as if it had this code, severity and effect.
fn finding(code: IssueCode, severity: Severity, effect: Effect, words: &str) -> Finding {
    Finding { code, severity, effect, message: words.into(), ..ChannelFinding::Polarity.tag("A1") }
}

#[test]
fn of_any_two_findings_the_one_that_took_the_number_is_the_reason() {
    let mut analysis = sample::without_anything();
    for (_, (taking, _)) in CODES {
        for (_, (other, _)) in CODES {
            for severity in [Severity::Error, Severity::Warning, Severity::Note] {
                let result = &mut analysis.result;
                result.quality = vec![
                    finding(*taking, Severity::Warning, Effect::Motion, "A1 took it"),
                    finding(*other, severity, Effect::Nothing, "A1 is harmless"),
                ];
                result.quality.sort_by(|a, b| b.severity.cmp(&a.severity).then(a.code.cmp(&b.code)));
                result.find_missing();
                let all = ["first_impact.", "slap_down.", "k", "impacts", "comparison"];
                assert_eq!(reasons(result, &all), ["A1 took it"], "{taking:?} beside {other:?}");
                assert_eq!(causes(result), ["A1 took it."], "{taking:?} beside {other:?}");
            }
        }
    }
}

#[test]
fn screen_tables_and_page_name_the_finding_that_took_the_number_and_then_what_explains_it() {
    let mut analysis = sample::without_anything();
    let result = &mut analysis.result;
    (result.verdict, result.impacts) = (Verdict::Review, sample::analysis().result.impacts);
    result.quality = vec![
        finding(IssueCode::UsualSlip, Severity::Warning, Effect::Hint, "A1 is stated upside down"),
        finding(IssueCode::Gap, Severity::Warning, Effect::LostSamples, "A1 is harmless"),
        finding(IssueCode::Geometry, Severity::Warning, Effect::Contradiction, "A1 took it"),
        finding(IssueCode::Geometry, Severity::Warning, Effect::Hint, "A1 would close it"),
    ];
    result.find_missing();
    let (text, page) = (bare(&text_of(&analysis)), made(&analysis));
    let first = "Not determined: k and the slap-down speed. A1 took it. A1 is stated upside down. A1 would";
    let flat = flat(&text);
    assert!(flat.contains(first) && !flat.contains("determined: A1 is harmless"), "{text}");
    // The first impact, the slap-down, both impacts.
    for said in [&flat, &page] {
        assert_eq!(said.matches("– not determined: A1 took it").count(), 3, "{said}");
        assert_eq!(said.matches("– not compared: A1 took it").count(), 1, "{said}");
    }
}

#[test]
fn a_number_that_stands_under_an_error_is_named_before_the_one_that_is_missing() {
    let mut analysis = sample::analysis();
    let result = &mut analysis.result;
    (result.verdict, result.slap_down, result.comparison) = (Verdict::Fail, SlapDown::default(), None);
    let ends = DropFinding::EndsEarly { after_s: 0.02 }.into();
    result.quality.insert(0, ends);
    result.find_missing();
    let screen = bare(&first_screen(&analysis, None, WIDTH));
    let said = "k is valid, the slap-down speed is not determined. No slap-down within 20 ms";
    assert!(screen.starts_with("PARTLY USABLE  ") && flat(&screen).contains(said), "{screen}");
}

#[test]
fn names_from_files_cannot_colour_the_terminal() {
    let mut analysis = sample::analysis();
    analysis.cask_file.cask.name = "\u{1b}[31mX".into();
    analysis.result.channels[0].name = "\u{1b}[2JA".into();
    analysis.result.quality[0].message = "\u{1b}[5mblink".into();
    let text = text_of(&analysis);
    for code in ["\u{1b}[31m", "\u{1b}[2J", "\u{1b}[5m"] {
        assert!(!text.contains(code));
    }
}

fn made(analysis: &Analysis) -> String {
    as_html::page(&document(analysis), &pictures::draw(analysis))
}

#[test]
fn it_stands_alone() {
    let page = made(&sample::analysis());
    for call in ["src=", "url(", "@import", "<script src", "http://", "https://", "fetch(", "XMLHttp"] {
        let hits = page.matches(call).count();
        // The only addresses are the name of the SVG vocabulary, and that of the library of the charts in its
        // head.
        let allowed = match call {
            "http://" => page.matches("http://www.w3.org/2000/svg").count(),
            "https://" => 1,
            _ => 0,
        };
        assert_eq!(hits, allowed, "{call}");
    }
    assert!(page.len() < 750_000, "{} bytes", page.len());
}

#[test]
fn its_links_lead_to_its_chapters_and_to_the_files_beside_it() {
    let page = made(&sample::with_other());
    let links: Vec<&str> = page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let (chapters, files): (Vec<_>, Vec<_>) = links.into_iter().partition(|link| link.starts_with('#'));
    assert_eq!(files, super::FILE_NAMES[1..]);
    assert!(chapters.len() > 8, "{chapters:?}");
    for chapter in chapters {
        assert_eq!(page.matches(&format!(" id=\"{}\"", &chapter[1..])).count(), 1, "{chapter}");
    }
}

#[test]
fn the_test_is_the_heading_and_the_foot_and_no_row() {
    let mut analysis = sample::analysis();
    analysis.result.test.id = Some("T-7 </style>".into());
    analysis.result.test.title = Some("Slap-down at −40 °C".into());
    analysis.result.test.date = Some("2026-11-22T18:04:00+01:00".into());
    let page = made(&analysis);
    for words in [
        "<h1>T-7 &lt;/style&gt;: Slap-down at −40 °C</h1>",
        "content: \"T\\2d 7 \\3c \\2f style\\3e  \\b7  recording 9f86d081884c7d65\"",
        "2026-11-22, 18:04 +01:00",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("Title</th>"));
}

#[test]
fn a_long_recording_is_thinned_and_says_so() {
    let mut analysis = sample::analysis();
    let live = |analysis: &Analysis| pictures::draw(analysis).swap_remove(1).live;
    assert!(live(&analysis).contains("every sample is here"));
    let curve = &mut analysis.curves.channels[0];
    for values in [&mut curve.time_s, &mut curve.raw_m_s2, &mut curve.filtered_m_s2, &mut curve.velocity_m_s]
    {
        *values = values.iter().flat_map(|value| [*value; 50]).collect();
    }
    let thinned = live(&analysis);
    assert!(thinned.contains("of each 34 samples") && thinned.len() < 150_000, "{}", thinned.len());
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
    assert!(page.contains("NOT TO BE USED") && page.contains("no impact was found"));
}
