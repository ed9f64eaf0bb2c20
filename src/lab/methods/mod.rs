//! Ways of working, each method beside its rivals and each damage that grows, to what is accepted: speed, accuracy, failure.

mod contest;
mod cutoff;
mod detection;
mod drops;
mod ends;
mod flight;
mod front;
mod limits;
mod map;
mod prediction;
mod references;
pub mod timing;
mod ways;

pub use contest::ALL_CLASSES;
pub use limits::limits_of;
pub use references::References;
pub use ways::{READING, WAYS};

use crate::ingest::Progress;
use crate::lab::campaign;
use crate::lab::data::{CampaignRequest, Trial, TrialMachine, TrialPoint, TrialRequest};
use crate::numerics::as_f64;

/// Tries the methods of a family.
type Trying = fn(&TrialRequest) -> Vec<TrialPoint>;

/// The families by name, what matters most first: the ways of working, then single methods by how much hangs on them.
///
/// Forms of the filter, rules of integration and root finders are not among them: in double precision no rival is off by what matters.
pub const FAMILIES: [(&str, Trying); 6] = [
    ("ways", ways::points),
    ("flight-fit", flight::points),
    ("prediction", prediction::points),
    ("first-contact", detection::points),
    ("cut-off", cutoff::points),
    ("record-ends", ends::points),
];

/// The whole trial, with a site's own reference recordings; `progress` is told the share that is done.
#[must_use]
pub fn trial(
    request: TrialRequest,
    machine: TrialMachine,
    site: Option<&References>,
    progress: Progress,
) -> Trial {
    let mut points = Vec::new();
    for (done, (_, tried)) in FAMILIES.iter().enumerate() {
        // Methods, the map and the campaign take a third of the time each.
        progress(as_f64(done) / as_f64(3 * FAMILIES.len()));
        points.extend(tried(&request));
    }
    front::mark_front(&mut points);
    let maps = map::maps(&request, &|share| progress((1.0 + share) / 3.0));
    let drops = CampaignRequest {
        scenes: request.either(100, 600),
        seed: request.seed,
        kinds: vec!["undamaged".to_owned()],
        exact: false,
    };
    let campaign = campaign::run(&drops, &|share| progress((2.0 + share) / 3.0));
    let limits = limits::limits(&points, &maps, &campaign, site);
    Trial {
        schema: "dropcheck.validation/3",
        version: env!("CARGO_PKG_VERSION"),
        request,
        machine,
        points,
        maps,
        campaign,
        limits,
    }
}
