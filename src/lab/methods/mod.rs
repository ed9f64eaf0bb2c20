//! Trial of whole analyses and of growing damages against the limits of acceptance: speed, accuracy, failure.

mod limits;
mod map;
mod references;
mod ways;

pub use limits::limits;
pub use references::References;
pub use ways::{ALL_CLASSES, READING, WAYS, points as ways};

use crate::ingest::Progress;
use crate::lab::campaign;
use crate::lab::data::{CampaignRequest, Trial, TrialMachine, TrialRequest};

/// Runs the whole trial, including a site's own reference recordings; `progress` receives the completed
/// share.
pub fn trial(
    request: TrialRequest,
    machine: TrialMachine,
    site: Option<&References>,
    progress: Progress,
) -> Trial {
    // The methods, the map and the campaign take a third of the time each.
    progress(0.0);
    let points = ways(&request);
    let maps = map::maps(&request, &|share| progress((1.0 + share) / 3.0));
    let drops = CampaignRequest {
        scenes: request.choose(100, 600),
        seed: request.seed,
        kinds: ["undamaged".to_owned()].into(),
        exact: false,
    };
    let campaign = campaign::run(&drops, &|share| progress((2.0 + share) / 3.0));
    let limits = limits(&points, &maps, &campaign, site);
    Trial {
        schema: "dropcheck.validation/3",
        version: env!("CARGO_PKG_VERSION"),
        request,
        machine,
        points,
        maps,
        limits,
    }
}
