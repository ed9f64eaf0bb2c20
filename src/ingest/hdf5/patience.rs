//! A process to one that is ended where it is silent for too long: a share may hang, and not all systems limit processor time.

use std::io;
use std::process::{Child, ExitStatus};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::Thread;
use std::time::{Duration, Instant};

/// Longest silence beside the time that reading takes. A call that touches only names, shapes and attributes ends within milliseconds
/// from a disk, within a second from a share on a slow line.
pub(super) const PATIENCE: Duration = Duration::from_secs(20);
/// What the slowest medium in use gives, a stick on USB 1.1.
const SLOWEST_BYTES_PER_S: u64 = 1_000_000;

/// A process that is ended where it is silent for too long.
pub(super) struct Watched {
    shared: Arc<Shared>,
    watch: Thread,
}

/// What the reader and the watch know of the process.
struct Shared {
    child: Mutex<Child>,
    begun: Instant,
    /// When it counts as silent, ms after it began.
    silent_ms: AtomicU64,
    is_over: AtomicBool,
    was_silent: AtomicBool,
}

impl Shared {
    fn child(&self) -> MutexGuard<'_, Child> {
        self.child.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends the process when it was silent for too long, or the reader needs it no more.
    fn watch(&self) {
        while !self.is_over.load(Ordering::Acquire) {
            let silent = self.begun + Duration::from_millis(self.silent_ms.load(Ordering::Acquire));
            let left = silent.saturating_duration_since(Instant::now());
            if left.is_zero() {
                self.was_silent.store(true, Ordering::Release);
                break;
            }
            std::thread::park_timeout(left);
        }
        let mut child = self.child();
        let _ = child.kill();
        // Waiting for its end here keeps the reader from waiting.
        let _ = child.wait();
    }
}

impl Watched {
    pub(super) fn of(child: Child) -> Self {
        let shared = Arc::new(Shared {
            child: Mutex::new(child),
            begun: Instant::now(),
            silent_ms: AtomicU64::new(u64::try_from(PATIENCE.as_millis()).unwrap_or(u64::MAX)),
            is_over: AtomicBool::new(false),
            was_silent: AtomicBool::new(false),
        });
        let watched = Arc::clone(&shared);
        let watch = std::thread::spawn(move || watched.watch()).thread().clone();
        Self { shared, watch }
    }

    /// It may be silent for as long as reading `bytes` takes.
    pub(super) fn wait_for(&self, bytes: u64) {
        let allowed = PATIENCE + Duration::from_secs(bytes / SLOWEST_BYTES_PER_S);
        let silent_ms = (self.shared.begun.elapsed().saturating_add(allowed)).as_millis();
        self.shared.silent_ms.store(u64::try_from(silent_ms).unwrap_or(u64::MAX), Ordering::Release);
    }

    /// Ends it: how it ended by itself, and whether it was silent for too long.
    pub(super) fn end(self) -> (io::Result<ExitStatus>, bool) {
        let mut child = self.shared.child();
        // What was killed by the system is about to end; what is well waits for requests.
        let mut ended = child.try_wait();
        for _ in 0..50 {
            if !matches!(ended, Ok(None)) {
                break;
            }
            std::thread::sleep(Duration::from_millis(2));
            ended = child.try_wait();
        }
        let status = ended.ok().flatten().ok_or_else(|| io::ErrorKind::InvalidData.into());
        (status, self.shared.was_silent.load(Ordering::Acquire))
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Release);
        self.watch.unpark();
    }
}
