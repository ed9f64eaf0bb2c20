//! Writes finished bytes to files, whole or not at all, and to standard output; checks the targets before the
//! work begins.

use super::protected_folders::is_protected;
use super::replace::{
    StoppedWrite, TEMP_PREFIX, create_beside, create_staging, parent_of, replace_set, sync_folder,
    write_whole,
};
use crate::data::shown;
use crate::ingest::{bytes_of, opened};
use crate::report::{ReportError, sanitize};
use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Beginning of every JSON document of this program, and the bytes within which it stands.
const SCHEMA_MARK: &str = "\"schema\": \"dropcheck.";
const SCHEMA_MARK_WITHIN: u64 = 64;

/// Reason why something could not be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum CannotWrite {
    #[error("{0} is a file, and --out needs a folder")]
    #[diagnostic(help("name a folder that does not exist yet, or an older report's"))]
    NotAFolder(String),
    #[error("{0} is no place for a report: its files would lie among those of the system or of your home")]
    #[diagnostic(help("name a folder of its own, which need not exist yet, such as --out report"))]
    Shared(String),
    #[error("nothing can be written in {path}")]
    #[diagnostic(help("choose another place, or change its permissions"))]
    NotWritable { path: String, source: io::Error },
    #[error("the folder {0} does not exist")]
    #[diagnostic(help("create it, or choose another place"))]
    NoFolder(String),
    #[error("{0} would overwrite the recording or the cask file")]
    #[diagnostic(help("choose another place: no command alters its input"))]
    Input(String),
    #[error("{0} exists and was not written by dropcheck")]
    #[diagnostic(help("choose another place, or remove it yourself"))]
    Foreign(String),
    #[error("{folder} holds the report of another recording, {recording}")]
    #[diagnostic(help("name another folder; or add --force, which replaces that report"))]
    OtherReport { folder: String, recording: String },
    #[error("{0} is a symbolic link")]
    #[diagnostic(help("name what it points to"))]
    Link(String),
    #[error("{0} is a folder, and a file of that name must be written")]
    #[diagnostic(help("choose another place, or remove it yourself"))]
    IsAFolder(String),
    #[error("{path} could not be written")]
    #[diagnostic(help(
        "see whether the disk is full or another program has it open; what was there before is unchanged"
    ))]
    Failed { path: String, source: io::Error },
    #[error("standard output could not be written")]
    #[diagnostic(help("see whether the disk behind it is full"))]
    StandardOutput { source: io::Error },
}

fn display(path: &Path) -> String {
    path.display().to_string()
}

/// Refuses a path, for the reason `why`, if something `is_wrong` with it.
fn refuse_if(is_wrong: bool, why: fn(String) -> CannotWrite, path: &Path) -> Result<(), CannotWrite> {
    if is_wrong { Err(why(display(path))) } else { Ok(()) }
}

/// Returns the operating system's message without its error number and without names of intermediate files.
fn without_details(source: &io::Error) -> io::Error {
    io::Error::new(source.kind(), shown::os_text(source))
}

/// A folder that was checked, before the work, to accept the files.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Checks that files with these `names` can be written in `path`: that it is a folder or can become one,
    /// writable, and that none of the files is an input or another program's. The first of `names` that ends
    /// in ".json" shows who wrote them.
    pub fn prepare(path: &Path, names: &[&str], inputs: &[&Path]) -> Result<Self, CannotWrite> {
        if path.as_os_str().is_empty() {
            return Err(CannotWrite::NoFolder("\"\"".into()));
        }
        refuse_if(is_input(path, inputs), CannotWrite::Input, path)?;
        // Somebody may have placed a link to have files written elsewhere.
        refuse_if(path.is_symlink(), CannotWrite::Link, path)?;
        refuse_if(is_protected(path), CannotWrite::Shared, path)?;
        let mut ancestor = path;
        while fs::symlink_metadata(ancestor).is_err() {
            ancestor = match ancestor.parent() {
                Some(parent) if !parent.as_os_str().is_empty() => parent,
                // This drive or network share of Windows does not exist.
                _ if ancestor.has_root() => return Err(CannotWrite::NoFolder(display(ancestor))),
                _ => Path::new("."),
            };
        }
        refuse_if(!ancestor.is_dir(), CannotWrite::NotAFolder, ancestor)?;
        check_writable(ancestor)?;
        let present: Vec<PathBuf> =
            names.iter().map(|name| path.join(name)).filter(|p| fs::symlink_metadata(p).is_ok()).collect();
        for target in &present {
            refuse_if(is_input(target, inputs), CannotWrite::Input, target)?;
            let is_folder = target.is_dir() && !target.is_symlink();
            refuse_if(is_folder, CannotWrite::IsAFolder, target)?;
        }
        let is_json = |name: &&&str| Path::new(name).extension().is_some_and(|ending| ending == "json");
        let is_ours = names.iter().find(is_json).is_none_or(|n| is_own_json(&path.join(n)));
        match present.first() {
            Some(first) if !is_ours => Err(CannotWrite::Foreign(display(first))),
            _ => Ok(Self { path: path.to_path_buf() }),
        }
    }

    /// Refuses to replace the report or the first look of a recording with another SHA-256.
    pub fn refuse_other_recording(&self, sha256: &str) -> Result<(), CannotWrite> {
        for (name, input) in [("result.json", "/input"), ("recording.json", "")] {
            let there = bytes_of(&self.path.join(name), 16).unwrap_or_default();
            let there: serde_json::Value = serde_json::from_slice(&there).unwrap_or_default();
            let input = there.pointer(input).unwrap_or(&serde_json::Value::Null);
            let [other, recording] = ["recording_sha256", "recording"].map(|key| &input[key]);
            if !other.is_null() && other != sha256 {
                let (folder, recording) = (display(&self.path), recording.to_string());
                return Err(CannotWrite::OtherReport { folder, recording });
            }
        }
        Ok(())
    }

    /// Creates the folder and its parents.
    pub fn create(&self) -> Result<(), CannotWrite> {
        fs::create_dir_all(&self.path).map_err(write_error(&self.path))
    }

    /// Returns the path of one of the files, for a reader.
    pub fn file(&self, name: &str) -> String {
        display(&self.path.join(name))
    }

    /// Writes every file under a temporary name and moves all to their places when they are complete.
    pub fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), CannotWrite> {
        replace_set(&self.path, files).map_err(|StoppedWrite { path, source }| write_error(&path)(source))
    }
}

/// Target of `--json`: none, standard output ("-"), or a file, checked before the work.
#[derive(Debug)]
pub struct JsonTarget(Option<PathBuf>);

impl JsonTarget {
    /// Checks that `path` can be written and is neither an input nor another program's file; "-" is standard
    /// output.
    pub fn prepare(path: Option<&Path>, inputs: &[&Path]) -> Result<Self, CannotWrite> {
        let target = Self(path.map(Path::to_path_buf));
        let Some(path) = path.filter(|_| !target.is_standard_output()) else { return Ok(target) };
        refuse_if(is_input(path, inputs), CannotWrite::Input, path)?;
        match fs::metadata(path) {
            Ok(there) if there.is_dir() => return Err(CannotWrite::IsAFolder(display(path))),
            // A pipe or a device accepts the bytes directly.
            Ok(there) if !there.is_file() => return Ok(target),
            _ if path.is_symlink() => return Err(CannotWrite::Link(display(path))),
            Ok(there) => refuse_if(there.len() > 0 && !is_own_json(path), CannotWrite::Foreign, path)?,
            Err(_) => {}
        }
        let parent = parent_of(path);
        refuse_if(!parent.is_dir(), CannotWrite::NoFolder, parent)?;
        check_writable(parent)?;
        Ok(target)
    }

    /// True if standard output is reserved for JSON.
    pub fn is_standard_output(&self) -> bool {
        self.0.as_deref() == Some(Path::new("-"))
    }

    /// Makes the JSON and writes it, if it was asked for.
    pub fn write(&self, make: impl FnOnce() -> Result<Vec<u8>, ReportError>) -> miette::Result<()> {
        match &self.0 {
            None => {}
            Some(_) if self.is_standard_output() => print_bytes(&make()?)?,
            Some(path) => replace(path, &make()?)?,
        }
        Ok(())
    }
}

fn write_error(path: &Path) -> impl Fn(io::Error) -> CannotWrite + '_ {
    move |source| CannotWrite::Failed { path: display(path), source: without_details(&source) }
}

/// Writes or replaces a file, whole or not at all.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), CannotWrite> {
    write_file(path, bytes).map_err(write_error(path))
}

fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        return fs::OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    let parent = parent_of(path);
    let staging = create_staging(parent)?;
    let staged = staging.path().join("json");
    write_whole(&staged, bytes)?;
    fs::rename(&staged, path)?;
    sync_folder(parent)
}

/// Like [`replace`], with a function that writes the content in pieces, so that a large file is never whole
/// in memory.
pub fn replace_in_pieces(
    path: &Path,
    write: impl FnOnce(&mut dyn FnMut(&[u8]) -> miette::Result<()>) -> miette::Result<()>,
) -> miette::Result<()> {
    let (staged, file) = create_beside(path).map_err(write_error(path))?;
    let mut writer = io::BufWriter::new(file);
    write(&mut |bytes| Ok(writer.write_all(bytes).map_err(write_error(path))?))?;
    let written = writer.into_inner().map_err(io::IntoInnerError::into_error);
    written.and_then(|file| file.sync_all()).map_err(write_error(path))?;
    fs::rename(&staged, path).and_then(|()| sync_folder(parent_of(path))).map_err(write_error(path))?;
    Ok(())
}

/// True if tables and progress are not printed.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

pub fn set_quiet(is_quiet: bool) {
    IS_QUIET.store(is_quiet, Ordering::Relaxed);
}

pub fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

/// Writes to standard output, with colours on a terminal; a reader that has left is no error.
pub fn print(text: &str) -> Result<(), CannotWrite> {
    if is_quiet() {
        return Ok(());
    }
    let mut out = anstream::stdout().lock();
    ignore_closed_reader(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Prints a note on standard error.
pub fn note(words: &str) {
    // If standard error is closed, nobody can be informed.
    let _ = writeln!(anstream::stderr(), "{}", sanitize(words));
}

/// Width of tables in columns: that of the terminal, or 80 without one.
pub fn columns() -> usize {
    let terminal = terminal_size::terminal_size_of(io::stdout()).map(|(width, _)| usize::from(width.0));
    terminal.map_or(80, |width| width.clamp(60, 160))
}

/// Writes bytes to standard output unchanged.
pub fn print_bytes(bytes: &[u8]) -> Result<(), CannotWrite> {
    let mut out = io::stdout().lock();
    ignore_closed_reader(out.write_all(bytes).and_then(|()| out.flush()))
}

fn ignore_closed_reader(written: io::Result<()>) -> Result<(), CannotWrite> {
    match written {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(CannotWrite::StandardOutput { source: without_details(&source) })
        }
        _ => Ok(()),
    }
}

fn check_writable(folder: &Path) -> Result<(), CannotWrite> {
    tempfile::Builder::new().prefix(TEMP_PREFIX).tempfile_in(folder).map(drop).map_err(|source| {
        CannotWrite::NotWritable { path: display(folder), source: without_details(&source) }
    })
}

fn is_input(path: &Path, inputs: &[&Path]) -> bool {
    let Ok(path) = fs::canonicalize(path) else { return false };
    inputs.iter().any(|input| fs::canonicalize(input).is_ok_and(|input| input == path))
}

fn is_own_json(path: &Path) -> bool {
    let head = read_head(path, SCHEMA_MARK_WITHIN).unwrap_or_default();
    String::from_utf8_lossy(&head).contains(SCHEMA_MARK)
}

/// Reads at most the first `most` bytes of a file.
pub fn read_head(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    opened(path)?.take(most).read_to_end(&mut head)?;
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: &[u8] = b"{\n  \"schema\": \"dropcheck.result/1\"\n}\n";

    fn files() -> Vec<(String, Vec<u8>)> {
        vec![("report.html".into(), b"new".to_vec()), ("result.json".into(), OWN.to_vec())]
    }

    const NAMES: [&str; 2] = ["report.html", "result.json"];

    #[test]
    fn a_new_folder_appears_whole_and_an_old_report_is_replaced() {
        let place = tempfile::tempdir().unwrap();
        let dir = place.path().join("a/b");
        for _ in 0..2 {
            Folder::prepare(&dir, &NAMES, &[]).unwrap().write(&files()).unwrap();
            assert_eq!(fs::read(dir.join("report.html")).unwrap(), b"new");
            assert_eq!(fs::read_dir(&dir).unwrap().count(), 2);
            fs::write(dir.join("report.html"), "old").unwrap();
        }
        assert_eq!(fs::read_dir(place.path().join("a")).unwrap().count(), 1);
    }

    #[test]
    fn what_is_not_ours_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("report.html"), "theirs").unwrap();
        let refused = Folder::prepare(place.path(), &NAMES, &[]).unwrap_err();
        assert!(matches!(refused, CannotWrite::Foreign { .. }));
        let file = place.path().join("theirs.json");
        fs::write(&file, "{}").unwrap();
        let refused = JsonTarget::prepare(Some(&file), &[]).unwrap_err();
        assert!(matches!(refused, CannotWrite::Foreign { .. }));
    }

    #[test]
    fn an_input_is_never_a_target() {
        let place = tempfile::tempdir().unwrap();
        let recording = place.path().join("result.json");
        fs::write(&recording, OWN).unwrap();
        let other_words = place.path().join(".").join("result.json");
        assert!(matches!(
            Folder::prepare(place.path(), &NAMES, &[&other_words]),
            Err(CannotWrite::Input { .. })
        ));
        assert!(matches!(
            JsonTarget::prepare(Some(&recording), &[&other_words]),
            Err(CannotWrite::Input { .. })
        ));
    }

    #[test]
    fn a_file_in_the_place_of_a_folder_is_refused_before_the_work() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("file");
        fs::write(&file, "x").unwrap();
        for out in [file.clone(), file.join("below")] {
            assert!(matches!(Folder::prepare(&out, &NAMES, &[]), Err(CannotWrite::NotAFolder { .. })));
        }
        assert!(matches!(JsonTarget::prepare(Some(place.path()), &[]), Err(CannotWrite::IsAFolder { .. })));
        let far = place.path().join("none/result.json");
        assert!(matches!(JsonTarget::prepare(Some(&far), &[]), Err(CannotWrite::NoFolder { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_the_folder_is_replaced_and_what_it_points_to_stays() {
        let place = tempfile::tempdir().unwrap();
        let theirs = place.path().join("theirs");
        fs::write(&theirs, "theirs").unwrap();
        let dir = place.path().join("dir");
        fs::create_dir(&dir).unwrap();
        fs::write(dir.join("result.json"), OWN).unwrap();
        std::os::unix::fs::symlink(&theirs, dir.join("report.html")).unwrap();
        Folder::prepare(&dir, &NAMES, &[]).unwrap().write(&files()).unwrap();
        assert_eq!(fs::read(&theirs).unwrap(), b"theirs");
        assert_eq!(fs::read(dir.join("report.html")).unwrap(), b"new");
        let link = place.path().join("link.json");
        std::os::unix::fs::symlink(&theirs, &link).unwrap();
        assert!(matches!(JsonTarget::prepare(Some(&link), &[]), Err(CannotWrite::Link { .. })));
    }

    #[test]
    fn a_reader_that_left_is_no_error() {
        assert!(ignore_closed_reader(Err(io::Error::from(ErrorKind::BrokenPipe))).is_ok());
        assert!(ignore_closed_reader(Err(io::Error::from(ErrorKind::StorageFull))).is_err());
    }
}
