//! Where the bytes of a recording lie, on disk or in memory, to something that reads and seeks.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// A file, or a folder of files, on disk; or a file in memory, which messages call `path`.
#[derive(Clone, Copy)]
pub struct RecordingFile<'a> {
    pub(super) path: &'a Path,
    pub(super) in_memory: Option<&'a Arc<[u8]>>,
}

impl<'a, P: AsRef<Path> + ?Sized> From<&'a P> for RecordingFile<'a> {
    fn from(path: &'a P) -> Self {
        Self { path: path.as_ref(), in_memory: None }
    }
}

impl<'a> RecordingFile<'a> {
    /// A file that is not on disk.
    #[must_use]
    pub fn in_memory(name: &'a Path, bytes: &'a Arc<[u8]>) -> Self {
        Self { path: name, in_memory: Some(bytes) }
    }

    /// Opens it for reading.
    ///
    /// # Errors
    /// It is no file, or may not be read.
    pub(super) fn opened(self) -> io::Result<OpenFile> {
        Ok(match self.in_memory {
            Some(bytes) => Box::new(Cursor::new(bytes.clone())),
            None => Box::new(opened(self.path)?),
        })
    }

    /// Its length, bytes.
    ///
    /// # Errors
    /// It is not there.
    pub(super) fn length(self) -> io::Result<u64> {
        self.in_memory.map_or_else(|| Ok(std::fs::metadata(self.path)?.len()), |bytes| Ok(bytes.len() as u64))
    }

    /// Whether it is a folder.
    pub(super) fn is_folder(self) -> bool {
        self.in_memory.is_none() && self.path.is_dir()
    }
}

/// What reads and seeks.
pub(super) trait ReadSeek: Read + Seek + Send {}
impl<T: Read + Seek + Send> ReadSeek for T {}

/// A file that is open for reading.
pub(super) type OpenFile = Box<dyn ReadSeek>;

/// The file at `path`, open for reading: no pipe or device, which may never end, and no folder.
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

/// So many bytes from there on, or those up to the end.
pub(super) fn bytes_at(file: &mut OpenFile, at: u64, count: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(at))?;
    file.take(count).read_to_end(&mut bytes)?;
    Ok(bytes)
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
    use crate::ingest::{Limits, list_within};

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
    #[test]
    fn a_file_in_memory_is_listed_as_on_disk() {
        let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/examples");
        for name in ["anf10-protobuf.mcap", "esbb-imu.mcap", "anf10-plain.csv"] {
            let path = examples.join(name);
            let bytes: Arc<[u8]> = std::fs::read(&path).unwrap().into();
            let [on_disk, in_memory] = [RecordingFile::from(&path), RecordingFile::in_memory(&path, &bytes)]
                .map(|file| list_within(file, Limits::default(), &|_| ()).unwrap());
            assert!(!on_disk.channels.is_empty() && in_memory == on_disk, "{name}");
        }
    }
}
