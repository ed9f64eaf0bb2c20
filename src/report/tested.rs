//! A cask file to the chapter that says what was dropped.

use super::document::{Chapter, ChapterPart, Fact, PartContent};
use super::medium::Medium;
use super::rounding::plain;
use super::words::contact_words;
use crate::data::CaskFile;

/// The settings that the chapter has already.
pub(super) const TOLD: [&str; 9] = [
    "mass",
    "length",
    "section in the plane of the drop",
    "centre of gravity from the first end",
    "inertia",
    "drop angle",
    "impact velocity",
    "gravity",
    "contact law of the first end",
];

/// The cask, the drop and the contact; what is a default is marked.
pub(super) fn tested(file: &CaskFile, heading: &str) -> Chapter {
    let (cask, drop) = (&file.cask, &file.drop);
    let fact = |name: &str, key: &str, value: String, unit: &str| Fact {
        is_default: file.defaults.iter().any(|d| d == key),
        ..Fact::number(name, value).note(unit)
    };
    let is_rod = cask.height_m <= 0.0;
    let section = if is_rod { "thin rod".into() } else { plain(cask.height_m, 5) };
    let velocity =
        if drop.impact_velocity_given { "Impact velocity, as stated" } else { "Impact velocity, √(2 g h)" };
    let mut of_cask = vec![
        fact("Mass", "cask.mass_kg", plain(cask.mass_kg, 6), "kg"),
        fact("Length between the ends that strike", "cask.length_m", plain(cask.length_m, 6), "m"),
        fact("Section in the plane of the drop", "cask.height_m", section, if is_rod { "" } else { "m" }),
        fact("Centre of gravity from the first end", "cask.cog_m", plain(cask.cog_m, 6), "m"),
        fact(
            "Inertia about the centre of gravity",
            "cask.inertia_kg_m2",
            plain(cask.inertia_kg_m2, 6),
            "kg\u{a0}m²",
        ),
    ];
    if let Some(width_m) = cask.width_m {
        of_cask.insert(3, fact("Section across that plane", "cask.width_m", plain(width_m, 6), "m"));
    }
    let mut of_drop = vec![
        fact("Free-fall height", "drop.height_m", plain(drop.height_m, 6), "m"),
        fact("Inclination of the axis", "drop.angle_deg", plain(drop.angle_rad.to_degrees(), 6), "°"),
        fact(velocity, "drop.impact_velocity", plain(drop.impact_velocity_m_s, 5), "m/s"),
        fact("Gravity", "drop.gravity_m_s2", plain(drop.gravity_m_s2, 6), "m/s²"),
        fact("Contact of the first end", "contact.friction", contact_words(file.contact), ""),
    ];
    if drop.contact_duration_s > 0.0 {
        let lasts_ms = plain(1e3 * drop.contact_duration_s, 5);
        of_drop.push(fact("First impact lasts", "contact.duration_s", lasts_ms, "ms"));
    }
    Chapter::new(heading).only(Medium::Page).with(PartContent::Beside([
        vec![ChapterPart::facts(format!("Cask {}", cask.name), of_cask)],
        vec![ChapterPart::facts("Drop and contact", of_drop)],
    ]))
}
