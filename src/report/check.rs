//! A set-up at rest to the document that `check` shows.

use super::analysis::quality;
use super::document::{Chapter, ChapterPart, ReportDocument};
use super::rounding::{fixed, optional_fixed};
use super::table::{ReportTable, TableCell};
use super::text::{Style, counted};
use crate::data::{Check, Finding};

/// What no recording at rest tells, and what does.
const UNTOLD: [&str; 3] = [
    "Calibration: a reading within 0.4 g is taken for right, since an offset looks like a scale. See the \
     certificate, or turn the sensor upside down: 2 g lie between both readings.",
    "Positions and length: a tape along the axis, from the edge that strikes first.",
    "Angle: an inclinometer on the rigged cask, since 1° changes g cos φ by less than an offset.",
];
/// What blows would tell.
const BY_TAPS: &str = "Ends, clocks, and the sign of channels that are AC-coupled: strike each end once from \
                       below, the first end first, and add --taps.";

/// The table, with SGR colours that the caller strips where no terminal shows it.
#[must_use]
pub fn table(check: &Check, has_blows: bool, width: usize) -> String {
    let document = ReportDocument { chapters: chapters(check, has_blows), ..ReportDocument::default() };
    super::as_text::text(&document, width)
}

fn chapters(check: &Check, has_blows: bool) -> Vec<Chapter> {
    let channels = ReportTable::of(&check.channels)
        .head("channel", |c| c.name.clone())
        .number("reads, g", |c| fixed(c.reads_g, 2))
        .number("expected, g", |c| optional_fixed(c.expected_g, 2))
        .number("noise, g", |c| fixed(c.noise_g, 3))
        .tag("", |c| ready(c.ready));
    let not_ready = check.channels.iter().filter(|channel| !channel.ready).count();
    let title = match (check.ready, not_ready) {
        (true, _) => "Ready: at rest nothing speaks against the drop".to_owned(),
        (false, 0) => "Not ready".to_owned(),
        (false, count) => format!("Not ready: {} of {}", count, counted(check.channels.len(), "channel")),
    };
    let mut found: Vec<Finding> = check.channels.iter().flat_map(|c| c.findings.clone()).collect();
    found.extend(check.findings.iter().cloned());
    found.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    let found = (!found.is_empty()).then(|| quality(&found));
    let untold = UNTOLD.into_iter().chain((!has_blows).then_some(BY_TAPS));
    let head = Chapter::new("").with(ChapterPart::title(title)).with(channels);
    let foot = Chapter::new("Not told by rest").with_all(untold.map(ChapterPart::text));
    [head].into_iter().chain(found).chain([foot]).collect()
}

fn ready(is_ready: bool) -> TableCell {
    let (style, words) = if is_ready { (Style::Green, "ready") } else { (Style::Red, "not ready") };
    TableCell::toned(style, words)
}
