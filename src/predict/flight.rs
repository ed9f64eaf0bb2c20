//! The motion just after L's impact to the motion just before R strikes.

use super::impact::{State, arms_m, strike_first_end};
use crate::data::{Body, Contact, FlightRegime, GRAZE_SHARE};
use crate::numerics::root::first_root;

/// More impacts of L than this before R strikes count as bouncing without end: with k ≤ 0.9 the 40th rebound is below 2 %.
const MOST_IMPACTS: u32 = 40;

/// Heights below this at the start of a flight are the contact itself, m.
const TOUCH_M: f64 = 1e-9;

pub(super) struct Outcome {
    pub at_second_end: Option<State>,
    pub flight_time_s: Option<f64>,
    pub impacts: u32,
    pub regime: FlightRegime,
}

/// Follows flight and further impacts of L until R strikes, or says that it does not.
pub(super) fn fly_until_second_end(
    body: &Body,
    gravity_m_s2: f64,
    contact: Contact,
    k: f64,
    after_impact: State,
) -> Outcome {
    let mut state = after_impact;
    let mut elapsed_s = 0.0;
    let mut impacts = 1;
    if k <= 0.0 && !lifts_off(body, gravity_m_s2, contact, &state) {
        return stays(body, gravity_m_s2, contact, &state, (elapsed_s, impacts));
    }
    loop {
        let second = next_touch(body, gravity_m_s2, &state, body.cog_m - body.length_m);
        let first = next_touch(body, gravity_m_s2, &state, body.cog_m).filter(|&from_s| {
            second.is_none_or(|to_s| strikes_again(body, gravity_m_s2, &state, from_s..to_s))
        });
        match (second, first) {
            (Some(t), again) if again.is_none_or(|u| t <= u) => {
                let at = state.after(t, gravity_m_s2);
                // R at the target but with the axis past the vertical is the other side of the cask.
                let strikes = at.angle_rad.cos() > 0.0 && at.second_end_velocity_m_s(body).1 < 0.0;
                return Outcome {
                    at_second_end: strikes.then_some(at),
                    flight_time_s: strikes.then_some(elapsed_s + t),
                    impacts,
                    regime: FlightRegime::Free,
                };
            }
            (_, Some(u)) => {
                state = strike_first_end(body, &state.after(u, gravity_m_s2), contact, k).0;
                elapsed_s += u;
                impacts += 1;
                if impacts >= MOST_IMPACTS || k <= 0.0 {
                    return stays(body, gravity_m_s2, contact, &state, (elapsed_s, impacts));
                }
            }
            _ => {
                return Outcome {
                    at_second_end: None,
                    flight_time_s: None,
                    impacts,
                    regime: FlightRegime::Free,
                };
            }
        }
    }
}

/// L has come to rest on the target: it pivots or slides until R strikes. With Coulomb friction it is taken to stick where the
/// last impact did, else to slide freely: between the two closed forms there is none.
fn stays(
    body: &Body,
    gravity_m_s2: f64,
    contact: Contact,
    state: &State,
    (elapsed_s, impacts): (f64, u32),
) -> Outcome {
    let law = match contact {
        Contact::Coulomb(mu) => {
            let (a, b) = arms_m(body, state.angle_rad, body.cog_m);
            // Friction that the pivot of a body at rest needs: a b / (r² + b²) of the normal force   (6)
            let needed = a * b / (body.inertia_kg_m2 / body.mass_kg + b * b);
            if needed <= mu { Contact::Rough } else { Contact::Smooth }
        }
        law => law,
    };
    let kept = contact_kept(body, gravity_m_s2, law, state);
    Outcome {
        at_second_end: kept.map(|(s, _)| s),
        flight_time_s: kept.map(|(_, t)| elapsed_s + t),
        impacts,
        regime: FlightRegime::Contact,
    }
}

/// First time after now at which the lower corner `along_m` behind S comes down to the target, s.
///
/// z(τ) = z_S + ż_S τ − g τ²/2 − b(φ − ω τ), |z̈| ≤ g + ω² ρ   (8)
fn next_touch(body: &Body, gravity_m_s2: f64, state: &State, along_m: f64) -> Option<f64> {
    let reach_m = along_m.hypot(body.height_m / 2.0);
    let bound_m_s2 = gravity_m_s2 + state.angular_velocity_rad_s.powi(2) * reach_m;
    // From here on S itself lies deeper than the corner can reach up.
    let rise_m_s = state.vertical_velocity_m_s;
    let last_s = (rise_m_s
        + (rise_m_s * rise_m_s + 2.0 * gravity_m_s2 * (state.height_m.abs() + reach_m)).sqrt())
        / gravity_m_s2;
    first_root(
        |t| {
            let (height_m, velocity_m_s) = state.after(t, gravity_m_s2).corner(body, along_m);
            (height_m, velocity_m_s)
        },
        bound_m_s2,
        last_s,
        TOUCH_M,
    )
}

/// Whether L, back on the target plane at the start of `span_s`, sinks deeper than a graze before its end.
fn strikes_again(body: &Body, gravity_m_s2: f64, state: &State, span_s: std::ops::Range<f64>) -> bool {
    const POINTS: u32 = 32;
    (1..=POINTS).any(|i| {
        let t = span_s.start + (span_s.end - span_s.start) * f64::from(i) / f64::from(POINTS);
        state.after(t, gravity_m_s2).corner(body, body.cog_m).0 < -GRAZE_SHARE * body.length_m
    })
}

/// Whether the contact force that would keep L on the target is a pull: then it lifts off at once.
///
/// Normal force per mass that keeps z̈_C = 0: (g − ω² b) / n_zz for a free tangential direction, and the rough one with ẍ_C = 0   (10)
fn lifts_off(body: &Body, gravity_m_s2: f64, contact: Contact, state: &State) -> bool {
    let (a, b) = arms_m(body, state.angle_rad, body.cog_m);
    let w2 = state.angular_velocity_rad_s.powi(2);
    let r2 = body.inertia_kg_m2 / body.mass_kg;
    // z̈_C = −g + ω² b + N (1 + a²/r²) − T a b / r²,  ẍ_C = ω² a + T (1 + b²/r²) − N a b / r², per unit mass.
    let (n_xx, n_zz, n_xz) = (1.0 + b * b / r2, 1.0 + a * a / r2, a * b / r2);
    let wanted_z = gravity_m_s2 - w2 * b;
    let normal = match contact {
        Contact::Rough => (n_xx * wanted_z - n_xz * w2 * a) / (n_xx * n_zz - n_xz * n_xz),
        Contact::Smooth => wanted_z / n_zz,
        Contact::Coulomb(mu) => wanted_z / (n_zz - mu * n_xz),
    };
    normal <= 0.0
}

/// L kept on the target until the axis lies flat: motion just before R strikes and the time it takes, s; `None` for Coulomb friction.
///
/// Rough: (Θ + m(a² + b²)) ω² grows by 2 m g Δz_S (11); smooth: (Θ + m a²) ω² does (12); time ∫ dφ / ω.
pub(super) fn contact_kept(
    body: &Body,
    gravity_m_s2: f64,
    contact: Contact,
    state: &State,
) -> Option<(State, f64)> {
    let sliding = match contact {
        Contact::Rough => false,
        Contact::Smooth => true,
        Contact::Coulomb(_) => return None,
    };
    let (m, theta) = (body.mass_kg, body.inertia_kg_m2);
    let moment = |angle_rad: f64| {
        let (a, b) = arms_m(body, angle_rad, body.cog_m);
        theta + m * (a * a + if sliding { 0.0 } else { b * b })
    };
    let height_m = |angle_rad: f64| arms_m(body, angle_rad, body.cog_m).1;
    let start_energy = moment(state.angle_rad) * state.angular_velocity_rad_s.powi(2);
    let spin = |angle_rad: f64| {
        let gained = 2.0 * m * gravity_m_s2 * (height_m(state.angle_rad) - height_m(angle_rad));
        ((start_energy + gained) / moment(angle_rad)).max(0.0).sqrt()
    };
    let w = spin(0.0);
    let (a, b) = arms_m(body, 0.0, body.cog_m);
    let flat = State {
        height_m: height_m(0.0),
        angle_rad: 0.0,
        horizontal_velocity_m_s: if sliding { state.horizontal_velocity_m_s } else { b * w },
        vertical_velocity_m_s: -a * w,
        angular_velocity_rad_s: w,
    };
    let time_s = crate::numerics::quadrature::simpson(|phi| 1.0 / spin(phi), 0.0, state.angle_rad, 64);
    time_s.is_finite().then_some((flat, time_s))
}
