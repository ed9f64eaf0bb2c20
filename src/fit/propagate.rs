//! A motion with its uncertain inputs to quantities with intervals, with or without the observables that it must meet.

use super::closures::{Observable, observables};
use super::inputs::{Inputs, UncertainInput, inputs};
use super::{Basis, COVERAGE, Reconstruct};
use crate::data::{Adjustment, Closure, Contribution, Estimate, Motion, Quantities};
use crate::numerics::prior_fit::{PriorFit, derivatives, fit};
use nalgebra::DMatrix;
use std::sync::{Mutex, PoisonError};

/// Number of quantities followed through the propagation.
const COUNT: usize = 13;
const IMPACT: usize = 0;
const DURATION: usize = 1;
const REBOUND: usize = 2;
const ROTATION: usize = 3;
const K: usize = 4;
const FLIGHT: usize = 5;
const SPEED: usize = 6;
const VERTICAL: usize = 7;
const HORIZONTAL: usize = 8;
const ANGLE: usize = 9;
const HEIGHT: usize = 10;
const SLIP: usize = 11;
const FRICTION: usize = 12;

/// Slopes hold as far from where they were taken, in standard uncertainties of the inputs: a motion bends so little within them that
/// results move by 1e-7 of themselves and intervals by 6e-4 at most (fixtures).
const NEAR_U: f64 = 0.1;

/// Steps over the contact that slopes are taken with: with four times as many no half-width of a fixture's quantities moves by more than 1e-3 of
/// itself.
const SLOPE_STEPS: usize = 50;

/// Moves below this many standard uncertainties are not worth a line.
const NOTABLE_MOVE: f64 = 0.05;

/// Reads the quantities off the motion and propagates the inputs' standard uncertainties to them (GUM, 5.1.2); `None` where the motion
/// cannot be had.
#[must_use]
pub fn quantities(measured: &Basis, reconstruct: Reconstruct) -> Option<Quantities> {
    Model::new(measured, reconstruct)?.by_stated_inputs()
}

/// Standard deviations of speed, m/s, and k over the given draws of the inputs, each a list of standard normal deviates that is repeated
/// over the inputs: what the linear propagation is checked against (JCGM 101).
#[must_use]
pub fn spread_by_draws(
    measured: &Basis,
    reconstruct: Reconstruct,
    draws: &mut dyn FnMut(usize) -> Option<Vec<f64>>,
) -> Option<(f64, f64)> {
    let model = Model::new(measured, reconstruct)?;
    let (mut n, mut sums) = (0.0, [0.0; 4]);
    while let Some(draw) = draws(model.inputs.len()) {
        let values = model.values(&draw)?;
        n += 1.0;
        for (i, value) in [values[SPEED], values[K]].into_iter().enumerate() {
            sums[2 * i] += value;
            sums[2 * i + 1] += value * value;
        }
    }
    let deviation = |sum: f64, squares: f64| (squares / n - (sum / n).powi(2)).max(0.0).sqrt();
    (n > 1.0).then(|| (deviation(sums[0], sums[1]), deviation(sums[2], sums[3])))
}

/// The reconstruction as a function of its inputs' moves.
pub(super) struct Model<'a> {
    measured: &'a Basis<'a>,
    reconstruct: Reconstruct<'a>,
    pub(super) base: Inputs,
    motion: Motion,
    pub(super) inputs: Vec<UncertainInput>,
    observables: Vec<Observable>,
    /// Slopes of the quantities and, below them, of the observables, and where they were asked for.
    known_slopes: Mutex<Vec<(Vec<f64>, DMatrix<f64>)>>,
}

impl<'a> Model<'a> {
    pub fn new(measured: &'a Basis, reconstruct: Reconstruct<'a>) -> Option<Self> {
        let base = Inputs::new(measured);
        let motion = reconstruct(&base.flight, &base.events, &base.setup)?;
        let inputs = inputs(measured, &motion);
        let observables = observables(measured, &motion);
        Some(Self {
            measured,
            reconstruct,
            base,
            motion,
            inputs,
            observables,
            known_slopes: Mutex::default(),
        })
    }

    fn follow(&self, inputs: &Inputs) -> Option<Motion> {
        (self.reconstruct)(&inputs.flight, &inputs.events, &inputs.setup)
    }

    /// The quantities, and the observables' misses, each over its own standard uncertainty.
    fn read(&self, inputs: &Inputs) -> Option<(Vec<f64>, Vec<f64>)> {
        let motion = self.follow(inputs)?;
        let missed = self.observables.iter().map(|o| o.residual(self.measured, inputs, &motion));
        Some((read_off(&motion, inputs), missed.collect::<Option<_>>()?))
    }

    /// The same with the inputs moved by so many standard uncertainties.
    fn moved(&self, by_u: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        self.read(&self.base.moved(&self.inputs, by_u))
    }

    fn values(&self, by_u: &[f64]) -> Option<Vec<f64>> {
        self.moved(by_u).map(|(values, _)| values)
    }

    fn residuals(&self, by_u: &[f64]) -> Option<Vec<f64>> {
        self.moved(by_u).map(|(_, left)| left)
    }

    /// The slopes of [`Self::values`] and, below them, of [`Self::residuals`]. One motion gives both; slopes at inputs near by that were made
    /// before are given again.
    fn slopes(&self, at_u: &[f64]) -> Option<DMatrix<f64>> {
        let known = || self.known_slopes.lock().unwrap_or_else(PoisonError::into_inner);
        let apart_u =
            |known: &[f64]| known.iter().zip(at_u).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        if let Some((_, slopes)) = known().iter().find(|known| apart_u(&known.0) <= NEAR_U) {
            return Some(slopes.clone());
        }
        let base = self.base.in_steps(SLOPE_STEPS);
        let both = |by_u: &[f64]| {
            self.read(&base.moved(&self.inputs, by_u)).map(|(values, left)| [values, left].concat())
        };
        let slopes = derivatives(&both(at_u)?, &both, at_u, &|i| self.inputs[i].jumps())?;
        known().push((at_u.to_vec(), slopes.clone()));
        Some(slopes)
    }

    fn slopes_of_quantities(&self, at_u: &[f64]) -> Option<DMatrix<f64>> {
        Some(self.slopes(at_u)?.rows(0, COUNT).into_owned())
    }

    fn slopes_of_residuals(&self, at_u: &[f64]) -> Option<DMatrix<f64>> {
        Some(self.slopes(at_u)?.rows(COUNT, self.observables.len()).into_owned())
    }

    /// The inputs fitted to the observables; `None` where there are none or the motion cannot be followed.
    pub fn joint(&self) -> Option<PriorFit> {
        if self.observables.is_empty() {
            return None;
        }
        fit(self.inputs.len(), &|by_u| self.residuals(by_u), &|at_u| self.slopes_of_residuals(at_u))
    }

    /// The quantities by the inputs as they are stated.
    pub fn by_stated_inputs(&self) -> Option<Quantities> {
        self.propagate(&PriorFit::of_priors(self.inputs.len()), 1.0)
    }

    /// The quantities at the inputs that a fit ended with, the contribution of each datum to their uncertainty widened by a factor.
    pub fn propagate(&self, fit: &PriorFit, widened: f64) -> Option<Quantities> {
        let values = self.values(&fit.unknowns)?;
        let slopes = self.slopes_of_quantities(&fit.unknowns)?;
        // Each datum moves the unknowns by its column of the response, and they the quantities.
        let by_datum = slopes * &fit.response * widened;
        let struck = self.measured.events.slap_down_s().is_some();
        let estimate = |i: usize, unit| Estimate::new(values[i], COVERAGE * by_datum.row(i).norm(), unit);
        let at_slap_down = |i: usize, unit| struck.then(|| estimate(i, unit));
        Some(Quantities {
            impact_velocity: estimate(IMPACT, "m/s"),
            duration: estimate(DURATION, "s"),
            rebound_velocity: estimate(REBOUND, "m/s"),
            angular_velocity: estimate(ROTATION, "rad/s"),
            k: estimate(K, "1"),
            flight_time: at_slap_down(FLIGHT, "s"),
            speed: at_slap_down(SPEED, "m/s"),
            vertical_velocity: at_slap_down(VERTICAL, "m/s"),
            horizontal_velocity: at_slap_down(HORIZONTAL, "m/s"),
            angle: at_slap_down(ANGLE, "deg"),
            second_end_height: at_slap_down(HEIGHT, "m"),
            slip_velocity: estimate(SLIP, "m/s"),
            friction: estimate(FRICTION, "1"),
            budget: self.budget(&by_datum, struck),
        })
    }

    /// One line a datum: the inputs, then the observables; largest first.
    fn budget(&self, by_datum: &DMatrix<f64>, struck: bool) -> Vec<Contribution> {
        let inputs = self.inputs.iter().map(|i| (i.name.clone(), i.size.clone()));
        let own = |o: &Observable| (o.name(), o.words(self.measured, &self.motion, 1.0).replace('+', ""));
        let names = inputs.chain(self.observables.iter().map(own));
        let mut budget: Vec<Contribution> = names
            .zip(by_datum.column_iter())
            .map(|((input, standard_uncertainty), column)| Contribution {
                input,
                standard_uncertainty,
                speed_m_s: struck.then(|| column[SPEED].abs()),
                k: Some(column[K].abs()),
            })
            .collect();
        budget.sort_by(|a, b| {
            let weight = |c: &Contribution| c.speed_m_s.unwrap_or(0.0).hypot(10.0 * c.k.unwrap_or(0.0));
            weight(b).total_cmp(&weight(a))
        });
        budget
    }

    /// By how much the stated inputs miss each observable, over the uncertainty that all inputs give it, and how much of the miss a fit leaves.
    pub fn closures(&self, fit: Option<&PriorFit>) -> Vec<Closure> {
        let start = vec![0.0; self.inputs.len()];
        let (Some(misses), Some(slopes)) = (self.residuals(&start), self.slopes_of_residuals(&start)) else {
            return Vec::new();
        };
        let left = |i: usize| fit.and_then(|f| f.left.get(i)).copied();
        self.observables
            .iter()
            .zip(misses)
            .enumerate()
            .map(|(i, (observable, miss))| Closure {
                name: observable.name(),
                kind: observable.kind(),
                channel: observable.channel().map(str::to_owned),
                miss: observable.words(self.measured, &self.motion, miss),
                miss_in_u: miss / slopes.row(i).norm().hypot(1.0),
                left_in_u: left(i).unwrap_or(miss),
            })
            .collect()
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

/// Rebound ż_L as L leaves (22), k = −ż_L after over ż_L before (23), speed = |v_R| (24), and the rest.
fn read_off(motion: &Motion, inputs: &Inputs) -> Vec<f64> {
    let contact_s = inputs.events.first_contact_s().unwrap_or(f64::NAN);
    let (horizontal, vertical) = motion.second_end_m_s.unwrap_or((0.0, 0.0));
    let mut values = vec![0.0; COUNT];
    values[IMPACT] = inputs.setup.impact_velocity_m_s;
    values[DURATION] = motion.separation.time_s - contact_s;
    values[REBOUND] = motion.rebound_m_s;
    values[ROTATION] = motion.separation.angular_velocity_rad_s;
    values[K] = motion.rebound_m_s / inputs.setup.impact_velocity_m_s;
    values[FLIGHT] = motion.slap_down.map_or(0.0, |s| s.time_s - motion.separation.time_s);
    values[SPEED] = horizontal.hypot(vertical);
    values[VERTICAL] = vertical;
    values[HORIZONTAL] = horizontal;
    values[ANGLE] = motion.slap_down.map_or(0.0, |s| s.angle_rad.to_degrees());
    values[HEIGHT] = motion.second_end_height_m.unwrap_or(0.0);
    values[SLIP] = motion.slip_m_s;
    values[FRICTION] = motion.impulse_ratio;
    values
}
