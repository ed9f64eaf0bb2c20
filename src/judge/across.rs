//! Judges motion across the plane of the drop from sensors on the skin, and names single sensors that cannot
//! show it.

use crate::data::{ChannelFinding, Events, Finding, Signal};
use crate::numerics::as_f64;

/// Largest velocity across the plane in a planar motion, m/s: 2 % of that of a slap-down.
const NOT_PLANAR_M_S: f64 = 0.3;

/// Smallest uncertainty of the scale from which a single sensor is named: 3° off the direction that it should
/// have.
const LEAST_U_AROUND: f64 = 5e-4;

/// Reports the mean velocity across the plane in the flight if it exceeds that of a planar drop.
pub fn judge_across(signal: &Signal, events: &Events) -> Option<Finding> {
    let (contact_s, left_s, struck_s) =
        (events.first_contact_s()?, events.separation_s()?, events.slap_down_s()?);
    let is_lost = [&signal.clipped, &signal.gaps].iter().any(|s| signal.overlaps(s, contact_s, struck_s));
    let [from, left, to] = [contact_s, left_s, struck_s].map(|at_s| signal.index_from(at_s));
    let mut velocity_m_s = 0.0;
    let mut flight_m_s = Vec::new();
    for (index, force) in signal.force_m_s2.iter().enumerate().take(to).skip(from) {
        velocity_m_s += force / signal.sample_rate_hz;
        flight_m_s.extend((index >= left).then_some(velocity_m_s));
    }
    let mean_m_s = flight_m_s.iter().sum::<f64>() / as_f64(flight_m_s.len().max(1));
    let u_m_s = signal.u_offset_m_s2 * (struck_s + left_s - 2.0 * contact_s) / 2.0;
    let finding = ChannelFinding::MovesAcross { velocity_m_s: mean_m_s, u_m_s };
    (!is_lost && mean_m_s.abs() > NOT_PLANAR_M_S + 2.0 * u_m_s).then(|| finding.tag(&signal.name))
}

/// Names a single sensor that does not read in the plane of the drop alone.
pub fn judge_alone(signal: &Signal) -> Option<Finding> {
    let finding = ChannelFinding::AloneOnSkin { u_share: signal.u_around };
    (signal.u_around > LEAST_U_AROUND).then(|| finding.tag(&signal.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, example};

    #[test]
    fn a_velocity_across_the_plane_through_the_flight_is_named_and_a_blow_that_ends_is_not() {
        let events = Events { separation: Some(At::exact(0.03)), ..example::events(0.02, 0.06) };
        // 1 kHz; 10 ms of contact, in which the cask gains a velocity across the plane.
        let gaining = |contact: f64, flight: f64| {
            let force = |i: u32| if (20..30).contains(&i) { contact } else { flight };
            let signal = example::signal(1e3, (0..80).map(force).collect());
            judge_across(&signal, &events).map(|found| found.message)
        };
        let named = gaining(50.0, 0.0).expect("0.5 m/s are named");
        assert!(named.contains("+0.50 ±"), "{named}");
        assert!(gaining(-50.0, 0.0).is_some());
        assert_eq!(gaining(25.0, 0.0), None, "0.25 m/s are not");
        // The flight compensates for the contact: 0.5 m/s at its start, 0.2 in the mean.
        assert_eq!(gaining(50.0, -20.0), None);
    }
}
