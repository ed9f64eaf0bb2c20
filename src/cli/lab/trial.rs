//! `validate` without a campaign: ways of working and damages to what is accepted, with page and pictures.

use super::super::Ending;
use super::super::output::{Folder, columns, print, replace};
use super::super::progress::with_progress;
use super::document::Marks;
use crate::lab::data::{TrialMachine, TrialRequest};
use crate::lab::methods::{self, References};
use crate::lab::report::{TRIAL_NAMES, trial_files, trial_markdown, trial_outcome};
use crate::{ingest, report};
use std::path::Path;

const MARKS: Marks = Marks { begin: "<!-- trial: begin -->", end: "<!-- trial: end -->" };

/// Writes the trial into the folder `out` and, by its extract, into the document `into`; ends with what is
/// accepted, a site's own reference recordings in the folder `site` among it.
pub fn run(
    request: TrialRequest,
    site: Option<&Path>,
    out: Option<&Path>,
    into: Option<&Path>,
) -> miette::Result<Ending> {
    let folder = out.map(|out| Folder::checked(out, &TRIAL_NAMES, &[])).transpose()?;
    let document = into.map(|path| MARKS.parts(path).map(|parts| (path, parts))).transpose()?;
    let site = site.map(References::of).transpose()?;
    let trial =
        with_progress("trial", |progress| methods::trial(request, machine(), site.as_ref(), progress));
    if let Some(folder) = &folder {
        folder.write(&trial_files(&trial)?)?;
    }
    if let Some((path, (before, after))) = &document {
        let text = trial_markdown(&trial, out.map(|out| way(path, out)).as_deref());
        replace(path, format!("{before}\n{text}{after}").as_bytes())?;
    }
    print(&trial_outcome(&trial, columns()))?;
    if let Some(folder) = &folder {
        print(&format!("Written: {}\n", report::printable(&folder.file(TRIAL_NAMES[0]))))?;
    }
    Ok(if trial.is_accepted() { Ending::Clear } else { Ending::NeedsALook })
}

/// What this program runs on.
fn machine() -> TrialMachine {
    let program = std::env::current_exe().ok().and_then(|program| ingest::sha256(&program).ok());
    TrialMachine {
        program_sha256: program.unwrap_or_default(),
        processor: processor().unwrap_or_else(|| "a processor that does not say its name".to_owned()),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        when: jiff::Timestamp::now().strftime("%Y-%m-%d %H:%M UTC").to_string(),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        is_optimised: !cfg!(debug_assertions),
    }
}

/// Its name where the system tells it: Linux in a file, Windows in the environment.
fn processor() -> Option<String> {
    let told = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let name = text.lines().find_map(|line| line.strip_prefix("model name"))?;
        Some(name.trim_start_matches([' ', '\t', ':']).trim().to_owned())
    });
    told.or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok()).filter(|name| !name.is_empty())
}

/// What leads from a document to a folder, for references: relative where the folder lies below the
/// document's own.
fn way(document: &Path, folder: &Path) -> String {
    let below = document.parent().and_then(|own| folder.strip_prefix(own).ok()).unwrap_or(folder);
    let words: Vec<String> =
        below.components().map(|part| part.as_os_str().to_string_lossy().replace(' ', "%20")).collect();
    if words.is_empty() { String::new() } else { format!("{}/", words.join("/").replace("//", "/")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_below_the_document_are_named_from_it() {
        assert_eq!(way(Path::new("docs/a.md"), Path::new("docs/the charts")), "the%20charts/");
        assert_eq!(way(Path::new("docs/a.md"), Path::new("docs")), "");
        assert_eq!(way(Path::new("a.md"), Path::new("/b")), "/b/");
    }
}
