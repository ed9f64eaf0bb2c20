//! A motion that depends on uncertain inputs to k and the other unknowns, each with its interval, on every
//! rung of the reconstruction.

mod closures;
mod inputs;
mod ladder;
mod propagate;
mod steps;
mod untested;

use crate::data::{
    AssumedFriction, ChannelSpec, Events, FlightFit, MeasuredRotation, Motion, RestLevel, Setup, Signal,
    StoodIn, Tolerances,
};

pub use inputs::Inputs;
pub use ladder::{RungTaken, ladder};
pub use steps::{u_base_strain_m_s, u_step_m_s};

/// Coverage factor of a 95 % interval (GUM, 6.3.3).
pub const COVERAGE: f64 = 2.0;

/// The measured motion as a function of its inputs, such as `motion::outcome` of the integrated channels.
pub type Reconstruct<'a> = &'a (dyn Fn(&FlightFit, &Events, &Setup) -> Option<Motion> + Sync);

/// The second impact, whose rotation must follow from its impulse as that of the first does   (32)
#[derive(Clone, Copy)]
pub struct SecondContact<'a> {
    /// The uncertain inputs of its own: what each is, and its standard uncertainty.
    pub inputs: &'a [[String; 2]],
    /// By how much the rotation is more than the impulse gives, rad/s, with these inputs and this motion
    /// before it.
    pub turned_beyond_rad_s: &'a (dyn Fn(&Inputs, &Motion) -> Option<f64> + Sync),
    /// Rotation that it gives, rad/s; `None` where nobody knows its friction: the one that meets the closure
    /// is then as good as any.
    pub turned_rad_s: Option<f64>,
}

/// What the propagation starts from.
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
    /// The friction of the first contact, where no axial channel measures it.
    pub friction: Option<AssumedFriction>,
    /// What the cask file says of the channels.
    pub specs: &'a [ChannelSpec],
    /// How well the stated things are known.
    pub tolerances: Tolerances,
    /// Θ / m, m²; `None` where the cask file describes a thin rod only, which no cask is.
    pub inertia_m2: Option<f64>,
    /// Rest before the release, as the DC-coupled channels show it.
    pub rests: &'a [RestLevel],
    /// Free fall from release to the first touch, s, where the record shows it.
    pub fall_s: Option<f64>,
    /// The rotation by angular-rate sensors.
    pub rotations: &'a [MeasuredRotation],
    /// The channel that stands in for an end without one.
    pub stood_in: Option<StoodIn>,
    /// The second impact, where the record tells it.
    pub second: Option<SecondContact<'a>>,
}

impl FitData<'_> {
    /// What the cask file says of a channel.
    fn spec(&self, channel: usize) -> Option<&ChannelSpec> {
        let name = &self.signals.get(channel)?.name;
        self.specs.iter().find(|spec| spec.name == *name)
    }
}
