//! `[[channel]]` tables to checked channel specifications.

use super::section::Section;
use crate::data::{
    Axis, Cask, ChannelSpec, Coupling, End, MOST_CHANNELS, OtherSpec, RateSpec, RowsOf, SensorRecord,
    SkinDirection, SkinPlace, Source, Unit, rate_unit_rad_s,
};
use crate::ingest::IngestError;
use crate::numerics::as_count;
use toml::de::DeValue;

const UNITS: &str = "unit = \"g\", \"m/s^2\", or \"V\" or \"mV\" with sensitivity in mV per g; left out: \
                     what the recording says";

/// Keys that say something of the motion, and how many of them of an acceleration alone.
#[rustfmt::skip]
const OF_MOTION: [&str; 12] = [
    "sensitivity", "coupling", "time_constant_s", "reference",
    "axis", "position_m", "offset_m", "polarity", "calibration_percent", "lateral_m", "around_deg",
    "direction",
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
    let (mut channels, mut others): (Vec<ChannelSpec>, Vec<OtherSpec>) = (Vec::new(), Vec::new());
    let tables = root.tables("channel")?;
    if let Some(beyond) = tables.get(MOST_CHANNELS) {
        let message = format!("the file has {} channels, and at most {MOST_CHANNELS} are read", tables.len());
        return Err(beyond.refuse("name", message, "keep those of the accelerometers on the cask"));
    }
    for table in &tables {
        let channel = channel(table, cask)?;
        let name = &channel.name;
        if let Some(first) = channels.iter().position(|other| other.name == *name) {
            let line = tables[first].line("name");
            let message = format!("two channels are named \"{name}\", the first on line {line}");
            let mend = "name each channel as the test's documents do, each name once";
            return Err(table.refuse("name", message, mend));
        }
        let is_read = |other: &&ChannelSpec| {
            (&other.source, &other.rows, &other.file) == (&channel.source, &channel.rows, &channel.file)
        };
        if let Some(first) = channels.iter().find(is_read) {
            let message = format!("{name} reads the same source as {}, {}", first.name, channel.source);
            let mend = "`dropcheck inspect RECORDING` lists the sources: name each sensor's own";
            return Err(table.refuse("source", message, mend));
        }
        let rate = rate(table)?;
        let is_across = channel.skin.is_some_and(SkinPlace::is_across);
        if rate.is_some() || is_across || end_or_none(table)?.is_none() {
            // Shown as recorded.
            let read = ChannelSpec { polarity: 1.0, ..channel.clone() };
            others.push(OtherSpec { read, unit: table.text("unit")?, rate });
        }
        channels.push(channel);
    }
    channels.retain(|channel| others.iter().all(|other| other.read.name != channel.name));
    Ok((channels, others))
}

fn channel(table: &Section, cask: &Cask) -> Result<ChannelSpec, IngestError> {
    let name = table.required_text("name")?;
    let end = end_or_none(table)?;
    let plain = ChannelSpec {
        source: source(table)?,
        scale: table.given("scale")?,
        full_scale: table.given("full_scale")?,
        sample_rate_hz: table.given("sample_rate_hz")?,
        file: table.text("file")?,
        rows: rows(table)?,
        time: table.text("time")?,
        sensor: sensor(table)?,
        ..ChannelSpec::new(&name, end.unwrap_or(End::First), "", 0.0)
    };
    if end.is_none() {
        without_meaning(table, &OF_MOTION, ["end = \"none\"", NO_PART])?;
        return Ok(plain);
    }
    if rate(table)?.is_some() {
        return Ok(plain);
    }
    let skin = skin(table, cask)?;
    let around_rad = skin.map(|skin| skin.around_rad);
    let offset_m = around_rad.map_or(0.0, |around| -around.cos() * cask.height_m / 2.0);
    let lateral_m =
        around_rad.map_or(0.0, |around| around.sin() * cask.width_m.unwrap_or(cask.height_m) / 2.0);
    let axis = match skin {
        Some(skin) if skin.direction == SkinDirection::Axial => Axis::Axial,
        Some(_) => Axis::Transverse,
        None => axis(table)?.ok_or_else(|| table.missing("axis", AXIS))?,
    };
    Ok(ChannelSpec {
        axis,
        skin,
        unit: unit(table)?,
        position_m: position_m(table, cask)?,
        offset_m: table.given("offset_m")?.unwrap_or(offset_m),
        polarity: polarity(table)?,
        coupling: coupling(table)?,
        calibration: calibration(table)?,
        reference: table.text("reference")?,
        lateral_m: table.given("lateral_m")?.unwrap_or(lateral_m),
        ..plain
    })
}

/// Refuses the first of these keys that stands in the table; the words say beside what, and why.
fn without_meaning(table: &Section, keys: &[&str], [beside, why]: [&str; 2]) -> Result<(), IngestError> {
    keys.iter().find(|key| table.value(key).is_some()).map_or(Ok(()), |key| {
        let problem = format!("{key} has no meaning beside {beside}");
        Err(table.refuse(key, problem, &format!("delete {key}: {why}")))
    })
}

/// Refuses a number that stands without the words `with` of another key, or those words without the number;
/// the mends say how to add it, and when to delete it.
fn only_with(
    table: &Section,
    key: &str,
    with: &str,
    is_with: bool,
    [add, delete]: [&str; 2],
) -> Result<(), IngestError> {
    let other = with.split(' ').next().unwrap_or(with);
    match (is_with, table.given(key)?) {
        (true, None) => Err(table.refuse(other, format!("{with} needs {key}"), add)),
        (false, Some(_)) => Err(table.refuse(key, format!("{key} has no meaning without {with}"), delete)),
        _ => Ok(()),
    }
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
    without_meaning(table, &OF_MOTION[..OF_ACCELERATION], ["axis = \"rate\"", NO_ACCELERATION])?;
    if let Some(unit) = table.text("unit")?.filter(|unit| rate_unit_rad_s(unit).is_none()) {
        let mend = "unit = \"rad/s\" or \"deg/s\"; left out: what the recording says";
        return Err(table.refuse("unit", format!("\"{unit}\" is no unit of a rate of turn"), mend));
    }
    // A rigid body turns alike everywhere, so that its place says nothing.
    for key in ["position_m", "offset_m", "lateral_m", "around_deg"] {
        table.given(key)?;
    }
    Ok(Some(RateSpec { polarity: polarity(table)?, calibration: calibration(table)? }))
}

/// As a share.
fn calibration(table: &Section) -> Result<Option<f64>, IngestError> {
    Ok(table.given("calibration_percent")?.map(|percent| percent / 100.0))
}

fn sensor(table: &Section) -> Result<SensorRecord, IngestError> {
    Ok(SensorRecord {
        serial: table.text("serial")?,
        certificate: table.text("certificate")?,
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

/// Where around the skin the channel sits; `None` where the table states an axis instead.
fn skin(table: &Section, cask: &Cask) -> Result<Option<SkinPlace>, IngestError> {
    const AROUND: &str = "around_deg counts from the lowest line (0) by the side (90) to the uppermost \
                          (180); direction = \"radial\" (positive outwards), \"tangential\" \
                          (positive towards a larger angle) or \"axial\"";
    const BESIDE: [&str; 2] = ["around_deg", "around_deg and direction state both place and axis"];
    let Some(around_deg) = table.given("around_deg")? else {
        without_meaning(table, &["direction"], ["axis, without around_deg", AROUND])?;
        return Ok(None);
    };
    without_meaning(table, &["axis", "offset_m", "lateral_m"], BESIDE)?;
    if cask.height_m <= 0.0 {
        let mend = "state `height_m` under [cask], or place the sensor by `axis` and `offset_m`";
        return Err(table.refuse("around_deg", "a thin rod (height_m = 0) has no skin", mend));
    }
    let words = [
        ("radial", SkinDirection::Radial),
        ("tangential", SkinDirection::Tangential),
        ("axial", SkinDirection::Axial),
    ];
    let direction = table.word("direction", &words, AROUND)?;
    let direction = direction.ok_or_else(|| table.missing("direction", AROUND))?;
    Ok(Some(SkinPlace { around_rad: around_deg.to_radians(), direction }))
}

fn source(table: &Section) -> Result<Source, IngestError> {
    const MEND: &str = "`dropcheck inspect RECORDING` lists what to write: source = \"/topic.field\" (MCAP), \
                        \"/group/dataset\" or \"/dataset[2]\" (HDF5), a column's header (CSV)";
    let Some(value) = table.value("source") else { return Err(table.missing("source", MEND)) };
    if !value.get_ref().is_table() {
        return Ok(Source::Path(table.required_text("source")?));
    }
    let parts = table.table("source")?;
    Ok(Source::TopicField {
        topic: parts.required_text("topic")?,
        field: parts.required_text("field")?,
        channel: parts.given("channel")?.and_then(|channel| u16::try_from(as_count(channel)).ok()),
    })
}

fn rows(table: &Section) -> Result<Option<RowsOf>, IngestError> {
    if table.value("where").is_none() {
        return Ok(None);
    }
    let parts = table.table("where")?;
    let column = parts.required_text("column")?;
    let is = match parts.value("is").map(toml::Spanned::get_ref) {
        Some(DeValue::Integer(number)) => number.as_str().to_owned(),
        _ => parts.required_text("is")?,
    };
    Ok(Some(RowsOf { column, is }))
}

fn unit(table: &Section) -> Result<Option<Unit>, IngestError> {
    const MENDS: [&str; 2] = [
        "add sensitivity = 10.0, in mV per g, from the sensor's calibration sheet (with the amplifier's \
         gain)",
        "write unit = \"V\" or \"mV\" if the recording holds voltages; delete sensitivity if it holds g \
         or m/s²",
    ];
    let sensitivity_mv_per_g = table.given("sensitivity")?.unwrap_or(f64::NAN);
    let words = [
        ("g", Unit::G),
        ("m/s^2", Unit::MetrePerSecondSquared),
        ("V", Unit::Volt { sensitivity_mv_per_g }),
        ("mV", Unit::Millivolt { sensitivity_mv_per_g }),
    ];
    let unit = table.word("unit", &words, UNITS)?;
    let is_voltage = matches!(unit, Some(Unit::Volt { .. } | Unit::Millivolt { .. }));
    only_with(table, "sensitivity", "unit = \"V\" or \"mV\"", is_voltage, MENDS)?;
    Ok(unit)
}

fn position_m(table: &Section, cask: &Cask) -> Result<f64, IngestError> {
    let position_m = table.required_number("position_m")?;
    if (0.0..=cask.length_m).contains(&position_m) {
        return Ok(position_m);
    }
    let message = format!("position_m {position_m} lies outside the cask, which is {} m long", cask.length_m);
    let mend = "position_m counts along the axis from the first end, in metres, for sensors on the second \
                end too";
    Err(table.refuse("position_m", message, mend))
}

pub(crate) fn polarity(table: &Section) -> Result<f64, IngestError> {
    let polarity = table.given("polarity")?.unwrap_or(1.0);
    if (polarity.abs() - 1.0).abs() < f64::EPSILON {
        return Ok(polarity.signum());
    }
    let mend = "-1 is for a sensor mounted the other way round; a scale belongs into sensitivity";
    Err(table.refuse("polarity", format!("polarity is {polarity}, and not 1 or -1"), mend))
}

pub(crate) fn coupling(table: &Section) -> Result<Coupling, IngestError> {
    const MEND: &str =
        "coupling = \"dc\" (the default: reads constant acceleration) or \"ac\" with time_constant_s";
    const MENDS: [&str; 2] = [
        "add time_constant_s, in s: 1/(2π f) with f the lower −3 dB corner in Hz from the data sheet \
         (0.5 Hz: 0.318)",
        "write coupling = \"ac\" if the channel is AC-coupled; else delete time_constant_s",
    ];
    let is_ac = table.word("coupling", &[("dc", false), ("ac", true)], MEND)?.unwrap_or(false);
    only_with(table, "time_constant_s", "coupling = \"ac\"", is_ac, MENDS)?;
    let constant_s = table.given("time_constant_s")?;
    Ok(constant_s.map_or(Coupling::Dc, |time_constant_s| Coupling::Ac { time_constant_s }))
}
