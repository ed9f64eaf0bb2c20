//! Reads a `[[channel]]` table of a scene file: the true channel, and the channel of the cask file.

use super::{flag, needs, spans_s, value, whole_number};
use crate::data::{
    Axis, Cask, ChannelSpec, Coupling, End, OtherSpec, RateSpec, STANDARD_GRAVITY_M_S2, Source, Unit,
};
use crate::ingest::cask_file::CaskFileError;
use crate::ingest::cask_file::channel::{axis, coupling, polarity};
use crate::ingest::cask_file::section::Section;
use crate::lab::data::{Chain, RateSensor, SceneChannel};
use crate::lab::drawn::{spec, unit_m_s2};

/// Sensors sit this far from their end unless the file says otherwise, m; at most a tenth of the cask.
const FROM_END_M: f64 = 0.15;
/// Deviation of a usual sensor's noise, as the key's default.
const WHITE_NOISE_G: f64 = 0.1;

/// A channel, true and as stated.
pub(super) type ChannelPair = (SceneChannel, ChannelSpec);

fn read_end(table: &Section, mend: &str) -> Result<End, CaskFileError> {
    let end = table.word("end", &[("first", End::First), ("second", End::Second)], mend)?;
    end.ok_or_else(|| table.missing("end", mend))
}

/// One transverse sensor near each end, for a scene without channels.
pub(super) fn usual_channels(cask: &Cask) -> Vec<ChannelPair> {
    let channel = |(name, end)| {
        let mut channel = SceneChannel::perfect(name, end, usual_position_m(cask, end));
        channel.chain.white_noise_m_s2 = WHITE_NOISE_G * STANDARD_GRAVITY_M_S2;
        let stated = stated_spec(&channel);
        (channel, stated)
    };
    [("A1", End::First), ("A2", End::Second)].map(channel).into()
}

/// Specification of a channel in a true cask file, with its source still unnamed.
fn stated_spec(channel: &SceneChannel) -> ChannelSpec {
    ChannelSpec { source: Source::Path(String::new()), ..spec(channel) }
}

fn usual_position_m(cask: &Cask, end: End) -> f64 {
    let from_end_m = FROM_END_M.min(cask.length_m / 10.0);
    match end {
        End::First => from_end_m,
        End::Second => cask.length_m - from_end_m,
    }
}

/// The channel of one table.
pub(super) fn channel(table: &Section, cask: &Cask) -> Result<ChannelPair, CaskFileError> {
    const HIDDEN: &str =
        "stated_coupling = \"dc\" hides the coupling from the cask file; left out, it is stated as it is";
    let end = read_end(table, "end = \"first\" (the low end) or \"second\" (the one that slaps down)")?;
    let unit = unit(table, "unit")?.unwrap_or(Unit::G);
    let unit_name = if unit == Unit::G { "g" } else { "m/s^2" };
    let full_scale = table.given("full_scale")?;
    let coupling = coupling(table)?;
    let channel = SceneChannel {
        name: table.required_text("name")?,
        end,
        axis: axis(table)?.unwrap_or(Axis::Transverse),
        position_m: position_m(table, "position_m", cask)?.unwrap_or_else(|| usual_position_m(cask, end)),
        offset_m: value(table, "offset_m")?,
        lateral_m: value(table, "lateral_m")?,
        unit: unit_name.to_owned(),
        sample_rate_hz: value(table, "sample_rate_hz")?,
        chain: chain(table, full_scale.map(|limit| limit * unit_m_s2(unit_name)))?,
    };
    let is_hidden = table.word("stated_coupling", &[("dc", true)], HIDDEN)?.unwrap_or(false);
    let stated = ChannelSpec {
        unit: Some(self::unit(table, "stated_unit")?.unwrap_or(unit)),
        position_m: position_m(table, "stated_position_m", cask)?.unwrap_or(channel.position_m),
        polarity: polarity(table)?,
        full_scale,
        coupling: if is_hidden { Coupling::Dc } else { coupling },
        lateral_m: table.given("stated_lateral_m")?.unwrap_or(channel.lateral_m),
        ..stated_spec(&channel)
    };
    Ok((channel, stated))
}

/// Reads the angular-rate sensor of one table, true and as stated.
pub(super) fn rate(table: &Section, cask: &Cask) -> Result<(RateSensor, OtherSpec), CaskFileError> {
    let units = [("deg/s", "deg/s"), ("rad/s", "rad/s")];
    let unit = table.word("unit", &units, "\"deg/s\" (the default) or \"rad/s\"")?.unwrap_or("deg/s");
    let end = read_end(table, "end = \"first\" (the low end) or \"second\" (the one that slaps down)")?;
    let sensor = RateSensor {
        name: table.required_text("name")?,
        position_m: position_m(table, "position_m", cask)?.unwrap_or_else(|| usual_position_m(cask, end)),
        unit: unit.to_owned(),
        sample_rate_hz: value(table, "sample_rate_hz")?,
        scale: value(table, "scale")?,
        offset_rad_s: value(table, "offset_deg_s")?.to_radians(),
        white_noise_rad_s: value(table, "white_noise_deg_s")?.to_radians(),
    };
    let read = ChannelSpec::new(&sensor.name, end, "", sensor.position_m);
    let rate = Some(RateSpec { polarity: 1.0, calibration: None });
    Ok((sensor, OtherSpec { read, unit: Some(unit.to_owned()), rate }))
}

fn unit(table: &Section, key: &str) -> Result<Option<Unit>, CaskFileError> {
    const UNITS: &str = "a synthetic recording is written in \"g\" (the default) or \"m/s^2\"";
    table.word(key, &[("g", Unit::G), ("m/s^2", Unit::MetrePerSecondSquared)], UNITS)
}

pub(super) fn position_m(table: &Section, key: &str, cask: &Cask) -> Result<Option<f64>, CaskFileError> {
    let (at, allowed) = (table.given(key)?, 0.0..=cask.length_m);
    match at.filter(|at| !allowed.contains(at)) {
        None => Ok(at),
        Some(at) => {
            let problem = format!("{key} is {at}");
            Err(table.outside(key, &problem, &allowed, "metres along the axis from the first end"))
        }
    }
}

fn chain(table: &Section, full_scale_m_s2: Option<f64>) -> Result<Chain, CaskFileError> {
    needs(table, &[("resonance_damping", "resonance_hz"), ("hum_hz", "hum_g")])?;
    needs(table, &[("whip_hz", "whip_g"), ("bits", "full_scale")])?;
    let value = |key| value(table, key);
    let in_g = |key| Ok::<_, CaskFileError>(value(key)? * STANDARD_GRAVITY_M_S2);
    let [damping, hum_hz, whip_hz] = ["resonance_damping", "hum_hz", "whip_hz"].map(value);
    let (damping, hum_hz, whip_hz) = (damping?, hum_hz?, whip_hz?);
    Ok(Chain {
        tilt_rad: value("tilt_deg")?.to_radians(),
        cross_axis: value("cross_axis_percent")? / 100.0,
        resonance: table.given("resonance_hz")?.map(|hz| (hz, damping)),
        ac_time_constant_s: table.given("time_constant_s")?,
        anti_alias_hz: table.given("anti_alias_hz")?,
        scale: value("scale")?,
        offset_m_s2: in_g("offset_g")?,
        zero_shift_m_s2: in_g("zero_shift_g")?,
        white_noise_m_s2: in_g("white_noise_g")?,
        pink_noise_m_s2: in_g("pink_noise_g")?,
        hum: table.given("hum_g")?.map(|hum_g| (hum_g * STANDARD_GRAVITY_M_S2, hum_hz)),
        cable_noise_m_s2: in_g("cable_noise_g")?,
        whip: table.given("whip_g")?.map(|whip_g| (whip_g * STANDARD_GRAVITY_M_S2, whip_hz)),
        full_scale_m_s2,
        bits: whole_number(table, "bits")?,
        dropouts_s: spans_s(table, "dropouts_s")?,
        gaps_s: spans_s(table, "gaps_s")?,
        skew_s: value("skew_ms")? * 1e-3,
        swapped_polarity: flag(table, "swapped_polarity")?,
    })
}
