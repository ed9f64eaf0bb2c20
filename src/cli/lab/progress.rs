//! The parts of a trial to a bar on standard error that says how long they will take yet, where that is a terminal.

use super::super::progress::PARTS;
use indicatif::{ProgressBar, ProgressStyle};

/// Does `work`, which tells what it is at and its progress from 0 to 1; the time left is shown too.
pub fn with_estimate<T>(work: impl FnOnce(&dyn Fn(&str, f64)) -> T) -> T {
    let bar = ProgressBar::new(u64::from(PARTS));
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent} %, {eta} left") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(std::time::Duration::from_millis(500));
    let done = work(&|what, fraction| {
        bar.set_message(dropcheck::report::printable(what));
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
