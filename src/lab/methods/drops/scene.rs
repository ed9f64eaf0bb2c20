//! A few numbers to a simulated drop, its recording and its cask file.

pub(super) use crate::data::STANDARD_GRAVITY_M_S2;
use crate::data::{
    Axis, Cask, CaskFile, ChannelSpec, Contact, Corrections, Coupling, Drop, End, FilterChoice, Recording,
    Source, Tolerances, Unit,
};
use crate::lab::data::{BendingMode, Chain, Scene, SceneChannel, SimulatedMotion, SyntheticRecording, Truth};
use crate::lab::{in_memory, synth};
use std::path::PathBuf;

const GRAVITY_M_S2: f64 = 9.81;
/// A cask: name, mass kg, length m, section m (\[P\] Table 3).
pub(super) type Build = (&'static str, f64, f64, f64);

pub(super) const ESBB: Build = ("ESBB", 315.0, 4.538, 0.15);
pub(super) const ANF_10: Build = ("ANF-10", 1429.0, 4.725, 0.565);
pub(super) const ANF_18: Build = ("ANF-18", 4466.0, 5.512, 0.792);
pub(super) const VHLW: Build = ("VHLW", 20_950.0, 4.486, 1.156);

/// A drop as a trial speaks of it; what is stated in the cask file is true unless it is named here.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub build: Build,
    pub angle_deg: f64,
    /// Stated angle less the true one, degrees.
    pub angle_error_deg: f64,
    /// Coefficient of restitution of a short impact.
    pub k: f64,
    /// Length of the first contact, s.
    pub pulse_s: f64,
    /// Yield force over the elastic peak.
    pub yield_share: Option<f64>,
    pub contact: Contact,
    pub stated_contact: Contact,
    pub modes: Vec<BendingMode>,
    pub rate_hz: f64,
    /// Chains of the transverse channels on the first and the second end.
    pub chains: [Chain; 2],
    pub before_s: f64,
    /// Record after the slap-down, s.
    pub after_s: f64,
    pub seed: u64,
}

/// A plan, simulated.
pub(super) struct Drawn {
    pub scene: Scene,
    pub stated: CaskFile,
    pub motion: SimulatedMotion,
}

impl Plan {
    /// A sound recording of a 9 m drop: 20 kHz, 0.1 g of noise, no ringing, 5 ms of contact.
    pub(super) fn of(build: Build, angle_deg: f64, k: f64, seed: u64) -> Self {
        let chain = Chain { white_noise_m_s2: 0.1 * STANDARD_GRAVITY_M_S2, ..Chain::perfect() };
        Self {
            build,
            angle_deg,
            angle_error_deg: 0.0,
            k,
            pulse_s: 5e-3,
            yield_share: None,
            contact: Contact::Rough,
            stated_contact: Contact::Rough,
            modes: Vec::new(),
            rate_hz: 2e4,
            chains: [chain.clone(), chain],
            before_s: 0.1,
            after_s: 0.05,
            seed,
        }
    }

    /// Both chains changed alike.
    pub(super) fn each_chain(&mut self, change: impl Fn(&mut Chain)) {
        self.chains.iter_mut().for_each(change);
    }

    /// The scene, how it moves, and what its cask file states.
    pub(super) fn draw(&self) -> Drawn {
        let scene = self.scene();
        let motion = synth::simulate(&scene);
        Drawn { stated: self.stated(&scene), scene, motion }
    }

    /// The cask, with its centre of gravity in the middle and a block's inertia, and its fall.
    pub(super) fn cask_and_drop(&self) -> (Cask, Drop) {
        let (name, mass_kg, length_m, height_m) = self.build;
        let cask = Cask {
            name: name.to_owned(),
            mass_kg,
            length_m,
            height_m,
            width_m: None,
            cog_m: length_m / 2.0,
            inertia_kg_m2: mass_kg * (length_m * length_m + height_m * height_m) / 12.0,
            is_body: true,
        };
        let drop = Drop {
            height_m: 9.0,
            angle_rad: self.angle_deg.to_radians(),
            impact_velocity_m_s: (2.0 * GRAVITY_M_S2 * 9.0).sqrt(),
            impact_velocity_given: false,
            gravity_m_s2: GRAVITY_M_S2,
        };
        (cask, drop)
    }

    fn scene(&self) -> Scene {
        let (cask, drop) = self.cask_and_drop();
        let (name, length_m) = (self.build.0, cask.length_m);
        let end = |end, duration_s, restitution| {
            let pulse = synth::Pulse { duration_s, restitution, yield_share: self.yield_share };
            synth::crushable_end(&cask, &drop, self.contact, end, pulse)
        };
        Scene {
            name: name.to_owned(),
            seed: self.seed,
            first_end: end(End::First, self.pulse_s, self.k),
            second_end: end(End::Second, 4e-3, 0.3),
            contact: self.contact,
            modes: self.modes.clone(),
            before_s: self.before_s,
            after_s: self.after_s,
            rest: false,
            clock_error: 0.0,
            swapped_ends: false,
            channels: vec![self.channel(End::First, length_m), self.channel(End::Second, length_m)],
            cask,
            drop,
        }
    }

    /// The transverse channel 0.15 m from an end.
    fn channel(&self, end: End, length_m: f64) -> SceneChannel {
        let (name, position_m, chain) = match end {
            End::First => ("A1", 0.15, &self.chains[0]),
            End::Second => ("A2", length_m - 0.15, &self.chains[1]),
        };
        SceneChannel {
            name: name.to_owned(),
            end,
            axis: Axis::Transverse,
            position_m,
            offset_m: 0.0,
            unit: "m/s^2".to_owned(),
            sample_rate_hz: self.rate_hz,
            chain: chain.clone(),
        }
    }

    fn stated(&self, scene: &Scene) -> CaskFile {
        let channels = scene.channels.iter().map(|channel| ChannelSpec {
            name: channel.name.clone(),
            end: channel.end,
            axis: channel.axis,
            source: Source::Path(channel.name.clone()),
            unit: Some(Unit::MetrePerSecondSquared),
            position_m: channel.position_m,
            offset_m: channel.offset_m,
            polarity: 1.0,
            full_scale: None,
            sample_rate_hz: None,
            time: None,
            coupling: Coupling::Dc,
        });
        CaskFile {
            path: PathBuf::from("synthetic.toml"),
            sha256: String::new(),
            cask: scene.cask.clone(),
            drop: Drop { angle_rad: scene.drop.angle_rad + self.angle_error_deg.to_radians(), ..scene.drop },
            contact: self.stated_contact,
            filter: FilterChoice::Auto,
            tolerances: Tolerances::default(),
            corrections: Corrections::default(),
            time: None,
            channels: channels.collect(),
            defaults: Vec::new(),
        }
    }
}

impl Drawn {
    pub(super) fn truth(&self) -> &Truth {
        &self.motion.truth
    }

    /// What the recorder wrote, and as it is read; none where it is refused.
    pub(super) fn recorded(&self) -> (SyntheticRecording, Option<Recording>) {
        let written = synth::record(&self.scene, &self.motion);
        let read = in_memory::synthetic(&written, &self.stated).ok();
        (written, read)
    }

    /// Largest force on the first channel during the first contact, m/s².
    pub(super) fn first_peak_m_s2(&self) -> f64 {
        let contact_s = self.truth().contact_s.unwrap_or(5e-3);
        let times_s: Vec<f64> = (0..=1000).map(|i| f64::from(i) / 1000.0 * contact_s).collect();
        let force = synth::specific_force_m_s2(&self.scene, &self.motion, &self.scene.channels[0], &times_s);
        force.into_iter().fold(0.0, f64::max)
    }
}
