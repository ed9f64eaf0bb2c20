//! A simulated drop with its cask file and its recording, from a cask with its fall and sensors, or from a
//! few numbers.

use super::chance::Chance;
use super::data::{
    BendingMode, Chain, ElasticBody, Scene, SceneChannel, SimulatedMotion, SyntheticRecording, WantedImpact,
};
use super::{in_memory, synth};
use crate::analysis::measure;
use crate::data::{
    Analysis, Cask, CaskFile, ChannelSpec, Contact, Drop, End, Recording, STANDARD_GRAVITY_M_S2, Tolerances,
    Unit,
};
use crate::numerics::reduce;
use std::path::PathBuf;

pub(super) const GRAVITY_M_S2: f64 = 9.81;

/// Least friction between two bodies without grease.
pub(super) const LEAST_FRICTION: f64 = 0.1;

/// A cask as a block of its length and section.
#[derive(Debug, Clone, Copy)]
pub(super) struct Build {
    pub name: &'static str,
    pub mass_kg: f64,
    pub length_m: f64,
    pub section_m: f64,
}

/// A slender beam and casks of \[P\] Table 3.
pub(super) const ESBB: Build = Build { name: "ESBB", mass_kg: 315.0, length_m: 4.538, section_m: 0.15 };
pub(super) const ANF_10: Build = Build { name: "ANF-10", mass_kg: 1429.0, length_m: 4.725, section_m: 0.565 };
pub(super) const ANF_18: Build = Build { name: "ANF-18", mass_kg: 4466.0, length_m: 5.512, section_m: 0.792 };
pub(super) const VHLW: Build = Build { name: "VHLW", mass_kg: 20_950.0, length_m: 4.486, section_m: 1.156 };
pub(super) const BUILDS: [Build; 4] = [ESBB, ANF_10, ANF_18, VHLW];

/// Name of a cask outside this list.
pub(super) const DRAWN: &str = "drawn";

impl Build {
    /// The cask with its centre of gravity in the middle and a block's inertia.
    pub(super) fn cask(self) -> Cask {
        Cask::block(self.name, self.mass_kg, self.length_m, self.section_m)
    }
}

/// A scene of a dropped cask with these impacts of its ends, the first at t = 0; nothing rings, and there are
/// no channels yet.
pub(super) fn scene(cask: Cask, drop: Drop, contact: Contact, impacts: [WantedImpact; 2]) -> Scene {
    let end = |end, impact| synth::crushable_end(&cask, &drop, contact, end, impact);
    Scene {
        name: cask.name.clone(),
        seed: 1,
        first_end: end(End::First, impacts[0]),
        second_end: end(End::Second, impacts[1]),
        before_s: 0.1,
        after_s: 0.05,
        cask,
        drop,
        contact,
        ..Scene::default()
    }
}

/// Makes a cask file for a drop, with the usual tolerances and still without channels; `defaults` are the
/// keys that it omits.
pub(super) fn cask_file(cask: Cask, drop: Drop, contact: Contact, defaults: Vec<String>) -> CaskFile {
    CaskFile {
        path: PathBuf::from("synthetic.toml"),
        tolerances: Tolerances::with_defaults(&defaults, cask.length_m),
        defaults,
        ..CaskFile::new(cask, drop, contact)
    }
}

/// Specification of a channel in a true cask file.
pub(super) fn spec(channel: &SceneChannel) -> ChannelSpec {
    ChannelSpec {
        axis: channel.axis,
        unit: Some(if channel.unit == "g" { Unit::G } else { Unit::MetrePerSecondSquared }),
        offset_m: channel.offset_m,
        lateral_m: channel.lateral_m,
        ..ChannelSpec::new(&channel.name, channel.end, &channel.name, channel.position_m)
    }
}

/// m/s² per unit of the recording.
pub(super) fn unit_m_s2(unit: &str) -> f64 {
    if unit == "g" { STANDARD_GRAVITY_M_S2 } else { 1.0 }
}

/// A drop before it is recorded: the true scene, the cask file, the motion, and its random numbers.
pub(super) struct DrawnDrop {
    pub scene: Scene,
    pub stated: CaskFile,
    pub motion: SimulatedMotion,
    pub chance: Chance,
}

impl DrawnDrop {
    /// Length of the first contact, s.
    pub(super) fn contact_s(&self) -> f64 {
        self.motion.truth.contact_s.unwrap_or(0.0)
    }

    /// Time from first contact to the slap-down, s.
    pub(super) fn contact_to_strike_s(&self) -> f64 {
        self.motion.truth.slap_t.unwrap_or(0.0)
    }

    /// Largest force of the drop at channel `i`, with the channel's scale, m/s².
    pub(super) fn peak_m_s2(&self, i: usize) -> f64 {
        let channel = &self.scene.channels[i];
        let times_s: Vec<f64> = self.motion.steps.iter().map(|step| step.time_s).collect();
        let force = synth::specific_force_m_s2(&self.scene, &self.motion, channel, &times_s);
        channel.chain.scale * reduce::peak(&force)
    }

    /// Recording as the recorder writes it.
    pub(super) fn record(&self) -> SyntheticRecording {
        synth::record(&self.scene, &self.motion)
    }

    /// Reads the recording; `None` if the reader refuses it.
    pub(super) fn read(&self, recording: &SyntheticRecording) -> Option<Recording> {
        in_memory::synthetic(recording, &self.stated).ok()
    }

    /// Analyses the recording; `None` if the reader refuses it.
    pub(super) fn analyze(&self, recording: &SyntheticRecording) -> Option<Analysis> {
        Some(measure(&self.read(recording)?, &self.stated))
    }
}

/// Plan of a drop for a trial.
#[derive(Debug, Clone)]
pub(super) struct DropPlan {
    pub build: Build,
    pub angle_deg: f64,
    /// Requested impact of each end.
    pub ends: [WantedImpact; 2],
    pub contact: Contact,
    pub modes: Vec<BendingMode>,
    /// The body if it is elastic: then no mode is listed.
    pub elastic: Option<ElasticBody>,
    pub rate_hz: f64,
    /// Chain of both transverse channels.
    pub chain: Chain,
    pub before_s: f64,
    pub seed: u64,
}

impl DropPlan {
    /// A sound recording of a 9 m drop: 20 kHz, 0.1 g of noise, no ringing, 5 ms of contact.
    pub(super) fn new(build: Build, angle_deg: f64, k: f64, seed: u64) -> Self {
        Self {
            build,
            angle_deg,
            ends: [(5e-3, k), (4e-3, 0.3)].map(|(duration_s, restitution)| WantedImpact {
                duration_s,
                restitution,
                yield_share: None,
            }),
            contact: Contact::Rough,
            modes: Vec::new(),
            elastic: None,
            rate_hz: 2e4,
            chain: Chain { white_noise_m_s2: 0.1 * STANDARD_GRAVITY_M_S2, ..Chain::perfect() },
            before_s: 0.1,
            seed,
        }
    }

    /// A mode as strong as the uniform beam's.
    pub(super) fn mode(order: u8, frequency_hz: f64) -> BendingMode {
        BendingMode { order, frequency_hz, damping: 0.03, strength: 1.0 }
    }

    /// Length of the flight, s.
    pub(super) fn flight_s(&self) -> f64 {
        self.draw().motion.truth.flight_s.unwrap_or(0.0)
    }

    /// The drop, simulated.
    pub(super) fn draw(&self) -> DrawnDrop {
        self.draw_with(|_, _, _| {})
    }

    /// Simulates the drop after `change` has modified its scene and cask file.
    pub(super) fn draw_with(&self, change: impl FnOnce(&mut Scene, &mut CaskFile, &mut Chance)) -> DrawnDrop {
        let drop = Drop::from_height(9.0, self.angle_deg.to_radians());
        let mut scene = Scene {
            seed: self.seed,
            modes: self.modes.clone(),
            elastic: self.elastic,
            before_s: self.before_s,
            channels: [End::First, End::Second].map(|end| self.channel(end)).into(),
            ..scene(self.build.cask(), drop, self.contact, self.ends)
        };
        let mut stated = cask_file(scene.cask.clone(), drop, self.contact, Vec::new());
        let mut chance = Chance::new(self.seed, 0);
        change(&mut scene, &mut stated, &mut chance);
        stated.channels = scene.channels.iter().map(spec).collect();
        DrawnDrop { motion: synth::simulate(&scene), scene, stated, chance }
    }

    /// The transverse channel 0.15 m from an end.
    fn channel(&self, end: End) -> SceneChannel {
        let (name, position_m) = match end {
            End::First => ("A1", 0.15),
            End::Second => ("A2", self.build.length_m - 0.15),
        };
        SceneChannel {
            unit: "m/s^2".to_owned(),
            sample_rate_hz: self.rate_hz,
            chain: self.chain.clone(),
            ..SceneChannel::perfect(name, end, position_m)
        }
    }
}
