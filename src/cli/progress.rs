//! Long work to a bar on standard error, where that is a terminal.

use dropcheck::ingest::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// Parts of the bar; finer than a terminal shows.
const PARTS: u32 = 1000;

/// A bar, which hides itself where standard error is no terminal.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar laid out by `template`, at its beginning.
    pub fn of(template: &str) -> Self {
        let bar = ProgressBar::new(u64::from(PARTS));
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// Draws it anew every half second, so that the time left goes on.
    #[cfg(feature = "lab")]
    pub fn tick(&self) {
        self.0.enable_steady_tick(std::time::Duration::from_millis(500));
    }

    /// What the work is at.
    pub fn say(&self, what: &str) {
        self.0.set_message(dropcheck::report::printable(what));
    }

    /// How far it has come, 0 to 1.
    pub fn reach(&self, fraction: f64) {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "cut to 0 to 1000 before the cast"
        )]
        self.0.set_position((fraction.clamp(0.0, 1.0) * f64::from(PARTS)) as u64);
    }

    /// Takes it away.
    pub fn end(&self) {
        self.0.finish_and_clear();
    }
}

/// Does `work`, which tells its progress from 0 to 1.
pub fn with_progress<T>(what: &str, work: impl FnOnce(Progress) -> T) -> T {
    let bar = Bar::of("{msg} {wide_bar} {percent} %");
    bar.say(what);
    let done = work(&|fraction| bar.reach(fraction));
    bar.end();
    done
}
