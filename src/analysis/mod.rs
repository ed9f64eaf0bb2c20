//! A recording and a cask file to everything that can be said of the drop: the order of the whole.

mod check;
mod comparison;
mod first_look;
mod flight;
pub mod flight_search;
mod impact;
mod impacts;
pub mod missing_end;
mod others;
mod plan;
mod progress;
mod rest;
mod result;
mod second_impact;
mod second_look;
mod setup;
mod slips;

pub use check::check;
pub use first_look::first_look;
pub use plan::study;
pub use rest::{read, read_within, take_rest};
pub use setup::sticking;

use crate::data::{Analysis, CaskFile, Events, Finding, Recording};
use crate::{ingest, judge};
use comparison::Measured;
use flight::Flown;
use flight_search::Patience;
use impact::Impact;
use impacts::Tabulated;
use progress::Reached;

/// From a recording and a cask file to everything that can be said of the drop.
///
/// What cannot be had is null in the result, with an issue that says why; the verdict says whether to believe
/// the rest.
#[must_use]
pub fn analyze(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    // On a thread of the pool: any other would be put to sleep and woken again for each piece of work that
    // two threads share.
    let mut found = measure(recording, cask_file);
    rayon::scope(|_| slips::name_slip(recording, cask_file, &mut found));
    let result = &mut found.result;
    result.keys = ingest::cask_file::settings(cask_file, recording);
    result.observed = cask_file.observed.iter().map(|seen| judge::beside(seen, result)).collect();
    result.limits = cask_file.limits.iter().map(|limit| judge::beside_limit(limit, result)).collect();
    result.quality.extend(judge::judge_observed(&result.observed));
    rayon::scope(|_| others::add(recording, cask_file, &mut found));
    let result = &mut found.result;
    result.verdict = judge::verdict(&mut result.quality);
    judge::behind_the_motion(&mut result.quality, &result.other_channels);
    found
}

/// [`analyze`] without the search for a usual slip, which names one and changes no number.
#[must_use]
pub fn measure(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    let whole = || analyzed(recording, cask_file, Patience::EachBeginning);
    rayon::scope(|_| second_look::leave_one_out(recording, cask_file, whole()))
}

/// A first impact with the events and the flight that follow it.
struct AfterImpact {
    impact: Impact,
    events: Events,
    flown: Option<Flown>,
}

/// The first impact and the flight after it, with what was found about them; `farther` as [`Impact::find`]
/// takes it.
fn flown(
    recording: &Recording,
    file: &CaskFile,
    farther: bool,
    patience: Patience,
) -> (Vec<Finding>, Option<AfterImpact>) {
    let mut findings = recording.issues.clone();
    let struck = Impact::find(recording, file, farther, patience, &mut findings).map(|impact| {
        let (events, flown) = flight::flown(&impact, file, &mut findings);
        AfterImpact { impact, events, flown }
    });
    (findings, struck)
}

fn analyzed(recording: &Recording, file: &CaskFile, patience: Patience) -> Analysis {
    let (mut findings, mut found) = flown(recording, file, false, patience);
    // From steep angles a cask may strike later than its angle has it.
    if found.as_ref().is_some_and(|f| f.events.slap_down.is_none() && f.impact.goes_on) {
        let farther = flown(recording, file, true, patience);
        if farther.1.as_ref().is_some_and(|f| f.events.slap_down.is_some()) {
            (findings, found) = farther;
        }
    }
    let Some(AfterImpact { impact, events, flown }) = found else {
        return result::without_impact(recording, file, findings);
    };
    judge::weigh_by_distance(&mut findings, &events);
    let (on_channels, shown) = rayon::join(
        || judge::judge_channels(impact.recorded(), &events, file, &findings),
        || result::ShownSignals::of(&impact.signals, &events, file),
    );
    findings.extend(on_channels);
    let reached = match flown {
        None => Reached::Impact,
        Some(flown) => match Measured::of(&flown, &impact, &events, file, &mut findings) {
            None => Reached::Flown(Box::new(flown)),
            Some(measured) => {
                let tabulated = flown.tabulated.as_ref();
                findings.extend(tabulated.and_then(|t| t.untold(impact.recorded(), &events)));
                findings.extend(tabulated.and_then(Tabulated::two_maxima));
                Reached::Measured(Box::new(flown), measured)
            }
        },
    };
    if !matches!(reached, Reached::Measured(..)) {
        findings.extend(judge::judge_fall_time(&findings, &file.drop, &events, &file.tolerances));
    }
    result::of(recording, file, findings, result::Examined { impact, events, shown, reached })
}
