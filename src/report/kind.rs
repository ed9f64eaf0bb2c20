//! Kind of a drop without a slap-down, by its angle, and the reason why none was to be expected.

use super::rounding::{interval, plain};
use crate::data::{CaskFile, DropResult};

/// Largest inclination of a flat drop, degrees: the usual error of a release.
const FLAT_DEG: f64 = 2.0;
/// Largest lever of the target's force about the centre of gravity that hardly turns a cask, as a share of
/// the distance between them: 6° of inclination.
const SMALL_LEVER: f64 = 0.1;

/// The kind of the drop, "Flat drop: …"; `None` if a slap-down was found, or was to be expected.
pub(super) fn words(result: &DropResult, file: &CaskFile) -> Option<String> {
    let (cask, drop) = (&file.cask, &file.drop);
    let (angle_deg, (sin, cos)) = (drop.angle_rad.to_degrees(), drop.angle_rad.sin_cos());
    let shown_deg = plain(angle_deg, 3);
    if angle_deg <= FLAT_DEG && result.slap_down.speed.is_none() {
        let apart_ms = 1e3 * cask.length_m * sin / drop.impact_velocity_m_s;
        return Some(format!(
            "Flat drop ({shown_deg}°): the second end meets the target {} ms after the first if nothing \
             turns the cask, so no flight that shows a slap-down speed is expected.",
            plain(apart_ms, 2)
        ));
    }
    if angle_deg <= FLAT_DEG || result.events.slap_down.is_some() {
        return None;
    }
    if drop.is_on_end() {
        let first = &result.first_impact;
        let [struck, rebound] =
            [&first.impact_velocity, &first.rebound_velocity].map(|v| interval(v.as_ref()));
        let found = format!(
            " It strikes at {struck} by the cask file and rebounds at {rebound} by its axial channels."
        );
        return Some(format!(
            "End drop ({shown_deg}°): the cask strikes with its end face, which hardly turns it, so no \
             slap-down is expected.{}",
            if first.rebound_velocity.is_some() { &found } else { "" }
        ));
    }
    let lever_m = cask.cog_m * cos - 0.5 * cask.height_m * sin;
    let is_small = lever_m <= SMALL_LEVER * cask.cog_m.hypot(0.5 * cask.height_m);
    let (place, turns) = match () {
        () if lever_m > 0.0 => ("short of the centre of gravity", "hardly turns"),
        () => ("beyond the centre of gravity", "does not turn"),
    };
    is_small.then(|| {
        format!(
            "Corner drop ({shown_deg}°): the struck corner lies {} mm {place}, so the first impact {turns} \
             the second end down and no slap-down is expected soon after it.",
            plain(1e3 * lever_m.abs(), 2)
        )
    })
}
