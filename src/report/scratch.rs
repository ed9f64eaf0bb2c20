//! A folder in the system's temporary one for a file on its way to bytes; what killed runs left there is
//! cleared away.

use std::fs;
use std::path::Path;
use std::sync::Once;
use std::time::Duration;
use tempfile::TempDir;

/// What the folders' names begin with; six letters and digits follow.
const PREFIX: &str = "dropcheck-";
/// The only file in them.
pub(super) const FILE_NAME: &str = "curves.h5";
/// No run needs its folder for a day: an older one is nobody's any more.
const STALE: Duration = Duration::from_hours(24);

/// A folder that vanishes with its value.
///
/// # Errors
/// The system's, where the temporary folder takes none.
pub(super) fn folder() -> std::io::Result<TempDir> {
    static CLEARED: Once = Once::new();
    let folder = tempfile::Builder::new().prefix(PREFIX).tempdir()?;
    CLEARED.call_once(|| clear(folder.path(), STALE));
    Ok(folder)
}

/// Removes the folders beside `own` that are of the same owner, no links, not touched for so long, and hold
/// nothing but the file.
fn clear(own: &Path, stale: Duration) {
    let (Some(place), Ok(mine)) = (own.parent(), fs::symlink_metadata(own)) else { return };
    for entry in fs::read_dir(place).into_iter().flatten().flatten() {
        let name = entry.file_name().into_string().unwrap_or_default();
        let is_named_so = name
            .strip_prefix(PREFIX)
            .is_some_and(|rest| rest.len() == 6 && rest.bytes().all(|byte| byte.is_ascii_alphanumeric()));
        let is_stale = |there: &fs::Metadata| {
            let age = there.modified().ok().and_then(|modified| modified.elapsed().ok());
            there.is_dir() && has_owner_of(there, &mine) && age.is_some_and(|age| age >= stale)
        };
        if is_named_so && entry.path() != own && entry.metadata().is_ok_and(|there| is_stale(&there)) {
            // Of a file that is a link the link goes; a folder that holds more stays.
            let _ = fs::remove_file(entry.path().join(FILE_NAME));
            let _ = fs::remove_dir(entry.path());
        }
    }
}

#[cfg(unix)]
fn has_owner_of(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    one.uid() == other.uid()
}

/// Each user has a temporary folder of his own.
#[cfg(not(unix))]
fn has_owner_of(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    true
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    #[test]
    fn only_old_folders_of_this_name_are_cleared() {
        let place = tempfile::tempdir().unwrap();
        let made = |name: &str, file: &str| {
            fs::create_dir(place.path().join(name)).unwrap();
            fs::write(place.path().join(name).join(file), "x").unwrap();
        };
        made("dropcheck-aB3xY9", FILE_NAME);
        made("dropcheck-aB3xY8", "theirs");
        made("dropcheck-results", FILE_NAME);
        made("elsewhere", FILE_NAME);
        std::os::unix::fs::symlink(place.path().join("elsewhere"), place.path().join("dropcheck-aB3xY7"))
            .unwrap();
        let own = place.path().join("dropcheck-aB3xY6");
        fs::create_dir(&own).unwrap();
        let left = || {
            let mut names: Vec<String> = fs::read_dir(place.path())
                .unwrap()
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names.len()
        };
        clear(&own, STALE);
        assert_eq!(left(), 6, "younger than a day");
        clear(&own, Duration::ZERO);
        assert_eq!(left(), 5);
        assert!(!place.path().join("dropcheck-aB3xY9").exists());
        assert!(place.path().join("elsewhere").join(FILE_NAME).exists());
    }
}
