//! Propagates uncertain inputs through the motion to k and the other unknowns, each with its interval, for
//! every reconstruction method.

mod closures;
mod inputs;
mod ladder;
mod propagate;
mod steps;
mod untested;

use crate::data::{
    AssumedFriction, ChannelSpec, Events, FlightFit, MeasuredRotation, Motion, RestLevel, ScaledCopy, Setup,
    Signal, Tolerances,
};

pub use inputs::Inputs;
pub use ladder::{SelectedMethod, run_methods};
pub use steps::{u_base_strain_m_s, u_step_m_s};

/// Coverage factor of a 95 % interval (GUM, 6.3.3).
pub const COVERAGE: f64 = 2.0;

/// The measured motion as a function of its inputs, such as `motion::outcome` of the integrated channels.
pub type Reconstruct<'a> = &'a (dyn Fn(&FlightFit, &Events, &Setup) -> Option<Motion> + Sync);

/// The second impact, whose rotation must follow from its impulse, as for the first impact   (32)
#[derive(Clone, Copy)]
pub struct SecondImpactData<'a> {
    /// Uncertain inputs of the second impact alone: name and standard uncertainty of each.
    pub inputs: &'a [[String; 2]],
    /// Excess of the rotation over that from the impulse, rad/s, with these inputs and this motion before it.
    pub excess_rotation_rad_s: &'a (dyn Fn(&Inputs, &Motion) -> Option<f64> + Sync),
    /// Rotation that the second impact gives, rad/s; `None` if the friction is unknown: any value that
    /// satisfies the check is then possible.
    pub rotation_rad_s: Option<f64>,
}

/// Input of the propagation.
#[derive(Clone, Copy)]
pub struct FitData<'a> {
    /// The conditioned channels.
    pub signals: &'a [Signal],
    /// The flight fit.
    pub flight: &'a FlightFit,
    /// Times of the events.
    pub events: &'a Events,
    /// Geometry, initial motion and contact law.
    pub setup: &'a Setup,
    /// Friction of the first contact, if no axial channel measures it.
    pub friction: Option<AssumedFriction>,
    /// Specifications of the channels in the cask file.
    pub specs: &'a [ChannelSpec],
    /// Uncertainty of the stated values.
    pub tolerances: Tolerances,
    /// Θ / m, m²; `None` if the cask file describes only a thin rod, which no cask is.
    pub inertia_m2: Option<f64>,
    /// Rest before the release, as the DC-coupled channels show it.
    pub rests: &'a [RestLevel],
    /// Free fall from release to the first touch, s, if the record shows it.
    pub fall_s: Option<f64>,
    /// The rotation by angular-rate sensors.
    pub rotations: &'a [MeasuredRotation],
    /// The reconstructed channel of an end without a sensor.
    pub stood_in: Option<ScaledCopy>,
    /// The second impact, if the record determines it.
    pub second: Option<SecondImpactData<'a>>,
}

impl FitData<'_> {
    /// Specification of a channel in the cask file.
    fn spec(&self, channel: usize) -> Option<&ChannelSpec> {
        let name = &self.signals.get(channel)?.name;
        self.specs.iter().find(|spec| spec.name == *name)
    }
}
