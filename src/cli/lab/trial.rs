//! `validate` without a campaign: compares the methods, damages the recordings, and decides on acceptance;
//! with page and pictures.

use super::super::Ending;
use super::super::output::{Folder, columns, print};
use super::super::progress::with_progress;
use super::super::rerun::program_sha256;
use crate::data::Program;
use crate::lab::data::{TrialMachine, TrialRequest};
use crate::lab::methods::{self, References};
use crate::lab::report::{TRIAL_NAMES, trial_files, trial_outcome};
use crate::report;
use std::path::Path;

/// Runs the trial and writes it into the folder `out`; the outcome is acceptance, including a site's own
/// reference recordings in the folder `site`.
pub fn run(request: TrialRequest, site: Option<&Path>, out: Option<&Path>) -> miette::Result<Ending> {
    let folder = out.map(|out| Folder::prepare(out, &TRIAL_NAMES, &[])).transpose()?;
    let site = site.map(References::read).transpose()?;
    let trial =
        with_progress("trial", |progress| methods::trial(request, machine(), site.as_ref(), progress));
    if let Some(folder) = &folder {
        folder.write(&trial_files(&trial)?)?;
    }
    print(&trial_outcome(&trial, columns()))?;
    if let Some(folder) = &folder {
        print(&format!("Written: {}\n", report::sanitize(&folder.file(TRIAL_NAMES[0]))))?;
    }
    Ok(if trial.is_accepted() { Ending::Clear } else { Ending::NeedsALook })
}

/// Describes the machine and the build.
fn machine() -> TrialMachine {
    TrialMachine {
        program_sha256: program_sha256().unwrap_or_default(),
        program_commit: Program::current().commit,
        processor: processor().unwrap_or_else(|| "a processor that does not say its name".to_owned()),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        when: jiff::Timestamp::now().strftime("%Y-%m-%d %H:%M UTC").to_string(),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        is_optimised: !cfg!(debug_assertions),
    }
}

/// Name of the processor, if the system states it: Linux in a file, Windows in the environment.
fn processor() -> Option<String> {
    let from_file = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let name = text.lines().find_map(|line| line.strip_prefix("model name"))?;
        Some(name.trim_start_matches([' ', '\t', ':']).trim().to_owned())
    });
    from_file.or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok()).filter(|name| !name.is_empty())
}
