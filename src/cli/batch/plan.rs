//! A manifest, or paths and a cask file, to what is to be analysed: one entry a recording, in the order in
//! which the campaign has them.

use super::super::lines;
use super::manifest;
use super::paths::{recordings, stem};
use super::planned::{PlannedTest, cask_of};
use crate::ingest::{bytes_of, hexadecimal};
use crate::report::folder_name;
use miette::miette;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// What every line of a shard says it is: `campaign.schema`.
pub const SHARD_SCHEMA: &str = "dropcheck.batch-shard/1";

/// Files of the campaign's folder that no report's folder may be named like.
pub const SUMMARY: [&str; 4] = ["campaign.json", "campaign.csv", "campaign.html", "results.jsonl"];

/// The whole campaign, of which a run may do a part.
#[derive(Debug)]
pub struct CampaignPlan {
    /// The manifest or the cask file.
    pub source: String,
    pub tests: Vec<PlannedTest>,
    /// A hash of all that says what is to be done: shards of one campaign have the same.
    of: String,
    /// The part of this run: every so many-th from a first.
    pub shard: (usize, usize),
}

impl CampaignPlan {
    /// Of a manifest, or of paths, with the cask file of those that have none, and the corrections that are
    /// switched off.
    pub fn of(
        paths: &[PathBuf],
        manifest: Option<&Path>,
        cask: Option<&Path>,
        without: &[String],
    ) -> miette::Result<Self> {
        let shown = |path: &Path| path.display().to_string();
        let (mut tests, source) = if let Some(path) = manifest {
            // Other machines may have it in another place.
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            (manifest::read(path, cask)?, name)
        } else {
            let source = cask.map_or_else(|| "cask files beside the recordings".to_owned(), shown);
            (of_paths(paths, cask)?, source)
        };
        name_apart(&mut tests);
        let mut hash = Sha256::new();
        hash.update(cask.and_then(|cask| bytes_of(cask, 16).ok()).unwrap_or_default());
        hash.update(without.join(","));
        for test in &tests {
            hash.update(json!([test.id, test.shown, test.cask_shown, test.stated, test.carried]).to_string());
        }
        Ok(Self { source, tests, of: hexadecimal(&hash.finalize()), shard: (0, 1) })
    }

    /// The numbers of the tests that are this run's.
    pub fn own(&self) -> Vec<usize> {
        (self.shard.0..self.tests.len()).step_by(self.shard.1).collect()
    }

    /// Whether this run does all of it.
    pub fn is_whole(&self) -> bool {
        self.shard.1 == 1
    }

    /// The name of the record in `--out`.
    pub fn record_name(&self) -> String {
        if self.is_whole() {
            SUMMARY[3].to_owned()
        } else {
            format!("results-{}-of-{}.jsonl", self.shard.0, self.shard.1)
        }
    }

    /// What a line says of its place in the campaign, as JSON.
    pub fn place(&self, number: usize) -> String {
        let test = &self.tests[number];
        let object = |pairs: &[(String, String)]| pairs.iter().cloned().collect::<BTreeMap<String, String>>();
        let place = json!({
            "of": self.of, "source": self.source, "number": number, "count": self.tests.len(),
            "shard": [self.shard.0, self.shard.1],
            "recording": test.shown, "cask": test.cask_shown, "report": test.folder,
            "stated": object(&test.stated), "carried": object(&test.carried),
        });
        lines::place(SHARD_SCHEMA, place)
    }

    /// Refuses a folder for the reports in which a recording would be overwritten.
    pub fn spares_recordings(&self, out: &Path) -> miette::Result<()> {
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

fn of_paths(paths: &[PathBuf], cask: Option<&Path>) -> miette::Result<Vec<PlannedTest>> {
    let test = |recording: PathBuf| {
        let cask = cask_of(&recording, cask);
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

/// Gives equal names a number, and each test a folder that leads nowhere else.
fn name_apart(tests: &mut [PlannedTest]) {
    let mut ids: HashSet<String> = HashSet::new();
    let mut folders: HashSet<String> = SUMMARY.iter().map(|name| (*name).to_owned()).collect();
    let [mut of_ids, mut of_folders] = [HashMap::new(), HashMap::new()];
    for test in tests {
        test.id = free(&test.id, &ids, &mut of_ids);
        ids.insert(test.id.clone());
        // Where capitals are no difference two folders would be one.
        test.folder = free(&folder_name(&test.id), &folders, &mut of_folders);
        folders.insert(test.folder.to_lowercase());
    }
}

/// The name, or the name with the first number with which it is not taken; `tried` has the last number of
/// each name.
fn free(name: &str, taken: &HashSet<String>, tried: &mut HashMap<String, u64>) -> String {
    let tried = tried.entry(name.to_owned()).or_default();
    loop {
        *tried += 1;
        let numbered = if *tried == 1 { name.to_owned() } else { format!("{name}-{tried}") };
        if !taken.contains(&numbered) && !taken.contains(&numbered.to_lowercase()) {
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
        name_apart(&mut tests);
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
