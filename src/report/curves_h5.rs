//! Writes curves as `curves.h5`: one group per channel, datasets with their unit, rate and start as
//! attributes.

use super::ReportError;
use super::grid::{CurveSeries, motion_series, named_events, step_s};
use crate::data::Analysis;
use crate::numerics::to_f32;
use hdf5_metno::types::VarLenUnicode;
use hdf5_metno::{Dataset, File, Group, H5Type, Location};
use std::fs;
use std::path::Path;
use std::sync::Once;
use std::time::Duration;
use tempfile::TempDir;

/// Level of gzip: at 4 float curves are smaller by 1 %, and writing them takes a fifth longer.
const GZIP_LEVEL: u8 = 1;

/// The file as bytes.
///
/// # Errors
///
/// [`ReportError::Hdf5`] if the library fails, [`ReportError::Scratch`] if the temporary folder does.
pub(super) fn bytes(analysis: &Analysis) -> Result<Vec<u8>, ReportError> {
    through_a_file(|file| write(file, analysis))
}

/// Returns the bytes that `fill` writes. The library writes only to files, so a scratch file in the system's
/// temporary folder carries them.
///
/// # Errors
///
/// [`ReportError::Hdf5`] if the library fails, [`ReportError::Scratch`] if the temporary folder does.
pub(crate) fn through_a_file(
    fill: impl FnOnce(&File) -> Result<(), ReportError>,
) -> Result<Vec<u8>, ReportError> {
    let failed = |source| ReportError::Scratch { folder: std::env::temp_dir().display().to_string(), source };
    let folder = scratch_folder().map_err(failed)?;
    let path = folder.path().join(FILE_NAME);
    // Every version of the library can read this format, and it omits the times of writing that newer ones
    // add.
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
    let dataset = store(group, name, &to_f32s(values))?;
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
    let frequency = store(group, "spectrum_frequency", &to_f32s(frequency_hz))?;
    text(&frequency, "unit", "Hz")?;
    let magnitude = store(group, "spectrum_magnitude", &to_f32s(magnitude))?;
    text(&magnitude, "unit", unit)
}

fn to_f32s(values: &[f64]) -> Vec<f32> {
    values.iter().copied().map(to_f32).collect()
}

/// Writes a compressed dataset of these values.
pub(crate) fn store<T: H5Type>(group: &Group, name: &str, values: &[T]) -> Result<Dataset, ReportError> {
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

/// A valid and free HDF5 link name: no slash, not a dot; the group's attribute `name` has the channel's name.
fn link_name(parent: &Group, name: &str, index: usize) -> String {
    let name: String =
        name.chars().map(|c| if c == '/' || c == '\0' || c.is_control() { '_' } else { c }).collect();
    if name.is_empty() || name == "." || name == ".." || parent.link_exists(&name) {
        return format!("channel_{}", index + 1);
    }
    name
}

/// Beginning of the folders' names; six letters and digits follow.
const PREFIX: &str = "dropcheck-";
/// The only file in them.
const FILE_NAME: &str = "curves.h5";
/// No run needs its folder for a day, so an older one is abandoned.
const STALE: Duration = Duration::from_hours(24);

/// Makes a folder that is removed when its value is dropped.
///
/// # Errors
///
/// Returned by the system, if the temporary folder is not writable.
fn scratch_folder() -> std::io::Result<TempDir> {
    static CLEARED: Once = Once::new();
    let folder = tempfile::Builder::new().prefix(PREFIX).tempdir()?;
    CLEARED.call_once(|| clear(folder.path(), STALE));
    Ok(folder)
}

/// Removes the folders beside `own` that belong to the same owner, are no links, have not changed for
/// `stale`, and hold nothing but the file.
fn clear(own: &Path, stale: Duration) {
    let (Some(place), Ok(mine)) = (own.parent(), fs::symlink_metadata(own)) else { return };
    for entry in fs::read_dir(place).into_iter().flatten().flatten() {
        let name = entry.file_name().into_string().unwrap_or_default();
        let is_named_so = name
            .strip_prefix(PREFIX)
            .is_some_and(|rest| rest.len() == 6 && rest.bytes().all(|byte| byte.is_ascii_alphanumeric()));
        let is_stale = |there: &fs::Metadata| {
            let age = there.modified().ok().and_then(|modified| modified.elapsed().ok());
            there.is_dir() && has_owner_of(there, &mine) && age.is_some_and(|age| age >= stale)
        };
        if is_named_so && entry.path() != own && entry.metadata().is_ok_and(|there| is_stale(&there)) {
            // Only the link is removed if the file is a link; a folder with other files stays.
            let _ = fs::remove_file(entry.path().join(FILE_NAME));
            let _ = fs::remove_dir(entry.path());
        }
    }
}

#[cfg(unix)]
fn has_owner_of(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    one.uid() == other.uid()
}

/// Each user has a separate temporary folder.
#[cfg(not(unix))]
fn has_owner_of(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    true
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
        assert_eq!(velocity.read_raw::<f32>().unwrap(), to_f32s(&analysis.curves.channels[0].velocity_m_s));
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

    #[cfg(unix)]
    #[test]
    fn only_old_folders_of_this_name_are_cleared() {
        let place = tempfile::tempdir().unwrap();
        let made = |name: &str, file: &str| {
            fs::create_dir(place.path().join(name)).unwrap();
            fs::write(place.path().join(name).join(file), "x").unwrap();
        };
        made("dropcheck-aB3xY9", FILE_NAME);
        made("dropcheck-aB3xY8", "theirs");
        made("dropcheck-results", FILE_NAME);
        made("elsewhere", FILE_NAME);
        std::os::unix::fs::symlink(place.path().join("elsewhere"), place.path().join("dropcheck-aB3xY7"))
            .unwrap();
        let own = place.path().join("dropcheck-aB3xY6");
        fs::create_dir(&own).unwrap();
        let left = || {
            let mut names: Vec<String> = fs::read_dir(place.path())
                .unwrap()
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names.len()
        };
        clear(&own, STALE);
        assert_eq!(left(), 6, "younger than a day");
        clear(&own, Duration::ZERO);
        assert_eq!(left(), 5);
        assert!(!place.path().join("dropcheck-aB3xY9").exists());
        assert!(place.path().join("elsewhere").join(FILE_NAME).exists());
    }
}
