//! Signals and the plateaus of the flight to the integrated channels during contact, and the line over their positions.

use super::{Integrated, Velocity};
use crate::data::{Axis, FlightFit, Mode, Signal};
use crate::numerics::damped_modes::Drive;
use nalgebra::Complex;

/// Steps over the contact in which the ringing is followed: a twentieth of a period of 400 Hz in 20 ms.
const STEPS: u16 = 160;
/// Rounds in which the shape of the force is freed of ringing: the second moves the ringing by a percent of itself.
const ROUNDS: usize = 2;
/// A mode that answered more strongly by this factor while it was driven than as L left is not known well enough to follow back.
const MOST_DECLINE: f64 = 5.0;

/// Least-squares line over the transverse channels: value at S and slope along the axis.
pub(super) struct AlongAxis {
    positions_m: Vec<f64>,
    offsets_m: Vec<f64>,
    channels: Vec<usize>,
    mean_m: f64,
    square_m2: f64,
}

impl AlongAxis {
    pub fn through(signals: &[Signal], cog_m: f64) -> Option<Self> {
        let channels: Vec<usize> =
            (0..signals.len()).filter(|&i| signals[i].axis == Axis::Transverse).collect();
        let positions_m: Vec<f64> = channels.iter().map(|&i| signals[i].position_m - cog_m).collect();
        let offsets_m = channels.iter().map(|&i| signals[i].offset_m).collect();
        #[allow(clippy::cast_precision_loss, reason = "a handful of channels")]
        let mean_m = positions_m.iter().sum::<f64>() / positions_m.len().max(1) as f64;
        let square_m2: f64 = positions_m.iter().map(|x| (x - mean_m).powi(2)).sum();
        (square_m2 > 1e-6).then_some(Self { positions_m, offsets_m, channels, mean_m, square_m2 })
    }

    /// ∫f_η of S, m/s, and Ω = φ̇, rad/s, at a time, given ∫Ω² dt since contact: f_η holds −Ω² η   (16)
    pub fn at(&self, histories: &Histories, time_s: f64, turned_rad2_s: f64) -> (f64, f64) {
        let (mut sum, mut moment) = (0.0, 0.0);
        for ((&i, offset_m), position_m) in self.channels.iter().zip(&self.offsets_m).zip(&self.positions_m) {
            let value = histories.at(i, time_s) + turned_rad2_s * offset_m;
            sum += value;
            moment += (position_m - self.mean_m) * value;
        }
        let slope = moment / self.square_m2;
        #[allow(clippy::cast_precision_loss, reason = "a handful of channels")]
        let mean = sum / self.channels.len() as f64;
        (mean - slope * self.mean_m, slope)
    }
}

/// The integrated channels over the contact, led to the plateaus of the flight.
pub(super) struct Histories<'a> {
    velocities: &'a [Velocity],
    corrections_m_s: Vec<f64>,
    axial: Vec<(usize, f64, f64)>,
    contact_s: f64,
    length_s: f64,
    /// How long a second of the recorder's clock lasts, s.
    second_s: f64,
    /// Ringing of each channel over the contact on a grid of [`STEPS`], m/s.
    bending: Vec<Vec<f64>>,
}

impl<'a> Histories<'a> {
    pub fn new(
        Integrated { signals, velocities, .. }: &'a Integrated,
        fit: &FlightFit,
        line: &AlongAxis,
        (contact_s, separation_s): (f64, f64),
    ) -> Option<Self> {
        let length_s = separation_s - contact_s;
        if length_s <= 0.0 {
            return None;
        }
        let mut corrections_m_s = Vec::new();
        for (signal, velocity) in signals.iter().zip(velocities) {
            let plateau = fit.plateau(&signal.name)?;
            // A zero shift sets in somewhere in the contact: half of it is taken to have acted.
            let before_s = fit.from_s - separation_s + length_s / 2.0;
            let plateau_m_s = plateau.velocity_step_m_s - plateau.zero_shift_m_s2 * before_s;
            corrections_m_s.push(plateau_m_s - velocity.at(separation_s));
        }
        let axial = (0..signals.len())
            .filter(|&i| signals[i].axis == Axis::Axial)
            .map(|i| (i, signals[i].position_m, signals[i].offset_m))
            .collect();
        let mut histories = Self {
            velocities,
            corrections_m_s,
            axial,
            contact_s,
            length_s,
            second_s: 1.0,
            bending: Vec::new(),
        };
        histories.take_off_bending(fit, line);
        Some(histories)
    }

    /// The same where a second of the recorder's clock lasts so long: every integral is as much longer.
    pub fn at_rate(self, second_s: f64) -> Self {
        Self { second_s, ..self }
    }

    /// Finds what rings in each channel during the contact, and leaves the corrections what that does not explain.
    ///
    /// The modes start from rest and are driven by the contact force, whose shape the rotation tells once it is free of ringing; until then
    /// a half sine stands for it.
    fn take_off_bending(&mut self, fit: &FlightFit, line: &AlongAxis) {
        if fit.modes.is_empty() {
            return;
        }
        for round in 0..ROUNDS {
            let turning =
                if round == 0 { half_sine(self.turning_at(line, STEPS)) } else { self.turning_rad_s(line) };
            let driven: Vec<Vec<Complex<f64>>> = fit
                .modes
                .iter()
                .map(|mode| driven(mode, &turning, self.length_s / f64::from(STEPS)))
                .collect();
            let before: Vec<f64> =
                (0..self.velocities.len()).map(|i| self.bending_m_s(i, usize::from(STEPS))).collect();
            let left_s = self.contact_s + self.length_s - fit.from_s;
            self.bending = fit
                .plateaus
                .iter()
                .map(|plateau| bending(&fit.modes, &plateau.ringing_m_s, &driven, left_s))
                .collect();
            for (i, before) in before.into_iter().enumerate() {
                self.corrections_m_s[i] += self.bending_m_s(i, usize::from(STEPS)) - before;
            }
        }
    }

    /// Ω on the grid, rad/s.
    fn turning_rad_s(&self, line: &AlongAxis) -> Vec<f64> {
        (0..=STEPS).map(|i| self.turning_at(line, i)).collect()
    }

    /// Ω at a step of the grid, rad/s.
    fn turning_at(&self, line: &AlongAxis, step: u16) -> f64 {
        line.at(self, self.grid_s(step), 0.0).1
    }

    fn grid_s(&self, step: u16) -> f64 {
        self.contact_s + self.length_s * f64::from(step) / f64::from(STEPS)
    }

    /// Ringing of a channel at a step of the grid, m/s.
    fn bending_m_s(&self, index: usize, step: usize) -> f64 {
        self.bending.get(index).and_then(|b| b.get(step)).copied().unwrap_or(0.0)
    }

    /// ∫f of a channel from before contact to a recorded time, ringing led out in proportion to time, m/s.
    pub fn at(&self, index: usize, time_s: f64) -> f64 {
        let share = ((time_s - self.contact_s) / self.length_s).clamp(0.0, 1.0);
        let position = share * f64::from(STEPS);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and STEPS")]
        let step = position as usize;
        let (a, b) =
            (self.bending_m_s(index, step), self.bending_m_s(index, (step + 1).min(usize::from(STEPS))));
        // Not `fract`, which is a call where the processor may be any.
        #[allow(clippy::cast_precision_loss, reason = "a step of the grid")]
        let bending_m_s = a + (position - step as f64) * (b - a);
        self.second_s
            * (self.velocities[index].at(time_s) - bending_m_s + share * self.corrections_m_s[index])
    }

    /// Mean over the axial channels of ∫f_ξ of their place on the axis, m/s, and their mean position, m; `None` without any.
    ///
    /// f_ξ holds −Ω̇ η (15), so ∫f_ξ + Ω η is what a sensor on the axis would give.
    pub fn axial_mean(&self, time_s: f64, rotation_rad_s: f64) -> Option<(f64, f64)> {
        #[allow(clippy::cast_precision_loss, reason = "a handful of channels")]
        let n = self.axial.len() as f64;
        let sums = self.axial.iter().fold((0.0, 0.0), |(v, x), &(i, position_m, offset_m)| {
            (v + self.at(i, time_s) + rotation_rad_s * offset_m, x + position_m)
        });
        (n > 0.0).then_some((sums.0 / n, sums.1 / n))
    }
}

/// The rotation over the contact under a half sine of force, on the grid, that ends at `end_rad_s`.
fn half_sine(end_rad_s: f64) -> Vec<f64> {
    let share = |i: u16| f64::from(i) / f64::from(STEPS);
    (0..=STEPS).map(|i| end_rad_s * (1.0 - (std::f64::consts::PI * share(i)).cos()) / 2.0).collect()
}

/// Z(t) = ∫ f(τ) e^((−ζ + i) ω (t − τ)) dτ from rest: a mode driven by the shape of the contact force, −dΩ/dt   (36)
fn driven(mode: &Mode, turning_rad_s: &[f64], step_s: f64) -> Vec<Complex<f64>> {
    let omega = std::f64::consts::TAU * mode.frequency_hz;
    let rate = Complex::new(-mode.damping * omega, omega);
    let (turn, half_turn) = ((rate * step_s).exp(), (rate * (step_s / 2.0)).exp());
    let mut value = Complex::new(0.0, 0.0);
    let mut values = vec![value];
    for pair in turning_rad_s.windows(2) {
        value = value * turn + half_turn * (pair[0] - pair[1]);
        values.push(value);
    }
    values
}

/// Velocity of one channel's ringing over the contact, m/s: each mode as it is driven, in the size that it has as L leaves.
fn bending(
    modes: &[Mode],
    amplitudes_m_s: &[(f64, f64)],
    driven: &[Vec<Complex<f64>>],
    left_s: f64,
) -> Vec<f64> {
    let mut sum = vec![0.0; usize::from(STEPS) + 1];
    for ((mode, &(a, b)), driven) in modes.iter().zip(amplitudes_m_s).zip(driven) {
        let omega = std::f64::consts::TAU * mode.frequency_hz;
        let as_left = Complex::new(a, -b) * (Complex::new(-mode.damping * omega, omega) * left_s).exp();
        let largest = driven.iter().map(Complex::norm_sqr).fold(0.0, f64::max);
        let last = driven[usize::from(STEPS)];
        if last.norm_sqr() * MOST_DECLINE * MOST_DECLINE < largest || largest <= 0.0 {
            continue;
        }
        // A mode's shape is real: what does not fit the phase is left to the correction.
        let size = (as_left * last.conj()).re / last.norm_sqr();
        for (sum, z) in sum.iter_mut().zip(driven) {
            *sum += size * z.re;
        }
    }
    sum
}

/// The shape of the contact force between first contact and separation at `left_s`, for modes that ring from `from_s` on: that of the rotation freed
/// of an earlier fit's ringing, or a half sine where there is none. `None` without two transverse channels apart.
#[must_use]
pub fn drive(
    integrated: &Integrated,
    fit: Option<&FlightFit>,
    left_s: f64,
    from_s: f64,
    cog_m: f64,
) -> Option<Drive> {
    let contact_s = integrated.contact_s;
    let line = AlongAxis::through(&integrated.signals, cog_m)?;
    let turning = match fit {
        Some(fit) => Histories::new(integrated, fit, &line, (contact_s, left_s))?.turning_rad_s(&line),
        None if left_s > contact_s => half_sine(-1.0),
        None => return None,
    };
    Some(Drive {
        age_s: from_s - contact_s,
        step_s: (left_s - contact_s) / f64::from(STEPS),
        impulses: turning.windows(2).map(|pair| pair[0] - pair[1]).collect(),
    })
}
