//! Writes an error as plain lines: the message, the lines at fault and the remedy.

use super::text::sanitize;
use crate::data::shorten;
use miette::Report;

/// Characters shown before and after the error in a long line.
const LONGEST_LINE: usize = 400;

/// The message for use without a terminal, for another program to show.
#[must_use]
pub fn message(report: &Report) -> String {
    in_lines(&message_text(report))
}

/// Removes sequences that would steer a terminal, and shortens each line for a reader.
pub(crate) fn in_lines(text: &str) -> String {
    let lines: Vec<String> = text.lines().map(|line| sanitize(&shorten(line))).collect();
    lines.join("\n").trim().to_owned()
}

/// The message, the lines at fault and the remedy, without drawing.
pub(crate) fn message_text(report: &Report) -> String {
    let mut lines = vec![with_causes(report)];
    if let (Some(source), Some(labels)) = (report.source_code(), report.labels()) {
        for label in labels {
            // A line of context includes the whole line; the part before the label's own line is removed.
            let Ok(span) = source.read_span(label.inner(), 1, 1) else { continue };
            let text = String::from_utf8_lossy(span.data());
            let at = label.offset().saturating_sub(span.span().offset()).min(text.len());
            let before = text.get(..at).unwrap_or_default();
            let number = span.line() + before.matches('\n').count() + 1;
            let line = text.lines().nth(number - span.line() - 1).unwrap_or_default();
            let line = excerpt(line, before.rsplit('\n').next().map_or(0, str::len));
            let word = label.label().map_or_else(String::new, |word| format!("   ({word})"));
            lines.push(format!("  line {number}: {line}{word}"));
        }
    }
    lines.extend(report.help().map(|help| format!("  help: {help}")));
    lines.join("\n")
}

/// Cuts out the part of `line` around byte `at` that a person reads.
fn excerpt(line: &str, at: usize) -> String {
    let from = line.floor_char_boundary(at.saturating_sub(LONGEST_LINE / 2));
    let to = line.ceil_char_boundary(at.saturating_add(LONGEST_LINE / 2).min(line.len()));
    let (before, behind) = (if from > 0 { "…" } else { "" }, if to < line.len() { "…" } else { "" });
    format!("{before}{}{behind}", line.get(from..to).unwrap_or_default())
}

/// The message with its causes, each once.
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
    let mut text = shorten(&with_causes(report)).into_owned();
    if let Some(help) = report.help() {
        text.push_str("; ");
        text.push_str(&shorten(&help.to_string()));
    }
    sanitize(&text)
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
        let text = message_text(&Report::new(diagnostic).with_source_code(source));
        assert_eq!(
            text,
            "cask.toml, line 2: no key mas_kg\n  line 2: mas_kg = 1.0   (unknown key)\n  help: did you mean \
             mass_kg?"
        );
    }

    #[test]
    fn of_a_long_line_the_place_at_fault_is_told() {
        let line = format!("{}x = oops{}", "é ".repeat(50_000), " z".repeat(50_000));
        let text = format!("[cask]\n{line}\n");
        let at = text.find("oops").unwrap();
        let diagnostic = miette::diagnostic!(
            labels = vec![miette::LabeledSpan::at(at..at + 4, "not a number")],
            "cask.toml, line 2: {line}"
        );
        let report = Report::new(diagnostic).with_source_code(miette::NamedSource::new("cask.toml", text));
        let message = message_text(&report);
        let shown = message.lines().nth(1).unwrap();
        assert!(
            shown.contains("x = oops z") && shown.contains("  line 2: …") && shown.len() < 600,
            "{shown}"
        );
        assert!(shorten(message.lines().next().unwrap()).len() < 700 && sentence(&report).len() < 700);
    }

    #[test]
    fn the_sentence_carries_the_remedy() {
        let report = miette::miette!(help = "record it again", "b.mcap\u{1b}[2J is empty");
        assert_eq!(sentence(&report), "b.mcap[2J is empty; record it again");
    }
}
