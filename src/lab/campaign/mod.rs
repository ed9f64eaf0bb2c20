//! A number of random scenes with known truth, through everything, to how far off the analysis is and how often it says so.
//!
//! Simulation, recorder and analysis come in as functions: this stage knows none of them.

mod chance;
mod damage;
mod draw;
mod recorder;
mod score;
mod statistics;
mod table;
mod tables;

pub use damage::kinds;
pub use score::csv;
pub use tables::markdown;

use crate::data::{Analysis, Cask, CaskFile, Contact, Drop, End, Recording};
use crate::lab::data::{
    Campaign, CampaignRequest, CampaignRow, CrushableEnd, Damage, Scene, SceneChannel, SceneFile,
    SceneNumber, SimulatedMotion, SyntheticRecording, WantedImpact,
};
use chance::Chance;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::mpsc;
use std::time::Instant;

/// What a perfect sensor reads at its place in a moving scene, m/s², at times in s from first contact.
pub type Force = dyn Fn(&Scene, &SimulatedMotion, &SceneChannel, &[f64]) -> Vec<f64> + Sync;

/// Everything that a scene passes through.
#[derive(Clone, Copy)]
pub struct Means<'a> {
    /// The stiffnesses of an end that give a wanted impact.
    pub crush: &'a (dyn Fn(&Cask, &Drop, Contact, End, WantedImpact) -> CrushableEnd + Sync),
    /// The motion of a scene.
    pub simulate: &'a (dyn Fn(&Scene) -> SimulatedMotion + Sync),
    /// What a perfect sensor reads.
    pub force: &'a Force,
    /// What the recorder writes.
    pub record: &'a (dyn Fn(&Scene, &SimulatedMotion) -> SyntheticRecording + Sync),
    /// The recording as read; none where it is refused.
    pub read: &'a (dyn Fn(&SyntheticRecording, &CaskFile) -> Option<Recording> + Sync),
    /// The analysis.
    pub analyze: &'a (dyn Fn(&Recording, &CaskFile) -> Analysis + Sync),
}

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
pub fn run(request: &CampaignRequest, means: &Means, progress: &dyn Fn(f64)) -> Campaign {
    let numbers = numbers(request);
    let rows = std::thread::scope(|scope| {
        let (tell, told) = mpsc::channel();
        let numbers = &numbers;
        let work = scope.spawn(move || {
            let each = |number: &SceneNumber| {
                let row = row(request, *number, means);
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
pub fn scene(seed: u64, number: SceneNumber, exact: bool, means: &Means) -> (SceneFile, SyntheticRecording) {
    let (case, recording, _) = made(seed, number, exact, means);
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

fn row(request: &CampaignRequest, number: SceneNumber, means: &Means) -> CampaignRow {
    let (case, recording, damage) = made(request.seed, number, request.exact, means);
    let read = (means.read)(&recording, &case.stated);
    let begun = Instant::now();
    let analysis = read.map(|read| (means.analyze)(&read, &case.stated));
    let analysis_s = begun.elapsed().as_secs_f64();
    score::row((number, damage), case, recording.first_contact_s, (analysis.as_ref(), analysis_s))
}

/// A scene, drawn, struck by its damage and recorded.
fn made(
    seed: u64,
    number: SceneNumber,
    exact: bool,
    means: &Means,
) -> (Case, SyntheticRecording, Option<Damage>) {
    let struck = match number {
        SceneNumber::Undamaged(_) => None,
        SceneNumber::Damaged(number) => Some(damage::of(number)),
    };
    let wish = struck.map_or_else(draw::Wish::new, |(kind, size)| (kind.wish)(size));
    let mut case = draw::case((seed, number), &wish, exact, means);
    recorder::equip(&mut case, &wish, exact, means);
    let Some((kind, size)) = struck else {
        let recording = (means.record)(&case.scene, &case.motion);
        return (case, recording, None);
    };
    (kind.before)(&mut case, size, means);
    let mut recording = (means.record)(&case.scene, &case.motion);
    (kind.after)(&mut case, &mut recording, size);
    (case, recording, Some(Damage { kind: kind.name, size, unit: kind.unit }))
}
