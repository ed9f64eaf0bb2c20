//! Curves to `curves.h5`: one group a channel, datasets with their unit, rate and start as attributes.

use super::grid::{CurveSeries, motion_series, named_events, step_s};
use super::{ReportError, scratch};
use crate::data::Analysis;
use crate::numerics::single;
use hdf5_metno::types::VarLenUnicode;
use hdf5_metno::{Dataset, File, Group, H5Type, Location};

/// Level of gzip: at 4 float curves are smaller by 1 %, and writing them takes a fifth longer.
const GZIP_LEVEL: u8 = 1;

/// The file as bytes.
///
/// # Errors
/// [`ReportError::Hdf5`] where the library fails, [`ReportError::Scratch`] where the temporary folder does.
pub(super) fn bytes(analysis: &Analysis) -> Result<Vec<u8>, ReportError> {
    through_a_file(|file| write(file, analysis))
}

/// What `fill` writes, as bytes. The library writes only to files, so a scratch file in the system's
/// temporary folder carries them.
///
/// # Errors
/// [`ReportError::Hdf5`] where the library fails, [`ReportError::Scratch`] where the temporary folder does.
pub(crate) fn through_a_file(
    fill: impl FnOnce(&File) -> Result<(), ReportError>,
) -> Result<Vec<u8>, ReportError> {
    let failed = |source| ReportError::Scratch { folder: std::env::temp_dir().display().to_string(), source };
    let folder = scratch::folder().map_err(failed)?;
    let path = folder.path().join(scratch::FILE_NAME);
    // As every version of the library reads it, and without the times of writing that newer ones add.
    let file = File::with_options().with_fapl(|access| access.libver_earliest()).create(&path)?;
    fill(&file)?;
    file.close()?;
    std::fs::read(&path).map_err(failed)
}

fn write(file: &File, analysis: &Analysis) -> Result<(), ReportError> {
    text(file, "schema", "dropcheck.curves/1")?;
    text(file, "version", analysis.result.version)?;
    text(file, "recording", &analysis.result.input.recording)?;
    text(file, "recording_sha256", &analysis.result.input.recording_sha256)?;
    if let Some(start_unix_ns) = analysis.start_unix_ns {
        file.new_attr::<i64>().create("start_unix_ns")?.write_scalar(&start_unix_ns)?;
    }
    let channels = file.create_group("channels")?;
    for (i, curve) in analysis.curves.channels.iter().enumerate() {
        let group = channels.create_group(&link_name(&channels, &curve.channel, i))?;
        text(&group, "name", &curve.channel)?;
        dataset(&group, "raw", &curve.raw_m_s2, "m/s^2", &curve.time_s)?;
        dataset(&group, "filtered", &curve.filtered_m_s2, "m/s^2", &curve.time_s)?;
        dataset(&group, "velocity", &curve.velocity_m_s, "m/s", &curve.time_s)?;
        let (frequency_hz, magnitude_m_s) = super::spectrum(curve);
        spectrum(&group, &frequency_hz, &magnitude_m_s, "m/s")?;
    }
    if !analysis.curves.others.is_empty() {
        let others = file.create_group("other_channels")?;
        for (i, curve) in analysis.curves.others.iter().enumerate() {
            let group = others.create_group(&link_name(&others, &curve.channel, i))?;
            text(&group, "name", &curve.channel)?;
            dataset(&group, "raw", &curve.values, &curve.unit, &curve.time_s)?;
            spectrum(&group, &curve.frequency_hz, &curve.magnitude, &format!("{} s", curve.unit))?;
        }
    }
    if let Some(motion) = &analysis.curves.motion {
        let group = file.create_group("motion")?;
        for CurveSeries { name, values, factor } in motion_series(motion) {
            let values: Vec<f64> = values.iter().map(|value| value * factor).collect();
            let (name, unit) = [("_rad_s", "rad/s"), ("_m_s", "m/s"), ("_deg", "deg"), ("_m", "m")]
                .iter()
                .find_map(|(suffix, unit)| name.strip_suffix(suffix).map(|name| (name, *unit)))
                .unwrap_or((name, "1"));
            dataset(&group, name, &values, unit, &motion.time_s)?;
        }
    }
    events(file, analysis)
}

fn events(file: &File, analysis: &Analysis) -> Result<(), ReportError> {
    let group = file.create_group("events")?;
    for (name, time_s) in named_events(&analysis.result.events) {
        let name = format!("{}_s", name.replace([' ', '-'], "_"));
        if let Some(time_s) = time_s {
            group.new_attr::<f64>().create(&*name)?.write_scalar(&time_s)?;
        }
    }
    Ok(())
}

fn dataset(group: &Group, name: &str, values: &[f64], unit: &str, time_s: &[f64]) -> Result<(), ReportError> {
    let dataset = filled(group, name, &singles(values))?;
    text(&dataset, "unit", unit)?;
    if let Some(step_s) = step_s(time_s) {
        dataset.new_attr::<f64>().create("sample_rate_hz")?.write_scalar(&(1.0 / step_s))?;
    }
    if let Some(start_s) = time_s.first() {
        dataset.new_attr::<f64>().create("start_time_s")?.write_scalar(start_s)?;
    }
    Ok(())
}

fn spectrum(group: &Group, frequency_hz: &[f64], magnitude: &[f64], unit: &str) -> Result<(), ReportError> {
    let frequency = filled(group, "spectrum_frequency", &singles(frequency_hz))?;
    text(&frequency, "unit", "Hz")?;
    let magnitude = filled(group, "spectrum_magnitude", &singles(magnitude))?;
    text(&magnitude, "unit", unit)
}

fn singles(values: &[f64]) -> Vec<f32> {
    values.iter().copied().map(single).collect()
}

/// A dataset of these values, compressed.
pub(crate) fn filled<T: H5Type>(group: &Group, name: &str, values: &[T]) -> Result<Dataset, ReportError> {
    let builder = group.new_dataset_builder();
    // A chunked dataset cannot be of length zero.
    let builder = if values.is_empty() { builder } else { builder.shuffle().deflate(GZIP_LEVEL) };
    Ok(builder.with_data(values).create(name)?)
}

/// A text attribute.
pub(crate) fn text(place: &Location, name: &str, value: &str) -> Result<(), ReportError> {
    // Strings in HDF5 end at the first NUL.
    let value: VarLenUnicode = value.replace('\0', "").parse().unwrap_or_default();
    place.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&value)?;
    Ok(())
}

/// A link name that HDF5 takes: no slash, not a dot, not taken; the group's attribute `name` has the
/// channel's own.
fn link_name(parent: &Group, name: &str, index: usize) -> String {
    let name: String =
        name.chars().map(|c| if c == '/' || c == '\0' || c.is_control() { '_' } else { c }).collect();
    if name.is_empty() || name == "." || name == ".." || parent.link_exists(&name) {
        return format!("channel_{}", index + 1);
    }
    name
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    fn reopened(analysis: &Analysis) -> (tempfile::TempDir, File) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curves.h5");
        std::fs::write(&path, bytes(analysis).unwrap()).unwrap();
        let file = File::open(&path).unwrap();
        (folder, file)
    }

    #[test]
    fn curves_return_with_rate_and_start() {
        let analysis = sample::analysis();
        let (_folder, file) = reopened(&analysis);
        let velocity = file.dataset("channels/A1/velocity").unwrap();
        assert_eq!(velocity.read_raw::<f32>().unwrap(), singles(&analysis.curves.channels[0].velocity_m_s));
        let rate: f64 = velocity.attr("sample_rate_hz").unwrap().read_scalar().unwrap();
        assert!((rate - 20_000.0).abs() < 1e-3);
        let start: f64 = velocity.attr("start_time_s").unwrap().read_scalar().unwrap();
        assert_eq!(start.to_bits(), 0.14_f64.to_bits());
        let unit: VarLenUnicode = velocity.attr("unit").unwrap().read_scalar().unwrap();
        assert_eq!(unit.as_str(), "m/s");
        assert!(file.dataset("motion/angle").is_ok());
    }

    #[test]
    fn any_channel_name_finds_a_place() {
        let mut analysis = sample::analysis();
        analysis.curves.channels[0].channel = "left/side".into();
        analysis.curves.channels[1].channel = "left_side".into();
        let (_folder, file) = reopened(&analysis);
        assert!(file.group("channels/left_side").is_ok());
        assert!(file.group("channels/channel_2").is_ok());
    }
}
