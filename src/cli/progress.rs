//! Shows the progress of long work: as a bar on standard error if that is a terminal, else as a line now and
//! then.

use super::output::{is_quiet, note};
use crate::ingest::Progress;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Parts of the bar; finer than a terminal shows.
const PARTS: u32 = 1000;

/// Work shorter than this needs no line in a log.
const SHORT_WORK: Duration = Duration::from_secs(3);

/// Creates a bar of `parts`, hidden in quiet mode.
fn bar(parts: u64) -> ProgressBar {
    if is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(parts) }
}

/// True if progress goes to a log, line by line.
fn is_log() -> bool {
    !is_quiet() && !std::io::stderr().is_terminal()
}

/// Runs `work`, which reports its progress from 0 to 1, beside a bar; without a terminal, long work gets a
/// line for each tenth.
pub fn with_progress<T>(what: &str, work: impl FnOnce(Progress) -> T) -> T {
    let bar = bar(u64::from(PARTS));
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent} %") {
        bar.set_style(style);
    }
    bar.set_message(crate::report::sanitize(what));
    let in_log = is_log();
    let last_tenth = AtomicU64::new(0);
    let result = work(&|fraction: f64| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 1000")]
        let parts = (fraction.clamp(0.0, 1.0) * f64::from(PARTS)) as u64;
        bar.set_position(parts);
        let tenth = 10 * parts / u64::from(PARTS);
        if in_log && bar.elapsed() > SHORT_WORK && last_tenth.fetch_max(tenth, Ordering::Relaxed) < tenth {
            note(&format!("{what}: {} %", 10 * tenth));
        }
    });
    bar.finish_and_clear();
    result
}

/// Time between two lines in a log.
const LOG_INTERVAL: Duration = Duration::from_secs(10);

/// Progress as "12 of 60, 3 minutes left" on standard error: a bar on a terminal, a line now and then in a
/// log.
pub struct CountedProgress {
    bar: ProgressBar,
    last_line: Instant,
}

impl CountedProgress {
    /// Begins the progress of `count` steps; `can_resume` if a run that is stopped can be continued.
    pub fn new(count: usize, can_resume: bool) -> Self {
        let bar = bar(count as u64);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos} of {len}, {eta} left{msg}") {
            bar.set_style(style);
        }
        bar.set_message(if can_resume { "; after Ctrl-C --resume goes on" } else { "" });
        Self { bar, last_line: Instant::now() }
    }

    /// Counts one more step.
    pub fn step(&mut self) {
        self.bar.inc(1);
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or_default());
        if is_log() && (done == all || self.last_line.elapsed() >= LOG_INTERVAL) {
            self.last_line = Instant::now();
            let left = HumanDuration(self.bar.eta());
            note(&format!("{done} of {all}, {left} left"));
        }
        if done == all {
            self.bar.finish_and_clear();
        }
    }
}
