//! Output of `synth` for a scene: the channels as their recorder wrote them, and the truth.

use super::scene::{Scene, Truth};
use crate::data::CaskFile;
use crate::numerics::as_f64;

/// An end's impact, which a scene file may request instead of stiffnesses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WantedImpact {
    /// Duration of the contact, s.
    pub duration_s: f64,
    /// k, above 0 and not above 1.
    pub restitution: f64,
    /// Yield force over the peak of the elastic end; `None`: no yield.
    pub yield_share: Option<f64>,
}

/// A checked scene file: the scene, and the statements for the cask file beside the recording.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// The true scene.
    pub scene: Scene,
    /// The scene as stated: its channels in the same order, their sources still unnamed.
    pub stated: CaskFile,
}

/// One channel as its recorder wrote it.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticChannel {
    /// Name.
    pub name: String,
    /// Unit of the samples, "g" or "m/s^2".
    pub unit: String,
    /// Stamp of the first sample, s from the earliest of all channels.
    pub start_s: f64,
    /// Sample rate, Hz, as the recorder states it.
    pub sample_rate_hz: f64,
    /// The samples; NaN where the recorder lost them.
    pub samples: Vec<f32>,
}

impl SyntheticChannel {
    /// The runs of samples between losses, each with the index of its first sample.
    pub fn runs(&self) -> impl Iterator<Item = (usize, &[f32])> {
        let mut at = 0;
        let begun = self.samples.split(|x| x.is_nan()).map(move |run| {
            let from = at;
            // The lost sample that ends the run counts too.
            at += run.len() + 1;
            (from, run)
        });
        begun.filter(|(_, run)| !run.is_empty())
    }

    /// Stamp of sample `index`, s.
    pub fn time_s(&self, index: usize) -> f64 {
        self.start_s + as_f64(index) / self.sample_rate_hz
    }
}

/// A synthetic recording with its truth.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticRecording {
    /// The channels, in the scene's order.
    pub channels: Vec<SyntheticChannel>,
    /// First contact by the recorder's clock, s from the earliest sample, for a channel without skew.
    pub first_contact_s: f64,
    /// Results of a perfect measurement.
    pub truth: Truth,
    /// The seed that it was made with.
    pub seed: u64,
}

impl SyntheticRecording {
    /// Converts the recording to sensors that are mounted as the cask file states.
    pub fn to_mounted(&self, stated: &CaskFile) -> Self {
        let mut mounted = self.clone();
        for (channel, stated) in mounted.channels.iter_mut().zip(&stated.channels) {
            if stated.polarity < 0.0 {
                channel.samples.iter_mut().for_each(|x| *x = -*x);
            }
        }
        mounted
    }
}
