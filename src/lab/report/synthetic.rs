//! The three files of a synthetic recording: recording, cask file and truth. The cask file names the place of
//! each channel.

mod cask;
mod mcap;

use crate::lab::data::{Scene, SceneFile, SyntheticRecording, Truth};
use crate::numerics::as_f64;
use crate::report::curves_h5::{store, text, through_a_file};
use crate::report::records::records;
use crate::report::{ReportError, json};
use miette::miette;
use serde::Serialize;

/// Format of a synthetic recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SyntheticFormat {
    /// MCAP with blocks in JSON.
    McapJson,
    /// MCAP with blocks in protobuf.
    McapProtobuf,
    /// HDF5 with one dataset per channel.
    Hdf5,
    /// CSV with one column per channel.
    Csv,
}

/// Location of a channel in the file.
struct SyntheticPlace {
    /// Name within the format: of the topic or dataset below `/daq/`, or of the column.
    name: String,
    /// The source as the cask file writes it.
    source: String,
    /// Separate times, as the cask file writes them, if the format does not state them.
    time: Option<String>,
}

/// The files by name: `recording_name`, then the cask file and the truth beside it.
///
/// # Errors
///
/// Returned if the format cannot hold the channels or a writer fails.
pub fn synthetic_files(
    scene_file: &SceneFile,
    recording: &SyntheticRecording,
    recording_name: &str,
    format: SyntheticFormat,
) -> miette::Result<Vec<(String, Vec<u8>)>> {
    let recording = &recording.to_mounted(&scene_file.stated);
    let places = places(recording, format);
    let bytes = match format {
        SyntheticFormat::McapJson => mcap::bytes(recording, &places, true)?,
        SyntheticFormat::McapProtobuf => mcap::bytes(recording, &places, false)?,
        SyntheticFormat::Hdf5 => hdf5_bytes(recording, &places)?,
        SyntheticFormat::Csv => csv_bytes(recording, &places)?,
    };
    let [_, cask_name, truth_name] = synthetic_names(recording_name);
    let cask_file = cask::text(&scene_file.stated, &places, recording_name).into_bytes();
    let truth = json::pretty(&TruthFile {
        schema: "dropcheck.truth/1",
        version: env!("CARGO_PKG_VERSION"),
        recording: recording_name,
        seed: recording.seed,
        t_impact: recording.first_contact_s,
        truth: &recording.truth,
        drawn: &scene_file.scene,
    })?;
    Ok(vec![(recording_name.to_owned(), bytes), (cask_name, cask_file), (truth_name, truth)])
}

/// Content of `….truth.json`; `t_impact` counts from the recording's first sample.
#[derive(Serialize)]
struct TruthFile<'a> {
    schema: &'static str,
    version: &'static str,
    recording: &'a str,
    seed: u64,
    t_impact: f64,
    #[serde(flatten)]
    truth: &'a Truth,
    drawn: &'a Scene,
}

/// The sample rate of all channels, Hz: one table has one rate.
fn one_rate_hz(recording: &SyntheticRecording) -> miette::Result<f64> {
    let mut rates_hz = recording.channels.iter().map(|c| c.sample_rate_hz);
    let first_hz = rates_hz.next().unwrap_or(1.0);
    let mend = "write .mcap or .h5, or give every [[channel]] the same sample_rate_hz";
    rates_hz.find(|hz| (hz - first_hz).abs() > 0.0).map_or(Ok(first_hz), |hz| {
        let rates = format!("{first_hz} and {hz} Hz");
        Err(miette!(help = mend, "CSV holds channels of one sample rate, and this scene has {rates}"))
    })
}

/// Writes a recording as CSV: comma, point, one header with units; a lost sample is an empty cell, a lost row
/// is omitted.
fn csv_bytes(recording: &SyntheticRecording, places: &[SyntheticPlace]) -> miette::Result<Vec<u8>> {
    let (channels, rate_hz) = (&recording.channels, one_rate_hz(recording)?);
    let mut times: Vec<(&str, f64)> = vec![("time_s", 0.0)];
    let late = channels.iter().zip(places).filter(|(channel, _)| channel.start_s > 0.0);
    times.extend(late.filter_map(|(channel, place)| Some((place.time.as_deref()?, channel.start_s))));
    let header = times.iter().map(|(name, _)| (*name).to_owned());
    let columns = channels.iter().zip(places).map(|(c, place)| format!("{} [{}]", place.name, c.unit));
    let count = channels.iter().map(|c| c.samples.len()).min().unwrap_or(0);
    let kept = (0..count).filter(|&row| channels.iter().any(|c| !c.samples[row].is_nan()));
    let rows = kept.map(|row| {
        let times = times.iter().map(|(_, start_s)| format!("{:.9}", start_s + as_f64(row) / rate_hz));
        let samples = channels.iter().map(|channel| channel.samples[row]);
        times.chain(samples.map(|x| if x.is_nan() { String::new() } else { x.to_string() })).collect()
    });
    Ok(records(std::iter::once(header.chain(columns).collect::<Vec<String>>()).chain(rows))?)
}

/// Writes a recording as HDF5: one dataset per channel in `/daq`; if samples were lost, the remaining times
/// in `/time_s`.
fn hdf5_bytes(recording: &SyntheticRecording, places: &[SyntheticPlace]) -> Result<Vec<u8>, ReportError> {
    through_a_file(|file| {
        let group = file.create_group("daq")?;
        for (channel, place) in recording.channels.iter().zip(places) {
            let samples: Vec<f32> = channel.samples.iter().copied().filter(|x| !x.is_nan()).collect();
            let dataset = store(&group, &place.name, &samples)?;
            text(&dataset, "unit", &channel.unit)?;
            for (name, value) in
                [("sample_rate_hz", channel.sample_rate_hz), ("start_time_s", channel.start_s)]
            {
                dataset.new_attr::<f64>().create(name)?.write_scalar(&value)?;
            }
            if place.time.is_some() {
                let times = if file.link_exists("time_s") {
                    file.group("time_s")?
                } else {
                    file.create_group("time_s")?
                };
                let kept = channel.samples.iter().enumerate().filter(|(_, x)| !x.is_nan());
                let times_s: Vec<f64> = kept.map(|(i, _)| channel.time_s(i)).collect();
                let times = store(&times, &place.name, &times_s)?;
                text(&times, "unit", "s")?;
            }
        }
        Ok(())
    })
}

/// Names of the files: the recording, the cask file, the truth.
pub fn synthetic_names(recording_name: &str) -> [String; 3] {
    let stem = recording_name.rsplit_once('.').map_or(recording_name, |(stem, _)| stem);
    [recording_name.to_owned(), format!("{stem}.toml"), format!("{stem}.truth.json")]
}

/// A place for every channel.
fn places(recording: &SyntheticRecording, format: SyntheticFormat) -> Vec<SyntheticPlace> {
    let mut taken: Vec<String> = vec!["time".into(), "time_s".into()];
    let mut places = Vec::new();
    for channel in &recording.channels {
        let name = unique_name(&channel.name, &taken);
        taken.push(name.to_lowercase());
        let has_own_times = channel.start_s > 0.0;
        let has_gaps = channel.samples.iter().any(|x| x.is_nan());
        let (source, time) = match format {
            SyntheticFormat::McapJson | SyntheticFormat::McapProtobuf => {
                (format!("/daq/{name}.samples"), None)
            }
            SyntheticFormat::Hdf5 => (format!("/daq/{name}"), has_gaps.then(|| format!("/time_s/{name}"))),
            SyntheticFormat::Csv => {
                let time = if has_own_times { format!("time_{name}_s") } else { "time_s".into() };
                (name.clone(), Some(time))
            }
        };
        places.push(SyntheticPlace { name, source, time });
    }
    places
}

/// A name with only letters, digits, `_` and `-`, which differs from the others in more than case.
fn unique_name(name: &str, taken: &[String]) -> String {
    let mut name: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
    // A bare number would count columns, and a spreadsheet would compute with a minus in front.
    if name.bytes().all(|b| b.is_ascii_digit()) || name.starts_with('-') {
        name.insert(0, 'A');
    }
    while taken.contains(&name.to_lowercase()) {
        name.push('_');
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_files_share_a_stem() {
        assert_eq!(synthetic_names("a.b.mcap"), ["a.b.mcap", "a.b.toml", "a.b.truth.json"]);
    }

    #[test]
    fn no_two_channels_share_a_place() {
        assert_eq!(unique_name("left.side", &[]), "left_side");
        assert_eq!(unique_name("Left side", &["left_side".into()]), "Left_side_");
        assert_eq!(unique_name("12", &[]), "A12");
        assert_eq!(unique_name("time_s", &["time_s".into()]), "time_s_");
    }
}
