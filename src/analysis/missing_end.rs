//! The channels of one end to what the cask's mass properties say of the other one, where that has none.

use crate::data::planar::arms_m;
use crate::data::{
    Axis, BodyModel, Cask, CaskFile, Contact, Drop, End, FlightFit, Recording, ScaledCopy, Signal,
};
use crate::predict;

/// R cannot strike before this share of the earliest time that is predicted for any k.
const EARLIEST: f64 = 0.9;
/// The k between which the earliest lies.
const RESTITUTIONS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Share of the turning during the contact that the force has seen in its mean: of a half sine under which
/// the rotation grows with the impulse. As L leaves, what sticks has seen all of it.
const MEAN_TURN: f64 = 0.25;

/// An end without a transverse channel of its own.
pub struct StandIn {
    /// The end that has none.
    pub end: End,
    /// Where the signal that stands in is, and where the one is that it is made of, from L, m.
    at_m: (f64, f64),
    /// Its velocity step over that of the end that has one.
    share: f64,
    /// Standard uncertainty of its velocity step, as a share of it.
    u_share: f64,
}

impl StandIn {
    /// Name of the signal that stands in, as the report shows it.
    const fn name(end: End) -> &'static str {
        match end {
            End::First => "the first end (by the mass properties)",
            End::Second => "the second end (by the mass properties)",
        }
    }

    /// Takes into account that the cask turned by `turned_rad` in the contact: by no more than until it lies
    /// flat.
    pub fn turn(&mut self, file: &CaskFile, signals: &mut [Signal], turned_rad: f64) {
        let turned_rad = turned_rad.max(0.0).min(file.drop.angle_rad);
        let Some((share, u_share)) = share_and_u(file, self.at_m, turned_rad) else { return };
        let by = share / self.share;
        (self.share, self.u_share) = (share, u_share);
        for signal in signals.iter_mut().filter(|s| s.name == Self::name(self.end)) {
            signal.force_m_s2.iter_mut().for_each(|f| *f *= by);
        }
    }

    /// Which of the signals it is, and of which it is made.
    pub fn stood_in(&self, signals: &[Signal]) -> Option<ScaledCopy> {
        let is_made_of = |s: &Signal| s.axis == Axis::Transverse && s.end != self.end;
        let channel = signals.iter().position(|s| s.name == Self::name(self.end))?;
        Some(ScaledCopy { channel, by: signals.iter().position(is_made_of)?, share: self.share })
    }

    /// Tells a flight fit how little is known of this end.
    pub fn doubt(&self, flight: &mut FlightFit) {
        for plateau in flight.plateaus.iter_mut().filter(|p| p.channel == Self::name(self.end)) {
            plateau.u_m_s = plateau.u_m_s.hypot(self.u_share * plateau.velocity_step_m_s);
        }
    }
}

/// What the first impact changes the velocity of the end that shows it by at the least (k = 0), m/s: v0 cos φ
/// of L, its share of that of R where only R has a transverse channel.
pub fn least_step_m_s(file: &CaskFile, recording: &Recording) -> f64 {
    let of_first_m_s = file.drop.transverse_velocity_m_s().max(file.drop.least_impact_m_s());
    let transverse = || recording.channels.iter().filter(|c| c.axis == Axis::Transverse);
    let far = transverse().next().filter(|_| transverse().all(|c| c.end == End::Second));
    let share =
        far.and_then(|c| step_ratio(&file.cask, &file.drop, (file.contact, 0.0), (c.position_m, 0.0), 0.0));
    share.map_or(of_first_m_s, |share| share.abs() * of_first_m_s)
}

/// Adds the signal of the end without a transverse channel where only the other one has some: a rigid body
/// struck at L's corner has its transverse forces in one ratio all along, whatever k is   (38)
///
/// Without R its slap-down is not in the record: what comes later than it could come is cut off.
pub fn stand_in(file: &CaskFile, signals: &mut Vec<Signal>, contact_s: f64) -> Option<StandIn> {
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
    let mut other = Signal { name: StandIn::name(end).into(), end, position_m, ..known };
    other.force_m_s2.iter_mut().for_each(|f| *f *= share);
    other.noise_spectrum.iter_mut().for_each(|bin| bin.1 *= share * share);
    other.noise_m_s2 *= share.abs();
    other.u_offset_m_s2 *= share.abs();
    signals.push(other);
    if end == End::Second {
        let soonest_s = soonest_slap_down_s(file);
        for signal in signals.iter_mut() {
            *signal = signal.cut(0, signal.index_from(contact_s + EARLIEST * soonest_s));
        }
    }
    Some(StandIn { end, at_m, share, u_share })
}

/// The earliest time from first contact to slap-down that is predicted for any k.
fn soonest_slap_down_s(file: &CaskFile) -> f64 {
    let body = predict::body(&file.cask, BodyModel::Body);
    let flight_s = |k: &f64| predict::predict(&body, &file.drop, file.contact, *k).flight_time_s;
    RESTITUTIONS.iter().filter_map(flight_s).fold(f64::INFINITY, f64::min)
}

/// The ratio of the velocity steps at two places and its standard uncertainty from inertia, centre of
/// gravity, angle and contact law, as a share of it.
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

/// Transverse velocity step at one place over that at another, of a rigid body struck at L's corner that
/// turns by so much meanwhile; the contact law with the share that it is off, of the way to the other law.
/// `None` near the centre of percussion.
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
    let held = predict::predict(&body, &mean, Contact::Rough, 1.0).impulse_ratio;
    let obeyed = predict::predict(&body, &mean, law, 1.0).impulse_ratio;
    // What sticks to the end has the impulse along the target of the angle at the end: I_x = m ω b
    let left_by = arms_m(drop.angle_rad - turned_rad).1 / b_m;
    let impulse_ratio = if (obeyed - held).abs() < 1e-9 {
        held * left_by * (1.0 - off)
    } else {
        obeyed + off * (held - obeyed)
    };
    // Δv_η(x) = (I_z cos φ − I_x sin φ)/m − ω (x − c),  Θ ω = a I_z − b I_x, for I_z = m   (38)
    let (sin, cos) = mean.angle_rad.sin_cos();
    let of_s = cos - impulse_ratio * sin;
    let omega_per_m = (a_m - b_m * impulse_ratio) * body.mass_kg / body.inertia_kg_m2;
    let step = |x_m: f64| of_s - omega_per_m * (x_m - cask.cog_m);
    let over = step(over_m);
    (over.abs() > 0.1 * of_s.abs()).then(|| step(at_m) / over)
}
