//! A scene file (TOML) to a checked scene and the cask file to go with it, or to one diagnostic that shows the line.

mod channel;
mod values;

use crate::data::keys::{self, names};
use crate::data::{Cask, CaskFile, Drop, End};
use crate::ingest::IngestError;
use crate::ingest::cask_file::section::{Document, Kind, Section};
use crate::ingest::cask_file::{self, CaskFileError};
use crate::lab::data::{BendingMode, CrushableEnd, Scene, SceneFile, WantedImpact};
use crate::lab::drawn;
use crate::lab::synth::crushable_end;
use std::path::Path;
use values::{flag, number_or, size_or, whole};

/// The scene file.
const SCENE_FILE: Kind = Kind {
    name: "the scene file",
    tables: &[
        (
            "",
            &[
                "name",
                "seed",
                "cask",
                "drop",
                "contact",
                "first_end",
                "second_end",
                "mode",
                "recording",
                "channel",
            ],
        ),
        ("cask", &names(&keys::CASK)),
        (
            "drop",
            &[
                "height_m",
                "angle_deg",
                "impact_velocity_m_s",
                "gravity_m_s2",
                "stated_height_m",
                "stated_angle_deg",
            ],
        ),
        ("contact", &names(&keys::CONTACT)),
        ("first_end", &END_KEYS),
        ("second_end", &END_KEYS),
        ("mode", &["order", "frequency_hz", "damping", "strength"]),
        ("recording", &["before_s", "after_s", "rest", "clock_error_ppm", "swapped_ends"]),
        (
            "channel",
            &[
                "name",
                "end",
                "axis",
                "position_m",
                "offset_m",
                "unit",
                "sample_rate_hz",
                "polarity",
                "full_scale",
                "tilt_deg",
                "cross_axis_percent",
                "resonance_hz",
                "resonance_damping",
                "coupling",
                "time_constant_s",
                "anti_alias_hz",
                "scale",
                "offset_g",
                "zero_shift_g",
                "white_noise_g",
                "pink_noise_g",
                "hum_g",
                "hum_hz",
                "cable_noise_g",
                "bits",
                "dropouts_s",
                "gaps_s",
                "skew_ms",
                "swapped_polarity",
                "stated_position_m",
                "stated_unit",
                "stated_coupling",
            ],
        ),
    ],
};

const END_KEYS: [&str; 6] = ["pulse_ms", "k", "yield_share", "loading_n_m", "unloading_n_m", "yield_n"];

/// What the ends do where the file is silent: a lid system's usual pulses, the second end the softer.
const FIRST_IMPACT: WantedImpact = WantedImpact { duration_s: 6e-3, restitution: 0.5, yield_share: None };
const SECOND_IMPACT: WantedImpact = WantedImpact { duration_s: 5e-3, restitution: 0.3, yield_share: None };

/// Defaults of the record: of the fall, after the slap-down, and of hanging at rest, s.
const BEFORE_S: f64 = 0.1;
const AFTER_S: f64 = 0.04;
const AT_REST_S: f64 = 0.25;

/// The longest record on either side of the drop, s, and the most samples of a channel.
const LONGEST_S: f64 = 60.0;
const MOST_SAMPLES: f64 = 2e7;

/// Share of critical damping of a bolted steel structure.
const MODE_DAMPING: f64 = 0.02;

/// Reads and checks the scene file at `path`.
///
/// # Errors
/// One diagnostic that shows the line.
pub fn read(path: &Path) -> Result<SceneFile, IngestError> {
    let bytes = cask_file::read(path, &SCENE_FILE)?;
    Ok(checked(path, cask_file::text(path, &bytes, &SCENE_FILE)?)?)
}

fn checked(path: &Path, text: &str) -> Result<SceneFile, CaskFileError> {
    let document = Document::new(&SCENE_FILE, path, text);
    let root = document.root()?;
    let drop_table = root.required_table("drop")?;
    let cask = cask_file::cask(&root.required_table("cask")?, path)?;
    let drop = cask_file::drop(&drop_table, &cask)?;
    inclined(&drop_table)?;
    let contact = cask_file::contact(&root.table("contact")?)?;
    let name = root.text("name")?.map_or_else(|| cask.name.clone(), |name| name.value);
    let stiffness = |end, table: Section, usual| {
        Ok::<_, CaskFileError>(match asked(&table, usual)? {
            Asked::Direct(direct) => direct,
            Asked::Impact(impact) => crushable_end(&cask, &drop, contact, end, impact),
        })
    };
    let first_end = stiffness(End::First, root.table("first_end")?, FIRST_IMPACT)?;
    let second_end = stiffness(End::Second, root.table("second_end")?, SECOND_IMPACT)?;
    let tables = root.tables("channel")?;
    let both = channels(&tables, &cask)?;
    let (channels, specs) = both.into_iter().unzip();
    let mut scene = Scene {
        name,
        seed: whole(&root, "seed")?.map_or(1, |seed| seed.value),
        first_end,
        second_end,
        modes: root.tables("mode")?.iter().map(mode).collect::<Result<_, _>>()?,
        before_s: BEFORE_S,
        after_s: AFTER_S,
        rest: false,
        clock_error: 0.0,
        swapped_ends: false,
        channels,
        cask: cask.clone(),
        drop,
        contact,
    };
    recording(&root.table("recording")?, &mut scene)?;
    affordable(&root, &tables, &scene)?;
    let defaults = cask_file::assumed(&root, &["cask", "drop", "contact"]);
    let stated = CaskFile {
        path: path.to_owned(),
        channels: specs,
        ..drawn::cask_file(cask, stated_drop(&drop_table, drop)?, contact, defaults)
    };
    Ok(SceneFile { scene, stated })
}

/// An axis that lies flat or stands has no first end.
fn inclined(table: &Section) -> Result<(), CaskFileError> {
    const MEND: &str = "flat, both ends strike at once; upright, none slaps down";
    table.within("angle_deg", &(0.1..=89.0), MEND)?;
    table.within("stated_angle_deg", &(0.0..=90.0), "degrees, for the cask file")?;
    Ok(())
}

fn stated_drop(table: &Section, drop: Drop) -> Result<Drop, CaskFileError> {
    let height_m = table.positive("stated_height_m")?.map_or(drop.height_m, |height| height.value);
    let angle = table.number("stated_angle_deg")?.map_or(drop.angle_rad, |angle| angle.value.to_radians());
    Ok(Drop { height_m, angle_rad: angle, ..drop })
}

enum Asked {
    Impact(WantedImpact),
    Direct(CrushableEnd),
}

/// `[first_end]` or `[second_end]`: a pulse, or the stiffnesses themselves.
fn asked(table: &Section, usual: WantedImpact) -> Result<Asked, CaskFileError> {
    let impact = WantedImpact {
        duration_s: table
            .within("pulse_ms", &(0.05..=200.0), "the length of the contact, in ms")?
            .map_or(usual.duration_s, |pulse| pulse * 1e-3),
        restitution: table
            .within("k", &(0.01..=1.0), "k is the rebound over the impact velocity of the end")?
            .unwrap_or(usual.restitution),
        yield_share: table.within(
            "yield_share",
            &(0.01..=1.0),
            "share of the elastic peak at which the force stays",
        )?,
    };
    let loading = table.positive("loading_n_m")?;
    let unloading = table.positive("unloading_n_m")?;
    let yield_n = table.positive("yield_n")?.map(|force| force.value);
    let Some(loading) = loading else {
        return match ["unloading_n_m", "yield_n"].into_iter().find(|key| table.value(key).is_some()) {
            Some(key) => {
                Err(alone(table, key, "needs loading_n_m", "give loading_n_m beside it, or pulse_ms and k"))
            }
            None => Ok(Asked::Impact(impact)),
        };
    };
    if let Some(key) = ["pulse_ms", "k", "yield_share"].into_iter().find(|key| table.value(key).is_some()) {
        return Err(alone(
            table,
            key,
            "not beside loading_n_m",
            "give pulse_ms and k, or the stiffnesses, not both",
        ));
    }
    let unloading_n_m = unloading.as_ref().map_or(loading.value, |unloading| unloading.value);
    if unloading_n_m < loading.value {
        return Err(alone(
            table,
            "unloading_n_m",
            "not below loading_n_m",
            "an end that unloads more softly than it loads would give energy",
        ));
    }
    Ok(Asked::Direct(CrushableEnd { loading_n_m: loading.value, unloading_n_m, yield_n }))
}

fn alone(table: &Section, key: &str, expected: &str, mend: &str) -> CaskFileError {
    let span = table.value(key).map_or_else(|| table.span(), toml::Spanned::span);
    table.wrong(span, format!("{key} contradicts its table: {expected}"), expected.into(), mend)
}

fn mode(table: &Section) -> Result<BendingMode, CaskFileError> {
    let order = whole(table, "order")?;
    let order = match order {
        None => 1,
        Some(order) => u8::try_from(order.value).ok().filter(|n| (1..=3).contains(n)).ok_or_else(|| {
            let message = format!("order is {}: only the first three shapes are simulated", order.value);
            table.wrong(order.span, message, "1, 2 or 3".into(), "1 is the shape with two nodes")
        })?,
    };
    let frequency_hz =
        table.within("frequency_hz", &(1.0..=20_000.0), "natural frequency of the free beam, in Hz")?;
    Ok(BendingMode {
        order,
        frequency_hz: frequency_hz
            .ok_or_else(|| table.missing("frequency_hz", "add a line such as frequency_hz = 62.0"))?,
        damping: table.within("damping", &(0.0..=0.9), "share of critical damping")?.unwrap_or(MODE_DAMPING),
        strength: number_or(table, "strength", 1.0)?,
    })
}

fn recording(table: &Section, scene: &mut Scene) -> Result<(), CaskFileError> {
    scene.rest = flag(table, "rest")?;
    let drop = &scene.drop;
    let fall_s = (2.0 * drop.height_m / drop.gravity_m_s2).sqrt();
    let before_s = if scene.rest { fall_s + AT_REST_S } else { BEFORE_S };
    scene.before_s = size_or(table, "before_s", before_s)?;
    scene.after_s = size_or(table, "after_s", AFTER_S)?;
    table.within("before_s", &(0.0..=LONGEST_S), "record before first contact, in s")?;
    table.within("after_s", &(0.0..=LONGEST_S), "record after the slap-down, in s")?;
    scene.clock_error = 1e-6
        * table.within("clock_error_ppm", &(-1e5..=1e5), "true over stated rate, less one")?.unwrap_or(0.0);
    scene.swapped_ends = flag(table, "swapped_ends")?;
    Ok(())
}

/// The channels, each name once.
fn channels(tables: &[Section], cask: &Cask) -> Result<Vec<channel::Both>, CaskFileError> {
    if tables.is_empty() {
        return Ok(channel::usual(cask));
    }
    let mut channels: Vec<channel::Both> = Vec::new();
    for table in tables {
        let both = channel::channel(table, cask)?;
        if channels.iter().any(|other| other.0.name == both.0.name) {
            let span = table.value("name").map_or_else(|| table.span(), toml::Spanned::span);
            let message = format!("two channels are named \"{}\"", both.0.name);
            return Err(table.wrong(span, message, "a name of its own".into(), "name each channel once"));
        }
        channels.push(both);
    }
    Ok(channels)
}

/// A record too long for its rate would fill the memory.
fn affordable(root: &Section, tables: &[Section], scene: &Scene) -> Result<(), CaskFileError> {
    let long_s = scene.before_s + scene.after_s;
    let Some(at) = scene.channels.iter().position(|c| c.sample_rate_hz * long_s > MOST_SAMPLES) else {
        return Ok(());
    };
    let table = tables.get(at).unwrap_or(root);
    Err(table.wrong(
        table.value("sample_rate_hz").map_or_else(|| table.span(), toml::Spanned::span),
        format!("sample_rate_hz over {long_s} s gives more than {MOST_SAMPLES:.0} samples"),
        "fewer samples".into(),
        "shorten before_s and after_s, or lower sample_rate_hz",
    ))
}

#[cfg(test)]
mod tests;
