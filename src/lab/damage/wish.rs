//! Requirements of a damage on its drop, from words in the table, and the scene of a kind of drop: cask,
//! contents, ends, fall, and their statements.

use super::super::chance::Chance;
use super::super::data::{LooseMass, Scene, SceneChannel, slow_down};
use super::super::drawn::{LEAST_FRICTION, cask_file};
use super::super::synth;
use crate::data::{Axis, Cask, CaskFile, Contact};

/// Motion between the two impacts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in super::super) enum BetweenImpacts {
    /// L flies until R strikes.
    #[default]
    Free,
    /// L touches again before.
    LandsAgain,
    /// A free flight too short for any undamaged drop.
    Short,
}

/// Requirements of a damage on its drop; by default none, as for an undamaged drop.
#[derive(Debug, Clone, Copy, Default)]
pub(in super::super) struct Wish {
    /// Motion between the impacts.
    pub flight: BetweenImpacts,
    /// The true contact of L, if the kind does not change it.
    pub contact: Option<Contact>,
    /// True if there is an axial channel; `None` leaves it to chance.
    pub axial: Option<bool>,
    /// True if the rest before the release is recorded; `None` leaves it to chance.
    pub rest: Option<bool>,
    /// Two transverse channels on the first end.
    pub third_channel: bool,
    /// Kind of damage, and its size; empty for an undamaged drop.
    pub kind: &'static str,
    /// See `kind`.
    pub size: f64,
}

impl Wish {
    /// Reads words such as "friction no_axial", for a damage of this size.
    pub(super) fn parse(words: &str, size: f64) -> Self {
        let has = |word: &str| words.split(' ').any(|one| one == word);
        let either = |yes: &str, no: &str| has(yes).then_some(true).or(has(no).then_some(false));
        let flights = [("lands_again", BetweenImpacts::LandsAgain), ("short_flight", BetweenImpacts::Short)];
        let contacts = [
            ("friction", Contact::Coulomb(size)),
            ("stated_rough", Contact::Rough),
            ("unstated", Contact::Unknown),
        ];
        Self {
            flight: flights.iter().find(|(word, _)| has(word)).map(|(_, flight)| *flight).unwrap_or_default(),
            contact: contacts.iter().find(|(word, _)| has(word)).map(|(_, contact)| *contact),
            axial: either("axial", "no_axial"),
            rest: either("rest", "no_rest"),
            third_channel: has("third_channel"),
            ..Self::default()
        }
    }
    /// A sound drop as the damage needs it.
    pub(super) fn equip(&self, scene: &mut Scene, stated: &mut CaskFile, chance: &mut Chance) {
        if self.rest == Some(true) {
            (scene.rest, scene.before_s) = (true, scene.fall_s() + 0.2);
        }
        let first = scene.channels[0].clone();
        let beside = |name: &str, axis| SceneChannel {
            name: name.to_owned(),
            axis,
            position_m: 3.0 * first.position_m,
            ..first.clone()
        };
        scene.channels.extend(self.third_channel.then(|| beside("A3", Axis::Transverse)));
        scene.channels.extend((self.axial == Some(true)).then(|| beside("A5", Axis::Axial)));
        if scene.contact == Contact::Unknown {
            let defaults = vec!["contact.friction".to_owned()];
            *stated = cask_file(scene.cask.clone(), scene.drop, scene.contact, defaults);
        }
        self.fulfil(scene, stated, chance);
    }

    /// Makes a scene and its cask file, both still without channels, fit the kind; kinds that belong to
    /// another object have no effect.
    pub(in super::super) fn fulfil(&self, scene: &mut Scene, stated: &mut CaskFile, chance: &mut Chance) {
        let Self { kind, size, .. } = *self;
        match kind {
            "turning" | "turning_unstated" => {
                let more_rad_s = chance.sign() * size.to_radians();
                scene.drop = scene.drop.add_rotation(&scene.cask, more_rad_s);
                if kind == "turning" {
                    stated.drop = stated.drop.add_rotation(&stated.cask, more_rad_s);
                }
            }
            "swinging" | "swinging_unstated" => {
                let more_m_s = chance.sign() * size;
                scene.drop.horizontal_velocity_m_s += more_m_s;
                if kind == "swinging" {
                    stated.drop.horizontal_velocity_m_s = more_m_s;
                }
            }
            "guided" | "guided_seen" | "guided_rest" => {
                scene.extras.guided = size / 100.0;
                scene.drop = slow_down(scene.drop, scene.extras.guided);
            }
            "contents" | "contents_light" => scene.extras.contents = contents(size, &scene.cask, chance),
            "lock_up" => lock_up(size, scene),
            "footprint" | "footprint_wide" => scene.first_end.footprint = size,
            "friction_falls" | "rough_falls" => {
                scene.contact = Contact::Coulomb(size);
                let fast = (size * chance.uniform(0.3, 0.8)).max(LEAST_FRICTION);
                scene.extras.falling_friction = Some((fast, chance.log_uniform([0.3, 3.0])));
            }
            "friction_changes" | "rough_changes" => {
                scene.contact = Contact::Coulomb(size);
                scene.extras.returning_friction = Some((size * chance.uniform(0.3, 1.5)).max(LEAST_FRICTION));
            }
            _ => {}
        }
    }
}

/// Adds a body of `size` percent of the cask's mass, which rattles at both its ends with a play of 2 to 60
/// mm.
fn contents(size: f64, cask: &Cask, chance: &mut Chance) -> Vec<LooseMass> {
    let play_m = chance.log_uniform([2e-3, 60e-3]);
    let pulse_s = chance.uniform(1e-3, 3e-3);
    let loose = |(nearest, farthest)| LooseMass {
        mass_kg: size / 200.0 * cask.mass_kg,
        position_m: chance.uniform(nearest, farthest) * cask.length_m,
        gap_m: chance.uniform(0.0, play_m),
        play_m,
        pulse_s,
        damping_s_m: chance.uniform(0.05, 0.4),
    };
    [(0.15, 0.4), (0.6, 0.85)].map(loose).into()
}

/// Makes a limiter yield at half of its elastic peak and lock up at `size` percent of its crush, four times
/// as stiff.
fn lock_up(size: f64, scene: &mut Scene) {
    scene.first_end.yield_n = None;
    let peak_n = synth::simulate(scene).steps.iter().map(|step| step.loads_n[0].1).fold(0.0, f64::max);
    let loading_n_m = scene.first_end.loading_n_m;
    scene.first_end.yield_n = Some(0.5 * peak_n);
    // The work F²/2 K of the elastic end equals that of half the force over (2 + 1/2) F/2 K.
    let crush_m = 1.25 * peak_n / loading_n_m;
    scene.first_end.lock_up = Some((size / 100.0 * crush_m, 4.0 * loading_n_m));
}
