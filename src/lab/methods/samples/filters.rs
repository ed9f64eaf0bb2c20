//! The forms of a low-pass to their round-off and time, over cut-off and order.

use super::reference::{low_passed, worst_of_peak};
use crate::lab::chance::Chance;
use crate::lab::data::{TrialMap, TrialPart, TrialPeerWork, TrialRequest};
use crate::lab::methods::contest::{Contest, Purpose, by_class, map};
use crate::lab::methods::rivals::filter::{EndPadding, FilterForm, LowPass};
use rayon::prelude::*;
use std::f64::consts::PI;

const FILTER: Purpose = Purpose::of_samples("filter", "of the peak");

/// A form and whether it is computed in single precision.
type FilterMethod = (FilterForm, bool);

/// Rivals of the second order, where the fraction of the whole is a section.
const SECOND_ORDER: [FilterMethod; 5] = [
    (FilterForm::StateVariable, false),
    (FilterForm::DirectSections, false),
    (FilterForm::Fourier, false),
    (FilterForm::StateVariable, true),
    (FilterForm::DirectSections, true),
];

/// Rivals of higher orders.
const HIGHER_ORDER: [FilterMethod; 4] = [
    (FilterForm::StateVariable, false),
    (FilterForm::TransferFunction, false),
    (FilterForm::DirectSections, false),
    (FilterForm::Fourier, false),
];

/// Samples of the shortest record: a turn of the clock is then work, not overhead.
const SHORTEST: usize = 20_000;

/// A record that a low-pass of this order and design frequency over sample rate is laid on.
struct FilterCase {
    order: u32,
    design: f64,
    samples: Vec<f64>,
    narrowed: Vec<f32>,
    truth: Vec<f64>,
}

/// What a filter makes of it, in its own precision.
enum Filtered {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl FilterCase {
    #[allow(clippy::cast_possible_truncation, reason = "single precision is what is tried")]
    fn of((order, design): (u32, f64), seed: u64, number: u32) -> Self {
        let samples = scene(order, design, &mut Chance::new(seed, u64::from(number)), f64::from(number));
        let truth = low_passed(&samples, order, design);
        Self { order, design, narrowed: samples.iter().map(|x| *x as f32).collect(), samples, truth }
    }
}

fn contest(methods: &[FilterMethod]) -> Contest<FilterMethod, FilterCase, Filtered> {
    Contest {
        purpose: FILTER,
        methods: methods.to_vec(),
        default: (FilterForm::default(), false),
        name: |(form, single)| format!("{}{}", form.as_str(), if single { ", f32" } else { "" }),
        run: |(form, single), case| {
            let filter = LowPass::new(case.order, case.design, form, EndPadding::Zero)?;
            Some(if single {
                Filtered::Single(filter.apply(&case.narrowed))
            } else {
                Filtered::Double(filter.apply(&case.samples))
            })
        },
        error: |case, filtered| match filtered {
            Filtered::Single(made) => worst_of_peak(made.into_iter().map(f64::from), &case.truth),
            Filtered::Double(made) => worst_of_peak(made.into_iter(), &case.truth),
        },
        parts: |case| case.samples.len(),
    }
}

/// A pulse with noise in the middle of silence so long that the filter forgets to 1e-16 before either end.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples, positive and below 2^52"
)]
fn scene(order: u32, design: f64, chance: &mut Chance, number: f64) -> Vec<f64> {
    // e^(−R 2π f t) = 1e-16 after 5.9 / (R f), R = sin(π / 2n) of the slowest pole.
    let silence = 5.9 / ((PI / f64::from(2 * order)).sin() * design);
    let half = 2.0 / design;
    let count = ((2.0 * (silence + half)).ceil() as usize).max(SHORTEST);
    let middle = 0.5 * count as f64 + number * 0.37;
    let at = |i: usize| {
        let t = (i as f64 - middle) / half;
        if t.abs() >= 1.0 {
            return 0.0;
        }
        (0.5 * PI * t).cos().powi(4) + 0.01 * chance.normal()
    };
    (0..count).map(at).collect()
}

fn class_name(order: u32, design: f64) -> String {
    format!("order {order}, f/fs = {design:e}")
}

/// Where the forms fail: sample rate over cut-off, and order.
fn maps(request: &TrialRequest) -> Vec<TrialMap> {
    let lines = |methods: &[FilterMethod], classes: &[(u32, f64)]| {
        contest(methods).lines(classes, |class| vec![FilterCase::of(*class, request.seed, 0)])
    };
    let last = if request.quick { 10 } else { 12 };
    let ratios: Vec<f64> = (2..=last).map(|half| 10_f64.powf(0.5 * f64::from(half))).collect();
    let of_order = |order: u32| ratios.iter().map(|ratio| (order, 1.0 / ratio)).collect::<Vec<_>>();
    let mut rate_lines = lines(&SECOND_ORDER, &of_order(2));
    // Reference and memory of the fourth order reach twice as far.
    let least = if request.quick { 0.9e-4 } else { 0.9e-5 };
    let fourth: Vec<(u32, f64)> = of_order(4).into_iter().filter(|(_, design)| *design > least).collect();
    for mut line in lines(&HIGHER_ORDER[1..3], &fourth) {
        line.method.push_str(", order 4");
        line.errors.resize(ratios.len(), None);
        line.noticed.resize(ratios.len(), None);
        rate_lines.push(line);
    }
    let orders: Vec<(u32, f64)> = (1..=10).map(|half| (2 * half, 1e-2)).collect();
    let order_lines = lines(&HIGHER_ORDER, &orders);
    let orders = orders.into_iter().map(|(order, _)| f64::from(order)).collect();
    let error = "error, of the peak";
    let over_rate = [
        "cutoff-over-rate",
        "Round-off of the forms as the cut-off falls against the sample rate",
        "sample rate over design frequency",
        error,
    ];
    let over_order = [
        "filter-order",
        "Round-off of the forms as the order rises, f/fs = 0.01",
        "order of one pass",
        error,
    ];
    vec![map(over_rate, ratios, 0.01, rate_lines), map(over_order, orders, 0.01, order_lines)]
}

/// What programs of others are given.
pub(super) fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    let work = |class: (u32, f64)| {
        let FilterCase { order, design, samples, truth, .. } = FilterCase::of(class, request.seed, 0);
        TrialPeerWork {
            family: FILTER.name,
            class: class_name(order, design),
            low_pass: Some((order, design)),
            drop: None,
            samples,
            truth,
            error_unit: FILTER.error_unit,
        }
    };
    [(2, 1e-1), (2, 1e-2), (2, 1e-3), (2, 1e-4), (4, 1e-2), (4, 1e-3), (4, 1e-4)].map(work).to_vec()
}

/// The whole job.
pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let second = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5].map(|design| (2, design));
    let fourth = [1e-2, 1e-3, 1e-4].map(|design| (4, design));
    let points = |&(order, design): &(u32, f64)| {
        let numbers = match (request.quick, design < 1e-4) {
            (true, true) => 0..1,
            (true, false) | (false, true) => 0..3,
            (false, false) => 0..15,
        };
        let case = |number: u32| FilterCase::of((order, design), request.seed, number);
        let cases: Vec<FilterCase> = numbers.into_par_iter().map(case).collect();
        let methods: &[FilterMethod] = if order == 2 { &SECOND_ORDER } else { &HIGHER_ORDER };
        contest(methods).points(&class_name(order, design), &cases, 1, request)
    };
    let part = by_class(&[&second[..], &fourth].concat(), &|share| progress(0.7 * share), points);
    TrialPart { maps: maps(request), ..part }
}
