//! An error to words on standard error: drawn under the line at fault on a terminal, told in plain sentences
//! elsewhere.

use crate::report::{in_lines, message_text};
use miette::{GraphicalReportHandler, GraphicalTheme, Report};
use std::io::{IsTerminal, Write};

/// A longer line is not drawn but told.
const LONGEST_LINE: usize = 1600;

/// Prints `report`; nothing in it can steer the terminal, and no line of a file fills it.
pub fn complain(report: &Report) {
    // Lines for a shell are not wrapped.
    let has_lines = report.help().is_some_and(|help| help.to_string().contains('\n'));
    let drawn = (std::io::stderr().is_terminal() && !has_lines).then(|| drawn(report));
    let fits = |text: &String| text.lines().all(|line| line.len() <= LONGEST_LINE);
    let text = drawn.filter(fits).unwrap_or_else(|| message_text(report));
    // There is no one left to tell where standard error is closed.
    let _ = writeln!(anstream::stderr(), "\u{1b}[1;31merror\u{1b}[0m: {}", in_lines(&text));
}

fn drawn(report: &Report) -> String {
    let mut text = String::new();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(80);
    match handler.render_report(&mut text, report.as_ref()) {
        Ok(()) => text.trim_start().trim_start_matches('×').to_owned(),
        Err(_) => message_text(report),
    }
}
