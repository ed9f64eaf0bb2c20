//! What a recording holds to a commented cask file to fill in.

use super::likely::{self, NoChannels, VOLTAGES, is_time, names_end};
use super::text::{is_hidden, line, printable};
use crate::data::{ListedChannel, Listing, MOST_CHANNELS, Severity, acceleration_unit_m_s2};
use std::fmt::Write;

/// The mark behind every value that only the user knows.
const FILL_IN: &str = "FILL IN";

/// The cask file, valid TOML; what only the user knows is marked, its numbers NaN: a likely one, forgotten, would pass for a measured one.
///
/// # Errors
/// [`NoChannels`] where nothing that looks like an acceleration can be read.
pub fn cask_file(listing: &Listing) -> Result<String, NoChannels> {
    let mut taken = likely::accelerations(listing);
    let beyond = taken.len().saturating_sub(MOST_CHANNELS);
    taken.truncate(MOST_CHANNELS);
    if taken.is_empty() {
        return Err(likely::none(listing));
    }
    let mut out = head(listing);
    for issue in listing.issues.iter().filter(|issue| issue.severity != Severity::Note) {
        line(&mut out, format_args!("# Of the recording: {}", printable(&issue.message)));
    }
    let mut devices: Vec<&str> = Vec::new();
    for (i, listed) in taken.iter().enumerate() {
        let device = device(&listed.source);
        let place = devices.iter().position(|known| *known == device).unwrap_or_else(|| {
            devices.push(device);
            devices.len() - 1
        });
        channel(&mut out, i, place.is_multiple_of(2), listed);
    }
    if beyond > 0 {
        line(
            &mut out,
            format_args!(
                "\n# {beyond} more look like these; a cask file holds at most {MOST_CHANNELS} channels."
            ),
        );
    }
    let left = listing.channels.iter().filter(|c| !taken.iter().any(|t| t.source == c.source));
    let (unreadable, other): (Vec<&ListedChannel>, Vec<_>) = left.partition(|c| c.unreadable.is_some());
    if !unreadable.is_empty() {
        out.push_str("\n# Also in the recording, but it cannot be read:\n");
        for listed in unreadable {
            line(&mut out, format_args!("#   {}", printable(&likely::reason(listed))));
        }
    }
    if !other.is_empty() {
        out.push_str("\n# Also in the recording, but it does not move or does not look like an acceleration in the plane of the drop:\n");
        for listed in other {
            line(&mut out, format_args!("#   {}", printable(&listed.source)));
        }
    }
    Ok(out)
}

fn head(listing: &Listing) -> String {
    let mut out = String::new();
    line(&mut out, format_args!("# Cask file for {}", printable(&listing.recording)));
    line(
        &mut out,
        format_args!(
            "# Lines marked \"{FILL_IN}\" hold what only you know: nan is no number, and is refused until you replace it."
        ),
    );
    line(
        &mut out,
        format_args!("# Lengths in m, mass in kg, angles in degrees. A line behind # is optional.\n"),
    );
    line(
        &mut out,
        format_args!(
            r#"[cask]
name = "CASK"               # {FILL_IN}: the cask's name
mass_kg = nan               # {FILL_IN}
length_m = nan              # {FILL_IN}: along the axis, between the two ends that strike
# height_m = 0.8            # cross-section in the plane of the drop; left out: a thin rod
# width_m = 0.8             # across that plane, reported only
# cog_m = 2.5               # centre of gravity from the first end; left out: length_m / 2
# inertia_kg_m2 = 2100.0    # about the centre of gravity; left out: m (l² + h²) / 12

[drop]
height_m = nan              # {FILL_IN}: free-fall height of the lowest point
angle_deg = nan             # {FILL_IN}: inclination of the axis above the horizontal
# impact_velocity_m_s = 13.3  # overrides √(2 g h)
# gravity_m_s2 = 9.81       # this is the default

# [contact]
# friction = "rough"        # "rough" (default), "smooth" or a Coulomb coefficient such as 0.4

# [filter]                  # left out: chosen from the mass and the data; give one of the two
# cfc = 180                 # a channel frequency class of SAE J211 / ISO 6487
# cutoff_hz = 400.0         # a −3 dB cut-off

# [tolerance]               # half-widths of 95 % intervals; these are the defaults
# angle_deg = 0.4           # drop angle
# impact_velocity_percent = 0.3
# calibration_percent = 1.0 # scale of a channel
# cross_axis_percent = 2.0  # what a sensor reads of the other body axis, tilt included
# position_m = 0.01         # place of a sensor along the axis
# cog_m = 0.01              # centre of gravity
# inertia_percent = 2.0
# friction_percent = 2.0    # contact law, of the way from rough to smooth
# clock_percent = 0.05      # rate of the recorder's clock

# [corrections]             # all are made; false leaves one out
# offset = true             # mean of the free fall
# zero_shift = true         # change of the offset at the first impact
# skew = true               # a channel stamped late or early
# hum = true                # mains hum
"#
        ),
    );
    match listing.channels.iter().find(|c| is_time(&c.source) && c.kind != "number" && c.kind != "array") {
        Some(time) => {
            line(&mut out, format_args!("# [recording]"));
            line(&mut out, format_args!("# time = {}   # where the times are not found by themselves\n", quoted(&time.source)));
        }
        None => out.push_str(
            "# [recording]\n# time = \"time_s\"           # CSV column or HDF5 dataset with the times, where they are not found by themselves\n\n",
        ),
    }
    out.push_str(
        "# At least one transverse channel on each end. The first end is low and touches first.\n\
         # Ends, axes and signs below are guesses: check each against the test plan.\n",
    );
    out
}

fn channel(out: &mut String, index: usize, guessed_first: bool, listed: &ListedChannel) {
    let source = listed.source.as_str();
    let first = names_end(source).unwrap_or(guessed_first);
    let end = if first { "first" } else { "second" };
    let axial = source.rsplit('.').next() == Some("x") && source.contains("acceleration");
    let axis = if axial { "axial" } else { "transverse" };
    out.push_str("\n[[channel]]\n");
    line(out, format_args!("# {}", facts(listed)));
    line(out, format_args!("name = \"A{}\"", index + 1));
    line(out, format_args!("end = \"{end}\"{}# check: \"first\" or \"second\"", pad(end.len() + 8)));
    line(out, format_args!("axis = \"{axis}\"{}# check: \"transverse\" or \"axial\"", pad(axis.len() + 9)));
    line(out, format_args!("source = {}", source_value(source)));
    unit(out, listed.unit.as_deref());
    line(out, format_args!("position_m = nan            # {FILL_IN}: along the axis, from the first end"));
    out.push_str(
        "# offset_m = 0.0            # across the axis, positive away from the target\n\
         # polarity = 1              # -1: mounted the other way round\n\
         # full_scale = 2000.0       # in `unit`: where the channel clips\n",
    );
    if listed.sample_rate_hz.is_some() {
        out.push_str("# sample_rate_hz = 100000.0 # overrides what the recording says\n");
    } else {
        line(
            out,
            format_args!(
                "sample_rate_hz = nan        # {FILL_IN}: no rate or times were found; or name the times below and take this line out"
            ),
        );
    }
    out.push_str(
        "# time = \"/daq/time_s\"      # this channel's own times (CSV column, HDF5 dataset)\n\
         # coupling = \"dc\"           # or \"ac\", then also time_constant_s = 0.3\n",
    );
}

/// What the axes of one sensor share: the topic of a message path with a vector, else the source itself.
fn device(source: &str) -> &str {
    match source.split_once('.') {
        Some((topic, field)) if source.starts_with('/') && field.contains('.') => topic,
        _ => source,
    }
}

fn unit(out: &mut String, told: Option<&str>) {
    match told {
        Some(unit) if acceleration_unit_m_s2(unit).is_some() => {
            line(
                out,
                format_args!(
                    "# unit = {}{}# left out: the recording says so itself",
                    quoted(unit),
                    pad(unit.len() + 11)
                ),
            );
        }
        Some(unit) if VOLTAGES.contains(&unit) => {
            line(out, format_args!("unit = {}{}# as the recording says", quoted(unit), pad(unit.len() + 9)));
            line(out, format_args!("sensitivity = nan           # {FILL_IN}: mV per g"));
        }
        told => {
            let quoted = |unit| format!("the recording says {:?}", printable(unit));
            let says = told.map_or_else(|| "the recording does not say".to_owned(), quoted);
            line(
                out,
                format_args!(
                    "unit = \"g\"                  # {FILL_IN}: \"g\", \"m/s^2\", \"V\" or \"mV\"; {says}"
                ),
            );
            line(out, format_args!("# sensitivity = 10.0        # mV per g, with \"V\" and \"mV\""));
        }
    }
}

fn pad(used: usize) -> String {
    " ".repeat(28usize.saturating_sub(used).max(1))
}

fn facts(listed: &ListedChannel) -> String {
    let mut facts = Vec::new();
    if let Some(n) = listed.samples {
        facts.push(format!("{n} samples"));
    }
    if let Some(rate) = listed.sample_rate_hz {
        facts.push(format!("{} Hz", super::rounding::plain(rate, 7)));
    }
    if let Some((low, high)) = listed.range {
        let three = |v| super::rounding::significant(v, 3);
        facts.push(format!("{} to {} {}", three(low), three(high), listed.unit.as_deref().unwrap_or("")));
    }
    facts.push(listed.encoding.clone());
    printable(&facts.join(", "))
}

/// A source as TOML: a listing may tell it as the table of topic and field, else it is a string.
fn source_value(source: &str) -> String {
    let table = format!("source = {source}").parse::<toml::Table>().ok().and_then(|t| {
        let table = t.get("source")?.as_table()?;
        let (topic, field) = (table.get("topic")?.as_str()?, table.get("field")?.as_str()?);
        (t.len() == 1 && table.len() == 2)
            .then(|| format!("{{ topic = {}, field = {} }}", quoted(topic), quoted(field)))
    });
    table.unwrap_or_else(|| quoted(source))
}

/// A TOML basic string.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if is_hidden(c) => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::super::listing::tests::{listed, listing};
    use super::*;

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
        assert_eq!(channels[0]["end"].as_str(), Some("first"));
        assert_eq!(channels[1]["end"].as_str(), Some("second"));
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
            assert_eq!(channel["axis"].as_str().unwrap() == "axial", source.contains("acceleration.x"));
        }
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
        let listing = listing(vec![listed("{ topic = \"/a.b\", field = \"acc.z\" }", "number", None)]);
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
        let d = crate::data::Tolerances::default();
        let expected = [
            ("angle_deg", d.angle_rad.to_degrees()),
            ("impact_velocity_percent", 100.0 * d.impact_velocity),
            ("calibration_percent", 100.0 * d.calibration),
            ("cross_axis_percent", 100.0 * d.cross_axis),
            ("position_m", d.position_m),
            ("cog_m", d.cog_m),
            ("inertia_percent", 100.0 * d.inertia),
            ("friction_percent", 100.0 * d.friction),
            ("clock_percent", 100.0 * d.clock),
        ];
        assert_eq!(stated.len(), expected.len());
        for (key, value) in expected {
            assert!((stated[key].as_float().expect(key) - value).abs() < 1e-9, "{key}");
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
            // What can be read is no acceleration, and what is one cannot.
            (vec![unreadable("A1", Some("g")), listed("count", "column", None)], "A1: 9 of 20 cells"),
        ] {
            let refusal = cask_file(&listing(channels)).unwrap_err();
            assert!(refusal.to_string().contains(expected), "{refusal}");
            let mend = miette::Diagnostic::help(&refusal).unwrap().to_string();
            assert!(mend.contains("dropcheck inspect"), "{mend}");
        }
    }

    #[test]
    fn what_is_left_out_and_what_is_missing_stand_in_the_form() {
        let mut without_rate = listed("A1", "column", Some("g"));
        without_rate.sample_rate_hz = None;
        let mut listing = listing(vec![without_rate, unreadable("A2", Some("g"))]);
        let doubt = crate::data::IssueCode::Clock;
        listing.issues = vec![crate::data::Issue::new(doubt, Severity::Warning, "are they in ms?")];
        let text = cask_file(&listing).unwrap();
        assert!(
            text.contains("#   A2: 9 of 20 cells") && text.contains("# Of the recording: are they in ms?")
        );
        let table = parsed(&text);
        assert_eq!(table["channel"].as_array().unwrap().len(), 1);
        assert!(table["channel"][0]["sample_rate_hz"].as_float().is_some_and(f64::is_nan));
    }
}
