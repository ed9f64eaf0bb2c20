//! Maps a growing damage: several drops go through the whole program, and each is inside its interval, warned
//! of, refused or silent.

use super::limits::SILENT_BY;
use crate::data::{STANDARD_GRAVITY_M_S2, Verdict};
use crate::ingest::Progress;
use crate::lab::campaign::half_widths_between;
use crate::lab::damage::{self, DamageKind};
use crate::lab::data::{BendingMode, ElasticBody, TrialDrop, TrialFate, TrialMap, TrialRequest, TrialSize};
use crate::lab::drawn::{ANF_10, ANF_18, Build, DropPlan, ESBB, VHLW};
use crate::numerics::as_f64;
use crate::report::text::json_word;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Plans to which every damage is applied: four casks, angles of 10 to 25°, k of 0.3 to 0.6, pulses of 3 to
/// 12 ms at either end and an offset of half a g; rigid bodies with a weak mode alternate with elastic ones.
fn plans(request: &TrialRequest) -> Vec<DropPlan> {
    let plan = |order: u64, build: Build, [angle_deg, k, first_ms, second_ms, frequency_hz]: [f64; 5]| {
        let mut plan = DropPlan::new(build, angle_deg, k, request.seed + order);
        (plan.ends[0].duration_s, plan.ends[1].duration_s) = (1e-3 * first_ms, 1e-3 * second_ms);
        if order.is_multiple_of(2) {
            plan.modes = vec![BendingMode { strength: 0.3, ..DropPlan::mode(1, frequency_hz) }];
        } else {
            plan.elastic = Some(ElasticBody { first_bending_hz: frequency_hz, damping: 0.01 });
            // The modes reach beyond half the sample rate, where a recorder has a filter.
            plan.chain.anti_alias_hz = Some(plan.rate_hz / 4.0);
        }
        plan.chain.offset_m_s2 = 0.5 * STANDARD_GRAVITY_M_S2;
        plan
    };
    let plans = [
        plan(0, ANF_18, [15.0, 0.5, 5.0, 4.0, 120.0]),
        plan(1, ANF_10, [10.0, 0.35, 4.0, 8.0, 150.0]),
        plan(2, VHLW, [20.0, 0.3, 8.0, 12.0, 180.0]),
        plan(3, ANF_18, [20.0, 0.5, 6.0, 3.0, 110.0]),
        plan(4, ESBB, [12.0, 0.6, 3.0, 5.0, 90.0]),
        plan(5, VHLW, [25.0, 0.45, 12.0, 6.0, 160.0]),
    ];
    let count = request.choose(4, plans.len());
    plans.into_iter().take(count).collect()
}

/// Determines the fate of a plan's drop with damage of this size.
fn analyze_drop(kind: &DamageKind, plan: &DropPlan, size: f64) -> TrialDrop {
    let (drop, recording) = kind.grow(plan, size);
    let truth = &drop.motion.truth;
    // None where the recording is refused.
    let result = drop.analyze(&recording).map(|analysis| analysis.result);
    let [speed, k] = result.as_ref().map_or([None; 2], |result| [result.slap_down.speed, result.k]);
    // The error is infinite if a number is stated for an event that did not happen.
    let off = [(speed, truth.speed), (k, truth.k)]
        .map(|(stated, truth)| Some(half_widths_between(stated?.into(), truth.unwrap_or(f64::INFINITY))));
    let worst = off.iter().flatten().copied().reduce(f64::max);
    let fate = match (off, result.as_ref().map(|result| result.verdict)) {
        ([Some(speed), Some(k)], _) if speed.max(k) <= 1.0 => TrialFate::Inside,
        (_, Some(Verdict::Pass)) if worst.is_some_and(|worst| worst > 1.0) => TrialFate::Silent,
        ([Some(_), Some(_)], _) => TrialFate::Warned,
        _ => TrialFate::Refused,
    };
    let mut findings = result.iter().flat_map(|result| &result.quality);
    let is_named = kind.expected_codes.is_empty()
        || findings.any(|finding| kind.expected_codes.contains(&&json_word(finding.code)[..]));
    TrialDrop { fate, half_widths_off: worst, is_named, is_elastic: drop.scene.elastic.is_some() }
}

/// Chance puts one sound drop in twenty outside its interval: a drop is silent if it is more than two
/// half-widths off, or a half-width further off than the same drop at the harmless size.
fn excuse_chance(sizes: &mut [TrialSize]) {
    let harmless: Vec<Option<f64>> = sizes[0].drops.iter().map(|drop| drop.half_widths_off).collect();
    let drops = sizes.iter_mut().flat_map(|size| size.drops.iter_mut().zip(&harmless));
    for (drop, harmless) in drops.filter(|(drop, _)| drop.fate == TrialFate::Silent) {
        let off = drop.half_widths_off.unwrap_or(f64::INFINITY);
        if off <= SILENT_BY && harmless.is_some_and(|harmless| off <= harmless + 1.0) {
            drop.fate = TrialFate::Inside;
        }
    }
}

/// Maps every damage that grows; `progress` receives the completed share.
pub(super) fn maps(request: &TrialRequest, progress: Progress) -> Vec<TrialMap> {
    let kinds: Vec<&DamageKind> = damage::growing_kinds().collect();
    let (plans, done) = (plans(request), AtomicUsize::new(0));
    let of_kind = |kind: &&DamageKind| {
        // The first and the last are among every third of them.
        let sizes = kind.growing.iter().copied().step_by(request.choose(3, 1));
        let of_size = |size: f64| {
            let drops = plans.par_iter().map(|plan| analyze_drop(kind, plan, size)).collect();
            TrialSize { size, drops }
        };
        let mut sizes: Vec<TrialSize> = sizes.collect::<Vec<_>>().into_par_iter().map(of_size).collect();
        excuse_chance(&mut sizes);
        let map = TrialMap {
            name: kind.name.to_owned(),
            what: kind.what.to_owned(),
            unit: kind.unit.to_owned(),
            told_by: kind.expected_codes.clone(),
            instead: kind.instead.to_owned(),
            sizes,
            // A full run determines by itself which damages are silent.
            known: damage::known_silence(kind.name).filter(|_| request.quick),
        };
        progress(as_f64(done.fetch_add(1, Ordering::Relaxed) + 1) / as_f64(kinds.len()));
        map
    };
    kinds.par_iter().map(of_kind).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_a_damage_takes_has_the_finding_that_took_it() {
        let plan = &plans(&TrialRequest { quick: true, seed: 1 })[0];
        let kinds: Vec<&DamageKind> = damage::growing_kinds().collect();
        let hold = |kind: &&DamageKind| {
            let (drop, recording) = kind.grow(plan, kind.growing.last().copied().unwrap_or_default());
            let Some(mut result) = drop.analyze(&recording).map(|analysis| analysis.result) else {
                return 0;
            };
            result.find_missing();
            for missing in &result.missing {
                let took = missing.because.map(|place| &result.quality[place]);
                let is_headline = missing.quantity == "k" || missing.quantity == "slap_down.speed";
                assert!(took.is_some() || !is_headline, "{}: {missing:?}", kind.name);
                assert!(took.is_none_or(|f| !f.effect.parts().is_empty()), "{}: {missing:?}", kind.name);
            }
            usize::from(result.k.is_none())
        };
        let refused: usize = kinds.par_iter().map(hold).sum();
        assert!(refused > 10, "{refused}");
    }

    #[test]
    fn what_chance_puts_outside_is_not_silent() {
        let size = |offs: [f64; 3]| TrialSize {
            size: 1.0,
            drops: offs
                .map(|off| TrialDrop {
                    fate: if off > 1.0 { TrialFate::Silent } else { TrialFate::Inside },
                    half_widths_off: Some(off),
                    is_named: true,
                    is_elastic: false,
                })
                .into(),
        };
        let mut sizes = [size([0.4, 1.1, 0.2]), size([1.3, 1.5, 0.9]), size([1.5, 2.1, 1.9])];
        excuse_chance(&mut sizes);
        let silent = sizes.map(|s| s.drops.iter().map(|d| d.fate == TrialFate::Silent).collect::<Vec<_>>());
        assert_eq!(silent, [vec![false; 3], vec![false; 3], vec![true; 3]]);
    }

    #[test]
    fn a_drop_is_inside_refused_or_silent() {
        let plan = &plans(&TrialRequest { quick: true, seed: 1 })[0];
        let fate = |name, size| analyze_drop(damage::find_kind(name).expect("a damage"), plan, size);
        assert_eq!(fate("offset", 10.0).fate, TrialFate::Inside);
        assert_eq!(fate("stated_length", 8.0).fate, TrialFate::Silent);
        let refused = fate("ends_exchanged", 0.0);
        assert!(refused.fate == TrialFate::Refused && refused.is_named);
        assert_eq!(fate("contents", 50.0).fate, TrialFate::Refused);
    }
}
