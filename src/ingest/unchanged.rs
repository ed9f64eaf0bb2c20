//! A recording, a file or a folder of files, to what is read of it, with the SHA-256 of the very bytes that
//! were read.

use super::RecordingFile;
use super::error::{self, IngestError};
use super::mme::MmeFiles;
use super::refusal::Refusal;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::fs::Metadata;
use std::io::Read;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

/// A change leaves the times of a file as they were where the one before lies less than a tick of the
/// system's clock back: ten milliseconds at most. As git does for its index, a file is looked at when its
/// times are older than that.
const TICKS: Duration = Duration::from_millis(20);
/// A file whose times are young at each of so many looks, one second long, is being written.
const MOST_LOOKS: usize = 50;

/// What `read` makes of a recording, and its SHA-256, which is taken beside it.
///
/// # Errors
/// What `read` says, at once; [`IngestError::Refused`] where the file was not the same all the time.
pub(super) fn hashed<T>(
    recording: RecordingFile,
    read: impl FnOnce() -> Result<T, IngestError>,
) -> Result<(T, String), IngestError> {
    let path = recording.path;
    if recording.in_memory.is_some() {
        return Ok((read()?, sha256(recording, &AtomicBool::new(false))?));
    }
    let before = at_rest(path)?;
    let is_needless = AtomicBool::new(false);
    let (read, sha256) = std::thread::scope(|scope| {
        let hashing = scope.spawn(|| sha256(recording, &is_needless));
        let read = read();
        is_needless.store(read.is_err(), Ordering::Relaxed);
        (read, hashing.join())
    });
    let sha256 = sha256.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    // A file that is rewritten may well make no sense: that it is comes first.
    if look(path)?.identities != before {
        return Err(changed(path));
    }
    Ok((read?, sha256?))
}

fn changed(path: &Path) -> IngestError {
    let refusal = Refusal::new(
        "it changed while it was being read",
        "copy it first and name the copy, or wait until it is written",
    );
    error::of_file(path, refusal.at("the whole recording"))
}

/// What tells a file from itself at another time.
#[cfg(unix)]
type Identity = (u64, u64, u64, (i64, i64), (i64, i64));
#[cfg(not(unix))]
type Identity = (u64, Option<SystemTime>);

/// Device, number, length, and the times of the last change of content and of anything; with the later of the
/// two times.
#[cfg(unix)]
fn identity(file: &Metadata) -> (Identity, Option<SystemTime>) {
    use std::os::unix::fs::MetadataExt;
    let [content, anything] = [(file.mtime(), file.mtime_nsec()), (file.ctime(), file.ctime_nsec())];
    let (seconds, nanoseconds) = content.max(anything);
    let since = |(seconds, nanoseconds): (i64, i64)| {
        Some(Duration::new(u64::try_from(seconds).ok()?, u32::try_from(nanoseconds).ok()?))
    };
    let latest = since((seconds, nanoseconds)).and_then(|since| SystemTime::UNIX_EPOCH.checked_add(since));
    ((file.dev(), file.ino(), file.len(), content, anything), latest)
}

/// Length and the time of the last change.
#[cfg(not(unix))]
fn identity(file: &Metadata) -> (Identity, Option<SystemTime>) {
    let modified = file.modified().ok();
    ((file.len(), modified), modified)
}

/// A recording's files at one moment.
struct FilesState {
    /// Of each.
    identities: Vec<Identity>,
    /// When the last of them was changed.
    latest: Option<SystemTime>,
}

fn look(path: &Path) -> Result<FilesState, IngestError> {
    let mut look = FilesState { identities: Vec::new(), latest: None };
    let names = names(path)?;
    for place in names
        .map_or_else(|| vec![path.to_owned()], |names| names.iter().map(|name| path.join(name)).collect())
    {
        let file = std::fs::metadata(&place).map_err(|source| error::io(&place, &source))?;
        let (identity, latest) = identity(&file);
        look.identities.push(identity);
        look.latest = look.latest.max(latest);
    }
    Ok(look)
}

/// The names of the files of a recording that is a folder; `None` where it is a file itself.
fn names(path: &Path) -> Result<Option<Vec<String>>, IngestError> {
    let found = if path.is_dir() { MmeFiles::of(path.into())? } else { None };
    Ok(found.map(|found| found.names().cloned().collect()))
}

/// The identities of a recording's files, looked at when a later change must show.
fn at_rest(path: &Path) -> Result<Vec<Identity>, IngestError> {
    for _ in 0..MOST_LOOKS {
        let FilesState { identities, latest } = look(path)?;
        // A time to come is another clock's, and no tick of this one's.
        match latest.and_then(|latest| latest.elapsed().ok()).and_then(|age| TICKS.checked_sub(age)) {
            Some(wait) if !wait.is_zero() => std::thread::sleep(wait),
            _ => return Ok(identities),
        }
    }
    Err(changed(path))
}

/// SHA-256 of a recording, lower-case hexadecimal, or of its beginning where it `is_needless` in
/// the end: of a file its own; of a folder that of the list of its files which `sha256sum` prints.
///
/// # Errors
/// [`IngestError::Refused`] where it cannot be read.
pub(super) fn sha256(recording: RecordingFile, is_needless: &AtomicBool) -> Result<String, IngestError> {
    let names = if recording.is_folder() { names(recording.path)? } else { None };
    let Some(names) = names else { return sha256_of_file(recording, is_needless) };
    let of_file = |name: &String| sha256_of_file((&recording.path.join(name)).into(), is_needless);
    let hashed = |name: &String| Ok(format!("{}  {name}\n", of_file(name)?));
    let lines = names.par_iter().map(hashed).collect::<Result<Vec<String>, IngestError>>()?;
    Ok(hexadecimal(&Sha256::digest(lines.concat())))
}

fn sha256_of_file(file: RecordingFile, is_needless: &AtomicBool) -> Result<String, IngestError> {
    let io = |source| error::io(file.path, &source);
    let mut file = file.opened().map_err(io)?;
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    while !is_needless.load(Ordering::Relaxed) {
        let read = file.read(&mut buffer).map_err(io)?;
        if read == 0 {
            break;
        }
        hasher.update(&buffer[..read]);
    }
    Ok(hexadecimal(&hasher.finalize()))
}

/// A hash as results have it, lower-case hexadecimal.
#[must_use]
pub fn hexadecimal(hash: &[u8]) -> String {
    hash.iter().fold(String::with_capacity(64), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::time::Instant;

    #[test]
    fn sha256_is_the_published_one_of_abc() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("abc");
        fs::write(&path, "abc").unwrap();
        // FIPS 180-4, example B.1.
        assert_eq!(
            sha256((&path).into(), &AtomicBool::new(false)).unwrap(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }

    #[test]
    fn a_refusal_does_not_wait_for_the_hash() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("sparse");
        // Two hundred gigabytes take several minutes to hash.
        fs::File::create(&path).unwrap().set_len(200 << 30).unwrap();
        let begun = Instant::now();
        let refused =
            hashed(path.as_path().into(), || Err::<(), _>(changed(Path::new("refused")))).unwrap_err();
        assert!(refused.to_string().starts_with("refused"), "{refused}");
        assert!(begun.elapsed() < Duration::from_mins(1));
    }

    #[test]
    fn a_file_that_is_rewritten_is_refused_or_hashed_as_it_was_read() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("rewritten");
        let content = [vec![b'a'; 1 << 20], vec![b'b'; 1 << 20]];
        fs::write(&path, &content[0]).unwrap();
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                // Pauses of 0 to 40 ms: shorter and longer than what a look waits for.
                for round in (0_u64..).take_while(|_| !is_over.load(Ordering::Relaxed)) {
                    fs::write(&path, &content[usize::from(round % 2 == 0)]).unwrap();
                    std::thread::sleep(Duration::from_millis(round * 7 % 41));
                }
            });
            for round in 0..40 {
                let read = || {
                    std::thread::sleep(Duration::from_millis(round * 3 % 17));
                    fs::read(&path).map_err(|source| error::io(&path, &source))
                };
                match hashed(path.as_path().into(), read) {
                    Ok((bytes, found)) => assert_eq!(found, hexadecimal(&Sha256::digest(&bytes))),
                    Err(error) => assert!(error.to_string().contains("changed while"), "{error}"),
                }
            }
            is_over.store(true, Ordering::Relaxed);
        });
        // As long as before, and within a tick of the clock of the first look.
        let refused = hashed(path.as_path().into(), || {
            fs::write(&path, &content[0]).unwrap();
            Ok(())
        });
        assert!(refused.unwrap_err().to_string().contains("changed while"));
        assert_eq!(hashed(path.as_path().into(), || Ok(())).map(|found| found.1.len()).unwrap(), 64);
    }
}
