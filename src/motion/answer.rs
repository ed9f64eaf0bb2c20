//! Delay of a sensor behind an impact on the end of a cask, from the cask's bending.

use crate::data::{End, FlightFit, Signal};
use crate::numerics::free_beam::WAVE_NUMBERS;
use std::f64::consts::TAU;

/// Longest delay of a sensor's response to an impact, s, if bending must travel to it   (50)
///
/// Bending spreads over the share x of the length in x² L²/√(EI/μ), by the first mode f of a free uniform
/// beam (4.73)²/2π · x²/f: the answer comes at any time up to then.
pub fn largest_delay_s(flight: &FlightFit, sensor: &Signal, length_m: f64, contact_s: f64) -> f64 {
    let from_first = sensor.position_m / length_m;
    let share = if sensor.end == End::First { from_first } else { 1.0 - from_first };
    WAVE_NUMBERS[0].powi(2) / TAU * share * share / flight.first_bending_hz(contact_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Mode, example};

    #[test]
    fn a_time_is_the_less_known_the_farther_the_sensor_is_and_the_slower_the_cask_bends() {
        let late_s = |end, position_m: f64, modes_hz: &[f64], contact_s: f64| {
            let mode = |&frequency_hz: &f64| Mode { frequency_hz, damping: 0.01, amplitude_m_s: 1.0 };
            let modes = modes_hz.iter().map(mode).collect();
            let flight = FlightFit { modes, ..example::flight(0.0, 0.1, vec![]) };
            let sensor = Signal { end, position_m, ..example::signal(1e4, vec![]) };
            largest_delay_s(&flight, &sensor, 5.0, contact_s) / 3.0_f64.sqrt()
        };
        // 22.37/2π · 0.2²/50 Hz over √3.
        let far_s = late_s(End::First, 1.0, &[50.0, 130.0], 5e-3);
        assert!((far_s - 1.6445e-3).abs() < 1e-6, "{far_s}");
        assert!((late_s(End::Second, 4.5, &[50.0], 5e-3) - far_s / 4.0).abs() < 1e-9);
        // Where nothing rings after 40 ms the cask bends at 50 Hz at the least.
        assert!((late_s(End::First, 1.0, &[], 0.04) - far_s).abs() < 1e-9);
    }
}
