//! Equations of motion of the cask: a rigid body in the plane with two corners, its bending modes, which ride
//! on it or, for an elastic body, move its corners, and its loose masses.

use super::contact::CrushingCorner;
use super::elastic::{self, BodyMode, MOST_ELASTIC};
use crate::data::Contact;
use crate::lab::data::{BendingMode, LooseMass, Scene};
use crate::numerics::free_beam::MOST_MODES;
use std::f64::consts::PI;

/// x, z, φ, their rates, then q and q̇ of each bending mode; x along the target, z up, φ the inclination.
pub(super) const CASK_STATE: usize = 6 + 2 * MOST_MODES;

/// The state of the cask is followed by x, z and their rates for each loose mass.
pub(super) const WHOLE_STATE: usize = CASK_STATE + 4 * MOST_LOOSE;

/// [`WHOLE_STATE`] of an elastic body.
pub(super) const ELASTIC_STATE: usize = 6 + 2 * MOST_ELASTIC + 4 * MOST_LOOSE;

/// Most loose masses of a scene.
pub const MOST_LOOSE: usize = 2;

/// Share of the loading's √(m/K) in which a sticking corner loses the remainder of its sliding: short against
/// any pulse.
const HOLD_SHARE: f64 = 0.02;

/// Friction of a rough corner: far above the 1 or so that sticking needs, yet zero without a normal force.
///
/// Held without a bound, a returning corner would be thrown off by the hold itself, again and again.
const ROUGH: f64 = 100.0;

/// Greatest friction at R: both ends may be on the target there, and two sticking corners would contradict
/// each other.
const SECOND_END_FRICTION: f64 = 0.5;

/// Sliding speed over which the friction of R changes its sign, m/s: small against the metres per second of a
/// slap-down.
const REVERSAL_M_S: f64 = 0.2;

/// A corner's place relative to S and its motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct CornerMotion {
    /// Distance from S along the target, m.
    pub(super) x_m: f64,
    /// Height above S, m.
    pub(super) z_m: f64,
    /// Above the target, m.
    pub(super) height_m: f64,
    /// Along the target, m/s.
    pub(super) sliding_m_s: f64,
    /// Up, m/s.
    pub(super) rising_m_s: f64,
}

/// The forces on both corners, N: tangential, normal.
pub(super) type Loads = [(f64, f64); 2];

/// A loose mass with its place in the state and the deflections of the modes at its pads.
#[derive(Clone, Copy)]
struct Loose<'a> {
    at: usize,
    mass: &'a LooseMass,
    bends: &'a [f64],
}

/// Position of a loose mass, in body axes from S, and the force of its pads on it.
struct PadForce {
    xi_m: f64,
    /// Across the axis, N.
    force_n: f64,
}

/// The cask of a scene, with the memory of its dents.
#[derive(Debug, Clone)]
pub(super) struct SceneBody<'a> {
    pub(super) scene: &'a Scene,
    pub(super) corners: [CrushingCorner; 2],
    friction: f64,
    hold_s: f64,
    pub(super) modes: Vec<BodyMode>,
    /// Shape of each mode at either end, along and across the axis.
    pub(super) ends: Vec<[[f64; 2]; 2]>,
    /// True if the modes move the corners.
    acts_back: bool,
    /// Index at which the state of the loose masses begins.
    loose_from: usize,
    /// Deflection of each mode where each loose mass lies, at its pads.
    at_pads: Vec<Vec<f64>>,
}

impl<'a> SceneBody<'a> {
    /// The body as L touches.
    pub(super) fn new(scene: &'a Scene) -> Self {
        let (mass_kg, modes) = (scene.cask.mass_kg, elastic::modes(scene));
        let acts_back = scene.elastic.is_some();
        let at_pads = |loose: &LooseMass| {
            modes.iter().map(|mode| mode.shape(loose.position_m / scene.cask.length_m)).collect()
        };
        Self {
            scene,
            at_pads: scene.extras.contents.iter().map(at_pads).collect(),
            corners: [
                CrushingCorner::new(scene.first_end, mass_kg, true),
                CrushingCorner::new(scene.second_end, mass_kg, false),
            ],
            friction: match scene.contact {
                Contact::Rough | Contact::Unknown => ROUGH,
                Contact::Smooth => 0.0,
                Contact::Coulomb(coefficient) => coefficient,
            },
            hold_s: HOLD_SHARE * (mass_kg / scene.first_end.loading_n_m).sqrt(),
            ends: modes.iter().map(|mode| [0, 1].map(|end| mode.corner_shape(end, scene))).collect(),
            modes,
            acts_back,
            loose_from: if acts_back { ELASTIC_STATE - 4 * MOST_LOOSE } else { CASK_STATE },
        }
    }

    /// State at first contact: L at the target, the whole body at the impact velocity.
    pub(super) fn at_first_contact(&self) -> [f64; ELASTIC_STATE] {
        let drop = &self.scene.drop;
        let mut y = [0.0; ELASTIC_STATE];
        y[2] = drop.angle_rad;
        let first = self.corner(0, &y);
        y[1] = -first.z_m;
        y[3] = drop.horizontal_velocity_m_s;
        y[5] = -drop.angular_velocity_rad_s;
        y[4] = -drop.impact_velocity_m_s - y[5] * first.x_m;
        let (sin, cos) = drop.angle_rad.sin_cos();
        for Loose { at: i, mass: loose, .. } in self.loose_masses() {
            let xi_m = loose.position_m - self.scene.cask.cog_m;
            let (x_m, z_m) = (xi_m * cos, xi_m * sin);
            let start = [x_m, y[1] + z_m, y[3] - y[5] * z_m, y[4] + y[5] * x_m];
            y[i..i + 4].copy_from_slice(&start);
        }
        y
    }

    /// The loose masses.
    fn loose_masses(&self) -> impl Iterator<Item = Loose<'_>> {
        let masses = (self.loose_from..).step_by(4).zip(&self.scene.extras.contents);
        masses.zip(&self.at_pads).map(|((at, mass), bends)| Loose { at, mass, bends })
    }

    /// Force of the pads on a loose mass.
    fn pad_force(&self, loose: Loose, y: &[f64]) -> PadForce {
        let Loose { at: i, mass: loose, bends } = loose;
        let (sin, cos) = y[2].sin_cos();
        let [x, z, vx, vz] = [0, 1, 3, 4].map(|of| y[of]);
        let (x_m, z_m) = (y[i] - x, y[i + 1] - z);
        let (xi_m, mut eta_m) = (x_m * cos + z_m * sin, z_m * cos - x_m * sin);
        let mut rising_m_s = (y[i + 3] - vz) * cos - (y[i + 2] - vx) * sin - y[5] * xi_m;
        if self.acts_back {
            for (q, bends) in bends.iter().enumerate() {
                (eta_m, rising_m_s) = (eta_m - bends * y[6 + 2 * q], rising_m_s - bends * y[7 + 2 * q]);
            }
        }
        let stiffness_n_m = loose.mass_kg * (PI / loose.pulse_s).powi(2);
        // A pad only pushes; this formula has no step in the force when the mass meets it (Hunt & Crossley
        // 1975).
        let pad_n = |crush_m: f64, rate_m_s: f64| {
            stiffness_n_m * crush_m.max(0.0) * (1.0 + loose.damping_s_m * rate_m_s).max(0.0)
        };
        let below_n = pad_n(-loose.gap_m - eta_m, -rising_m_s);
        let above_n = pad_n(eta_m - (loose.play_m - loose.gap_m), rising_m_s);
        PadForce { xi_m, force_n: below_n - above_n }
    }

    /// Position and motion of L (0) or R (1), as seen from the target.
    pub(super) fn corner(&self, end: usize, y: &[f64]) -> CornerMotion {
        self.bent_corner(if self.acts_back { &self.ends } else { &[] }, end, y)
    }

    /// Adds the bending of the first of the modes, u along and w across the axis.
    pub(super) fn bent_corner(&self, modes: &[[[f64; 2]; 2]], end: usize, y: &[f64]) -> CornerMotion {
        let cask = &self.scene.cask;
        let ([mut u_m, mut w_m], [mut u_m_s, mut w_m_s]) = ([0.0; 2], [0.0; 2]);
        for (i, (ends, mode)) in modes.iter().zip(&self.modes).enumerate() {
            let [along, across] = ends[end];
            let [q_m, q_m_s] = [y[6 + 2 * i], y[7 + 2 * i]].map(|q| mode.mode.strength * q);
            (u_m, w_m) = (u_m + along * q_m, w_m + across * q_m);
            (u_m_s, w_m_s) = (u_m_s + along * q_m_s, w_m_s + across * q_m_s);
        }
        let xi_m = u_m + if end == 0 { -cask.cog_m } else { cask.length_m - cask.cog_m };
        let eta_m = w_m - cask.height_m / 2.0;
        let (sin, cos) = y[2].sin_cos();
        let (x_m, z_m) = (xi_m * cos - eta_m * sin, xi_m * sin + eta_m * cos);
        CornerMotion {
            x_m,
            z_m,
            height_m: y[1] + z_m,
            sliding_m_s: y[3] - y[5] * z_m + (u_m_s * cos - w_m_s * sin),
            rising_m_s: y[4] + y[5] * x_m + (u_m_s * sin + w_m_s * cos),
        }
    }

    /// Values that stay above zero while the phases of both corners last.
    pub(super) fn phase_margins(&self, y: &[f64]) -> [f64; 4] {
        let [first, second] = [0, 1].map(|end| {
            let at = self.corner(end, y);
            self.corners[end].phase_margins(at.height_m, at.rising_m_s)
        });
        [first[0], first[1], second[0], second[1]]
    }

    /// The forces on both corners, N.
    pub(super) fn loads(&self, y: &[f64]) -> Loads {
        if !self.corners.iter().any(CrushingCorner::touches) {
            return [(0.0, 0.0); 2];
        }
        let at = [0, 1].map(|end| self.corner(end, y));
        let normal_n = [0, 1].map(|end| self.corners[end].normal_n(at[end].height_m, at[end].rising_m_s));
        let reversal = (at[1].sliding_m_s / REVERSAL_M_S).tanh();
        let second_n = -self.friction.min(SECOND_END_FRICTION) * normal_n[1] * reversal;
        let mut loads = [(0.0, normal_n[0]), (second_n, normal_n[1])];
        if self.corners[0].touches() && self.friction > 0.0 {
            let hold_n = self.hold_n(y, &at[0], &loads);
            // The friction stays within Coulomb's bound.
            let bound_n = self.friction_at(at[0].sliding_m_s) * normal_n[0];
            loads[0].0 = hold_n.clamp(-bound_n, bound_n);
        }
        loads
    }

    /// Friction of L at this sliding speed.
    fn friction_at(&self, sliding_m_s: f64) -> f64 {
        let extras = &self.scene.extras;
        let returning = extras.returning_friction.filter(|_| self.corners[0].is_unloading());
        let held = returning.unwrap_or(self.friction);
        extras
            .falling_friction
            .map_or(held, |(fast, within_m_s)| fast + (held - fast) * (-sliding_m_s.abs() / within_m_s).exp())
    }

    /// Lever arm of the force on an end from S, along the target, m: as the end flattens it moves inward.
    fn arm_m(&self, end: usize, at: &CornerMotion) -> f64 {
        let (corner, inward) = (&self.corners[end], if end == 0 { 1.0 } else { -1.0 });
        at.x_m + inward * corner.law.footprint * corner.crush_m(at.height_m)
    }

    /// The additional tangential force on L that stops its sliding within the hold time and keeps it stopped,
    /// N.
    fn hold_n(&self, y: &[f64], at: &CornerMotion, loads: &Loads) -> f64 {
        let (cask, free) = (&self.scene.cask, self.accelerations(y, loads));
        // ẍ_C = ẍ_S − φ̈ z − φ̇² x without the force, and the change per newton.
        let mut without_m_s2 = free[0] - free[2] * at.z_m - y[5] * y[5] * at.x_m;
        let mut per_newton = 1.0 / cask.mass_kg + at.z_m * at.z_m / cask.inertia_kg_m2;
        if self.acts_back {
            let (sin, cos) = y[2].sin_cos();
            // Bending adds − 2 φ̇ ż′ + ẍ′, with its velocity z′ upwards.
            without_m_s2 -= 2.0 * y[5] * (at.rising_m_s - (y[4] + y[5] * at.x_m));
            for (i, [[along, across], _]) in self.ends.iter().enumerate() {
                let towards = along * cos - across * sin;
                without_m_s2 += towards * self.mode_m_s2(i, y, loads);
                per_newton += towards * towards / cask.mass_kg;
            }
        }
        (-at.sliding_m_s / self.hold_s - without_m_s2) / per_newton
    }

    /// Second derivative of a mode's coordinate under loads on the corners, m/s²: bending comes from the
    /// forces across the axis and, for an elastic body, from those along it below the axis.
    fn mode_m_s2(&self, i: usize, y: &[f64], loads: &Loads) -> f64 {
        let (sin, cos) = y[2].sin_cos();
        let mass_kg = self.scene.cask.mass_kg;
        let [first, second] = [0, 1].map(|end| {
            let (t, n) = loads[end];
            (n * cos - t * sin) * (self.ends[i][end][1] / mass_kg)
        });
        let mut drive_m_s2 = first + second;
        if self.acts_back {
            for (end, (t, n)) in loads.iter().enumerate() {
                drive_m_s2 += (t * cos + n * sin) * (self.ends[i][end][0] / mass_kg);
            }
        }
        bending_m_s2(&self.modes[i].mode, drive_m_s2, y[6 + 2 * i], y[7 + 2 * i])
    }

    /// ẍ and z̈ of S, m/s², and φ̈, rad/s².
    pub(super) fn accelerations(&self, y: &[f64], loads: &Loads) -> [f64; 3] {
        let (mut tangential_n, mut normal_n, mut moment_n_m) = (0.0, 0.0, 0.0);
        for (end, &(t, n)) in loads.iter().enumerate().filter(|(_, load)| **load != (0.0, 0.0)) {
            let at = self.corner(end, y);
            tangential_n += t;
            normal_n += n;
            moment_n_m += self.arm_m(end, &at) * n - at.z_m * t;
        }
        for loose in self.loose_masses() {
            let PadForce { xi_m, force_n } = self.pad_force(loose, y);
            let (sin, cos) = y[2].sin_cos();
            tangential_n += force_n * sin;
            normal_n -= force_n * cos;
            moment_n_m -= force_n * xi_m;
        }
        let cask = &self.scene.cask;
        [
            tangential_n / cask.mass_kg,
            normal_n / cask.mass_kg - self.scene.drop.gravity_m_s2,
            moment_n_m / cask.inertia_kg_m2,
        ]
    }

    /// Rates of the state under `loads`.
    pub(super) fn rates(&self, y: &[f64], loads: &Loads) -> [f64; ELASTIC_STATE] {
        let mut rates = [0.0; ELASTIC_STATE];
        for (i, acceleration) in self.accelerations(y, loads).into_iter().enumerate() {
            rates[i] = y[3 + i];
            rates[3 + i] = acceleration;
        }
        for i in 0..self.modes.len() {
            rates[6 + 2 * i] = y[7 + 2 * i];
            rates[7 + 2 * i] = self.mode_m_s2(i, y, loads);
        }
        let (sin, cos) = y[2].sin_cos();
        let cask = &self.scene.cask;
        for loose in self.loose_masses() {
            let (i, mass_kg, bends) = (loose.at, loose.mass.mass_kg, loose.bends);
            let PadForce { force_n, .. } = self.pad_force(loose, y);
            let (along_n, up_n) = (-force_n * sin, force_n * cos);
            let [along, up] = [along_n, up_n].map(|n| n / mass_kg);
            rates[i..i + 4].copy_from_slice(&[y[i + 2], y[i + 3], along, up - self.scene.drop.gravity_m_s2]);
            for (q, bends) in bends.iter().enumerate() {
                rates[7 + 2 * q] -= force_n * bends / cask.mass_kg;
            }
        }
        rates
    }

    /// Greatest angular frequency of the current state, rad/s: of a corner in contact or of a mode; for an
    /// elastic body a third of it, since its fastest modes have little of the motion.
    pub(super) fn fastest_rad_s(&self) -> f64 {
        let counts = if self.acts_back { 1.0 / 3.0 } else { 1.0 };
        let listed = self.scene.modes.iter().chain(self.modes.iter().map(|mode| &mode.mode));
        let modes = listed.map(|mode| counts * std::f64::consts::TAU * mode.frequency_hz);
        let corners = self.corners.iter().map(|c| (c.stiffness_n_m() / self.scene.cask.mass_kg).sqrt());
        let pads = self.loose_masses().map(|loose| PI / loose.mass.pulse_s);
        modes.chain(corners).chain(pads).fold(0.0, f64::max)
    }
}

/// q̈ = F/m − 2 ζ ω q̇ − ω² q: acceleration of the mode's coordinate, m/s², `drive_m_s2` being F/m.
///
/// Listed modes ride on the rigid motion and do not act back on the contact, so that k stays a property of
/// the ends.
pub fn bending_m_s2(mode: &BendingMode, drive_m_s2: f64, q_m: f64, velocity_m_s: f64) -> f64 {
    let omega = std::f64::consts::TAU * mode.frequency_hz;
    drive_m_s2 - 2.0 * mode.damping * omega * velocity_m_s - omega * omega * q_m
}
