//! The C library on a thread of its own, given up where it shows no sign of life: a damaged file can make it loop for ever.

use super::super::error::IngestError;
use super::Progress;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// Longest silence beside the time that reading takes. A call that touches only names, shapes and attributes ends within milliseconds
/// from a disk, within a second from a share on a slow line.
const PATIENCE: Duration = Duration::from_secs(20);
/// What the slowest medium in use gives, a stick on USB 1.1.
const SLOWEST_BYTES_PER_S: u64 = 1_000_000;

/// The file that the library never came back from. It keeps its lock, so that every later call in this process would wait for ever.
static LOST_IN: OnceLock<String> = OnceLock::new();

enum Sign {
    /// What follows reads so many bytes before the next sign.
    Alive { bytes: u64 },
    /// The fraction done.
    Done(f64),
}

/// Where the thread that calls the library says that it is alive.
pub(super) struct Signs(Sender<Sign>);

impl Signs {
    /// The last call came back; the next reads `bytes`.
    pub(super) fn alive(&self, bytes: u64) {
        // Nobody listens any more once the thread was given up.
        let _ = self.0.send(Sign::Alive { bytes });
    }

    /// As a [`Progress`].
    pub(super) fn done(&self, fraction: f64) {
        let _ = self.0.send(Sign::Done(fraction));
    }
}

/// What `work` makes of the HDF5 file at `path`.
///
/// # Errors
/// Those of `work`; a library that does not come back, now or from an earlier file.
pub(super) fn watched<T: Send + 'static>(
    path: &Path,
    progress: Progress,
    work: impl FnOnce(&Signs) -> Result<T, IngestError> + Send + 'static,
) -> Result<T, IngestError> {
    require_library(path)?;
    within(PATIENCE, progress, work).unwrap_or_else(|| {
        let _ = LOST_IN.set(path.display().to_string());
        Err(IngestError::Content {
            path: path.display().to_string(),
            place: "HDF5 file".into(),
            problem: format!(
                "the HDF5 library reads on and on in it and was given up after {} s: the file is damaged",
                PATIENCE.as_secs()
            ),
            mend: "copy it from the logger again".into(),
        })
    })
}

/// Whether HDF5 can still be read and written in this process.
///
/// # Errors
/// The library did not come back from an earlier file.
pub(in super::super) fn require_library(path: &Path) -> Result<(), IngestError> {
    LOST_IN.get().map_or(Ok(()), |earlier| {
        Err(IngestError::Content {
            path: path.display().to_string(),
            place: "not read".into(),
            problem: format!("the HDF5 library did not come back from {earlier}, which is damaged"),
            mend: "run dropcheck again without that file".into(),
        })
    })
}

/// What `work` comes to on a thread of its own; `None` where it is silent for longer than `patience` and the bytes it reads allow. Its
/// thread then goes on alone: there is no way to stop it but to end the process.
fn within<T: Send + 'static>(
    patience: Duration,
    progress: Progress,
    work: impl FnOnce(&Signs) -> T + Send + 'static,
) -> Option<T> {
    let (sender, receiver) = channel();
    let worker = std::thread::spawn(move || work(&Signs(sender)));
    let mut allowed = patience;
    loop {
        match receiver.recv_timeout(allowed) {
            Ok(Sign::Alive { bytes }) => {
                allowed = patience.saturating_add(Duration::from_secs(bytes / SLOWEST_BYTES_PER_S));
            }
            Ok(Sign::Done(fraction)) => progress(fraction),
            Err(RecvTimeoutError::Timeout) => return None,
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    Some(worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::Mutex;
    use std::thread::sleep;

    const SHORT: Duration = Duration::from_millis(200);

    #[test]
    fn work_that_shows_signs_may_take_any_time() {
        let seen = Mutex::new(Vec::new());
        let answer = within(SHORT, &|fraction| seen.lock().expect("no panic").push(fraction), |signs| {
            for tenth in 1..=10 {
                sleep(SHORT / 5);
                signs.alive(0);
                signs.done(f64::from(tenth) / 10.0);
            }
            "whole"
        });
        assert_eq!(answer, Some("whole"));
        assert_eq!(seen.lock().expect("no panic").len(), 10);
    }

    #[test]
    fn work_that_falls_silent_is_given_up() {
        let answer = within(SHORT, &|_| {}, |signs| {
            signs.alive(0);
            sleep(SHORT * 5);
        });
        assert_eq!(answer, None);
    }

    #[test]
    fn reading_much_may_take_its_time() {
        let answer = within(SHORT, &|_| {}, |signs| {
            signs.alive(3 * SLOWEST_BYTES_PER_S);
            sleep(SHORT * 3);
        });
        assert_eq!(answer, Some(()));
    }

    #[test]
    fn a_panic_of_the_work_goes_on_here() {
        let answer = catch_unwind(AssertUnwindSafe(|| within(PATIENCE, &|_| {}, |_| panic!("in the work"))));
        assert_eq!(*answer.unwrap_err().downcast::<&str>().unwrap(), "in the work");
    }
}
