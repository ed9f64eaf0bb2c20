//! Document with the content of a recording that `inspect` shows.

use super::analysis::quality;
use super::document::{Chapter, ChapterPart, Medium, ReportDocument, ReportTable, TableShape, Words};
use super::rounding::{MISSING, plain};
use super::text::{json_word, tail};
use crate::data::{ListedChannel, Listing};

/// The table, with SGR colours that the caller strips if no terminal shows it.
pub fn table(listing: &Listing, width: usize) -> String {
    super::as_text::text(&document(listing), width)
}

/// Chapters on the facts of the container, the sources, their storage, and damage of the file, if any.
pub(super) fn document(listing: &Listing) -> ReportDocument {
    let counts: Vec<String> = listing.counts.iter().map(|(name, count)| plural(name, *count)).collect();
    let counts = (!counts.is_empty()).then(|| ChapterPart::line(counts.join(", ")));
    let facts = listing
        .facts
        .iter()
        .map(|(name, value)| ChapterPart::line(format!("{}: {value}", name.replace('_', " "))));
    let unreadable = listing.channels.iter().filter_map(|channel| {
        let reason = channel.unreadable.as_ref()?;
        Some(ChapterPart::text(format!("{} cannot be read: {reason}", channel.source)))
    });
    let title = ChapterPart::title(recording_words(listing)).only_on(Medium::Terminal);
    let mut chapters = vec![
        Chapter::new("").then(title).with_all(counts).with_all(facts),
        Chapter::new("Sources").with_all(sources(&listing.channels)).with_all(unreadable),
        Chapter::new("Stored as").with_all(encodings(&listing.channels).into_iter().map(ChapterPart::text)),
    ];
    if !listing.issues.is_empty() {
        chapters.push(quality(&listing.issues));
    }
    ReportDocument { chapters, ..ReportDocument::default() }
}

/// The recording, its format and its size.
pub(super) fn recording_words(listing: &Listing) -> String {
    format!("{} · {} · {}", tail(&listing.recording, 50), json_word(listing.format), size(listing.bytes))
}

/// "3 chunks", "1 chunk".
fn plural(name: &str, count: u64) -> String {
    let name = name.replace('_', " ");
    let name = if count == 1 { name.strip_suffix('s').unwrap_or(&name) } else { &name };
    format!("{count} {name}")
}

/// A source with the selected rows.
pub(super) fn source_words(listed: &ListedChannel) -> String {
    let rows = listed.rows.as_ref().map_or_else(String::new, |rows| format!(" ({rows})"));
    format!("{}{rows}", listed.source)
}

/// Columns that become one sentence if all sources have the same value.
const SHARED: [&str; 3] = ["start", "length", "gaps"];

/// Sources up to this many columns leave room for the rest of the table; longer ones go below their topic or
/// group.
const WIDEST_SOURCE: usize = 32;

fn sources(channels: &[ListedChannel]) -> Vec<ChapterPart> {
    if channels.is_empty() {
        return vec![ChapterPart::text("none")];
    }
    let longest = channels.iter().map(|c| c.source.chars().count()).max().unwrap_or(0);
    let is_long = longest > WIDEST_SOURCE;
    let known = |words: Option<String>| words.unwrap_or_else(|| MISSING.to_owned());
    let seconds = |t: Option<f64>| known(t.map(|t| format!("{} s", plain(t, 3))));
    let mut table: ReportTable = ReportTable::from_rows(channels)
        .head("source", |c| {
            let named = source_words(c);
            let short = if is_long { format!("  {}", split(&named).1) } else { named.clone() };
            Words::with_short(named, short)
        })
        .number("samples", |c| known(c.samples.or(c.messages).map(|n| n.to_string())))
        .number("rate", |c| known(c.sample_rate_hz.map(rate)))
        .text("unit", |c| match &c.unit {
            Some(unit) => Words::from(unit.clone()),
            None => Words::with_short("not stated", MISSING),
        })
        .number("start", |c| seconds(c.start_s))
        .number("length", |c| seconds(c.duration_s))
        .number("gaps", |c| known(c.gaps.map(|n| n.to_string())))
        .text("range", |c| {
            known(c.range.map(|(low, high)| format!("{} … {}", plain(low, 3), plain(high, 3))))
        })
        .only_on(Medium::Terminal)
        .limit_rows(usize::MAX, 300, "recording.json has all")
        .into();
    if is_long {
        table.shape = TableShape::Groups(channels.iter().map(|c| split(&c.source).0.to_owned()).collect());
    }
    let mut common = Vec::new();
    table.columns.retain(|column| {
        let (name, words) = (column.head.text_on(Medium::Page), column.cells[0].words.text_on(Medium::Page));
        let is_shared = SHARED.contains(&name)
            && channels.len() > 1
            && column.cells.iter().all(|cell| cell.words.text_on(Medium::Page) == words);
        match (name, words) {
            _ if !is_shared || words == MISSING => {}
            ("gaps", "0") => common.push("no gaps".to_owned()),
            _ => common.push(format!("{name} {words}")),
        }
        !is_shared
    });
    let common =
        (!common.is_empty()).then(|| ChapterPart::text(format!("Every source: {}.", common.join(", "))));
    [table.into()].into_iter().chain(common).collect()
}

/// Splits a source into the topic or group that others share, and the rest of its path with the separator.
fn split(source: &str) -> (&str, &str) {
    if source.starts_with('{') {
        return ("of several MCAP channels on one topic", source);
    }
    let name = source.rfind('/').map_or(0, |slash| slash + 1);
    match source[name..].find('.') {
        Some(dot) => source.split_at(name + dot),
        None => source.split_at(name.saturating_sub(1)),
    }
}

fn rate(rate_hz: f64) -> String {
    if rate_hz >= 1e3 {
        format!("{} kHz", plain(rate_hz / 1e3, 5))
    } else {
        format!("{} Hz", plain(rate_hz, 4))
    }
}

/// Lists the ways in which the sources are stored, each once.
fn encodings(channels: &[ListedChannel]) -> Vec<String> {
    let mut groups: Vec<(&str, Vec<&str>)> = Vec::new();
    for channel in channels.iter().filter(|c| !c.encoding.is_empty()) {
        match groups.iter_mut().find(|(encoding, _)| *encoding == channel.encoding) {
            Some((_, sources)) => sources.push(&channel.source),
            None => groups.push((&channel.encoding, vec![&channel.source])),
        }
    }
    let words = |(encoding, sources): (&str, Vec<&str>)| match sources[..] {
        [one] => format!("{encoding}: {one}"),
        _ => format!("{encoding}: {} and {} more", sources[0], sources.len() - 1),
    };
    groups.into_iter().map(words).collect()
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
    use super::super::text::WIDTH;
    use super::*;
    use crate::data::RecordingFormat;
    use std::collections::BTreeMap;

    pub(in super::super) fn listed(source: &str, kind: &str, unit: Option<&str>) -> ListedChannel {
        ListedChannel {
            samples: Some(200_000),
            messages: Some(200),
            sample_rate_hz: Some(100_000.0),
            unit: unit.map(Into::into),
            start_s: Some(0.0),
            duration_s: Some(2.0),
            gaps: Some(0),
            range: Some((-512.3, 498.1)),
            encoding: "protobuf dropcheck.AccelerationBlock".into(),
            ..ListedChannel::new(source, kind)
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
        let text = anstream::adapter::strip_str(&table(&listing(sources.concat()), WIDTH)).to_string();
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
        let text = anstream::adapter::strip_str(&table(&listing, WIDTH)).to_string();
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(text.contains("200000") && text.contains("100 kHz") && text.contains("cannot be read"));
        assert!(!table(&listing, WIDTH).contains("\u{1b}[2J"));
    }
}
