//! Lines of JSON, one a recording or scene, and the shards of a campaign that hold them: the numbers of a run
//! to their lines, each made once, counted, in a file, on standard output.

mod file;
mod shards;

pub use file::{LineFiles, LineRecord};
pub use shards::{holds_some, merged, no_shard, own_number, part, place, schema};

use super::output::print_plain;
use super::progress::CountedProgress;
use crate::ordered_parallel;
use std::path::Path;

/// Where the lines of a run go.
pub struct LineOutput {
    /// The file that holds them.
    pub record: Option<LineRecord>,
    /// Whether they go to standard output, and nothing else does.
    pub is_standard_output: bool,
}

impl LineOutput {
    /// A file, and where `--jsonl` is "-" standard output.
    pub fn new(record: Option<LineRecord>, jsonl: Option<&Path>) -> Self {
        Self { record, is_standard_output: jsonl == Some(Path::new("-")) }
    }

    /// Makes the lines of these numbers on so many threads, and hands each over in their order once it is
    /// written. `make` is given the line that the file has from an earlier run; none: that one stays.
    pub fn each(
        &mut self,
        own: Vec<usize>,
        jobs: usize,
        make: impl Fn(usize, Option<&str>) -> miette::Result<Option<String>> + Sync,
        mut take: impl FnMut(&str) -> miette::Result<()>,
    ) -> miette::Result<()> {
        let mut progress = CountedProgress::of(own.len(), self.record.is_some());
        // These are read by one thread beside the others, since the file grows meanwhile.
        let earlier = self.record.as_ref().map(|record| record.lines.clone()).unwrap_or_default();
        let make = |number| {
            let earlier = earlier.text(number);
            make(number, earlier.as_deref()).map(|made| (made, earlier))
        };
        ordered_parallel::each(own.into_iter(), jobs, make, |number, line| {
            let (made, earlier) = line?;
            if let Some((record, line)) = self.record.as_mut().zip(made.as_ref()) {
                record.put(number, line.as_bytes())?;
            }
            let line = made.or(earlier).unwrap_or_default();
            if self.is_standard_output {
                print_plain(line.as_bytes())?;
            }
            progress.step();
            take(&line)
        })?;
        self.record.as_mut().map_or(Ok(()), LineRecord::finish)
    }
}
