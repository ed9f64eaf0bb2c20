//! Summarises a channel beside the accelerometers: level at rest, noise, extremes and limits; of an
//! angular-rate sensor also the rotation of the cask in the fall, and its change by the first impact   (45)

use super::clipping;
use crate::data::{
    Channel, Events, FlightFit, MeasuredRotation, OtherSummary, RateSpec, RotationRate, Span, rate_unit_rad_s,
};
use crate::numerics::damped_modes::{Oscillation, uniform_ringing};
use crate::numerics::reduce::block_means;
use crate::numerics::{as_f64, robust};
use nalgebra::{DMatrix, DVector};

/// Time after a release and before a contact in which their effects last, s: a hook opens within some
/// milliseconds.
const CLEAR_S: f64 = 0.02;
const BEFORE_CONTACT_S: f64 = 1e-3;
/// Time at rest before the release that determines a zero, s.
const ZERO_TIME_S: f64 = 1.0;
/// Shortest time and fewest samples that determine a level, s: a period of 50 Hz hum.
const LEAST_LEVEL_S: f64 = 0.02;
const LEAST_SAMPLES: usize = 8;
/// Largest number of means to which the flight is fitted.
const MOST_FLIGHT_MEANS: usize = 240;

/// Summarises the channel over the whole recording, with its level at rest before the release, or before the
/// first contact if no release is recorded.
pub fn read_other(channel: &Channel, events: &Events) -> OtherSummary {
    let mut values = channel.force_m_s2(0, channel.samples.len());
    let [smallest, largest] = channel.extremes().map_or([None; 2], |extremes| extremes.map(Some));
    let mut summary = OtherSummary {
        name: channel.name.clone(),
        unit: channel.unit.clone(),
        source: channel.source.clone(),
        samples: values.len(),
        sample_rate_hz: channel.sample_rate_hz,
        smallest,
        largest,
        ..OtherSummary::default()
    };
    let quiet =
        events.release_s.or(events.first_contact_s()).map_or(0, |before_s| channel.index_at(before_s));
    let mut at_rest: Vec<f64> = robust::thin(&values[..quiet]).filter(|value| value.is_finite()).collect();
    if !at_rest.is_empty() {
        let (noise, rest) = (robust::spread(&at_rest), robust::median(&mut at_rest));
        for value in &mut values {
            *value -= rest;
        }
        summary.clipped = clipping::find_clipped(channel, &values, rest, noise, quiet);
        (summary.rest, summary.noise) = (Some(rest), Some(noise));
    }
    summary
}

/// Measures the rotation by an angular-rate sensor, over `usual_s` of the fall if its release is not
/// recorded; `None` if the sensor does not show fall and flight.
pub fn measured_rotation(
    channel: &Channel,
    spec: RateSpec,
    usual_s: f64,
    events: &Events,
    flight: &FlightFit,
) -> Option<MeasuredRotation> {
    let scale_rad_s = spec.polarity * rate_unit_rad_s(&channel.unit)?;
    let contact_s = events.fall_end_s.or(events.first_contact_s())? - BEFORE_CONTACT_S;
    let sensor = RateReader { channel, scale_rad_s, clipped: &read_other(channel, events).clipped };
    let fall_from_s = events.release_s.map_or(contact_s - usual_s, |at_s| at_s + CLEAR_S);
    let fall = sensor.mean_rate(fall_from_s, contact_s)?;
    let zero = match (events.release_s, channel.rest) {
        (Some(at_s), _) => sensor.mean_rate(at_s - CLEAR_S - ZERO_TIME_S, at_s - CLEAR_S),
        (None, rest) => rest.map(|rest| sensor.rate(rest.level, rest.u)),
    };
    let difference = |a: RotationRate, b: RotationRate| RotationRate {
        rad_s: a.rad_s - b.rad_s,
        u_rad_s: a.u_rad_s.hypot(b.u_rad_s),
    };
    Some(MeasuredRotation {
        channel: channel.name.clone(),
        calibration: spec.calibration,
        before: zero.map(|zero| difference(fall, zero)),
        gained: difference(sensor.fit_in_flight(flight)?, fall),
    })
}

struct RateReader<'a> {
    channel: &'a Channel,
    /// rad/s per unit of the samples, positive brings R down.
    scale_rad_s: f64,
    clipped: &'a [Span],
}

impl RateReader<'_> {
    fn rate(&self, level: f64, u: f64) -> RotationRate {
        RotationRate { rad_s: self.scale_rad_s * level, u_rad_s: self.scale_rad_s.abs() * u }
    }

    /// Returns the samples between two times, and the time of the first, s; `None` if there are too few or
    /// one stands at a limit.
    fn samples_between(&self, from_s: f64, to_s: f64) -> Option<(Vec<f64>, f64)> {
        let (from, to) = (self.channel.index_at(from_s), self.channel.index_at(to_s));
        let is_clipped = self.clipped.iter().any(|span| span.from < to && span.to > from);
        let values = self.channel.force_m_s2(from, to);
        let is_whole = values.len() >= LEAST_SAMPLES && values.iter().all(|value| value.is_finite());
        (is_whole && !is_clipped).then(|| (values, self.channel.time_s(from)))
    }

    /// Mean between two times, with its uncertainty determined like that of an offset.
    fn mean_rate(&self, from_s: f64, to_s: f64) -> Option<RotationRate> {
        let (values, begins_s) = self.samples_between(from_s, to_s)?;
        let (mean, u) = robust::mean_and_u(&values);
        (to_s - begins_s >= LEAST_LEVEL_S).then(|| self.rate(mean, u))
    }

    /// Fits the constant part in the flight beside the modes that the accelerometers show there.
    fn fit_in_flight(&self, flight: &FlightFit) -> Option<RotationRate> {
        let (values, begins_s) = self.samples_between(flight.from_s, flight.to_s)?;
        let block = values.len().div_ceil(MOST_FLIGHT_MEANS);
        let means = DVector::from_vec(block_means(&values, block));
        let step_s = as_f64(block) / self.channel.sample_rate_hz;
        let middle_s = begins_s - flight.from_s + (as_f64(block) - 1.0) / 2.0 / self.channel.sample_rate_hz;
        let mut parts = vec![DVector::from_element(means.len(), 1.0)];
        for mode in &flight.modes {
            let oscillation = Oscillation { frequency_hz: mode.frequency_hz, damping: mode.damping };
            let ringing: Vec<_> = uniform_ringing(oscillation, middle_s, step_s).take(means.len()).collect();
            parts.push(DVector::from_iterator(means.len(), ringing.iter().map(|z| z.re)));
            parts.push(DVector::from_iterator(means.len(), ringing.iter().map(|z| z.im)));
        }
        let model = DMatrix::from_columns(&parts);
        let inverse = model.tr_mul(&model).try_inverse()?;
        let sizes = &inverse * model.tr_mul(&means);
        let residuals = &means - &model * &sizes;
        let spare = as_f64(means.len().checked_sub(parts.len() + 1)?);
        let square = residuals.norm_squared().max(f64::MIN_POSITIVE);
        // Correlated neighbours count as one   (21)
        let lag = residuals.as_slice().windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / square;
        let lag = lag.clamp(0.0, 0.95);
        let u = (square / spare * (1.0 + lag) / (1.0 - lag) * inverse[(0, 0)]).sqrt();
        let length_s = flight.to_s - flight.from_s;
        let amplitudes = sizes.as_slice()[1..].chunks_exact(2).map(|size| size[0].hypot(size[1]));
        let ringing = flight.modes.iter().zip(amplitudes).map(|(mode, size)| mode.u_plateau(size, length_s));
        Some(self.rate(sizes[0], ringing.fold(u, f64::hypot)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;
    use crate::data::{At, Span};

    /// Simulates 500 samples of noise of 1 about 20, then a half sine of 100 that is cut at `limit` above 20.
    fn pulse(limit: f64) -> Vec<f64> {
        let sine = |i: u32| {
            let x = (f64::from(i) - 500.0) / 200.0;
            if (0.0..1.0).contains(&x) { 100.0 * (std::f64::consts::PI * x).sin() } else { 0.0 }
        };
        (0..1000).map(|i| 20.0 + (sine(i) + example::noise(i, 1)).min(limit)).collect()
    }

    fn read(values: Vec<f64>) -> OtherSummary {
        let events = Events { first_contact: Some(At::exact(0.05)), ..Events::default() };
        read_other(&example::other(values), &events)
    }

    #[test]
    fn rest_noise_and_extremes_have_their_times() {
        let summary = read(pulse(f64::INFINITY));
        assert!((summary.rest.unwrap() - 20.0).abs() < 0.2 && (summary.noise.unwrap() - 1.0).abs() < 0.15);
        let largest = summary.largest.unwrap();
        assert!((largest.value - 120.0).abs() < 3.0 && (largest.time_s - 0.06).abs() < 2e-3);
        assert!(summary.clipped.is_empty());
        assert!(read(vec![f64::NAN; 900]).largest.is_none());
    }

    #[test]
    fn a_flat_top_and_a_stated_limit_are_clipping() {
        let [span] = read(pulse(60.0)).clipped[..] else { panic!() };
        assert!((530..545).contains(&span.from) && (655..670).contains(&span.to), "{span:?}");
        let mut stated = example::other(vec![1.0, 5.0, 5.0, -5.0, 2.0]);
        stated.full_scale = Some(5.0);
        let events = Events { first_contact: Some(At::exact(1e-4)), ..Events::default() };
        assert_eq!(read_other(&stated, &events).clipped, [Span { from: 1, to: 4 }]);
    }
}
