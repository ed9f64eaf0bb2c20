//! Wrong statements in the cask file.

use super::super::drawn::DrawnDrop;
use crate::data::{Contact, block_inertia_kg_m2};

/// Damages the cask file by `kind`; kinds that belong to another object have no effect.
pub(super) fn apply(kind: &str, case: &mut DrawnDrop, size: f64) {
    match kind {
        "stated_position" => position(case, size),
        "stated_angle" => {
            let stated_deg = case.stated.drop.angle_rad.to_degrees();
            let moved_deg = stated_deg + case.chance.sign() * size;
            let moved_deg = if moved_deg > 0.0 { moved_deg } else { stated_deg + size };
            case.stated.drop.angle_rad = moved_deg.to_radians();
        }
        "stated_height" | "stated_height_rest" => {
            let drop = &mut case.stated.drop;
            drop.height_m *= case.chance.factor(size);
            drop.impact_velocity_m_s = (2.0 * drop.gravity_m_s2 * drop.height_m).sqrt();
        }
        "stated_rough" | "stated_rough_axial" => state(case, Contact::Rough),
        "stated_smooth" | "stated_smooth_axial" => state(case, Contact::Smooth),
        "stated_cog" => {
            state_key(case, "cask.cog_m");
            case.stated.cask.cog_m += case.chance.sign() * size;
        }
        "stated_inertia" => {
            state_key(case, "cask.inertia_kg_m2");
            case.stated.cask.inertia_kg_m2 *= case.chance.factor(size);
        }
        "stated_length" => length(case, size),
        "stated_section" => {
            case.stated.cask.height_m *= case.chance.factor(size);
            follow(case);
        }
        "stated_off" => case.stated.channels[1].position_m = case.stated.cask.length_m + 0.3,
        "stated_one_end" => drop(case.stated.channels.remove(1)),
        _ => {}
    }
}

/// States a key of the cask file that had been omitted.
fn state_key(case: &mut DrawnDrop, key: &str) {
    case.stated.defaults.retain(|default| default != key);
}

/// Moves A1 or A2 along the cask; the position stays on the cask, so that only the data can reveal it.
fn position(case: &mut DrawnDrop, size: f64) {
    let (which, sign) = (case.chance.index(2), case.chance.sign());
    let length_m = case.stated.cask.length_m;
    let position_m = &mut case.stated.channels[which].position_m;
    let moved_m = *position_m + sign * size;
    *position_m = if (0.0..=length_m).contains(&moved_m) { moved_m } else { *position_m - sign * size };
}

fn state(case: &mut DrawnDrop, contact: Contact) {
    state_key(case, "contact.friction");
    case.stated.contact = contact;
}

/// Moves the second end away from its stated position; sensors keep their positions, within the cask.
fn length(case: &mut DrawnDrop, size: f64) {
    let drawn = case.chance.factor(size);
    let reach_m = case.stated.channels.iter().map(|spec| spec.position_m).fold(0.0, f64::max);
    let cask = &mut case.stated.cask;
    cask.length_m *= if drawn * cask.length_m < reach_m { 1.0 / drawn } else { drawn };
    follow(case);
}

/// Derives the values that the cask file omits from the sizes that it states.
fn follow(case: &mut DrawnDrop) {
    let is_left = |key: &str| case.stated.defaults.iter().any(|default| default == key);
    let cask = &mut case.stated.cask;
    if is_left("cask.cog_m") {
        cask.cog_m = cask.length_m / 2.0;
    }
    if is_left("cask.inertia_kg_m2") {
        cask.inertia_kg_m2 = block_inertia_kg_m2(cask.mass_kg, cask.length_m, cask.height_m);
    }
}
