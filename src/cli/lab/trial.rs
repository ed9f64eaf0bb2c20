//! `validate` without a campaign: every part of the trial, kept as it is done, to the page, charts and tables.

use super::super::Ending;
use super::super::output::{Folder, print, replace};
use super::document::Marks;
use super::machine::machine;
use super::peers::peers;
use super::progress::with_estimate;
use dropcheck::lab::data::{Trial, TrialMachine, TrialPart, TrialRequest};
use dropcheck::lab::methods;
use dropcheck::lab::report::TRIAL_NAMES;
use dropcheck::{lab, report};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const MARKS: Marks = Marks { begin: "<!-- trial: begin -->", end: "<!-- trial: end -->" };

/// Folder of finished parts, in that of the trial.
const PARTS: &str = "parts";
/// The part that programs of others are; and how long they take against the others.
const PEERS: (&str, f64) = ("peers", 2.0);

/// What is asked for.
pub struct WantedTrial<'a> {
    pub request: TrialRequest,
    pub afresh: bool,
    pub out: Option<&'a Path>,
    pub into: Option<&'a Path>,
}

/// A finished part, and what it holds for.
#[derive(Serialize, Deserialize)]
struct Kept {
    schema: String,
    version: String,
    request: TrialRequest,
    machine: TrialMachine,
    said: String,
    part: TrialPart,
}

/// Where finished parts are kept, and for whom.
struct Shelf {
    folder: Option<PathBuf>,
    request: TrialRequest,
    machine: TrialMachine,
}

impl Shelf {
    fn path(&self, name: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{name}.json")))
    }

    /// A part of this version, request and machine that is there already.
    fn taken(&self, name: &str) -> Option<Kept> {
        let kept: Kept = serde_json::from_slice(&std::fs::read(self.path(name)?).ok()?).ok()?;
        let same = kept.version == env!("CARGO_PKG_VERSION")
            && kept.request == self.request
            && kept.machine == self.machine;
        same.then_some(kept)
    }

    fn keep(&self, name: &str, part: TrialPart, said: String) -> miette::Result<Kept> {
        let kept = Kept {
            schema: "dropcheck.trial-part/1".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            request: self.request,
            machine: self.machine.clone(),
            said,
            part,
        };
        if let Some(path) = self.path(name) {
            replace(&path, &serde_json::to_vec_pretty(&kept).map_err(report::ReportError::from)?)?;
        }
        Ok(kept)
    }

    /// The result holds what the parts held: the next trial begins anew.
    fn clear(&self, names: &[&str]) {
        for path in names.iter().filter_map(|name| self.path(name)) {
            // One that is not there, or stays, does no harm.
            let _ = std::fs::remove_file(path);
        }
        if let Some(folder) = &self.folder {
            let _ = std::fs::remove_dir(folder);
        }
    }
}

pub fn run(wanted: &WantedTrial) -> miette::Result<Ending> {
    let folder = wanted.out.map(|out| Folder::checked(out, &TRIAL_NAMES, &[])).transpose()?;
    let document = wanted.into.map(|path| MARKS.parts(path).map(|parts| (path, parts))).transpose()?;
    let shelf =
        Shelf { folder: wanted.out.map(|out| out.join(PARTS)), request: wanted.request, machine: machine() };
    if let Some(parts) = &shelf.folder {
        std::fs::create_dir_all(parts)
            .map_err(|source| miette::miette!("{} cannot be made: {source}", parts.display()))?;
    }
    let jobs = methods::jobs();
    let names: Vec<&str> = jobs.iter().map(|job| job.name).chain([PEERS.0]).collect();
    if wanted.afresh {
        shelf.clear(&names);
        if let Some(parts) = &shelf.folder {
            // As above, it may stand already.
            let _ = std::fs::create_dir_all(parts);
        }
    }
    let waiting = names.iter().filter(|name| shelf.taken(name).is_none()).count();
    if waiting < names.len() {
        let taken = names.len() - waiting;
        eprintln!(
            "{taken} of {} parts are taken from a run that was broken off; --afresh measures them again.",
            names.len()
        );
    }
    let trial = with_estimate(|progress| measured(&shelf, progress))?;
    if let Some(folder) = &folder {
        folder.write(&lab::report::trial_files(&trial)?)?;
        shelf.clear(&names);
    }
    if let Some((path, (before, after))) = &document {
        let charts = wanted.out.map(|out| way(path, out));
        let text = lab::report::trial_markdown(&trial, charts.as_deref());
        replace(path, format!("{before}\n{text}{after}").as_bytes())?;
    }
    match &folder {
        Some(folder) => print(&format!("Written: {}\n", report::printable(&folder.file(TRIAL_NAMES[0]))))?,
        None if document.is_none() => print(&lab::report::trial_markdown(&trial, None))?,
        None => {}
    }
    Ok(Ending::Clear)
}

/// Every part, taken or measured.
fn measured(shelf: &Shelf, progress: &dyn Fn(&str, f64)) -> miette::Result<Trial> {
    let jobs = methods::jobs();
    let waiting: f64 =
        jobs.iter().filter(|job| shelf.taken(job.name).is_none()).map(|job| job.weight).sum::<f64>()
            + PEERS.1;
    let (mut parts, mut done) = (Vec::new(), 0.0);
    for job in &jobs {
        let kept = if let Some(kept) = shelf.taken(job.name) {
            kept
        } else {
            let part = (job.run)(&shelf.request, &|share| {
                progress(job.name, (done + share * job.weight) / waiting);
            });
            done += job.weight;
            shelf.keep(job.name, part, String::new())?
        };
        progress(job.name, done / waiting);
        parts.push(kept.part);
    }
    let beside = if let Some(kept) = shelf.taken(PEERS.0) {
        kept
    } else {
        progress(PEERS.0, done / waiting);
        let (part, said) = peers(&methods::peer_work(&shelf.request), shelf.request.quick);
        shelf.keep(PEERS.0, part, said)?
    };
    parts.push(beside.part);
    Ok(methods::gather(shelf.request, shelf.machine.clone(), beside.said, parts))
}

/// What leads from a document to a folder, for references: relative where the folder lies below the document's own.
fn way(document: &Path, folder: &Path) -> String {
    let own = document.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (own, folder) = match (own.canonicalize(), folder.canonicalize()) {
        (Ok(own), Ok(folder)) => (own, folder),
        _ => (own.to_path_buf(), folder.to_path_buf()),
    };
    let below = folder.strip_prefix(&own).unwrap_or(&folder);
    let words: Vec<String> =
        below.components().map(|part| part.as_os_str().to_string_lossy().replace(' ', "%20")).collect();
    if words.is_empty() { String::new() } else { format!("{}/", words.join("/").replace("//", "/")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shelf(folder: &Path, seed: u64) -> Shelf {
        Shelf {
            folder: Some(folder.to_path_buf()),
            request: TrialRequest { quick: true, seed },
            machine: machine(),
        }
    }

    #[test]
    fn a_part_is_taken_again_for_the_same_request_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let first = shelf(folder.path(), 1);
        first.keep("filters", TrialPart::default(), "said".to_owned()).expect("kept");
        assert_eq!(first.taken("filters").map(|kept| kept.said).as_deref(), Some("said"));
        assert!(shelf(folder.path(), 2).taken("filters").is_none() && first.taken("other").is_none());
        std::fs::write(folder.path().join("filters.json"), "{\"schema\": \"drop").expect("a file");
        assert!(first.taken("filters").is_none());
        first.clear(&["filters", "other"]);
        assert!(!folder.path().exists());
    }

    #[test]
    fn charts_below_the_document_are_named_from_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let charts = folder.path().join("docs/the charts");
        std::fs::create_dir_all(&charts).expect("folders");
        assert_eq!(way(&folder.path().join("docs/a.md"), &charts), "the%20charts/");
        assert_eq!(way(&charts.join("a.md"), &charts), "");
    }
}
