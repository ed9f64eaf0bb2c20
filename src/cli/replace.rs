//! A set of finished files into a folder: all of them or none, whatever interrupts it, and nobody else's
//! touched.

use rayon::prelude::*;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What the program's own folders beside and in a report begin with; none outlives an undisturbed run.
pub const OWN_PREFIX: &str = ".dropcheck-";
/// Complete files that were on their way to their places when the run was stopped.
const UNFINISHED: &str = ".dropcheck-unfinished";
/// A folder with more entries is no report's but a person's, and is not exchanged as a whole.
#[cfg(target_os = "linux")]
const MOST_ENTRIES: usize = 256;

/// Where a write stopped, and why.
#[derive(Debug)]
pub struct Stopped {
    pub path: PathBuf,
    pub source: io::Error,
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> Stopped + '_ {
    move |source| Stopped { path: path.to_path_buf(), source }
}

/// Writes `files` to `folder`, which need not exist.
///
/// A folder that holds plain files only is exchanged for a complete one in a single step of the file system.
/// Where that cannot be, complete files are moved one by one; a run that is stopped between two of them is
/// made good by the next.
pub fn replace_set(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Stopped> {
    // "." has no parent by its name, and would wait for its own lock.
    let folder = &std::path::absolute(folder).map_err(at(folder))?;
    let parent = parent_of(folder);
    fs::create_dir_all(parent).map_err(at(parent))?;
    let turn = turn(parent);
    let clear_stale = |place: &Path| turn.iter().for_each(|_| clear_stale(place, files));
    clear_stale(parent);
    match fs::symlink_metadata(folder) {
        Err(_) => return appear(parent, folder, files),
        Ok(there) if !there.is_dir() => {
            return Err(at(folder)(io::Error::other("a link or a file has taken the folder's place")));
        }
        Ok(_) => clear_stale(folder),
    }
    if exchange(parent, folder, files).map_err(at(folder))? {
        return Ok(());
    }
    move_one_by_one(folder, files)
}

/// The folder that `path` lies in.
pub fn parent_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// One run at a time writes below a folder, where its file system knows locks: this one, as long as it holds
/// the lock.
fn turn(parent: &Path) -> Option<File> {
    File::open(parent).ok().filter(|folder| folder.lock().is_ok())
}

/// Removes what a run that was killed left in `parent`: while this one has its turn nobody is at work there.
fn clear_stale(parent: &Path, files: &[(String, Vec<u8>)]) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_own = name.to_string_lossy().starts_with(OWN_PREFIX) && name != UNFINISHED;
        if is_own && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            clear(&entry.path(), files);
        } else if is_own && entry.metadata().is_ok_and(|there| there.is_file() && there.len() == 0) {
            // Made to see whether the folder can be written to.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Removes a left-over folder with those of its files that were this program's or still have a name
/// elsewhere.
fn clear(stale: &Path, files: &[(String, Vec<u8>)]) {
    for entry in fs::read_dir(stale).into_iter().flatten().flatten() {
        let is_own = files.iter().any(|(name, _)| entry.file_name() == name.as_str());
        if is_own || entry.metadata().is_ok_and(|metadata| has_other_name(&metadata)) {
            let _ = fs::remove_file(entry.path());
        }
    }
    // Refused where something is left in it.
    let _ = fs::remove_dir(stale);
}

#[cfg(unix)]
fn has_other_name(metadata: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    metadata.is_file() && metadata.nlink() > 1
}

#[cfg(not(unix))]
fn has_other_name(_: &fs::Metadata) -> bool {
    false
}

/// A folder that vanishes unless it is moved, beside the place its content goes to.
pub fn staging_in(folder: &Path) -> io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(OWN_PREFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any folder the user makes: the process's mask takes away what it must.
        builder.permissions(fs::Permissions::from_mode(0o777));
    }
    builder.tempdir_in(folder)
}

/// Writes a file that must not exist, down to the disk.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    use std::io::Write;
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// A file beside `path`, to be filled and given its name: always the same one, so that what a killed run left
/// is written over.
pub fn staged_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let staged = parent_of(path).join(format!("{OWN_PREFIX}{name}"));
    match fs::remove_file(&staged) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(source),
        _ => File::create_new(&staged).map(|file| (staged, file)),
    }
}

/// Makes names durable; a system that cannot open a folder has its own way.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

fn fill(staging: &Path, folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Stopped> {
    files.par_iter().try_for_each(|(name, bytes)| {
        write_whole(&staging.join(name), bytes).map_err(at(&folder.join(name)))
    })?;
    sync_folder(staging).map_err(at(folder))
}

/// Gives a file or folder another name. On Windows a virus scanner may hold what was just written.
fn moved(from: &Path, to: &Path) -> io::Result<()> {
    const AGAIN: Duration = Duration::from_millis(50);
    let mut tries = if cfg!(windows) { 20 } else { 0 };
    loop {
        match fs::rename(from, to) {
            Err(held) if tries > 0 && held.kind() != io::ErrorKind::NotFound => std::thread::sleep(AGAIN),
            ended => return ended,
        }
        tries -= 1;
    }
}

/// A folder that was not there, complete from its first moment.
fn appear(parent: &Path, folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Stopped> {
    let staging = staging_in(parent).map_err(at(parent))?;
    fill(staging.path(), folder, files)?;
    moved(staging.path(), folder).map_err(at(folder))?;
    // The folder has its name; nothing is left to clear away.
    let _ = staging.keep();
    sync_folder(parent).map_err(at(parent))
}

/// Exchanges `folder` for a complete one that holds its other files too, under names of their own; `false`
/// where nothing was changed and another way must be found.
#[cfg(target_os = "linux")]
fn exchange(parent: &Path, folder: &Path, files: &[(String, Vec<u8>)]) -> io::Result<bool> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let Some(others) = others(folder, files)? else { return Ok(false) };
    let Ok(staging) = staging_in(parent) else { return Ok(false) };
    if !take_over_rights(folder, staging.path()) {
        return Ok(false);
    }
    fill(staging.path(), folder, files).map_err(|stopped| stopped.source)?;
    for name in others {
        if fs::hard_link(folder.join(&name), staging.path().join(&name)).is_err() {
            return Ok(false);
        }
    }
    sync_folder(staging.path())?;
    if renameat_with(CWD, staging.path(), CWD, folder, RenameFlags::EXCHANGE).is_err() {
        return Ok(false);
    }
    sync_folder(parent)?;
    // What somebody put into the folder in the meantime goes back to it.
    let is_swept = self::others(staging.path(), files)?.is_some_and(|late| {
        late.iter().all(|name| {
            let place = folder.join(name);
            fs::symlink_metadata(&place).is_ok() || fs::rename(staging.path().join(name), place).is_ok()
        })
    });
    if !is_swept {
        // It holds what cannot be put back: it stays where a person can find it.
        let _ = staging.keep();
    }
    Ok(true)
}

/// Names in `folder` that are not among `files`; `None` where it is no plain folder of a report.
#[cfg(target_os = "linux")]
fn others(folder: &Path, files: &[(String, Vec<u8>)]) -> io::Result<Option<Vec<std::ffi::OsString>>> {
    // Whoever stands in the folder would find himself in one that is gone.
    let is_here = fs::canonicalize(folder).ok() == fs::canonicalize(".").ok();
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        if files.iter().any(|(own, _)| name == own.as_str()) {
            continue;
        }
        if is_here || !entry.file_type()?.is_file() || names.len() >= MOST_ENTRIES {
            return Ok(None);
        }
        names.push(name);
    }
    Ok((!is_here).then_some(names))
}

/// Gives `staging` the owner and permissions of `folder`; `false` where that cannot be.
#[cfg(target_os = "linux")]
fn take_over_rights(folder: &Path, staging: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let (Ok(old), Ok(new)) = (fs::metadata(folder), fs::metadata(staging)) else { return false };
    (old.uid(), old.gid(), old.dev()) == (new.uid(), new.gid(), new.dev())
        && fs::set_permissions(staging, old.permissions()).is_ok()
}

/// Elsewhere no step exchanges two folders.
#[cfg(not(target_os = "linux"))]
#[allow(clippy::unnecessary_wraps, reason = "as where it may fail")]
fn exchange(_: &Path, _: &Path, _: &[(String, Vec<u8>)]) -> io::Result<bool> {
    Ok(false)
}

/// Stages the files in `folder` itself and moves each to its place.
fn move_one_by_one(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Stopped> {
    // Two ways may lead to the folder, through one parent each.
    let _turn = turn(folder);
    let unfinished = folder.join(UNFINISHED);
    settle(folder, &unfinished, files)?;
    let staging = staging_in(folder).map_err(at(folder))?;
    fill(staging.path(), folder, files)?;
    if cfg!(windows) {
        // One that another program has open would stop the moves in their middle.
        for (name, _) in files {
            match fs::OpenOptions::new().append(true).open(folder.join(name)) {
                Err(held) if held.kind() != io::ErrorKind::NotFound => {
                    return Err(at(&folder.join(name))(held));
                }
                _ => {}
            }
        }
    }
    // From here on every file is complete and a next run can end what this one began.
    moved(staging.path(), &unfinished).map_err(at(&unfinished))?;
    let _ = staging.keep();
    sync_folder(folder).map_err(at(folder))?;
    settle(folder, &unfinished, files)
}

/// Moves what is in `unfinished` to its places, if it is there.
fn settle(folder: &Path, unfinished: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Stopped> {
    if !fs::symlink_metadata(unfinished).is_ok_and(|there| there.is_dir()) {
        return Ok(());
    }
    let staged = fs::read_dir(unfinished).map_err(at(unfinished))?.flatten();
    let mut names: Vec<_> = staged.map(|entry| entry.file_name()).collect();
    // The JSON goes first: it marks the folder as this program's, should a later move fail.
    names.sort_by_key(|name| Path::new(name).extension().is_none_or(|ending| ending != "json"));
    for name in names {
        let target = folder.join(&name);
        // Of another set of files it is the newer one, unless somebody took the place in the meantime.
        if files.iter().any(|(own, _)| name == own.as_str()) || fs::symlink_metadata(&target).is_err() {
            moved(&unfinished.join(&name), &target).map_err(at(&target))?;
        }
    }
    fs::remove_dir(unfinished).map_err(at(unfinished))?;
    sync_folder(folder).map_err(at(folder))
}

#[cfg(test)]
mod tests;
