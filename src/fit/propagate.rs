//! A motion with its uncertain inputs to quantities with intervals, with or without the observables that it
//! must meet.

use super::closures::{Observable, observables};
use super::inputs::{Inputs, UncertainInput, inputs};
use super::untested::Influence;
use super::{COVERAGE, FitData, Reconstruct};
use crate::data::{Adjustment, Axis, Closure, Contribution, Estimate, MISSED_U, Motion, Opening, Quantities};
use crate::numerics::prior_fit::{PriorFit, derivatives, fit};
use nalgebra::{DMatrix, DVector, Matrix};
use std::sync::{Mutex, PoisonError};

/// Slopes hold as far from where they were taken, in standard uncertainties of the inputs: a motion bends so
/// little within them that results move by 1e-7 of themselves and intervals by 6e-4 at most (fixtures).
const NEAR_U: f64 = 0.1;

/// Steps over the contact that slopes are taken with: with four times as many no half-width of a fixture's
/// quantities moves by more than 1e-3 of itself.
const SLOPE_STEPS: usize = 50;

/// What bending leaves of the step of a transverse channel, m/s: a third of what the check of them allows.
const U_LINE_M_S: f64 = 0.03;

/// Rounds of Gauss and Newton by which an input that is opened is sought.
const OPENING_ROUNDS: usize = 5;

/// Moves below this many standard uncertainties are not worth a line.
const NOTABLE_MOVE: f64 = 0.05;

/// The quantities, and what each datum contributes to their uncertainty.
pub(super) struct Propagated {
    pub quantities: Quantities,
    /// Largest contribution first.
    pub budget: Vec<Contribution>,
}

/// The reconstruction as a function of its inputs' moves.
pub(super) struct Model<'a> {
    reconstruct: Reconstruct<'a>,
    pub(super) base: Inputs,
    motion: Motion,
    pub(super) inputs: Vec<UncertainInput>,
    observables: Vec<Observable<'a>>,
    line: StepLine,
    /// Slopes of the quantities and, below them, of the observables, and where they were asked for.
    known_slopes: Mutex<Vec<(Vec<f64>, DMatrix<f64>)>>,
}

impl<'a> Model<'a> {
    pub fn new(measured: &'a FitData, reconstruct: Reconstruct<'a>) -> Option<Self> {
        let base = Inputs::new(measured);
        let motion = reconstruct(&base.flight, &base.events, &base.setup)?;
        let inputs = inputs(measured, &motion);
        let observables = observables(measured, &motion);
        let (line, known_slopes) = (StepLine::of(measured), Mutex::default());
        Some(Self { reconstruct, base, motion, inputs, observables, line, known_slopes })
    }

    fn follow(&self, inputs: &Inputs) -> Option<Motion> {
        (self.reconstruct)(&inputs.flight, &inputs.events, &inputs.setup)
    }

    /// The quantities, and the observables' misses, each over its own standard uncertainty.
    fn read(&self, inputs: &Inputs) -> Option<(Quantities<f64>, Vec<f64>)> {
        let motion = self.follow(inputs)?;
        let missed = self.observables.iter().map(|o| o.residual(inputs, &motion));
        Some((Quantities::of(&motion), missed.collect::<Option<_>>()?))
    }

    /// The same with the inputs moved by so many standard uncertainties.
    fn moved(&self, by_u: &[f64]) -> Option<(Quantities<f64>, Vec<f64>)> {
        self.read(&self.base.moved(&self.inputs, by_u))
    }

    fn values(&self, by_u: &[f64]) -> Option<Quantities<f64>> {
        self.moved(by_u).map(|(values, _)| values)
    }

    fn residuals(&self, by_u: &[f64]) -> Option<Vec<f64>> {
        self.moved(by_u).map(|(_, left)| left)
    }

    /// The slopes of [`Self::values`] and, below them, of [`Self::residuals`]. One motion gives both; slopes
    /// at inputs near by that were made before are given again.
    fn slopes(&self, at_u: &[f64]) -> Option<DMatrix<f64>> {
        let known = || self.known_slopes.lock().unwrap_or_else(PoisonError::into_inner);
        let apart_u =
            |known: &[f64]| known.iter().zip(at_u).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        if let Some((_, slopes)) = known().iter().find(|known| apart_u(&known.0) <= NEAR_U) {
            return Some(slopes.clone());
        }
        let base = self.base.in_steps(SLOPE_STEPS);
        let both = |by_u: &[f64]| {
            let (values, left) = self.read(&base.moved(&self.inputs, by_u))?;
            Some([&values.into_array()[..], &left].concat())
        };
        let slopes = derivatives(&both(at_u)?, &both, at_u, &|i| self.inputs[i].jumps())?;
        known().push((at_u.to_vec(), slopes.clone()));
        Some(slopes)
    }

    fn slopes_of_quantities(&self, at_u: &[f64]) -> Option<DMatrix<f64>> {
        Some(self.slopes(at_u)?.rows(0, Quantities::COUNT).into_owned())
    }

    fn slopes_of_residuals(&self, at_u: &[f64]) -> Option<DMatrix<f64>> {
        Some(self.slopes(at_u)?.rows(Quantities::COUNT, self.observables.len()).into_owned())
    }

    /// The inputs fitted to the observables; `None` where there are none or the motion cannot be followed.
    pub fn joint(&self) -> Option<PriorFit> {
        if self.observables.is_empty() {
            return None;
        }
        fit(self.inputs.len(), &|by_u| self.residuals(by_u), &|at_u| self.slopes_of_residuals(at_u))
    }

    /// The quantities by the inputs as they are stated, their uncertainty propagated (GUM, 5.1.2).
    pub fn by_stated_inputs(&self) -> Option<Propagated> {
        self.propagate(&PriorFit::of_priors(self.inputs.len()), 1.0)
    }

    /// The quantities at the inputs that a fit ended with, the contribution of each datum to their
    /// uncertainty widened by a factor.
    pub fn propagate(&self, fit: &PriorFit, widened: f64) -> Option<Propagated> {
        let values = self.values(&fit.unknowns)?;
        let slopes = self.slopes_of_quantities(&fit.unknowns)?;
        // Each datum moves the unknowns by its column of the response, and they the quantities.
        let by_datum = slopes * &fit.response * widened;
        let u = Quantities::from_fn(|row| by_datum.row(row).norm());
        let quantities = values
            .zip(u)
            .zip(Quantities::UNITS)
            .map(|((value, u), unit)| Estimate::new(value, COVERAGE * u, unit));
        Some(Propagated { quantities, budget: self.budget(&by_datum, values.speed.is_some()) })
    }

    /// One line a datum: the inputs, then the observables; largest first.
    fn budget(&self, by_datum: &DMatrix<f64>, strikes: bool) -> Vec<Contribution> {
        let tolerance = |i: &UncertainInput| i.stated.as_ref().map(|stated| stated.tolerance);
        let inputs = self.inputs.iter().map(|i| (i.name.clone(), i.size.clone(), tolerance(i)));
        let own = |o: &Observable| (o.name.clone(), o.words(1.0).replace('+', ""), None);
        let names = inputs.chain(self.observables.iter().map(own));
        let mut budget: Vec<Contribution> = names
            .zip(by_datum.column_iter())
            .map(|((input, standard_uncertainty, tolerance), column)| {
                let change = Quantities::from_fn(|row| column[row].abs());
                let speed_m_s = change.speed.filter(|_| strikes);
                Contribution { input, standard_uncertainty, tolerance, speed_m_s, k: Some(change.k) }
            })
            .collect();
        budget.sort_by(|a, b| {
            let weight = |c: &Contribution| c.speed_m_s.unwrap_or(0.0).hypot(10.0 * c.k.unwrap_or(0.0));
            weight(b).total_cmp(&weight(a))
        });
        budget
    }

    /// By how much the stated inputs miss each observable, over the uncertainty that all inputs give it.
    pub fn closures(&self) -> Vec<Closure> {
        let start = vec![0.0; self.inputs.len()];
        let (Some(misses), Some(slopes)) = (self.residuals(&start), self.slopes_of_residuals(&start)) else {
            return Vec::new();
        };
        let in_u = MissesInU::of(&slopes);
        let beside = in_u.beside_others(&misses);
        let closure = |(i, observable): (usize, &Observable)| Closure {
            name: observable.name.clone(),
            kind: observable.kind,
            channel: observable.channel.clone(),
            miss: observable.words(misses[i]),
            miss_in_u: misses[i] / in_u.u[i],
            beside_others_in_u: beside[i],
        };
        self.observables.iter().enumerate().map(closure).collect()
    }

    /// What each input, were it stated wrong by a standard uncertainty, does to the quantities at a fit, and
    /// to the closures of the inputs as they are stated.
    pub fn influences(&self, fit: &PriorFit) -> Option<Vec<Influence>> {
        let count = self.inputs.len();
        let slopes = self.slopes_of_residuals(&vec![0.0; count])?;
        let in_u = MissesInU::of(&slopes);
        let quantities = self.slopes_of_quantities(&fit.unknowns)? * fit.response.columns(0, count);
        let strikes = self.motion.slap_down.is_some();
        let influence = |input: usize| {
            let by = Quantities::from_fn(|row| quantities[(row, input)]);
            let misses: Vec<f64> = slopes.column(input).iter().copied().collect();
            let own = misses.iter().zip(&in_u.u).map(|(miss, u)| miss / u);
            Influence {
                quantities: Quantities { speed: by.speed.filter(|_| strikes), ..by },
                miss_in_u: own.chain(in_u.beside_others(&misses)).map(f64::abs).fold(0.0, f64::max),
            }
        };
        Some((0..count).map(influence).collect())
    }

    /// Each input of which another number, alone, comes nearest to the observables and the line of the
    /// transverse steps, the best first; none where nothing is missed.
    ///
    /// That number has the least χ² = mᵀ (JJᵀ + 1)⁻¹ m of the misses m, by Gauss and Newton   (31)
    pub fn openings(&self, closures: &[Closure]) -> Option<Vec<Opening>> {
        // By less than its own uncertainty no step is told from the line.
        let is_on_line = self.line.misses(&self.base).iter().all(|miss| miss.abs() < MISSED_U);
        if is_on_line && closures.iter().all(|closure| closure.most_in_u() < MISSED_U) {
            return None;
        }
        let start = vec![0.0; self.inputs.len()];
        let missed_by = |by_u: &[f64]| {
            let inputs = self.base.moved(&self.inputs, by_u);
            let mut misses = self.read(&inputs)?.1;
            misses.extend(self.line.misses(&inputs));
            Some(DVector::from_vec(misses))
        };
        let misses = missed_by(&start).filter(|misses| !misses.is_empty())?;
        let of_line = |by_u: &[f64]| Some(self.line.misses(&self.base.moved(&self.inputs, by_u)));
        let slopes = self.slopes_of_residuals(&start)?;
        let line_slopes = derivatives(&of_line(&start)?, &of_line, &start, &|_| false)?;
        let rows: Vec<_> = slopes.row_iter().chain(line_slopes.row_iter()).map(Matrix::into_owned).collect();
        let in_u = MissesInU::of(&DMatrix::from_rows(&rows));
        let own = misses.iter().zip(&in_u.u).map(|(miss, u)| miss / u);
        if own.chain(in_u.beside_others(misses.as_slice())).all(|miss_in_u| miss_in_u.abs() < MISSED_U) {
            return None;
        }
        let opened = |(input, own): (usize, &UncertainInput)| {
            let stated = own.stated.as_ref().filter(|_| own.shifts.len() == 1)?;
            let [number, by_u] = stated.number?;
            let (mut at_u, mut missed) = (start.clone(), misses.clone());
            for _ in 0..OPENING_ROUNDS {
                let slope = missed_by(&beside(&at_u, input))? - &missed;
                let weighed = &in_u.weights * &slope;
                at_u[input] -= weighed.dot(&missed) / weighed.dot(&slope);
                missed = missed_by(&at_u)?;
            }
            let explains = number + at_u[input] * by_u;
            let chi_square = (&in_u.weights * &missed).dot(&missed);
            let channel = stated.channel.clone();
            let key = match stated.key {
                "calibration_percent" => "scale",
                "tolerance.clock_percent" => "sample_rate_hz",
                key => key,
            };
            let opening = Opening { key, channel, stated: number, explains, chi_square };
            (explains.is_finite() && chi_square.is_finite()).then_some(opening)
        };
        let mut all: Vec<Opening> = self.inputs.iter().enumerate().filter_map(opened).collect();
        all.sort_by(|a, b| a.chi_square.total_cmp(&b.chi_square));
        Some(all)
    }

    /// What a fit moved, largest first.
    pub fn adjustments(&self, fit: &PriorFit) -> Vec<Adjustment> {
        let mut moved: Vec<Adjustment> = self
            .inputs
            .iter()
            .enumerate()
            .filter(|(i, _)| fit.unknowns[*i].abs() > NOTABLE_MOVE)
            .map(|(i, input)| Adjustment {
                input: input.name.clone(),
                standard_uncertainty: input.size.clone(),
                moved_in_u: fit.unknowns[i],
                left_share: fit.left_share(i),
            })
            .collect();
        moved.sort_by(|a, b| b.moved_in_u.abs().total_cmp(&a.moved_in_u.abs()));
        moved
    }
}

/// What the velocity steps of three and more transverse channels leave of the line over their positions that
/// one rigid body gives   (16)
struct StepLine {
    /// The channels.
    channels: Vec<usize>,
    /// Takes the line off what each has.
    projection: DMatrix<f64>,
}

impl StepLine {
    fn of(measured: &FitData) -> Self {
        let own = measured.signals.iter().enumerate().take(measured.flight.plateaus.len());
        let channels: Vec<usize> = own.filter(|(_, s)| s.axis == Axis::Transverse).map(|(i, _)| i).collect();
        let place = |row: usize, column: usize| match column {
            0 => 1.0,
            _ => measured.signals[channels[row]].position_m,
        };
        let along = DMatrix::from_fn(channels.len(), 2, place);
        let inverse = (along.transpose() * &along).try_inverse();
        let projection = inverse.map_or_else(
            || DMatrix::zeros(channels.len(), channels.len()),
            |inverse| {
                DMatrix::identity(channels.len(), channels.len()) - &along * inverse * along.transpose()
            },
        );
        Self { channels, projection }
    }

    /// Over [`U_LINE_M_S`]; empty where two channels determine the line.
    fn misses(&self, inputs: &Inputs) -> Vec<f64> {
        if self.channels.len() < 3 {
            return Vec::new();
        }
        let step = |row: usize, _| inputs.flight.plateaus[self.channels[row]].velocity_step_m_s / U_LINE_M_S;
        let steps = DVector::from_fn(self.channels.len(), step);
        (&self.projection * steps).iter().copied().collect()
    }
}

/// These moves with one of them larger by a standard uncertainty.
fn beside(by_u: &[f64], input: usize) -> Vec<f64> {
    by_u.iter().enumerate().map(|(i, by)| if i == input { by + 1.0 } else { *by }).collect()
}

/// How far the closures may miss by chance: their covariance by all inputs is JJᵀ + 1   (31)
struct MissesInU {
    /// Standard uncertainty of each, over its own.
    u: Vec<f64>,
    /// Inverse of the covariance.
    weights: DMatrix<f64>,
}

impl MissesInU {
    fn of(slopes: &DMatrix<f64>) -> Self {
        let count = slopes.nrows();
        let covariance = DMatrix::identity(count, count) + slopes * slopes.transpose();
        let u = covariance.diagonal().iter().map(|square| square.sqrt()).collect();
        let weights = covariance.cholesky().map_or_else(|| DMatrix::identity(count, count), |c| c.inverse());
        Self { u, weights }
    }

    /// Each miss less what the others let expect of it, over the standard uncertainty that they leave it
    /// (W m)_i / √W_ii.
    fn beside_others(&self, misses: &[f64]) -> Vec<f64> {
        let all = &self.weights * DVector::from_column_slice(misses);
        all.iter().zip(self.weights.diagonal().iter()).map(|(miss, weight)| miss / weight.sqrt()).collect()
    }
}
