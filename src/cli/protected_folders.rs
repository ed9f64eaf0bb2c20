//! Recognises folders of the system and the user's home, in which no report belongs.

use std::path::Path;

/// Folders that hold nothing but the system's own files.
const SYSTEM_FOLDERS: &str =
    "/bin /boot /dev/block /etc /lib /lib32 /lib64 /proc /sbin /sys /usr /Applications /Library /System";
/// Environment variables of Windows that name such folders.
const WINDOWS_VARIABLES: [&str; 3] = ["SystemRoot", "ProgramFiles", "ProgramFiles(x86)"];
/// Folders that only hold other folders: a report may go into one below.
const PARENT_FOLDERS: &str = "/dev /home /media /mnt /opt /root /run /srv /var /usr/local /Users";

/// True if the files of a report in `folder`, which exists, would mix with those of the system or lie loosely
/// in the user's home.
pub fn is_protected(folder: &Path) -> bool {
    let Ok(real) = folder.canonicalize() else { return false };
    let home = std::env::home_dir().and_then(|home| home.canonicalize().ok());
    let is_in = |variable: &&str| {
        let place = std::env::var_os(variable).filter(|_| cfg!(windows));
        place
            .and_then(|place| Path::new(&place).canonicalize().ok())
            .is_some_and(|place| real.starts_with(place))
    };
    real.parent().is_none()
        || home.is_some_and(|home| home == real || cfg!(windows) && home.parent() == Some(&real))
        || WINDOWS_VARIABLES.iter().any(is_in)
        || PARENT_FOLDERS.split(' ').any(|place| real == Path::new(place))
        || SYSTEM_FOLDERS.split(' ').any(|place| real.starts_with(place)) && !real.starts_with("/usr/local")
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn systems_folders_are_protected_and_a_folder_of_its_own_is_not() {
        for folder in ["/", "/usr", "/usr/bin", "/etc", "/bin", "/usr/bin/..", "/dev", "/home", "/var"] {
            assert!(!Path::new(folder).exists() || is_protected(Path::new(folder)), "{folder}");
        }
        assert!(std::env::home_dir().is_none_or(|home| !home.exists() || is_protected(&home)));
        let own = tempfile::tempdir().unwrap();
        assert!(!is_protected(own.path()) && !is_protected(&own.path().join("none")));
    }
}
