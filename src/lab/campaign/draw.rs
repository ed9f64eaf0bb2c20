//! Random numbers to a drop: the cask, how it falls and what its ends do, as they are and as they are stated.

use crate::data::planar::first_arm_m;
use crate::data::{Cask, CaskFile, Contact, Drop, Tolerances};
use crate::lab::chance::{Chance, round, three_digits};
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

/// A drop counts where it has a slap-down of this kind: k within, flight at least, s.
const K_RANGE: (f64, f64) = (0.02, 0.98);
const SHORTEST_FLIGHT_S: f64 = 8e-3;

/// The angle is drawn again only after so many attempts with it: else the flat drops would be the ones left
/// out.
const ATTEMPTS: u32 = 300;

/// Draws until there is a drop as wished.
pub(super) fn drawn(mut chance: Chance, wish: &Wish, exact: bool) -> DrawnDrop {
    let mut angle_deg = stated_angle_deg(&mut chance, wish);
    let mut attempt = 0_u32;
    loop {
        attempt += 1;
        let (scene, stated) = drop(&mut chance, angle_deg, wish, exact);
        let motion = match wish.flight {
            BetweenImpacts::LandsAgain => synth::simulate(&scene),
            _ => synth::simulate_one_flight(&scene),
        };
        if is_as_wished(&motion.truth, wish) {
            return DrawnDrop { scene, stated, motion, chance };
        }
        if wish.flight != BetweenImpacts::Free || attempt.is_multiple_of(ATTEMPTS) {
            angle_deg = stated_angle_deg(&mut chance, wish);
        }
    }
}

/// 5 to 30° mostly; R strikes soon where it is not far from the target.
fn stated_angle_deg(chance: &mut Chance, wish: &Wish) -> f64 {
    if wish.flight == BetweenImpacts::Short {
        return round(chance.even(2.0, 8.0), 1);
    }
    round(if chance.is(0.8) { chance.even(5.0, 30.0) } else { chance.even(2.0, 60.0) }, 1)
}

/// Whether the drop is one that the campaign takes.
fn is_as_wished(truth: &Truth, wish: &Wish) -> bool {
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

/// One attempt: the scene as it is and the cask file, both still without channels.
fn drop(chance: &mut Chance, angle_deg: f64, wish: &Wish, exact: bool) -> (Scene, CaskFile) {
    let mut defaults = vec!["drop.gravity_m_s2".to_owned()];
    let stated = cask(chance, &mut defaults);
    let tolerances = Tolerances::of(&defaults, stated.length_m);
    let stated_drop = falls(chance, angle_deg, wish);
    let (drawn, is_said) = contact(chance);
    let stated_contact = wish.contact.unwrap_or(if is_said { drawn } else { Contact::Unknown });
    if stated_contact == Contact::Unknown {
        defaults.push("contact.friction".to_owned());
    }
    let off = if exact { 0.0 } else { 1.0 };
    let cask = Cask {
        length_m: stated.length_m * (1.0 + off * chance.within(tolerances.length)),
        height_m: stated.height_m * (1.0 + off * chance.within(tolerances.height)),
        cog_m: stated.cog_m + off * chance.within(tolerances.cog_m),
        inertia_kg_m2: stated.inertia_kg_m2 * (1.0 + off * chance.within(tolerances.inertia)),
        ..stated.clone()
    };
    let v0_m_s = stated_drop.impact_velocity_m_s * (1.0 + off * chance.within(tolerances.impact_velocity));
    let angle_rad = stated_drop.angle_rad + off * chance.within(tolerances.angle_rad);
    let angular_velocity_rad_s = off * chance.within(tolerances.angular_velocity_rad_s);
    let a_m = first_arm_m(cask.cog_m, cask.height_m, angle_rad);
    let drop = Drop {
        // The height that gives this speed, so that the fall lasts as long as it should.
        height_m: v0_m_s * v0_m_s / (2.0 * GRAVITY_M_S2),
        impact_velocity_m_s: v0_m_s - angular_velocity_rad_s * a_m,
        angle_rad: angle_rad.max(0.5_f64.to_radians()),
        angular_velocity_rad_s,
        horizontal_velocity_m_s: off * chance.within(tolerances.horizontal_velocity_m_s),
        ..stated_drop
    };
    let impacts = impacts(chance, &stated, drop.impact_velocity_m_s);
    let elastic = chance.is(0.5).then(|| elastic_body(chance));
    let (share, friction) = (off * chance.within(tolerances.friction), chance.even(LEAST_FRICTION, 1.0));
    let mut scene = Scene {
        seed: chance.seed(),
        modes: if elastic.is_some() { Vec::new() } else { modes(chance) },
        elastic,
        after_s: chance.even(0.02, 0.15),
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
            stated => loosened(stated, holds, share),
        };
    }
    (scene, stated)
}

/// The contact with its friction off by a share of it; of rough and smooth ones by a share of what sticking
/// takes, `holds`.
fn loosened(contact: Contact, holds: f64, share: f64) -> Contact {
    // Nothing is smoother than smooth.
    match contact {
        Contact::Coulomb(mu) => Contact::Coulomb(mu * (1.0 + share)),
        Contact::Smooth if holds > 0.0 => Contact::Coulomb(holds * share.abs()),
        Contact::Rough if holds > 0.0 => Contact::Coulomb(holds * (1.0 + share)),
        contact => contact,
    }
}

/// One of the casks, or, six times in ten, any within the envelope; one in four leaves out its centre of
/// gravity, one in four its inertia.
fn cask(chance: &mut Chance, defaults: &mut Vec<String>) -> Cask {
    let mut build = chance.one_of(&BUILDS);
    if chance.is(0.6) {
        let length_m = round(chance.log_even(envelope::LENGTH_M), 3);
        let section_m = three_digits(length_m / chance.log_even(envelope::SLENDERNESS));
        let mass_kg = length_m * section_m * section_m * chance.log_even(envelope::DENSITY_KG_M3);
        build = Build { name: DRAWN, mass_kg: three_digits(mass_kg), length_m, section_m };
    }
    let mut cask = build.cask();
    if chance.is(0.75) {
        cask.cog_m = round(cask.length_m * chance.even(0.45, 0.55), 3);
    } else {
        defaults.push("cask.cog_m".to_owned());
    }
    if chance.is(0.75) {
        cask.inertia_kg_m2 = three_digits(cask.inertia_kg_m2 * chance.even(0.85, 1.15));
    } else {
        defaults.push("cask.inertia_kg_m2".to_owned());
    }
    cask
}

/// The fall as stated: from 9 m mostly.
fn falls(chance: &mut Chance, angle_deg: f64, wish: &Wish) -> Drop {
    // L lands again where it is thrown up little and R has a long way.
    let usual = if wish.flight == BetweenImpacts::LandsAgain { 0.2 } else { 0.7 };
    let height_m = if chance.is(usual) { 9.0 } else { round(chance.log_even([0.3, 12.0]), 2) };
    Drop::of_height(height_m, angle_deg.to_radians())
}

/// The contact of L, and whether the cask file says it: four times in ten it does not.
fn contact(chance: &mut Chance) -> (Contact, bool) {
    let part = chance.even(0.0, 1.0);
    let contact = match part {
        part if part < 0.8 => Contact::Rough,
        part if part < 0.87 => Contact::Smooth,
        _ => Contact::Coulomb(round(chance.even(0.1, 0.9), 2)),
    };
    (contact, !(0.4..0.8).contains(&part))
}

/// What both ends do, each by itself; none crushes further than its section lets it.
fn impacts(chance: &mut Chance, cask: &Cask, impact_velocity_m_s: f64) -> [WantedImpact; 2] {
    // R strikes half as fast again, about.
    [1.0, 1.5].map(|faster| {
        let restitution = chance.log_even(envelope::RESTITUTION);
        // An elastic end of v0 and T is crushed by v0 T · 2/(π (1 + k)).
        let most_m = LARGEST_CRUSH * cask.height_m;
        let longest_s = most_m * FRAC_PI_2 * (1.0 + restitution) / (faster * impact_velocity_m_s);
        WantedImpact {
            duration_s: longest_s.min(1e-3 * chance.log_even(envelope::PULSE_MS)),
            restitution,
            yield_share: chance.is(1.0 / 3.0).then(|| chance.log_even(envelope::PLATEAU)),
        }
    })
}

fn elastic_body(chance: &mut Chance) -> ElasticBody {
    let first_bending_hz = chance.log_even(envelope::FIRST_BENDING_HZ);
    ElasticBody { first_bending_hz, damping: chance.log_even(envelope::DAMPING) }
}

/// One to three bending modes of 30 to 400 Hz.
fn modes(chance: &mut Chance) -> Vec<BendingMode> {
    let first_hz = chance.log_even([30.0, 160.0]);
    let strength = if chance.is(0.5) { chance.even(0.2, 1.0) } else { 1.0 };
    let most = chance.one_of(&[1, 1, 1, 2, 2, 3]);
    let mode = |(order, overtone): (u8, f64)| BendingMode {
        order,
        frequency_hz: first_hz * overtone * if order == 1 { 1.0 } else { chance.even(0.8, 1.1) },
        damping: chance.even(0.01, 0.06),
        strength,
    };
    (1..).zip(OVERTONES).take(most).map(mode).take_while(|mode| mode.frequency_hz <= 400.0).collect()
}
