//! Writes a set of finished files into a folder: all of them or none, even if interrupted, and without
//! touching files of others.

use rayon::prelude::*;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Prefix of the temporary folders that the program creates beside and in a report; none outlives an
/// undisturbed run.
pub const TEMP_PREFIX: &str = ".dropcheck-";
/// Folder of complete files that were being moved to their places when the run was stopped.
const UNFINISHED: &str = ".dropcheck-unfinished";
/// A folder with more other entries belongs to a person, not to a report, and is not exchanged as a whole.
#[cfg(target_os = "linux")]
const MOST_ENTRIES: usize = 256;

/// Path at which a write stopped, and the reason.
#[derive(Debug)]
pub struct StoppedWrite {
    pub path: PathBuf,
    pub source: io::Error,
}

fn stop_at(path: &Path) -> impl FnOnce(io::Error) -> StoppedWrite + '_ {
    move |source| StoppedWrite { path: path.to_path_buf(), source }
}

/// Writes `files` to `folder`, which need not exist.
///
/// A folder with plain files only is exchanged for a complete one in a single step of the file system. If
/// that is impossible, complete files are moved one by one; if a run is stopped between two of them, the next
/// run moves the others.
pub fn replace_set(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), StoppedWrite> {
    // "." has no parent by its name, and would wait for its own lock.
    let folder = &std::path::absolute(folder).map_err(stop_at(folder))?;
    let parent = parent_of(folder);
    fs::create_dir_all(parent).map_err(stop_at(parent))?;
    let lock = lock_folder(parent);
    let clear_leftovers = |place: &Path| lock.iter().for_each(|_| clear_leftovers(place, files));
    clear_leftovers(parent);
    match fs::symlink_metadata(folder) {
        Err(_) => return create_complete(parent, folder, files),
        Ok(there) if !there.is_dir() => {
            return Err(stop_at(folder)(io::Error::other("a link or a file has taken the folder's place")));
        }
        Ok(_) => clear_leftovers(folder),
    }
    if exchange(parent, folder, files).map_err(stop_at(folder))? {
        return Ok(());
    }
    move_one_by_one(folder, files)
}

/// Returns the folder that contains `path`.
pub fn parent_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Locks a folder, if its file system supports locks: one run at a time writes below it.
fn lock_folder(parent: &Path) -> Option<File> {
    File::open(parent).ok().filter(|folder| folder.lock().is_ok())
}

/// Removes the leftovers of a killed run in `parent`: while this run holds the lock, no other works there.
fn clear_leftovers(parent: &Path, files: &[(String, Vec<u8>)]) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_own = name.to_string_lossy().starts_with(TEMP_PREFIX) && name != UNFINISHED;
        if is_own && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            remove_leftover(&entry.path(), files);
        } else if is_own && entry.metadata().is_ok_and(|there| there.is_file() && there.len() == 0) {
            // This file only tested whether the folder is writable.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Removes a leftover folder, with those of its files that this program wrote or that still have a name
/// elsewhere.
fn remove_leftover(leftover: &Path, files: &[(String, Vec<u8>)]) {
    for entry in fs::read_dir(leftover).into_iter().flatten().flatten() {
        let is_own = files.iter().any(|(name, _)| entry.file_name() == name.as_str());
        if is_own || entry.metadata().is_ok_and(|metadata| has_other_name(&metadata)) {
            let _ = fs::remove_file(entry.path());
        }
    }
    // The system refuses this if the folder is not empty.
    let _ = fs::remove_dir(leftover);
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

/// Creates a folder that vanishes unless it is moved, beside the final place of its content.
pub fn create_staging(folder: &Path) -> io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMP_PREFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The permissions are those of any new folder: the process's mask restricts them.
        builder.permissions(fs::Permissions::from_mode(0o777));
    }
    builder.tempdir_in(folder)
}

/// Writes a new file down to the disk; fails if it exists.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    use std::io::Write;
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Creates a file beside `path` to be filled and renamed: always under the same name, so that it replaces the
/// leftover of a killed run.
pub fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let staged = parent_of(path).join(format!("{TEMP_PREFIX}{name}"));
    match fs::remove_file(&staged) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(source),
        _ => File::create_new(&staged).map(|file| (staged, file)),
    }
}

/// Makes new names in a folder durable; systems other than Unix cannot open a folder for it and do so
/// themselves.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

fn write_all_files(staging: &Path, folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), StoppedWrite> {
    files.par_iter().try_for_each(|(name, bytes)| {
        write_whole(&staging.join(name), bytes).map_err(stop_at(&folder.join(name)))
    })?;
    sync_folder(staging).map_err(stop_at(folder))
}

/// Renames a file or folder; repeats that on Windows, where a virus scanner may hold new files.
fn rename(from: &Path, to: &Path) -> io::Result<()> {
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

/// Creates the folder complete from its first moment.
fn create_complete(parent: &Path, folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), StoppedWrite> {
    let staging = create_staging(parent).map_err(stop_at(parent))?;
    write_all_files(staging.path(), folder, files)?;
    rename(staging.path(), folder).map_err(stop_at(folder))?;
    // The folder has been renamed; nothing remains to be removed.
    let _ = staging.keep();
    sync_folder(parent).map_err(stop_at(parent))
}

/// Exchanges `folder` for a complete one that also holds its other files under their names; `false` if
/// nothing was changed and another way is needed.
#[cfg(target_os = "linux")]
fn exchange(parent: &Path, folder: &Path, files: &[(String, Vec<u8>)]) -> io::Result<bool> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let Some(others) = other_names(folder, files)? else { return Ok(false) };
    let Ok(staging) = create_staging(parent) else { return Ok(false) };
    if !copy_rights(folder, staging.path()) {
        return Ok(false);
    }
    write_all_files(staging.path(), folder, files).map_err(|stopped| stopped.source)?;
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
    // Files that appeared in the folder in the meantime are moved back to it.
    let is_emptied = other_names(staging.path(), files)?.is_some_and(|late| {
        late.iter().all(|name| {
            let place = folder.join(name);
            fs::symlink_metadata(&place).is_ok() || fs::rename(staging.path().join(name), place).is_ok()
        })
    });
    if !is_emptied {
        // It still holds files that cannot be moved back: it stays where a person can find it.
        let _ = staging.keep();
    }
    Ok(true)
}

/// Lists the names in `folder` that are not among `files`; `None` if it is no plain folder of a report.
#[cfg(target_os = "linux")]
fn other_names(folder: &Path, files: &[(String, Vec<u8>)]) -> io::Result<Option<Vec<std::ffi::OsString>>> {
    // A shell in this folder would be left in one that no longer exists.
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

/// Gives `staging` the owner and permissions of `folder`; `false` if that is impossible.
#[cfg(target_os = "linux")]
fn copy_rights(folder: &Path, staging: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let (Ok(old), Ok(new)) = (fs::metadata(folder), fs::metadata(staging)) else { return false };
    (old.uid(), old.gid(), old.dev()) == (new.uid(), new.gid(), new.dev())
        && fs::set_permissions(staging, old.permissions()).is_ok()
}

/// Other systems cannot exchange two folders in one step.
#[cfg(not(target_os = "linux"))]
#[allow(clippy::unnecessary_wraps, reason = "as where it may fail")]
fn exchange(_: &Path, _: &Path, _: &[(String, Vec<u8>)]) -> io::Result<bool> {
    Ok(false)
}

/// Writes the files in `folder` itself and moves each to its place.
fn move_one_by_one(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), StoppedWrite> {
    // Two paths may lead to the folder, each through another parent.
    let _lock = lock_folder(folder);
    let unfinished = folder.join(UNFINISHED);
    finish_moves(folder, &unfinished, files)?;
    let staging = create_staging(folder).map_err(stop_at(folder))?;
    write_all_files(staging.path(), folder, files)?;
    if cfg!(windows) {
        // A file that another program has open would stop the moves halfway.
        for (name, _) in files {
            match fs::OpenOptions::new().append(true).open(folder.join(name)) {
                Err(held) if held.kind() != io::ErrorKind::NotFound => {
                    return Err(stop_at(&folder.join(name))(held));
                }
                _ => {}
            }
        }
    }
    // From here on every file is complete, and a next run can finish the moves.
    rename(staging.path(), &unfinished).map_err(stop_at(&unfinished))?;
    let _ = staging.keep();
    sync_folder(folder).map_err(stop_at(folder))?;
    finish_moves(folder, &unfinished, files)
}

/// Moves the files in `unfinished` to their places, if that folder exists.
fn finish_moves(folder: &Path, unfinished: &Path, files: &[(String, Vec<u8>)]) -> Result<(), StoppedWrite> {
    if !fs::symlink_metadata(unfinished).is_ok_and(|there| there.is_dir()) {
        return Ok(());
    }
    let staged = fs::read_dir(unfinished).map_err(stop_at(unfinished))?.flatten();
    let mut names: Vec<_> = staged.map(|entry| entry.file_name()).collect();
    // The JSON is moved first: it marks the folder as this program's if a later move fails.
    names.sort_by_key(|name| Path::new(name).extension().is_none_or(|ending| ending != "json"));
    for name in names {
        let target = folder.join(&name);
        // A file of another set is newer than the one in place, unless somebody created that in the meantime.
        if files.iter().any(|(own, _)| name == own.as_str()) || fs::symlink_metadata(&target).is_err() {
            rename(&unfinished.join(&name), &target).map_err(stop_at(&target))?;
        }
    }
    fs::remove_dir(unfinished).map_err(stop_at(unfinished))?;
    sync_folder(folder).map_err(stop_at(folder))
}

#[cfg(test)]
mod tests;
