//! A time with what it is uncertain by.

/// A time and its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// From the recording's first sample, s.
    pub time_s: f64,
    /// Its standard uncertainty, s.
    pub u_s: f64,
}

impl At {
    /// A time that is known.
    #[must_use]
    pub const fn exactly(time_s: f64) -> Self {
        Self { time_s, u_s: 0.0 }
    }
}
