//! Lines of scenes to a file that grows, and such files to the rows in them; a shard that is missing, doubled, cut or foreign is named.

use super::super::shard;
use dropcheck::ingest::opened;
use dropcheck::lab::campaign::{self, ScenePlace};
use dropcheck::lab::data::{CampaignRequest, CampaignRow, CampaignShard};
use miette::{IntoDiagnostic, WrapErr};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

/// A file of lines in the order of their scenes that this run writes.
pub struct SceneLines {
    path: PathBuf,
    file: File,
}

impl SceneLines {
    /// Begins the file, or with `resume` goes on with the lines that are there.
    pub fn open(path: &Path, resume: bool) -> miette::Result<Self> {
        let file = shard::held(path, &[])?;
        if !resume {
            shard::keep(&file, path, 0)?;
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
        while let Some(row) = lines.row(&place.at(place.number + done * place.shard[1]))? {
            take(&row)?;
            done += 1;
        }
        shard::keep(&self.file, &self.path, lines.whole_bytes)?;
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
    /// Lines that were read, and how long the rows among them are.
    count: usize,
    whole_bytes: u64,
}

impl LineReader {
    fn open(path: &Path) -> miette::Result<Self> {
        let file = opened(path).into_diagnostic();
        let file = file.wrap_err_with(|| format!("{} cannot be read", path.display()))?;
        Ok(Self { path: path.to_path_buf(), reader: BufReader::new(file), count: 0, whole_bytes: 0 })
    }

    /// The next line, with its end; empty where there is none.
    fn next(&mut self) -> miette::Result<Vec<u8>> {
        let mut line = Vec::new();
        let read = shard::next_line(&mut self.reader, &mut line).into_diagnostic();
        read.wrap_err_with(|| format!("{} cannot be read", self.path.display()))?;
        self.count += 1;
        Ok(line)
    }

    /// The row of the next line, which has to be that of the scene that is `due`; `None` where the file ends or its last line is torn.
    fn row(&mut self, due: &ScenePlace) -> miette::Result<Option<CampaignRow>> {
        let line = self.next()?;
        if !line.ends_with(b"\n") {
            return Ok(None);
        }
        self.whole_bytes += line.len() as u64;
        match campaign::read(&line) {
            Some((own, row)) if own == *due => Ok(Some(row)),
            Some((own, _)) => Err(self.refused(own.differs(due).unwrap_or(DISORDER))),
            None => Err(self.refused("is no line of a campaign")),
        }
    }

    fn refused(&self, words: &str) -> miette::Report {
        let help = "run that shard again, by the same words and program as the others";
        miette::miette!(help = help, "{}, line {}, {words}", self.path.display(), self.count)
    }
}

const DISORDER: &str = "stands where another scene is due: lines are doubled or missing";

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
            let Some((own, _)) = campaign::read(&lines.next()?) else {
                let is_cut = shard::is_own(path) && lines.reader.fill_buf().is_ok_and(<[u8]>::is_empty);
                return Err(if is_cut { cut(path, 1) } else { shard::no_shard(path) });
            };
            let this = ScenePlace::first(&own.of, CampaignShard { index: own.shard[0], count: own.shard[1] });
            let all = shards.get_or_insert_with(|| Self { first: this.at(0), files: BTreeMap::new() });
            if let Some(words) = own.differs(&all.first) {
                return Err(lines.refused(words));
            }
            if let Some(other) = all.files.insert(own.shard[0], LineReader::open(path)?) {
                let words =
                    format!("is shard {}/{} once more: {}", own.shard[0], own.shard[1], other.path.display());
                return Err(lines.refused(&words));
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
            let row = file.row(&due)?.ok_or_else(|| cut(&file.path, file.count))?;
            take(&row)?;
        }
        for file in self.files.values_mut() {
            if !file.next()?.is_empty() {
                return Err(file.refused("is one too many: its shard ends before"));
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
