//! Bending modes of a scene's body: those that the scene lists, or all modes of an elastic one.

use crate::lab::data::{BendingMode, Scene};
use crate::numerics::free_beam::MOST_MODES;
use crate::numerics::thick_beam::{ThickBeam, high_shape, wave_number};

/// Most modes of an elastic body.
pub(super) const MOST_ELASTIC: usize = 12;

/// An elastic body has no modes above this, Hz: measuring chains of drop tests end below it.
const BAND_HZ: f64 = 4e3;

/// E/(κG) of a solid steel section: 2 (1 + ν) over 5/6.
const SHEAR: f64 = 3.1;

/// Share of the length over which the slope of a shape is taken.
const STEP: f64 = 1e-4;

/// A mode of the body.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyMode {
    pub(super) mode: BendingMode,
    /// Rotation of a section over the slope of the axis.
    turning: f64,
}

impl BodyMode {
    /// Deflection at `share` of the length for the coordinate before the strength.
    pub(super) fn shape(&self, share: f64) -> f64 {
        high_shape(self.mode.order, share)
    }

    /// Rotation of the section at `share` of the length for `strength` of that coordinate, 1/m.
    pub(super) fn tilt_1_m(&self, strength: f64, share: f64, length_m: f64) -> f64 {
        let [above, below] = [share + STEP, share - STEP].map(|at| self.shape(at));
        strength * (above - below) / (2.0 * STEP * length_m) * self.turning
    }

    /// Movement of L's corner (0) or R's (1) along and across the axis for that coordinate; for a mode that
    /// only rides on the motion, across alone.
    pub(super) fn corner_shape(&self, end: usize, scene: &Scene) -> [f64; 2] {
        let share = if end == 0 { 0.0 } else { 1.0 };
        let down_m = if scene.elastic.is_some() { scene.cask.height_m / 2.0 } else { 0.0 };
        [down_m * self.tilt_1_m(1.0, share, scene.cask.length_m), self.shape(share)]
    }
}

/// The modes of a scene's body: for an elastic one those of a Timoshenko beam of its length and section, up
/// to the twelfth or 4 kHz.
pub(super) fn modes(scene: &Scene) -> Vec<BodyMode> {
    let Some(body) = scene.elastic else {
        let listed = scene.modes.iter().take(MOST_MODES);
        return listed.map(|mode| BodyMode { mode: *mode, turning: 1.0 }).collect();
    };
    let height = scene.cask.height_m / scene.cask.length_m;
    // Frequencies relate to the slender beam's first: the inertia of the turning sections affects them alone.
    let relative = |order, thick: ThickBeam| wave_number(order).powi(2) * thick.slowing;
    let unit_hz = body.first_bending_hz / relative(1, ThickBeam::new(1, height, SHEAR));
    let mode = |order| {
        let thick = ThickBeam::new(order, height, SHEAR);
        let frequency_hz = unit_hz * relative(order, thick);
        let mode = BendingMode { order, frequency_hz, damping: body.damping, strength: 1.0 };
        BodyMode { mode, turning: thick.turning }
    };
    let is_in_band = |mode: &BodyMode| mode.mode.order == 1 || mode.mode.frequency_hz <= BAND_HZ;
    (1..).take(MOST_ELASTIC).map(mode).take_while(is_in_band).collect()
}

#[cfg(test)]
#[path = "elastic_tests.rs"]
mod tests;
