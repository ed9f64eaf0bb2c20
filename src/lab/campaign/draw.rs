//! Random numbers to a drop: the cask, how it falls and what its ends do, as they are and as they are stated.

use super::Case;
use super::chance::{Chance, round};
use crate::data::{Cask, CaskFile, Contact, Corrections, Drop, End, FilterChoice, Tolerances};
use crate::lab::data::{BendingMode, Scene, SceneNumber, SimulatedMotion, Truth, WantedImpact};
use crate::lab::{crush, synth};
use std::collections::BTreeMap;
use std::path::PathBuf;

const GRAVITY_M_S2: f64 = 9.81;

/// Casks of \[P\] Table 3 and a slender beam: name, mass kg, length m, section m.
const CASKS: [(&str, f64, f64, f64); 4] = [
    ("ESBB", 315.0, 4.538, 0.15),
    ("ANF-10", 1429.0, 4.725, 0.565),
    ("ANF-18", 4466.0, 5.512, 0.792),
    ("VHLW", 20_950.0, 4.486, 1.156),
];

/// Bending frequencies of a free uniform beam over its first.
const OVERTONES: [f64; 3] = [1.0, 2.757, 5.404];

/// A drop counts where it has a slap-down of this kind: k within, flight at least, s.
const K_RANGE: (f64, f64) = (0.02, 0.98);
const SHORTEST_FLIGHT_S: f64 = 8e-3;

/// What happens between the two impacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Flight {
    /// L flies until R strikes.
    Free,
    /// L touches again before.
    LandsAgain,
    /// The same as free, for less than [`SHORTEST_FLIGHT_S`].
    Short,
}

/// What a damage needs of the drop that it strikes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wish {
    /// What happens between the impacts.
    pub flight: Flight,
    /// The contact of L, as it is.
    pub contact: Option<Contact>,
    /// Whether there is an axial channel; `None`: as it comes.
    pub axial: Option<bool>,
    /// Whether the rest before the release is recorded; `None`: as it comes.
    pub rest: Option<bool>,
    /// Two transverse channels on the first end.
    pub third_channel: bool,
    /// Nothing that makes thousands of samples more than the damage needs.
    pub slow_recorder: bool,
}

impl Wish {
    /// Anything.
    pub(super) const fn new() -> Self {
        Self {
            flight: Flight::Free,
            contact: None,
            axial: None,
            rest: None,
            third_channel: false,
            slow_recorder: false,
        }
    }
}

/// The angle is drawn again only after so many attempts with it: else the flat drops would be the ones left out.
const ATTEMPTS: u32 = 300;

/// Draws until there is a drop as wished, and counts the others by what they lack.
pub(super) fn case((seed, number): (u64, SceneNumber), wish: &Wish, exact: bool) -> Case {
    let mut chance = Chance::new(seed, number);
    let mut redraws = BTreeMap::new();
    let mut angle_deg = stated_angle_deg(&mut chance, wish);
    let mut attempt = 0_u32;
    loop {
        attempt += 1;
        let (scene, stated) = drop(&mut chance, angle_deg, wish, exact);
        let motion = synth::simulate(&scene);
        let Some(lack) = lacks(&motion.truth, wish) else {
            return Case { scene, stated, motion, chance, redraws };
        };
        *redraws.entry(lack).or_insert(0) += 1;
        if wish.flight != Flight::Free || attempt.is_multiple_of(ATTEMPTS) {
            angle_deg = stated_angle_deg(&mut chance, wish);
        }
    }
}

/// 5 to 30° mostly; R strikes soon where it is not far from the target.
fn stated_angle_deg(chance: &mut Chance, wish: &Wish) -> f64 {
    if wish.flight == Flight::Short {
        return round(chance.even(2.0, 8.0), 1);
    }
    round(if chance.is(0.8) { chance.even(5.0, 30.0) } else { chance.even(2.0, 60.0) }, 1)
}

/// What keeps a drop out of the campaign.
fn lacks(truth: &Truth, wish: &Wish) -> Option<&'static str> {
    let (Some(k), Some(_)) = (truth.k, truth.speed) else { return Some("no slap-down") };
    if !(K_RANGE.0..=K_RANGE.1).contains(&k) {
        return Some("k outside 0.02 to 0.98");
    }
    if wish.flight == Flight::LandsAgain {
        return (truth.relands == 0).then_some("no second contact");
    }
    if truth.first_down_at_slap {
        return Some("first end down at slap-down");
    }
    if truth.relands > 0 {
        return Some("second contact");
    }
    let is_short = truth.flight_s.is_none_or(|flight_s| flight_s < SHORTEST_FLIGHT_S);
    match (is_short, wish.flight == Flight::Short) {
        (true, false) => Some("flight below 8 ms"),
        (false, true) => Some("flight of 8 ms and more"),
        _ => None,
    }
}

/// One attempt: the scene as it is and the cask file, both still without channels.
fn drop(chance: &mut Chance, angle_deg: f64, wish: &Wish, exact: bool) -> (Scene, CaskFile) {
    let tolerances = Tolerances::default();
    let mut defaults: Vec<String> = ["gravity_m_s2"].map(|key| format!("drop.{key}")).into();
    let stated = cask(chance, &mut defaults);
    let stated_drop = falls(chance, angle_deg, wish);
    let (drawn, is_said) = contact(chance);
    let stated_contact = wish.contact.unwrap_or(drawn);
    if stated_contact == Contact::Rough && !is_said {
        defaults.push("contact.friction".to_owned());
    }
    let off = if exact { 0.0 } else { 1.0 };
    let cask = Cask {
        cog_m: stated.cog_m + off * chance.within(tolerances.cog_m),
        inertia_kg_m2: stated.inertia_kg_m2 * (1.0 + off * chance.within(tolerances.inertia)),
        ..stated.clone()
    };
    let v0_m_s = stated_drop.impact_velocity_m_s * (1.0 + off * chance.within(tolerances.impact_velocity));
    let angle_rad = stated_drop.angle_rad + off * chance.within(tolerances.angle_rad);
    let drop = Drop {
        // The height that gives this speed, so that the fall lasts as long as it should.
        height_m: v0_m_s * v0_m_s / (2.0 * GRAVITY_M_S2),
        impact_velocity_m_s: v0_m_s,
        angle_rad: angle_rad.max(0.5_f64.to_radians()),
        ..stated_drop
    };
    let [first, second] = impacts(chance);
    let share = off * chance.within(tolerances.friction);
    let mut scene = Scene {
        name: cask.name.clone(),
        seed: chance.seed(),
        first_end: crush(&cask, &drop, stated_contact, End::First, first),
        second_end: crush(&cask, &drop, stated_contact, End::Second, second),
        modes: modes(chance),
        before_s: 0.1,
        after_s: chance.even(0.02, 0.15),
        rest: false,
        // Quartz oscillators keep some 1e-5.
        clock_error: off * chance.normal() * 2e-5,
        swapped_ends: false,
        channels: Vec::new(),
        cask,
        drop,
        contact: stated_contact,
    };
    if wish.contact.is_none() && share != 0.0 {
        let held = Scene { contact: Contact::Rough, ..scene.clone() };
        scene.contact = loosened(stated_contact, impulse_ratio(&synth::simulate(&held)), share);
    }
    (scene, cask_file(stated, stated_drop, stated_contact, defaults))
}

/// What the cask file says of a drop, with the usual tolerances.
fn cask_file(cask: Cask, drop: Drop, contact: Contact, defaults: Vec<String>) -> CaskFile {
    CaskFile {
        path: PathBuf::from("synthetic.toml"),
        sha256: String::new(),
        cask,
        drop,
        contact,
        filter: FilterChoice::Auto,
        tolerances: Tolerances::default(),
        corrections: Corrections::default(),
        time: None,
        channels: Vec::new(),
        defaults,
    }
}

/// I_x / I_z of the first contact.
fn impulse_ratio(motion: &SimulatedMotion) -> f64 {
    let end_s = motion.truth.contact_s.unwrap_or(f64::INFINITY);
    let within = motion.time_s.partition_point(|t| *t <= end_s);
    let steps = motion.time_s[..within].windows(2).zip(motion.first_end_n.windows(2));
    let (along, up) = steps.fold((0.0, 0.0), |(along, up), (t, force)| {
        let half_s = (t[1] - t[0]) / 2.0;
        (along + half_s * (force[0].0 + force[1].0), up + half_s * (force[0].1 + force[1].1))
    });
    if up > 0.0 { along / up } else { 0.0 }
}

/// The contact a share of the way from one law to the other: of sticking, which takes a friction of `holds`, towards smooth; of what slides
/// towards sticking.
fn loosened(contact: Contact, holds: f64, share: f64) -> Contact {
    let slides = match contact {
        Contact::Smooth => Some(0.0),
        Contact::Coulomb(mu) if mu < holds => Some(mu),
        _ => None,
    };
    // Nothing is smoother than smooth, and no corner sticks better than it sticks.
    let mu = slides.map_or(holds * (1.0 - share.abs()), |mu| (mu + share * (holds - mu)).abs());
    if holds > 0.0 { Contact::Coulomb(mu) } else { contact }
}

/// One of the casks; four in ten are stretched, one in four states its centre of gravity, one in four its inertia.
fn cask(chance: &mut Chance, defaults: &mut Vec<String>) -> Cask {
    let (name, mut mass_kg, mut length_m, mut height_m) = chance.one_of(&CASKS);
    let mut name = name.to_owned();
    if chance.is(0.4) {
        mass_kg = round(mass_kg * chance.even(0.6, 1.6), 0);
        length_m = round(length_m * chance.even(0.7, 1.3), 3);
        height_m = round(height_m * chance.even(0.5, 1.2), 3);
        name.push_str("-var");
    }
    let mut cog_m = length_m / 2.0;
    if chance.is(0.25) {
        cog_m = round(length_m * chance.even(0.45, 0.55), 3);
    } else {
        defaults.push("cask.cog_m".to_owned());
    }
    let mut inertia_kg_m2 = mass_kg * (length_m * length_m + height_m * height_m) / 12.0;
    if chance.is(0.25) {
        inertia_kg_m2 = round(inertia_kg_m2 * chance.even(0.85, 1.15), 0);
    } else {
        defaults.push("cask.inertia_kg_m2".to_owned());
    }
    Cask { name, mass_kg, length_m, height_m, width_m: None, cog_m, inertia_kg_m2, is_body: true }
}

/// The fall as stated: from 9 m mostly.
fn falls(chance: &mut Chance, angle_deg: f64, wish: &Wish) -> Drop {
    // L lands again where it is thrown up little and R has a long way.
    let usual = if wish.flight == Flight::LandsAgain { 0.2 } else { 0.7 };
    let height_m = if chance.is(usual) { 9.0 } else { round(chance.log_even(0.3, 12.0), 2) };
    Drop {
        height_m,
        angle_rad: angle_deg.to_radians(),
        impact_velocity_m_s: (2.0 * GRAVITY_M_S2 * height_m).sqrt(),
        impact_velocity_given: false,
        gravity_m_s2: GRAVITY_M_S2,
    }
}

/// The contact of L, and whether the cask file says it where it is the default.
fn contact(chance: &mut Chance) -> (Contact, bool) {
    let part = chance.even(0.0, 1.0);
    let contact = match part {
        part if part < 0.8 => Contact::Rough,
        part if part < 0.87 => Contact::Smooth,
        _ => Contact::Coulomb(round(chance.even(0.1, 0.9), 2)),
    };
    (contact, part < 0.4)
}

/// What both ends do: pulses of 1 to 20 ms, one in four of the first with a force plateau.
fn impacts(chance: &mut Chance) -> [WantedImpact; 2] {
    let duration_s = chance.log_even(1e-3, 20e-3);
    let first = WantedImpact {
        duration_s,
        restitution: chance.even(K_RANGE.0, K_RANGE.1),
        yield_share: if chance.is(0.25) { Some(chance.even(0.6, 0.95)) } else { None },
    };
    let second = WantedImpact {
        duration_s: duration_s * chance.even(0.5, 1.5),
        restitution: chance.even(0.05, 0.7),
        yield_share: None,
    };
    [first, second]
}

/// One to three bending modes of 30 to 400 Hz.
fn modes(chance: &mut Chance) -> Vec<BendingMode> {
    let part = chance.even(0.0, 1.0);
    let first_hz = chance.log_even(30.0, 160.0);
    let strength = if chance.is(0.5) { chance.even(0.2, 1.0) } else { 1.0 };
    let mut modes = Vec::new();
    for (order, overtone) in (1..).zip(OVERTONES).take(if part < 0.5 {
        1
    } else if part < 0.82 {
        2
    } else {
        3
    }) {
        let frequency_hz = first_hz * overtone * if order == 1 { 1.0 } else { chance.even(0.8, 1.1) };
        if frequency_hz > 400.0 {
            break;
        }
        modes.push(BendingMode { order, frequency_hz, damping: chance.even(0.01, 0.06), strength });
    }
    modes
}
