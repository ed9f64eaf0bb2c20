//! The thin uniform rod of \[P\]: Table 1 to the motion just after L's impact.

use super::impact::{Struck, strike_first_end};
use super::state::{State, arms_m};
use crate::data::{Body, Contact};

/// \[P\] Table 1, with ż_S2 of the smooth impact put right: a rod that falls at v0 without rotation, rough or
/// smooth   (7)
///
/// `body` is a thin uniform rod; any friction counts as rough. One that turns or moves sideways as it strikes
/// is none of \[P\]'s (2).
pub(super) fn table_1(body: &Body, before: &State, contact: Contact, k: f64) -> Struck {
    if before.angular_velocity_rad_s != 0.0 || before.horizontal_velocity_m_s != 0.0 {
        return strike_first_end(body, before, contact, k);
    }
    let (l, v0) = (body.length_m, -before.vertical_velocity_m_s);
    let (a, b) = arms_m(body, before.angle_rad, body.cog_m);
    // a = (l/2) cos φ0, b = (l/2) sin φ0
    let (sin, cos) = (2.0 * b / l, 2.0 * a / l);
    let smooth = contact == Contact::Smooth;
    // rough ω2 = 3 (1 + k) v0 cos φ0 / (2 l), smooth ω2 = 6 (1 + k) v0 cos φ0 / (l (3 cos² φ0 + 1))
    let w = if smooth {
        6.0 * (1.0 + k) * v0 * cos / (l * (3.0 * cos * cos + 1.0))
    } else {
        3.0 * (1.0 + k) * v0 * cos / (2.0 * l)
    };
    // ẋ_S2 = ω2 (l/2) sin φ0 where L does not slide, ż_S2 = k v0 − ω2 (l/2) cos φ0
    let after = State {
        horizontal_velocity_m_s: if smooth { 0.0 } else { w * l / 2.0 * sin },
        vertical_velocity_m_s: k * v0 - w * l / 2.0 * cos,
        angular_velocity_rad_s: w,
        ..*before
    };
    Struck {
        after,
        horizontal_impulse_n_s: body.mass_kg * after.horizontal_velocity_m_s,
        vertical_impulse_n_s: body.mass_kg * (after.vertical_velocity_m_s + v0),
        // μ* = a b / (r² + b²), r² = l²/12   (6)
        friction_to_stick: a * b / (l * l / 12.0 + b * b),
        sticks: !smooth,
    }
}
