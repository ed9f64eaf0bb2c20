//! Series to plateaus by a shape that is named, instead of by the one that the data call for.

use crate::numerics::damped_modes::{Fit, Form, Oscillation, Seeds, Series, fit};

/// What a series is taken for   (20)
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A plateau: its mean.
    Mean,
    /// A plateau with drift.
    Line,
    /// A plateau and so many damped modes.
    Modes(u8),
}

impl Shape {
    /// Those that a flight may ask for, simplest first.
    pub const ALL: [Self; 5] = [Self::Mean, Self::Line, Self::Modes(1), Self::Modes(2), Self::Modes(3)];

    /// Its name for a person.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Mean | Self::Modes(0) => "mean",
            Self::Line => "line",
            Self::Modes(1) => "1 mode",
            Self::Modes(2) => "2 modes",
            Self::Modes(_) => "3 modes",
        }
    }
}

/// The fit of `shape`, its modes sought one after another over `band_hz`; `None` where it is singular or a mode is not to be had.
#[must_use]
pub fn fit_shape(shape: Shape, series: &[Series], band_hz: (f64, f64)) -> Option<Fit> {
    let Shape::Modes(wanted) = shape else {
        return fit(series, &[], None, Form { drift: shape == Shape::Line, drive: None });
    };
    let seeds = Seeds::new(series, band_hz, None);
    let mut fitted = fit(series, &[], None, Form::FREE)?;
    for _ in 0..wanted {
        let start: Vec<Oscillation> = fitted.modes;
        fitted = fit(series, &start, Some(&seeds), Form::FREE)?;
    }
    Some(fitted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_mode_is_what_the_mean_misses() {
        // 1.25 periods of 25 Hz in 50 ms about a plateau of 8.
        let time_s: Vec<f64> = (0..200).map(|i| 2.5e-4 * f64::from(i)).collect();
        let value: Vec<f64> = time_s.iter().map(|t| 8.0 + 2.0 * (TAU * 25.0 * t).sin()).collect();
        let series = [Series { time_s, value, steps_s: vec![], floor: 1e-6 }];
        let plateau = |shape| fit_shape(shape, &series, (15.0, 400.0)).expect("a fit").series[0].plateau;
        // A quarter period too much: its mean of 2/(π/2) over a fifth of the window.
        assert!((plateau(Shape::Mean) - 8.255).abs() < 0.01);
        assert!((plateau(Shape::Modes(1)) - 8.0).abs() < 1e-6);
    }
}
