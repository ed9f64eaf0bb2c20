//! A wrong statement to the cask file that makes it.

use super::super::Case;
use super::super::draw::Wish;
use super::{Kind, SOUND, rest};
use crate::data::Contact;

pub(super) const KINDS: &[Kind] = &[
    Kind { name: "stated_position", sizes: &[0.03, 0.1, 0.3, 1.0], unit: "m", before: position, ..SOUND },
    Kind { name: "stated_angle", sizes: &[0.5, 1.0, 2.0, 5.0, 10.0], unit: "°", before: angle, ..SOUND },
    Kind {
        name: "stated_height",
        sizes: &[2.0, 5.0, 10.0, 20.0, 50.0],
        unit: "%",
        wish: |_| rest(false),
        before: height,
        ..SOUND
    },
    Kind {
        name: "stated_height_rest",
        sizes: &[2.0, 5.0, 10.0, 20.0, 50.0],
        unit: "%",
        wish: |_| rest(true),
        before: height,
        ..SOUND
    },
    Kind {
        name: "stated_rough",
        sizes: &[0.0, 0.1, 0.2, 0.4],
        unit: "true μ",
        wish: |size| contact(Contact::Coulomb(size), false),
        before: |case, _| state(case, Contact::Rough),
        ..SOUND
    },
    Kind {
        name: "stated_rough_axial",
        sizes: &[0.0, 0.1, 0.2, 0.4],
        unit: "true μ",
        wish: |size| contact(Contact::Coulomb(size), true),
        before: |case, _| state(case, Contact::Rough),
        ..SOUND
    },
    Kind {
        name: "stated_smooth",
        sizes: &[0.05, 0.1, 0.3, 1.0],
        unit: "true μ",
        wish: |size| contact(Contact::Coulomb(size), false),
        before: |case, _| state(case, Contact::Smooth),
        ..SOUND
    },
    Kind {
        name: "stated_smooth_axial",
        sizes: &[0.05, 0.1, 0.3, 1.0],
        unit: "true μ",
        wish: |size| contact(Contact::Coulomb(size), true),
        before: |case, _| state(case, Contact::Smooth),
        ..SOUND
    },
    Kind { name: "stated_cog", sizes: &[0.02, 0.05, 0.1, 0.2, 0.5], unit: "m", before: cog, ..SOUND },
    Kind { name: "stated_inertia", sizes: &[3.0, 10.0, 30.0, 100.0], unit: "%", before: inertia, ..SOUND },
];

/// A drop with this contact, with or without an axial channel.
fn contact(contact: Contact, axial: bool) -> Wish {
    Wish { contact: Some(contact), axial: Some(axial), slow_recorder: true, ..Wish::new() }
}

/// A key of the cask file that is given after all.
fn given(case: &mut Case, key: &str) {
    case.stated.defaults.retain(|default| default != key);
}

/// Too large or too small by `size` percent.
fn factor(case: &mut Case, size: f64) -> f64 {
    let factor = 1.0 + size / 100.0;
    if case.chance.is(0.5) { factor } else { 1.0 / factor }
}

/// One of A1 and A2 somewhere else along the cask; still on it, so that nothing but the data can tell.
fn position(case: &mut Case, size: f64) {
    let (which, sign) = (case.chance.index(2), case.chance.sign());
    let length_m = case.stated.cask.length_m;
    let position_m = &mut case.stated.channels[which].position_m;
    let moved_m = *position_m + sign * size;
    *position_m = if (0.0..=length_m).contains(&moved_m) { moved_m } else { *position_m - sign * size };
}

fn angle(case: &mut Case, size: f64) {
    let stated_deg = case.stated.drop.angle_rad.to_degrees();
    let moved_deg = stated_deg + case.chance.sign() * size;
    let moved_deg = if moved_deg > 0.0 { moved_deg } else { stated_deg + size };
    case.stated.drop.angle_rad = moved_deg.to_radians();
}

fn height(case: &mut Case, size: f64) {
    let factor = factor(case, size);
    let drop = &mut case.stated.drop;
    drop.height_m *= factor;
    drop.impact_velocity_m_s = (2.0 * drop.gravity_m_s2 * drop.height_m).sqrt();
}

fn state(case: &mut Case, contact: Contact) {
    given(case, "contact.friction");
    case.stated.contact = contact;
}

fn cog(case: &mut Case, size: f64) {
    given(case, "cask.cog_m");
    let sign = case.chance.sign();
    case.stated.cask.cog_m += sign * size;
}

fn inertia(case: &mut Case, size: f64) {
    given(case, "cask.inertia_kg_m2");
    let factor = factor(case, size);
    case.stated.cask.inertia_kg_m2 *= factor;
}
