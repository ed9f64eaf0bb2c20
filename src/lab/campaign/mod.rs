//! A number of random scenes with known truth, through everything, to how far off the analysis is and how often it says so.

mod chance;
mod damage;
mod draw;
mod recorder;
mod score;
mod statistics;
mod tables;

pub use damage::kinds;
pub use score::csv;
pub use tables::markdown;

use crate::analysis::analyze;
use crate::data::CaskFile;
use crate::ingest::Progress;
use crate::lab::data::{
    Campaign, CampaignRequest, CampaignRow, Damage, Scene, SceneFile, SceneNumber, SimulatedMotion,
    SyntheticRecording,
};
use crate::lab::{in_memory, synth};
use chance::Chance;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::mpsc;
use std::time::Instant;

/// A scene on its way: as it is, as stated, and how it moves.
pub(crate) struct Case {
    scene: Scene,
    stated: CaskFile,
    motion: SimulatedMotion,
    chance: Chance,
    redraws: BTreeMap<&'static str, u32>,
}

/// Runs the campaign; `progress` is told the share that is done. The same request gives the same rows but for their times.
#[must_use]
pub fn run(request: &CampaignRequest, progress: Progress) -> Campaign {
    let numbers = numbers(request);
    let rows = std::thread::scope(|scope| {
        let (tell, told) = mpsc::channel();
        let numbers = &numbers;
        let work = scope.spawn(move || {
            let each = |number: &SceneNumber| {
                let row = row(request, *number);
                // Nobody listening is no reason to stop.
                let _ = tell.send(());
                row
            };
            numbers.par_iter().map(each).collect::<Vec<CampaignRow>>()
        });
        for (done, ()) in told.iter().enumerate() {
            #[allow(clippy::cast_precision_loss, reason = "a share for a progress bar")]
            progress((done + 1) as f64 / numbers.len() as f64);
        }
        work.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    Campaign { request: request.clone(), rows }
}

/// One scene as `synth` writes it: the scene with what is stated of it, and its recording.
#[must_use]
pub fn scene(seed: u64, number: SceneNumber, exact: bool) -> (SceneFile, SyntheticRecording) {
    let (case, recording, _) = made(seed, number, exact);
    (SceneFile { scene: case.scene, stated: case.stated }, recording)
}

/// The numbers of the scenes: damaged ones are counted through all kinds, those not asked for left out.
fn numbers(request: &CampaignRequest) -> Vec<SceneNumber> {
    let undamaged = if request.undamaged { request.scenes } else { 0 };
    let is_any = damage::kinds().any(|kind| request.kinds.contains(&kind.0));
    let damaged = if is_any { request.scenes } else { 0 };
    let wanted = |number: &u32| request.kinds.contains(&damage::of(*number).0.name);
    let damaged = (0..u32::MAX).filter(wanted).take(usize::try_from(damaged).unwrap_or(0));
    (0..undamaged).map(SceneNumber::Undamaged).chain(damaged.map(SceneNumber::Damaged)).collect()
}

fn row(request: &CampaignRequest, number: SceneNumber) -> CampaignRow {
    let (case, recording, damage) = made(request.seed, number, request.exact);
    let read = in_memory::synthetic(&recording, &case.stated).ok();
    let begun = Instant::now();
    let analysis = read.map(|read| analyze(&read, &case.stated));
    let analysis_s = begun.elapsed().as_secs_f64();
    score::row((number, damage), case, recording.first_contact_s, (analysis.as_ref(), analysis_s))
}

/// A scene, drawn, struck by its damage and recorded.
fn made(seed: u64, number: SceneNumber, exact: bool) -> (Case, SyntheticRecording, Option<Damage>) {
    let struck = match number {
        SceneNumber::Undamaged(_) => None,
        SceneNumber::Damaged(number) => Some(damage::of(number)),
    };
    let wish = struck.map_or_else(draw::Wish::new, |(kind, size)| (kind.wish)(size));
    let mut case = draw::case((seed, number), &wish, exact);
    recorder::equip(&mut case, &wish, exact);
    let Some((kind, size)) = struck else {
        let recording = synth::record(&case.scene, &case.motion);
        return (case, recording, None);
    };
    (kind.before)(&mut case, size);
    let mut recording = synth::record(&case.scene, &case.motion);
    (kind.after)(&mut case, &mut recording, size);
    (case, recording, Some(Damage { kind: kind.name, size, unit: kind.unit }))
}
