//! An error to words on standard error: drawn under the line at fault on a terminal, told in plain sentences elsewhere.

use dropcheck::report::printable;
use miette::{GraphicalReportHandler, GraphicalTheme, NarratableReportHandler, Report};
use std::io::{IsTerminal, Write};

/// Prints `report`; nothing in it can steer the terminal.
pub fn complain(report: &Report) {
    let mut text = String::new();
    let terminal = std::io::stderr().is_terminal();
    let drawn = if terminal {
        let theme = GraphicalTheme::unicode_nocolor();
        GraphicalReportHandler::new_themed(theme).with_width(80).render_report(&mut text, report.as_ref())
    } else {
        NarratableReportHandler::new().render_report(&mut text, report.as_ref())
    };
    if drawn.is_err() {
        text = report.to_string();
    }
    let lines: Vec<String> = text.lines().map(printable).collect();
    // There is no one left to tell where standard error is closed.
    let _ = writeln!(anstream::stderr(), "\u{1b}[1;31merror\u{1b}[0m: {}", lines.join("\n").trim());
}

/// The error and its remedy as one sentence, for a row of a table.
pub fn sentence(report: &Report) -> String {
    let mut text = report.to_string();
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
    fn the_sentence_carries_the_remedy() {
        let report = miette::miette!(help = "record it again", "b.mcap\u{1b}[2J is empty");
        assert_eq!(sentence(&report), "b.mcap[2J is empty; record it again");
    }
}
