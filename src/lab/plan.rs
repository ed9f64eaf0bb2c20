//! A few numbers to a simulated drop and its cask file, all of it true.

use super::chance::Chance;
use super::data::{BendingMode, Chain, Scene, SceneChannel, WantedImpact};
use super::drawn::{Build, DrawnDrop, cask_file, scene, spec};
use super::synth;
use crate::data::{CaskFile, Contact, Drop, End, STANDARD_GRAVITY_M_S2};

/// A drop as a trial speaks of it.
#[derive(Debug, Clone)]
pub(super) struct DropPlan {
    pub build: Build,
    pub angle_deg: f64,
    /// Coefficient of restitution of a short impact.
    pub k: f64,
    /// Length of the first contact, s.
    pub pulse_s: f64,
    /// Yield force over the elastic peak.
    pub yield_share: Option<f64>,
    pub contact: Contact,
    pub modes: Vec<BendingMode>,
    pub rate_hz: f64,
    /// Chain of both transverse channels.
    pub chain: Chain,
    pub before_s: f64,
    pub seed: u64,
}

impl DropPlan {
    /// A sound recording of a 9 m drop: 20 kHz, 0.1 g of noise, no ringing, 5 ms of contact.
    pub(super) fn of(build: Build, angle_deg: f64, k: f64, seed: u64) -> Self {
        Self {
            build,
            angle_deg,
            k,
            pulse_s: 5e-3,
            yield_share: None,
            contact: Contact::Rough,
            modes: Vec::new(),
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

    /// The drop, its scene and cask file changed before it is simulated.
    pub(super) fn draw_with(&self, change: impl FnOnce(&mut Scene, &mut CaskFile, &mut Chance)) -> DrawnDrop {
        let drop = Drop::of_height(9.0, self.angle_deg.to_radians());
        let impacts = [(self.pulse_s, self.k), (4e-3, 0.3)].map(|(duration_s, restitution)| WantedImpact {
            duration_s,
            restitution,
            yield_share: self.yield_share,
        });
        let mut scene = Scene {
            seed: self.seed,
            modes: self.modes.clone(),
            before_s: self.before_s,
            channels: [End::First, End::Second].map(|end| self.channel(end)).into(),
            ..scene(self.build.cask(), drop, self.contact, impacts)
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
