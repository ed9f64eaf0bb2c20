//! Each method of the program beside its rivals: time and error against a truth; and where the program fails.

mod contest;
mod cutoff;
mod detection;
mod detector;
mod drops;
mod ends;
mod filters;
mod flight;
mod front;
mod gustafsson;
mod integration;
mod prediction;
mod reconstruction;
mod reference;
mod roots;
mod sweep;
pub mod timing;

use crate::ingest::Progress;
use crate::lab::data::{Trial, TrialMachine, TrialPoint, TrialRequest};
use crate::numerics::as_f64;

/// Tries the methods of a family.
type Trying = fn(&TrialRequest) -> Vec<TrialPoint>;

/// The families by name, in the order in which they are shown.
pub const FAMILIES: [(&str, Trying); 9] = [
    ("filters", filters::points),
    ("record-ends", ends::points),
    ("integration", integration::points),
    ("cut-off", cutoff::points),
    ("first-contact", detection::points),
    ("flight-fit", flight::points),
    ("reconstruction", reconstruction::points),
    ("root", roots::points),
    ("prediction", prediction::points),
];

/// The whole trial; `progress` is told the share that is done.
#[must_use]
pub fn trial(request: TrialRequest, machine: TrialMachine, progress: Progress) -> Trial {
    let mut points = Vec::new();
    for (done, (_, tried)) in FAMILIES.iter().enumerate() {
        // The maps take the other half of the time.
        progress(0.5 * as_f64(done) / as_f64(FAMILIES.len()));
        points.extend(tried(&request));
    }
    let maps = sweep::maps(&request, &|share| progress(0.5 + 0.5 * share));
    front::mark_front(&mut points);
    Trial {
        schema: "dropcheck.validation/2",
        version: env!("CARGO_PKG_VERSION"),
        request,
        machine,
        points,
        maps,
    }
}
