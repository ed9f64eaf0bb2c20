//! Plans a campaign from a manifest, or from paths and a cask file: one entry per recording, in the order of
//! the campaign.

use super::super::lines;
use super::manifest;
use super::paths::{recordings, stem};
use super::planned::{PlannedTest, find_cask_file};
use crate::ingest::{bytes_of, hexadecimal};
use crate::report::folder_name;
use miette::miette;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Schema of a shard, in every line as `campaign.schema`.
pub const SHARD_SCHEMA: &str = "dropcheck.batch-shard/1";

/// Files of the campaign's folder, whose names no report's folder may have.
pub const SUMMARY: [&str; 4] = ["campaign.json", "campaign.csv", "campaign.html", "results.jsonl"];

/// The whole campaign; a run may do a part of it.
#[derive(Debug)]
pub struct CampaignPlan {
    /// The manifest or the cask file.
    pub source: String,
    pub tests: Vec<PlannedTest>,
    /// Hash of everything that determines the work: shards of one campaign have the same.
    hash: String,
    /// Part of this run: index and number of shards.
    pub shard: (usize, usize),
}

impl CampaignPlan {
    /// Plans a manifest or paths, with the cask file of recordings that have none, and the disabled
    /// corrections.
    pub fn new(
        paths: &[PathBuf],
        manifest: Option<&Path>,
        cask: Option<&Path>,
        without: &[String],
    ) -> miette::Result<Self> {
        let shown = |path: &Path| path.display().to_string();
        let (mut tests, source) = if let Some(path) = manifest {
            // Other machines may have it in another folder.
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            (manifest::read(path, cask)?, name)
        } else {
            let source = cask.map_or_else(|| "cask files beside the recordings".to_owned(), shown);
            (plan_paths(paths, cask)?, source)
        };
        assign_unique_names(&mut tests);
        let mut hash = Sha256::new();
        hash.update(cask.and_then(|cask| bytes_of(cask, 16).ok()).unwrap_or_default());
        hash.update(without.join(","));
        for test in &tests {
            hash.update(json!([test.id, test.shown, test.cask_shown, test.stated, test.carried]).to_string());
        }
        Ok(Self { source, tests, hash: hexadecimal(&hash.finalize()), shard: (0, 1) })
    }

    /// Lists the numbers of the tests in this run.
    pub fn numbers(&self) -> Vec<usize> {
        (self.shard.0..self.tests.len()).step_by(self.shard.1).collect()
    }

    /// True if this run does the whole campaign.
    pub fn is_whole(&self) -> bool {
        self.shard.1 == 1
    }

    /// File name of the record in `--out`.
    pub fn record_name(&self) -> String {
        if self.is_whole() {
            SUMMARY[3].to_owned()
        } else {
            format!("results-{}-of-{}.jsonl", self.shard.0, self.shard.1)
        }
    }

    /// Returns a line's place in the campaign as JSON.
    pub fn place(&self, number: usize) -> String {
        let test = &self.tests[number];
        let object = |pairs: &[(String, String)]| pairs.iter().cloned().collect::<BTreeMap<String, String>>();
        let place = json!({
            "of": self.hash, "source": self.source, "number": number, "count": self.tests.len(),
            "shard": [self.shard.0, self.shard.1],
            "recording": test.shown, "cask": test.cask_shown, "report": test.folder,
            "stated": object(&test.stated), "carried": object(&test.carried),
        });
        lines::place_json(SHARD_SCHEMA, place)
    }

    /// Refuses an output folder in which a report would overwrite a recording.
    pub fn refuse_overwriting(&self, out: &Path) -> miette::Result<()> {
        let real = |path: &Path| std::fs::canonicalize(path).ok();
        let folders: HashSet<PathBuf> =
            self.tests.iter().filter_map(|test| real(&out.join(&test.folder))).collect();
        let inputs = self.tests.iter().flat_map(|test| [Some(&test.recording), test.cask.as_ref()]).flatten();
        let is_within = |input: &&PathBuf| {
            // A recording may itself be a folder.
            real(input).is_some_and(|input| input.ancestors().take(2).any(|place| folders.contains(place)))
        };
        let mend = "choose another --out: no command alters its input";
        inputs.filter(|_| !folders.is_empty()).find(is_within).map_or(Ok(()), |input| {
            Err(miette!(help = mend, "{} lies where a report of this campaign would go", input.display()))
        })
    }
}

fn plan_paths(paths: &[PathBuf], cask: Option<&Path>) -> miette::Result<Vec<PlannedTest>> {
    let test = |recording: PathBuf| {
        let cask = find_cask_file(&recording, cask);
        PlannedTest {
            id: stem(&recording),
            shown: recording.display().to_string(),
            cask_shown: cask.as_ref().map(|cask| cask.display().to_string()),
            cask,
            recording,
            ..PlannedTest::default()
        }
    };
    Ok(recordings(paths)?.into_iter().map(test).collect())
}

/// Appends numbers to equal names, and gives each test a safe folder name.
fn assign_unique_names(tests: &mut [PlannedTest]) {
    let mut ids: HashSet<String> = HashSet::new();
    let mut folders: HashSet<String> = SUMMARY.iter().map(|name| (*name).to_owned()).collect();
    let [mut id_counts, mut folder_counts] = [HashMap::new(), HashMap::new()];
    for test in tests {
        test.id = unused_name(&test.id, &ids, &mut id_counts);
        ids.insert(test.id.clone());
        // On a file system that ignores case two folders would be one.
        test.folder = unused_name(&folder_name(&test.id), &folders, &mut folder_counts);
        folders.insert(test.folder.to_lowercase());
    }
}

/// Returns the name, or the name with the first number that makes it unused; `counts` holds the last number
/// of each name.
fn unused_name(name: &str, used: &HashSet<String>, counts: &mut HashMap<String, u64>) -> String {
    let count = counts.entry(name.to_owned()).or_default();
    loop {
        *count += 1;
        let numbered = if *count == 1 { name.to_owned() } else { format!("{name}-{count}") };
        if !used.contains(&numbered) && !used.contains(&numbered.to_lowercase()) {
            return numbered;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folders(ids: &[&str]) -> Vec<String> {
        let mut tests: Vec<PlannedTest> =
            ids.iter().map(|id| PlannedTest { id: (*id).into(), ..PlannedTest::default() }).collect();
        assign_unique_names(&mut tests);
        tests.into_iter().map(|test| test.folder).collect()
    }

    #[test]
    fn equal_names_get_folders_of_their_own() {
        assert_eq!(folders(&["t1", "t1", "T1", "t2"]), ["t1", "t1-2", "T1-3", "t2"]);
    }

    #[test]
    fn a_hundred_thousand_equal_names_are_numbered_at_once() {
        let names = vec!["drop"; 100_000];
        assert_eq!(folders(&names).last().map(String::as_str), Some("drop-100000"));
        assert_eq!(folders(&["a", "a-2", "a", "a", "a-2"]), ["a", "a-2", "a-3", "a-4", "a-2-2"]);
    }

    #[test]
    fn a_name_leads_nowhere_else() {
        let found = folders(&["..", "...", "campaign.json", "a/../b", "SD/1:2", "nul.a", "com1", "com10"]);
        let spared =
            ["recording", "recording-2", "campaign.json-2", "a_.._b", "SD_1_2", "_nul.a", "_com1", "com10"];
        assert_eq!(found, spared);
    }
}
