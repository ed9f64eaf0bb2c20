//! Signals and the plateaus of the flight to the integrated channels during contact, and the line over their positions.

use super::Velocity;
use crate::data::{Axis, FlightFit, Signal};

/// Least-squares line over the transverse channels: value at S and slope along the axis.
pub(super) struct Line {
    positions_m: Vec<f64>,
    offsets_m: Vec<f64>,
    channels: Vec<usize>,
    mean_m: f64,
    square_m2: f64,
}

impl Line {
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
        let values: Vec<f64> = self
            .channels
            .iter()
            .zip(&self.offsets_m)
            .map(|(&i, offset_m)| histories.at(i, time_s) + turned_rad2_s * offset_m)
            .collect();
        #[allow(clippy::cast_precision_loss, reason = "a handful of channels")]
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let slope = values.iter().zip(&self.positions_m).map(|(v, x)| (x - self.mean_m) * v).sum::<f64>()
            / self.square_m2;
        (mean - slope * self.mean_m, slope)
    }
}

/// The integrated channels over the contact, led to the plateaus of the flight.
pub(super) struct Histories {
    velocities: Vec<Velocity>,
    corrections_m_s: Vec<f64>,
    axial: Vec<(usize, f64, f64)>,
    contact_s: f64,
    length_s: f64,
}

impl Histories {
    pub fn new(signals: &[Signal], fit: &FlightFit, contact_s: f64, separation_s: f64) -> Option<Self> {
        let length_s = separation_s - contact_s;
        if length_s <= 0.0 {
            return None;
        }
        let mut velocities = Vec::new();
        let mut corrections_m_s = Vec::new();
        for signal in signals {
            let plateau = fit.plateau(&signal.name)?;
            // The same start as the flight fit's, so that both count from one zero.
            let velocity = Velocity::of(signal, contact_s - 2e-3, separation_s);
            // A zero shift sets in somewhere in the contact: half of it is taken to have acted.
            let before_s = fit.from_s - separation_s + length_s / 2.0;
            let plateau_m_s = plateau.velocity_step_m_s - plateau.zero_shift_m_s2 * before_s;
            corrections_m_s.push(plateau_m_s - velocity.at(separation_s));
            velocities.push(velocity);
        }
        let axial = (0..signals.len())
            .filter(|&i| signals[i].axis == Axis::Axial)
            .map(|i| (i, signals[i].position_m, signals[i].offset_m))
            .collect();
        Some(Self { velocities, corrections_m_s, axial, contact_s, length_s })
    }

    /// ∫f of a channel since before contact, ringing led out in proportion to time, m/s.
    pub fn at(&self, index: usize, time_s: f64) -> f64 {
        let share = ((time_s - self.contact_s) / self.length_s).clamp(0.0, 1.0);
        self.velocities[index].at(time_s) + share * self.corrections_m_s[index]
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
