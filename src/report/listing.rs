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
    let cut: Vec<Vec<String>> =
        rows.iter().map(|row| shown.iter().map(|i| row[*i].clone()).collect()).collect();
    let mut out = columns(&header, &cut, &right);
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
