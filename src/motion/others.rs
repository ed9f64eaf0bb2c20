//! Curve of a channel that takes no part in the motion, as recorded, and its spectrum.

use super::curves::span_s;
use crate::data::{Channel, Events, OtherCurve, SpectralLine};
use crate::numerics::as_f64;
use crate::numerics::spectrum::magnitude;

/// A spectral line needs this many periods within the curve: with fewer it is the shape of a pulse.
const LEAST_PERIODS: f64 = 3.0;

/// The curve over the range shown of the event; `None` if the first contact is not known.
pub fn other_curve(channel: &Channel, events: &Events) -> Option<OtherCurve> {
    let (from_s, to_s) = events.first_contact_s().map(|contact_s| span_s(contact_s, events))?;
    // A slow channel also needs the samples on either side.
    let step_s = 1.0 / channel.sample_rate_hz;
    let shown = channel.index_at(from_s - step_s)..channel.index_at(to_s + 2.0 * step_s);
    let values = channel.force_m_s2(shown.start, shown.end);
    let numbers = || values.iter().filter(|value| value.is_finite());
    let mean = numbers().sum::<f64>() / as_f64(numbers().count());
    let about_mean = |value: &f64| if value.is_finite() { value - mean } else { 0.0 };
    let (frequency_hz, magnitude) = magnitude(values.iter().map(about_mean), channel.sample_rate_hz);
    Some(OtherCurve {
        channel: channel.name.clone(),
        unit: channel.unit.clone(),
        time_s: shown.map(|i| channel.time_s(i)).collect(),
        values,
        frequency_hz,
        magnitude,
    })
}

/// The strongest maximum of its spectrum, from three periods in the curve on.
pub fn strongest_line(curve: &OtherCurve) -> Option<SpectralLine> {
    let least_hz = LEAST_PERIODS / (curve.time_s.last()? - curve.time_s.first()?);
    let is_maximum = |m: &[f64]| m[1] > m[0] && m[1] >= m[2];
    let maxima = curve.magnitude.windows(3).zip(&curve.frequency_hz[1..]).filter(|(m, _)| is_maximum(m));
    maxima
        .filter(|(_, frequency_hz)| **frequency_hz >= least_hz)
        .map(|(m, frequency_hz)| SpectralLine { frequency_hz: *frequency_hz, magnitude: m[1] })
        .max_by(|a, b| a.magnitude.total_cmp(&b.magnitude))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    #[test]
    fn the_curve_holds_what_is_shown_and_its_line_is_found() {
        let sine = |i: u32| 20.0 + 3.0 * (2.0 * std::f64::consts::PI * 250.0 * f64::from(i) / 1e4).sin();
        let mut channel = example::other((0..4000).map(sine).collect());
        let events = example::events(0.1, 0.2);
        let curve = other_curve(&channel, &events).expect("a contact");
        let ends = [curve.time_s[0], *curve.time_s.last().unwrap()];
        assert!((ends[0] - 0.09).abs() < 2.5e-4 && (ends[1] - 0.24).abs() < 2.5e-4, "{ends:?}");
        let index = channel.index_at(curve.time_s[7]);
        assert!((curve.values[7] - channel.samples.get(index)).abs() < 1e-12);
        let line = strongest_line(&curve).expect("a line");
        // A half of the amplitude over the time shown, within the scallop of the bins.
        assert!((line.frequency_hz - 250.0).abs() < 5.0, "{line:?}");
        assert!((line.magnitude / (1.5 * (ends[1] - ends[0])) - 1.0).abs() < 0.1, "{line:?}");
        assert!(other_curve(&channel, &Events::default()).is_none());
        // A slow channel has the samples on either side.
        channel.sample_rate_hz = 2.0;
        assert_eq!(other_curve(&channel, &events).expect("a contact").time_s, [0.0, 0.5]);
    }
}
