//! Long work to a bar on standard error, where that is a terminal.

use dropcheck::ingest::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// Parts of the bar; finer than a terminal shows.
const PARTS: u32 = 1000;

/// Does `work`, which tells its progress from 0 to 1, beside a bar that hides itself where standard error is no terminal.
pub fn with_progress<T>(what: &str, work: impl FnOnce(Progress) -> T) -> T {
    let bar = ProgressBar::new(u64::from(PARTS));
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent} %") {
        bar.set_style(style);
    }
    bar.set_message(dropcheck::report::printable(what));
    let done = work(&|fraction: f64| {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "cut to 0 to 1000 before the cast"
        )]
        bar.set_position((fraction.clamp(0.0, 1.0) * f64::from(PARTS)) as u64);
    });
    bar.finish_and_clear();
    done
}
