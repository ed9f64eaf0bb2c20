//! An error to words on standard error: drawn under the line at fault on a terminal, told in plain sentences elsewhere.

use dropcheck::report::printable;
use miette::{GraphicalReportHandler, GraphicalTheme, Report};
use std::io::{IsTerminal, Write};

/// Prints `report`; nothing in it can steer the terminal.
pub fn complain(report: &Report) {
    let text = if std::io::stderr().is_terminal() { drawn(report) } else { told(report) };
    let lines: Vec<String> = text.lines().map(printable).collect();
    // There is no one left to tell where standard error is closed.
    let _ = writeln!(anstream::stderr(), "\u{1b}[1;31merror\u{1b}[0m: {}", lines.join("\n").trim());
}

fn drawn(report: &Report) -> String {
    let mut text = String::new();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(80);
    match handler.render_report(&mut text, report.as_ref()) {
        Ok(()) => text.trim_start().trim_start_matches('×').to_owned(),
        Err(_) => told(report),
    }
}

/// The message, the lines at fault and the remedy, without drawing.
fn told(report: &Report) -> String {
    let mut lines = vec![with_causes(report)];
    if let (Some(source), Some(labels)) = (report.source_code(), report.labels()) {
        for label in labels {
            // With a line of context the line comes whole; the part before the label's own line is cut off.
            let Ok(span) = source.read_span(label.inner(), 1, 1) else { continue };
            let text = String::from_utf8_lossy(span.data());
            let at = label.offset().saturating_sub(span.span().offset()).min(text.len());
            let before = text.get(..at).unwrap_or_default();
            let number = span.line() + before.matches('\n').count() + 1;
            let line = text.lines().nth(number - span.line() - 1).unwrap_or_default();
            let word = label.label().map_or_else(String::new, |word| format!("   ({word})"));
            lines.push(format!("  line {number}: {line}{word}"));
        }
    }
    lines.extend(report.help().map(|help| format!("  help: {help}")));
    lines.join("\n")
}

/// The message with what caused it, each once.
fn with_causes(report: &Report) -> String {
    let mut text = report.to_string();
    for cause in report.chain().skip(1) {
        let cause = cause.to_string();
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

/// The error and its remedy as one sentence, for a row of a table.
pub fn sentence(report: &Report) -> String {
    let mut text = with_causes(report);
    if let Some(help) = report.help() {
        text.push_str("; ");
        text.push_str(&help.to_string());
    }
    printable(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_at_fault_is_told() {
        let source = miette::NamedSource::new("cask.toml", "[cask]\nmas_kg = 1.0\n");
        let diagnostic = miette::diagnostic!(
            labels = vec![miette::LabeledSpan::at(7..13, "unknown key")],
            help = "did you mean mass_kg?",
            "cask.toml, line 2: no key mas_kg"
        );
        let text = told(&Report::new(diagnostic).with_source_code(source));
        assert_eq!(
            text,
            "cask.toml, line 2: no key mas_kg\n  line 2: mas_kg = 1.0   (unknown key)\n  help: did you mean mass_kg?"
        );
    }

    #[test]
    fn the_sentence_carries_the_remedy() {
        let report = miette::miette!(help = "record it again", "b.mcap\u{1b}[2J is empty");
        assert_eq!(sentence(&report), "b.mcap[2J is empty; record it again");
    }
}
