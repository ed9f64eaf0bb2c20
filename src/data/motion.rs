//! The rigid-body motion that follows from the channels and a contact law.

use super::curves::MotionCurve;

/// Plane motion at one time; velocities of the centre of gravity S.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionState {
    /// Time, s from the recording's first sample.
    pub time_s: f64,
    /// Inclination φ, rad.
    pub angle_rad: f64,
    /// ω = −φ̇, rad/s.
    pub angular_velocity_rad_s: f64,
    /// ẋ of S, m/s.
    pub horizontal_velocity_m_s: f64,
    /// ż of S, m/s.
    pub vertical_velocity_m_s: f64,
    /// z of S above the target, m.
    pub height_m: f64,
}

/// Steps over the contact: 200 over 20 ms leave the trapezoid's error below 4e-5 of the velocities, and are a
/// twenty-fifth of a period of 400 Hz.
pub const CONTACT_STEPS: usize = 200;

/// Inputs of the reconstruction beside the signals: geometry, initial motion and the source of the axial
/// velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Length l, m.
    pub length_m: f64,
    /// Section h, m.
    pub height_m: f64,
    /// Centre of gravity c from the first end, m.
    pub cog_m: f64,
    /// φ at first contact, rad.
    pub angle_rad: f64,
    /// Speed at which L strikes, m/s.
    pub impact_velocity_m_s: f64,
    /// True if that speed follows from the height of the fall, and therefore depends on the rotation.
    pub is_of_fall: bool,
    /// ω at first contact, rad/s.
    pub angular_velocity_rad_s: f64,
    /// ẋ of S at first contact, m/s.
    pub horizontal_velocity_m_s: f64,
    /// g, m/s².
    pub gravity_m_s2: f64,
    /// Source of the axial velocity during contact.
    pub axial: AxialSource,
    /// Inward movement of the force per crush of the corner, m/m.
    pub inward: f64,
    /// True duration of one second of the recorder's clock, s: 1 if its rate is as stated.
    pub second_s: f64,
    /// Steps that the contact is followed in.
    pub contact_steps: usize,
}

/// Source of the axial velocity during contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxialSource {
    /// ẋ_C = 0.
    Sticking,
    /// Friction: the tangential force is this share of the normal force.
    Sliding {
        /// I_x / I_z: positive if it pushes towards R.
        friction: f64,
    },
    /// The axial channels.
    Measured,
}

/// The friction of the first contact where no axial channel measures it: I_x / I_z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssumedFriction {
    /// Impulse ratio of the contact law.
    pub ratio: f64,
    /// Standard uncertainty of the ratio.
    pub u: f64,
}

/// A reconstructed channel of an end without a sensor: another channel times a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaledCopy {
    /// Index of the reconstructed channel among the signals.
    pub channel: usize,
    /// Index of the channel that replaces it, whose errors it has.
    pub by: usize,
    /// The number.
    pub share: f64,
}

/// The motion between first contact and slap-down.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// State when L strikes.
    pub contact: MotionState,
    /// State when L leaves the target.
    pub separation: MotionState,
    /// Speed with which L strikes, m/s.
    pub impact_m_s: f64,
    /// Vertical velocity of L's corner as it leaves, m/s.
    pub rebound_m_s: f64,
    /// Horizontal velocity of L's corner then, m/s: 0 where it sticks.
    pub slip_m_s: f64,
    /// I_x / I_z of the contact: the friction that the motion needed.
    pub impulse_ratio: f64,
    /// Angular impulse about S during the contact over mass, m²/s: Θ ω / m of a rigid body   (32)
    pub angular_impulse_m2_s: f64,
    /// Greatest depth of L's corner below the point of first touch, m.
    pub crush_m: f64,
    /// Just before R strikes, where it does.
    pub slap_down: Option<MotionState>,
    /// Horizontal and vertical velocity of R's corner then, m/s.
    pub second_end_m_s: Option<(f64, f64)>,
    /// Height of R's corner then, m: 0 but for errors of angle, velocity and time.
    pub second_end_height_m: Option<f64>,
    /// Height of L's corner when it touches again, relative to that when it left, m: 0 likewise.
    pub touch_height_m: Option<f64>,
    /// Lowest height of L's corner between separation and slap-down, relative to that when it left, m;
    /// infinite without a curve.
    pub lowest_first_end_m: f64,
    /// Height of L's corner when R strikes, m.
    pub last_first_end_m: f64,
    /// The motion over time.
    pub curve: MotionCurve,
}

impl Motion {
    /// Excess of the rotation from the first contact over the rotation that its impulse gives a body of this
    /// Θ/m (m²), rad/s   (32)
    pub fn excess_rotation_rad_s(&self, inertia_m2: f64) -> f64 {
        self.separation.angular_velocity_rad_s
            - self.contact.angular_velocity_rad_s
            - self.angular_impulse_m2_s / inertia_m2
    }
}
