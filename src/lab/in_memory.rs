//! Channels of a synthetic recording as a reader of its file would give them, without the file.

use crate::data::{CaskFile, Recording, RecordingFormat, Samples};
use crate::ingest::time_base::{self, Block};
use crate::ingest::{IngestError, RawChannel, RawRecording, assemble, error};
use crate::lab::data::SyntheticRecording;
use std::path::Path;

/// Replaces the name of the file.
const NAME: &str = "synthetic";

/// The channels of `recording`, in the order of the cask file's, as from its MCAP file: runs of NaN were
/// never written.
///
/// # Errors
///
/// Returned for a channel without a number, as for a file.
pub fn synthetic(recording: &SyntheticRecording, cask_file: &CaskFile) -> Result<Recording, IngestError> {
    let path = Path::new(NAME);
    let mut channels = Vec::with_capacity(recording.channels.len());
    let recording = recording.to_mounted(cask_file);
    for channel in recording.channels.iter().take(cask_file.channels.len() + cask_file.others.len()) {
        let block = |(from, run): (usize, &[f32])| Block { start_s: channel.time_s(from), count: run.len() };
        let blocks: Vec<Block> = channel.runs().map(block).collect();
        let samples = channel.samples.iter().copied().filter(|x| !x.is_nan()).collect();
        let uniform = time_base::from_blocks(&blocks, channel.sample_rate_hz, Samples::F32(samples));
        let uniform = uniform.map_err(|refusal| error::of_channel(path, &channel.name, refusal))?;
        channels.push(RawChannel { uniform, unit: Some(channel.unit.clone()), factors: Vec::new() });
    }
    let raw = RawRecording { channels, zero_unix_ns: None, issues: Vec::new() };
    assemble::recording(path, RecordingFormat::Mcap, String::new(), raw, cask_file)
}
