//! What each rung of the reconstruction says, to the simplest one that explains the recording.

use super::inputs::{Inputs, UncertainInput};
use super::propagate::{Model, Propagated};
use super::steps::has_lost_step;
use super::untested::{self, SilentMistake};
use super::{FitData, Reconstruct};
use crate::data::{
    Closure, ClosureKind, Contribution, Estimate, FlightFit, MET_U, Opening, Quantities,
    ReconstructionCandidate, ReconstructionChoice, ReconstructionRung, Tolerances, Untested,
};
use crate::numerics::prior_fit::{PriorFit, derivatives};

/// Where the closures tell lost velocity steps they test nothing, and the intervals of the joint fit are
/// widened by this: with it they hold 19 of 20 simulated drops.
const UNTESTED: f64 = 2.0;

/// Half-width of a length that is open, as a share of it.
const OPEN_LENGTH: f64 = 0.1;

/// A higher rung is taken where it narrows an interval to less than this share: with 0.75 the joint fit was
/// kept back in three of five drops with an axial channel, whose speed it tells with a quarter less error.
const NARROWED: f64 = 0.9;

/// Steps over the contact that the slopes of further numbers are taken with, the largest force among them:
/// with twice as many no half-width of a fixture moves by more than 0.4 % of itself.
const SPREAD_STEPS: usize = 100;

/// A rung with everything that it says.
struct RungStep {
    candidate: ReconstructionCandidate,
    propagated: Propagated,
}

/// Numbers as a function of the inputs, such as [`RungTaken::spread`] takes it.
pub type NumbersOf<'a> = &'a (dyn Fn(&Inputs) -> Option<Vec<f64>> + Sync);

/// What the rung taken says, and the inputs that it says it with.
pub struct RungTaken {
    /// The numbers.
    pub quantities: Quantities,
    /// What each input contributes to their uncertainty, largest first.
    pub budget: Vec<Contribution>,
    /// The rung, and the others.
    pub choice: ReconstructionChoice,
    /// The inputs as the rung has them.
    pub taken: Inputs,
    /// Where a closure is missed, the inputs of which another number would explain it.
    pub openings: Vec<Opening>,
    base: Inputs,
    inputs: Vec<UncertainInput>,
    fit: PriorFit,
    widened: f64,
    silent: Vec<SilentMistake>,
}

impl RungTaken {
    /// What nothing in the recording tests, largest effect first; `finds` says whether a check of the
    /// velocity steps would find a mistake.
    pub fn untested(&self, finds: &dyn Fn(&FlightFit) -> bool) -> Vec<Untested> {
        untested::untested(&self.silent, &self.base, &self.inputs, finds)
    }

    /// The inputs as stated, each moved by so many of its standard uncertainties.
    pub fn drawn(&self, mut by_u: impl FnMut() -> f64) -> Inputs {
        let by_u: Vec<f64> = self.inputs.iter().map(|_| by_u()).collect();
        self.base.moved(&self.inputs, &by_u)
    }

    /// Numbers that follow from the inputs, each with its standard uncertainty; `None` where `of` fails near
    /// the inputs taken.
    pub fn spread(&self, of: NumbersOf) -> Option<Vec<(f64, f64)>> {
        let at_u = &self.fit.unknowns;
        let values = of(&self.taken)?;
        let base = self.base.in_steps(SPREAD_STEPS);
        let beside = |by_u: &[f64]| of(&base.moved(&self.inputs, by_u));
        let slopes = derivatives(&beside(at_u)?, &beside, at_u, &|i| self.inputs[i].jumps())?;
        let by_datum = slopes * &self.fit.response * self.widened;
        Some(values.into_iter().enumerate().map(|(i, value)| (value, by_datum.row(i).norm())).collect())
    }
}

/// Every rung and the one taken: the simplest whose residuals are within what noise and tolerances explain,
/// and whose answer no higher one would change by more than its interval or know much better.
///
/// `None` where the motion cannot be determined.
pub fn ladder(measured: &FitData, reconstruct: Reconstruct) -> Option<RungTaken> {
    let model = Model::new(measured, reconstruct)?;
    let flight = model.by_stated_inputs()?;
    let joint = model.joint();
    let closures = model.closures();
    let openings = model.openings(&closures).unwrap_or_default();
    let mut steps = vec![by_flight(measured, flight, &closures)];
    let (mut widened, mut why) = widened(&closures, has_lost_step(measured));
    if let Some(fit) = &joint {
        if closures.iter().any(|c| c.kind == ClosureKind::SecondTurning && c.most_in_u() > MET_U) {
            let by_length = by_open_length(measured, reconstruct, &model.propagate(fit, 1.0)?.quantities);
            if by_length > widened {
                (widened, why) = (by_length, "a wrong length would explain the second impact's rotation");
            }
        }
        let step = |propagated| by_joint(propagated, fit.chi_square, closures.len(), widened, why);
        steps.extend(model.propagate(fit, widened).map(step));
    }
    let taken = taken(&steps);
    let reason = reason(&steps, taken);
    let rung = steps[taken].candidate.rung;
    let is_joint = rung == ReconstructionRung::Joint;
    let choice = ReconstructionChoice {
        rung,
        reason,
        chi_square: joint.as_ref().map(|fit| (fit.chi_square, closures.len())),
        adjustments: joint.as_ref().map_or_else(Vec::new, |fit| model.adjustments(fit)),
        closures,
        candidates: steps.iter().map(|s| s.candidate.clone()).collect(),
    };
    let Propagated { quantities, budget } = steps.swap_remove(taken).propagated;
    let fit = joint.filter(|_| is_joint).unwrap_or_else(|| PriorFit::of_priors(model.inputs.len()));
    let widened = if is_joint { widened } else { 1.0 };
    let influences = model.influences(&fit)?;
    let silent = untested::silent(measured, &model.inputs, &influences, &quantities);
    let Model { base, inputs, .. } = model;
    Some(RungTaken {
        quantities,
        budget,
        choice,
        taken: base.moved(&inputs, &fit.unknowns),
        openings,
        base,
        inputs,
        fit,
        widened,
        silent,
    })
}

fn step(rung: ReconstructionRung, propagated: Propagated, consistent: bool, residual: String) -> RungStep {
    let Quantities { speed, k, .. } = propagated.quantities;
    RungStep {
        candidate: ReconstructionCandidate { rung, speed, k: Some(k), consistent, residual },
        propagated,
    }
}

/// (a) The flight fitted with modes and drift.
fn by_flight(measured: &FitData, propagated: Propagated, closures: &[Closure]) -> RungStep {
    let left_m_s = measured.flight.plateaus.iter().map(|p| p.residual_m_s).fold(0.0, f64::max);
    let what = match (measured.flight.modes.len(), measured.flight.drift) {
        (0, false) => "no mode, no drift".to_owned(),
        (n, drift) => {
            format!("{n} mode{}{}", if n == 1 { "" } else { "s" }, if drift { " and drift" } else { "" })
        }
    };
    let residual = format!("{left_m_s:.3} m/s about {what}; {}", worst(closures));
    // A lost step is so uncertain that no closure counts as missed, however wrong the step is: the closures
    // then say nothing.
    let consistent = meets(closures) && !has_lost_step(measured);
    step(ReconstructionRung::Flight, propagated, consistent, residual)
}

/// How much wider the intervals of a joint fit are, and why: data that contradict one another by more than
/// chance (Birge 1932)   (31b), or closures that are spent on a lost step.
fn widened(closures: &[Closure], has_lost_step: bool) -> (f64, &'static str) {
    let by_misses = closures.iter().map(|c| c.most_in_u() / MET_U).fold(1.0, f64::max);
    if has_lost_step && by_misses < UNTESTED {
        (UNTESTED, "a closure is spent on a lost velocity step")
    } else {
        (by_misses, "a closure is missed by more than chance")
    }
}

/// How much wider the intervals of a joint fit must be to hold what it says where the length is open.
fn by_open_length(measured: &FitData, reconstruct: Reconstruct, stated: &Quantities) -> f64 {
    let tolerances = Tolerances { length: OPEN_LENGTH, ..measured.tolerances };
    let open = Model::new(&FitData { tolerances, ..*measured }, reconstruct)
        .and_then(|open| open.propagate(&open.joint()?, 0.0))
        .map(|open| open.quantities);
    let apart = |(a, b): (Estimate, Estimate)| (a.value - b.value).abs() / a.u95;
    open.map_or(1.0, |open| apart((stated.k, open.k)).max(stated.speed.zip(open.speed).map_or(0.0, apart)))
}

/// (b) Everything fitted within its tolerance.
fn by_joint(
    propagated: Propagated,
    chi_square: f64,
    degrees: usize,
    widened: f64,
    why: &'static str,
) -> RungStep {
    let noun = if degrees == 1 { "observable" } else { "observables" };
    let mut residual = format!("χ² = {chi_square:.1} for {degrees} {noun}");
    if widened > 1.0 {
        residual = format!("{residual}, intervals widened {widened:.1} times: {why}");
    }
    step(ReconstructionRung::Joint, propagated, true, residual)
}

fn meets(closures: &[Closure]) -> bool {
    closures.iter().all(|c| c.most_in_u() <= MET_U)
}

/// The closure that is missed most.
fn worst(closures: &[Closure]) -> String {
    closures.iter().max_by(|a, b| a.most_in_u().total_cmp(&b.most_in_u())).map_or_else(
        || "nothing to close on".to_owned(),
        |c| format!("{} off by {} ({:.1} u)", c.name, c.miss, c.most_in_u()),
    )
}

/// The first rung that is consistent and that no higher one would move out of the narrower of both intervals
/// or know much better; else the last.
fn taken(steps: &[RungStep]) -> usize {
    (0..steps.len())
        .find(|&i| {
            let own = &steps[i].candidate;
            own.consistent && steps[i + 1..].iter().all(|higher| stays(own, &higher.candidate))
        })
        .unwrap_or(steps.len() - 1)
}

fn stays(own: &ReconstructionCandidate, next: &ReconstructionCandidate) -> bool {
    let within = |a: Option<Estimate>, b: Option<Estimate>| match (a, b) {
        (Some(a), Some(b)) => (a.value - b.value).abs() <= a.u95.min(b.u95) && b.u95 > NARROWED * a.u95,
        (None, None) => true,
        _ => false,
    };
    within(own.speed, next.speed) && within(own.k, next.k)
}

fn words(rung: ReconstructionRung) -> &'static str {
    match rung {
        ReconstructionRung::Flight => "the planar motion with modes and drift fitted to the flight",
        ReconstructionRung::Joint => "the joint fit of all inputs within their tolerances",
    }
}

/// Why this rung, and what the next one would have changed.
fn reason(steps: &[RungStep], taken: usize) -> String {
    let own = &steps[taken].candidate;
    let mut said = format!("Taken: {}", words(own.rung));
    if let Some(below) = taken.checked_sub(1).map(|i| &steps[i].candidate) {
        let why = if below.consistent {
            format!(
                "it changes what {} says by more than its interval, or knows it better by a tenth",
                words(below.rung)
            )
        } else {
            format!("{} leaves {}", words(below.rung), below.residual)
        };
        said = format!("{said}, because {why}");
    }
    if let Some(next) = steps.get(taken + 1).map(|s| &s.candidate) {
        let change = |a: Option<Estimate>, b: Option<Estimate>| a.zip(b).map(|(a, b)| b.value - a.value);
        let speed =
            change(own.speed, next.speed).map_or(String::new(), |d| format!("the speed by {d:+.2} m/s and "));
        let k = change(own.k, next.k).map_or(String::new(), |d| format!("k by {d:+.3}"));
        said = format!("{said}; {} would change {speed}{k}, within the interval", words(next.rung));
    }
    said + "."
}
