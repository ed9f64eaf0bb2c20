//! The sources of a listing to their samples, as many at a time as the memory allows.

use super::{IngestError, Limits, Progress, ReadRequest, RecordingFile, assemble, detect, foreign, read_raw};
use crate::data::{
    Cask, CaskFile, Channel, ChannelSpec, Contact, Drop, End, ListedChannel, Listing, Unit,
    acceleration_unit_m_s2,
};
use crate::numerics::as_f64;

/// A sample takes so much while it is read: twice its value, and its time.
const SAMPLE_BYTES: u64 = 24;

/// Hands over these sources of a recording one after the other, by their places among them; or
/// why one cannot be read.
///
/// For want of a statement each is a transverse channel of the first end, in the recording's own unit, empty
/// where it states none; the scale is no number where that is none of acceleration.
pub fn read_listed<'a>(
    recording: impl Into<RecordingFile<'a>>,
    listed: &[&ListedChannel],
    limits: Limits,
    progress: Progress,
    mut take: impl FnMut(usize, Result<Channel, IngestError>),
) {
    // What cannot be converted is refused as what it is.
    let recording = recording.into();
    let converted = foreign::converted(recording).ok().flatten();
    let recording = converted.as_ref().map_or(recording, |converted| (&converted.file).into());
    let all = limits.samples_bytes() / SAMPLE_BYTES;
    let mut from = 0;
    while from < listed.len() {
        let mut left = all;
        let fits = |listed: &&&ListedChannel| {
            let rest = left.checked_sub(listed.samples.unwrap_or(all));
            left = rest.unwrap_or_default();
            rest.is_some()
        };
        // What does not fit alone is refused by its reader.
        let count = listed[from..].iter().take_while(fits).count().max(1);
        let group = &listed[from..from + count];
        match read_together(recording, group, limits) {
            Ok(read) => (from..).zip(read).for_each(|(place, read)| take(place, Ok(read))),
            Err(_) => (from..).zip(group).for_each(|(place, one)| {
                let read = read_together(recording, &[*one], limits);
                take(place, read.map(|mut read| read.remove(0)));
            }),
        }
        from += count;
        progress(as_f64(from) / as_f64(listed.len()));
    }
}

/// Times from the earliest first sample on.
pub(super) fn count_from_first(Listing { channels, issues, .. }: &mut Listing) {
    let first_s = channels.iter().filter_map(|channel| channel.start_s).fold(f64::INFINITY, f64::min);
    let starts = channels.iter_mut().filter_map(|channel| channel.start_s.as_mut());
    let places = issues.iter_mut().flat_map(|issue| [&mut issue.from_s, &mut issue.to_s]).flatten();
    starts.chain(places).for_each(|time_s| *time_s -= first_s);
}

fn read_together(
    recording: RecordingFile,
    group: &[&ListedChannel],
    limits: Limits,
) -> Result<Vec<Channel>, IngestError> {
    let m_s2 = |listed: &ListedChannel| listed.unit.as_deref().and_then(acceleration_unit_m_s2);
    let spec = |listed: &&ListedChannel| ChannelSpec {
        source: listed.origin(),
        rows: listed.rows.clone(),
        // Any unit has a reader take what is in none of acceleration; its scale is taken back below.
        unit: m_s2(listed).is_none().then_some(Unit::MetrePerSecondSquared),
        ..ChannelSpec::new(&listed.source, End::First, "", 0.0)
    };
    // Readers take of it nothing but the channels.
    let (cask, drop) = (Cask::block("", 1.0, 1.0, 0.0), Drop::from_height(1.0, 0.0));
    let channels = group.iter().map(spec).collect();
    let file = CaskFile { channels, ..CaskFile::new(cask, drop, Contact::Unknown) };
    let format = detect::format(recording)?;
    let raw = read_raw(ReadRequest { file: recording, limits, progress: &|_| () }, format, &file)?;
    let read = assemble::recording(recording.path, format, String::new(), raw, &file)?;
    let read = group.iter().zip(read.channels).map(|(listed, channel)| Channel {
        unit: listed.unit.clone().unwrap_or_default(),
        scale_m_s2: m_s2(listed).unwrap_or(f64::NAN),
        start_s: listed.start_s.unwrap_or(channel.start_s),
        ..channel
    });
    Ok(read.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ingest::list;
    use std::path::Path;

    fn read(path: &Path, listing: &Listing) -> Vec<Result<Channel, String>> {
        let listed: Vec<&ListedChannel> = listing.channels.iter().collect();
        let mut found = Vec::new();
        let take = |number, read: Result<_, IngestError>| {
            assert_eq!(number, found.len());
            found.push(read.map_err(|refused| refused.to_string()));
        };
        read_listed(path, &listed, Limits::default(), &|_| (), take);
        found
    }

    #[test]
    fn what_does_not_fit_together_is_read_in_turn_and_a_refusal_leaves_the_others() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/examples/anf10-protobuf.mcap");
        let mut listing = list(&path, &|_| ()).unwrap();
        let together = read(&path, &listing);
        assert!(together.iter().all(|read| read.as_ref().is_ok_and(|read| read.unit == "g")));
        listing.channels.insert(1, ListedChannel::new("/daq/none.samples", "array"));
        let beside_a_refusal = read(&path, &listing);
        listing.channels.iter_mut().for_each(|listed| listed.samples = Some(1 << 40));
        for apart in [beside_a_refusal, read(&path, &listing)] {
            assert!(apart[0] == together[0] && apart[2] == together[1]);
            assert!(apart[1].as_ref().is_err_and(|refused| refused.contains("/daq/none")));
        }
    }
}
