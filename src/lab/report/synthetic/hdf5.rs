//! A synthetic recording to HDF5: one dataset a channel in `/daq`; where samples were lost, the times of the
//! rest in `/time_s`.

use super::place::SyntheticPlace;
use crate::lab::data::SyntheticRecording;
use crate::report::ReportError;
use crate::report::curves_h5::{filled, text, through_a_file};
use hdf5_metno::File;

/// The file as bytes.
///
/// # Errors
/// [`ReportError::Hdf5`] where the library fails, [`ReportError::Scratch`] where the temporary folder does.
pub(super) fn bytes(
    recording: &SyntheticRecording,
    places: &[SyntheticPlace],
) -> Result<Vec<u8>, ReportError> {
    through_a_file(|file| write(file, recording, places))
}

fn write(file: &File, recording: &SyntheticRecording, places: &[SyntheticPlace]) -> Result<(), ReportError> {
    let group = file.create_group("daq")?;
    for (channel, place) in recording.channels.iter().zip(places) {
        let samples: Vec<f32> = channel.samples.iter().copied().filter(|x| !x.is_nan()).collect();
        let dataset = filled(&group, &place.name, &samples)?;
        text(&dataset, "unit", &channel.unit)?;
        for (name, value) in [("sample_rate_hz", channel.sample_rate_hz), ("start_time_s", channel.start_s)] {
            dataset.new_attr::<f64>().create(name)?.write_scalar(&value)?;
        }
        if place.time.is_some() {
            let times =
                if file.link_exists("time_s") { file.group("time_s")? } else { file.create_group("time_s")? };
            let kept = channel.samples.iter().enumerate().filter(|(_, x)| !x.is_nan());
            let times_s: Vec<f64> = kept.map(|(i, _)| channel.time_s(i)).collect();
            let times = filled(&times, &place.name, &times_s)?;
            text(&times, "unit", "s")?;
        }
    }
    Ok(())
}
