//! Samples in memory to the channels that a cask file names, on the same time base and in the same units as
//! those of a file.

use super::clock::Claims;
use super::error::{self, IngestError};
use super::refusal::Refusal;
use super::statement::Statement;
use super::time_base::{self, ChannelTimes};
use super::unchanged::hexadecimal;
use super::{RawChannel, RawRecording, assemble, cask_file};
use crate::data::{CaskFile, ChannelSpec, HeldSamples, Recording, RecordingFormat, Samples};
use sha2::{Digest, Sha256};
use std::path::Path;

/// What stands for the name of the file.
const NAME: &str = "samples in memory";

/// The channels that `cask_file` names from samples in memory, by each `source` or by each `name`.
///
/// # Errors
/// [`IngestError`] where a channel has no samples, or nothing says its rate or its unit.
pub fn read_arrays(held: &[HeldSamples], cask_file: &CaskFile) -> Result<Recording, IngestError> {
    let path = Path::new(NAME);
    let cask_file = &*cask_file.for_recorder(None);
    cask_file::require_channels(cask_file, path)?;
    let (stated_file, cask_file) = (cask_file, &*cask_file.with_all_channels());
    let mut channels = Vec::with_capacity(cask_file.channels.len());
    for (stated, held) in cask_file.channels.iter().zip(chosen(held, cask_file)?) {
        let refused = |refusal| error::of_channel(path, &stated.name, refusal);
        if let Some(rows) = &stated.rows {
            let problem = format!("{rows} picks rows of a file, and these are samples in memory");
            let mend = "take `where` out, and hand over the samples of this sensor alone";
            return Err(refused(Refusal::new(problem, mend)));
        }
        let said = |rate_hz| Statement::by(format!("rate_hz = {rate_hz}"), rate_hz, 0.0);
        let claims = Claims {
            cask_hz: stated.sample_rate_hz,
            are_times_named: false,
            stated: held.sample_rate_hz.map(said).into_iter().collect(),
        };
        let samples = Samples::F64(held.values.clone());
        let uniform = match &held.times_s {
            Some(times_s) => ChannelTimes::new(times_s).place(samples, &claims),
            None if claims.is_empty() => return Err(refused(no_rate(held))),
            None => time_base::from_claims(held.start_s, &claims, samples),
        };
        let uniform = uniform.map_err(refused)?;
        channels.push(RawChannel { uniform, unit: held.unit.clone(), factors: Vec::new() });
    }
    let raw = RawRecording { channels, zero_unix_ns: None, issues: Vec::new() };
    assemble::recording(path, RecordingFormat::Samples, sha256(held), raw, stated_file)
}

fn no_rate(held: &HeldSamples) -> Refusal {
    Refusal::new(
        format!("nothing says when the samples of {:?} were taken", held.name),
        "give them a rate_hz, or times_s, or this channel of the cask file a sample_rate_hz",
    )
}

/// The samples of each channel: all by their `source`, else all by their `name`, for a mixture could take one
/// sensor for another.
fn chosen<'a>(held: &'a [HeldSamples], cask_file: &CaskFile) -> Result<Vec<&'a HeldSamples>, IngestError> {
    let bare = |name: &str| name.trim_start_matches('/').to_owned();
    let by = |key: &str| held.iter().find(|held| bare(&held.name) == bare(key));
    let channels = &cask_file.channels;
    let by_source: Option<Vec<_>> = channels.iter().map(|spec| by(&spec.source.to_string())).collect();
    let by_name = || channels.iter().map(|spec| by(&spec.name)).collect();
    by_source.or_else(by_name).ok_or_else(|| {
        let lacks_source = |spec: &&ChannelSpec| by(&spec.source.to_string()).is_none();
        let missing = channels.iter().filter(lacks_source);
        let spec = missing.clone().find(|spec| by(&spec.name).is_none()).or(missing.clone().next());
        let spec = spec.unwrap_or(&channels[0]);
        let there: Vec<String> = held.iter().map(|held| format!("{:?}", held.name)).collect();
        let there = if there.is_empty() { "none".to_owned() } else { there.join(", ") };
        let refusal = Refusal::new(
            format!(
                "there are no samples {:?}, which is its source, nor are all channels there by name",
                spec.source.to_string()
            ),
            format!(
                "there is: {there}; name the samples of every channel by its `source`, or of every one by \
                 its `name`"
            ),
        );
        error::of_channel(Path::new(NAME), &spec.name, refusal)
    })
}

/// SHA-256 of all samples with what is said of them, lower-case hexadecimal.
fn sha256(held: &[HeldSamples]) -> String {
    let mut hasher = Sha256::new();
    for HeldSamples { name, values, sample_rate_hz, unit, times_s, start_s } in held {
        let times_s = times_s.as_deref().unwrap_or_default();
        hasher.update(format!(
            "{name:?} {sample_rate_hz:?} {unit:?} {start_s} {} {}",
            values.len(),
            times_s.len()
        ));
        values.iter().chain(times_s).for_each(|value| hasher.update(value.to_le_bytes()));
    }
    hexadecimal(&hasher.finalize())
}
