//! Runs random scenes with known truth through the whole program, and counts its errors and the coverage of
//! its intervals.

mod draw;
mod recorder;
mod score;
mod tables;
mod tally;

pub use score::outcome;
pub(super) use score::{half_widths_between, half_widths_off, is_missed};
pub use tables::markdown;
pub(super) use tally::BODIES;
pub use tally::Tally;

use crate::ingest::Progress;
use crate::lab::chance::Chance;
use crate::lab::damage::Wish;
pub use crate::lab::damage::{DamageKind, campaign_kinds as kinds};
use crate::lab::data::{CampaignRequest, CampaignRow, Damage, SceneFile, SceneNumber, SyntheticRecording};
use crate::numerics::as_f64;
use crate::ordered_parallel;
use score::RecordedScene;
use std::convert::Infallible;

/// Value of the first key of every line.
pub const SCHEMA: &str = "dropcheck.scenes/1";

/// Words for several kinds: every drop, those that are not damaged, those of sound kinds.
pub const WORDS: [&str; 3] = ["all", "undamaged", "sound"];

/// Rows of the campaign, undamaged scenes first, each in the order of their numbers; `progress` receives the
/// completed share. The same request gives the same rows.
pub fn run(request: &CampaignRequest, progress: Progress) -> Vec<CampaignRow> {
    let (numbers, mut rows) = (numbers(request), Vec::new());
    let take = |_, row| {
        rows.push(row);
        progress(as_f64(rows.len()) / as_f64(numbers.len()));
        Ok::<(), Infallible>(())
    };
    let jobs = rayon::current_num_threads();
    let Ok(()) = ordered_parallel::each(numbers.iter(), jobs, |number| row(request, *number), take);
    rows
}

/// One scene as `synth` writes it: the scene with its cask file, and its recording.
pub fn scene(seed: u64, number: SceneNumber, exact: bool) -> (SceneFile, SyntheticRecording) {
    let RecordedScene { drop, recording, .. } = recorded(seed, number, exact);
    (SceneFile { scene: drop.scene, stated: drop.stated }, recording)
}

/// Numbers of a campaign's scenes in order, undamaged ones first: those of a kind are counted through all
/// kinds, and kinds that are not requested are omitted.
pub fn numbers(request: &CampaignRequest) -> Vec<SceneNumber> {
    let has = |word: &str| request.kinds.contains(word);
    let [all, undamaged, sound] = WORDS.map(has);
    let wanted: Vec<bool> = kinds().map(|kind| all || has(kind.name) || sound && kind.is_sound()).collect();
    let is_wanted = |number: &u32| wanted[*number as usize % wanted.len()];
    let count = |is_any: bool| if is_any { request.scenes as usize } else { 0 };
    let damaged = (0..u32::MAX).filter(is_wanted).take(count(wanted.contains(&true)));
    let undamaged = (0..u32::MAX).take(count(all || undamaged));
    undamaged.map(SceneNumber::Undamaged).chain(damaged.map(SceneNumber::Damaged)).collect()
}

/// Kind and size of damage in scene D`number`: kinds alternate, then sizes.
fn kind_and_size(number: u32) -> (&'static DamageKind, f64) {
    let kinds: Vec<&DamageKind> = kinds().collect();
    let number = usize::try_from(number).unwrap_or(0);
    let kind = kinds[number % kinds.len()];
    (kind, kind.sizes[(number / kinds.len()) % kind.sizes.len()])
}

/// Analyses a scene and compares the result with its truth.
pub fn row(request: &CampaignRequest, number: SceneNumber) -> CampaignRow {
    let scene = recorded(request.seed, number, request.exact);
    let analysis = scene.drop.analyze(&scene.recording);
    score::row(number, scene, analysis.as_ref())
}

/// Reads a line; `None` if it is incomplete.
pub fn read(line: &[u8]) -> Option<CampaignRow> {
    serde_json::from_slice(line.strip_suffix(b"\n")?).ok()
}

fn recorded(seed: u64, number: SceneNumber, exact: bool) -> RecordedScene {
    // Every scene has its own random stream, so that none changes another.
    let (stream, struck) = match number {
        SceneNumber::Undamaged(number) => (2 * u64::from(number), None),
        SceneNumber::Damaged(number) => (2 * u64::from(number) + 1, Some(kind_and_size(number))),
    };
    let wish = struck.map_or_else(Wish::default, |(kind, size)| kind.wish(size));
    let mut drop = draw::draw_drop(Chance::new(seed, stream), &wish, exact);
    recorder::equip(&mut drop, &wish, exact);
    let recording = struck.map(|(kind, size)| kind.apply(&mut drop, size));
    let recording = recording.unwrap_or_else(|| drop.record());
    let damage =
        struck.map(|(kind, size)| Damage { kind: kind.name.to_owned(), size, unit: kind.unit.to_owned() });
    RecordedScene { drop, damage, recording }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{ChannelSpec, End, OtherSpec, RateSpec, Verdict};
    use crate::lab::data::RateSensor;
    use std::collections::BTreeSet;

    #[test]
    fn numbers_go_through_all_kinds_and_sizes() {
        let most = kinds().map(|kind| kind.sizes.len()).max().expect("some") * kinds().count();
        let seen: BTreeSet<(&str, u64)> = (0..u32::try_from(most).expect("some"))
            .map(|number| (kind_and_size(number).0.name, kind_and_size(number).1.to_bits()))
            .collect();
        assert_eq!(seen.len(), kinds().map(|kind| kind.sizes.len()).sum::<usize>());
    }

    /// A drop as the campaign draws it, the rest in the record, with an angular-rate sensor in addition.
    fn with_rate_sensor(number: SceneNumber) -> CampaignRow {
        let (stream, struck) = match number {
            SceneNumber::Undamaged(number) => (2 * u64::from(number), None),
            SceneNumber::Damaged(number) => (2 * u64::from(number) + 1, Some(kind_and_size(number))),
        };
        let wish = struck.map_or_else(Wish::default, |(kind, size)| kind.wish(size));
        let wish = Wish { rest: Some(true), ..wish };
        let mut drop = draw::draw_drop(Chance::new(3, stream), &wish, false);
        recorder::equip(&mut drop, &wish, false);
        let chance = &mut drop.chance;
        let from_end_m = chance.uniform(0.05, 0.4);
        let (end, unit) = (chance.choose(&[End::First, End::Second]), chance.choose(&["deg/s", "rad/s"]));
        let position_m = if end == End::First { from_end_m } else { drop.scene.cask.length_m - from_end_m };
        let sensor = RateSensor {
            name: "W1".into(),
            position_m,
            unit: unit.into(),
            sample_rate_hz: drop.scene.channels[0].sample_rate_hz,
            scale: 1.0 + chance.vary(drop.stated.tolerances.calibration),
            offset_rad_s: chance.uniform(-3.0, 3.0).to_radians(),
            white_noise_rad_s: chance.log_uniform([0.05, 0.5]).to_radians(),
        };
        let rate = Some(RateSpec { polarity: 1.0, calibration: None });
        let read = ChannelSpec::new("W1", end, "W1", position_m);
        drop.stated.others.push(OtherSpec { read, unit: None, rate });
        let keys = ["drop.angular_velocity_deg_s", "tolerance.angular_velocity_deg_s"];
        drop.stated.defaults.extend(keys.map(str::to_owned));
        drop.scene.extras.rates.push(sensor);
        let recording = drop.record();
        let analysis = drop.analyze(&recording);
        score::row(number, RecordedScene { drop, damage: None, recording }, analysis.as_ref())
    }

    #[test]
    fn a_rate_sensor_tells_turning_that_is_not_stated() {
        let request =
            CampaignRequest { scenes: 12, seed: 3, kinds: ["turning_unstated".into()].into(), exact: false };
        let off = |row: &CampaignRow| {
            let off = |name| row.quantities.get(name).and_then(half_widths_off).map(f64::abs);
            off("k").zip(off("speed")).map(|(k, speed)| k.max(speed))
        };
        // In 100 such drops none exceeded 2 half-widths, in 12 without the sensor two did.
        let rows: Vec<CampaignRow> = numbers(&request).into_iter().map(with_rate_sensor).collect();
        assert!(
            rows.iter().filter_map(off).all(|off| off < 2.0),
            "{:?}",
            rows.iter().map(off).collect::<Vec<_>>()
        );
        assert!(rows.iter().filter(|row| row.verdict == Some(Verdict::Pass)).count() > 9);
    }

    #[test]
    fn words_name_as_many_scenes_as_are_asked_for() {
        for (words, count) in
            [(&["all"][..], 14), (&["undamaged"], 7), (&["skew", "hum"], 7), (&["sound"], 7)]
        {
            let kinds = words.iter().map(|word| (*word).to_owned()).collect();
            let request = CampaignRequest { scenes: 7, seed: 1, kinds, exact: false };
            assert_eq!(numbers(&request).len(), count, "{words:?}");
        }
    }
}
