//! A `[[channel]]` table of a scene file to the channel as it is and the channel as the cask file will state it.

use super::values::{flag, number_or, size_or, spans_s};
use crate::data::{Axis, Cask, ChannelSpec, Coupling, End, STANDARD_GRAVITY_M_S2, Source, Unit};
use crate::ingest::cask_file::CaskFileError;
use crate::ingest::cask_file::channel::{coupling, polarity};
use crate::ingest::cask_file::section::Section;
use crate::lab::data::{Chain, SceneChannel};
use crate::lab::drawn::{spec, unit_m_s2};

/// Defaults of a channel: a usual recorder and a usual piezoresistive sensor.
const SAMPLE_RATE_HZ: f64 = 20_000.0;
const WHITE_NOISE_G: f64 = 0.1;
const RESONANCE_DAMPING: f64 = 0.02;
const MAINS_HZ: f64 = 50.0;

/// Sensors sit this far from their end unless the file says otherwise, m; at most a tenth of the cask.
const FROM_END_M: f64 = 0.15;

/// The fastest recorder and resonance that are simulated, Hz: faster ones fill the memory.
const FASTEST_HZ: f64 = 5e6;
const SLOWEST_HZ: f64 = 100.0;

/// A channel as it is, and as stated.
pub(super) type Both = (SceneChannel, ChannelSpec);

/// One transverse sensor near each end, for a scene without channels.
pub(super) fn usual(cask: &Cask) -> Vec<Both> {
    let channel = |(name, end)| {
        let mut channel = SceneChannel::perfect(name, end, usual_position_m(cask, end));
        channel.chain.white_noise_m_s2 = WHITE_NOISE_G * STANDARD_GRAVITY_M_S2;
        let stated = stated(&channel);
        (channel, stated)
    };
    [("A1", End::First), ("A2", End::Second)].map(channel).into()
}

/// What a true cask file says of a channel, its source still to be named.
fn stated(channel: &SceneChannel) -> ChannelSpec {
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
pub(super) fn channel(table: &Section, cask: &Cask) -> Result<Both, CaskFileError> {
    const END: &str = "end = \"first\" (the low end) or \"second\" (the one that slaps down)";
    const AXIS: &str =
        "axis = \"transverse\" (across the cask, in the plane of the drop) or \"axial\" (along it)";
    let name = table.required_text("name")?.value;
    let end = table
        .word("end", &[("first", End::First), ("second", End::Second)], END)?
        .ok_or_else(|| table.missing("end", END))?;
    let axis = table.word("axis", &[("transverse", Axis::Transverse), ("axial", Axis::Axial)], AXIS)?;
    let unit = unit(table, "unit")?.unwrap_or(Unit::G);
    let unit_name = if unit == Unit::G { "g" } else { "m/s^2" };
    let full_scale = table.positive("full_scale")?.map(|limit| limit.value);
    let position =
        |key| table.within(key, &(0.0..=cask.length_m), "metres along the axis from the first end");
    let coupling = coupling(table)?;
    let channel = SceneChannel {
        name,
        end,
        axis: axis.unwrap_or(Axis::Transverse),
        position_m: position("position_m")?.unwrap_or_else(|| usual_position_m(cask, end)),
        offset_m: number_or(table, "offset_m", 0.0)?,
        unit: unit_name.to_owned(),
        sample_rate_hz: table
            .within("sample_rate_hz", &(SLOWEST_HZ..=FASTEST_HZ), "samples a second")?
            .unwrap_or(SAMPLE_RATE_HZ),
        chain: chain(table, coupling, full_scale.map(|limit| limit * unit_m_s2(unit_name)))?,
    };
    let is_hidden = stated_dc(table)?;
    let stated = ChannelSpec {
        unit: Some(self::unit(table, "stated_unit")?.unwrap_or(unit)),
        position_m: position("stated_position_m")?.unwrap_or(channel.position_m),
        polarity: polarity(table)?,
        full_scale,
        coupling: if is_hidden { Coupling::Dc } else { coupling },
        ..stated(&channel)
    };
    Ok((channel, stated))
}

fn unit(table: &Section, key: &str) -> Result<Option<Unit>, CaskFileError> {
    let words = [("g", false), ("m/s^2", true)];
    let word =
        table.word(key, &words, "a synthetic recording is written in \"g\" (the default) or \"m/s^2\"")?;
    Ok(word.map(|is_si| if is_si { Unit::MetrePerSecondSquared } else { Unit::G }))
}

/// Whether the cask file is to hide an AC coupling.
fn stated_dc(table: &Section) -> Result<bool, CaskFileError> {
    const MEND: &str =
        "stated_coupling = \"dc\" hides the coupling from the cask file; left out, it is stated as it is";
    Ok(table.word("stated_coupling", &[("dc", true)], MEND)?.unwrap_or(false))
}

fn chain(table: &Section, coupling: Coupling, full_scale_m_s2: Option<f64>) -> Result<Chain, CaskFileError> {
    let in_g = |key, default| size_or(table, key, default).map(|g| g * STANDARD_GRAVITY_M_S2);
    let frequency = |key| table.within(key, &(1.0..=FASTEST_HZ), "in Hz");
    Ok(Chain {
        tilt_rad: table
            .within("tilt_deg", &(-90.0..=90.0), "degrees towards the other body axis")?
            .unwrap_or(0.0)
            .to_radians(),
        cross_axis: table
            .within("cross_axis_percent", &(-100.0..=100.0), "usual are 1 to 5 percent")?
            .unwrap_or(0.0)
            / 100.0,
        resonance: beside(
            table,
            frequency("resonance_hz")?,
            ("resonance_damping", "resonance_hz"),
            table.within("resonance_damping", &(0.001..=2.0), "share of critical damping")?,
            RESONANCE_DAMPING,
        )?,
        ac_time_constant_s: match coupling {
            Coupling::Dc => None,
            Coupling::Ac { time_constant_s } => Some(time_constant_s),
        },
        anti_alias_hz: frequency("anti_alias_hz")?,
        scale: table.positive("scale")?.map_or(1.0, |scale| scale.value),
        offset_m_s2: number_or(table, "offset_g", 0.0)? * STANDARD_GRAVITY_M_S2,
        zero_shift_m_s2: number_or(table, "zero_shift_g", 0.0)? * STANDARD_GRAVITY_M_S2,
        white_noise_m_s2: in_g("white_noise_g", WHITE_NOISE_G)?,
        pink_noise_m_s2: in_g("pink_noise_g", 0.0)?,
        hum: beside(
            table,
            table.positive("hum_g")?.map(|hum| hum.value * STANDARD_GRAVITY_M_S2),
            ("hum_hz", "hum_g"),
            frequency("hum_hz")?,
            MAINS_HZ,
        )?,
        cable_noise_m_s2: in_g("cable_noise_g", 0.0)?,
        full_scale_m_s2,
        bits: bits(table, full_scale_m_s2)?,
        dropouts_s: spans_s(table, "dropouts_s")?,
        gaps_s: spans_s(table, "gaps_s")?,
        skew_s: number_or(table, "skew_ms", 0.0)? * 1e-3,
        swapped_polarity: flag(table, "swapped_polarity")?,
    })
}

/// `first` with its companion, which alone means nothing.
fn beside(
    table: &Section,
    first: Option<f64>,
    (key, needs): (&str, &str),
    companion: Option<f64>,
    default: f64,
) -> Result<Option<(f64, f64)>, CaskFileError> {
    match (first, companion) {
        (None, Some(_)) => Err(alone(table, key, needs)),
        (first, companion) => Ok(first.map(|first| (first, companion.unwrap_or(default)))),
    }
}

fn alone(table: &Section, key: &str, needs: &str) -> CaskFileError {
    table.wrong(
        table.value(key).map_or_else(|| table.span(), toml::Spanned::span),
        format!("{key} has no meaning without {needs}"),
        format!("only with {needs}"),
        &format!("add {needs}, or delete {key}"),
    )
}

fn bits(table: &Section, full_scale_m_s2: Option<f64>) -> Result<Option<u8>, CaskFileError> {
    let bits = super::values::whole(table, "bits")?;
    let Some(bits) = bits else { return Ok(None) };
    match u8::try_from(bits.value) {
        Ok(number) if (2..=32).contains(&number) => match full_scale_m_s2 {
            Some(_) => Ok(Some(number)),
            None => Err(alone(table, "bits", "full_scale")),
        },
        _ => Err(table.wrong(
            bits.span,
            format!("bits is {}, outside 2 to 32", bits.value),
            "2 to 32".into(),
            "the bits of the converter over ± full_scale; usual are 12 to 24",
        )),
    }
}
