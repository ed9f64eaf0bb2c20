//! What a recording holds to the table of `inspect`, 80 columns wide.

use super::columns::columns;
use super::rounding::{MISSING, plain};
use super::table::quality;
use super::text::{Style, WIDTH, format_word, line, printable, styled, tail, wrap};
use crate::data::{ListedChannel, Listing};

/// The table, with SGR colours that the caller strips where no terminal shows it.
#[must_use]
pub fn table(listing: &Listing) -> String {
    let title = format!(
        "{} · {} · {}",
        tail(&listing.recording, 50),
        format_word(listing.format),
        size(listing.bytes)
    );
    let mut out = format!("{}\n", styled(Style::Bold, &title));
    let counts: Vec<String> = listing.counts.iter().map(|(name, count)| counted(name, *count)).collect();
    if !counts.is_empty() {
        out.push_str(&wrap(&counts.join(", "), WIDTH, 0));
    }
    for (name, value) in &listing.facts {
        out.push_str(&wrap(&format!("{}: {value}", name.replace('_', " ")), WIDTH, 0));
    }
    line(&mut out, format_args!("\n{}", styled(Style::Bold, "Sources")));
    if listing.channels.is_empty() {
        out.push_str("  none\n");
    } else {
        out.push_str(&sources(&listing.channels));
    }
    for channel in &listing.channels {
        if let Some(reason) = &channel.unreadable {
            let text = format!("{} cannot be read: {reason}", channel.source);
            out.push_str(&wrap(&text, WIDTH, 2));
        }
    }
    out.push_str(&encodings(&listing.channels));
    if !listing.issues.is_empty() {
        out.push_str(&quality(&listing.issues));
    }
    out
}

/// "3 chunks", "1 chunk".
fn counted(name: &str, count: u64) -> String {
    let name = name.replace('_', " ");
    let name = if count == 1 { name.strip_suffix('s').unwrap_or(&name) } else { &name };
    format!("{count} {name}")
}

/// Heads of the columns of [`cells`], and which of them are said in one sentence where all sources share them.
const HEADER: [(&str, bool); 8] = [
    ("source", false),
    ("samples", false),
    ("rate", false),
    ("unit", false),
    ("start", true),
    ("length", true),
    ("gaps", true),
    ("range", false),
];

fn sources(channels: &[ListedChannel]) -> String {
    let rows: Vec<Vec<String>> = channels.iter().map(cells).collect();
    let shared = |i: usize| rows.len() > 1 && HEADER[i].1 && rows.iter().all(|row| row[i] == rows[0][i]);
    let shown: Vec<usize> = (0..HEADER.len()).filter(|i| !shared(*i)).collect();
    let header: Vec<&str> = shown.iter().map(|i| HEADER[*i].0).collect();
    let right: Vec<usize> =
        (0..shown.len()).filter(|i| (1..7).contains(&shown[*i]) && shown[*i] != 3).collect();
    let mut cut: Vec<Vec<String>> =
        rows.iter().map(|row| shown.iter().map(|i| row[*i].clone()).collect()).collect();
    let longest = channels.iter().map(|c| c.source.chars().count()).max().unwrap_or(0);
    let mut out = if longest > WIDEST_SOURCE {
        under_topics(&header, &mut cut, &right)
    } else {
        columns(&header, &cut, &right)
    };
    let common: Vec<String> = (0..HEADER.len())
        .filter(|i| shared(*i) && rows[0][*i] != MISSING)
        .map(|i| match (HEADER[i].0, rows[0][i].as_str()) {
            ("gaps", "0") => "no gaps".to_owned(),
            (name, value) => format!("{name} {value}"),
        })
        .collect();
    if !common.is_empty() {
        out.push_str(&wrap(&format!("Every source: {}.", common.join(", ")), WIDTH, 2));
    }
    out
}

/// Sources up to this many columns leave room for the rest of the table; longer ones stand under their topic or group.
const WIDEST_SOURCE: usize = 32;

/// A source as the topic or group that others share, and the rest of its path with the mark that joins them.
fn split(source: &str) -> (&str, &str) {
    let name = source.rfind('/').map_or(0, |slash| slash + 1);
    match source[name..].find('.') {
        Some(dot) => source.split_at(name + dot),
        None => source.split_at(name.saturating_sub(1)),
    }
}

/// The table with each topic or group on a line of its own above its sources.
fn under_topics(header: &[&str], rows: &mut [Vec<String>], right: &[usize]) -> String {
    let mut topics: Vec<String> = Vec::with_capacity(rows.len());
    for row in rows.iter_mut() {
        let (topic, rest) = split(&row[0]);
        topics.push(topic.to_owned());
        row[0] = format!("  {rest}");
    }
    let table = columns(header, rows, right);
    let head = table.lines().count().saturating_sub(rows.len());
    // A cell that is wrapped all the same has more lines than rows: then only the first topic can be placed.
    let is_aligned = head == columns(header, &[], right).lines().count();
    let mut out = String::new();
    for (i, text) in table.lines().enumerate() {
        if let Some(row) = i.checked_sub(head).filter(|_| is_aligned)
            && (row == 0 || topics.get(row) != topics.get(row - 1))
        {
            line(&mut out, format_args!("  {}", printable(&topics[row])));
        }
        line(&mut out, format_args!("{text}"));
    }
    out
}

fn cells(channel: &ListedChannel) -> Vec<String> {
    let samples = channel.samples.or(channel.messages);
    let seconds = |t: Option<f64>| t.map_or_else(|| MISSING.to_owned(), |t| format!("{} s", plain(t, 3)));
    vec![
        channel.source.clone(),
        samples.map_or_else(|| MISSING.to_owned(), |n| n.to_string()),
        channel.sample_rate_hz.map_or_else(|| MISSING.to_owned(), rate),
        channel.unit.clone().unwrap_or_else(|| MISSING.to_owned()),
        seconds(channel.start_s),
        seconds(channel.duration_s),
        channel.gaps.map_or_else(|| MISSING.to_owned(), |n| n.to_string()),
        channel.range.map_or_else(
            || MISSING.to_owned(),
            |(low, high)| format!("{} … {}", plain(low, 3), plain(high, 3)),
        ),
    ]
}

fn rate(rate_hz: f64) -> String {
    if rate_hz >= 1e3 {
        format!("{} kHz", plain(rate_hz / 1e3, 5))
    } else {
        format!("{} Hz", plain(rate_hz, 4))
    }
}

/// How the sources are stored, each way once.
fn encodings(channels: &[ListedChannel]) -> String {
    let mut groups: Vec<(&str, Vec<&str>)> = Vec::new();
    for channel in channels.iter().filter(|c| !c.encoding.is_empty()) {
        match groups.iter_mut().find(|(encoding, _)| *encoding == channel.encoding) {
            Some((_, sources)) => sources.push(&channel.source),
            None => groups.push((&channel.encoding, vec![&channel.source])),
        }
    }
    if groups.is_empty() {
        return String::new();
    }
    let mut out = format!("\n{}\n", styled(Style::Bold, "Stored as"));
    for (encoding, sources) in groups {
        let named = sources.first().copied().unwrap_or_default();
        let others =
            if sources.len() > 1 { format!(" and {} more", sources.len() - 1) } else { String::new() };
        out.push_str(&wrap(&format!("{encoding}: {}{others}", printable(named)), WIDTH, 2));
    }
    out
}

#[allow(clippy::cast_precision_loss, reason = "three digits are shown")]
fn size(bytes: u64) -> String {
    let mut value = bytes as f64;
    for unit in ["bytes", "KiB", "MiB", "GiB"] {
        if value < 1024.0 {
            return format!("{} {unit}", plain(value, 4));
        }
        value /= 1024.0;
    }
    format!("{} TiB", plain(value, 4))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::data::RecordingFormat;
    use std::collections::BTreeMap;

    pub(in super::super) fn listed(source: &str, kind: &str, unit: Option<&str>) -> ListedChannel {
        ListedChannel {
            source: source.into(),
            kind: kind.into(),
            samples: Some(200_000),
            messages: Some(200),
            sample_rate_hz: Some(100_000.0),
            unit: unit.map(Into::into),
            start_s: Some(0.0),
            duration_s: Some(2.0),
            gaps: Some(0),
            range: Some((-512.3, 498.1)),
            encoding: "protobuf dropcheck.AccelerationBlock".into(),
            unreadable: None,
        }
    }

    pub(in super::super) fn listing(channels: Vec<ListedChannel>) -> Listing {
        Listing {
            schema: "dropcheck.inspect/1",
            recording: "test.mcap".into(),
            bytes: 1_234_567,
            format: RecordingFormat::Mcap,
            counts: BTreeMap::from([("messages".into(), 400), ("chunks".into(), 3)]),
            facts: BTreeMap::from([("library".into(), "recorder\u{1b}[2J 1.0".into())]),
            channels,
            issues: Vec::new(),
        }
    }

    #[test]
    fn long_paths_stand_under_their_topic() {
        let sources = ["upper", "lower"].map(|sensor| {
            ["x", "y"].map(|axis| {
                listed(&format!("/cask/second_end/imu_{sensor}.linear_acceleration.{axis}"), "number", None)
            })
        });
        let text = anstream::adapter::strip_str(&table(&listing(sources.concat()))).to_string();
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        let at = |part: &str| text.lines().position(|line| line.trim_start().starts_with(part)).unwrap();
        let topic = at("/cask/second_end/imu_upper");
        assert!(text.lines().nth(topic + 1).unwrap().contains("    .linear_acceleration.x  "), "{text}");
        assert_eq!(at("/cask/second_end/imu_lower"), topic + 3, "{text}");
    }

    #[test]
    fn a_source_is_split_where_others_share_it() {
        assert_eq!(split("/a.b/imu.x.y"), ("/a.b/imu", ".x.y"));
        assert_eq!(split("/daq/slow/acc[2]"), ("/daq/slow", "/acc[2]"));
        assert_eq!(split("Acceleration of the first end"), ("", "Acceleration of the first end"));
        assert_eq!(split("/topic"), ("", "/topic"));
    }

    #[test]
    fn eighty_columns_hold_it() {
        let mut none = listed("/camera/front/image.data", "topic", None);
        none.unreadable = Some("sensor_msgs/msg/Image holds no number per sample".into());
        let listing =
            listing(vec![listed("/imu_first.linear_acceleration.z", "number", Some("m/s^2")), none]);
        let text = anstream::adapter::strip_str(&table(&listing)).to_string();
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(text.contains("200000") && text.contains("100 kHz") && text.contains("cannot be read"));
        assert!(!table(&listing).contains("\u{1b}[2J"));
    }
}
