//! A signal to what the converter and the store make of it: clipped, in steps, held, lost.

use crate::lab::data::Chain;
use crate::numerics::as_count;

/// A count from a product of time and rate; at least 1.
pub(super) fn count(number: f64) -> usize {
    as_count(number.round()).max(1)
}

/// The first index that is not before `number`.
pub(super) fn ceiling(number: f64) -> usize {
    // A time that was meant to fall on a sample does so in spite of rounding.
    as_count((number - 1e-6).ceil())
}

/// Clipped at ± full scale; with bits, in steps of full scale over 2^(bits − 1), the uppermost code a step
/// below it.
pub(super) fn converted(signal_m_s2: f64, chain: &Chain) -> f64 {
    let Some(full_scale_m_s2) = chain.full_scale_m_s2 else { return signal_m_s2 };
    let Some(bits) = chain.bits else { return signal_m_s2.clamp(-full_scale_m_s2, full_scale_m_s2) };
    let codes = 2_f64.powi(i32::from(bits) - 1);
    let step_m_s2 = full_scale_m_s2 / codes;
    (signal_m_s2 / step_m_s2).round().clamp(-codes, codes - 1.0) * step_m_s2
}

/// Within each span, s after the first sample, the last value before it stays, or all is `lost`.
pub(super) fn hold(samples: &mut [f64], spans_s: &[(f64, f64)], rate_hz: f64, lost: Option<f64>) {
    for &(from_s, to_s) in spans_s {
        let to = ceiling(to_s * rate_hz).min(samples.len());
        let from = ceiling(from_s * rate_hz).min(to);
        let held = from.checked_sub(1).map_or(0.0, |before| samples[before]);
        samples[from..to].fill(lost.unwrap_or(held));
    }
}
