//! Finds the sources of a recording that look like accelerations in the plane of the drop.

use crate::data::{ListedChannel, Listing, acceleration_unit_m_s2, is_rate_of_turn};

/// Units of a sensor's output that the cask file knows.
pub(super) const VOLTAGES: [&str; 2] = ["V", "mV"];

/// Words in a source that indicate no measured quantity.
const NO_QUANTITY: &str = "time stamp sec nsec nanosec seq covariance sample_rate frame_id index";

/// Words in a source that indicate another quantity than acceleration.
const OTHER_QUANTITIES: &str = "orientation angular gyro temp";

/// Readable sources that look like accelerations: by unit or name if any does, else all numeric ones; none if
/// those that look so cannot be read.
pub(super) fn accelerations(listing: &Listing) -> Vec<&ListedChannel> {
    let numeric: Vec<&ListedChannel> =
        candidates(listing).filter(|c| c.unreadable.is_none() && c.kind != "topic").collect();
    let likely: Vec<&ListedChannel> = numeric
        .iter()
        .filter(|c| is_likely(c))
        // The y axis of an IMU lies across the plane of the drop.
        .filter(|c| !c.source.ends_with("linear_acceleration.y"))
        .copied()
        .collect();
    let taken = if !likely.is_empty() {
        likely
    } else if candidates(listing).any(|c| c.unreadable.is_some() && is_likely(c)) {
        Vec::new()
    } else {
        numeric
    };
    // A source that never changes is an axis without a sensor, unless it is the only source.
    let moves = |c: &&ListedChannel| c.range.is_none_or(|(low, high)| low < high);
    if taken.iter().any(moves) { taken.into_iter().filter(moves).collect() } else { taken }
}

/// Sources that might be accelerations if they could be read; those that look like it, if any does.
pub(super) fn unreadable_sources(listing: &Listing) -> Vec<&ListedChannel> {
    let all: Vec<&ListedChannel> = candidates(listing).filter(|c| c.unreadable.is_some()).collect();
    let likely: Vec<&ListedChannel> = all.iter().copied().filter(|c| is_likely(c)).collect();
    if likely.is_empty() { all } else { likely }
}

/// A source and why it cannot be read.
pub(super) fn reason(listed: &ListedChannel) -> String {
    format!("{}: {}", listed.source, listed.unreadable.as_deref().unwrap_or("it cannot be read"))
}

/// Lists the available sources, and says how to make a recording that can be analysed.
pub(super) fn no_acceleration(listing: &Listing) -> miette::Report {
    /// More than this many reasons no longer fit a terminal's few lines.
    const HANDFUL: usize = 4;
    let unreadable = unreadable_sources(listing);
    let reasons: Vec<String> = unreadable.iter().take(HANDFUL).map(|listed| reason(listed)).collect();
    let more = match unreadable.len().saturating_sub(HANDFUL) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    let problem = if listing.channels.is_empty() {
        "it holds nothing that could be read as samples".to_owned()
    } else if reasons.is_empty() {
        let names: Vec<&str> = listing.channels.iter().take(HANDFUL).map(|c| c.source.as_str()).collect();
        format!("nothing in it looks like an acceleration: it holds {}", names.join(", "))
    } else {
        format!("no acceleration in it can be read: {}{more}", reasons.join("; "))
    };
    let mend = if reasons.is_empty() {
        "check that this is the recording of the accelerometers; if it is, write the [[channel]] tables by \
         hand, each with its source"
    } else {
        "in a copy, make each value of these a plain number with one decimal mark, or leave it empty; or \
         export the recording again"
    };
    let name = &listing.recording;
    let mend = format!("{mend}; `dropcheck inspect {name}` lists all that is in it");
    miette::miette!(help = mend, "{name}: {problem}")
}

/// Sources that are not called something else.
fn candidates(listing: &Listing) -> impl Iterator<Item = &ListedChannel> {
    listing
        .channels
        .iter()
        .filter(|c| c.samples != Some(0) && !c.unit.as_deref().is_some_and(is_rate_of_turn))
        .filter(|c| is_quantity(&c.source))
        .filter(|c| !OTHER_QUANTITIES.split(' ').any(|word| has_word(&c.source, word)))
}

/// True unless a source is named like times, counts or names.
pub(super) fn is_quantity(source: &str) -> bool {
    !NO_QUANTITY.split(' ').any(|word| has_word(source, word)) && !is_time(source)
}

/// True if unit or name indicate an acceleration.
fn is_likely(listed: &ListedChannel) -> bool {
    let is_known = |unit: &str| acceleration_unit_m_s2(unit).is_some() || VOLTAGES.contains(&unit);
    listed.unit.as_deref().is_some_and(is_known) || listed.source.to_lowercase().contains("acc")
}

/// True if `word` stands in `source` between letters of another kind.
pub(super) fn has_word(source: &str, word: &str) -> bool {
    let source = source.to_lowercase();
    let letter = |c: Option<char>| c.is_some_and(|c| c.is_ascii_alphabetic());
    source.match_indices(word).any(|(at, _)| {
        !letter(source[..at].chars().next_back()) && !letter(source[at + word.len()..].chars().next())
    })
}

/// True if a source is named like times.
pub(super) fn is_time(source: &str) -> bool {
    let last = source.rsplit(['/', '.']).next().unwrap_or(source).to_lowercase();
    last == "t"
        || last.starts_with("t_")
        || last.starts_with("t [")
        || last.contains("time")
        || last.contains("zeit")
        || ["x_value", "elapsed"].iter().any(|name| last.starts_with(name))
}
