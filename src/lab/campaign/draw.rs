//! Draws a random drop: the cask, its fall and its impacts, both true and as stated.

use crate::data::planar::first_arm_m;
use crate::data::{Cask, CaskFile, Contact, Drop, Tolerances};
use crate::lab::chance::{Chance, round, round_to_three_digits};
use crate::lab::damage::{BetweenImpacts, Wish};
use crate::lab::data::{BendingMode, ElasticBody, Scene, Truth, WantedImpact};
use crate::lab::drawn::{BUILDS, Build, DRAWN, DrawnDrop, GRAVITY_M_S2, LEAST_FRICTION, cask_file, scene};
use crate::lab::envelope;
use crate::lab::synth;
use std::f64::consts::FRAC_PI_2;

/// Greatest crush of an end over its section: a limiter is used up to a third of it.
const LARGEST_CRUSH: f64 = 0.35;

/// Bending frequencies of a free uniform beam over its first.
const OVERTONES: [f64; 3] = [1.0, 2.757, 5.404];

/// A drop counts if it has a slap-down of this kind: k within, flight at least, s.
const K_RANGE: (f64, f64) = (0.02, 0.98);
const SHORTEST_FLIGHT_S: f64 = 8e-3;

/// The angle is drawn again only after this many attempts with it: else flat drops would be
/// under-represented.
const ATTEMPTS: u32 = 300;

/// Draws until there is a drop as wished.
pub(super) fn draw_drop(mut chance: Chance, wish: &Wish, exact: bool) -> DrawnDrop {
    let mut angle_deg = stated_angle_deg(&mut chance, wish);
    let mut attempt = 0_u32;
    loop {
        attempt += 1;
        let (scene, stated) = drop(&mut chance, angle_deg, wish, exact);
        let motion = match wish.flight {
            BetweenImpacts::LandsAgain => synth::simulate(&scene),
            _ => synth::simulate_one_flight(&scene),
        };
        if meets_wish(&motion.truth, wish) {
            return DrawnDrop { scene, stated, motion, chance };
        }
        if wish.flight != BetweenImpacts::Free || attempt.is_multiple_of(ATTEMPTS) {
            angle_deg = stated_angle_deg(&mut chance, wish);
        }
    }
}

/// Draws mostly 5 to 30°; at low angles R strikes soon, because it is close to the target.
fn stated_angle_deg(chance: &mut Chance, wish: &Wish) -> f64 {
    if wish.flight == BetweenImpacts::Short {
        return round(chance.uniform(2.0, 8.0), 1);
    }
    round(if chance.flip(0.8) { chance.uniform(5.0, 30.0) } else { chance.uniform(2.0, 60.0) }, 1)
}

/// True if the campaign accepts the drop.
fn meets_wish(truth: &Truth, wish: &Wish) -> bool {
    let is_short = truth.flight_s.is_none_or(|flight_s| flight_s < SHORTEST_FLIGHT_S);
    let is_once = truth.relands == 0 && !truth.first_down_at_slap;
    let is_between = match wish.flight {
        BetweenImpacts::LandsAgain => truth.relands > 0,
        BetweenImpacts::Short => is_once && is_short,
        BetweenImpacts::Free => is_once && !is_short,
    };
    let is_struck = truth.speed.is_some() && truth.k.is_some_and(|k| (K_RANGE.0..=K_RANGE.1).contains(&k));
    is_struck && is_between
}

/// One attempt: the true scene and the cask file, both still without channels.
fn drop(chance: &mut Chance, angle_deg: f64, wish: &Wish, exact: bool) -> (Scene, CaskFile) {
    let mut defaults = vec!["drop.gravity_m_s2".to_owned()];
    let stated = cask(chance, &mut defaults);
    let tolerances = Tolerances::with_defaults(&defaults, stated.length_m);
    let stated_drop = falls(chance, angle_deg, wish);
    let (drawn, is_said) = contact(chance);
    let stated_contact = wish.contact.unwrap_or(if is_said { drawn } else { Contact::Unknown });
    if stated_contact == Contact::Unknown {
        defaults.push("contact.friction".to_owned());
    }
    let off = if exact { 0.0 } else { 1.0 };
    let cask = Cask {
        length_m: stated.length_m * (1.0 + off * chance.vary(tolerances.length)),
        height_m: stated.height_m * (1.0 + off * chance.vary(tolerances.height)),
        cog_m: stated.cog_m + off * chance.vary(tolerances.cog_m),
        inertia_kg_m2: stated.inertia_kg_m2 * (1.0 + off * chance.vary(tolerances.inertia)),
        ..stated.clone()
    };
    let v0_m_s = stated_drop.impact_velocity_m_s * (1.0 + off * chance.vary(tolerances.impact_velocity));
    let angle_rad = stated_drop.angle_rad + off * chance.vary(tolerances.angle_rad);
    let angular_velocity_rad_s = off * chance.vary(tolerances.angular_velocity_rad_s);
    let a_m = first_arm_m(cask.cog_m, cask.height_m, angle_rad);
    let drop = Drop {
        // The height gives this speed, so that the fall has the correct duration.
        height_m: v0_m_s * v0_m_s / (2.0 * GRAVITY_M_S2),
        impact_velocity_m_s: v0_m_s - angular_velocity_rad_s * a_m,
        angle_rad: angle_rad.max(0.5_f64.to_radians()),
        angular_velocity_rad_s,
        horizontal_velocity_m_s: off * chance.vary(tolerances.horizontal_velocity_m_s),
        ..stated_drop
    };
    let impacts = impacts(chance, &stated, drop.impact_velocity_m_s);
    let elastic = chance.flip(0.5).then(|| elastic_body(chance));
    let (share, friction) = (off * chance.vary(tolerances.friction), chance.uniform(LEAST_FRICTION, 1.0));
    let mut scene = Scene {
        seed: chance.seed(),
        modes: if elastic.is_some() { Vec::new() } else { modes(chance) },
        elastic,
        after_s: chance.uniform(0.02, 0.15),
        // Quartz oscillators keep some 1e-5.
        clock_error: off * chance.normal() * 2e-5,
        ..scene(cask, drop, stated_contact, impacts)
    };
    let mut stated = cask_file(stated, stated_drop, stated_contact, defaults);
    wish.fulfil(&mut scene, &mut stated, chance);
    if wish.contact.is_none() && share != 0.0 {
        let held = Scene { contact: Contact::Rough, elastic: None, ..scene.clone() };
        // I_x / I_z of the first contact.
        let (along, up) = synth::simulate_one_flight(&held).first_impulse_n_s();
        let holds = if up > 0.0 { along / up } else { 0.0 };
        scene.contact = match stated_contact {
            Contact::Unknown => Contact::Coulomb(friction),
            stated => vary_friction(stated, holds, share),
        };
    }
    (scene, stated)
}

/// Changes the friction of the contact by a share; for rough and smooth contacts by a share of the friction
/// for sticking, `holds`.
fn vary_friction(contact: Contact, holds: f64, share: f64) -> Contact {
    // A smooth contact cannot become smoother.
    match contact {
        Contact::Coulomb(mu) => Contact::Coulomb(mu * (1.0 + share)),
        Contact::Smooth if holds > 0.0 => Contact::Coulomb(holds * share.abs()),
        Contact::Rough if holds > 0.0 => Contact::Coulomb(holds * (1.0 + share)),
        contact => contact,
    }
}

/// Draws one of the known casks, or, six times in ten, any cask within the envelope; one file in four omits
/// its centre of gravity, one in four its inertia.
fn cask(chance: &mut Chance, defaults: &mut Vec<String>) -> Cask {
    let mut build = chance.choose(&BUILDS);
    if chance.flip(0.6) {
        let length_m = round(chance.log_uniform(envelope::LENGTH_M), 3);
        let section_m = round_to_three_digits(length_m / chance.log_uniform(envelope::SLENDERNESS));
        let mass_kg = length_m * section_m * section_m * chance.log_uniform(envelope::DENSITY_KG_M3);
        build = Build { name: DRAWN, mass_kg: round_to_three_digits(mass_kg), length_m, section_m };
    }
    let mut cask = build.cask();
    if chance.flip(0.75) {
        cask.cog_m = round(cask.length_m * chance.uniform(0.45, 0.55), 3);
    } else {
        defaults.push("cask.cog_m".to_owned());
    }
    if chance.flip(0.75) {
        cask.inertia_kg_m2 = round_to_three_digits(cask.inertia_kg_m2 * chance.uniform(0.85, 1.15));
    } else {
        defaults.push("cask.inertia_kg_m2".to_owned());
    }
    cask
}

/// The fall as stated: from 9 m mostly.
fn falls(chance: &mut Chance, angle_deg: f64, wish: &Wish) -> Drop {
    // L touches again if it is thrown up little and R has a long way to fall.
    let usual = if wish.flight == BetweenImpacts::LandsAgain { 0.2 } else { 0.7 };
    let height_m = if chance.flip(usual) { 9.0 } else { round(chance.log_uniform([0.3, 12.0]), 2) };
    Drop::from_height(height_m, angle_deg.to_radians())
}

/// Draws the contact of L, and if the cask file states it: four times in ten it does not.
fn contact(chance: &mut Chance) -> (Contact, bool) {
    let part = chance.uniform(0.0, 1.0);
    let contact = match part {
        part if part < 0.8 => Contact::Rough,
        part if part < 0.87 => Contact::Smooth,
        _ => Contact::Coulomb(round(chance.uniform(0.1, 0.9), 2)),
    };
    (contact, !(0.4..0.8).contains(&part))
}

/// Draws the impact of each end independently; no end crushes further than its section allows.
fn impacts(chance: &mut Chance, cask: &Cask, impact_velocity_m_s: f64) -> [WantedImpact; 2] {
    // R strikes half as fast again, about.
    [1.0, 1.5].map(|faster| {
        let restitution = chance.log_uniform(envelope::RESTITUTION);
        // An elastic end of v0 and T is crushed by v0 T · 2/(π (1 + k)).
        let most_m = LARGEST_CRUSH * cask.height_m;
        let longest_s = most_m * FRAC_PI_2 * (1.0 + restitution) / (faster * impact_velocity_m_s);
        WantedImpact {
            duration_s: longest_s.min(1e-3 * chance.log_uniform(envelope::PULSE_MS)),
            restitution,
            yield_share: chance.flip(1.0 / 3.0).then(|| chance.log_uniform(envelope::PLATEAU)),
        }
    })
}

fn elastic_body(chance: &mut Chance) -> ElasticBody {
    let first_bending_hz = chance.log_uniform(envelope::FIRST_BENDING_HZ);
    ElasticBody { first_bending_hz, damping: chance.log_uniform(envelope::DAMPING) }
}

/// Draws one to three bending modes of 30 to 400 Hz.
fn modes(chance: &mut Chance) -> Vec<BendingMode> {
    let first_hz = chance.log_uniform([30.0, 160.0]);
    let strength = if chance.flip(0.5) { chance.uniform(0.2, 1.0) } else { 1.0 };
    let most = chance.choose(&[1, 1, 1, 2, 2, 3]);
    let mode = |(order, overtone): (u8, f64)| BendingMode {
        order,
        frequency_hz: first_hz * overtone * if order == 1 { 1.0 } else { chance.uniform(0.8, 1.1) },
        damping: chance.uniform(0.01, 0.06),
        strength,
    };
    (1..).zip(OVERTONES).take(most).map(mode).take_while(|mode| mode.frequency_hz <= 400.0).collect()
}
