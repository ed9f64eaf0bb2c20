//! A recording and a cask file to everything that can be said of the drop: the order of the whole.

mod flight;
mod impact;
mod measured;
pub mod one_end;
mod outcome;
pub mod settle;

use crate::data::{Analysis, AxialClosure, CaskFile, Recording, Setup};
use crate::judge;
use flight::Flown;
use impact::Impact;
use measured::Measured;

/// How far an analysis came from the first impact on.
enum Reached {
    /// The times, as far as they were found, and the curves of the channels.
    Impact,
    /// The motion too, but what it says of the impacts is not to be stated.
    Flown(Box<Flown>),
    /// The quantities, beside their prediction.
    Measured(Box<Flown>, Measured),
}

/// From a recording and a cask file to everything that can be said of the drop.
///
/// What cannot be had is null in the result, with an issue that says why; the verdict says whether to believe the rest.
#[must_use]
pub fn analyze(recording: &Recording, cask_file: &CaskFile) -> Analysis {
    // On a thread of the pool: any other would be put to sleep and woken again for each piece of work that two threads share.
    rayon::scope(|_| analyzed(recording, cask_file))
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
    outcome::of(recording, file, findings, outcome::Gathered { impact, events, smooth, reached })
}

/// Geometry and initial motion of a cask file, L sticking to the target.
#[must_use]
pub fn sticking(cask_file: &CaskFile) -> Setup {
    Setup {
        length_m: cask_file.cask.length_m,
        height_m: cask_file.cask.height_m,
        cog_m: cask_file.cask.cog_m,
        angle_rad: cask_file.drop.angle_rad,
        impact_velocity_m_s: cask_file.drop.impact_velocity_m_s,
        gravity_m_s2: cask_file.drop.gravity_m_s2,
        axial: AxialClosure::Sticking,
        second_s: 1.0,
    }
}
