//! The keys of a scene file: what each takes, and what holds where it is left out.

use crate::data::keys::{self, Key, KeyTable, flag, number, text};

/// What stands in no table.
pub(super) const ROOT: [&str; 2] = ["name", "seed"];

pub(super) static TABLES: [KeyTable; 9] = [
    KeyTable { name: "cask", remark: "", keys: &keys::CASK },
    KeyTable { name: "drop", remark: "", keys: &DROP },
    KeyTable { name: "contact", remark: "", keys: &CONTACT },
    KeyTable { name: "first_end", remark: "", keys: &END },
    KeyTable { name: "second_end", remark: "", keys: &END },
    KeyTable { name: "contents", remark: "", keys: &CONTENTS },
    KeyTable { name: "mode", remark: "", keys: &MODE },
    KeyTable { name: "recording", remark: "", keys: &RECORDING },
    KeyTable { name: "channel", remark: "", keys: &CHANNEL },
];

const DROP: [Key; 10] = {
    let [height, angle, velocity, gravity, turning, along] = keys::DROP;
    [
        height,
        angle.within(0.1, 89.0, "flat, both ends strike at once; upright, none slaps down"),
        velocity,
        gravity,
        turning,
        along,
        number("stated_height_m", "").above_zero(),
        number("stated_angle_deg", "").within(0.0, 90.0, "degrees, for the cask file"),
        number("guided_percent", "0").within(0.0, 90.0, "the share of gravity that rails or ropes take"),
        number("roll_deg_s", "0"),
    ]
};

const CONTACT: [Key; 4] = [
    keys::CONTACT[0],
    number("falling_friction", "").zero_or_more(),
    number("falling_speed_m_s", "1").above_zero(),
    number("returning_friction", "").zero_or_more(),
];

/// An end by its pulse, or by the stiffnesses themselves.
const END: [Key; 9] = [
    number("pulse_ms", "").within(0.05, 200.0, "the length of the contact, in ms"),
    number("k", "").within(0.01, 1.0, "k is the rebound over the impact velocity of the end"),
    number("yield_share", "").within(0.01, 1.0, "share of the elastic peak at which the force stays"),
    number("loading_n_m", "").above_zero(),
    number("unloading_n_m", "").above_zero(),
    number("yield_n", "").above_zero(),
    number("lock_up_m", "").zero_or_more(),
    number("lock_up_n_m", "").above_zero(),
    number("footprint", "0").within(0.0, 100.0, "m inward for each of crush"),
];

/// A blow of 2 ms, of which the pads take the half at some metres a second: timber, rubber, honeycomb.
const CONTENTS: [Key; 6] = [
    number("mass_kg", keys::REQUIRED).above_zero(),
    number("position_m", ""),
    number("gap_m", "0.01").zero_or_more(),
    number("play_m", "0.02").zero_or_more(),
    number("pulse_ms", "2").within(0.1, 200.0, "the length of a blow, in ms"),
    number("damping_s_m", "0.2").zero_or_more(),
];

const MODE: [Key; 4] = [
    number("order", "1").within(
        1.0,
        3.0,
        "only the first three shapes are simulated; 1 is the one with two nodes",
    ),
    number("frequency_hz", keys::REQUIRED)
        .within(1.0, 20_000.0, "natural frequency of the free beam, in Hz")
        .shown("62.0", ""),
    // Of a bolted steel structure.
    number("damping", "0.02").within(0.0, 0.9, "share of critical damping"),
    number("strength", "1"),
];

const RECORDING: [Key; 5] = [
    number("before_s", "").within(0.0, 60.0, "record before first contact, in s"),
    number("after_s", "0.04").within(0.0, 60.0, "record after the slap-down, in s"),
    off("rest"),
    number("clock_error_ppm", "0").within(-1e5, 1e5, "true over stated rate, less one"),
    off("swapped_ends"),
];

/// The fastest recorder and resonance that are simulated, Hz: faster ones fill the memory.
const FASTEST_HZ: f64 = 5e6;

/// A usual recorder and a usual piezoresistive sensor where the file is silent.
const CHANNEL: [Key; 38] = [
    text("name", keys::REQUIRED),
    text("end", keys::REQUIRED),
    text("axis", ""),
    number("position_m", ""),
    number("offset_m", "0"),
    number("lateral_m", "0"),
    text("unit", ""),
    number("sample_rate_hz", "20000").within(100.0, FASTEST_HZ, "samples a second"),
    number("polarity", "1"),
    number("full_scale", "").above_zero(),
    number("tilt_deg", "0").within(-90.0, 90.0, "degrees towards the other body axis"),
    number("cross_axis_percent", "0").within(-100.0, 100.0, "usual are 1 to 5 percent"),
    number("resonance_hz", "").within(1.0, FASTEST_HZ, "in Hz"),
    number("resonance_damping", "0.02").within(0.001, 2.0, "share of critical damping"),
    text("coupling", ""),
    number("time_constant_s", "").above_zero(),
    number("anti_alias_hz", "").within(1.0, FASTEST_HZ, "in Hz"),
    number("scale", "1").above_zero(),
    number("offset_g", "0"),
    number("offset_deg_s", "0"),
    number("zero_shift_g", "0"),
    number("white_noise_g", "0.1").zero_or_more(),
    number("white_noise_deg_s", "0.1").zero_or_more(),
    number("pink_noise_g", "0").zero_or_more(),
    number("hum_g", "").above_zero(),
    number("hum_hz", "50").within(1.0, FASTEST_HZ, "in Hz"),
    number("cable_noise_g", "0").zero_or_more(),
    number("whip_g", ""),
    number("whip_hz", "15").within(0.1, FASTEST_HZ, "in Hz"),
    number("bits", "").within(2.0, 32.0, "the bits of the converter over ± full_scale; usual are 12 to 24"),
    text("dropouts_s", "[]"),
    text("gaps_s", "[]"),
    number("skew_ms", "0"),
    off("swapped_polarity"),
    number("stated_position_m", ""),
    number("stated_lateral_m", ""),
    text("stated_unit", ""),
    text("stated_coupling", ""),
];

const fn off(name: &'static str) -> Key {
    Key { default: "false", ..flag(name) }
}
