//! The keys of a cask file, one row each; those of `[tolerance]` and `[corrections]` stand in
//! [`super::tolerances`] with their values.
//!
//! The parser, the form that `init` writes, and the table in docs/formats.md are made from these rows.

use super::SAMPLE_RATES_HZ;
#[cfg(feature = "lab")]
pub(crate) use super::key::flag;
pub use super::key::{Allowed, FILL_IN, Key, KeyTable, REQUIRED, Takes};
pub(crate) use super::key::{number, text};
pub use super::tolerances::{CORRECTIONS, TOLERANCE};

/// Tables that stand as the value of a key: no line of a file begins them.
pub const INNER_TABLES: [&str; 4] = ["source", "where", "observation", "limit"];

/// The tables of a cask file, in the order of the form.
pub static TABLES: [KeyTable; 16] = [
    KeyTable { name: "test", remark: "for the head of the report; changes no number", keys: &TEST },
    KeyTable { name: "cask", remark: "", keys: &CASK },
    KeyTable { name: "drop", remark: "", keys: &DROP },
    KeyTable { name: "contact", remark: "", keys: &CONTACT },
    KeyTable { name: "filter", remark: "left out: chosen from the mass; give one of the two", keys: &FILTER },
    KeyTable {
        name: "tolerance",
        remark: "half-widths of 95 % intervals; these are the defaults",
        keys: &TOLERANCE,
    },
    KeyTable { name: "corrections", remark: "all are made; false leaves one out", keys: &CORRECTIONS },
    KeyTable { name: "recording", remark: "", keys: &RECORDING },
    KeyTable {
        name: "observed",
        remark: "what was seen otherwise, held against the result",
        keys: &OBSERVED,
    },
    KeyTable { name: "limits", remark: "the customer's, held against the result", keys: &LIMITS },
    KeyTable { name: "report", remark: "around the page report.html", keys: &REPORT },
    KeyTable { name: "channel", remark: "", keys: &CHANNEL },
    KeyTable { name: "source", remark: "", keys: &SOURCE },
    KeyTable { name: "where", remark: "", keys: &WHERE },
    KeyTable { name: "observation", remark: "", keys: &OBSERVATION },
    KeyTable { name: "limit", remark: "one of the two or both", keys: &LIMIT },
];

/// Keys of `[test]`.
pub const TEST: [Key; 13] = [
    text("id", "–").shown(r#""SD-2026-014""#, "number of the test"),
    text("title", "–").shown(r#""Slap-down at 15°""#, ""),
    text("place", "–").shown(r#""Drop tower""#, ""),
    text("operator", "–").shown(r#""J. Doe""#, "who carried it out"),
    text("customer", "–").shown(r#""Customer""#, ""),
    text("specimen", "–").shown(r#""Model 1:2, No. 3""#, "what was dropped"),
    text("target", "–").shown(r#""IAEA target, 1000 t""#, "onto what"),
    text("remarks", "–").shown(r#""second drop of this model""#, ""),
    Key { takes: Takes::Date, ..text("date", "–") }.shown("2026-11-22T09:40:00+01:00", "without quotes"),
    number("temperature_c", "–")
        .within(-100.0, 200.0, "of the specimen, in °C")
        .shown("12.5", "of the specimen"),
    Key { takes: Takes::Texts, ..text("photos", "–") }
        .shown(r#"["before.jpg"]"#, "PNG or JPEG in the folder of this file"),
    Key { takes: Takes::Texts, ..text("signatures", "–") }
        .shown(r#"["Test engineer", "Reviewer"]"#, "lines to sign"),
    Key { takes: Takes::Table, ..text("more", "–") }
        .shown(r#"{ "Drop rig" = "Hall 3" }"#, "anything else, printed as it stands"),
];

/// Keys of `[observed]`.
pub const OBSERVED: [Key; 6] = [
    observation("slap_down_speed_m_s", "{ value = 20.4, u95 = 0.3, by = \"video\" }", "slap-down speed"),
    observation("k", "{ value = 0.55, u95 = 0.05 }", "coefficient of restitution"),
    observation("angular_velocity_rad_s", "{ value = 4.6, u95 = 0.1 }", "angular velocity"),
    observation("angle_deg", "{ value = 1.0, u95 = 0.5 }", "angle at slap-down"),
    observation("flight_time_s", "{ value = 0.056, u95 = 0.001 }", "flight time"),
    observation("impact_velocity_m_s", "{ value = 13.25, u95 = 0.05 }", "impact velocity"),
];

/// Keys of an observation.
pub const OBSERVATION: [Key; 3] = [
    number("value", REQUIRED).shown("20.4", ""),
    number("u95", REQUIRED).above_zero().shown("0.3", "half-width of its 95 % interval"),
    text("by", "–").shown(r#""video, 5000 frames/s""#, ""),
];

/// Keys of `[limits]`.
pub const LIMITS: [Key; 6] = [
    observation("slap_down_speed_m_s", "{ most = 25.0 }", "slap-down speed"),
    observation("k", "{ least = 0.2, most = 0.8 }", "coefficient of restitution"),
    observation("rigid_body_deceleration_g", "{ most = 300.0 }", "rigid-body deceleration"),
    observation("force_mn", "{ most = 12.0 }", "vertical force"),
    observation("crush_mm", "{ most = 150.0 }", "crush"),
    observation("energy_kj", "{ most = 250.0 }", "energy absorbed"),
];

/// Keys of a limit.
pub const LIMIT: [Key; 2] = [number("least", "–").shown("0.2", ""), number("most", "–").shown("25.0", "")];

/// Keys of `[report]`.
pub const REPORT: [Key; 3] = [
    text("header", "–").shown(r#""Drop Test Centre""#, "above the title"),
    text("footer", "–").shown(r#""Not to be copied in parts""#, "below each page"),
    text("logo", "–").shown(r#""logo.svg""#, "PNG, JPEG or SVG in the folder of this file"),
];

/// Keys of `[cask]`.
///
/// What a cask and a drop may be: models of a centimetre and a gram to more than any cask there is. Within it
/// `predict` ends in a second, and no product of two keys leaves the numbers that a double holds.
pub const CASK: [Key; 8] = [
    text("name", "the file's name").shown(r#""CASK""#, "the cask's name; left out: the file's"),
    number("mass_kg", REQUIRED)
        .within(1e-3, 1e6, "a model of a gram to more than any cask, in kg")
        .asked("4466.0", ""),
    number("length_m", REQUIRED)
        .within(0.01, 100.0, "a model of a centimetre to more than any cask, in metres: 5512 mm are 5.512")
        .asked("5.512", "along the axis, between the two ends that strike"),
    number("height_m", "0")
        .zero_or_more()
        .shown("0.8", "cross-section in the plane of the drop; left out: a thin rod"),
    number("width_m", "–").above_zero().shown("0.8", "across that plane, reported only"),
    number("cog_m", "`length_m` / 2")
        .above_zero()
        .shown("2.5", "centre of gravity from the first end; left out: length_m / 2"),
    number("inertia_kg_m2", "m (l² + h²)/12")
        .above_zero()
        .shown("2100.0", "about the centre of gravity; left out: m (l² + h²) / 12"),
    number("scale", "–")
        .within(
            0.01,
            1.0,
            "length of the model over that of its prototype: 0.5 of a half-scale model; all other keys are \
             the model's own",
        )
        .shown("0.5", "of a scale model, over its prototype"),
];

/// Keys of `[drop]`.
pub const DROP: [Key; 6] = [
    number("height_m", "required, but beside `impact_velocity_m_s`: then v0²/(2 g)")
        .within(1e-3, 1000.0, "in metres: from a millimetre to more than any drop tower; 9000 mm are 9")
        .asked("9.0", "free-fall height of the lowest point"),
    number("angle_deg", REQUIRED)
        .within(
            0.0,
            90.0,
            "the inclination of the cask's axis above the horizontal before the drop, in degrees; the first \
             end is the low one",
        )
        .asked("15.0", "inclination of the axis above the horizontal"),
    // From below the velocity of the least drop to above that of the highest; beyond, a body turns thousands
    // of times in flight.
    number("impact_velocity_m_s", "√(2 g h)")
        .within(0.01, 200.0, "in m/s: no drop of a cask is slower or faster; check the value and its unit")
        .shown("13.3", "overrides √(2 g h)"),
    // From below the Moon's 1.6 m/s² to three hundred times the Earth's in a centrifuge.
    number("gravity_m_s2", "9.81")
        .within(1.0, 3000.0, "in m/s²: the Moon's to that of a centrifuge")
        .shown("9.81", "this is the default"),
    // Ten times what a hook that lets go of one end first gives a cask in a fall of 9 m.
    number("angular_velocity_deg_s", "0")
        .within(-60.0, 60.0, "in degrees a second, of the cask as the first end strikes")
        .shown(
            "0.0",
            "rotation as the first end strikes, positive brings the second end down; `height_m` is \
                       then the fall of the centre of gravity",
        ),
    number("horizontal_velocity_m_s", "0")
        .within(-5.0, 5.0, "in m/s, of the centre of gravity as the first end strikes")
        .shown("0.0", "of the centre of gravity as the first end strikes, positive towards the second end"),
];

/// Keys of `[contact]`.
pub const CONTACT: [Key; 2] = [
    Key { takes: Takes::TextOrNumber, ..text("friction", "`\"unknown\"`") }.shown(
        r#""unknown""#,
        r#""rough", "smooth", a Coulomb coefficient such as 0.4, or "unknown": all that lies between"#,
    ),
    number("duration_s", "–")
        .within(0.0, LONGEST_CONTACT_S, "how long the first end's impact lasts, in seconds: 20 ms are 0.02")
        .shown("0.02", "how long the first impact lasts, for `predict`; `analyze` measures it"),
];

/// Five times the impact of a limiter; a body that turns at 5 rad/s comes down in that.
pub const LONGEST_CONTACT_S: f64 = 0.2;

/// Keys of `[filter]`.
pub const FILTER: [Key; 2] = [
    number("cfc", "").above_zero().shown("180", "a channel frequency class of SAE J211 / ISO 6487"),
    number("cutoff_hz", "").above_zero().shown("400.0", "a −3 dB cut-off"),
];

/// Keys of `[recording]`.
pub const RECORDING: [Key; 2] = [
    text("time", "found").shown(
        r#""time_s""#,
        "CSV column, HDF5 dataset or field of messages with the times, where they are not found by \
         themselves",
    ),
    text("rest", "–").shown(r#""rest.h5""#, "a recording of the rest before the drop, beside this file"),
];

/// Keys of `[[channel]]`.
pub const CHANNEL: [Key; 21] = [
    text("name", REQUIRED).asked(r#""A1""#, ""),
    text("end", REQUIRED)
        .asked(r#""first""#, r#""first" (low, touches first), "second", or "none": no part in the motion"#),
    text("axis", REQUIRED).asked(
        r#""transverse""#,
        r#""transverse" (across the cask, in the plane of the drop), "axial", or "rate" (its rotation)"#,
    ),
    Key { takes: Takes::TextOrTable, ..text("source", REQUIRED) }.asked(r#""/daq/a1.samples""#, ""),
    text("unit", "the recording's").shown(r#""g""#, "left out: the recording says so itself"),
    number("position_m", REQUIRED).asked("0.15", "along the axis, from the first end"),
    number("offset_m", "0")
        .shown("0.0", "across the axis, positive away from the target: half the section on the upper skin"),
    number("polarity", "1").shown("1", "-1: mounted the other way round"),
    number("sensitivity", "").above_zero().shown("10.0", r#"mV per g, with "V" and "mV""#),
    number("full_scale", "–").above_zero().shown("2000.0", "in `unit`: where the channel clips"),
    number("sample_rate_hz", "the recording's")
        .within(*SAMPLE_RATES_HZ.start(), *SAMPLE_RATES_HZ.end(), "samples a second, in Hz")
        .shown("100000.0", "overrides what the recording says"),
    text("time", "`[recording] time`")
        .shown(r#""/daq/time_s""#, "this channel's own times (CSV column, HDF5 dataset, field of messages)"),
    Key { takes: Takes::Table, ..text("where", "–") }.shown(
        r#"{ column = "Sensor", is = "left" }"#,
        "its rows, where the source holds those of several sensors",
    ),
    text("coupling", "`\"dc\"`").shown(r#""dc""#, r#"or "ac", then also time_constant_s = 0.3"#),
    number("time_constant_s", "").above_zero(),
    number("calibration_percent", "that of `[tolerance]`")
        .within(0.0, 100.0, "half-width of the 95 % interval, in percent")
        .shown("1.0", "this channel's own"),
    text("reference", "–")
        .shown(r#""amplifier 3""#, "channels of one name share the error of their calibration"),
    number("lateral_m", "0").shown("0.0", "off the plane of the drop"),
    text("serial", "–").shown(r#""A-20311""#, "of the sensor, for the report"),
    text("certificate", "–").shown(r#""K-2026-118""#, "of its calibration"),
    Key { takes: Takes::Date, ..text("calibrated", "–") }.shown("2026-03-02", "without quotes"),
];

/// Keys of a source that is a table, `{ topic = …, field = … }`.
pub const SOURCE: [Key; 3] = [
    text("topic", REQUIRED).shown(r#""/imu""#, ""),
    text("field", REQUIRED).shown(r#""linear_acceleration.z""#, ""),
    number("channel", "the only one")
        .within(0.0, 65_535.0, "the number of one of the MCAP channels that write on the topic")
        .shown("3", ""),
];

/// Keys of `where = { column = …, is = … }`.
pub const WHERE: [Key; 2] = [
    text("column", REQUIRED).shown(r#""Sensor""#, ""),
    Key { takes: Takes::TextOrNumber, ..text("is", REQUIRED) }.shown(r#""left""#, ""),
];

const fn observation(name: &'static str, example: &'static str, remark: &'static str) -> Key {
    Key { takes: Takes::Observation, ..text(name, "–") }.shown(example, remark)
}
