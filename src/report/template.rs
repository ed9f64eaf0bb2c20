//! Writes a commented cask file to fill in, from the content of a recording.

use super::acceleration_sources::{self, VOLTAGES, has_word, is_time};
use super::rounding::{plain, significant};
use super::text::{is_hidden, lines, sanitize};
use crate::data::keys::{CHANNEL, FILL_IN, Key, TABLES, Takes};
use crate::data::{ListedChannel, Listing, MOST_CHANNELS, RowsOf, Severity, Source, acceleration_unit_m_s2};

/// The cask file, valid TOML; values that only the user knows are nan or "FILL IN": a likely value,
/// forgotten, would look like a known one.
///
/// # Errors
///
/// Returned if nothing that looks like an acceleration can be read.
pub fn cask_file(listing: &Listing) -> miette::Result<String> {
    let mut taken = acceleration_sources::accelerations(listing);
    let beyond = taken.len().saturating_sub(MOST_CHANNELS);
    taken.truncate(MOST_CHANNELS);
    if taken.is_empty() {
        return Err(acceleration_sources::no_acceleration(listing));
    }
    let mut out = head(listing);
    for issue in listing.issues.iter().filter(|issue| issue.severity != Severity::Note) {
        out.push(format!("# Of the recording: {}", sanitize(&issue.message)));
    }
    for (i, listed) in taken.iter().enumerate() {
        channel(&mut out, i, listed);
    }
    if beyond > 0 {
        let more =
            format!("{beyond} more look like these; a cask file holds at most {MOST_CHANNELS} channels.");
        out.extend([String::new(), format!("# {more}")]);
    }
    let left = listing.channels.iter().filter(|c| !taken.iter().any(|t| t.source == c.source));
    let (unreadable, other): (Vec<&ListedChannel>, Vec<_>) = left.partition(|c| c.unreadable.is_some());
    let mut also = |why: &str, sources: Vec<String>| {
        if !sources.is_empty() {
            out.extend([String::new(), format!("# Also in the recording, but it {why}:")]);
            out.extend(sources.into_iter().map(|source| format!("#   {}", sanitize(&source))));
        }
    };
    also("cannot be read", unreadable.into_iter().map(acceleration_sources::reason).collect());
    let (shown, clocks): (Vec<_>, Vec<_>) = other.into_iter().partition(|c| is_shown(c));
    let sources = clocks.into_iter().map(|listed| listed.source.clone()).collect();
    also("tells times, counts or names", sources);
    if !shown.is_empty() {
        out.extend([String::new(), OTHERS.to_owned()]);
        out.extend(shown.into_iter().flat_map(other_channel));
    }
    Ok(lines(out))
}

/// The columns of a sensor list, in the order of a measuring plan.
const LIST: &str = "name source end plane_m around_deg direction unit full_scale polarity serial certificate \
                    calibrated file";

/// A sensor list with one row per source, to be filled in: accelerations first, all others with `end =
/// "none"`.
///
/// # Errors
///
/// Returned if nothing that looks like an acceleration can be read.
pub fn sensor_list(listing: &Listing) -> miette::Result<Vec<u8>> {
    let accelerations = acceleration_sources::accelerations(listing);
    if accelerations.is_empty() {
        return Err(acceleration_sources::no_acceleration(listing));
    }
    let is_other = |c: &&ListedChannel| c.unreadable.is_none() && is_shown(c);
    let is_taken = |c: &&ListedChannel| accelerations.iter().any(|taken| taken.source == c.source);
    let others = listing.channels.iter().filter(|c| is_other(c) && !is_taken(c));
    let rows: Vec<(&ListedChannel, &str)> =
        accelerations.iter().map(|c| (&**c, "")).chain(others.map(|c| (c, "none"))).collect();
    let has_rows = rows.iter().any(|(c, _)| c.rows.is_some());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let fault = |error: csv::Error| miette::miette!("the sensor list could not be written: {error}");
    let heads: Vec<&str> = LIST.split(' ').chain(has_rows.then_some("where")).collect();
    writer.write_record(&heads).map_err(fault)?;
    let labels: Vec<String> = rows.iter().map(|(listed, _)| label(listed).0).collect();
    for ((listed, end), short) in rows.into_iter().zip(&labels) {
        let is_alone = labels.iter().filter(|other| *other == short).count() == 1;
        let name = if is_alone { short.clone() } else { super::listing::source_words(listed) };
        let source = match listed.origin() {
            Source::Path(path) => path,
            source @ Source::TopicField { .. } => source_value(&source),
        };
        let picked =
            |rows: &RowsOf| format!("{{ column = {}, is = {} }}", quote(&rows.column), quote(&rows.is));
        let mut cells = vec![name, source, end.to_owned()];
        cells.resize(LIST.split(' ').count(), String::new());
        cells[6] = if listed.unit.is_none() { label(listed).1 } else { String::new() };
        cells.extend(has_rows.then(|| listed.rows.as_ref().map(picked).unwrap_or_default()));
        writer.write_record(&cells).map_err(fault)?;
    }
    writer.into_inner().map_err(|error| fault(error.into_error().into()))
}

/// Name of a channel from the last part of its source, and the unit in brackets after it.
fn label(listed: &ListedChannel) -> (String, String) {
    let last = listed.source.rsplit('/').next().unwrap_or(&listed.source);
    let split = last.split_once(['[', '(']).filter(|(name, _)| !name.trim().is_empty());
    let (name, unit) = split.unwrap_or((last, ""));
    let (name, unit) = (name.trim(), unit.trim_end_matches([']', ')', ' ']).to_owned());
    (listed.rows.as_ref().map_or_else(|| name.to_owned(), |rows| format!("{name} {}", rows.is)), unit)
}

/// The cask file to fill in beside a sensor list of this name.
pub fn cask_file_with_list(listing: &Listing, list: &str) -> String {
    let mut out = head(listing);
    // A key outside the tables comes before all tables.
    out.insert(3, entry(&format!("sensors = {}", quote(list)), "a row a channel, in this folder"));
    out.insert(4, String::new());
    lines(out)
}

/// Heading of the channels that are no accelerations.
const OTHERS: &str = "# Also in the recording, but it does not move or does not look like an acceleration in \
                      the plane of\n# the drop. Without the marks it is shown and judged beside the motion.";

/// True if a source that is no acceleration may be a channel.
fn is_shown(listed: &ListedChannel) -> bool {
    let has_samples = listed.samples.is_none_or(|samples| samples > 1);
    listed.kind != "topic" && has_samples && acceleration_sources::is_quantity(&listed.source)
}

/// The lines of a channel that takes no part in the motion, commented out.
fn other_channel(listed: &ListedChannel) -> Vec<String> {
    let source = &listed.source[..];
    let name = listed.rows.as_ref().map_or_else(|| source.to_owned(), |rows| format!("{source} {}", rows.is));
    let mut out = vec![
        "# [[channel]]".to_owned(),
        format!("# name = {}", quote(&name)),
        entry("# end = \"none\"", &facts(listed)),
        format!("# source = {}", source_value(&listed.origin())),
    ];
    if listed.unit.is_none() {
        out.push(entry(&format!("# unit = \"{FILL_IN}\""), "the recording does not say"));
    }
    if let Some(rows) = &listed.rows {
        out.push(format!("# where = {{ column = {}, is = {} }}", quote(&rows.column), quote(&rows.is)));
    }
    out
}

fn head(listing: &Listing) -> Vec<String> {
    let mut out = vec![
        format!("# Cask file for {}", sanitize(&listing.recording)),
        format!(
            "# \"{FILL_IN}\" and nan stand for what only you know; a line with one of them is refused until \
             you replace it."
        ),
        "# Lengths in m, mass in kg, angles in degrees. A line behind # is optional.\n".to_owned(),
    ];
    let is_clock = |c: &&ListedChannel| is_time(&c.source) && c.samples != Some(1);
    let time = listing.channels.iter().filter(is_clock).find(|c| c.kind != "number" && c.kind != "array");
    for table in TABLES.iter().take_while(|table| table.name != "channel") {
        let mark = if table.keys.iter().any(|key| key.is_asked) { "" } else { "# " };
        out.push(entry(&format!("{mark}[{}]", table.name), table.remark));
        out.extend(table.keys.iter().map(|key| {
            let is_for_all = (table.name, key.name) == ("recording", "time");
            match time.filter(|_| is_for_all && listing.channels.iter().all(|c| c.time.is_none())) {
                Some(time) => entry(&format!("# time = {}", quote(&time.source)), key.remark),
                None => key_line(key),
            }
        }));
        out.push(String::new());
    }
    out.push(
        "# At least one transverse channel on each end. The first end is low and touches first.\n\
         # Check each end, axis and sign (polarity) against the test plan."
            .to_owned(),
    );
    out
}

/// A line of the form, its remark in the column of remarks.
fn entry(text: &str, remark: &str) -> String {
    let remark = if remark.is_empty() { String::new() } else { format!(" # {remark}") };
    format!("{text:<27}{remark}").trim_end().to_owned()
}

/// The line of a key: requested if only the user knows it, else commented out.
fn key_line(key: &Key) -> String {
    if !key.is_asked {
        return entry(&format!("# {} = {}", key.name, key.example), key.remark);
    }
    if !matches!(key.takes, Takes::Number(_)) {
        return entry(&format!("{} = \"{FILL_IN}\"", key.name), key.remark);
    }
    let colon = if key.remark.is_empty() { "" } else { ": " };
    entry(&format!("{} = nan", key.name), &format!("{FILL_IN}{colon}{}", key.remark))
}

/// The line of a key with one of two words: the one in the source's name, else to be filled in.
fn word_line(key: &Key, source: &str, words: [&str; 2]) -> String {
    let held = words.map(|word| has_word(source, word));
    match words.iter().zip(held).find(|(_, is_held)| *is_held).filter(|_| held != [true; 2]) {
        Some((word, _)) => {
            let remark = format!("read off the name, to be checked: {}", key.remark);
            entry(&format!("{} = \"{word}\"", key.name), &remark)
        }
        None => key_line(key),
    }
}

fn channel(out: &mut Vec<String>, index: usize, listed: &ListedChannel) {
    let source = listed.source.as_str();
    out.extend([String::new(), "[[channel]]".to_owned(), format!("# {}", facts(listed))]);
    for key in &CHANNEL {
        let line = match key.name {
            "name" => format!("name = \"A{}\"", index + 1),
            "end" => word_line(key, source, ["first", "second"]),
            "axis" => word_line(key, source, ["transverse", "axial"]),
            "source" => format!("source = {}", source_value(&listed.origin())),
            "unit" => {
                out.extend(unit(listed.unit.as_deref(), key));
                continue;
            }
            "sample_rate_hz" if listed.sample_rate_hz.is_none() => {
                const NONE: &str =
                    "no rate or times were found; or name the times below and take this line out";
                entry("sample_rate_hz = nan", &format!("{FILL_IN}: {NONE}"))
            }
            // They go with the unit and the coupling that need them.
            "sensitivity" | "time_constant_s" => continue,
            "time" if let Some(time) = &listed.time => {
                entry(&format!("# time = {}", quote(time)), key.remark)
            }
            "where" if let Some(rows) = &listed.rows => {
                format!("where = {{ column = {}, is = {} }}", quote(&rows.column), quote(&rows.is))
            }
            _ => key_line(key),
        };
        out.push(line);
    }
}

/// The line of the unit, and that of the sensitivity which it needs.
fn unit(told: Option<&str>, key: &Key) -> Vec<String> {
    match told {
        Some(unit) if acceleration_unit_m_s2(unit).is_some() => {
            vec![entry(&format!("# unit = {}", quote(unit)), key.remark)]
        }
        Some(unit) if VOLTAGES.contains(&unit) => vec![
            entry(&format!("unit = {}", quote(unit)), "as the recording says"),
            entry("sensitivity = nan", &format!("{FILL_IN}: mV per g")),
        ],
        told => {
            let quoted = |unit| format!("the recording says {:?}", sanitize(unit));
            let says = told.map_or_else(|| "the recording does not say".to_owned(), quoted);
            let remark = format!("\"g\", \"m/s^2\", \"V\" or \"mV\"; {says}");
            let sensitivity = entry("# sensitivity = 10.0", "mV per g, with \"V\" and \"mV\"");
            vec![entry(&format!("unit = \"{FILL_IN}\""), &remark), sensitivity]
        }
    }
}

fn facts(listed: &ListedChannel) -> String {
    let unit = listed.unit.as_deref().unwrap_or("");
    let facts = [
        listed.samples.map(|n| format!("{n} samples")),
        listed.sample_rate_hz.map(|rate| format!("{} Hz", plain(rate, 7))),
        listed.range.map(|(low, high)| format!("{} to {} {unit}", significant(low, 3), significant(high, 3))),
        Some(listed.encoding.clone()),
    ];
    sanitize(&facts.into_iter().flatten().collect::<Vec<String>>().join(", "))
}

/// A source as TOML.
fn source_value(source: &Source) -> String {
    match source {
        Source::Path(path) => quote(path),
        Source::TopicField { topic, field, channel } => {
            let channel = channel.map_or_else(String::new, |channel| format!(", channel = {channel}"));
            format!("{{ topic = {}, field = {}{channel} }}", quote(topic), quote(field))
        }
    }
}

/// A TOML basic string.
fn quote(text: &str) -> String {
    let escaped = text.chars().map(|c| match c {
        '"' | '\\' => format!("\\{c}"),
        c if is_hidden(c) => format!("\\u{:04X}", u32::from(c)),
        c => c.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::super::listing::tests::{listed, listing};
    use super::*;
    use crate::data::{Cask, TOLERANCES, Tolerances};

    fn parsed(text: &str) -> toml::Table {
        text.parse().unwrap_or_else(|e| panic!("{e}\n{text}"))
    }

    #[test]
    fn it_is_toml_with_a_channel_a_source() {
        let listing = listing(vec![
            listed("/daq/a1", "dataset", Some("g")),
            listed("/daq/a2", "dataset", Some("mV")),
            listed("/daq/time_s", "dataset", Some("s")),
        ]);
        let table = parsed(&cask_file(&listing).unwrap());
        let channels = table["channel"].as_array().unwrap();
        assert_eq!(channels.len(), 2);
        for key in ["end", "axis"] {
            assert_eq!(channels[1][key].as_str(), Some(FILL_IN), "no name shows it");
        }
        assert!(!channels[0].as_table().unwrap().contains_key("unit"), "the recording says so itself");
        assert_eq!(channels[1]["unit"].as_str(), Some("mV"));
        assert!(
            table["drop"]["angle_deg"].as_float().is_some_and(f64::is_nan),
            "nothing passes for a measured angle"
        );
    }

    #[test]
    fn an_imu_gives_its_axes_in_the_plane_and_its_ends_by_name() {
        let sources = ["x", "y", "z"]
            .iter()
            .flat_map(|axis| ["first", "second"].map(|end| format!("/imu_{end}.linear_acceleration.{axis}")))
            .chain(["/imu_first.orientation.x".into(), "/imu_first.header.stamp.sec".into()]);
        let listing = listing(sources.map(|s| listed(&s, "number", None)).collect());
        let table = parsed(&cask_file(&listing).unwrap());
        let channels = table["channel"].as_array().unwrap();
        assert_eq!(channels.len(), 4);
        for channel in channels {
            let source = channel["source"].as_str().unwrap();
            assert_eq!(channel["end"].as_str().unwrap() == "first", source.contains("first"));
            assert_eq!(channel["axis"].as_str(), Some(FILL_IN));
        }
    }

    #[test]
    fn a_word_in_a_name_is_taken_and_marked_and_two_are_not() {
        let sources = ["first end, axial", "second_transverse", "first or second", "firsthand"];
        let listing = listing(sources.map(|source| listed(source, "column", None)).into());
        let text = cask_file(&listing).unwrap();
        let channels = parsed(&text)["channel"].as_array().unwrap().clone();
        let words = |key: &str| -> Vec<String> {
            channels.iter().map(|channel| channel[key].as_str().unwrap().to_owned()).collect()
        };
        assert_eq!(words("end"), ["first", "second", FILL_IN, FILL_IN]);
        assert_eq!(words("axis"), ["axial", "transverse", FILL_IN, FILL_IN]);
        assert_eq!(words("unit"), [FILL_IN; 4]);
        assert_eq!(text.matches("read off the name").count(), 4, "{text}");
    }

    #[test]
    fn a_rate_of_turn_is_no_acceleration() {
        let sources = [("A1", "g"), ("Chan 7:6DX0855-AC1", "deg/sec"), ("w", "°/s"), ("r", "rad/s")];
        let channels: Vec<ListedChannel> =
            sources.iter().map(|(source, unit)| listed(source, "column", Some(unit))).collect();
        let text = cask_file(&listing(channels.clone())).unwrap();
        assert_eq!(parsed(&text)["channel"].as_array().unwrap().len(), 1);
        let (_, others) = text.split_once("beside the motion.\n").expect("the other channels");
        let others =
            parsed(&others.lines().map(|line| line.trim_start_matches("# ")).collect::<Vec<_>>().join("\n"))
                ["channel"]
                .as_array()
                .unwrap()
                .clone();
        assert_eq!(others.len(), 3);
        assert_eq!((&others[1]["name"], &others[1]["end"]), (&"w".into(), &"none".into()));
        assert!(cask_file(&listing(channels[1..].to_vec())).is_err());
    }

    #[test]
    fn no_name_can_break_the_file() {
        let awkward = "a\"]\n[cask]\nname = \\\u{1b}\u{202e}\u{ffff}";
        let mut listing =
            listing(vec![listed(awkward, "column", Some("x\"\ny")), listed("other\n]", "topic", None)]);
        listing.recording = "r\n[evil]".into();
        let text = cask_file(&listing).unwrap();
        assert!(text.contains("\\u202E\\uFFFF") && !text.contains(['\u{202e}', '\u{ffff}']));
        let table = parsed(&text);
        assert_eq!(table["channel"][0]["source"].as_str(), Some(awkward));
        assert!(!table.contains_key("evil"));
    }

    #[test]
    fn a_topic_with_a_dot_keeps_its_table() {
        let place = Source::TopicField { topic: "/a.b".into(), field: "acc.z".into(), channel: None };
        let own = listed("{ topic = \"/a.b\", field = \"acc.z\" }", "number", None);
        let listing = listing(vec![ListedChannel { place: Some(place), ..own }]);
        let table = parsed(&cask_file(&listing).unwrap());
        assert_eq!(table["channel"][0]["source"]["field"].as_str(), Some("acc.z"));
    }

    #[test]
    fn the_tolerances_shown_are_all_and_the_defaults() {
        let text = cask_file(&listing(vec![listed("/daq/a1", "dataset", None)])).unwrap();
        let (_, rest) = text.split_once("# [tolerance]").expect("the table");
        let (table, _) = rest.split_once("\n\n").expect("its end");
        let lines: Vec<&str> = table.lines().skip(1).map(|line| line.trim_start_matches("# ")).collect();
        let stated: toml::Table = lines.join("\n").parse().expect("valid once the marks are off");
        // The sizes that the form's examples of their tolerances are of.
        let cask = Cask { length_m: 5.0, height_m: 0.8, ..super::super::sample::cask_file().cask };
        assert_eq!(stated.len(), TOLERANCES.len());
        for tolerance in &TOLERANCES {
            let shown = stated[tolerance.key].as_float().expect(tolerance.key);
            assert!(
                (shown - tolerance.value_in_file(Tolerances::default(), &cask)).abs() < 1e-9,
                "{}",
                tolerance.key
            );
        }
    }

    fn unreadable(source: &str, unit: Option<&str>) -> ListedChannel {
        let unreadable = Some("9 of 20 cells are no numbers, such as \"x\"".to_owned());
        ListedChannel { unreadable, ..listed(source, "column", unit) }
    }

    #[test]
    fn a_recording_without_channels_is_refused_with_the_reason() {
        for (channels, expected) in [
            (Vec::new(), "it holds nothing"),
            (vec![listed("/daq/time_s", "dataset", Some("s"))], "it holds /daq/time_s"),
            (vec![unreadable("A1", None), unreadable("A2", None)], "A1: 9 of 20 cells"),
            // The readable source is no acceleration, and the acceleration is not readable.
            (vec![unreadable("A1", Some("g")), listed("count", "column", None)], "A1: 9 of 20 cells"),
        ] {
            let refusal = cask_file(&listing(channels)).unwrap_err();
            assert!(refusal.to_string().contains(expected), "{refusal}");
            let mend = refusal.help().unwrap().to_string();
            assert!(mend.contains("dropcheck inspect"), "{mend}");
        }
    }

    #[test]
    fn what_is_left_out_and_what_is_missing_stand_in_the_form() {
        let mut without_rate = listed("A1", "column", Some("g"));
        without_rate.sample_rate_hz = None;
        let mut listing = listing(vec![without_rate, unreadable("A2", Some("g"))]);
        listing.issues = vec![crate::data::ClockFinding::Refused("are they in ms?".into()).into()];
        let text = cask_file(&listing).unwrap();
        assert!(
            text.contains("#   A2: 9 of 20 cells") && text.contains("# Of the recording: are they in ms?")
        );
        let table = parsed(&text);
        assert_eq!(table["channel"].as_array().unwrap().len(), 1);
        assert!(table["channel"][0]["sample_rate_hz"].as_float().is_some_and(f64::is_nan));
    }
}
