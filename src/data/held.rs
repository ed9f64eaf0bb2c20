//! Samples that a program holds in memory, before any cask file is known.

/// One source of samples, as a reader of another format hands it over.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeldSamples {
    /// What the cask file names as `source`, or as the channel's `name`.
    pub name: String,
    /// The samples, in `unit`; what is not finite is missing.
    pub values: Vec<f64>,
    /// Sample rate, Hz; `None` where `times_s` tells it, or the cask file.
    pub sample_rate_hz: Option<f64>,
    /// Unit; `None` where the cask file tells it.
    pub unit: Option<String>,
    /// A time a sample, s.
    pub times_s: Option<Vec<f64>>,
    /// Time of the first sample where there are no times, s.
    pub start_s: f64,
}
