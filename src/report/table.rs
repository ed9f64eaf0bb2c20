//! An analysis to the table that the terminal shows, 80 columns wide.

use super::columns::columns;
use super::grid::STANDARD_GRAVITY_M_S2;
use super::prediction::contact_words;
use super::rounding::{self, MISSING, interval, optional, percent, plain};
use super::text::{
    self, Style, WIDTH, code_word, format_word, line, printable, severity_word, span_text, styled,
    styled_lines, tail, verdict_sentence, verdict_word, wrap,
};
use crate::data::{Analysis, CaskFile, DropResult, End, Estimate, Issue, IssueCode, Severity, Verdict};

/// Columns that the name of a quantity takes.
const NAME_WIDTH: usize = 22;

/// Findings that take away what the first impact would give.
pub(super) const FIRST_IMPACT_CODES: [IssueCode; 5] = [
    IssueCode::NoImpact,
    IssueCode::BeginsLate,
    IssueCode::MissingChannel,
    IssueCode::DeadChannel,
    IssueCode::Truncated,
];

/// Findings that take away what the slap-down would give.
pub(super) const SLAP_DOWN_CODES: [IssueCode; 8] = [
    IssueCode::NoSlapDown,
    IssueCode::EndsEarly,
    IssueCode::NoImpact,
    IssueCode::MissingChannel,
    IssueCode::DeadChannel,
    IssueCode::SecondContact,
    IssueCode::FlightFit,
    IssueCode::Truncated,
];

/// The whole table, with SGR colours that the caller strips where no terminal shows it.
#[must_use]
pub fn table(analysis: &Analysis) -> String {
    let result = &analysis.result;
    let mut out = tested(result, &analysis.cask_file);
    out.push_str(&verdict(result));
    out.push_str(&quantities(result));
    out.push_str(&comparison(result));
    out.push_str(&reconstruction(result));
    out.push_str(&predictions(result));
    out.push_str(&channels(result));
    out.push_str(&quality(&result.quality));
    out
}

fn heading(words: &str) -> String {
    format!("\n{}\n", styled(Style::Bold, words))
}

fn tested(result: &DropResult, file: &CaskFile) -> String {
    let (cask, drop) = (&file.cask, &file.drop);
    let mut sizes = format!("{} kg, l {} m", plain(cask.mass_kg, 6), plain(cask.length_m, 5));
    if cask.height_m > 0.0 {
        sizes += ", h ";
        sizes += &plain(cask.height_m, 5);
        sizes += " m";
    }
    let what = format!(
        "{} · drop {} m at {}° · {sizes} · {} contact",
        cask.name,
        plain(drop.height_m, 5),
        plain(drop.angle_rad.to_degrees(), 5),
        contact_words(file.contact)
    );
    let files = format!(
        "{} ({}) with {}",
        tail(&result.input.recording, 40),
        format_word(result.input.format),
        tail(&result.input.cask, 24)
    );
    format!("{}{}", styled_lines(Style::Bold, &wrap(&what, WIDTH, 0)), wrap(&files, WIDTH, 0))
}

fn verdict(result: &DropResult) -> String {
    let style = match result.verdict {
        Verdict::Pass => Style::Green,
        Verdict::Review => Style::Yellow,
        Verdict::Fail => Style::Red,
    };
    format!("\n{}  {}\n", styled(style, verdict_word(result.verdict)), verdict_sentence(result))
}

fn quantities(result: &DropResult) -> String {
    let (first, second) = (&result.first_impact, &result.slap_down);
    let mut out = heading("First impact");
    let rows = [
        ("first contact", &first.time, "after the first sample"),
        ("impact velocity", &first.impact_velocity, ""),
        ("contact lasts", &first.duration, ""),
        ("rebound velocity", &first.rebound_velocity, "vertical, up positive"),
        ("angular velocity", &first.angular_velocity, ""),
        ("restitution k", &result.k, "rebound over impact velocity"),
    ];
    out.push_str(&block(result, &rows, &FIRST_IMPACT_CODES));
    out.push_str(&heading("Slap-down"));
    let rows = [
        ("speed", &second.speed, "just before the second end strikes"),
        ("vertical velocity", &second.vertical_velocity, "up positive"),
        ("horizontal velocity", &second.horizontal_velocity, ""),
        ("angle", &second.angle, "of the axis above the horizontal"),
        ("flight time", &second.flight_time, "from separation"),
        ("time", &second.time, "after the first sample"),
    ];
    out.push_str(&block(result, &rows, &SLAP_DOWN_CODES));
    out
}

/// Rows of quantities; the reason for the missing ones stands once below them.
fn block(result: &DropResult, rows: &[(&str, &Option<Estimate>, &str)], codes: &[IssueCode]) -> String {
    let mut out = String::new();
    let mut missing = false;
    for (name, estimate, note) in rows {
        let value = interval(estimate.as_ref());
        missing |= value == MISSING;
        let note = if value == MISSING { "" } else { *note };
        let line = format!("  {name:<NAME_WIDTH$}{value:<22}");
        out.push_str(format!("{line}{}", styled_note(note)).trim_end());
        out.push('\n');
    }
    if missing {
        let sentence = format!("{MISSING} could not be had: {}", text::reason(result, codes));
        out.push_str(&wrap(&sentence, WIDTH, 2));
    }
    out
}

fn styled_note(note: &str) -> String {
    if note.is_empty() { String::new() } else { styled(Style::Dim, note) }
}

fn comparison(result: &DropResult) -> String {
    let mut out = heading("Measured beside predicted");
    if let Some(c) = &result.comparison {
        let agrees = if c.agrees {
            styled(Style::Green, "within both intervals")
        } else {
            styled(Style::Yellow, "beyond both intervals")
        };
        let by = result
            .model
            .as_ref()
            .map_or(String::new(), |m| format!("{} with the measured k", m.rung.words()));
        for (name, value, note) in [
            ("measured", rounding::pair(c.measured, c.measured_u95, "m/s"), String::new()),
            ("predicted", rounding::pair(c.predicted, c.predicted_u95, "m/s"), styled_note(&by)),
            ("difference", percent(c.difference_percent), agrees),
        ] {
            out.push_str(format!("  {name:<NAME_WIDTH$}{value:<22}{note}").trim_end());
            out.push('\n');
        }
    } else {
        let reason = text::reason(result, &SLAP_DOWN_CODES);
        out.push_str(&wrap(&format!("{MISSING} could not be compared: {reason}"), WIDTH, 2));
    }
    if let Some(model) = &result.model {
        out.push_str(&wrap(
            &format!("Model: {}. {}", model.rung.words(), text::sentence(&model.reason)),
            WIDTH,
            2,
        ));
    }
    out
}

/// The rung taken and why, and the closure that is missed most.
fn reconstruction(result: &DropResult) -> String {
    let Some(choice) = &result.reconstruction else { return String::new() };
    let mut out = heading("How the motion was reconstructed");
    out.push_str(&wrap(&text::sentence(&choice.reason), WIDTH, 2));
    if let Some(worst) = choice.closures.iter().max_by(|a, b| a.miss_in_u.abs().total_cmp(&b.miss_in_u.abs()))
    {
        let of = match choice.closures.len() {
            1 => "The one closure".to_owned(),
            n => format!("Of {n} closures the worst"),
        };
        let miss = format!(
            "{of}, {}, is missed by {}, {} standard uncertainties.",
            worst.name,
            text::true_minus(&worst.miss),
            rounding::fixed(worst.miss_in_u.abs(), 1)
        );
        out.push_str(&wrap(&miss, WIDTH, 2));
    }
    out
}

fn predictions(result: &DropResult) -> String {
    if result.predictions.is_empty() {
        return String::new();
    }
    heading("Predictions") + &super::prediction::at_one_angle(&result.predictions)
}

fn channels(result: &DropResult) -> String {
    let g = |value: Option<f64>| optional(value.map(|v| v / STANDARD_GRAVITY_M_S2), 3);
    let rows: Vec<Vec<String>> = result
        .channels
        .iter()
        .map(|c| {
            let unit = c.unit.split(" (").next().unwrap_or_default().to_owned();
            vec![
                c.name.clone(),
                end_axis(c.end, c.axis),
                format!("{} kHz", plain(c.sample_rate_hz / 1e3, 5)),
                unit,
                g(c.offset_m_s2),
                g(c.noise_m_s2),
                g(c.peak_filtered_m_s2),
                g(c.peak_raw_m_s2),
            ]
        })
        .collect();
    let header = ["channel", "end, axis", "rate", "unit", "offset g", "noise g", "peak g", "raw g"];
    format!("{}{}", heading("Channels"), columns(&header, &rows, &[2, 4, 5, 6, 7]))
}

/// "first, transverse".
pub(super) fn end_axis(end: End, axis: crate::data::Axis) -> String {
    let end = match end {
        End::First => "first",
        End::Second => "second",
    };
    let axis = match axis {
        crate::data::Axis::Transverse => "transverse",
        crate::data::Axis::Axial => "axial",
    };
    format!("{end}, {axis}")
}

/// Every finding: severity, code, channel and span on one line, the message below it.
pub(super) fn quality(issues: &[Issue]) -> String {
    let mut out = heading("Quality");
    if issues.is_empty() {
        out.push_str("  no findings\n");
    }
    for issue in issues {
        let style = match issue.severity {
            Severity::Note => Style::Dim,
            Severity::Warning => Style::Yellow,
            Severity::Error => Style::Red,
        };
        let place: Vec<String> =
            [Some(code_word(issue.code)), issue.channel.as_deref().map(printable), span_text(issue)]
                .into_iter()
                .flatten()
                .collect();
        line(
            &mut out,
            format_args!("  {}  {}", styled(style, severity_word(issue.severity)), place.join(" · ")),
        );
        out.push_str(&wrap(&issue.message, WIDTH, 6));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    fn bare(text: &str) -> String {
        anstream::adapter::strip_str(text).to_string()
    }

    #[test]
    fn eighty_columns_hold_it() {
        for analysis in [sample::analysis(), sample::without_anything()] {
            for line in bare(&table(&analysis)).lines() {
                assert!(line.chars().count() <= WIDTH, "{} columns: {line}", line.chars().count());
            }
        }
    }

    #[test]
    fn the_figures_are_there() {
        let text = bare(&table(&sample::analysis()));
        for words in
            ["REVIEW", "20.56 ± 0.11 m/s", "0.559 ± 0.010", "+0.3 %", "within both intervals", "clipped · A1"]
        {
            assert!(text.contains(words), "{words} is missing in\n{text}");
        }
        let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            flat.contains("first impact, is missed by −0.8 % of ω, 0.4 standard uncertainties."),
            "{flat}"
        );
        assert!(flat.contains("reconstructed Taken: planar motion with modes and drift"), "{flat}");
    }

    #[test]
    fn a_missing_quantity_says_why() {
        let text = bare(&table(&sample::without_anything()));
        assert!(text.contains("FAIL"));
        assert!(text.contains("– could not be had: no impact was found"), "{text}");
    }

    #[test]
    fn names_from_files_cannot_colour_the_terminal() {
        let mut analysis = sample::analysis();
        analysis.cask_file.cask.name = "\u{1b}[31mX".into();
        analysis.result.channels[0].name = "\u{1b}[2JA".into();
        analysis.result.quality[0].message = "\u{1b}[5mblink".into();
        let text = table(&analysis);
        for code in ["\u{1b}[31m", "\u{1b}[2J", "\u{1b}[5m"] {
            assert!(!text.contains(code));
        }
    }
}
