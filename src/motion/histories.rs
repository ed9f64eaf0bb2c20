//! Sums of the channels over the contact, from the signals and the plateaus of the flight: the line over
//! their positions, without ringing.

use super::flight::{centrifugal_m_s2, oscillation};
use super::{Integrated, Velocity, spin_rad_s};
use crate::data::{Axis, CONTACT_STEPS, FlightFit, Mode, Signal};
use crate::numerics::as_f64;
use crate::numerics::damped_modes::{Drive, rate};
use nalgebra::Complex;
use std::f64::consts::PI;

/// A mode whose amplitude was larger by this factor while it was driven than when L left cannot be
/// extrapolated back.
const MOST_DECLINE: f64 = 5.0;

/// ∫f_η of S, m/s; Ω = φ̇, rad/s; and the mean over the axial channels of ∫f_ξ, m/s: each a sum over the
/// channels.
pub(super) type Sums = [f64; 3];

/// Weight of each channel in the [`Sums`]: the transverse ones by the least-squares line over their
/// positions, its value at S and its slope along the axis   (16), the axial ones by their mean.
pub(super) struct AlongAxis {
    weights: Vec<Sums>,
    /// Place of S, m.
    cog_m: f64,
    /// Effect of ∫Ω² dt since contact on the first two, m and 1: f_η holds −Ω² η   (14)
    turned_m: [f64; 2],
    /// Mean position of the axial channels: from L and off the axis, m; `None` without any.
    axial_m: Option<[f64; 2]>,
}

impl AlongAxis {
    pub fn new(signals: &[Signal], cog_m: f64) -> Option<Self> {
        let on = |axis: Axis| signals.iter().filter(move |s| s.axis == axis);
        let mean = |axis: Axis, of: fn(&Signal) -> f64| {
            on(axis).map(of).sum::<f64>() / as_f64(on(axis).count().max(1))
        };
        let mean_m = mean(Axis::Transverse, |s| s.position_m) - cog_m;
        let beside_m = |s: &Signal| s.position_m - cog_m - mean_m;
        let square_m2: f64 = on(Axis::Transverse).map(|s| beside_m(s).powi(2)).sum();
        let one_of = |axis: Axis| 1.0 / as_f64(on(axis).count().max(1));
        let weights = |s: &Signal| match s.axis {
            Axis::Transverse => {
                let slope = beside_m(s) / square_m2;
                [one_of(Axis::Transverse) - slope * mean_m, slope, 0.0]
            }
            Axis::Axial => [0.0, 0.0, one_of(Axis::Axial)],
        };
        let weights: Vec<Sums> = signals.iter().map(weights).collect();
        let turned_m = [0, 1].map(|i| signals.iter().zip(&weights).map(|(s, w)| w[i] * s.offset_m).sum());
        let axial_m = (on(Axis::Axial).next().is_some())
            .then(|| [mean(Axis::Axial, |s| s.position_m), mean(Axis::Axial, |s| s.offset_m)]);
        (square_m2 > 1e-6).then_some(Self { weights, cog_m, turned_m, axial_m })
    }

    /// Sums of the steps of all channels: the velocity of S across the axis, Ω, and the velocity along the
    /// axis   (16)
    pub fn step_sums(&self, steps_m_s: &[f64]) -> Sums {
        let [across_m_s, turned_rad_s, along_m_s] = self.sums(steps_m_s.iter().copied());
        let offset_m = self.axial_m.map_or(0.0, |[_, offset_m]| offset_m);
        [across_m_s, turned_rad_s, along_m_s + turned_rad_s * offset_m]
    }

    /// The weighted sums over a value of each channel.
    fn sums(&self, of_channels: impl Iterator<Item = f64>) -> Sums {
        self.weights
            .iter()
            .zip(of_channels)
            .fold([0.0; 3], |sums, (weights, value)| [0, 1, 2].map(|i| sums[i] + weights[i] * value))
    }
}

/// Sums of the channels over the contact at equally spaced times, brought to the plateaus of the flight at
/// the end, with the ringing distributed in proportion to time.
pub(super) struct Histories<'a> {
    line: &'a AlongAxis,
    sums: Vec<Sums>,
}

impl<'a> Histories<'a> {
    pub fn new(
        Integrated { signals, velocities, .. }: &Integrated,
        fit: &FlightFit,
        line: &'a AlongAxis,
        before_rad_s: f64,
        (contact_s, separation_s): (f64, f64),
        steps: usize,
    ) -> Option<Self> {
        let length_s = separation_s - contact_s;
        if length_s <= 0.0 {
            return None;
        }
        let turning_rad_s = spin_rad_s(signals, fit, before_rad_s, [contact_s, separation_s]);
        let mut sums = vec![[0.0; 3]; steps + 1];
        for ((signal, velocity), weights) in signals.iter().zip(velocities).zip(&line.weights) {
            let plateau = fit.plateau(&signal.name)?;
            // A zero shift begins somewhere in the contact: half of the contact is assumed.
            let flown_s = fit.from_s - separation_s;
            let shifted_m_s = plateau.zero_shift_m_s2 * (flown_s + length_s / 2.0);
            let pulled_m_s = centrifugal_m_s2(signal, turning_rad_s, line.cog_m) * flown_s;
            let plateau_m_s = plateau.velocity_step_m_s - shifted_m_s - pulled_m_s;
            velocity.add_even((contact_s, length_s / as_f64(steps)), plateau_m_s, *weights, &mut sums);
        }
        let mut histories = Self { line, sums };
        histories.take_off_bending(fit, length_s, separation_s - fit.from_s);
        Some(histories)
    }

    /// Scales the time if a second of the recorder's clock has another duration: every integral grows in
    /// proportion.
    pub fn scale_time(mut self, second_s: f64) -> Self {
        for sums in &mut self.sums {
            *sums = sums.map(|sum| second_s * sum);
        }
        self
    }

    /// Subtracts the ringing of the channels during the contact, with the amplitude that it has when L
    /// leaves, `left_s` from the fit's beginning.
    ///
    /// The modes start from rest and are driven by the contact force, whose shape the rotation shows once it
    /// is free of ringing; before that a half sine replaces it. The iteration ends when the ringing changes
    /// by less than a percent.
    fn take_off_bending(&mut self, fit: &FlightFit, length_s: f64, left_s: f64) {
        if fit.modes.is_empty() {
            return;
        }
        let steps = self.sums.len() - 1;
        let step_s = length_s / as_f64(steps);
        let ringing = self.ringing(fit, &driven_modes(&fit.modes, &half_sine(steps), step_s), left_s);
        let turning: Vec<f64> =
            self.sums.iter().zip(&ringing).map(|(sums, ringing)| sums[1] - ringing[1]).collect();
        let ringing = self.ringing(fit, &driven_modes(&fit.modes, &turning, step_s), left_s);
        for (sums, ringing) in self.sums.iter_mut().zip(ringing) {
            *sums = [0, 1, 2].map(|i| sums[i] - ringing[i]);
        }
    }

    /// Contribution of the driven modes to the sums, less a line to their value when L leaves.
    fn ringing(&self, fit: &FlightFit, driven: &[Vec<Complex<f64>>], left_s: f64) -> Vec<Sums> {
        let steps = self.sums.len() - 1;
        let mut all = vec![[0.0; 3]; steps + 1];
        for (m, (mode, driven)) in fit.modes.iter().zip(driven).enumerate() {
            let aged = (rate(oscillation(mode)) * left_s).exp();
            let last = driven[steps];
            let largest = driven.iter().map(Complex::norm_sqr).fold(0.0, f64::max);
            if last.norm_sqr() * MOST_DECLINE * MOST_DECLINE < largest || largest <= 0.0 {
                continue;
            }
            // The shape of a mode is real: the line covers any part that does not fit the phase.
            let size = |(a, b): (f64, f64)| (Complex::new(a, -b) * aged * last.conj()).re / last.norm_sqr();
            let sizes =
                self.line.sums(fit.plateaus.iter().map(|p| p.ringing_m_s.get(m).map_or(0.0, |of| size(*of))));
            for (i, (sums, z)) in all.iter_mut().zip(driven).enumerate() {
                let beside = z.re - last.re * (as_f64(i) / as_f64(steps));
                *sums = [0, 1, 2].map(|i| sums[i] + sizes[i] * beside);
            }
        }
        all
    }

    /// ∫f_η of S, m/s, and Ω, rad/s, at a step, given ∫Ω² dt since contact   (16)
    pub fn state_at(&self, step: usize, turned_rad2_s: f64) -> (f64, f64) {
        let [across_m_s, turning_rad_s, _] = self.sums[step];
        let [of_across, of_turning] = self.line.turned_m.map(|m| turned_rad2_s * m);
        (across_m_s + of_across, turning_rad_s + of_turning)
    }

    /// Ω at every step, rad/s.
    fn rotations_rad_s(&self) -> Vec<f64> {
        self.sums.iter().map(|sums| sums[1]).collect()
    }

    /// Mean over the axial channels of ∫f_ξ at their place on the axis, m/s, and their mean position, m;
    /// `None` without any.
    ///
    /// f_ξ holds −Ω̇ η (15), so ∫f_ξ + Ω η is the value of a sensor on the axis.
    pub fn axial_mean(&self, step: usize, rotation_rad_s: f64) -> Option<(f64, f64)> {
        let [position_m, offset_m] = self.line.axial_m?;
        Some((self.sums[step][2] + rotation_rad_s * offset_m, position_m))
    }
}

impl Velocity {
    /// Adds to each of the `sums` its `weights` times the velocity at equally spaced times, brought to
    /// `end_m_s` at the last of them.
    fn add_even(&self, (from_s, step_s): (f64, f64), end_m_s: f64, weights: Sums, sums: &mut [Sums]) {
        let last = as_f64(sums.len() - 1);
        let missing_m_s = end_m_s - self.velocity_at(from_s + last * step_s);
        for (i, sums) in sums.iter_mut().enumerate() {
            let value = self.velocity_at(from_s + as_f64(i) * step_s) + missing_m_s * (as_f64(i) / last);
            *sums = [0, 1, 2].map(|i| sums[i] + weights[i] * value);
        }
    }
}

/// Rotation over the contact under a half sine of force.
fn half_sine(steps: usize) -> Vec<f64> {
    (0..=steps).map(|i| (1.0 - (PI * as_f64(i) / as_f64(steps)).cos()) / 2.0).collect()
}

/// Z(t) = ∫ f(τ) e^((−ζ + i) ω (t − τ)) dτ from rest: modes driven by the shape of the contact force,
/// −dΩ/dt   (36)
fn driven_modes(modes: &[Mode], turning_rad_s: &[f64], step_s: f64) -> Vec<Vec<Complex<f64>>> {
    let response = |mode: &Mode| {
        let rate = rate(oscillation(mode));
        let (turn, half_turn) = ((rate * step_s).exp(), (rate * (step_s / 2.0)).exp());
        let mut value = Complex::new(0.0, 0.0);
        let steps = turning_rad_s.windows(2).map(|pair| {
            value = value * turn + half_turn * (pair[0] - pair[1]);
            value
        });
        std::iter::once(Complex::new(0.0, 0.0)).chain(steps).collect()
    };
    modes.iter().map(response).collect()
}

/// Shape of the contact force between first contact and separation at `left_s`, for modes that ring from
/// `from_s` on: that of the rotation without the ringing of an earlier fit, or a half sine if there is none.
/// `None` without two transverse channels apart.
pub fn contact_drive(
    integrated: &Integrated,
    fit: Option<&FlightFit>,
    left_s: f64,
    from_s: f64,
    cog_m: f64,
    before_rad_s: f64,
) -> Option<Drive> {
    let contact_s = integrated.contact_s;
    let line = AlongAxis::new(&integrated.signals, cog_m)?;
    let turning = match fit {
        Some(fit) => {
            Histories::new(integrated, fit, &line, before_rad_s, (contact_s, left_s), CONTACT_STEPS)?
                .rotations_rad_s()
        }
        None if left_s > contact_s => half_sine(CONTACT_STEPS).into_iter().map(|share| -share).collect(),
        None => return None,
    };
    Some(Drive {
        age_s: from_s - contact_s,
        step_s: (left_s - contact_s) / as_f64(CONTACT_STEPS),
        impulses: turning.windows(2).map(|pair| pair[0] - pair[1]).collect(),
    })
}
