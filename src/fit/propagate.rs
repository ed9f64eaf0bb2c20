//! Propagates the uncertain inputs of a motion to quantities with intervals, with or without the observables
//! that it must reproduce.

use super::closures::{Observable, observables};
use super::inputs::{Inputs, UncertainInput, inputs};
use super::untested::Influence;
use super::{COVERAGE, FitData, Reconstruct};
use crate::data::{
    Adjustment, Axis, Consistency, Contribution, Estimate, MISSED_U, Motion, OpenedInput, Quantities,
};
use crate::numerics::prior_fit::{PriorFit, derivatives, fit};
use nalgebra::{DMatrix, DVector, Matrix};
use std::sync::{Mutex, PoisonError};

/// Slopes hold this far from where they were computed, in standard uncertainties of the inputs: within this
/// distance the motion is so nearly linear that results change by 1e-7 and intervals by 6e-4 at most
/// (fixtures).
const NEAR_U: f64 = 0.1;

/// Steps over the contact for slopes: with four times as many no half-width of a fixture's quantities changes
/// by more than 1e-3.
const SLOPE_STEPS: usize = 50;

/// Standard uncertainty of a transverse channel's step from bending, m/s: a third of the tolerance of their
/// check.
const U_LINE_M_S: f64 = 0.03;

/// Rounds of the Gauss-Newton method that seek the number of an opened input.
const OPENED_ROUNDS: usize = 5;

/// Shifts below this many standard uncertainties are not listed.
const NOTABLE_MOVE: f64 = 0.05;

/// The quantities, and the contribution of each datum to their uncertainty.
pub(super) struct Propagated {
    pub quantities: Quantities,
    /// Largest contribution first.
    pub budget: Vec<Contribution>,
}

/// The reconstruction as a function of its inputs' shifts.
pub(super) struct Model<'a> {
    reconstruct: Reconstruct<'a>,
    pub(super) base: Inputs,
    motion: Motion,
    pub(super) inputs: Vec<UncertainInput>,
    observables: Vec<Observable<'a>>,
    line: StepLine,
    /// Slopes of the quantities and, below them, of the observables, with the inputs at which they were
    /// computed.
    known_slopes: Mutex<Vec<(Vec<f64>, DMatrix<f64>)>>,
}

impl<'a> Model<'a> {
    pub fn new(measured: &'a FitData, reconstruct: Reconstruct<'a>) -> Option<Self> {
        let base = Inputs::new(measured);
        let motion = reconstruct(&base.flight, &base.events, &base.setup)?;
        let inputs = inputs(measured, &motion);
        let observables = observables(measured, &motion);
        let (line, known_slopes) = (StepLine::new(measured), Mutex::default());
        Some(Self { reconstruct, base, motion, inputs, observables, line, known_slopes })
    }

    fn follow(&self, inputs: &Inputs) -> Option<Motion> {
        (self.reconstruct)(&inputs.flight, &inputs.events, &inputs.setup)
    }

    /// The quantities, and the misses of the observables, each over its own standard uncertainty.
    fn read(&self, inputs: &Inputs) -> Option<(Quantities<f64>, Vec<f64>)> {
        let motion = self.follow(inputs)?;
        let missed = self.observables.iter().map(|o| o.residual(inputs, &motion));
        Some((Quantities::from_motion(&motion), missed.collect::<Option<_>>()?))
    }

    /// Evaluates the model with the inputs shifted by this many standard uncertainties.
    fn evaluate_at(&self, by_u: &[f64]) -> Option<(Quantities<f64>, Vec<f64>)> {
        self.read(&self.base.shift(&self.inputs, by_u))
    }

    fn values(&self, by_u: &[f64]) -> Option<Quantities<f64>> {
        self.evaluate_at(by_u).map(|(values, _)| values)
    }

    fn residuals(&self, by_u: &[f64]) -> Option<Vec<f64>> {
        self.evaluate_at(by_u).map(|(_, left)| left)
    }

    /// The slopes of [`Self::values`] and, below them, of [`Self::residuals`]. One motion gives both; slopes
    /// computed before at inputs close by are reused.
    fn slopes(&self, at_u: &[f64]) -> Option<DMatrix<f64>> {
        let known = || self.known_slopes.lock().unwrap_or_else(PoisonError::into_inner);
        let apart_u =
            |known: &[f64]| known.iter().zip(at_u).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        if let Some((_, slopes)) = known().iter().find(|known| apart_u(&known.0) <= NEAR_U) {
            return Some(slopes.clone());
        }
        let base = self.base.with_contact_steps(SLOPE_STEPS);
        let both = |by_u: &[f64]| {
            let (values, left) = self.read(&base.shift(&self.inputs, by_u))?;
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

    /// Fits the inputs to the observables; `None` if there are none or the motion cannot be followed.
    pub fn fit_jointly(&self) -> Option<PriorFit> {
        if self.observables.is_empty() {
            return None;
        }
        fit(self.inputs.len(), &|by_u| self.residuals(by_u), &|at_u| self.slopes_of_residuals(at_u))
    }

    /// Computes the quantities from the stated inputs, with their uncertainty propagated (GUM, 5.1.2).
    pub fn propagate_stated(&self) -> Option<Propagated> {
        self.propagate(&PriorFit::from_priors(self.inputs.len()), 1.0)
    }

    /// Computes the quantities at the end of a fit, with the contribution of each datum to their uncertainty
    /// widened by a factor.
    pub fn propagate(&self, fit: &PriorFit, widened: f64) -> Option<Propagated> {
        let values = self.values(&fit.unknowns)?;
        let slopes = self.slopes_of_quantities(&fit.unknowns)?;
        // Each datum moves the unknowns by its column of the response, and the unknowns move the quantities.
        let by_datum = slopes * &fit.response * widened;
        let u = Quantities::from_fn(|row| by_datum.row(row).norm());
        let quantities = values
            .zip(u)
            .zip(Quantities::UNITS)
            .map(|((value, u), unit)| Estimate::new(value, COVERAGE * u, unit));
        Some(Propagated { quantities, budget: self.budget(&by_datum, values.speed.is_some()) })
    }

    /// One line per datum: the inputs, then the observables; largest first.
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

    /// Misses of each observable with the stated inputs, over the uncertainty that all inputs give it.
    pub fn closures(&self) -> Vec<Consistency> {
        let start = vec![0.0; self.inputs.len()];
        let (Some(misses), Some(slopes)) = (self.residuals(&start), self.slopes_of_residuals(&start)) else {
            return Vec::new();
        };
        let in_u = NormalizedMisses::from_slopes(&slopes);
        let beside = in_u.given_others(&misses);
        let closure = |(i, observable): (usize, &Observable)| Consistency {
            name: observable.name.clone(),
            kind: observable.kind,
            channel: observable.channel.clone(),
            miss: observable.words(misses[i]),
            miss_in_u: misses[i] / in_u.u[i],
            beside_others_in_u: beside[i],
        };
        self.observables.iter().enumerate().map(closure).collect()
    }

    /// Effect of each input, if it were stated wrong by a standard uncertainty, on the quantities at a fit,
    /// and on the checks with the stated inputs.
    pub fn influences(&self, fit: &PriorFit) -> Option<Vec<Influence>> {
        let count = self.inputs.len();
        let slopes = self.slopes_of_residuals(&vec![0.0; count])?;
        let in_u = NormalizedMisses::from_slopes(&slopes);
        let quantities = self.slopes_of_quantities(&fit.unknowns)? * fit.response.columns(0, count);
        let strikes = self.motion.slap_down.is_some();
        let influence = |input: usize| {
            let by = Quantities::from_fn(|row| quantities[(row, input)]);
            let misses: Vec<f64> = slopes.column(input).iter().copied().collect();
            let own = misses.iter().zip(&in_u.u).map(|(miss, u)| miss / u);
            Influence {
                quantities: Quantities { speed: by.speed.filter(|_| strikes), ..by },
                miss_in_u: own.chain(in_u.given_others(&misses)).map(f64::abs).fold(0.0, f64::max),
            }
        };
        Some((0..count).map(influence).collect())
    }

    /// Inputs of which another number, alone, comes closest to the observables and the line of the transverse
    /// steps, the best first; none if no check fails.
    ///
    /// That number has the least χ² = mᵀ (JJᵀ + 1)⁻¹ m of the misses m, by the Gauss-Newton method   (31)
    pub fn opened_inputs(&self, closures: &[Consistency]) -> Option<Vec<OpenedInput>> {
        // A step that is off the line by less than its uncertainty lies on it.
        let is_on_line = self.line.residuals(&self.base).iter().all(|miss| miss.abs() < MISSED_U);
        if is_on_line && closures.iter().all(|closure| closure.largest_residual() < MISSED_U) {
            return None;
        }
        let start = vec![0.0; self.inputs.len()];
        let missed_by = |by_u: &[f64]| {
            let inputs = self.base.shift(&self.inputs, by_u);
            let mut misses = self.read(&inputs)?.1;
            misses.extend(self.line.residuals(&inputs));
            Some(DVector::from_vec(misses))
        };
        let misses = missed_by(&start).filter(|misses| !misses.is_empty())?;
        let of_line = |by_u: &[f64]| Some(self.line.residuals(&self.base.shift(&self.inputs, by_u)));
        let slopes = self.slopes_of_residuals(&start)?;
        let line_slopes = derivatives(&of_line(&start)?, &of_line, &start, &|_| false)?;
        let rows: Vec<_> = slopes.row_iter().chain(line_slopes.row_iter()).map(Matrix::into_owned).collect();
        let in_u = NormalizedMisses::from_slopes(&DMatrix::from_rows(&rows));
        let own = misses.iter().zip(&in_u.u).map(|(miss, u)| miss / u);
        if own.chain(in_u.given_others(misses.as_slice())).all(|miss_in_u| miss_in_u.abs() < MISSED_U) {
            return None;
        }
        let opened = |(input, own): (usize, &UncertainInput)| {
            let stated = own.stated.as_ref().filter(|_| own.shifts.len() == 1)?;
            let [number, by_u] = stated.number?;
            let (mut at_u, mut missed) = (start.clone(), misses.clone());
            for _ in 0..OPENED_ROUNDS {
                let slope = missed_by(&with_one_moved(&at_u, input))? - &missed;
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
            let opening = OpenedInput { key, channel, stated: number, explains, chi_square };
            (explains.is_finite() && chi_square.is_finite()).then_some(opening)
        };
        let mut all: Vec<OpenedInput> = self.inputs.iter().enumerate().filter_map(opened).collect();
        all.sort_by(|a, b| a.chi_square.total_cmp(&b.chi_square));
        Some(all)
    }

    /// Corrections by a fit, largest first.
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
                left_share: fit.remaining_share(i),
            })
            .collect();
        moved.sort_by(|a, b| b.moved_in_u.abs().total_cmp(&a.moved_in_u.abs()));
        moved
    }
}

/// Residuals of the velocity steps of three and more transverse channels from the line over their positions
/// that one rigid body gives   (16)
struct StepLine {
    /// The channels.
    channels: Vec<usize>,
    /// Projection that subtracts the line from the steps.
    projection: DMatrix<f64>,
}

impl StepLine {
    fn new(measured: &FitData) -> Self {
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

    /// Residuals of the steps over [`U_LINE_M_S`]; empty if two channels determine the line.
    fn residuals(&self, inputs: &Inputs) -> Vec<f64> {
        if self.channels.len() < 3 {
            return Vec::new();
        }
        let step = |row: usize, _| inputs.flight.plateaus[self.channels[row]].velocity_step_m_s / U_LINE_M_S;
        let steps = DVector::from_fn(self.channels.len(), step);
        (&self.projection * steps).iter().copied().collect()
    }
}

/// Copies the shifts with one of them larger by a standard uncertainty.
fn with_one_moved(by_u: &[f64], input: usize) -> Vec<f64> {
    by_u.iter().enumerate().map(|(i, by)| if i == input { by + 1.0 } else { *by }).collect()
}

/// Expected misses of the checks by chance: their covariance from all inputs is JJᵀ + 1   (31)
struct NormalizedMisses {
    /// Standard uncertainty of each miss, in that of the observable alone.
    u: Vec<f64>,
    /// Inverse of the covariance.
    weights: DMatrix<f64>,
}

impl NormalizedMisses {
    fn from_slopes(slopes: &DMatrix<f64>) -> Self {
        let count = slopes.nrows();
        let covariance = DMatrix::identity(count, count) + slopes * slopes.transpose();
        let u = covariance.diagonal().iter().map(|square| square.sqrt()).collect();
        let weights = covariance.cholesky().map_or_else(|| DMatrix::identity(count, count), |c| c.inverse());
        Self { u, weights }
    }

    /// Each miss less its expectation from the others, over its standard uncertainty given the others (W m)_i
    /// / √W_ii.
    fn given_others(&self, misses: &[f64]) -> Vec<f64> {
        let all = &self.weights * DVector::from_column_slice(misses);
        all.iter().zip(self.weights.diagonal().iter()).map(|(miss, weight)| miss / weight.sqrt()).collect()
    }
}
