//! `[[channel]]` tables to checked channel specifications.

use super::section::Section;
use crate::data::{
    Axis, Cask, ChannelSpec, Coupling, End, MOST_CHANNELS, OtherSpec, RateSpec, RowsOf, SensorRecord, Source,
    Unit, rate_unit_rad_s,
};
use crate::ingest::IngestError;
use std::ops::Range;
use toml::de::DeValue;

const UNITS: &str = "unit = \"g\", \"m/s^2\", or \"V\" or \"mV\" with sensitivity in mV per g; left out: \
                     what the recording says";

/// Keys that say something of the motion, and how many of them of an acceleration alone.
const OF_MOTION: [&str; 10] = [
    "sensitivity",
    "coupling",
    "time_constant_s",
    "reference",
    "axis",
    "position_m",
    "offset_m",
    "polarity",
    "calibration_percent",
    "lateral_m",
];
const OF_ACCELERATION: usize = 4;

/// What a channel with `end = "none"` and an angular-rate sensor are, for keys without a meaning there.
const NO_PART: &str = "a channel with end = \"none\" takes no part in the motion and is shown as recorded; \
                       an accelerometer on the cask has end = \"first\" or \"second\"";
const NO_ACCELERATION: &str = "an angular-rate sensor is DC-coupled, in rad/s or deg/s, with a calibration \
                               of its own; an accelerometer has axis = \"transverse\" or \"axial\"";

/// The channels of the motion and the others, each in the file's order, with names of their own.
pub(super) fn channels(
    root: &Section,
    cask: &Cask,
) -> Result<(Vec<ChannelSpec>, Vec<OtherSpec>), IngestError> {
    let mut channels: Vec<ChannelSpec> = Vec::new();
    let mut others: Vec<OtherSpec> = Vec::new();
    let mut lines: Vec<usize> = Vec::new();
    let tables = root.tables("channel")?;
    if let Some(beyond) = tables.get(MOST_CHANNELS) {
        return Err(beyond.wrong(
            beyond.span(),
            format!("the file has {} channels", tables.len()),
            format!("at most {MOST_CHANNELS}"),
            "keep those of the accelerometers on the cask",
        ));
    }
    for table in tables {
        let (channel, name_span) = channel(&table, cask)?;
        if let Some(first) = channels.iter().position(|other| other.name == channel.name) {
            return Err(table.wrong(
                name_span,
                format!("two channels are named \"{}\", the first on line {}", channel.name, lines[first]),
                "a name of its own".into(),
                "name each channel as the test's documents do, each name once",
            ));
        }
        let is_read = |other: &ChannelSpec| other.source == channel.source && other.rows == channel.rows;
        if let Some(first) = channels.iter().position(is_read) {
            return Err(table.wrong(
                table.place("source"),
                format!(
                    "{} reads the same source as {}, {}",
                    channel.name, channels[first].name, channel.source
                ),
                "read already".into(),
                "`dropcheck inspect RECORDING` lists the sources: name each sensor's own",
            ));
        }
        lines.push(table.line(name_span.start));
        let rate = rate(&table)?;
        if rate.is_some() || end_or_none(&table)?.is_none() {
            let unit = table.words("unit")?;
            others.push(OtherSpec { read: channel.clone(), unit, rate });
        }
        channels.push(channel);
    }
    channels.retain(|channel| others.iter().all(|other| other.read.name != channel.name));
    Ok((channels, others))
}

fn channel(table: &Section, cask: &Cask) -> Result<(ChannelSpec, Range<usize>), IngestError> {
    let name = table.required_text("name")?;
    let Some(end) = end_or_none(table)? else {
        let words = ["beside end = \"none\"", "only with \"first\" or \"second\"", NO_PART];
        without_meaning(table, &OF_MOTION, words)?;
        return Ok((other(table, &name.value)?, name.span));
    };
    if rate(table)?.is_some() {
        return Ok((ChannelSpec { end, ..other(table, &name.value)? }, name.span));
    }
    let axis = axis(table)?.ok_or_else(|| table.missing("axis", AXIS))?;
    let source = source(table)?;
    let unit = unit(table)?;
    let position_m = position_m(table, cask)?;
    let spec = ChannelSpec {
        name: name.value,
        end,
        axis,
        source,
        unit,
        position_m,
        offset_m: table.given("offset_m")?.unwrap_or(0.0),
        polarity: polarity(table)?,
        full_scale: table.given("full_scale")?,
        sample_rate_hz: table.given("sample_rate_hz")?,
        rows: rows(table)?,
        time: table.words("time")?,
        coupling: coupling(table)?,
        calibration: table.given("calibration_percent")?.map(|percent| percent / 100.0),
        reference: table.words("reference")?,
        lateral_m: table.given("lateral_m")?.unwrap_or(0.0),
        sensor: sensor(table)?,
    };
    Ok((spec, name.span))
}

/// Refuses the first of these keys that stands in the table; the words say beside what, what it goes with,
/// and why.
fn without_meaning(
    table: &Section,
    keys: &[&str],
    [beside, goes_with, why]: [&str; 3],
) -> Result<(), IngestError> {
    keys.iter().find(|key| table.value(key).is_some()).map_or(Ok(()), |key| {
        let problem = format!("{key} has no meaning {beside}");
        Err(table.wrong(table.place(key), problem, goes_with.into(), &format!("delete {key}: {why}")))
    })
}

/// Whether the table is that of an angular-rate sensor.
pub(crate) fn is_rate(table: &Section) -> bool {
    table.value("axis").and_then(|axis| axis.get_ref().as_str()) == Some("rate")
}

/// What the table says of an angular-rate sensor; `None` where it is none.
fn rate(table: &Section) -> Result<Option<RateSpec>, IngestError> {
    if !is_rate(table) || end_or_none(table)?.is_none() {
        return Ok(None);
    }
    let words = ["beside axis = \"rate\"", "only with \"transverse\" or \"axial\"", NO_ACCELERATION];
    without_meaning(table, &OF_MOTION[..OF_ACCELERATION], words)?;
    if let Some(unit) = table.text("unit")?.filter(|unit| rate_unit_rad_s(&unit.value).is_none()) {
        let problem = format!("\"{}\" is no unit of a rate of turn", unit.value);
        let mend = "unit = \"rad/s\" or \"deg/s\"; left out: what the recording says";
        return Err(table.wrong(unit.span, problem, "\"rad/s\" or \"deg/s\"".into(), mend));
    }
    // A rigid body turns alike everywhere, so that its place says nothing.
    for key in ["position_m", "offset_m", "lateral_m"] {
        table.number(key)?;
    }
    let calibration = table.given("calibration_percent")?.map(|percent| percent / 100.0);
    Ok(Some(RateSpec { polarity: polarity(table)?, calibration }))
}

/// A channel of this name that is no accelerometer.
fn other(table: &Section, name: &str) -> Result<ChannelSpec, IngestError> {
    Ok(ChannelSpec {
        source: source(table)?,
        full_scale: table.given("full_scale")?,
        sample_rate_hz: table.given("sample_rate_hz")?,
        rows: rows(table)?,
        time: table.words("time")?,
        sensor: sensor(table)?,
        ..ChannelSpec::plain(name, End::First, "", 0.0)
    })
}

fn sensor(table: &Section) -> Result<SensorRecord, IngestError> {
    Ok(SensorRecord {
        serial: table.words("serial")?,
        certificate: table.words("certificate")?,
        calibrated: table.date("calibrated")?,
    })
}

/// The end of the cask; `None` of a channel that takes no part in the motion.
fn end_or_none(table: &Section) -> Result<Option<End>, IngestError> {
    let words = [("first", Some(End::First)), ("second", Some(End::Second)), ("none", None)];
    table.word("end", &words, END)?.ok_or_else(|| table.missing("end", END))
}

const END: &str = "end = \"first\" (low, touches first) or \"second\" (slaps down); \"none\" for a channel \
                   that takes no part in the motion, such as strain or temperature";
const AXIS: &str = "axis = \"transverse\" (across the cask, in the plane of the drop), \"axial\" (along it), \
                    or \"rate\" of an angular-rate sensor";

/// The axis of an accelerometer; `None` where the table has none, or an angular-rate sensor.
pub(crate) fn axis(table: &Section) -> Result<Option<Axis>, IngestError> {
    let words = [("transverse", Some(Axis::Transverse)), ("axial", Some(Axis::Axial)), ("rate", None)];
    Ok(table.word("axis", &words, AXIS)?.flatten())
}

fn source(table: &Section) -> Result<Source, IngestError> {
    const MEND: &str = "`dropcheck inspect RECORDING` lists what to write: source = \"/topic.field\" (MCAP), \
                        \"/group/dataset\" or \"/dataset[2]\" (HDF5), a column's header (CSV)";
    let Some(value) = table.value("source") else { return Err(table.missing("source", MEND)) };
    if !value.get_ref().is_table() {
        return Ok(Source::Path(table.required_text("source")?.value));
    }
    let parts = table.table("source")?;
    Ok(Source::TopicField {
        topic: parts.required_text("topic")?.value,
        field: parts.required_text("field")?.value,
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the key's row bounds it"
        )]
        channel: parts.given("channel")?.map(|channel| channel as u16),
    })
}

fn rows(table: &Section) -> Result<Option<RowsOf>, IngestError> {
    if table.value("where").is_none() {
        return Ok(None);
    }
    let parts = table.table("where")?;
    let column = parts.required_text("column")?.value;
    let is = match parts.value("is").map(toml::Spanned::get_ref) {
        Some(DeValue::Integer(number)) => number.as_str().to_owned(),
        _ => parts.required_text("is")?.value,
    };
    Ok(Some(RowsOf { column, is }))
}

fn unit(table: &Section) -> Result<Option<Unit>, IngestError> {
    let words = [
        ("g", Unit::G),
        ("m/s^2", Unit::MetrePerSecondSquared),
        ("V", Unit::Volt { sensitivity_mv_per_g: f64::NAN }),
        ("mV", Unit::Millivolt { sensitivity_mv_per_g: f64::NAN }),
    ];
    let mut unit = table.word("unit", &words, UNITS)?;
    let given = table.number("sensitivity")?;
    match (&mut unit, given) {
        (Some(Unit::Volt { sensitivity_mv_per_g } | Unit::Millivolt { sensitivity_mv_per_g }), given) => {
            let given = given.ok_or_else(|| {
                table.wrong(
                    table.place("unit"),
                    "a unit of voltage needs sensitivity".into(),
                    "needs sensitivity beside it".into(),
                    "add sensitivity = 10.0, in mV per g, from the sensor's calibration sheet (with the \
                     amplifier's gain)",
                )
            })?;
            *sensitivity_mv_per_g = given.value;
        }
        (_, Some(given)) => {
            return Err(table.wrong(
                given.span,
                "sensitivity has no meaning without unit = \"V\" or \"mV\"".into(),
                "only with \"V\" or \"mV\"".into(),
                "write unit = \"V\" or \"mV\" if the recording holds voltages; delete sensitivity if it \
                 holds g or m/s²",
            ));
        }
        _ => {}
    }
    Ok(unit)
}

pub(crate) fn position_m(table: &Section, cask: &Cask) -> Result<f64, IngestError> {
    let position = table.required_number("position_m")?;
    if (0.0..=cask.length_m).contains(&position.value) {
        return Ok(position.value);
    }
    Err(table.wrong(
        position.span,
        format!("position_m {} lies outside the cask, which is {} m long", position.value, cask.length_m),
        format!("0 to {} m", cask.length_m),
        "position_m counts along the axis from the first end, in metres, for sensors on the second end too",
    ))
}

pub(crate) fn polarity(table: &Section) -> Result<f64, IngestError> {
    match table.number("polarity")? {
        None => Ok(1.0),
        Some(polarity) if (polarity.value.abs() - 1.0).abs() < f64::EPSILON => Ok(polarity.value.signum()),
        Some(polarity) => Err(table.wrong(
            polarity.span,
            format!("polarity is {}", polarity.value),
            "1 or -1".into(),
            "-1 is for a sensor mounted the other way round; a scale belongs into sensitivity",
        )),
    }
}

pub(crate) fn coupling(table: &Section) -> Result<Coupling, IngestError> {
    const MEND: &str =
        "coupling = \"dc\" (the default: reads constant acceleration) or \"ac\" with time_constant_s";
    let is_ac = table.word("coupling", &[("dc", false), ("ac", true)], MEND)?.unwrap_or(false);
    match (is_ac, table.number("time_constant_s")?) {
        (true, Some(constant)) => Ok(Coupling::Ac { time_constant_s: constant.value }),
        (true, None) => Err(table.wrong(
            table.place("coupling"),
            "coupling = \"ac\" needs time_constant_s".into(),
            "needs time_constant_s beside it".into(),
            "add time_constant_s, in s: 1/(2π f) with f the lower −3 dB corner in Hz from the data sheet \
             (0.5 Hz: 0.318)",
        )),
        (false, Some(constant)) => Err(table.wrong(
            constant.span,
            "time_constant_s has no meaning without coupling = \"ac\"".into(),
            "only with \"ac\"".into(),
            "write coupling = \"ac\" if the channel is AC-coupled; else delete time_constant_s",
        )),
        (false, None) => Ok(Coupling::Dc),
    }
}
