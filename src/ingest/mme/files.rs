//! A folder or a zip to the files of a test in ISO-MME: `T1.mme`, `Channel/T1.chn`, `Channel/T1.001` ….

use super::zip::{self, ZipEntry};
use crate::ingest::error::{self, IngestError};
use crate::ingest::lines::Text;
use crate::ingest::refusal::Refusal;
use crate::ingest::shown::os_text;
use crate::ingest::{Limits, RecordingFile, opened};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Read};
use std::path::Path;

/// The folder of the index and of the channels, in any case.
const CHANNELS: &str = "channel";

/// The files of a test by their names, from the folder on that is the recording, or in the zip.
pub(in crate::ingest) struct MmeFiles<'a> {
    pub(super) recording: RecordingFile<'a>,
    header: String,
    /// The list of the channels.
    pub(super) index: Option<String>,
    /// The channels by their numbers.
    pub(super) channels: BTreeMap<u32, String>,
    zipped: BTreeMap<String, ZipEntry>,
}

impl<'a> MmeFiles<'a> {
    /// The files of the test in a folder or zip; `None` where it holds no header, `*.mme`.
    ///
    /// # Errors
    /// It holds several tests, or two channels of one number; the operating system refuses.
    pub(in crate::ingest) fn of(recording: RecordingFile<'a>) -> Result<Option<Self>, IngestError> {
        let path = recording.path;
        let io = |source| error::io(path, &source);
        let is_folder = recording.is_folder();
        let zipped = if is_folder { Vec::new() } else { zip::entries(recording).map_err(io)? };
        // A zip may hold one name twice.
        let in_zip = zipped.iter().map(|(name, _)| name.clone());
        let names = if is_folder { in_folder(path).map_err(io)? } else { in_zip.collect() };
        let zipped: BTreeMap<String, ZipEntry> = zipped.into_iter().collect();
        // Those of "._" are a Mac's remarks on files.
        let is_header = |name: &&String| {
            name.to_ascii_lowercase().ends_with(".mme") && !name.starts_with("._") && !name.contains("/._")
        };
        let headers: Vec<&String> = names.iter().filter(is_header).collect();
        let several = |one: &str, other: &str, mend| {
            let refusal = Refusal::new(format!("it holds {one} and {other}"), mend);
            Err(error::of_file(path, refusal.at("its files")))
        };
        let header = match headers[..] {
            [] => return Ok(None),
            [header] => header.clone(),
            [one, other, ..] => return several(one, other, "name the folder of one test, or zip it alone"),
        };
        let stem = header.rfind('/').map_or(0, |slash| slash + 1);
        let stem = format!("{}{CHANNELS}/{}", &header[..stem], &header[stem..header.len() - "mme".len()]);
        let mut files = Self { recording, header, index: None, channels: BTreeMap::new(), zipped };
        for name in names {
            let lower = name.to_ascii_lowercase();
            let Some(ending) = lower.strip_prefix(&stem.to_ascii_lowercase()) else { continue };
            let number = ending.parse().ok().filter(|_| !ending.starts_with('+'));
            let other = match number {
                Some(number) => files.channels.insert(number, name.clone()),
                None if ending == "chn" => files.index.replace(name.clone()),
                None => None,
            };
            if let Some(other) = other {
                return several(&other, &name, "leave the right one of the two in a copy");
            }
        }
        Ok(Some(files))
    }

    /// The names of all: header, index, channels by number.
    pub(in crate::ingest) fn names(&self) -> impl Iterator<Item = &String> {
        [&self.header].into_iter().chain(&self.index).chain(self.channels.values())
    }

    /// What the files take, unpacked.
    ///
    /// # Errors
    /// They unpack to more than such a zip may.
    pub(super) fn bytes(&self, limits: Limits) -> Result<u64, IngestError> {
        let bytes = self.names().map(|name| self.bytes_of(name)).sum();
        let most_bytes = limits.unpacked_bytes(self.recording.length().unwrap_or_default());
        if !self.zipped.is_empty() {
            limits.hold(self.recording.path, "its channels unpack to", bytes, most_bytes)?;
        }
        Ok(bytes)
    }

    fn bytes_of(&self, name: &str) -> u64 {
        let on_disk = || fs::metadata(self.recording.path.join(name)).map_or(0, |file| file.len());
        self.zipped.get(name).map_or_else(on_disk, ZipEntry::bytes)
    }

    /// The text of a file.
    ///
    /// # Errors
    /// It is too large, damaged, or may not be read.
    pub(super) fn text(&self, name: &str, limits: Limits) -> Result<Text, IngestError> {
        // A line of two bytes becomes a sample of eight.
        let (place, bytes, most_bytes) =
            (self.recording.path.join(name), self.bytes_of(name), limits.part_bytes() / 4);
        limits.hold(self.recording.path, &format!("{name} takes"), bytes, most_bytes)?;
        let source: Box<dyn Read + Send> = match self.zipped.get(name) {
            None => Box::new(opened(&place).map_err(|source| error::io(&place, &source))?),
            Some(entry) => {
                let mend = "copy the zip again, or unpack it and name the folder";
                let damaged = |source| {
                    error::of_file(self.recording.path, Refusal::new(os_text(&source), mend).at(name))
                };
                Box::new(Cursor::new(entry.unpacked(self.recording).map_err(damaged)?))
            }
        };
        Text::read(&place, source, bytes, limits)
    }

    /// The refusal of a test that lacks a file.
    pub(super) fn without(&self, what: &str) -> IngestError {
        let problem = format!("beside {} there is no {what}", self.header);
        let refusal = Refusal::new(problem, "copy or export the test again, with all its files");
        error::of_file(self.recording.path, refusal.at("its files"))
    }
}

/// The names of the files in a folder and in its folder of channels; links are none.
fn in_folder(path: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(path)? {
        let (kind, name) = named(entry)?;
        if kind.is_dir() && name.eq_ignore_ascii_case(CHANNELS) {
            let channels = fs::read_dir(path.join(&name))?.map(named).collect::<io::Result<Vec<_>>>()?;
            let channels = channels.into_iter().filter(|(kind, _)| kind.is_file());
            names.extend(channels.map(|(_, channel)| format!("{name}/{channel}")));
        } else if kind.is_file() {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

fn named(entry: io::Result<fs::DirEntry>) -> io::Result<(fs::FileType, String)> {
    entry.and_then(|entry| Ok((entry.file_type()?, entry.file_name().to_string_lossy().into_owned())))
}
