//! A channel that takes no part in the motion to what it reads: level at rest, noise, extremes, limits.

use super::clipping;
use crate::data::{Channel, Events, OtherSummary};
use crate::numerics::robust;

/// What the channel reads over the whole recording; at rest before the release where the record shows it,
/// else before the first contact.
#[must_use]
pub fn read_other(channel: &Channel, events: &Events) -> OtherSummary {
    let mut values = channel.force_m_s2(0, channel.samples.len());
    let [smallest, largest] = channel.extremes().map_or([None; 2], |both| both.map(Some));
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
    let mut at_rest: Vec<f64> = robust::sampled(&values[..quiet]).filter(|value| value.is_finite()).collect();
    if !at_rest.is_empty() {
        let (noise, rest) = (robust::spread(&at_rest), robust::median(&mut at_rest));
        for value in &mut values {
            *value -= rest;
        }
        summary.clipped = clipping::clipped(channel, &values, rest, noise, quiet);
        (summary.rest, summary.noise) = (Some(rest), Some(noise));
    }
    summary
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;
    use crate::data::{At, Span};

    /// 500 of noise of 1 about 20, then a half sine of 100 that is cut at `limit` above 20.
    fn pulse(limit: f64) -> Vec<f64> {
        let sine = |i: u32| {
            let x = (f64::from(i) - 500.0) / 200.0;
            if (0.0..1.0).contains(&x) { 100.0 * (std::f64::consts::PI * x).sin() } else { 0.0 }
        };
        (0..1000).map(|i| 20.0 + (sine(i) + example::noise(i, 1)).min(limit)).collect()
    }

    fn read(values: Vec<f64>) -> OtherSummary {
        let events = Events { first_contact: Some(At::exactly(0.05)), ..Events::default() };
        read_other(&example::other(values), &events)
    }

    #[test]
    fn rest_noise_and_extremes_have_their_times() {
        let told = read(pulse(f64::INFINITY));
        assert!((told.rest.unwrap() - 20.0).abs() < 0.2 && (told.noise.unwrap() - 1.0).abs() < 0.15);
        let largest = told.largest.unwrap();
        assert!((largest.value - 120.0).abs() < 3.0 && (largest.time_s - 0.06).abs() < 2e-3);
        assert!(told.clipped.is_empty());
        assert!(read(vec![f64::NAN; 900]).largest.is_none());
    }

    #[test]
    fn a_flat_top_and_a_stated_limit_are_clipping() {
        let [span] = read(pulse(60.0)).clipped[..] else { panic!() };
        assert!((530..545).contains(&span.from) && (655..670).contains(&span.to), "{span:?}");
        let mut stated = example::other(vec![1.0, 5.0, 5.0, -5.0, 2.0]);
        stated.full_scale = Some(5.0);
        let events = Events { first_contact: Some(At::exactly(1e-4)), ..Events::default() };
        assert_eq!(read_other(&stated, &events).clipped, [Span { from: 1, to: 4 }]);
    }
}
