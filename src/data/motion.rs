//! The rigid-body motion that the channels and a contact law give.

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

/// What the reconstruction needs beside the signals: geometry, initial motion and how the axial velocity is
/// had.
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
    /// Whether that follows from the height of the fall, and so from the rotation too.
    pub is_of_fall: bool,
    /// ω at first contact, rad/s.
    pub angular_velocity_rad_s: f64,
    /// ẋ of S at first contact, m/s.
    pub horizontal_velocity_m_s: f64,
    /// g, m/s².
    pub gravity_m_s2: f64,
    /// How the axial velocity during contact is had.
    pub axial: AxialClosure,
    /// How far inward of a corner the force moves for what that crushes, m for each.
    pub inward: f64,
    /// How long a second of the recorder's clock lasts, s: 1 where its rate is as stated.
    pub second_s: f64,
    /// Steps that the contact is followed in.
    pub contact_steps: usize,
}

/// Where the axial velocity during contact comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxialClosure {
    /// ẋ_C = 0.
    Sticking,
    /// A tangential force of so much of the normal force.
    Sliding {
        /// I_x / I_z: positive where it pushes towards R.
        friction: f64,
    },
    /// From the axial channels.
    Measured,
}

/// The friction of the first contact where no axial channel measures it: I_x / I_z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssumedFriction {
    /// As the contact law has it.
    pub ratio: f64,
    /// Standard uncertainty of it.
    pub u: f64,
}

/// A channel that stands in for an end without one: another one times a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoodIn {
    /// Its place among the signals.
    pub channel: usize,
    /// The place of the other one, whose errors it has.
    pub by: usize,
    /// The number.
    pub share: f64,
}

/// The motion between first contact and slap-down.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// As L strikes.
    pub contact: MotionState,
    /// As L leaves the target.
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
    /// How far L's corner goes below where it touched, m.
    pub crush_m: f64,
    /// Just before R strikes, where it does.
    pub slap_down: Option<MotionState>,
    /// Horizontal and vertical velocity of R's corner then, m/s.
    pub second_end_m_s: Option<(f64, f64)>,
    /// Height of R's corner then, m: 0 but for errors of angle, velocity and time.
    pub second_end_height_m: Option<f64>,
    /// Height of L's corner over where it left as it touches again, m: 0 likewise.
    pub touch_height_m: Option<f64>,
    /// Lowest height of L's corner between separation and slap-down over where it left, m; infinite where no
    /// curve was asked for.
    pub lowest_first_end_m: f64,
    /// The same height as R strikes.
    pub last_first_end_m: f64,
    /// The motion over time.
    pub curve: MotionCurve,
}

impl Motion {
    /// By how much the first contact turns the cask more than its impulse gives a body of this Θ/m, m²: rad/s
    /// (32)
    pub fn turned_beyond_rad_s(&self, inertia_m2: f64) -> f64 {
        self.separation.angular_velocity_rad_s
            - self.contact.angular_velocity_rad_s
            - self.angular_impulse_m2_s / inertia_m2
    }
}
