//! `analyze`: analyses one recording with its cask file, prints the table and writes the report.

use super::Ending;
use super::limits::Bounds;
use super::output::{Folder, JsonTarget, columns, note, print};
use super::pdf;
use super::progress::with_progress;
use super::replace::parent_of;
use super::rerun::{self, EarlierResult};
use crate::analysis::{complete, read_within};
use crate::data::keys::CORRECTIONS;
use crate::data::{Analysis, CaskFile, DropResult, HeldSamples, Setting, Verdict};
use crate::{ingest, report};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use miette::{ensure, miette};
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = include_str!("help/analyze.txt"))]
#[allow(clippy::struct_excessive_bools, reason = "switches that have nothing to do with one another")]
pub struct Arguments {
    /// The recording: MCAP, HDF5, CSV or ISO-MME, told by its content
    recording: PathBuf,
    /// The cask file (TOML); `dropcheck init` writes one to fill in
    #[arg(short, long)]
    cask: Option<PathBuf>,
    /// Repeat the analysis recorded in this result.json, with the cask file in it, and say what differs
    #[arg(long, value_name = "RESULT", conflicts_with_all = ["cask", "without"])]
    from: Option<PathBuf>,
    /// A recording of the rest before the drop, where the recording itself has none; goes before `[recording]
    /// rest` of the cask file
    #[arg(long, value_name = "REST")]
    rest: Option<PathBuf>,
    /// Folder for the report: report.html, result.json, curves.csv, srs.csv, curves.h5, curves.mcap, pictures
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the report of another recording in --out
    #[arg(long, requires = "out")]
    force: bool,
    /// Write the result as JSON to a file; with - to standard output, and nothing else there
    #[arg(short, long, value_name = "FILE|-")]
    json: Option<PathBuf>,
    /// Also report.pdf, printed by an installed Chromium, Chrome or Edge
    #[arg(long, requires = "out")]
    pdf: bool,
    /// Separators of curves.csv and srs.csv: en (comma, decimal point) or de (semicolon, decimal comma)
    #[arg(long, value_name = "LOCALE", default_value = "en", value_parser = ["en", "de"], requires = "out")]
    csv_locale: String,
    /// Print all tables below the first screen
    #[arg(long)]
    full: bool,
    /// For a formal report: exit with 1 also where something is untested or a default carries over a tenth
    /// of the variance
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    disabled: DisabledCorrections,
    #[command(flatten)]
    bounds: Bounds,
}

/// Corrections of the samples that the command line disables, whatever the cask file says.
#[derive(Args)]
pub struct DisabledCorrections {
    /// Leave a correction of the samples out; several with commas, or once more
    #[arg(long, value_name = "CORRECTION", value_delimiter = ',', value_parser = corrections())]
    pub without: Vec<String>,
}

/// Lists the keys of `[corrections]` in the cask file.
fn corrections() -> PossibleValuesParser {
    CORRECTIONS.map(|key| PossibleValue::new(key.name).help(key.remark)).into()
}

impl DisabledCorrections {
    /// True if the correction of this key is disabled.
    fn contains(&self, key: &str) -> bool {
        self.without.iter().any(|without| without == key)
    }

    /// Disables them in the cask file, before the analysis.
    pub fn apply_to(&self, cask_file: &mut CaskFile) {
        for (key, is_made) in cask_file.corrections.switches() {
            *is_made &= !self.contains(key);
        }
    }

    /// Records them in the result, since neither the cask file nor its SHA-256 shows them.
    pub fn record_in(&self, result: &mut DropResult) {
        for key in CORRECTIONS.iter().filter(|key| self.contains(key.name)) {
            result.settings.push(Setting {
                name: format!("correction {}", key.name),
                value: "switched off".into(),
                origin: "command line, --without".into(),
            });
        }
    }
}

/// Runs the analysis that the arguments ask for, with samples in memory if there are any; writes nothing, and
/// states neither command nor date.
pub fn analyze(arguments: &Arguments, held: Option<&[HeldSamples]>) -> miette::Result<Analysis> {
    let mut cask_file = ingest::cask_file(arguments.cask.as_deref().unwrap_or(Path::new("")))?;
    arguments.disabled.apply_to(&mut cask_file);
    cask_file.rest = arguments.rest.clone().or(cask_file.rest);
    let limits = arguments.bounds.limits();
    let mut recording = match held {
        Some(held) => ingest::read_arrays(held, &cask_file)?,
        None => ingest::read_within(&arguments.recording, &cask_file, limits, &|_| ())?,
    };
    complete(&mut recording, &cask_file, limits)?;
    let mut analysis = crate::analyze(&recording, &cask_file);
    arguments.disabled.record_in(&mut analysis.result);
    Ok(analysis)
}

/// Writes the report of an analysis into `folder`, as `--out` does.
///
/// # Errors
/// Those of the command: the folder is another program's, holds another recording's report, or cannot be
/// written.
pub fn write(analysis: &Analysis, folder: &Path) -> miette::Result<()> {
    let input = &analysis.result.input;
    let inputs = [Path::new(&input.recording), Path::new(&input.cask)];
    let folder = Folder::prepare(folder, report::FILE_NAMES, &inputs)?;
    folder.refuse_other_recording(&input.recording_sha256)?;
    Ok(folder.write(&report::files(analysis)?)?)
}

/// Runs the command; `words` are those after the program's name, for the record.
pub fn run(arguments: &Arguments, words: Vec<String>) -> miette::Result<Ending> {
    // Its hash is computed while the recording is read, since the result states it.
    #[cfg(not(debug_assertions))]
    std::thread::spawn(rerun::program_sha256);
    let Arguments { recording, cask, from, rest, .. } = arguments;
    if cask.is_none() && from.is_none() {
        return Err(refuse_missing_cask(recording));
    }
    let inputs = [Some(recording), cask.as_ref(), from.as_ref(), rest.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    refuse_swapped_files(recording, cask.as_deref())?;
    let names = [report::FILE_NAMES, &[pdf::NAME]].concat();
    let folder = arguments.out.as_deref().map(|dir| Folder::prepare(dir, &names, &inputs)).transpose()?;
    let json = JsonTarget::prepare(arguments.json.as_deref(), &inputs)?;

    let earlier = arguments.from.as_deref().map(EarlierResult::read).transpose()?;
    let mut cask_file = match (&earlier, &arguments.cask) {
        (Some(earlier), _) => earlier.cask_file()?,
        // One of both is given.
        (None, cask) => ingest::cask_file::parse(cask.as_deref().unwrap_or(Path::new("")))?,
    };
    if folder.is_some() {
        cask_file = ingest::cask_file::with_photos(cask_file)?;
    }
    let earlier_disabled =
        earlier.as_ref().map(|e| DisabledCorrections { without: e.disabled_corrections() });
    let disabled = earlier_disabled.as_ref().unwrap_or(&arguments.disabled);
    disabled.apply_to(&mut cask_file);
    let limits = arguments.bounds.limits();
    let earlier_rest = earlier.as_ref().and_then(EarlierResult::rest);
    cask_file.rest = arguments.rest.clone().or(earlier_rest).or(cask_file.rest);
    let recording =
        with_progress("reading", |progress| read_within(&arguments.recording, &cask_file, limits, progress))?;
    if let Some(folder) = folder.as_ref().filter(|_| !arguments.force) {
        folder.refuse_other_recording(&recording.sha256)?;
    }
    let mut analysis = crate::analyze(&recording, &cask_file);
    disabled.record_in(&mut analysis.result);
    rerun::stamp(&mut analysis.result, words)?;
    let ([summary, differences], repeat_ending) = match &earlier {
        Some(earlier) => earlier.repeat(&mut analysis.result)?,
        None => (Default::default(), Ending::Clear),
    };

    if let Some(folder) = &folder {
        write_report(arguments, &analysis, folder)?;
    }
    json.write(|| report::pretty_json(&analysis.result))?;
    if json.is_standard_output() {
        // Standard output is reserved for the JSON.
        let _ = write!(anstream::stderr(), "{summary}{differences}");
    } else {
        print(&summary)?;
        let page = folder.as_ref().map(|folder| folder.file("report.html"));
        print(&report::first_screen(&analysis, page.as_deref(), columns()))?;
        if arguments.full {
            print(&report::table(&analysis, columns()))?;
        }
        print(&differences)?;
    }
    let not_strict = report::why_not_strict(&analysis).filter(|_| arguments.strict);
    if let Some(why) = &not_strict {
        note(&format!("--strict: {why}"));
    }
    let result = &analysis.result;
    let is_clear = result.verdict == Verdict::Pass && !result.exceeds_a_limit() && not_strict.is_none();
    Ok(repeat_ending.max(Ending::from_review(!is_clear)))
}

/// Writes the files of `--out`, and notes if an older PDF remains among them.
///
/// # Errors
/// Also if no browser prints the report that `--pdf` asks for; all other files are written.
fn write_report(arguments: &Arguments, analysis: &Analysis, folder: &Folder) -> miette::Result<()> {
    let mut files = report::files(analysis)?;
    if arguments.csv_locale == "de" {
        for (_, bytes) in files.iter_mut().filter(|(name, _)| ["curves.csv", "srs.csv"].contains(&&name[..]))
        {
            *bytes = report::in_german(bytes)?;
        }
    }
    let printed = arguments.pdf.then(|| pdf::print_page(&files[0].1)).transpose();
    let (document, missing) = printed.map_or_else(|why| (None, Some(why)), |document| (document, None));
    files.extend(document.map(|bytes| (pdf::NAME.to_owned(), bytes)));
    folder.write(&files)?;
    if let Some(why) = missing {
        let mend = "install one, or open report.html and print it; the other files are written";
        return Err(miette!(help = mend, "there is no {}: {why}", pdf::NAME));
    }
    let is_new = files.iter().any(|(name, _)| name == pdf::NAME);
    if !is_new && Path::new(&folder.file(pdf::NAME)).exists() {
        note(&format!("{} is of an earlier run; --pdf writes it anew.", folder.file(pdf::NAME)));
    }
    Ok(())
}

/// Refuses a command without cask file and names the command with the one beside the recording; only the user
/// knows if it is the right one.
fn refuse_missing_cask(recording: &Path) -> miette::Report {
    let beside = std::fs::read_dir(parent_of(recording)).into_iter().flatten().flatten();
    let names = beside.map(|file| recording.with_file_name(file.file_name()));
    let is_toml = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    let casks: Vec<PathBuf> =
        names.filter(|path| is_toml(path) && ingest::cask_file::parse(path).is_ok()).collect();
    let recording = quote(recording);
    let mend = match &casks[..] {
        [cask] => format!("if it is that beside it: `dropcheck analyze {recording} --cask {}`", quote(cask)),
        _ => format!(
            "write `dropcheck analyze {recording} --cask CASK.toml`; `dropcheck init {recording}` writes a \
             cask file to fill in"
        ),
    };
    miette!(help = mend, "there is no --cask, the cask file of {recording}")
}

/// Quotes a path for a shell.
fn quote(path: &Path) -> String {
    let path = report::sanitize(&path.display().to_string());
    if path.contains(' ') { format!("\"{path}\"") } else { path }
}

/// Refuses a recording whose name shows that it is none.
fn refuse_swapped_files(recording: &Path, cask: Option<&Path>) -> miette::Result<()> {
    let [is_toml, cask_is_toml] = [Some(recording), cask]
        .map(|path| path.and_then(Path::extension).is_some_and(|ending| ending.eq_ignore_ascii_case("toml")));
    let mend = "write it into a file, and name that";
    ensure!(recording != Path::new("-"), help = mend, "- stands for standard input, which is not read");
    let cask = cask.map_or_else(|| "CASK.toml".to_owned(), quote);
    let recording = quote(recording);
    let mend = format!("write `dropcheck analyze {cask} --cask {recording}`");
    ensure!(!is_toml || cask_is_toml, help = mend, "{recording} is a cask file by its name, and {cask} none");
    Ok(())
}
