//! Runs every reconstruction method and selects the simplest one that explains the recording.

use super::inputs::{Inputs, UncertainInput};
use super::propagate::{Model, Propagated};
use super::steps::has_lost_step;
use super::untested::{self, SilentMistake};
use super::{FitData, Reconstruct};
use crate::data::{
    CONSISTENT_U, CheckKind, Consistency, Contribution, Estimate, FlightFit, Method, MethodCandidate,
    MethodChoice, OpenedInput, Quantities, Tolerances, Untested,
};
use crate::numerics::prior_fit::{PriorFit, derivatives};

/// If the consistency checks determine lost velocity steps they check nothing, and the intervals of the joint
/// fit are widened by this: with it they hold 19 of 20 simulated drops.
const UNCHECKED_FACTOR: f64 = 2.0;

/// Relative half-width of an unknown length.
const OPEN_LENGTH: f64 = 0.1;

/// A higher method is selected if it narrows an interval to less than this share: with 0.75 the joint fit was
/// rejected in three of five drops with an axial channel, although it determines their speed with a quarter
/// less error.
const NARROWER_SHARE: f64 = 0.9;

/// Steps over the contact for the slopes of further numbers, the largest force among them: with twice as many
/// no half-width of a fixture changes by more than 0.4 %.
const SPREAD_STEPS: usize = 100;

/// A method with its complete result.
struct MethodRun {
    candidate: MethodCandidate,
    propagated: Propagated,
}

/// Numbers as a function of the inputs, for [`SelectedMethod::propagate_numbers`].
pub type NumbersOf<'a> = &'a (dyn Fn(&Inputs) -> Option<Vec<f64>> + Sync);

/// Result of the selected method, and the inputs of that result.
pub struct SelectedMethod {
    /// The numbers.
    pub quantities: Quantities,
    /// Contribution of each input to their uncertainty, largest first.
    pub budget: Vec<Contribution>,
    /// The selected method, and the others.
    pub choice: MethodChoice,
    /// Inputs with the corrections of the selected method.
    pub taken: Inputs,
    /// Inputs of which another number would explain a failed check.
    pub opened_inputs: Vec<OpenedInput>,
    base: Inputs,
    inputs: Vec<UncertainInput>,
    fit: PriorFit,
    widened: f64,
    silent: Vec<SilentMistake>,
}

impl SelectedMethod {
    /// Lists the inputs that this recording cannot check, largest effect first; `finds` says if a check of
    /// the velocity steps would find a mistake.
    pub fn find_untested(&self, finds: &dyn Fn(&FlightFit) -> bool) -> Vec<Untested> {
        untested::list_untested(&self.silent, &self.base, &self.inputs, finds)
    }

    /// Copies the stated inputs, each shifted by `by_u` of its standard uncertainties.
    pub fn draw_inputs(&self, mut by_u: impl FnMut() -> f64) -> Inputs {
        let by_u: Vec<f64> = self.inputs.iter().map(|_| by_u()).collect();
        self.base.shift(&self.inputs, &by_u)
    }

    /// Evaluates numbers that follow from the inputs, each with its standard uncertainty; `None` if `of`
    /// fails near the selected inputs.
    pub fn propagate_numbers(&self, of: NumbersOf) -> Option<Vec<(f64, f64)>> {
        let at_u = &self.fit.unknowns;
        let values = of(&self.taken)?;
        let base = self.base.with_contact_steps(SPREAD_STEPS);
        let beside = |by_u: &[f64]| of(&base.shift(&self.inputs, by_u));
        let slopes = derivatives(&beside(at_u)?, &beside, at_u, &|i| self.inputs[i].jumps())?;
        let by_datum = slopes * &self.fit.response * self.widened;
        Some(values.into_iter().enumerate().map(|(i, value)| (value, by_datum.row(i).norm())).collect())
    }
}

/// Runs all methods and selects one: the simplest whose residuals noise and tolerances explain, and whose
/// answer no higher one would change by more than its interval or determine much better.
///
/// `None` if the motion cannot be determined.
pub fn run_methods(measured: &FitData, reconstruct: Reconstruct) -> Option<SelectedMethod> {
    let model = Model::new(measured, reconstruct)?;
    let flight = model.propagate_stated()?;
    let joint = model.fit_jointly();
    let closures = model.closures();
    let opened_inputs = model.opened_inputs(&closures).unwrap_or_default();
    let mut steps = vec![flight_method(measured, flight, &closures)];
    let (mut widened, mut why) = interval_factor(&closures, has_lost_step(measured));
    if let Some(fit) = &joint {
        if closures.iter().any(|c| c.kind == CheckKind::SecondTurning && c.largest_residual() > CONSISTENT_U)
        {
            let by_length = open_length_factor(measured, reconstruct, &model.propagate(fit, 1.0)?.quantities);
            if by_length > widened {
                (widened, why) = (by_length, "a wrong length would explain the second impact's rotation");
            }
        }
        let step = |propagated| joint_method(propagated, fit.chi_square, closures.len(), widened, why);
        steps.extend(model.propagate(fit, widened).map(step));
    }
    let taken = select_step(&steps);
    let reason = reason(&steps, taken);
    let rung = steps[taken].candidate.rung;
    let is_joint = rung == Method::Joint;
    let choice = MethodChoice {
        rung,
        reason,
        chi_square: joint.as_ref().map(|fit| (fit.chi_square, closures.len())),
        adjustments: joint.as_ref().map_or_else(Vec::new, |fit| model.adjustments(fit)),
        closures,
        candidates: steps.iter().map(|s| s.candidate.clone()).collect(),
    };
    let Propagated { quantities, budget } = steps.swap_remove(taken).propagated;
    let fit = joint.filter(|_| is_joint).unwrap_or_else(|| PriorFit::from_priors(model.inputs.len()));
    let widened = if is_joint { widened } else { 1.0 };
    let influences = model.influences(&fit)?;
    let silent = untested::find_silent(measured, &model.inputs, &influences, &quantities);
    let Model { base, inputs, .. } = model;
    Some(SelectedMethod {
        quantities,
        budget,
        choice,
        taken: base.shift(&inputs, &fit.unknowns),
        opened_inputs,
        base,
        inputs,
        fit,
        widened,
        silent,
    })
}

fn step(rung: Method, propagated: Propagated, consistent: bool, residual: String) -> MethodRun {
    let Quantities { speed, k, .. } = propagated.quantities;
    MethodRun { candidate: MethodCandidate { rung, speed, k: Some(k), consistent, residual }, propagated }
}

/// (a) The flight fitted with modes and drift.
fn flight_method(measured: &FitData, propagated: Propagated, closures: &[Consistency]) -> MethodRun {
    let left_m_s = measured.flight.plateaus.iter().map(|p| p.residual_m_s).fold(0.0, f64::max);
    let name = match (measured.flight.modes.len(), measured.flight.drift) {
        (0, false) => "no mode, no drift".to_owned(),
        (n, drift) => {
            format!("{n} mode{}{}", if n == 1 { "" } else { "s" }, if drift { " and drift" } else { "" })
        }
    };
    let residual = format!("{left_m_s:.3} m/s about {name}; {}", name_worst(closures));
    // A lost step is so uncertain that no check counts as failed, however wrong the step is: the checks then
    // confirm nothing.
    let consistent =
        closures.iter().all(|c| c.largest_residual() <= CONSISTENT_U) && !has_lost_step(measured);
    step(Method::Flight, propagated, consistent, residual)
}

/// Factor by which the intervals of a joint fit are widened, and its reason: data that contradict one another
/// by more than chance (Birge 1932)   (31b), or checks that are spent on a lost step.
fn interval_factor(closures: &[Consistency], has_lost_step: bool) -> (f64, &'static str) {
    let by_misses = closures.iter().map(|c| c.largest_residual() / CONSISTENT_U).fold(1.0, f64::max);
    if has_lost_step && by_misses < UNCHECKED_FACTOR {
        (UNCHECKED_FACTOR, "a closure is spent on a lost velocity step")
    } else {
        (by_misses, "a closure is missed by more than chance")
    }
}

/// Factor by which the intervals of a joint fit must be widened to hold its result if the length is open.
fn open_length_factor(measured: &FitData, reconstruct: Reconstruct, stated: &Quantities) -> f64 {
    let tolerances = Tolerances { length: OPEN_LENGTH, ..measured.tolerances };
    let open = Model::new(&FitData { tolerances, ..*measured }, reconstruct)
        .and_then(|open| open.propagate(&open.fit_jointly()?, 0.0))
        .map(|open| open.quantities);
    let apart = |(a, b): (Estimate, Estimate)| (a.value - b.value).abs() / a.u95;
    open.map_or(1.0, |open| apart((stated.k, open.k)).max(stated.speed.zip(open.speed).map_or(0.0, apart)))
}

/// (b) Everything fitted within its tolerance.
fn joint_method(
    propagated: Propagated,
    chi_square: f64,
    degrees: usize,
    widened: f64,
    why: &'static str,
) -> MethodRun {
    let noun = if degrees == 1 { "observable" } else { "observables" };
    let mut residual = format!("χ² = {chi_square:.1} for {degrees} {noun}");
    if widened > 1.0 {
        residual = format!("{residual}, intervals widened {widened:.1} times: {why}");
    }
    step(Method::Joint, propagated, true, residual)
}

/// Names the check with the largest miss.
fn name_worst(closures: &[Consistency]) -> String {
    closures.iter().max_by(|a, b| a.largest_residual().total_cmp(&b.largest_residual())).map_or_else(
        || "nothing to close on".to_owned(),
        |c| format!("{} off by {} ({:.1} u)", c.name, c.miss, c.largest_residual()),
    )
}

/// The first method that is consistent and that no higher one would move out of the narrower of both
/// intervals or determine much better; else the last.
fn select_step(steps: &[MethodRun]) -> usize {
    (0..steps.len())
        .find(|&i| {
            let own = &steps[i].candidate;
            own.consistent && steps[i + 1..].iter().all(|higher| is_stable(own, &higher.candidate))
        })
        .unwrap_or(steps.len() - 1)
}

fn is_stable(own: &MethodCandidate, next: &MethodCandidate) -> bool {
    let within = |a: Option<Estimate>, b: Option<Estimate>| match (a, b) {
        (Some(a), Some(b)) => (a.value - b.value).abs() <= a.u95.min(b.u95) && b.u95 > NARROWER_SHARE * a.u95,
        (None, None) => true,
        _ => false,
    };
    within(own.speed, next.speed) && within(own.k, next.k)
}

fn words(rung: Method) -> &'static str {
    match rung {
        Method::Flight => "the planar motion with modes and drift fitted to the flight",
        Method::Joint => "the joint fit of all inputs within their tolerances",
    }
}

/// The reason for this method, and what the next one would change.
fn reason(steps: &[MethodRun], taken: usize) -> String {
    let own = &steps[taken].candidate;
    let mut text = format!("Taken: {}", words(own.rung));
    if let Some(below) = taken.checked_sub(1).map(|i| &steps[i].candidate) {
        let why = if below.consistent {
            format!(
                "it changes what {} says by more than its interval, or knows it better by a tenth",
                words(below.rung)
            )
        } else {
            format!("{} leaves {}", words(below.rung), below.residual)
        };
        text = format!("{text}, because {why}");
    }
    if let Some(next) = steps.get(taken + 1).map(|s| &s.candidate) {
        let change = |a: Option<Estimate>, b: Option<Estimate>| a.zip(b).map(|(a, b)| b.value - a.value);
        let speed =
            change(own.speed, next.speed).map_or(String::new(), |d| format!("the speed by {d:+.2} m/s and "));
        let k = change(own.k, next.k).map_or(String::new(), |d| format!("k by {d:+.3}"));
        text = format!("{text}; {} would change {speed}{k}, within the interval", words(next.rung));
    }
    text + "."
}
