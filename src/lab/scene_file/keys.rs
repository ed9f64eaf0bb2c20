//! The keys of a scene file: their values, and their defaults.

use crate::data::keys::{
    self, ABOVE_ZERO, ANY, FROM_ZERO, Key, KeyTable, REQUIRED, Takes::Flag, Takes::Text, keys, range,
};

/// Keys outside the tables.
pub(super) const ROOT: [&str; 2] = ["name", "seed"];

pub(super) static TABLES: [KeyTable; 10] = [
    KeyTable { name: "cask", remark: "", keys: &keys::CASK },
    KeyTable { name: "drop", remark: "", keys: &DROP },
    KeyTable { name: "contact", remark: "", keys: &CONTACT },
    KeyTable { name: "first_end", remark: "", keys: &END },
    KeyTable { name: "second_end", remark: "", keys: &END },
    KeyTable { name: "contents", remark: "", keys: &CONTENTS },
    KeyTable { name: "body", remark: "", keys: &BODY },
    KeyTable { name: "mode", remark: "", keys: &MODE },
    KeyTable { name: "recording", remark: "", keys: &RECORDING },
    KeyTable { name: "channel", remark: "", keys: &CHANNEL },
];

const DROP: [Key; 10] = {
    let [height, angle, velocity, gravity, turning, along] = keys::DROP;
    let [stated_height, stated_angle, guided, roll] = OF_DROP;
    let flat = range(0.1, 89.0, "flat, both ends strike at once; upright, none slaps down");
    let angle = Key { takes: flat, ..angle };
    [height, angle, velocity, gravity, turning, along, stated_height, stated_angle, guided, roll]
};

const CONTACT: [Key; 4] = {
    let [falling_friction, falling_speed, returning_friction] = OF_CONTACT;
    [keys::CONTACT[0], falling_friction, falling_speed, returning_friction]
};

/// The fastest recorder and resonance that are simulated, Hz: faster ones fill the memory.
const FASTEST_HZ: f64 = 5e6;

keys! {
/// Keys beside those of a cask file.
OF_DROP {
    "stated_height_m": "", ABOVE_ZERO;
    "stated_angle_deg": "", range(0.0, 90.0, "degrees, for the cask file");
    "guided_percent": "0", range(0.0, 90.0, "the share of gravity that rails or ropes take");
    "roll_deg_s": "0", ANY;
}

/// Keys of the first end beside those of a cask file.
OF_CONTACT {
    "falling_friction": "", FROM_ZERO;
    "falling_speed_m_s": "1", ABOVE_ZERO;
    "returning_friction": "", FROM_ZERO;
}

/// An end, by its pulse or by its stiffnesses.
END {
    "pulse_ms": "", range(0.05, 200.0, "the length of the contact, in ms");
    "k": "", range(0.01, 1.0, "k is the rebound over the impact velocity of the end");
    "yield_share": "", range(0.01, 1.0, "share of the elastic peak at which the force stays");
    "loading_n_m": "", ABOVE_ZERO;
    "unloading_n_m": "", ABOVE_ZERO;
    "yield_n": "", ABOVE_ZERO;
    "lock_up_m": "", FROM_ZERO;
    "lock_up_n_m": "", ABOVE_ZERO;
    "footprint": "0", range(0.0, 100.0, "m inward for each of crush");
}

/// An impact of 2 ms, of which the pads absorb half at some metres per second: timber, rubber, honeycomb.
CONTENTS {
    "mass_kg": REQUIRED, ABOVE_ZERO;
    "position_m": "", ANY;
    "gap_m": "0.01", FROM_ZERO;
    "play_m": "0.02", FROM_ZERO;
    "pulse_ms": "2", range(0.1, 200.0, "the length of a blow, in ms");
    "damping_s_m": "0.2", FROM_ZERO;
}

/// An elastic body, by its first bending mode.
BODY {
    "first_bending_hz": REQUIRED, range(1.0, 20_000.0, "first natural frequency of the free beam, in Hz");
    // A welded steel structure has this damping; bolted ones have more.
    "damping": "0.01", range(0.0, 0.9, "share of critical damping of every mode");
}

MODE {
    "order": "1", range(1.0, 3.0, "only the first three shapes are simulated; 1 is the one with two nodes");
    "frequency_hz": REQUIRED, range(1.0, 20_000.0, "natural frequency of the free beam, in Hz"), "62.0", "";
    // A bolted steel structure has this damping.
    "damping": "0.02", range(0.0, 0.9, "share of critical damping");
    "strength": "1", ANY;
}

RECORDING {
    "before_s": "", range(0.0, 60.0, "record before first contact, in s");
    "after_s": "0.04", range(0.0, 60.0, "record after the slap-down, in s");
    "rest": "false", Flag;
    "clock_error_ppm": "0", range(-1e5, 1e5, "true over stated rate, less one");
    "swapped_ends": "false", Flag;
}

/// A usual recorder and a usual piezoresistive sensor, if the file does not state them.
CHANNEL {
    "name": REQUIRED, Text;
    "end": REQUIRED, Text;
    "axis": "", Text;
    "position_m": "", ANY;
    "offset_m": "0", ANY;
    "lateral_m": "0", ANY;
    "unit": "", Text;
    "sample_rate_hz": "20000", range(100.0, FASTEST_HZ, "samples a second");
    "polarity": "1", ANY;
    "full_scale": "", ABOVE_ZERO;
    "tilt_deg": "0", range(-90.0, 90.0, "degrees towards the other body axis");
    "cross_axis_percent": "0", range(-100.0, 100.0, "usual are 1 to 5 percent");
    "resonance_hz": "", range(1.0, FASTEST_HZ, "in Hz");
    "resonance_damping": "0.02", range(0.001, 2.0, "share of critical damping");
    "coupling": "", Text;
    "time_constant_s": "", ABOVE_ZERO;
    "anti_alias_hz": "", range(1.0, FASTEST_HZ, "in Hz");
    "scale": "1", ABOVE_ZERO;
    "offset_g": "0", ANY;
    "offset_deg_s": "0", ANY;
    "zero_shift_g": "0", ANY;
    "white_noise_g": "0.1", FROM_ZERO;
    "white_noise_deg_s": "0.1", FROM_ZERO;
    "pink_noise_g": "0", FROM_ZERO;
    "hum_g": "", ABOVE_ZERO;
    "hum_hz": "50", range(1.0, FASTEST_HZ, "in Hz");
    "cable_noise_g": "0", FROM_ZERO;
    "whip_g": "", ANY;
    "whip_hz": "15", range(0.1, FASTEST_HZ, "in Hz");
    "bits": "", range(2.0, 32.0, "the bits of the converter over ± full_scale; usual are 12 to 24");
    "dropouts_s": "[]", Text;
    "gaps_s": "[]", Text;
    "skew_ms": "0", ANY;
    "swapped_polarity": "false", Flag;
    "stated_position_m": "", ANY;
    "stated_lateral_m": "", ANY;
    "stated_unit": "", Text;
    "stated_coupling": "", Text;
}
}
