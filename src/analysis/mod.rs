//! A recording and a cask file to everything that can be said of the drop: the order of the whole.

mod again;
mod flight;
mod impact;
mod measured;
pub mod one_end;
mod outcome;
mod reached;
pub mod settle;
mod setup;

pub use setup::sticking;

use crate::data::{Analysis, CaskFile, Recording};
use crate::judge;
use impact::Impact;
use measured::Measured;
use reached::Reached;

/// From a recording and a cask file to everything that can be said of the drop.
///
/// What cannot be had is null in the result, with an issue that says why; the verdict says whether to believe the rest.
#[must_use]
pub fn analyze(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    // On a thread of the pool: any other would be put to sleep and woken again for each piece of work that two threads share.
    rayon::scope(|_| {
        let mut found = again::without_one(recording, cask_file, analyzed(recording, cask_file));
        again::name_slip(recording, cask_file, &mut found);
        found
    })
}

fn analyzed(recording: &Recording, file: &CaskFile) -> Analysis {
    let mut findings = recording.issues.clone();
    let Some(impact) = Impact::find(recording, file, &mut findings) else {
        findings.push(judge::judge_no_impact(&findings, &file.drop));
        return outcome::without_impact(recording, file, findings);
    };
    let (events, flown) = flight::flown(&impact, file, &mut findings);
    judge::weigh_by_distance(&mut findings, &events);
    let (on_channels, smooth) = rayon::join(
        || judge::judge_channels(impact.recorded(), &events, file, &findings),
        || outcome::smooth(&impact.signals, &events, file),
    );
    findings.extend(on_channels);
    let reached = match flown {
        None => Reached::Impact,
        Some(flown) => match Measured::of(&flown, &impact, &events, file, &mut findings) {
            None => Reached::Flown(Box::new(flown)),
            Some(measured) => Reached::Measured(Box::new(flown), measured),
        },
    };
    outcome::of(recording, file, findings, outcome::Examined { impact, events, smooth, reached })
}
