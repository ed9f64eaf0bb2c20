//! The keys of a cask file, one row each; those of `[tolerance]` and `[corrections]` are in
//! [`super::tolerances`] with their values.
//!
//! The parser, the form that `init` writes, and the table in docs/formats.md are made from these rows.

use super::SAMPLE_RATES_HZ;
pub(crate) use super::key::{ABOVE_ZERO, ANY, FROM_ZERO, keys, range};
pub use super::key::{Allowed, FILL_IN, Key, KeyTable, REQUIRED, Takes};
pub use super::tolerances::{CORRECTIONS, TOLERANCE};
use Takes::{Date, Observation, Table, Text, TextOrNumber, TextOrTable, Texts};

/// Tables that are the value of a key: no line of a file begins them.
pub const INNER_TABLES: [&str; 4] = ["source", "where", "observation", "limit"];

const fn table(name: &'static str, remark: &'static str, keys: &'static [Key]) -> KeyTable {
    KeyTable { name, remark, keys }
}

/// The tables of a cask file, in the order of the form.
pub static TABLES: [KeyTable; 17] = [
    table("test", "for the head of the report; changes no number", &TEST),
    table("cask", "", &CASK),
    table("drop", "", &DROP),
    table("contact", "", &CONTACT),
    table("filter", "left out: chosen from the mass; give one of the two", &FILTER),
    table("tolerance", "half-widths of 95 % intervals; these are the defaults", &TOLERANCE),
    table("corrections", "all are made; false leaves one out", &CORRECTIONS),
    table("recording", "", &RECORDING),
    table("observed", "what was seen otherwise, held against the result", &OBSERVED),
    table(
        "limits",
        "the customer's; exceeded, and exit status 1, where the whole interval lies beyond",
        &LIMITS,
    ),
    table("simulation", "a calculation, laid over the recording and rated", &SIMULATION),
    table("report", "around the page report.html", &REPORT),
    table("channel", "", &CHANNEL),
    table("source", "", &SOURCE),
    table("where", "", &WHERE),
    table("observation", "", &OBSERVATION),
    table("limit", "one of the two or both", &LIMIT),
];

/// The tables of a house file, to which cask files refer.
pub static OF_HOUSE: [KeyTable; 2] = [table("tolerance", "", &TOLERANCE), table("report", "", &REPORT)];

/// Name of a quantity of `[observed]` or `[limits]` in reports, the same for both tables.
pub fn quantity_words(name: &str) -> &str {
    OBSERVED.iter().chain(&LIMITS).find(|key| key.name == name).map_or(name, |key| key.remark)
}

/// Longest contact: five times the impact of a limiter; in this time a body that turns at 5 rad/s comes down.
pub const LONGEST_CONTACT_S: f64 = 0.2;
/// Shortest contact: a tenth of the impact of steel on steel. The steps of a prediction grow as its inverse.
pub const SHORTEST_CONTACT_S: f64 = 1e-5;
/// The lowest cut-off of a low-pass, Hz: a drop lasts a tenth of a second. The filter's transients grow as
/// the inverse.
const LOWEST_CUTOFF_HZ: f64 = 1.0;

keys! {
/// Keys of `[test]`.
TEST {
    "id": "–", Text, r#""SD-2026-014""#, "number of the test";
    "title": "–", Text, r#""Slap-down at 15°""#, "";
    "place": "–", Text, r#""Drop tower""#, "";
    "operator": "–", Text, r#""J. Doe""#, "who carried it out";
    "customer": "–", Text, r#""Customer""#, "";
    "specimen": "–", Text, r#""Model 1:2, No. 3""#, "what was dropped";
    "target": "–", Text, r#""IAEA target, 1000 t""#, "onto what";
    "remarks": "–", Text, r#""second drop of this model""#, "";
    "date": "–", Date, "2026-11-22T09:40:00+01:00", "without quotes";
    "temperature_c": "–", range(-100.0, 200.0, "of the specimen, in °C"), "12.5", "of the specimen";
    "photos": "–", Texts, r#"["before.jpg"]"#, "PNG or JPEG in the folder of this file";
    "signatures": "–", Texts, r#"["Test engineer", "Reviewer"]"#, "lines to sign";
    "revisions": "–", Texts, r#"["2026-11-22, 0.1.0, first issue"]"#,
        "of the report: date, version of the program, what changed";
    "more": "–", Table, r#"{ "Drop rig" = "Hall 3" }"#, "anything else, printed as it stands";
}

/// Keys of `[observed]`.
OBSERVED {
    "slap_down_speed_m_s": "–", Observation, "{ value = 20.4, u95 = 0.3 }",
        "slap-down speed of the rigid cask";
    "local_speed_m_s": "–", Observation, "{ value = 18.1, u95 = 0.3 }", "speed of the corner that strikes";
    "k": "–", Observation, "{ value = 0.55, u95 = 0.05 }", "coefficient of restitution";
    "angular_velocity_rad_s": "–", Observation, "{ value = 4.6, u95 = 0.1 }",
        "angular velocity after the first impact";
    "angle_deg": "–", Observation, "{ value = 1.0, u95 = 0.5 }", "angle at slap-down";
    "flight_time_s": "–", Observation, "{ value = 0.056, u95 = 0.001, by = \"video\" }", "flight time";
    "impact_velocity_m_s": "–", Observation, "{ value = 13.25, u95 = 0.05 }", "impact velocity";
}

/// Keys of an observation.
OBSERVATION {
    "value": REQUIRED, ANY, "20.4", "";
    "u95": REQUIRED, ABOVE_ZERO, "0.3", "half-width of its 95 % interval";
    "by": "–", Text, r#""video, 5000 frames/s""#, "";
}

/// Keys of `[limits]`.
LIMITS {
    "slap_down_speed_m_s": "–", Observation, "{ most = 25.0 }", "slap-down speed of the rigid cask";
    "local_speed_m_s": "–", Observation, "{ most = 25.0 }", "speed of the corner that strikes";
    "k": "–", Observation, "{ least = 0.2, most = 0.8 }", "coefficient of restitution";
    "rigid_body_deceleration_g": "–", Observation, "{ most = 300.0 }", "rigid-body deceleration";
    "force_mn": "–", Observation, "{ most = 12.0 }", "vertical force";
    "crush_mm": "–", Observation, "{ most = 150.0 }", "crush";
    "energy_kj": "–", Observation, "{ most = 250.0 }", "energy absorbed";
}

/// Keys of a limit.
LIMIT {
    "least": "–", ANY, "0.2", "";
    "most": "–", ANY, "25.0", "";
}

/// Keys of `[simulation]`.
SIMULATION {
    "file": REQUIRED, Text, r#""fe.csv""#, "table of the calculated accelerations, beside this file";
    "time": "found", Text, r#""t_s""#, "its column of times";
    "unit": REQUIRED, Text, r#""m/s^2""#, r#"or "g""#;
    "channels": REQUIRED, Table, r#"{ A2 = "N1234_az" }"#,
        "the column of each channel, along the channel's axis and with its sign";
}

/// Keys of `[report]`.
REPORT {
    "header": "–", Text, r#""Drop Test Centre""#, "above the title";
    "footer": "–", Text, r#""Not to be copied in parts""#, "below each page";
    "logo": "–", Text, r#""logo.svg""#, "PNG, JPEG or SVG in the folder of this file";
}

/// Keys of `[cask]`.
///
/// The ranges of cask and drop reach from models of a centimetre and a gram to beyond any existing cask.
/// Within them `predict` ends in a second, and no product of two keys overflows a double.
CASK {
    "name": "the file's name", Text, r#""CASK""#, "the cask's name; left out: the file's";
    "mass_kg": REQUIRED, range(1e-3, 1e6, "a model of a gram to more than any cask, in kg"),
        ask "4466.0", "";
    "length_m": REQUIRED,
        range(0.01, 100.0, "a model of a centimetre to more than any cask, in metres: 5512 mm are 5.512"),
        ask "5.512", "along the axis, between the two ends that strike";
    "height_m": REQUIRED, FROM_ZERO, ask "0.8", "section in the plane of the drop; 0 states a thin rod";
    "width_m": "–", ABOVE_ZERO, "0.8", "across that plane, reported only";
    "cog_m": "`length_m` / 2", ABOVE_ZERO, "2.5",
        "centre of gravity from the first end; left out: length_m / 2, and wider intervals";
    "inertia_kg_m2": "m (l² + h²)/12", ABOVE_ZERO, "2100.0",
        "about the centre of gravity; left out: m (l² + h²) / 12, and wider intervals";
    "scale": "–", range(0.01, 1.0, "length of the model over that of its prototype: 0.5 of a half-scale \
         model; all other keys are the model's own"), "0.5", "of a scale model, over its prototype";
}

/// Keys of `[drop]`.
DROP {
    "height_m": "required, but beside `impact_velocity_m_s`: then v0²/(2 g)",
        range(1e-3, 1000.0, "in metres: from a millimetre to more than any drop tower; 9000 mm are 9"),
        ask "9.0", "free-fall height of the lowest point";
    "angle_deg": REQUIRED, range(0.0, 90.0, "the inclination of the cask's axis above the horizontal before \
         the drop, in degrees; the first end is the low one"), ask "15.0",
        "inclination of the axis above the horizontal";
    // The range reaches from below the velocity of the lowest drop to above that of the highest; beyond it a
    // body turns thousands of times in flight.
    "impact_velocity_m_s": "√(2 g h)",
        range(0.01, 200.0, "in m/s: no drop of a cask is slower or faster; check the value and its unit"),
        "13.3", "overrides √(2 g h)";
    // The range reaches from below the Moon's 1.6 m/s² to three hundred times the Earth's in a centrifuge.
    "gravity_m_s2": "9.81", range(1.0, 3000.0, "in m/s²: the Moon's to that of a centrifuge"), "9.81",
        "this is the default";
    // The range is ten times the rotation of a cask that falls 9 m after its hook released one end first.
    "angular_velocity_deg_s": "0",
        range(-60.0, 60.0, "in degrees a second, of the cask as the first end strikes"), "0.0",
        "rotation as the first end strikes, positive brings the second end down; `height_m` is then the fall \
         of the centre of gravity";
    "horizontal_velocity_m_s": "0",
        range(-5.0, 5.0, "in m/s, of the centre of gravity as the first end strikes"), "0.0",
        "of the centre of gravity as the first end strikes, positive towards the second end";
}

/// Keys of `[contact]`.
CONTACT {
    "friction": "`\"unknown\"`", TextOrNumber, r#""unknown""#,
        r#""rough", "smooth", "unknown" (all between), or the most that the impulse ratio is, such as 0.4"#;
    "duration_s": "–",
        Takes::Number(Allowed::ZeroOrWithin(SHORTEST_CONTACT_S, LONGEST_CONTACT_S,
            "how long the first end's impact lasts, in seconds: 20 ms are 0.02, and 0 is an impulse")),
        "0.02", "how long the first impact lasts, for `predict`; `analyze` measures it";
}

/// Keys of `[filter]`.
FILTER {
    "cfc": "", range(LOWEST_CUTOFF_HZ, *SAMPLE_RATES_HZ.end(), "the class, such as 60, 180 or 600"), "180",
        "a channel frequency class of SAE J211 / ISO 6487";
    "cutoff_hz": "", range(LOWEST_CUTOFF_HZ, *SAMPLE_RATES_HZ.end(), "the −3 dB cut-off, in Hz"), "400.0",
        "a −3 dB cut-off";
}

/// Keys of `[recording]`.
RECORDING {
    "time": "found", Text, r#""time_s""#,
        "CSV column, HDF5 dataset or field of messages with the times, where they are not found by \
         themselves";
    "rest": "–", Text, r#""rest.h5""#, "a recording of the rest before the drop, beside this file";
}

/// Keys of `[[channel]]`.
CHANNEL {
    "name": REQUIRED, Text, ask r#""A1""#, "";
    "end": REQUIRED, Text, ask r#""first""#,
        r#""first" (low, touches first), "second", or "none": no part in the motion"#;
    "axis": "required, but beside `around_deg`", Text, ask r#""transverse""#,
        r#""transverse" (across the cask, in the plane of the drop), "axial", or "rate" (its rotation)"#;
    "source": REQUIRED, TextOrTable, ask r#""/daq/a1.samples""#, "";
    "unit": "the recording's", Text, r#""g""#, "left out: the recording says so itself";
    "position_m": REQUIRED, ANY, ask "0.15", "along the axis, from the first end";
    "offset_m": "0", ANY, "0.0",
        "across the axis, positive away from the target: half the section on the upper skin";
    "around_deg": "–", range(-180.0, 360.0, "around the skin, in degrees: 0 is the lowest line, 90 the \
         side, 180 the uppermost line"), "180.0",
        "around the skin from the lowest line (0) to the uppermost (180); gives `offset_m` and `lateral_m`";
    "direction": "–", Text, r#""radial""#,
        r#"beside `around_deg`: "radial" (outwards), "tangential" (to a larger angle), "axial""#;
    "polarity": "1", ANY, "1", "-1: mounted the other way round";
    "sensitivity": "", ABOVE_ZERO, "10.0", r#"mV per g, with "V" and "mV""#;
    "scale": "1", ABOVE_ZERO, "0.9", "what is read times this is in `unit`";
    "full_scale": "–", ABOVE_ZERO, "2000.0", "in `unit`: where the channel clips";
    "sample_rate_hz": "the recording's",
        range(*SAMPLE_RATES_HZ.start(), *SAMPLE_RATES_HZ.end(), "samples a second, in Hz"), "100000.0",
        "overrides what the recording says";
    "time": "`[recording] time`", Text, r#""/daq/time_s""#,
        "this channel's own times (CSV column, HDF5 dataset, field of messages)";
    "file": "–", Text, r#""logger2.h5""#,
        "another recorder's recording, beside this file: the clocks are joined at first contact";
    "where": "–", Table, r#"{ column = "Sensor", is = "left" }"#,
        "its rows, where the source holds those of several sensors";
    "coupling": "`\"dc\"`", Text, r#""dc""#, r#"or "ac", then also time_constant_s = 0.3"#;
    "time_constant_s": "", ABOVE_ZERO, "", "";
    "calibration_percent": "that of `[tolerance]`",
        range(0.0, 100.0, "half-width of the 95 % interval, in percent"), "1.0", "this channel's own";
    "reference": "–", Text, r#""amplifier 3""#, "channels of one name share the error of their calibration";
    "lateral_m": "0", ANY, "0.0", "off the plane of the drop";
    "serial": "–", Text, r#""A-20311""#, "of the sensor, for the report";
    "certificate": "–", Text, r#""K-2026-118""#, "of its calibration";
    "calibrated": "–", Date, "2026-03-02", "without quotes";
}

/// Keys of a source that is a table, `{ topic = …, field = … }`.
SOURCE {
    "topic": REQUIRED, Text, r#""/imu""#, "";
    "field": REQUIRED, Text, r#""linear_acceleration.z""#, "";
    "channel": "the only one",
        range(0.0, 65_535.0, "the number of one of the MCAP channels that write on the topic"), "3", "";
}

/// Keys of `where = { column = …, is = … }`.
WHERE {
    "column": REQUIRED, Text, r#""Sensor""#, "";
    "is": REQUIRED, TextOrNumber, r#""left""#, "";
}
}
