//! A process to one that is ended where it is silent for too long: a share may hang, and not all systems limit processor time.

use std::io;
use std::process::{Child, ExitStatus};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Longest silence beside the time that reading takes. A call that touches only names, shapes and attributes ends within milliseconds
/// from a disk, within a second from a share on a slow line.
pub(super) const PATIENCE: Duration = Duration::from_secs(20);
/// What the slowest medium in use gives, a stick on USB 1.1.
const SLOWEST_BYTES_PER_S: u64 = 1_000_000;

/// A process that is ended where it is silent for too long.
pub(super) struct Watched {
    child: Arc<Mutex<Child>>,
    begun: Instant,
    /// When it counts as silent, ms after it began.
    silent_ms: Arc<AtomicU64>,
    is_over: Arc<AtomicBool>,
    was_silent: Arc<AtomicBool>,
    watch: Option<JoinHandle<()>>,
}

impl Watched {
    pub(super) fn of(child: Child) -> Self {
        let begun = Instant::now();
        let patience_ms = u64::try_from(PATIENCE.as_millis()).unwrap_or(u64::MAX);
        let mut watched = Self {
            child: Arc::new(Mutex::new(child)),
            begun,
            silent_ms: Arc::new(AtomicU64::new(patience_ms)),
            is_over: Arc::default(),
            was_silent: Arc::default(),
            watch: None,
        };
        let [is_over, was_silent] = [&watched.is_over, &watched.was_silent].map(Arc::clone);
        let (child, silent_ms) = (Arc::clone(&watched.child), Arc::clone(&watched.silent_ms));
        watched.watch = Some(std::thread::spawn(move || {
            while !is_over.load(Ordering::Acquire) {
                let silent = begun + Duration::from_millis(silent_ms.load(Ordering::Acquire));
                let left = silent.saturating_duration_since(Instant::now());
                if left.is_zero() {
                    was_silent.store(true, Ordering::Release);
                    break;
                }
                std::thread::park_timeout(left);
            }
            let mut child = child.lock().unwrap_or_else(PoisonError::into_inner);
            let _ = child.kill();
            // Waiting for its end here keeps the reader from waiting.
            let _ = child.wait();
        }));
        watched
    }

    /// It may be silent for as long as reading `bytes` takes.
    pub(super) fn wait_for(&self, bytes: u64) {
        let allowed = PATIENCE + Duration::from_secs(bytes / SLOWEST_BYTES_PER_S);
        let silent_ms = (self.begun.elapsed().saturating_add(allowed)).as_millis();
        self.silent_ms.store(u64::try_from(silent_ms).unwrap_or(u64::MAX), Ordering::Release);
    }

    /// Ends it: how it ended by itself, and whether it was silent for too long.
    pub(super) fn end(self) -> (io::Result<ExitStatus>, bool) {
        let mut child = self.child.lock().unwrap_or_else(PoisonError::into_inner);
        // What was killed by the system is about to end; what is well waits for requests.
        let mut ended = child.try_wait();
        for _ in 0..50 {
            if !matches!(ended, Ok(None)) {
                break;
            }
            std::thread::sleep(Duration::from_millis(2));
            ended = child.try_wait();
        }
        let status = match ended {
            Ok(Some(status)) => Ok(status),
            _ => Err(io::ErrorKind::InvalidData.into()),
        };
        (status, self.was_silent.load(Ordering::Acquire))
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Release);
        if let Some(watch) = self.watch.take() {
            watch.thread().unpark();
        }
    }
}
