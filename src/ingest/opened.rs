//! A path to the open file there: no pipe or device, which may never end, and no folder.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The file at `path`, open for reading.
///
/// # Errors
/// It is no file, or may not be read.
pub fn opened(path: &Path) -> io::Result<File> {
    // Asked before opening, which would wait for a pipe's writer.
    match std::fs::metadata(path)? {
        there if there.is_file() => File::open(path),
        there if there.is_dir() => Err(io::Error::other("this is a directory, not a file")),
        _ => Err(io::Error::other("this is a pipe or a device, not a file; save it to a file first")),
    }
}

/// All bytes of a small file.
///
/// # Errors
/// As [`opened`], and where it has more than so many MiB.
pub fn bytes_of(path: &Path, most_mib: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // A file may grow while it is read.
    if opened(path)?.take((most_mib << 20) + 1).read_to_end(&mut bytes)? as u64 > most_mib << 20 {
        return Err(io::Error::other(format!("it has more than {most_mib} MiB")));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_file_of_so_many_bytes_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, vec![7; 1 << 20]).unwrap();
        assert_eq!(bytes_of(&path, 1).unwrap().len(), 1 << 20);
        std::fs::write(&path, vec![7; (1 << 20) + 1]).unwrap();
        assert!(bytes_of(&path, 1).unwrap_err().to_string().contains("more than 1 MiB"));
        assert!(bytes_of(folder.path(), 1).unwrap_err().to_string().contains("directory"));
        #[cfg(unix)]
        assert!(opened(Path::new("/dev/zero")).unwrap_err().to_string().contains("device"));
    }
}
