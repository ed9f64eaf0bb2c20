//! Scales the values of a scale model to its prototype   (46)

use super::estimate::Estimate;
use super::impacts::{ImpactTable, RigidBodyDeceleration};
use super::quantities::{FirstImpact, SlapDown};
use serde::Serialize;

/// Quantities of a result scaled to the prototype; times of the recording do not scale.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prototype {
    /// Length of the model over that of the prototype.
    pub scale: f64,
    /// The first impact.
    pub first_impact: FirstImpact,
    /// The slap-down.
    pub slap_down: SlapDown,
    /// Coefficient of restitution.
    pub k: Option<Estimate>,
    /// Slap-down speed over impact velocity.
    pub amplification: Option<Estimate>,
    /// Both impacts, without channels and curves.
    pub impacts: [ImpactTable; 2],
}

impl ImpactTable {
    /// Scales the values alone.
    pub(super) fn to_prototype(&self, scale: f64) -> Self {
        let scaled = |estimate: Option<Estimate>| estimate.map(|model| model.to_prototype(scale));
        let RigidBodyDeceleration { filter, cutoff_hz, at_cog, at_struck_end, .. } =
            self.rigid_body_deceleration.clone();
        let rigid_body_deceleration = RigidBodyDeceleration {
            filter,
            cutoff_hz: scale * cutoff_hz,
            at_cog: scaled(at_cog),
            at_struck_end: scaled(at_struck_end),
            at_cog_unfiltered: None,
            others: Vec::new(),
        };
        Self { numbers: self.numbers.map(scaled), rigid_body_deceleration, ..Self::empty(self.end) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_scale_model_tells_its_prototype_by_the_law_of_each_unit() {
        // Equal stress σ and speed v: a force is σ l², a mass ρ l³, so a ∝ F/m, t ∝ v/a, J ∝ F l.
        let twice = |unit| Estimate::new(3.0, 1.0, unit).to_prototype(0.5);
        for (unit, factor) in [
            ("s", 2.0),
            ("m", 2.0),
            ("m/s", 1.0),
            ("rad/s", 0.5),
            ("m/s^2", 0.5),
            ("N", 4.0),
            ("N s", 8.0),
            ("J", 8.0),
            ("deg", 1.0),
            ("1", 1.0),
        ] {
            assert_eq!(twice(unit), Estimate::new(3.0 * factor, factor, unit));
        }
    }
}
