//! The analytical prediction and the body that it describes.

use super::cask::Contact;
use serde::Serialize;

/// Body of a prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BodyModel {
    /// The thin uniform rod of the paper.
    Rod,
    /// The rigid body with section, centre of gravity and inertia.
    Body,
}

impl BodyModel {
    /// "rod" or "body".
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Rod => "rod",
            Self::Body => "body",
        }
    }
}

/// A rigid body in the plane of the drop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Rod or body.
    pub model: BodyModel,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Length l, m.
    pub length_m: f64,
    /// Section h in the plane, m; 0 for the rod.
    pub height_m: f64,
    /// Centre of gravity c from the first end, m.
    pub cog_m: f64,
    /// Inertia Θ about the centre of gravity, kg m².
    pub inertia_kg_m2: f64,
}

/// Motion of L between the first impact and the slap-down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FlightRegime {
    /// L leaves the target with the first impact and does not come to rest on it.
    Free,
    /// k = 0 and the contact force stays a push: L pivots or slides on the target until R strikes.
    Contact,
    /// L stays on the target for a part of the way.
    Mixed,
}

impl std::fmt::Display for FlightRegime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Free => "free flight",
            Self::Contact => "contact kept",
            Self::Mixed => "contact kept in part",
        })
    }
}

/// Beyond this inclination the axis has been upright before R strikes, degrees, whatever the rotation of the
/// cask.
const UPRIGHT_DEG: f64 = 90.0;

impl Prediction {
    /// True if the cask turns over, a somersault, before R strikes: this is not the slap-down of a drop test.
    pub fn turns_over(&self) -> bool {
        self.slap_down_angle_deg.is_some_and(|angle_deg| angle_deg.abs() >= UPRIGHT_DEG)
    }

    /// True if R slaps down after one impact of L, without a somersault: only these count for the largest
    /// value of a study.
    ///
    /// Where L strikes again the values jump from angle to angle, hundreds of times between 47° and 90° for a
    /// rough rod with k = 1, and none of them is critical.
    pub fn is_single_slap_down(&self) -> bool {
        self.slap_down_speed_m_s.is_some() && self.first_end_impacts == 1 && !self.turns_over()
    }
}

/// Velocity of the centre of gravity S, m/s: the rows of \[P\] Tables 1 and 2 that are about S.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CogVelocity {
    /// ẋ_S2, just after the first impact.
    pub horizontal_after_impact_m_s: f64,
    /// ż_S2, just after the first impact, positive up.
    pub vertical_after_impact_m_s: f64,
    /// ẋ_S*, just before R strikes.
    pub horizontal_at_slap_down_m_s: Option<f64>,
    /// ż_S*, just before R strikes.
    pub vertical_at_slap_down_m_s: Option<f64>,
}

/// Prediction of one model for one contact law and one k. A quantity that does not exist (no slap-down) is
/// `None`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// Body.
    pub model: BodyModel,
    /// The contact law: "rough", "smooth" or the Coulomb coefficient.
    pub contact: Contact,
    /// Coefficient of restitution.
    pub k: f64,
    /// Magnitude of R's velocity just before it strikes, m/s.
    pub slap_down_speed_m_s: Option<f64>,
    /// Vertical component, negative down, m/s.
    pub vertical_velocity_m_s: Option<f64>,
    /// Horizontal component, m/s.
    pub horizontal_velocity_m_s: Option<f64>,
    /// ω between the impacts, positive brings R down, rad/s.
    pub angular_velocity_rad_s: f64,
    /// Time from the first impact to the slap-down, s.
    pub flight_time_s: Option<f64>,
    /// Kinetic energy just before slap-down over that before first impact.
    pub energy_ratio: Option<f64>,
    /// Inclination at slap-down, degrees.
    pub slap_down_angle_deg: Option<f64>,
    /// Impacts of L before R strikes, the first included.
    pub first_end_impacts: u32,
    /// I_x / I_z of the first impact: the friction that sticking needs if it sticks, μ if it slides.
    pub impulse_ratio: f64,
    /// The friction μ* that L needs to stick in the first impact   (6)
    pub friction_to_stick: f64,
    /// True if L sticks in the first impact.
    pub sticks: bool,
    /// Motion of L between the impacts.
    pub regime: FlightRegime,
    /// Motion of S, for `prediction.csv` alone.
    #[serde(skip)]
    pub cog: CogVelocity,
    /// Speed for k = 0 if L is held on the target whatever the force, \[P\] Table 2, m/s   (11) (12); `None`
    /// for k > 0.
    pub closed_form_speed_m_s: Option<f64>,
}
