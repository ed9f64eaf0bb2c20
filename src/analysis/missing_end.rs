//! Reconstructs the channel of an end without one from the channels of the other end and the cask's mass
//! properties.

use crate::data::planar::arms_m;
use crate::data::{
    Axis, BodyModel, Cask, CaskFile, Contact, Drop, End, FlightFit, Recording, ScaledCopy, Signal,
};
use crate::predict;

/// R cannot strike before this share of the earliest time predicted for any k.
const EARLIEST_SHARE: f64 = 0.9;
/// Values of k for which the time is predicted.
const RESTITUTIONS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Mean share of the rotation that has occurred while the force acts: for a half sine under which the
/// rotation grows with the impulse. When L leaves, all of it has occurred.
const MEAN_TURN: f64 = 0.25;

/// A reconstructed end, which has no transverse channel of its own.
pub struct ReconstructedEnd {
    /// The end without channel.
    pub end: End,
    /// Positions of the reconstructed signal and of its source, from L, m.
    at_m: (f64, f64),
    /// Ratio of its velocity step to that of the other end.
    share: f64,
    /// Standard uncertainty of its velocity step, as a share of it.
    u_share: f64,
}

impl ReconstructedEnd {
    /// Name of the reconstructed signal in the report.
    const fn name(end: End) -> &'static str {
        match end {
            End::First => "the first end (by the mass properties)",
            End::Second => "the second end (by the mass properties)",
        }
    }

    /// Includes that the cask turned by `turned_rad` in the contact, at most until it lies flat.
    pub fn apply_rotation(&mut self, file: &CaskFile, signals: &mut [Signal], turned_rad: f64) {
        let turned_rad = turned_rad.max(0.0).min(file.drop.angle_rad);
        let Some((share, u_share)) = share_and_u(file, self.at_m, turned_rad) else { return };
        let by = share / self.share;
        (self.share, self.u_share) = (share, u_share);
        for signal in signals.iter_mut().filter(|s| s.name == Self::name(self.end)) {
            signal.force_m_s2.iter_mut().for_each(|f| *f *= by);
        }
    }

    /// Identifies the reconstructed signal and its source.
    pub fn scaled_copy(&self, signals: &[Signal]) -> Option<ScaledCopy> {
        let is_made_of = |s: &Signal| s.axis == Axis::Transverse && s.end != self.end;
        let channel = signals.iter().position(|s| s.name == Self::name(self.end))?;
        Some(ScaledCopy { channel, by: signals.iter().position(is_made_of)?, share: self.share })
    }

    /// Adds the uncertainty of the reconstructed end to a flight fit.
    pub fn widen_uncertainty(&self, flight: &mut FlightFit) {
        for plateau in flight.plateaus.iter_mut().filter(|p| p.channel == Self::name(self.end)) {
            plateau.u_m_s = plateau.u_m_s.hypot(self.u_share * plateau.velocity_step_m_s);
        }
    }
}

/// Smallest change of velocity in the first impact (k = 0), at the end that shows it, m/s: v0 cos φ for L, a
/// share of it if only R has a transverse channel.
pub fn least_step_m_s(file: &CaskFile, recording: &Recording) -> f64 {
    let first_m_s = file.drop.transverse_velocity_m_s().max(file.drop.least_impact_m_s());
    let transverse = || recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let second_end = transverse().next().filter(|_| transverse().all(|c| c.end == End::Second));
    let share = second_end
        .and_then(|c| step_ratio(&file.cask, &file.drop, (file.contact, 0.0), (c.position_m, 0.0), 0.0));
    share.map_or(first_m_s, |share| share.abs() * first_m_s)
}

/// Adds the signal of the end without a transverse channel if the other end has one: the transverse forces of
/// a rigid body struck at L's corner have a constant ratio, independent of k   (38)
///
/// Without a channel at R the record does not show the slap-down: it is cut at the earliest possible time.
pub fn add_signal(file: &CaskFile, signals: &mut Vec<Signal>, contact_s: f64) -> Option<ReconstructedEnd> {
    let mut transverse = signals.iter().filter(|s| s.axis == Axis::Transverse);
    let known = transverse.next()?;
    if transverse.any(|s| s.end != known.end) {
        return None;
    }
    let end = if known.end == End::First { End::Second } else { End::First };
    let known = known.clone();
    let position_m = file.cask.length_m - known.position_m;
    let at_m = (position_m, known.position_m);
    let (share, u_share) = share_and_u(file, at_m, 0.0)?;
    let mut other = Signal { name: ReconstructedEnd::name(end).into(), end, position_m, ..known };
    other.force_m_s2.iter_mut().for_each(|f| *f *= share);
    other.noise_spectrum.iter_mut().for_each(|bin| bin.1 *= share * share);
    other.noise_m_s2 *= share.abs();
    other.u_offset_m_s2 *= share.abs();
    signals.push(other);
    if end == End::Second {
        let soonest_s = soonest_slap_down_s(file);
        for signal in signals.iter_mut() {
            *signal = signal.cut(0, signal.index_from(contact_s + EARLIEST_SHARE * soonest_s));
        }
    }
    Some(ReconstructedEnd { end, at_m, share, u_share })
}

/// Earliest time from first contact to slap-down predicted for any k.
fn soonest_slap_down_s(file: &CaskFile) -> f64 {
    let body = predict::body(&file.cask, BodyModel::Body);
    let flight_s = |k: &f64| predict::predict(&body, &file.drop, file.contact, *k).flight_time_s;
    RESTITUTIONS.iter().filter_map(flight_s).fold(f64::INFINITY, f64::min)
}

/// Ratio of the velocity steps at two places and its relative standard uncertainty from inertia, centre of
/// gravity, angle and contact law.
fn share_and_u(file: &CaskFile, at_m: (f64, f64), turned_rad: f64) -> Option<(f64, f64)> {
    let known = &file.tolerances;
    let with = |inertia: f64, cog: f64, angle: f64, law: f64| {
        // Half of a 95 % half-width is a standard uncertainty.
        let cask = Cask {
            inertia_kg_m2: file.cask.inertia_kg_m2 * (1.0 + inertia * known.inertia / 2.0),
            cog_m: file.cask.cog_m + cog * known.cog_m / 2.0,
            ..file.cask.clone()
        };
        let drop = Drop { angle_rad: file.drop.angle_rad + angle * known.angle_rad / 2.0, ..file.drop };
        step_ratio(&cask, &drop, (file.contact, law * known.friction / 2.0), at_m, turned_rad)
    };
    let moves = [(1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)];
    let u = moves.iter().try_fold(0.0_f64, |u, &(i, c, a, l)| {
        Some(u.hypot((with(i, c, a, l)? - with(-i, -c, -a, -l)?) / 2.0))
    })?;
    let share = with(0.0, 0.0, 0.0, 0.0)?;
    Some((share, u / share.abs()))
}

/// Ratio of the transverse velocity steps at two places of a rigid body that is struck at L's corner and
/// turns by `turned_rad` meanwhile; `off` shifts the contact law towards the other one, as a share. `None`
/// near the centre of percussion.
fn step_ratio(
    cask: &Cask,
    drop: &Drop,
    (law, off): (Contact, f64),
    (at_m, over_m): (f64, f64),
    turned_rad: f64,
) -> Option<f64> {
    let body = predict::body(cask, BodyModel::Body);
    let mean = Drop { angle_rad: drop.angle_rad - MEAN_TURN * turned_rad, ..*drop };
    let arms_m = |angle_rad: f64| arms_m(angle_rad.sin_cos(), body.cog_m, body.height_m);
    let (a_m, b_m) = arms_m(mean.angle_rad);
    let sticking = predict::predict(&body, &mean, Contact::Rough, 1.0).impulse_ratio;
    let stated = predict::predict(&body, &mean, law, 1.0).impulse_ratio;
    // A contact that sticks to its end has the impulse along the target that belongs to the final angle: I_x
    // = m ω b
    let left_by = arms_m(drop.angle_rad - turned_rad).1 / b_m;
    let impulse_ratio = if (stated - sticking).abs() < 1e-9 {
        sticking * left_by * (1.0 - off)
    } else {
        stated + off * (sticking - stated)
    };
    // Δv_η(x) = (I_z cos φ − I_x sin φ)/m − ω (x − c),  Θ ω = a I_z − b I_x, for I_z = m   (38)
    let (sin, cos) = mean.angle_rad.sin_cos();
    let at_cog = cos - impulse_ratio * sin;
    let omega_per_m = (a_m - b_m * impulse_ratio) * body.mass_kg / body.inertia_kg_m2;
    let step = |x_m: f64| at_cog - omega_per_m * (x_m - cask.cog_m);
    let over = step(over_m);
    (over.abs() > 0.1 * at_cog.abs()).then(|| step(at_m) / over)
}
