//! A synthetic recording to CSV: comma, point, one header with units; a lost sample is an empty cell, a lost
//! row is left out.

use super::place::SyntheticPlace;
use crate::lab::data::SyntheticRecording;
use crate::numerics::as_f64;
use crate::report::ReportError;
use crate::report::records::records;

/// The table of channels that have one rate.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub(super) fn bytes(
    recording: &SyntheticRecording,
    places: &[SyntheticPlace],
    rate_hz: f64,
) -> Result<Vec<u8>, ReportError> {
    let channels = &recording.channels;
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
    records(std::iter::once(header.chain(columns).collect::<Vec<String>>()).chain(rows))
}
