//! Long work to a bar on standard error where that is a terminal, else to a line now and then.

use super::output::{is_quiet, note};
use crate::ingest::Progress;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Parts of the bar; finer than a terminal shows.
const PARTS: u32 = 1000;

/// Work that is done within this time needs no word in a log.
const SOON: Duration = Duration::from_secs(3);

/// A bar of so many parts, unless nobody wants to see it.
fn bar(parts: u64) -> ProgressBar {
    if is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(parts) }
}

/// Whether progress goes to a log, line by line.
fn is_log() -> bool {
    !is_quiet() && !std::io::stderr().is_terminal()
}

/// Does `work`, which tells its progress from 0 to 1, beside a bar; where standard error is no terminal long
/// work has a line each tenth.
pub fn with_progress<T>(what: &str, work: impl FnOnce(Progress) -> T) -> T {
    let bar = bar(u64::from(PARTS));
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent} %") {
        bar.set_style(style);
    }
    bar.set_message(crate::report::sanitize(what));
    let in_log = is_log();
    let told = AtomicU64::new(0);
    let done = work(&|fraction: f64| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 1000")]
        let parts = (fraction.clamp(0.0, 1.0) * f64::from(PARTS)) as u64;
        bar.set_position(parts);
        let tenth = 10 * parts / u64::from(PARTS);
        if in_log && bar.elapsed() > SOON && told.fetch_max(tenth, Ordering::Relaxed) < tenth {
            note(&format!("{what}: {} %", 10 * tenth));
        }
    });
    bar.finish_and_clear();
    done
}

/// So often a line of a log says how far the work is.
const EACH: Duration = Duration::from_secs(10);

/// "12 of 60, 3 minutes left" on standard error: a bar on a terminal, a line now and then in a log.
pub struct CountedProgress {
    bar: ProgressBar,
    told: Instant,
}

impl CountedProgress {
    /// Of so many steps; whether a run that is stopped leaves what it has `kept`.
    pub fn of(count: usize, kept: bool) -> Self {
        let bar = bar(count as u64);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos} of {len}, {eta} left{msg}") {
            bar.set_style(style);
        }
        bar.set_message(if kept { "; after Ctrl-C --resume goes on" } else { "" });
        Self { bar, told: Instant::now() }
    }

    /// One more is done.
    pub fn step(&mut self) {
        self.bar.inc(1);
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or_default());
        if is_log() && (done == all || self.told.elapsed() >= EACH) {
            self.told = Instant::now();
            let left = HumanDuration(self.bar.eta());
            note(&format!("{done} of {all}, {left} left"));
        }
        if done == all {
            self.bar.finish_and_clear();
        }
    }
}
