//! The forms of a low-pass to their round-off and time, over cut-off and order.

use super::reference::low_passed;
use super::summary::{Family, chance, silent_line, worst_of_peak};
use crate::lab::data::{TrialLine, TrialMap, TrialPart, TrialPeerWork, TrialPoint, TrialRequest};
use crate::lab::methods::rivals::filter::{EndPadding, FilterForm, LowPass};
use crate::lab::methods::timing::{Effort, Work, in_turn};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::hint::black_box;

const FAMILY: Family = Family { name: "filter", error_unit: "of the peak", time_per: "sample" };

/// A form and whether it is computed in single precision.
type Method = (FilterForm, bool);

/// Rivals of the second order, where the fraction of the whole is a section.
const SECOND_ORDER: [Method; 5] = [
    (FilterForm::StateVariable, false),
    (FilterForm::DirectSections, false),
    (FilterForm::Fourier, false),
    (FilterForm::StateVariable, true),
    (FilterForm::DirectSections, true),
];

/// Rivals of higher orders.
const HIGHER_ORDER: [Method; 4] = [
    (FilterForm::StateVariable, false),
    (FilterForm::TransferFunction, false),
    (FilterForm::DirectSections, false),
    (FilterForm::Fourier, false),
];

/// Samples of the shortest record: a turn of the clock is then work, not overhead.
const SHORTEST: usize = 20_000;

fn name((form, single): Method) -> String {
    format!("{}{}", form.as_str(), if single { ", f32" } else { "" })
}

/// A pulse with noise in the middle of silence so long that the filter forgets to 1e-16 before either end.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples, positive and below 2^52"
)]
fn scene(order: u32, design: f64, seed: u64, case: u32) -> Vec<f64> {
    // e^(−R 2π f t) = 1e-16 after 5.9 / (R f), R = sin(π / 2n) of the slowest pole.
    let silence = 5.9 / ((PI / f64::from(2 * order)).sin() * design);
    let half = 2.0 / design;
    let count = ((2.0 * (silence + half)).ceil() as usize).max(SHORTEST);
    let mut generator = chance(seed, case);
    let middle = 0.5 * count as f64 + f64::from(case) * 0.37;
    let at = |i: usize| {
        let t = (i as f64 - middle) / half;
        if t.abs() >= 1.0 {
            return 0.0;
        }
        let noise: f64 = StandardNormal.sample(&mut generator);
        (0.5 * PI * t).cos().powi(4) + 0.01 * noise
    };
    (0..count).map(at).collect()
}

/// Error of a method on one scene, of the peak; `None` where there is no such filter.
fn error((form, single): Method, order: u32, design: f64, (x, truth): (&[f64], &[f64])) -> Option<f64> {
    let filter = LowPass::new(order, design, form, EndPadding::Zero)?;
    Some(if single {
        let made = filter.apply(&narrowed(x));
        worst_of_peak(made.into_iter().map(f64::from), truth)
    } else {
        worst_of_peak(filter.apply(x).into_iter(), truth)
    })
}

#[allow(clippy::cast_possible_truncation, reason = "single precision is what is tried")]
fn narrowed(samples: &[f64]) -> Vec<f32> {
    samples.iter().map(|x| *x as f32).collect()
}

fn class_name(order: u32, design: f64) -> String {
    format!("order {order}, f/fs = {design:e}")
}

/// Points of one order and cut-off.
fn class_points(
    request: &TrialRequest,
    (order, design): (u32, f64),
    effort: Option<Effort>,
) -> Vec<TrialPoint> {
    let methods: &[Method] = if order == 2 { &SECOND_ORDER } else { &HIGHER_ORDER };
    let cases = match (request.quick, design < 1e-4) {
        (true, true) => 1,
        (true, false) | (false, true) => 3,
        (false, false) => 15,
    };
    let class = class_name(order, design);
    let per_case: Vec<Vec<f64>> = (0..cases)
        .into_par_iter()
        .map(|case| {
            let x = scene(order, design, request.seed, case);
            let truth = low_passed(&x, order, design);
            methods.iter().map(|m| error(*m, order, design, (&x, &truth)).unwrap_or(f64::NAN)).collect()
        })
        .collect();
    let timings = effort.map(|effort| {
        let x = scene(order, design, request.seed, 0);
        let x32 = narrowed(&x);
        let made = |form| LowPass::new(order, design, form, EndPadding::Zero);
        let mut work: Vec<Work> = methods
            .iter()
            .map(|&(form, single)| -> Work {
                let (filter, x, x32) = (made(form), &x, &x32);
                if single {
                    Box::new(move || drop(black_box(filter.as_ref().map(|f| f.apply(black_box(x32))))))
                } else {
                    Box::new(move || drop(black_box(filter.as_ref().map(|f| f.apply(black_box(x))))))
                }
            })
            .collect();
        in_turn(&mut work, effort).into_iter().map(|t| t.per(x.len())).collect::<Vec<_>>()
    });
    let point = |(i, method): (usize, &Method)| {
        let errors = per_case.iter().map(|errors| errors[i]).collect();
        let timing = timings.as_ref().and_then(|t| t.get(i).copied());
        let is_default = *method == (FilterForm::default(), false);
        FAMILY.point((&name(*method), &class), is_default, errors, timing)
    };
    methods.iter().enumerate().map(point).collect()
}

/// Speed-accuracy points of every class.
pub(super) fn points(request: &TrialRequest, effort: Option<Effort>, done: &dyn Fn(f64)) -> Vec<TrialPoint> {
    let second = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5].map(|design| (2, design));
    let fourth = [1e-2, 1e-3, 1e-4].map(|design| (4, design));
    let classes = [&second[..], &fourth].concat();
    let mut points = Vec::new();
    for (class, share) in classes.iter().zip(1_u32..) {
        points.extend(class_points(request, *class, effort));
        done(f64::from(share) / 8.0);
    }
    points
}

/// Errors of `methods` over (order, cut-off over rate) at each stress.
fn lines(methods: &[Method], stresses: &[(u32, f64)], seed: u64) -> Vec<TrialLine> {
    let columns: Vec<Vec<Option<f64>>> = stresses
        .par_iter()
        .map(|&(order, design)| {
            let x = scene(order, design, seed, 0);
            let truth = low_passed(&x, order, design);
            methods.iter().map(|m| error(*m, order, design, (&x, &truth))).collect()
        })
        .collect();
    let line = |(i, method): (usize, &Method)| {
        silent_line(&name(*method), columns.iter().map(|column| column[i]).collect())
    };
    methods.iter().enumerate().map(line).collect()
}

/// Where the forms fail: sample rate over cut-off, and order.
pub(super) fn maps(request: &TrialRequest) -> Vec<TrialMap> {
    let last = if request.quick { 10 } else { 12 };
    let ratios: Vec<f64> = (2..=last).map(|half| 10_f64.powf(0.5 * f64::from(half))).collect();
    let over_rate: Vec<(u32, f64)> = ratios.iter().map(|ratio| (2, 1.0 / ratio)).collect();
    let fourth: Vec<(u32, f64)> = ratios.iter().map(|ratio| (4, 1.0 / ratio)).collect();
    let mut rate_lines = lines(&SECOND_ORDER, &over_rate, request.seed);
    // Reference and memory of the fourth order reach twice as far.
    let least = if request.quick { 0.9e-4 } else { 0.9e-5 };
    let reach = fourth.iter().take_while(|(_, design)| *design > least).count();
    for mut line in lines(&HIGHER_ORDER[1..3], &fourth[..reach], request.seed) {
        line.method.push_str(", order 4");
        line.errors.resize(ratios.len(), None);
        line.noticed.resize(ratios.len(), None);
        rate_lines.push(line);
    }
    let orders: Vec<(u32, f64)> = (1..=10).map(|half| (2 * half, 1e-2)).collect();
    vec![
        TrialMap {
            name: "cutoff-over-rate".to_owned(),
            title: "Round-off of the forms as the cut-off falls against the sample rate".to_owned(),
            stress: "sample rate over design frequency".to_owned(),
            is_log: true,
            stresses: ratios,
            error: "error, of the peak".to_owned(),
            limit: 0.01,
            lines: rate_lines,
        },
        TrialMap {
            name: "filter-order".to_owned(),
            title: "Round-off of the forms as the order rises, f/fs = 0.01".to_owned(),
            stress: "order of one pass".to_owned(),
            is_log: false,
            stresses: orders.iter().map(|(order, _)| f64::from(*order)).collect(),
            error: "error, of the peak".to_owned(),
            limit: 0.01,
            lines: lines(&HIGHER_ORDER, &orders, request.seed),
        },
    ]
}

/// What programs of others are given.
pub(super) fn peer_work(request: &TrialRequest) -> Vec<TrialPeerWork> {
    let work = |(order, design): (u32, f64)| {
        let samples = scene(order, design, request.seed, 0);
        let truth = low_passed(&samples, order, design);
        let (family, error_unit) = (FAMILY.name, FAMILY.error_unit);
        TrialPeerWork {
            family,
            class: class_name(order, design),
            low_pass: Some((order, design)),
            drop: None,
            samples,
            truth,
            error_unit,
        }
    };
    [(2, 1e-1), (2, 1e-2), (2, 1e-3), (2, 1e-4), (4, 1e-2), (4, 1e-3), (4, 1e-4)].map(work).to_vec()
}

/// The whole job.
pub(super) fn run(request: &TrialRequest, done: &dyn Fn(f64)) -> TrialPart {
    let points = points(request, Some(Effort::of(request.quick)), &|share| done(0.7 * share));
    TrialPart { points, maps: maps(request) }
}
