//! The channels of the first end to what the cask's mass properties say of the second one, where that has none.

use crate::data::{Axis, Body, BodyModel, Cask, CaskFile, Drop, End, FlightFit, Signal};
use crate::predict;

/// R cannot strike before this share of the earliest time that is predicted for any k.
const EARLIEST: f64 = 0.9;
/// The k between which the earliest lies.
const RESTITUTIONS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// The second end without a transverse channel of its own.
pub(crate) struct StandIn {
    /// Standard uncertainty of its velocity step, as a share of it.
    u_share: f64,
}

impl StandIn {
    /// Name of the signal that stands in, as the report shows it.
    const NAME: &'static str = "the second end (by the mass properties)";

    /// Tells a flight fit how little is known of this end.
    pub fn doubt(&self, flight: &mut FlightFit) {
        for plateau in flight.plateaus.iter_mut().filter(|p| p.channel == Self::NAME) {
            plateau.u_m_s = plateau.u_m_s.hypot(self.u_share * plateau.velocity_step_m_s);
        }
    }
}

/// Adds the signal of the second end where only the first one has a transverse channel: a rigid body struck at L's corner has its
/// transverse forces in one ratio all along, whatever k is   (38)
///
/// R's slap-down is not in the record: what comes later than it could come is cut off.
pub(crate) fn stand_in(file: &CaskFile, signals: &mut Vec<Signal>, contact_s: f64) -> Option<StandIn> {
    let mut transverse = signals.iter().filter(|s| s.axis == Axis::Transverse);
    let known = transverse.next().filter(|s| s.end == End::First)?;
    if transverse.any(|s| s.end == End::Second) {
        return None;
    }
    let known = known.clone();
    let position_m = file.cask.length_m - known.position_m;
    let ratio = |cask: &Cask, drop: &Drop| step_ratio(cask, drop, file, (position_m, known.position_m));
    let share = ratio(&file.cask, &file.drop)?;
    let u_share = u_ratio(file, &ratio)? / share.abs();
    let mut other = Signal { name: StandIn::NAME.into(), end: End::Second, position_m, ..known };
    other.force_m_s2.iter_mut().for_each(|f| *f *= share);
    other.noise_spectrum.iter_mut().for_each(|bin| bin.1 *= share * share);
    other.noise_m_s2 *= share.abs();
    other.u_offset_m_s2 *= share.abs();
    signals.push(other);
    let body = predict::body(&file.cask, BodyModel::Body);
    let flight_s = |k: &f64| predict::predict(&body, &file.drop, file.contact, *k).flight_time_s;
    let soonest_s = RESTITUTIONS.iter().filter_map(flight_s).fold(f64::INFINITY, f64::min);
    for signal in signals.iter_mut() {
        *signal = signal.cut(0, signal.index_from(contact_s + EARLIEST * soonest_s));
    }
    Some(StandIn { u_share })
}

/// Transverse velocity step at one place over that at another, of a rigid body struck at L's corner; `None` near the centre of percussion.
fn step_ratio(cask: &Cask, drop: &Drop, file: &CaskFile, (at_m, over_m): (f64, f64)) -> Option<f64> {
    let body = predict::body(cask, BodyModel::Body);
    let struck = predict::predict(&body, drop, file.contact, 1.0);
    let (up_n_s, omega_rad_s) = (vertical_impulse_n_s(&body, drop, &struck), struck.angular_velocity_rad_s);
    let (sin, cos) = drop.angle_rad.sin_cos();
    // Δv_η(x) = (I_z cos φ − I_x sin φ)/m − ω (x − c)   (38)
    let of_s_m_s = up_n_s * (cos - struck.impulse_ratio * sin) / body.mass_kg;
    let step_m_s = |x_m: f64| of_s_m_s - omega_rad_s * (x_m - cask.cog_m);
    let over_m_s = step_m_s(over_m);
    (over_m_s.abs() > 0.1 * of_s_m_s.abs()).then(|| step_m_s(at_m) / over_m_s)
}

/// I_z of Θ ω = a I_z − b I_x   (1)
fn vertical_impulse_n_s(body: &Body, drop: &Drop, struck: &crate::data::Prediction) -> f64 {
    let (sin, cos) = drop.angle_rad.sin_cos();
    let (a_m, b_m) =
        (body.cog_m * cos - body.height_m / 2.0 * sin, body.cog_m * sin + body.height_m / 2.0 * cos);
    body.inertia_kg_m2 * struck.angular_velocity_rad_s / (a_m - b_m * struck.impulse_ratio)
}

/// Standard uncertainty of the ratio from inertia, centre of gravity and angle.
fn u_ratio(file: &CaskFile, ratio: &dyn Fn(&Cask, &Drop) -> Option<f64>) -> Option<f64> {
    let known = &file.tolerances;
    let with = |inertia: f64, cog: f64, angle: f64| {
        // Half of a 95 % half-width is a standard uncertainty.
        let cask = Cask {
            inertia_kg_m2: file.cask.inertia_kg_m2 * (1.0 + inertia * known.inertia / 2.0),
            cog_m: file.cask.cog_m + cog * known.cog_m / 2.0,
            ..file.cask.clone()
        };
        let angle_rad = file.drop.angle_rad + angle * known.angle_rad / 2.0;
        ratio(&cask, &Drop { angle_rad, ..file.drop })
    };
    let moves = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
    moves.iter().try_fold(0.0_f64, |u, &(i, c, a)| Some(u.hypot((with(i, c, a)? - with(-i, -c, -a)?) / 2.0)))
}
