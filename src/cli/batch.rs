//! `batch`: analyses a campaign of recordings into a report and a line each, and a summary of all; one that
//! fails does not stop the others.

mod campaign;
mod manifest;
mod paths;
mod plan;
mod planned;

pub use manifest::template;
pub use plan::SHARD_SCHEMA;

use super::Ending;
use super::analyze::DisabledCorrections;
use super::limits::Bounds;
use super::lines::{self, LineOutput, LineRecord, check_shard, parse_shard};
use super::output::{Folder, columns, print};
use super::rerun::stamp;
use crate::analysis::read_within;
use crate::data::{Analysis, CaskFile};
use crate::ingest::bytes_of;
use crate::report::Batch;
use crate::report::sentence;
use crate::{ingest, report};
use clap::Args;
use miette::miette;
use plan::CampaignPlan;
use planned::PlannedTest;
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = include_str!("help/batch.txt"))]
pub struct Arguments {
    /// Recordings, folders of them, and patterns; each counted once
    #[arg(required_unless_present = "manifest", conflicts_with = "manifest", value_name = "PATHS")]
    paths: Vec<PathBuf>,
    /// A table (CSV) of the recordings with their cask files; paths in it are relative to it
    #[arg(short, long, value_name = "FILE")]
    manifest: Option<PathBuf>,
    /// The cask file (TOML) of those that have none of their own
    #[arg(short, long)]
    cask: Option<PathBuf>,
    /// Folder for campaign.html, campaign.csv, campaign.json and one report a recording
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// One line a recording: its result, or {"id", "exit", "error"}; with - to standard output, and nothing
    /// else there
    #[arg(long, value_name = "FILE|-")]
    jsonl: Option<PathBuf>,
    /// Only each N-th recording from number I on, from 0; `dropcheck merge` puts the parts together
    #[arg(long, value_name = "I/N", value_parser = parse_shard, default_value = "0/1",
        hide_default_value = true)]
    shard: (usize, usize),
    /// Go on with what an earlier run of the same words has left: what is done is not done again
    #[arg(long)]
    resume: bool,
    /// Recordings at a time, each on one core [default: all cores]
    #[arg(short = 'J', long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Exit status 0 also where results want a look; 2 stays for what could not be analysed
    #[arg(long)]
    exit_zero: bool,
    #[command(flatten)]
    disabled: DisabledCorrections,
    #[command(flatten)]
    bounds: Bounds,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let (manifest, cask) = (arguments.manifest.as_deref(), arguments.cask.as_deref());
    let mut plan = CampaignPlan::new(&arguments.paths, manifest, cask, &arguments.disabled.without)?;
    plan.shard = arguments.shard;
    check_shard(arguments.shard, plan.tests.len())?;
    let inputs: Vec<&Path> = arguments.manifest.iter().chain(&arguments.cask).map(PathBuf::as_path).collect();
    if let Some(out) = &arguments.out {
        Folder::prepare(out, &plan::SUMMARY[..3], &inputs)?;
        plan.refuse_overwriting(out)?;
    }
    let record = open_record(arguments, &plan, &inputs)?;
    let mut output = LineOutput::new(record, arguments.jsonl.as_deref());
    let jobs = arguments
        .jobs
        .map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let mut batch = Batch::new(plan.source.clone());
    let make = |number: usize, earlier: Option<&str>| {
        let is_done = earlier.is_some_and(|line| is_done(line, &plan.tests[number], arguments));
        Ok((!is_done).then(|| make_line(&plan, number, arguments)))
    };
    output.write_lines(plan.numbers(), jobs, make, |line| {
        batch.add(&serde_json::from_str(line).unwrap_or_default());
        Ok(())
    })?;
    let out = arguments.out.as_deref().filter(|_| plan.is_whole());
    if let Some((record, out)) = output.record.as_ref().zip(out) {
        campaign::write(out, &batch, &record.lines, &inputs)?;
    }
    if !output.is_standard_output {
        print(&batch.table(columns()))?;
        print_location(arguments, &plan)?;
    }
    Ok(campaign::ending(&batch).with_exit_zero(arguments.exit_zero))
}

/// Prints where the files are.
fn print_location(arguments: &Arguments, plan: &CampaignPlan) -> miette::Result<()> {
    if plan.is_whole() {
        return arguments.out.as_deref().map_or(Ok(()), print_page_path);
    }
    let ((index, count), done, all) = (plan.shard, plan.numbers().len(), plan.tests.len());
    let merge = "`dropcheck merge` makes the campaign of all shards";
    Ok(print(&format!("\nShard {index}/{count}: {done} of {all} recordings; {merge}.\n"))?)
}

fn print_page_path(out: &Path) -> miette::Result<()> {
    let page = out.join("campaign.html").display().to_string();
    Ok(print(&format!("\nCampaign: {}\n", report::sanitize(&page)))?)
}

/// Opens the file for the lines: that of `--jsonl`, else one in `--out`.
fn open_record(
    arguments: &Arguments,
    plan: &CampaignPlan,
    inputs: &[&Path],
) -> miette::Result<Option<LineRecord>> {
    let of_jsonl = arguments.jsonl.clone().filter(|path| path != Path::new("-"));
    let path = match (of_jsonl, &arguments.out) {
        (Some(path), _) => path,
        (None, Some(out)) => {
            let made = std::fs::create_dir_all(out);
            made.map_err(|source| miette!("{} cannot be made: {source}", out.display()))?;
            out.join(plan.record_name())
        }
        (None, None) if arguments.resume => {
            let mend = "name the --out or the --jsonl FILE of the run that is to go on";
            return Err(miette!(help = mend, "--resume does not know what is done"));
        }
        (None, None) => return Ok(None),
    };
    let numbers = plan.numbers();
    let own_number = |line: &Value| {
        let number = lines::line_number(line, &numbers, |number| plan.place(number));
        Ok(number.filter(|_| report::impossible(line).is_none()))
    };
    LineRecord::open(&path, arguments.resume, inputs, own_number).map(Some)
}

/// True if an earlier line still holds: its inputs are unchanged and its report exists.
fn is_done(line: &str, test: &PlannedTest, arguments: &Arguments) -> bool {
    let Some(cask) = &test.cask else { return false };
    let line: Value = serde_json::from_str(line).unwrap_or_default();
    let input = &line["input"];
    // The report states the same values as the line.
    let is_there = || {
        let Some(folder) = arguments.out.as_ref().map(|out| out.join(&test.folder)) else { return true };
        let result = bytes_of(&folder.join("result.json"), 16).unwrap_or_default();
        let result: Value = serde_json::from_slice(&result).unwrap_or_default();
        let mut entries = line.as_object().into_iter().flatten();
        folder.join(report::FILE_NAMES[0]).is_file()
            && entries
                .all(|(key, value)| ["campaign", "id", "curves"].contains(&&key[..]) || result[key] == *value)
    };
    let cask_file = || ingest::cask_file::with_columns(cask, &test.stated).ok();
    let sha256 = |path: &Path| ingest::sha256(path).ok();
    let is_same_cask = |file: &CaskFile| {
        let rest_sha256 = file.rest.as_ref().map(|rest| sha256(rest));
        let simulation_sha256 = file.simulation.as_ref().map(|simulation| sha256(&simulation.path));
        input["cask_sha256"] == file.sha256
            && input["rest_sha256"] == json!(rest_sha256)
            && input["simulation_sha256"] == json!(simulation_sha256)
    };
    line["verdict"].is_string()
        && is_there()
        && cask_file().as_ref().is_some_and(is_same_cask)
        && sha256(&test.recording).is_some_and(|sha256| input["recording_sha256"] == sha256)
}

/// Makes the line of one test: its result, or the error.
fn make_line(plan: &CampaignPlan, number: usize, arguments: &Arguments) -> String {
    let test = &plan.tests[number];
    let head = format!("{{\"campaign\":{},\"id\":{},", plan.place(number), json!(test.id));
    // A panic of the program also makes a line.
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let analysis = analyze_test(plan, test, arguments)?;
        let curves = report::to_line(&report::drop_curves(&analysis))?;
        Ok(format!("\"curves\":{curves},{}", &report::to_line(&analysis.result)?[1..]))
    }));
    let fault = |_| Err(miette!("{}: the program has a fault here; please report it", test.shown));
    let outcome = outcome.unwrap_or_else(fault);
    match outcome {
        Ok(result) => format!("{head}{result}\n"),
        Err(complaint) => {
            let error = confidential_error(test, arguments).unwrap_or_else(|| sentence(&complaint));
            let failed = json!({"exit": 2, "error": error});
            format!("{head}{}\n", &report::to_line(&failed).unwrap_or_default()[1..])
        }
    }
}

/// Error message that reveals nothing of a file outside the folder of the manifest or of the recording: a
/// manifest from somebody else may name any file, and a folder may contain links to any. `None` if both files
/// lie inside.
fn confidential_error(test: &PlannedTest, arguments: &Arguments) -> Option<String> {
    let folder = arguments.manifest.as_ref().unwrap_or(&test.recording).parent();
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = std::fs::canonicalize(folder).ok()?;
    let cask = test.cask.as_ref().filter(|cask| arguments.cask.as_ref() != Some(*cask));
    let mut files = [Some(&test.recording), cask].into_iter().flatten();
    files.find(|file| std::fs::canonicalize(file).is_ok_and(|file| !file.starts_with(&folder)))?;
    let (recording, cask) = (&test.shown, test.cask_shown.as_deref().unwrap_or("FILE"));
    Some(report::sanitize(&format!(
        "{recording} or its cask file lies in another folder, so that what is wrong with it is not written \
         here; `dropcheck analyze {recording} --cask {cask}` says it"
    )))
}

fn analyze_test(plan: &CampaignPlan, test: &PlannedTest, arguments: &Arguments) -> miette::Result<Analysis> {
    let Some(cask) = &test.cask else {
        // The message omits the name, so that it is the same for all recordings without cask file.
        let mend = "put NAME.toml beside NAME.mcap, or name one by --cask or in the manifest";
        return Err(miette!(help = mend, "there is no cask file for the recording"));
    };
    let inputs = [test.recording.as_path(), cask];
    let folder = arguments
        .out
        .as_ref()
        .map(|out| Folder::prepare(&out.join(&test.folder), report::FILE_NAMES, &inputs));
    let folder = folder.transpose()?;
    let mut cask_file = ingest::cask_file::with_columns(cask, &test.stated)?;
    if folder.is_some() {
        cask_file = ingest::cask_file::with_photos(cask_file)?;
    }
    arguments.disabled.apply_to(&mut cask_file);
    let recording = read_within(&test.recording, &cask_file, arguments.bounds.limits(), &|_| ())?;
    let mut analysis = crate::analyze(&recording, &cask_file);
    arguments.disabled.record_in(&mut analysis.result);
    stamp(&mut analysis.result, command_words(plan, test, arguments))?;
    if let Some(folder) = folder {
        folder.write(&report::files(&analysis)?)?;
    }
    Ok(analysis)
}

/// Returns the command that would analyse this recording alone, independent of shard and output folder.
fn command_words(plan: &CampaignPlan, test: &PlannedTest, arguments: &Arguments) -> Vec<String> {
    let mut words = vec!["batch".to_owned()];
    if arguments.manifest.is_some() {
        words.extend(["--manifest".to_owned(), plan.source.clone()]);
    } else {
        words.push(test.shown.clone());
        words.extend(test.cask_shown.iter().flat_map(|cask| ["--cask".to_owned(), cask.clone()]));
    }
    let without = &arguments.disabled.without;
    if !without.is_empty() {
        words.extend(["--without".to_owned(), without.join(",")]);
    }
    words
}

/// Writes the files of the campaign from all its shards.
pub fn merge(shards: &[PathBuf], out: &Path) -> miette::Result<Ending> {
    let inputs: Vec<&Path> = shards.iter().map(PathBuf::as_path).collect();
    Folder::prepare(out, &plan::SUMMARY[..3], &inputs)?;
    let (lines, first) = lines::merge_shards(shards, report::impossible)?;
    let mut batch = Batch::new(first["source"].as_str().unwrap_or_default().to_owned());
    lines.for_each(|line| {
        batch.add(&serde_json::from_slice(line).unwrap_or_default());
        Ok(())
    })?;
    campaign::write(out, &batch, &lines, &inputs)?;
    print(&batch.table(columns()))?;
    print_page_path(out)?;
    Ok(campaign::ending(&batch))
}
