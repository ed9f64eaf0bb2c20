//! Curves for a reader from the signals: filtered force, velocity, spectrum.

use super::decimate::decimate;
use crate::data::{Axis, ChannelCurve, Events, FilterChoice, MotionCurve, Setup, Signal};
use crate::numerics::filter::{CFC_DESIGN, LowPass, TWO_PASS_CUTOFF};
use crate::numerics::quadrature::running_integral;
use rayon::prelude::*;
use std::ops::Range;

/// Shown before first contact, s.
const BEFORE_S: f64 = 0.01;
/// Shown after the last event, s: the slap-down pulse and some ringing.
const AFTER_S: f64 = 0.04;
/// A low-pass with −3 dB at f reaches this many times 1/f: beyond that 1e-12 of a sample remains.
const REACH: f64 = 6.2;
/// A rate of this many times the cut-off suffices after a low-pass: block means at this rate lose 2e-4 at the
/// cut-off.
const RATE_OVER_CUTOFF: f64 = 100.0;
/// IAEA SSG-26 as quoted in the field: 100–200 Hz for 100 t, scaled with (100 t / m)^(1/3); the upper end
/// (28).
const CUTOFF_100_T_HZ: f64 = 200.0;
/// Points of the motion, uniform over contact and flight: 0.1 ms over 60 ms.
const CURVE_POINTS: u32 = 600;

/// The −3 dB cut-off for curves and peaks, Hz, and its origin: the same for every drop of a mass.
pub fn cutoff_hz(choice: FilterChoice, mass_kg: f64) -> (f64, &'static str) {
    match choice {
        FilterChoice::Cfc(class) => (class * CFC_DESIGN * TWO_PASS_CUTOFF, "cask file"),
        FilterChoice::CutoffHz(hz) => (hz, "cask file"),
        FilterChoice::Auto => (
            CUTOFF_100_T_HZ * (1e5 / mass_kg).cbrt(),
            "default: IAEA SSG-26, upper end of 100 to 200 Hz × (100 t/m)^⅓",
        ),
    }
}

/// The name of the low-pass that [`cutoff_hz`] gives.
pub fn filter_name(choice: FilterChoice) -> String {
    match choice {
        FilterChoice::Cfc(class) => format!("CFC {class}"),
        FilterChoice::CutoffHz(hz) => format!("{hz} Hz"),
        FilterChoice::Auto => "SSG-26, 200 Hz".to_owned(),
    }
}

/// Low-passes with which rigid-body decelerations are usually stated, and their −3 dB frequencies, Hz   (28),
/// (25)
pub fn usual_filters(mass_kg: f64) -> Vec<(String, f64)> {
    let by_mass_hz = cutoff_hz(FilterChoice::Auto, mass_kg).0;
    let classes = [60.0, 180.0, 600.0].map(|class| {
        let choice = FilterChoice::Cfc(class);
        (filter_name(choice), cutoff_hz(choice, mass_kg).0)
    });
    let advised =
        [("SSG-26, 100 Hz".to_owned(), by_mass_hz / 2.0), (filter_name(FilterChoice::Auto), by_mass_hz)];
    advised.into_iter().chain(classes).collect()
}

/// The signals over the range shown, extended on both sides by the reach of a low-pass with this −3 dB
/// cut-off, Hz.
pub fn cut_shown(signals: &[Signal], events: &Events, cutoff_hz: f64) -> Vec<Signal> {
    signals.iter().map(|signal| cut_wide(signal, span_s(signal.start_s, events), cutoff_hz)).collect()
}

/// A signal between two times, s, extended on both sides by the reach of a low-pass with this −3 dB cut-off,
/// Hz.
pub(super) fn cut_wide(signal: &Signal, (from_s, to_s): (f64, f64), cutoff_hz: f64) -> Signal {
    let margin_s = REACH / cutoff_hz;
    signal.cut(signal.index_from(from_s - margin_s), signal.index_from(to_s + margin_s))
}

/// The signals after a zero-phase low-pass, at a rate that suffices for it; unchanged if the cut-off is too
/// high for the rate.
pub fn filter(signals: &[Signal], cutoff_hz: f64) -> Vec<Signal> {
    let signals = decimate(signals, RATE_OVER_CUTOFF * cutoff_hz);
    let smooth = low_pass_samples(&signals, cutoff_hz);
    signals.iter().zip(smooth).map(|(signal, smooth)| signal.cut_with(0, smooth)).collect()
}

/// The samples of signals after a zero-phase low-pass with this −3 dB cut-off, Hz; unchanged if their rate is
/// too low.
fn low_pass_samples(signals: &[Signal], cutoff_hz: f64) -> Vec<Vec<f64>> {
    let filter = |signal: &Signal| LowPass::with_cutoff_hz(cutoff_hz, signal.sample_rate_hz);
    let filters: Vec<Option<LowPass>> = signals.iter().map(filter).collect();
    match filters.first() {
        Some(Some(filter)) if filters.iter().all(|other| other.as_ref() == Some(filter)) => {
            filter.apply_each(&signals.iter().map(|s| &s.force_m_s2[..]).collect::<Vec<_>>())
        }
        _ => {
            let filter_one = |(filter, signal): (&Option<LowPass>, &Signal)| match filter {
                Some(filter) => filter.apply(&signal.force_m_s2),
                None => signal.force_m_s2.clone(),
            };
            filters.iter().zip(signals).map(filter_one).collect()
        }
    }
}

/// Curves over the event, from signals with the margin of [`cut_shown`].
pub fn channel_curves(
    signals: &[Signal],
    events: &Events,
    cutoff_hz: f64,
    setup: &Setup,
) -> Vec<ChannelCurve> {
    signals
        .par_iter()
        .zip(low_pass_samples(signals, cutoff_hz))
        .map(|(signal, smooth)| {
            let Range { start: from, end: to } = visible(signal, events);
            // The velocity counts from first contact, when L moves with −v0 along the sensor's axis (17).
            let (sin, cos) = setup.angle_rad.sin_cos();
            let before_m_s = match signal.axis {
                Axis::Transverse => {
                    -setup.impact_velocity_m_s * cos - setup.angular_velocity_rad_s * signal.position_m
                }
                Axis::Axial => -setup.impact_velocity_m_s * sin + setup.horizontal_velocity_m_s * cos,
            };
            let raw = signal.force_m_s2[from..to].to_vec();
            let velocity_m_s = running_integral(&raw, 1.0 / signal.sample_rate_hz)
                .into_iter()
                .map(|v| before_m_s + v)
                .collect();
            ChannelCurve {
                channel: signal.name.clone(),
                time_s: (from..to).map(|i| signal.time_s(i)).collect(),
                raw_m_s2: raw,
                filtered_m_s2: smooth[from..to].to_vec(),
                velocity_m_s,
            }
        })
        .collect()
}

/// The samples that are shown.
pub fn visible(signal: &Signal, events: &Events) -> Range<usize> {
    let (first_s, last_s) = span_s(signal.start_s, events);
    let from = signal.index_from(first_s);
    from..signal.index_from(last_s).max(from)
}

/// Time range shown of a channel that begins at `start_s`, s.
pub(super) fn span_s(start_s: f64, events: &Events) -> (f64, f64) {
    let first_s = events.first_contact_s().unwrap_or(start_s);
    let last_s = events.slap_down_s().or(events.separation_s().map(|t| t + 0.05)).unwrap_or(first_s + 0.1);
    (first_s - BEFORE_S, last_s + AFTER_S)
}
/// The curve on uniform times, linear between its steps.
pub(super) fn uniform(curve: &MotionCurve) -> MotionCurve {
    let (Some(&first_s), Some(&last_s)) = (curve.time_s.first(), curve.time_s.last()) else {
        return MotionCurve::default();
    };
    let time_s: Vec<f64> = (0..=CURVE_POINTS)
        .map(|i| first_s + (last_s - first_s) * f64::from(i) / f64::from(CURVE_POINTS))
        .collect();
    let places: Vec<(usize, f64)> = time_s
        .iter()
        .map(|&t| {
            let next = curve.time_s.partition_point(|&u| u < t).clamp(1, curve.time_s.len() - 1);
            let (a, b) = (curve.time_s[next - 1], curve.time_s[next]);
            (next, if b > a { ((t - a) / (b - a)).clamp(0.0, 1.0) } else { 1.0 })
        })
        .collect();
    let on = |values: &[f64]| {
        let between =
            |&(next, share): &(usize, f64)| values[next - 1] + share * (values[next] - values[next - 1]);
        places.iter().map(between).collect()
    };
    MotionCurve {
        angle_rad: on(&curve.angle_rad),
        angular_velocity_rad_s: on(&curve.angular_velocity_rad_s),
        first_end_vertical_m_s: on(&curve.first_end_vertical_m_s),
        second_end_vertical_m_s: on(&curve.second_end_vertical_m_s),
        second_end_horizontal_m_s: on(&curve.second_end_horizontal_m_s),
        first_end_height_m: on(&curve.first_end_height_m),
        second_end_height_m: on(&curve.second_end_height_m),
        time_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_default_cutoff_keeps_the_peak_of_a_usual_pulse() {
        // A half sine of 5.3 ms, 3 over the default cut-off of 4.5 t, between two silences.
        let sine =
            |i: u32| if (5000..5530).contains(&i) { (PI * f64::from(i - 5000) / 530.0).sin() } else { 0.0 };
        let pulse: Vec<f64> = (0..10_530).map(sine).collect();
        let peak = |choice| {
            let filter = LowPass::with_cutoff_hz(cutoff_hz(choice, 4.5e3).0, 1e5);
            filter.expect("below Nyquist").apply(&pulse).into_iter().fold(0.0, f64::max)
        };
        assert!((peak(FilterChoice::Auto) - 1.0_f64).abs() < 0.01, "{}", peak(FilterChoice::Auto));
        assert!(peak(FilterChoice::Cfc(60.0)) < 0.9);
    }
}
