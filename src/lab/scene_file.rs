//! Reads a scene file (TOML): a checked scene and its cask file, or one diagnostic that shows the line.

mod channel;
mod keys;

use crate::data::{Cask, CaskFile, Drop};
use crate::ingest::IngestError;
use crate::ingest::cask_file::section::{Document, Kind, Section};
use crate::ingest::cask_file::{self, CaskFileError};
use crate::lab::data::{
    BendingMode, CrushableEnd, ElasticBody, LooseMass, Scene, SceneExtras, SceneFile, WantedImpact, slow_down,
};
use crate::lab::drawn;
use crate::lab::synth;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use std::path::Path;

/// The scene file.
const SCENE_FILE: Kind = Kind { name: "the scene file", root: &keys::ROOT, tables: &keys::TABLES };

/// Impacts of the ends if the file states none: usual pulses of a lid system, the second end softer.
const FIRST_IMPACT: WantedImpact = WantedImpact { duration_s: 6e-3, restitution: 0.5, yield_share: None };
const SECOND_IMPACT: WantedImpact = WantedImpact { duration_s: 5e-3, restitution: 0.3, yield_share: None };

/// Default duration of hanging at rest, s.
const AT_REST_S: f64 = 0.25;

/// Most samples of a channel.
const MOST_SAMPLES: f64 = 2e7;

/// Reads and checks the scene file at `path`.
///
/// # Errors
/// One diagnostic that shows the line.
pub fn read(path: &Path) -> Result<SceneFile, IngestError> {
    let bytes = cask_file::read(path, &SCENE_FILE)?;
    parse(path, cask_file::text(path, &bytes, &SCENE_FILE)?)
}

fn parse(path: &Path, text: &str) -> Result<SceneFile, CaskFileError> {
    let document = Document::new(&SCENE_FILE, path, text);
    let root = document.root()?;
    let drop_table = root.required_table("drop")?;
    let cask = cask_file::cask(&root.required_table("cask")?, path)?;
    let free = cask_file::drop(&drop_table, &cask)?;
    let guided = value(&drop_table, "guided_percent")? / 100.0;
    // The cask file does not mention that guides slow the fall.
    let drop = if free.impact_velocity_given { free } else { slow_down(free, guided) };
    let contact_table = root.table("contact")?;
    let contact = cask_file::contact(&contact_table)?;
    let (first, second) = (root.table("first_end")?, root.table("second_end")?);
    let impacts = [impact(&first, FIRST_IMPACT)?, impact(&second, SECOND_IMPACT)?];
    let by_pulses = drawn::scene(cask.clone(), drop, contact, impacts);
    let (of_rate, tables): (Vec<Section>, _) =
        root.tables("channel")?.into_iter().partition(cask_file::channel::is_rate);
    let (channels, specs) = channels(&tables, &cask)?.into_iter().unzip();
    let rates = of_rate.iter().map(|table| channel::rate(table, &cask)).collect::<Result<Vec<_>, _>>()?;
    let (rates, others) = rates.into_iter().unzip();
    let recording = root.table("recording")?;
    let loose = root.tables("contents")?;
    if let Some(table) = loose.get(synth::MOST_LOOSE) {
        let most = "one [[contents]] more than the two that are simulated";
        return Err(contradicts(table, "mass_kg", most, "two make a body that strikes at both its ends"));
    }
    let falling_speed_m_s = value(&contact_table, "falling_speed_m_s")?;
    let extras = SceneExtras {
        contents: loose.iter().map(|table| loose_mass(table, &cask)).collect::<Result<_, _>>()?,
        falling_friction: contact_table.given("falling_friction")?.map(|fast| (fast, falling_speed_m_s)),
        returning_friction: contact_table.given("returning_friction")?,
        guided,
        roll_rad_s: value(&drop_table, "roll_deg_s")?.to_radians(),
        rates,
    };
    let mut scene = Scene {
        name: root.text("name")?.unwrap_or_else(|| cask.name.clone()),
        seed: whole_number(&root, "seed")?.unwrap_or(by_pulses.seed),
        first_end: crushable(&first, by_pulses.first_end)?,
        second_end: crushable(&second, by_pulses.second_end)?,
        modes: root.tables("mode")?.iter().map(mode).collect::<Result<_, _>>()?,
        elastic: root.value("body").map(|_| elastic_body(&root)).transpose()?,
        after_s: value(&recording, "after_s")?,
        rest: flag(&recording, "rest")?,
        clock_error: 1e-6 * value(&recording, "clock_error_ppm")?,
        swapped_ends: flag(&recording, "swapped_ends")?,
        channels,
        extras,
        ..by_pulses
    };
    let usual_s = if scene.rest { scene.fall_s() + AT_REST_S } else { scene.before_s };
    scene.before_s = recording.given("before_s")?.unwrap_or(usual_s);
    affordable(&root, &tables, &scene)?;
    let defaults = cask_file::assumed(&root, &["cask", "drop", "contact"]);
    let stated = CaskFile {
        path: path.to_owned(),
        channels: specs,
        others,
        scale: root.table("cask")?.given("scale")?,
        ..drawn::cask_file(cask, stated_drop(&drop_table, free)?, contact, defaults)
    };
    Ok(SceneFile { scene, stated })
}

fn loose_mass(table: &Section, cask: &Cask) -> Result<LooseMass, CaskFileError> {
    let (gap_m, play_m) = (value(table, "gap_m")?, value(table, "play_m")?);
    if gap_m > play_m {
        return Err(contradicts(table, "gap_m", "not above play_m", "the mass lies between its pads"));
    }
    Ok(LooseMass {
        mass_kg: table.required_number("mass_kg")?,
        position_m: channel::position_m(table, "position_m", cask)?.unwrap_or(cask.cog_m),
        gap_m,
        play_m,
        pulse_s: 1e-3 * value(table, "pulse_ms")?,
        damping_s_m: value(table, "damping_s_m")?,
    })
}

fn stated_drop(table: &Section, drop: Drop) -> Result<Drop, CaskFileError> {
    let angle_rad = table.given("stated_angle_deg")?.map(f64::to_radians);
    Ok(Drop {
        height_m: table.given("stated_height_m")?.unwrap_or(drop.height_m),
        angle_rad: angle_rad.unwrap_or(drop.angle_rad),
        ..drop
    })
}

/// Reads the impact that `[first_end]` or `[second_end]` requests by its pulse.
fn impact(table: &Section, usual: WantedImpact) -> Result<WantedImpact, CaskFileError> {
    Ok(WantedImpact {
        duration_s: table.given("pulse_ms")?.map_or(usual.duration_s, |ms| ms * 1e-3),
        restitution: table.given("k")?.unwrap_or(usual.restitution),
        yield_share: table.given("yield_share")?,
    })
}

/// The end with the stiffnesses of the table, or with the pulse that gave `by_pulse`.
fn crushable(table: &Section, by_pulse: CrushableEnd) -> Result<CrushableEnd, CaskFileError> {
    needs(table, &[("lock_up_m", "lock_up_n_m"), ("lock_up_n_m", "lock_up_m")])?;
    let by_pulse = CrushableEnd {
        lock_up: table.given("lock_up_m")?.zip(table.given("lock_up_n_m")?),
        footprint: value(table, "footprint")?,
        ..by_pulse
    };
    let any_of = |keys: &[&'static str]| keys.iter().copied().find(|key| table.value(key).is_some());
    let (yield_n, unloading_n_m) = (table.given("yield_n")?, table.given("unloading_n_m")?);
    let Some(loading_n_m) = table.given("loading_n_m")? else {
        return any_of(&["unloading_n_m", "yield_n"]).map_or(Ok(by_pulse), |key| {
            Err(contradicts(table, key, "needs loading_n_m", "give loading_n_m beside it, or pulse_ms and k"))
        });
    };
    let unloading_n_m = unloading_n_m.unwrap_or(loading_n_m);
    if let Some(key) = any_of(&["pulse_ms", "k", "yield_share"]) {
        let mend = "give pulse_ms and k, or the stiffnesses, not both";
        return Err(contradicts(table, key, "not beside loading_n_m", mend));
    }
    if unloading_n_m < loading_n_m {
        let mend = "an end that unloads more softly than it loads would give energy";
        return Err(contradicts(table, "unloading_n_m", "not below loading_n_m", mend));
    }
    Ok(CrushableEnd { loading_n_m, unloading_n_m, yield_n, ..by_pulse })
}

/// The elastic body, which has modes of its own.
fn elastic_body(root: &Section) -> Result<ElasticBody, CaskFileError> {
    if let Some(mode) = root.tables("mode")?.first() {
        let mend = "leave [body] out, or the [[mode]] tables: an elastic body has modes of its own";
        return Err(contradicts(mode, "frequency_hz", "not beside [body]", mend));
    }
    let body = root.table("body")?;
    let first_bending_hz = body.required_number("first_bending_hz")?;
    Ok(ElasticBody { first_bending_hz, damping: value(&body, "damping")? })
}

fn mode(table: &Section) -> Result<BendingMode, CaskFileError> {
    Ok(BendingMode {
        order: whole_number(table, "order")?.unwrap_or(1),
        frequency_hz: table.required_number("frequency_hz")?,
        damping: value(table, "damping")?,
        strength: value(table, "strength")?,
    })
}

/// The channels, each name once.
fn channels(tables: &[Section], cask: &Cask) -> Result<Vec<channel::ChannelPair>, CaskFileError> {
    if tables.is_empty() {
        return Ok(channel::usual_channels(cask));
    }
    let mut channels: Vec<channel::ChannelPair> = Vec::new();
    for table in tables {
        let pair = channel::channel(table, cask)?;
        if channels.iter().any(|other| other.0.name == pair.0.name) {
            let message = format!("two channels are named \"{}\"", pair.0.name);
            return Err(table.refuse("name", message, "name each channel once"));
        }
        channels.push(pair);
    }
    Ok(channels)
}

/// Refuses a record that is too long for its rate and would fill the memory.
fn affordable(root: &Section, tables: &[Section], scene: &Scene) -> Result<(), CaskFileError> {
    let long_s = scene.before_s + scene.after_s;
    let Some(at) = scene.channels.iter().position(|c| c.sample_rate_hz * long_s > MOST_SAMPLES) else {
        return Ok(());
    };
    let table = tables.get(at).unwrap_or(root);
    let message = format!("sample_rate_hz over {long_s} s gives more than {MOST_SAMPLES:.0} samples");
    let mend = "shorten before_s and after_s, or lower sample_rate_hz";
    Err(table.refuse("sample_rate_hz", message, mend))
}

/// A number; the key's default if it is absent.
fn value(table: &Section, key: &str) -> Result<f64, CaskFileError> {
    let default = || table.row(key).and_then(|row| row.default.parse().ok()).unwrap_or(0.0);
    Ok(table.given(key)?.unwrap_or_else(default))
}

/// `true` or `false`; false if the key is absent.
fn flag(table: &Section, key: &str) -> Result<bool, CaskFileError> {
    Ok(table.flag(key)?.unwrap_or(false))
}

/// A whole number of 0 or more, within the key's range.
fn whole_number<T: std::str::FromStr>(table: &Section, key: &str) -> Result<Option<T>, CaskFileError> {
    if table.given(key)?.is_none() {
        return Ok(None);
    }
    let written = table.value(key).and_then(|value| value.get_ref().as_integer());
    let whole = written.and_then(|integer| integer.as_str().replace('_', "").parse().ok());
    whole.map(Some).ok_or_else(|| {
        let mend = format!("write it without point, sign and quotes: {key} = 1");
        table.refuse(key, format!("{key} is no whole number of 0 or more"), &mend)
    })
}

/// A list of `[from, to]`, in s after the first sample.
fn spans_s(table: &Section, key: &str) -> Result<Vec<(f64, f64)>, CaskFileError> {
    let Some(value) = table.value(key) else { return Ok(Vec::new()) };
    let spans = Vec::<Vec<f64>>::deserialize(value.clone().into_deserializer()).ok();
    let span = |span: Vec<f64>| match span[..] {
        [from_s, to_s] if 0.0 <= from_s && from_s < to_s && to_s.is_finite() => Some((from_s, to_s)),
        _ => None,
    };
    let spans: Option<Vec<_>> = spans.and_then(|spans| spans.into_iter().map(span).collect());
    spans.ok_or_else(|| {
        let mend = format!(
            "write {key} = [[0.12, 0.14]]: from and to in s after the first sample, the later behind"
        );
        table.refuse(key, format!("{key} is no list of spans"), &mend)
    })
}

/// Refuses the first of each pair of keys if the second is absent.
fn needs(table: &Section, pairs: &[(&'static str, &str)]) -> Result<(), CaskFileError> {
    for (key, other) in pairs {
        if table.value(key).is_some() && table.value(other).is_none() {
            let mend = format!("add {other}, or delete {key}");
            return Err(contradicts(table, key, &format!("no meaning without {other}"), &mend));
        }
    }
    Ok(())
}

/// Refuses a key that is meaningless with the other keys of its table.
fn contradicts(table: &Section, key: &str, expected: &str, mend: &str) -> CaskFileError {
    let message = format!("{key} contradicts its table: {expected}");
    table.refuse(key, message, mend)
}

#[cfg(test)]
mod tests;
