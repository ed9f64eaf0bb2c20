//! What each way says of drops whose truth is known, and how long it takes, to points of the trial.

use crate::data::{DropResult, Estimate};
use crate::lab::data::{TrialPoint, Truth};
use crate::numerics::{as_f64, robust};
use std::hint::black_box;
use std::time::Instant;

/// What stands for an error that is no number or beyond all bounds: the way diverged.
const DIVERGED: f64 = 1e9;

/// What all classes together are called.
pub const ALL_CLASSES: &str = "all";

/// What a reading alone is called.
pub const READING: &str = "reading alone";

/// A drop of a class, and what happened.
#[derive(Clone, Copy)]
pub(super) struct KnownDrop {
    pub class: &'static str,
    pub truth: Truth,
}

/// What a way says of a drop.
#[derive(Clone, Copy, Default)]
pub(super) struct Answer {
    pub speed: Option<Estimate>,
    pub k: Option<Estimate>,
}

impl Answer {
    pub(super) fn of(result: &DropResult) -> Self {
        Self { speed: result.slap_down.speed, k: result.k }
    }

    /// Numbers, in m/s and 1, without an interval.
    pub(super) fn bare(speed_m_s: Option<f64>, k: Option<f64>) -> Self {
        let bare = |value| Estimate::new(value, f64::NAN, "");
        Self { speed: speed_m_s.map(bare), k: k.map(bare) }
    }
}

/// What a way says of every drop, and how long it takes for each, ns.
pub(super) struct Worked {
    pub name: String,
    /// Whether it is what the program takes.
    pub is_default: bool,
    pub answers: Vec<Answer>,
    pub times_ns: Vec<f64>,
}

impl Worked {
    pub(super) fn named(name: &str, is_default: bool) -> Self {
        Self { name: name.to_owned(), is_default, answers: Vec::new(), times_ns: Vec::new() }
    }

    /// One answer more, timed; no answer is an empty one.
    pub(super) fn timed(&mut self, work: impl FnOnce() -> Option<Answer>) {
        let begun = Instant::now();
        let answer = black_box(work()).unwrap_or_default();
        self.times_ns.push(1e9 * begun.elapsed().as_secs_f64());
        self.answers.push(answer);
    }
}

/// What is held against the truth.
#[derive(Clone, Copy)]
pub(super) struct WayQuantity {
    pub family: &'static str,
    pub unit: &'static str,
    /// What a verdict needs.
    pub matters: f64,
    pub stated: fn(&Answer) -> Option<Estimate>,
    pub truth: fn(&Truth) -> Option<f64>,
    /// What the truth is divided by, of itself.
    pub scale: fn(f64) -> f64,
}

pub(super) const SPEED: WayQuantity = WayQuantity {
    family: "speed, from file to answer",
    unit: "% of the slap-down speed",
    matters: 1.0,
    stated: |answer| answer.speed,
    truth: |truth| truth.speed,
    scale: |speed_m_s| 100.0 / speed_m_s,
};

pub(super) const K: WayQuantity = WayQuantity {
    family: "k, from file to answer",
    unit: "1",
    matters: 0.01,
    stated: |answer| answer.k,
    truth: |truth| truth.k,
    scale: |_| 1.0,
};

/// A point a way and class, and one of all classes; a way that never says anything of the quantity is none
/// for it. The drops of a class stand together.
pub(super) fn scored(of: &WayQuantity, worked: &[Worked], drops: &[KnownDrop]) -> Vec<TrialPoint> {
    let mut classes: Vec<&'static str> = drops.iter().map(|drop| drop.class).collect();
    classes.dedup();
    classes.extend(drops.first().map(|_| ALL_CLASSES));
    let on_class = |class| worked.iter().map(move |way| point(of, way, drops, class));
    let points = classes.into_iter().flat_map(on_class);
    points.filter(|point| point.cases > 0 || point.method == READING).collect()
}

/// What a way says of the drops of a class, and how long it takes.
fn point(of: &WayQuantity, way: &Worked, drops: &[KnownDrop], class: &str) -> TrialPoint {
    let is_own = |i: &usize| class == ALL_CLASSES || drops[*i].class == class;
    let own: Vec<usize> = (0..drops.len()).filter(is_own).collect();
    let off = |i: &usize| {
        let (stated, truth) = (of.stated)(&way.answers[*i]).zip((of.truth)(&drops[*i].truth))?;
        let scale = (of.scale)(truth);
        Some((scale * (stated.value - truth).abs(), scale * stated.u95))
    };
    let said: Vec<(f64, f64)> = own.iter().filter_map(off).collect();
    let held = said.iter().filter(|(error, half_width)| error <= half_width).count();
    let (errors, mut half_widths): (Vec<f64>, Vec<f64>) = said.into_iter().unzip();
    let cases = errors.len();
    let promised = (cases > 0).then(|| robust::median(&mut half_widths)).filter(|u| u.is_finite());
    let [median_error, p95_error] = median_and_p95(errors);
    let mut taken_ns: Vec<f64> = own.iter().map(|i| way.times_ns[*i]).collect();
    taken_ns.sort_by(f64::total_cmp);
    let counted = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    TrialPoint {
        family: of.family.to_owned(),
        method: way.name.clone(),
        class: class.to_owned(),
        is_default: way.is_default,
        median_error,
        p95_error,
        error_unit: of.unit.to_owned(),
        time_ns: taken_ns[(taken_ns.len() - 1) / 2],
        cases: counted(cases),
        missing: counted(own.len() - cases),
        matters: of.matters,
        promised,
        held: promised.map(|_| as_f64(held) / as_f64(cases)),
    }
}

/// Median and 95th percentile, each that of a drop; what is no number counts as diverged.
fn median_and_p95(mut errors: Vec<f64>) -> [f64; 2] {
    for error in &mut errors {
        *error = if error.is_nan() { DIVERGED } else { error.abs().min(DIVERGED) };
    }
    errors.sort_by(f64::total_cmp);
    let Some(last) = errors.len().checked_sub(1) else { return [DIVERGED; 2] };
    [errors[last / 2], errors[(95 * last).div_ceil(100)]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_drops() {
        let bits = |values: [f64; 2]| values.map(f64::to_bits);
        assert_eq!(bits(median_and_p95(vec![3.0, -1.0, 2.0])), bits([2.0, 3.0]));
        assert_eq!(bits(median_and_p95(vec![f64::NAN, 1.0])), bits([1.0, DIVERGED]));
    }
}
