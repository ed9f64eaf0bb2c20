//! A process to one that is ended where it is silent for too long: a share may hang, and not all systems
//! limit processor time.

use std::cell::Cell;
use std::process::{Child, ExitStatus};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Longest silence beside the time that reading takes. A call that touches only names, shapes and attributes
/// ends within milliseconds from a disk, within a second from a share on a slow line.
pub(super) const PATIENCE: Duration = Duration::from_secs(20);
/// What the slowest medium in use gives, a stick on USB 1.1.
const SLOWEST_BYTES_PER_S: u64 = 1_000_000;
/// The watch hears of answers no more often than this: ten thousand come within a tenth of a second.
const SELDOM: Duration = Duration::from_secs(1);

/// A process that is ended where it is silent for too long, and where nobody holds this any more.
pub(super) struct Watched {
    /// How long it may be silent from now on; `None` while nothing is asked of it.
    allowed: Sender<Option<Duration>>,
    told: Cell<Option<Instant>>,
    watch: JoinHandle<ProcessEnd>,
}

/// How a process ended.
pub(super) enum ProcessEnd {
    /// It was silent for too long.
    Silent,
    /// By itself.
    With(ExitStatus),
    /// It was well.
    ByReader,
}

impl Watched {
    pub(super) fn of(child: Child) -> Self {
        let (allowed, heard) = channel();
        Self { allowed, told: Cell::new(None), watch: std::thread::spawn(move || watch(child, &heard)) }
    }

    /// It may be silent for as long as reading `bytes` takes.
    pub(super) fn wait_for(&self, bytes: u64) {
        if bytes > 0 || self.told.get().is_none_or(|told| told.elapsed() > SELDOM) {
            self.told.set(Some(Instant::now()));
            // It ended already where nobody hears this.
            let _ = self.allowed.send(Some(PATIENCE + Duration::from_secs(bytes / SLOWEST_BYTES_PER_S)));
        }
    }

    /// It has answered all that it was asked: it may be silent until the next request, however long the
    /// reader is busy.
    pub(super) fn rest(&self) {
        self.told.set(None);
        let _ = self.allowed.send(None);
    }

    /// Ends it.
    pub(super) fn end(self) -> ProcessEnd {
        drop(self.allowed);
        self.watch.join().unwrap_or(ProcessEnd::ByReader)
    }
}

/// Ends the process when it was silent for too long, or the reader needs it no more.
fn watch(mut child: Child, allowed: &Receiver<Option<Duration>>) -> ProcessEnd {
    #[cfg(windows)]
    let _job = super::job::that_ends(&child);
    let mut patience = Some(PATIENCE);
    let ended = loop {
        let heard = match patience {
            Some(patience) => allowed.recv_timeout(patience),
            None => allowed.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        match heard {
            Ok(next) => patience = next,
            Err(RecvTimeoutError::Timeout) => break ProcessEnd::Silent,
            Err(RecvTimeoutError::Disconnected) => break own_end(&mut child),
        }
    };
    let _ = child.kill();
    let _ = child.wait();
    ended
}

/// What was killed by the system is about to end; what is well waits for requests.
fn own_end(child: &mut Child) -> ProcessEnd {
    for _ in 0..50 {
        match child.try_wait() {
            Ok(None) => std::thread::sleep(Duration::from_millis(2)),
            Ok(Some(status)) => return ProcessEnd::With(status),
            Err(_) => break,
        }
    }
    ProcessEnd::ByReader
}
