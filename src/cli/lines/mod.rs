//! Lines of JSON, one per recording or scene, and the shards of a campaign that hold them: makes, counts,
//! stores and prints each line once.

mod file;
mod shards;

pub use file::{LineFiles, LineRecord};
pub use shards::{
    check_shard, line_number, merge_shards, parse_shard, place_json, read_schema, refuse_other_file,
};

use super::output::print_bytes;
use super::progress::CountedProgress;
use crate::ordered_parallel;
use std::path::Path;

/// Targets of the lines of a run.
pub struct LineOutput {
    /// File for the lines.
    pub record: Option<LineRecord>,
    /// True if standard output is reserved for the lines.
    pub is_standard_output: bool,
}

impl LineOutput {
    /// Uses a file, and standard output if `--jsonl` is "-".
    pub fn new(record: Option<LineRecord>, jsonl: Option<&Path>) -> Self {
        Self { record, is_standard_output: jsonl == Some(Path::new("-")) }
    }

    /// Makes the lines of these numbers on `jobs` threads and hands each over in order once it is written.
    /// `make` gets the line that an earlier run left in the file, and returns `None` to keep it.
    pub fn write_lines(
        &mut self,
        numbers: Vec<usize>,
        jobs: usize,
        make: impl Fn(usize, Option<&str>) -> miette::Result<Option<String>> + Sync,
        mut take: impl FnMut(&str) -> miette::Result<()>,
    ) -> miette::Result<()> {
        let mut progress = CountedProgress::new(numbers.len(), self.record.is_some());
        // A thread of its own reads the earlier lines, since the file grows meanwhile.
        let earlier = self.record.as_ref().map(|record| record.lines.clone()).unwrap_or_default();
        let make = |number| {
            let earlier = earlier.text(number);
            make(number, earlier.as_deref()).map(|made| (made, earlier))
        };
        ordered_parallel::each(numbers.into_iter(), jobs, make, |number, line| {
            let (made, earlier) = line?;
            if let Some((record, line)) = self.record.as_mut().zip(made.as_ref()) {
                record.append(number, line.as_bytes())?;
            }
            let line = made.or(earlier).unwrap_or_default();
            if self.is_standard_output {
                print_bytes(line.as_bytes())?;
            }
            progress.step();
            take(&line)
        })?;
        self.record.as_mut().map_or(Ok(()), LineRecord::finish)
    }
}
