//! Position and velocity of the lower corners of a rigid cask in its plane, from inclination and rotation.

/// Arms a and b, m: the distance of S ahead of a lower corner along the target, and above it. The corner lies
/// `behind_m` behind S along the axis: c for L, c − l for R.
///
/// a = c cos φ − (h/2) sin φ, b = c sin φ + (h/2) cos φ   (1)
pub fn arms_m((sin, cos): (f64, f64), behind_m: f64, height_m: f64) -> (f64, f64) {
    let half_m = height_m / 2.0;
    (behind_m * cos - half_m * sin, behind_m * sin + half_m * cos)
}

/// Horizontal and vertical velocity of a corner with these arms, m/s, where S moves with `cog_m_s` and the
/// cask turns with ω = −φ̇.
///
/// ẋ_C = ẋ_S − b ω, ż_C = ż_S + a ω   (3)
pub fn corner_m_s(cog_m_s: (f64, f64), turning_rad_s: f64, (a_m, b_m): (f64, f64)) -> (f64, f64) {
    (cog_m_s.0 - b_m * turning_rad_s, cog_m_s.1 + a_m * turning_rad_s)
}

/// Vertical velocity of S just before L strikes with v0, m/s: ż_S = −v0 − ω a   (3)
pub fn falling_m_s(impact_velocity_m_s: f64, turning_rad_s: f64, a_m: f64) -> f64 {
    a_m * -turning_rad_s - impact_velocity_m_s
}

/// Arm a of L's corner at an inclination, m   (1)
pub fn first_arm_m(cog_m: f64, height_m: f64, angle_rad: f64) -> f64 {
    arms_m(angle_rad.sin_cos(), cog_m, height_m).0
}
