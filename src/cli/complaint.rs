//! Prints an error on standard error: on a terminal drawn below the line at fault, elsewhere in plain
//! sentences.

use crate::report::{in_lines, message_text};
use miette::{GraphicalReportHandler, GraphicalTheme, Report};
use std::io::{IsTerminal, Write};

/// Longest line that is drawn; with a longer one the error is printed in sentences.
const LONGEST_LINE: usize = 1600;

/// Prints `report`; nothing in it can control the terminal, and no line of a file fills it.
pub fn complain(report: &Report) {
    // Lines for a shell are not wrapped.
    let has_lines = report.help().is_some_and(|help| help.to_string().contains('\n'));
    let drawing = (std::io::stderr().is_terminal() && !has_lines).then(|| draw(report));
    let fits = |text: &String| text.lines().all(|line| line.len() <= LONGEST_LINE);
    let text = drawing.filter(fits).unwrap_or_else(|| message_text(report));
    // If standard error is closed, nobody can be informed.
    let _ = writeln!(anstream::stderr(), "\u{1b}[1;31merror\u{1b}[0m: {}", in_lines(&text));
}

fn draw(report: &Report) -> String {
    let mut text = String::new();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(80);
    match handler.render_report(&mut text, report.as_ref()) {
        Ok(()) => text.trim_start().trim_start_matches('×').to_owned(),
        Err(_) => message_text(report),
    }
}
