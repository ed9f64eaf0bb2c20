//! A number of random scenes with known truth, through everything, to how far off the analysis is and how often it says so.

mod draw;
mod recorder;
mod rungs;
mod score;
mod statistics;
mod tables;

pub(super) use rungs::rungs;
pub use score::csv;
pub(super) use score::written;
pub(super) use statistics::{half_widths_between, half_widths_off, is_missed, quantile};
pub use tables::markdown;

use crate::analysis::measure;
use crate::ingest::Progress;
use crate::lab::chance::Chance;
use crate::lab::damage::Wish;
pub use crate::lab::damage::{DamageKind, drawn as kinds};
use crate::lab::data::{
    Campaign, CampaignRequest, CampaignRow, Damage, SceneFile, SceneNumber, SyntheticRecording,
};
use crate::numerics::as_f64;
use rayon::prelude::*;
use score::RecordedScene;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Runs the campaign; `progress` is told the share that is done. The same request gives the same rows but for their times.
#[must_use]
pub fn run(request: &CampaignRequest, progress: Progress) -> Campaign {
    let numbers = numbers(request);
    let done = AtomicUsize::new(0);
    let each = |number: &SceneNumber| {
        let row = row(request, *number);
        progress(as_f64(done.fetch_add(1, Ordering::Relaxed) + 1) / as_f64(numbers.len()));
        row
    };
    let rows = numbers.par_iter().map(each).collect();
    Campaign { request: request.clone(), rows }
}

/// One scene as `synth` writes it: the scene with what is stated of it, and its recording.
#[must_use]
pub fn scene(seed: u64, number: SceneNumber, exact: bool) -> (SceneFile, SyntheticRecording) {
    let RecordedScene { drop, recording, .. } = recorded(seed, number, exact);
    (SceneFile { scene: drop.scene, stated: drop.stated }, recording)
}

/// The numbers of the scenes: those of a kind are counted through all kinds, those not asked for left out.
fn numbers(request: &CampaignRequest) -> Vec<SceneNumber> {
    let undamaged = if request.undamaged { request.scenes } else { 0 };
    let damaged = if request.kinds.is_empty() { 0 } else { request.scenes };
    let wanted = |number: &u32| request.kinds.contains(&kind_and_size(*number).0.name);
    let damaged = (0..u32::MAX).filter(wanted).take(usize::try_from(damaged).unwrap_or(0));
    (0..undamaged).map(SceneNumber::Undamaged).chain(damaged.map(SceneNumber::Damaged)).collect()
}

/// What there is to scene D`number`: kinds take turns, then sizes.
fn kind_and_size(number: u32) -> (&'static DamageKind, f64) {
    let kinds: Vec<&DamageKind> = kinds().collect();
    let number = usize::try_from(number).unwrap_or(0);
    let kind = kinds[number % kinds.len()];
    (kind, kind.sizes[(number / kinds.len()) % kind.sizes.len()])
}

fn row(request: &CampaignRequest, number: SceneNumber) -> CampaignRow {
    let scene = recorded(request.seed, number, request.exact);
    let read = scene.drop.read(&scene.recording);
    let begun = Instant::now();
    let analysis = read.map(|read| measure(&read, &scene.drop.stated));
    let analysis_s = begun.elapsed().as_secs_f64();
    CampaignRow { analysis_s, ..score::row(number, scene, analysis.as_ref()) }
}

fn recorded(seed: u64, number: SceneNumber, exact: bool) -> RecordedScene {
    // A stream of its own for every scene, so that none moves another.
    let (stream, struck) = match number {
        SceneNumber::Undamaged(number) => (2 * u64::from(number), None),
        SceneNumber::Damaged(number) => (2 * u64::from(number) + 1, Some(kind_and_size(number))),
    };
    let wish = struck.map_or_else(Wish::default, |(kind, size)| kind.wish(size));
    let mut drop = draw::drawn(Chance::new(seed, stream), &wish, exact);
    recorder::equip(&mut drop, &wish, exact);
    let recording = struck.map(|(kind, size)| kind.strike(&mut drop, size));
    let recording = recording.unwrap_or_else(|| drop.recorded());
    let damage = struck.map(|(kind, size)| Damage { kind: kind.name, size, unit: kind.unit });
    RecordedScene { drop, damage, recording }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn numbers_go_through_all_kinds_and_sizes() {
        let most = kinds().map(|kind| kind.sizes.len()).max().expect("some") * kinds().count();
        let seen: BTreeSet<(&str, u64)> = (0..u32::try_from(most).expect("some"))
            .map(|number| (kind_and_size(number).0.name, kind_and_size(number).1.to_bits()))
            .collect();
        assert_eq!(seen.len(), kinds().map(|kind| kind.sizes.len()).sum::<usize>());
    }
}
