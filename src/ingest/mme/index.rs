//! The index of a test in ISO-MME, `Channel/T1.chn`, to its channels with the name of each as a source.

use super::files::MmeFiles;
use super::header::HeadedText;
use crate::data::{ChannelSpec, Source};
use crate::ingest::Limits;
use crate::ingest::error::{self, IngestError};
use crate::ingest::refusal::Refusal;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// How the lines that name channels begin, before the number of the channel's file.
const NAME: &str = "name of channel";

/// A channel as the index lists it.
#[derive(Debug)]
pub(super) struct IndexedChannel {
    /// What a cask file calls it: its code, and its number behind a point where others have the same code.
    pub source: String,
    pub code: String,
    /// What stands behind the code.
    pub words: String,
    /// That of its file.
    pub number: u32,
}

/// The channels of a test, in their order.
///
/// # Errors
/// There is no index, it cannot be read, or it lists one file twice.
pub(super) fn channels(files: &MmeFiles, limits: Limits) -> Result<Vec<IndexedChannel>, IngestError> {
    let name = files.index.as_ref().ok_or_else(|| files.without("index, Channel/….chn"))?;
    let text = HeadedText::of(files, name, limits)?;
    let (mut channels, mut numbers, mut codes) = (Vec::new(), BTreeSet::new(), BTreeMap::new());
    for line in &text.header {
        let name = line.name.to_ascii_lowercase();
        let Some(number) = name.strip_prefix(NAME).and_then(|number| number.trim().parse().ok()) else {
            continue;
        };
        if !numbers.insert(number) {
            return Err(text.fault(line.number, format!("channel {number} is listed a second time")));
        }
        let code = line.value.split(|c: char| c == '/' || c.is_whitespace()).next().unwrap_or_default();
        let words = line.value[code.len()..].trim_start_matches(|c: char| c == '/' || c.is_whitespace());
        let (code, words) = (code.to_owned(), words.to_owned());
        *codes.entry(code.clone()).or_insert(0) += 1;
        channels.push(IndexedChannel { source: code.clone(), code, words, number });
    }
    for channel in channels.iter_mut().filter(|channel| codes[&channel.code] > 1) {
        channel.source = format!("{}.{:03}", channel.code, channel.number);
    }
    Ok(channels)
}

/// The one of `channels` that a cask file asks for.
///
/// # Errors
/// It is not listed; the cask file asks for what this format has not.
pub(super) fn wanted<'a>(
    path: &Path,
    spec: &ChannelSpec,
    time: Option<&String>,
    channels: &'a [IndexedChannel],
) -> Result<&'a IndexedChannel, IngestError> {
    let refused = |refusal| error::of_channel(path, &spec.name, refusal);
    let Source::Path(wanted) = &spec.source else {
        let problem = "its source is a topic with a field, and this recording is in ISO-MME";
        return Err(refused(Refusal::new(problem, "write the channel code: source = \"…\"")));
    };
    if spec.rows.is_some() || spec.time.as_ref().or(time).is_some() {
        let problem = "`where` or `time` is stated, and a channel in ISO-MME holds one sensor and no times";
        let mend = "take it out; Sampling interval of the file, or sample_rate_hz here, says when";
        return Err(refused(Refusal::new(problem, mend)));
    }
    channels.iter().find(|channel| channel.source == wanted.trim()).ok_or_else(|| {
        let names: Vec<String> = channels.iter().map(|channel| channel.source.clone()).collect();
        let near = error::near_names(path, wanted, "channel", &names);
        refused(Refusal::new(format!("the index lists no channel {wanted:?}"), near))
    })
}
