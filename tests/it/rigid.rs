//! From positions, velocities and impulses of a rigid body in the plane to those of its corners: vectors
//! only, no closed form.

use dropcheck::data::Body;

/// A vector in the fixed frame: x along the target, z up.
#[derive(Clone, Copy, Debug)]
pub struct Vector {
    pub x: f64,
    pub z: f64,
}

/// A point of the body from its centre of gravity, axial and transverse, m.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub axial_m: f64,
    pub transverse_m: f64,
}

impl Point {
    /// The lower corner of the first end.
    pub fn first_end(body: &Body) -> Self {
        Self { axial_m: -body.cog_m, transverse_m: -body.height_m / 2.0 }
    }

    /// The lower corner of the second end.
    pub fn second_end(body: &Body) -> Self {
        Self { axial_m: body.length_m - body.cog_m, transverse_m: -body.height_m / 2.0 }
    }
}

/// Where a rigid body is and how it moves; `turn_rad_s` is dφ/dt, counterclockwise.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    pub position_m: Vector,
    pub angle_rad: f64,
    pub velocity_m_s: Vector,
    pub turn_rad_s: f64,
}

impl Motion {
    /// From the centre of gravity to the point, m.
    pub fn arm_m(&self, point: Point) -> Vector {
        let (sine, cosine) = self.angle_rad.sin_cos();
        Vector {
            x: point.axial_m * cosine - point.transverse_m * sine,
            z: point.axial_m * sine + point.transverse_m * cosine,
        }
    }

    /// The point's height above the target, m.
    pub fn height_m(&self, point: Point) -> f64 {
        self.position_m.z + self.arm_m(point).z
    }

    /// The point's velocity, m/s.
    pub fn velocity_at_m_s(&self, point: Point) -> Vector {
        let arm_m = self.arm_m(point);
        Vector {
            x: self.velocity_m_s.x - self.turn_rad_s * arm_m.z,
            z: self.velocity_m_s.z + self.turn_rad_s * arm_m.x,
        }
    }

    /// The motion after an impulse at the end of an arm, N s.
    pub fn pushed(&self, body: &Body, arm_m: Vector, impulse_n_s: Vector) -> Self {
        Self {
            velocity_m_s: Vector {
                x: self.velocity_m_s.x + impulse_n_s.x / body.mass_kg,
                z: self.velocity_m_s.z + impulse_n_s.z / body.mass_kg,
            },
            turn_rad_s: self.turn_rad_s
                + (arm_m.x * impulse_n_s.z - arm_m.z * impulse_n_s.x) / body.inertia_kg_m2,
            ..*self
        }
    }

    /// The motion after `time_s` without any force.
    pub fn drifted(&self, time_s: f64) -> Self {
        Self {
            position_m: Vector {
                x: self.position_m.x + self.velocity_m_s.x * time_s,
                z: self.position_m.z + self.velocity_m_s.z * time_s,
            },
            angle_rad: self.angle_rad + self.turn_rad_s * time_s,
            ..*self
        }
    }

    /// The motion after gravity has acted for `time_s` in place.
    pub fn pulled(&self, gravity_m_s2: f64, time_s: f64) -> Self {
        let velocity_m_s = Vector { z: self.velocity_m_s.z - gravity_m_s2 * time_s, ..self.velocity_m_s };
        Self { velocity_m_s, ..*self }
    }

    /// The motion after `time_s` of free flight: drift, pull, drift is exact for a constant force.
    pub fn flown(&self, gravity_m_s2: f64, time_s: f64) -> Self {
        self.drifted(time_s / 2.0).pulled(gravity_m_s2, time_s).drifted(time_s / 2.0)
    }

    /// Kinetic and potential energy, J.
    pub fn energy_j(&self, body: &Body, gravity_m_s2: f64) -> f64 {
        let speed_m_s = self.velocity_m_s.x.hypot(self.velocity_m_s.z);
        0.5 * body.mass_kg * speed_m_s.powi(2)
            + 0.5 * body.inertia_kg_m2 * self.turn_rad_s.powi(2)
            + body.mass_kg * gravity_m_s2 * self.position_m.z
    }
}
