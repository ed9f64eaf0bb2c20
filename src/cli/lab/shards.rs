//! Lines of scenes to a file that grows, and such files to the rows in them; a shard that is missing, doubled, cut or foreign is named.

use super::super::output::JsonTarget;
use super::super::shard;
use dropcheck::lab::campaign::{self, ScenePlace};
use dropcheck::lab::data::{CampaignRequest, CampaignRow, CampaignShard};
use miette::{IntoDiagnostic, WrapErr};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file of lines in the order of their scenes that this run writes.
pub struct SceneLines {
    path: PathBuf,
    file: File,
}

impl SceneLines {
    /// Begins the file, or with `resume` goes on with the lines that are there.
    pub fn open(path: &Path, resume: bool) -> miette::Result<Self> {
        if !shard::is_own(path) {
            JsonTarget::checked(Some(path), &[])?;
        }
        let words = || format!("{} cannot be written", path.display());
        let file = OpenOptions::new().read(true).append(true).create(true).open(path);
        let file = file.into_diagnostic().wrap_err_with(words)?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(miette::miette!(
                help = "wait for it, or end it",
                "another run is writing {}",
                path.display()
            ));
        }
        if !resume {
            file.set_len(0).into_diagnostic().wrap_err_with(words)?;
        }
        Ok(Self { path: path.to_path_buf(), file })
    }

    /// Hands over the rows that are there, which begin at `place`, and says how many; a torn end is cut off.
    pub fn take_over(
        &mut self,
        place: &ScenePlace,
        mut take: impl FnMut(&CampaignRow) -> miette::Result<()>,
    ) -> miette::Result<usize> {
        let mut lines = LineReader::open(&self.path)?;
        let mut done = 0;
        let mut end = 0;
        while let Some(line) = lines.next()? {
            if !line.ends_with(b"\n") {
                break;
            }
            let due = place.at(place.number + done * place.shard[1]);
            match campaign::read(line) {
                Some((own, row)) if own == due => take(&row)?,
                own => {
                    let words = own.and_then(|(own, _)| own.differs(&due)).unwrap_or("is out of its order");
                    return Err(miette::miette!(
                        help = "repeat the words of the run that is to go on, or write to another file",
                        "{}, line {}, {words}",
                        self.path.display(),
                        lines.count
                    ));
                }
            }
            done += 1;
            end += line.len() as u64;
        }
        let cut = self.file.set_len(end).and_then(|()| self.file.seek(SeekFrom::End(0)));
        cut.into_diagnostic().wrap_err_with(|| format!("{} cannot be written", self.path.display()))?;
        Ok(done)
    }

    /// Writes one line at its end.
    pub fn put(&mut self, line: &[u8]) -> miette::Result<()> {
        let written = self.file.write_all(line).into_diagnostic();
        written.wrap_err_with(|| format!("{} could not be written", self.path.display()))
    }
}

/// A file, line by line.
struct LineReader {
    path: PathBuf,
    reader: BufReader<File>,
    line: Vec<u8>,
    /// Lines that were read.
    count: usize,
}

impl LineReader {
    fn open(path: &Path) -> miette::Result<Self> {
        let file = File::open(path).into_diagnostic();
        let file = file.wrap_err_with(|| format!("{} cannot be read", path.display()))?;
        Ok(Self { path: path.to_path_buf(), reader: BufReader::new(file), line: Vec::new(), count: 0 })
    }

    fn next(&mut self) -> miette::Result<Option<&[u8]>> {
        self.line.clear();
        let read = self.reader.read_until(b'\n', &mut self.line).into_diagnostic();
        let length = read.wrap_err_with(|| format!("{} cannot be read", self.path.display()))?;
        self.count += 1;
        Ok((length > 0).then_some(&self.line[..]))
    }
}

/// The shards of one campaign.
pub struct Shards {
    first: ScenePlace,
    files: BTreeMap<usize, LineReader>,
}

impl Shards {
    /// By the first line of each; several of one campaign, all of its shards and each once.
    pub fn open(paths: &[PathBuf]) -> miette::Result<Self> {
        let mut shards: Option<Self> = None;
        for path in paths {
            let mut lines = LineReader::open(path)?;
            let line = lines.next()?.ok_or_else(|| shard::no_shard(path))?;
            let Some((own, _)) = campaign::read(line) else {
                return Err(if shard::is_own(path) { cut(path, 1) } else { shard::no_shard(path) });
            };
            let this = ScenePlace::first(&own.of, CampaignShard { index: own.shard[0], count: own.shard[1] });
            let all = shards.get_or_insert_with(|| Self { first: this.at(0), files: BTreeMap::new() });
            if let Some(words) = own.differs(&all.first) {
                return Err(miette::miette!(
                    help = "merge shards of one campaign, with the program that wrote them",
                    "{} {words}{}",
                    path.display(),
                    all.files
                        .values()
                        .next()
                        .map_or(String::new(), |other| { format!(", beside {}", other.path.display()) })
                ));
            }
            if let Some(other) = all.files.insert(own.shard[0], LineReader::open(path)?) {
                return Err(miette::miette!(
                    help = "name each shard once",
                    "{} is shard {}/{} once more, which {} is already",
                    path.display(),
                    own.shard[0],
                    own.shard[1],
                    other.path.display()
                ));
            }
        }
        let shards = shards.ok_or_else(|| miette::miette!("no shard is named"))?;
        let parts = shards.first.shard[1];
        match (0..parts.min(shards.first.count)).find(|i| !shards.files.contains_key(i)) {
            None => Ok(shards),
            Some(missing) => Err(miette::miette!(
                help = "run it, and name all shards",
                "shard {missing}/{parts} is missing: none of the files named holds it"
            )),
        }
    }

    /// What was asked for.
    pub fn request(&self) -> &CampaignRequest {
        &self.first.of
    }

    /// Hands over every row, in the order of one run.
    pub fn each(mut self, take: &mut dyn FnMut(&CampaignRow) -> miette::Result<()>) -> miette::Result<()> {
        let parts = self.first.shard[1];
        for number in 0..self.first.count {
            let due = self.first.at(number);
            let Some(file) = self.files.get_mut(&(number % parts)) else { continue };
            let read = file.next()?.map(campaign::read);
            match read.flatten() {
                Some((own, row)) if own == due => take(&row)?,
                Some((own, _)) => {
                    let words = own
                        .differs(&due)
                        .unwrap_or("stands where another scene is due: lines are doubled or missing");
                    return Err(miette::miette!(
                        help = "run that shard again",
                        "{}, line {}, {words}",
                        file.path.display(),
                        file.count
                    ));
                }
                None => return Err(cut(&file.path, file.count)),
            }
        }
        for file in self.files.values_mut() {
            if file.next()?.is_some() {
                return Err(miette::miette!(
                    help = "run that shard again",
                    "{}, line {}, is one too many: its shard ends before",
                    file.path.display(),
                    file.count
                ));
            }
        }
        Ok(())
    }
}

fn cut(path: &Path, line: usize) -> miette::Report {
    miette::miette!(
        help = "the run was stopped, or the file was not copied whole: run that shard again with --resume",
        "{} is cut: there is no whole line {line}",
        path.display()
    )
}
