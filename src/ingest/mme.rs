//! A folder or zip in ISO-MME (ISO/TS 13499) to the channels that a cask file names, and to the list of all.

mod channel;
mod code;
mod files;
mod header;
mod index;
mod zip;

pub(super) use files::MmeFiles;

use super::error::{self, IngestError};
use super::refusal::Refusal;
use super::{RawChannel, RawRecording, ReadRequest, RecordingFile};
use crate::data::{
    CaskFile, ClockFinding, Finding, ListedChannel, Listing, RecordingFormat, acceleration_unit_m_s2,
};
use channel::ChannelFile;
use index::IndexedChannel;
use std::collections::BTreeMap;

/// The channels of `cask_file` from a folder or zip; no other channel is opened.
///
/// # Errors
/// A file is not there or damaged, or contradicts itself, its index or its code.
pub(super) fn read(request: ReadRequest, cask_file: &CaskFile) -> Result<RawRecording, IngestError> {
    let ReadRequest { file, limits, .. } = request;
    let (path, files) = (file.path, files(file)?);
    files.bytes(limits)?;
    let listed = index::channels(&files, limits)?;
    let (mut channels, mut starts, mut held_bytes) = (Vec::new(), Vec::new(), 0);
    for stated in &cask_file.channels {
        let channel = index::wanted(path, stated, cask_file.time.as_ref(), &listed)?;
        let mut read = ChannelFile::of(&files, channel, limits)?;
        held_bytes += 8 * read.values.len() as u64;
        limits.hold(path, "the samples of the channels read take", held_bytes, limits.samples_bytes())?;
        let unit = read.unit().map(|line| line.value.clone());
        let is_acceleration = unit.as_deref().and_then(acceleration_unit_m_s2).is_some();
        let other =
            code::quantity(&channel.code).filter(|quantity| !["acceleration", "00"].contains(quantity));
        if let Some(other) = other.filter(|_| is_acceleration && stated.unit.is_none()) {
            let problem =
                format!("{}: its unit is one of acceleration, and its code says {other}", channel.source);
            let mend = "check which is right; if it is the unit, write it into this channel of the cask file";
            return Err(error::of_channel(path, &stated.name, Refusal::new(problem, mend)));
        }
        starts.push(read.start_s.is_some());
        let uniform = read.placed(stated.sample_rate_hz);
        let uniform = uniform.map_err(|refusal| error::of_channel(path, &stated.name, refusal))?;
        channels.push(RawChannel { uniform, unit, factors: Vec::new() });
    }
    if let Some(spec) = starts.iter().position(|is_stated| !is_stated).filter(|_| starts.contains(&true)) {
        let problem = "its file has no line Time of first sample, and those of other channels have";
        let mend = "write the line into a copy of its file, in s: Time of first sample :-0.1";
        return Err(error::of_channel(path, &cask_file.channels[spec].name, Refusal::new(problem, mend)));
    }
    Ok(RawRecording { channels, zero_unix_ns: None, issues: Vec::new() })
}

/// The files of a test.
fn files(file: RecordingFile) -> Result<MmeFiles, IngestError> {
    MmeFiles::of(file)?.ok_or_else(|| error::directory(file.path))
}

/// Lists the channels of a folder or zip.
///
/// # Errors
/// There is no index, or it cannot be read.
pub(super) fn list(request: ReadRequest) -> Result<Listing, IngestError> {
    let ReadRequest { file, limits, .. } = request;
    let (path, files) = (file.path, files(file)?);
    let (bytes, listed) = (files.bytes(limits)?, index::channels(&files, limits)?);
    let (mut channels, mut issues) = (Vec::new(), Vec::new());
    for channel in &listed {
        let named = ListedChannel::new(&channel.source, "channel");
        channels.push(match ChannelFile::of(&files, channel, limits) {
            Ok(read) => one_listed(named, channel, read, &mut issues),
            Err(IngestError::Refused { refusal, .. }) => {
                ListedChannel { unreadable: Some(refusal.beside(&channel.source)), ..named }
            }
            Err(error) => return Err(error),
        });
    }
    Ok(Listing {
        counts: BTreeMap::from([("channels".into(), channels.len() as u64)]),
        channels,
        issues,
        ..Listing::new(path, bytes, RecordingFormat::Mme)
    })
}

/// A channel as it is listed; what reading would say of it goes to `issues`.
fn one_listed(
    named: ListedChannel,
    channel: &IndexedChannel,
    mut read: ChannelFile,
    issues: &mut Vec<Finding>,
) -> ListedChannel {
    let said =
        [Some(read.text.encoding.to_owned()), code::meaning(&channel.code), Some(channel.words.clone())];
    let said: Vec<String> = said.into_iter().flatten().filter(|words| !words.is_empty()).collect();
    let mut listed = ListedChannel {
        samples: Some(read.values.len() as u64),
        unit: read.unit().map(|line| line.value.clone()),
        range: ListedChannel::value_range(read.values.iter().copied()),
        encoding: said.join("; "),
        ..named
    };
    let found = match read.placed(None) {
        Ok(uniform) => {
            uniform.list(&mut listed);
            uniform.issues
        }
        Err(refusal) => vec![ClockFinding::Refused(refusal.beside(&channel.source)).into()],
    };
    issues.extend(found.into_iter().map(|issue| issue.tag(&channel.source)));
    ListedChannel { start_s: read.start_s, ..listed }
}

#[cfg(test)]
mod tests;
