//! A synthetic recording to CSV: comma, point, one header with units; a lost sample is an empty cell, a lost row is left out.

use super::SyntheticError;
use super::place::SyntheticPlace;
use crate::lab::data::SyntheticRecording;
use crate::report::ReportError;

/// The table.
///
/// # Errors
/// [`SyntheticError::OneRate`] where the channels have several rates; [`ReportError::Csv`] where the writer fails.
pub(super) fn bytes(
    recording: &SyntheticRecording,
    places: &[SyntheticPlace],
) -> Result<Vec<u8>, SyntheticError> {
    let channels = &recording.channels;
    let rates_hz: Vec<f64> = channels.iter().map(|c| c.sample_rate_hz).collect();
    let first_hz = rates_hz.first().copied().unwrap_or(1.0);
    if let Some(&other_hz) = rates_hz.iter().find(|hz| (*hz - first_hz).abs() > 0.0) {
        return Err(SyntheticError::OneRate { first_hz, other_hz });
    }
    table(recording, places, first_hz).map_err(|error| ReportError::Csv(error).into())
}

fn table(
    recording: &SyntheticRecording,
    places: &[SyntheticPlace],
    rate_hz: f64,
) -> Result<Vec<u8>, csv::Error> {
    let channels = &recording.channels;
    let mut times: Vec<(&str, f64)> = vec![("time_s", 0.0)];
    for (channel, place) in channels.iter().zip(places) {
        if let Some(time) = place.time.as_deref().filter(|_| channel.start_s > 0.0) {
            times.push((time, channel.start_s));
        }
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = times.iter().map(|(name, _)| (*name).to_owned());
    let columns = channels.iter().zip(places).map(|(c, place)| format!("{} [{}]", place.name, c.unit));
    writer.write_record(header.chain(columns))?;
    let rows = channels.iter().map(|c| c.samples.len()).min().unwrap_or(0);
    for row in (0..rows).filter(|&row| channels.iter().any(|c| !c.samples[row].is_nan())) {
        for (_, start_s) in &times {
            #[allow(clippy::cast_precision_loss, reason = "counts stay below 2^52")]
            let time_s = start_s + row as f64 / rate_hz;
            writer.write_field(format!("{time_s:.9}"))?;
        }
        for channel in channels {
            let sample = channel.samples[row];
            writer.write_field(if sample.is_nan() { String::new() } else { sample.to_string() })?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}
