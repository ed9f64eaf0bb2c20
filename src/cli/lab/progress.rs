//! The parts of a trial to a bar on standard error that says how long they will take yet, where that is a terminal.

use super::super::progress::Bar;

/// Does `work`, which tells what it is at and its progress from 0 to 1; the time left is shown too.
pub fn with_estimate<T>(work: impl FnOnce(&dyn Fn(&str, f64)) -> T) -> T {
    let bar = Bar::of("{msg} {wide_bar} {percent} %, {eta} left");
    bar.tick();
    let done = work(&|what, fraction| {
        bar.say(what);
        bar.reach(fraction);
    });
    bar.end();
    done
}
