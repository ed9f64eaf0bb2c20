//! How well the stated things are known, and which corrections may be made.

/// 95 % half-widths of what the cask file states and the sensors' certificates promise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Drop angle, rad.
    pub angle_rad: f64,
    /// Impact velocity, as a share of it.
    pub impact_velocity: f64,
    /// Scale of a channel, as a share of it.
    pub calibration: f64,
    /// What a sensor reads of the other body axis, as a share: cross-axis sensitivity and tilt.
    pub cross_axis: f64,
    /// Place of a sensor along the axis, m.
    pub position_m: f64,
    /// Length between the ends that strike, as a share of it.
    pub length: f64,
    /// Section, as a share of it.
    pub height: f64,
    /// Rotation at first contact, rad/s.
    pub angular_velocity_rad_s: f64,
    /// Sideways velocity at first contact, m/s.
    pub horizontal_velocity_m_s: f64,
    /// Centre of gravity, m.
    pub cog_m: f64,
    /// Inertia, as a share of it.
    pub inertia: f64,
    /// Friction of the first contact, as a share of it: of the stated coefficient, or of what sticking needs.
    pub friction: f64,
    /// Rate of the recorder's clock, as a share of it; all channels share it.
    pub clock: f64,
}

/// Inertia that is only a homogeneous block's, as a share: casks carry their mass off the even spread.
const INERTIA_OF_BLOCK: f64 = 0.1;

impl Default for Tolerances {
    /// Sources and sizes: docs/uncertainty.md.
    fn default() -> Self {
        Self {
            length: 0.01,
            height: 0.01,
            angular_velocity_rad_s: 1.0_f64.to_radians(),
            horizontal_velocity_m_s: 0.1,
            angle_rad: 0.4_f64.to_radians(),
            impact_velocity: 0.003,
            calibration: 0.01,
            cross_axis: 0.02,
            position_m: 0.01,
            cog_m: 0.01,
            inertia: 0.02,
            friction: 0.2,
            clock: 0.0005,
        }
    }
}

impl Tolerances {
    /// The defaults where a cask file leaves these keys out, as "table.key": an inertia may be the block's
    /// alone.
    #[must_use]
    pub fn of(left_out: &[String]) -> Self {
        let usual = Self::default();
        let is_block = left_out.iter().any(|key| key == "cask.inertia_kg_m2");
        Self { inertia: if is_block { INERTIA_OF_BLOCK } else { usual.inertia }, ..usual }
    }
}

/// Which corrections of the samples may be made; what is made is reported with its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "four switches that have nothing to do with one another")]
pub struct Corrections {
    /// The mean of the free fall is taken off.
    pub offset: bool,
    /// A change of the offset at the first impact is fitted and taken off.
    pub zero_shift: bool,
    /// A channel that is stamped late or early is shifted.
    pub skew: bool,
    /// Mains hum seen in the free fall is taken off.
    pub hum: bool,
}

impl Default for Corrections {
    fn default() -> Self {
        Self { offset: true, zero_shift: true, skew: true, hum: true }
    }
}
