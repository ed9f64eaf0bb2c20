//! Determines a channel's offset and noise from the free fall before first contact.

use crate::data::{ChannelFinding, Finding, Severity, Signal};
use crate::numerics::reduce::{self, block_means, block_size};
use crate::numerics::{as_f64, noise, robust};
use std::borrow::Cow;

/// Shortest free fall that determines an offset, s: a period of 50 Hz hum is 20 ms, and half of it still
/// bounds an offset.
const LEAST_S: f64 = 0.01;

/// Offsets above both limits are a warning, m/s² and as a share of the channel's peak: data sheets of
/// piezoresistive shock sensors allow a bias of some percent of the range.
const LARGE_M_S2: f64 = 50.0;
const LARGE_SHARE: f64 = 0.05;

/// Offsets above this are a note, m/s².
const NOTABLE_M_S2: f64 = 0.98;

/// Samples this many spreads off the median are disturbances: not one in a million of normal noise is.
const OUTLIER_SPREADS: f64 = 8.0;

/// Rate of the means from which the spectrum is computed, Hz: an integral over milliseconds contains nothing
/// above a few hundred.
const SPECTRUM_RATE_HZ: f64 = 8000.0;

/// A slope counts beyond this many of its standard uncertainties from [`BLOCKS`] means: that of 1/f noise is
/// ten times that of white noise.
const LEAST_SLOPE_U: f64 = 15.0;
const BLOCKS: usize = 8;

/// Contact and flight over which an offset is integrated, s: those of a 9 m drop from 15°.
const AHEAD_S: f64 = 0.06;

/// Velocity from a drift or a residual offset above which it is a warning, m/s: 0.2 % of a slap-down.
const SMALL_M_S: f64 = 0.05;

/// Stores the mean before `before_s`, its uncertainty and the noise in the signal, and subtracts the mean if
/// `take_off`.
pub(super) fn treat(signal: &mut Signal, before_s: f64, take_off: bool) -> Vec<Finding> {
    let end = signal.index_from(before_s);
    let length_s = before_s - signal.start_s;
    let quiet = recorded_samples(signal, end);
    if length_s < LEAST_S || quiet.len() < 8 {
        let finding = judge_short_fall(signal, length_s, quiet.len());
        // Without free fall the offset may be as large as a usual one.
        signal.u_offset_m_s2 = NOTABLE_M_S2;
        return vec![finding];
    }
    let (quiet, spread_m_s2) = replace_outliers(quiet);
    let (mean, rms) = robust::mean_and_rms(&quiet);
    let noise_m_s2 = spread_m_s2.max(1e-3 * rms);
    let block = block_size(SPECTRUM_RATE_HZ, signal.sample_rate_hz);
    let noise_spectrum = noise::spectrum(&block_means(&quiet, block), signal.sample_rate_hz / as_f64(block));
    let u_offset_m_s2 = robust::mean_and_u(&quiet).1.hypot(rounding_m_s2(signal, spread_m_s2));
    let mut findings = Vec::new();
    let large_m_s2 = LARGE_M_S2.max(LARGE_SHARE * reduce::peak(&signal.force_m_s2));
    findings.extend(judge_offset(&signal.name, mean, take_off, large_m_s2));
    findings.extend(judge_drift(&signal.name, &quiet, (signal.start_s, before_s)));
    signal.noise_m_s2 = noise_m_s2;
    signal.noise_spectrum = noise_spectrum;
    signal.free_fall_s = length_s;
    signal.u_offset_m_s2 = u_offset_m_s2;
    if take_off {
        signal.removed_offset_m_s2 = mean;
        for f in &mut signal.force_m_s2 {
            *f -= mean;
        }
        for gap in &signal.gaps {
            signal.force_m_s2[gap.from..gap.to].fill(0.0);
        }
    }
    findings
}

/// Standard uncertainty of a level from the converter's step q, q/√12, if the noise is less than half a step
/// and does not average it out.
fn rounding_m_s2(signal: &Signal, noise_m_s2: f64) -> f64 {
    let force = &signal.force_m_s2;
    reduce::least_step_beyond(force, 1e-9 * reduce::peak(force), 2.0 * noise_m_s2) / 12.0_f64.sqrt()
}

/// Returns the first `end` samples without the missing ones.
fn recorded_samples(signal: &Signal, end: usize) -> Cow<'_, [f64]> {
    let force = &signal.force_m_s2[..end];
    let mut gaps = signal.gaps.iter().filter(|gap| gap.from < end).peekable();
    if gaps.peek().is_none() {
        return Cow::Borrowed(force);
    }
    let (mut quiet, mut at) = (Vec::with_capacity(end), 0);
    for gap in gaps {
        quiet.extend_from_slice(force.get(at..gap.from).unwrap_or_default());
        at = at.max(gap.to);
    }
    quiet.extend_from_slice(force.get(at..).unwrap_or_default());
    Cow::Owned(quiet)
}

fn judge_short_fall(signal: &Signal, length_s: f64, samples: usize) -> Finding {
    let finding = if length_s < LEAST_S {
        ChannelFinding::ShortFreeFall { length_s: length_s.max(0.0) }
    } else {
        // So few samples in a fall of that length mean a wrong rate, not a late start.
        ChannelFinding::FewSamples { length_s, samples, sample_rate_hz: signal.sample_rate_hz }
    };
    finding.tag(&signal.name)
}

/// Replaces outliers by the median, since a spike is no offset; returns the samples and the remaining spread.
fn replace_outliers(mut quiet: Cow<'_, [f64]>) -> (Cow<'_, [f64]>, f64) {
    let (median, spread) = robust::centre_and_spread(&quiet);
    let most = OUTLIER_SPREADS * spread;
    let (low, high) = reduce::extremes(&quiet, median);
    if most > 0.0 && (high - median).max(median - low) > most {
        for x in quiet.to_mut().iter_mut().filter(|x| (**x - median).abs() > most) {
            *x = median;
        }
        let spread = robust::spread(&quiet);
        return (quiet, spread);
    }
    (quiet, spread)
}

fn judge_offset(name: &str, mean_m_s2: f64, is_removed: bool, large_m_s2: f64) -> Option<Finding> {
    let adds_m_s = mean_m_s2.abs() * AHEAD_S;
    if is_removed {
        let finding = ChannelFinding::OffsetTakenOff { mean_m_s2, is_large: mean_m_s2.abs() > large_m_s2 };
        return (mean_m_s2.abs() > NOTABLE_M_S2).then(|| finding.tag(name));
    }
    let severity = if adds_m_s > SMALL_M_S { Severity::Warning } else { Severity::Note };
    let finding = ChannelFinding::OffsetLeftIn { mean_m_s2, adds_m_s, over_s: AHEAD_S, severity };
    (adds_m_s > 0.1 * SMALL_M_S).then(|| finding.tag(name))
}

/// Reports a slope of the free fall beyond its noise whose continuation into the flight matters.
fn judge_drift(name: &str, quiet: &[f64], (from_s, to_s): (f64, f64)) -> Option<Finding> {
    let size = quiet.len() / BLOCKS;
    if size == 0 {
        return None;
    }
    let means: Vec<f64> = quiet.chunks_exact(size).take(BLOCKS).map(|c| robust::mean_and_rms(c).0).collect();
    let length_s = to_s - from_s;
    let step_s = length_s / as_f64(BLOCKS);
    let middle = (as_f64(BLOCKS) - 1.0) / 2.0;
    let place = |i: usize| (as_f64(i) - middle) * step_s;
    let square: f64 = (0..BLOCKS).map(|i| place(i).powi(2)).sum();
    let slope = means.iter().enumerate().map(|(i, m)| place(i) * m).sum::<f64>() / square;
    let mean = robust::mean_and_rms(&means).0;
    let residual: f64 = means.iter().enumerate().map(|(i, m)| (m - mean - slope * place(i)).powi(2)).sum();
    let u_slope = (residual / as_f64(BLOCKS - 2) / square).sqrt();
    // The drift counts from the middle of the free fall, whose mean was subtracted, through contact and
    // flight.
    let adds_m_s = slope.abs() * AHEAD_S * (length_s / 2.0 + AHEAD_S / 2.0);
    let finding = ChannelFinding::Drift { slope_m_s3: slope, u_m_s3: u_slope, adds_m_s };
    (slope.abs() > LEAST_SLOPE_U * u_slope && adds_m_s > SMALL_M_S)
        .then(|| finding.tag(name).span(from_s, to_s))
}

#[cfg(test)]
mod tests {
    use super::super::tests::signal;
    use super::*;
    use crate::data::FindingKind;
    use crate::data::example::noise;

    /// Simulates 0.2 s of free fall and 0.1 s after it at 10 kHz: an offset of 3 m/s², noise of 2 m/s², and a
    /// slope.
    fn channel(slope: f64, seed: u64) -> Signal {
        signal((0..3000).map(|i| 3.0 + 2.0 * noise(i, seed) + slope * f64::from(i) * 1e-4).collect())
    }

    #[test]
    fn the_mean_is_taken_off_whatever_spikes_there_are() {
        let mut spiky = channel(0.0, 1);
        for i in [100, 700, 701, 1500] {
            spiky.force_m_s2[i] += 2e4;
        }
        assert!(treat(&mut spiky, 0.2, true).iter().all(|i| i.severity == Severity::Note));
        // 2/√2000 = 0.045 is the standard deviation of the mean; the spikes alone would have moved it by 40.
        assert!((spiky.removed_offset_m_s2 - 3.0).abs() < 0.18, "{}", spiky.removed_offset_m_s2);
        assert!(spiky.noise_m_s2 < 2.2 && (spiky.free_fall_s - 0.2).abs() < 1e-9);
        assert!(!spiky.noise_spectrum.is_empty());
    }

    #[test]
    fn an_offset_that_stays_is_said_with_what_it_adds() {
        let mut left = channel(0.0, 1);
        let before = left.force_m_s2.clone();
        let findings = treat(&mut left, 0.2, false);
        assert_eq!(left.force_m_s2, before);
        assert!(left.removed_offset_m_s2.abs() < 1e-300);
        let FindingKind::Channel(ChannelFinding::OffsetLeftIn { adds_m_s, severity, .. }) = findings[0].what
        else {
            panic!("{findings:?}")
        };
        // 3 m/s² over 60 ms.
        assert!((adds_m_s - 0.18).abs() < 0.01 && severity == Severity::Warning, "{findings:?}");
    }

    #[test]
    fn a_drift_is_named_and_noise_is_none() {
        // 49 m/s³, known to 2/√2000 · √12/0.2 = 0.8, adds 49 · 0.06 · 0.13 = 0.38 m/s.
        let drifting = treat(&mut channel(49.0, 2), 0.2, true);
        assert!(
            drifting.iter().any(|f| matches!(f.what,
                FindingKind::Channel(ChannelFinding::Drift { slope_m_s3, .. }) if slope_m_s3 > 0.0)),
            "{drifting:?}"
        );
        for seed in 0..50 {
            let findings = treat(&mut channel(0.0, seed), 0.2, true);
            assert!(findings.iter().all(|i| i.severity == Severity::Note), "{seed}: {findings:?}");
        }
    }

    #[test]
    fn a_record_without_free_fall_begins_late() {
        let findings = treat(&mut channel(0.0, 1), 0.005, true);
        assert_eq!(findings[0].what, FindingKind::Channel(ChannelFinding::ShortFreeFall { length_s: 0.005 }));
    }

    #[test]
    fn a_long_fall_of_few_samples_is_no_late_start() {
        // The times are in ms and were read as seconds.
        let mut slow = signal(vec![0.0; 300]);
        slow.sample_rate_hz = 20.0;
        let findings = treat(&mut slow, 0.25, true);
        let few = ChannelFinding::FewSamples { length_s: 0.25, samples: 5, sample_rate_hz: 20.0 };
        assert_eq!(findings[0].what, FindingKind::Channel(few));
    }
}
