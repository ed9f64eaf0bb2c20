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

    /// One answer more, of so many calls that are timed together; no answer is an empty one.
    pub(super) fn timed(&mut self, calls: u32, mut work: impl FnMut() -> Option<Answer>) {
        let begun = Instant::now();
        for _ in 1..calls {
            black_box(work());
        }
        let answer = black_box(work()).unwrap_or_default();
        self.times_ns.push(1e9 * begun.elapsed().as_secs_f64() / f64::from(calls));
        self.answers.push(answer);
    }
}

/// What is held against the truth.
#[derive(Clone, Copy)]
pub(super) struct WayQuantity {
    pub family: &'static str,
    pub unit: &'static str,
    pub time_per: &'static str,
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
    time_per: "file",
    matters: 1.0,
    stated: |answer| answer.speed,
    truth: |truth| truth.speed,
    scale: |speed_m_s| 100.0 / speed_m_s,
};

pub(super) const K: WayQuantity = WayQuantity {
    family: "k, from file to answer",
    unit: "1",
    time_per: "file",
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
    let [lower_ns, time_ns, upper_ns] = quartiles(own.iter().map(|i| way.times_ns[*i]).collect());
    let counted = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    TrialPoint {
        family: of.family.to_owned(),
        method: way.name.clone(),
        class: class.to_owned(),
        is_default: way.is_default,
        is_on_front: false,
        median_error,
        p95_error,
        error_unit: of.unit.to_owned(),
        time_ns,
        time_quartiles_ns: [lower_ns, upper_ns],
        time_per: of.time_per.to_owned(),
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

/// Lower quartile, median and upper quartile; each the value of a drop, none in between.
fn quartiles(mut taken_ns: Vec<f64>) -> [f64; 3] {
    taken_ns.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarters| taken_ns[(taken_ns.len() - 1) * quarters / 4])
}

/// Two errors below this cannot be told apart: a few roundings of a double.
const ROUNDING: f64 = 1e-15;
/// Two errors or two times whose ratio is below this are alike: another seed, another run moves them as much.
const ALIKE: f64 = 1.1;

/// Marks the points on the front: no other of their family and class is at least as accurate (95th
/// percentile) and at least as fast, and better in one of the two.
///
/// Another is better only by more than 10 %, and faster only where the quartiles of the two times do not
/// overlap either.
pub(super) fn mark_front(points: &mut [TrialPoint]) {
    let is_beside =
        |a: &TrialPoint, b: &TrialPoint| a.cases > 0 && a.family == b.family && a.class == b.class;
    let error = |p: &TrialPoint| p.p95_error.max(ROUNDING);
    let is_faster = |a: &TrialPoint, b: &TrialPoint| {
        ALIKE * a.time_ns < b.time_ns && a.time_quartiles_ns[1] < b.time_quartiles_ns[0]
    };
    let beats = |a: &TrialPoint, b: &TrialPoint| {
        (ALIKE * error(a) < error(b) && !is_faster(b, a)) || (error(a) <= ALIKE * error(b) && is_faster(a, b))
    };
    let is_on_front =
        |p: &TrialPoint| p.cases > 0 && !points.iter().any(|other| is_beside(other, p) && beats(other, p));
    let front: Vec<bool> = points.iter().map(is_on_front).collect();
    for (point, is_on_front) in points.iter_mut().zip(front) {
        point.is_on_front = is_on_front;
    }
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

    #[test]
    fn quartiles_are_those_of_drops() {
        assert_eq!(
            quartiles(vec![5.0, 1.0, 3.0, 2.0, 4.0]).map(f64::to_bits),
            [2.0_f64, 3.0, 4.0].map(f64::to_bits)
        );
    }

    fn point(class: &str, p95_error: f64, time_ns: f64) -> TrialPoint {
        let time_quartiles_ns = [time_ns - 0.1, time_ns + 0.1];
        let class = class.into();
        TrialPoint { class, p95_error, time_ns, time_quartiles_ns, cases: 1, ..TrialPoint::default() }
    }

    fn front(mut points: Vec<TrialPoint>) -> Vec<bool> {
        mark_front(&mut points);
        points.iter().map(|p| p.is_on_front).collect()
    }

    #[test]
    fn the_front_is_what_no_other_beats() {
        let points = vec![
            point("a", 1e-3, 1.0),
            point("a", 1e-6, 5.0),
            point("a", 1e-5, 6.0),
            point("a", 1e-2, 1.05),
            point("b", 1.0, 9.0),
        ];
        assert_eq!(front(points), [true, true, false, false, true]);
    }

    #[test]
    fn roundings_are_alike_and_the_faster_wins() {
        assert_eq!(front(vec![point("a", 1e-16, 9.0), point("a", 9e-16, 5.0)]), [false, true]);
    }
}
