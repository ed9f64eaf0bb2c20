//! Judges ends, signs and clocks from the channels' answers to one blow on each end.

use crate::data::{Channel, End, Finding, RestFinding, TapAnswer};

/// Difference in samples by which two channels must distinguish the ends.
const SAMPLES: f64 = 2.0;
/// Difference from which clocks are apart, s: the rise of a manual blow, and the delay of a bending wave.
const APART_S: f64 = 1e-3;

/// Compares the answers of each transverse channel with a blow on the first end, then one on the second, both
/// from below.
///
/// A channel of the first end answers the first blow early and the second late, so that the time between them
/// is longest there, whatever its clock. An equal difference of two channels in both blows is that of their
/// clocks.
pub fn judge_taps(felt: &[(&Channel, Vec<TapAnswer>)]) -> Vec<Finding> {
    if let Some((_, blows)) = felt.iter().find(|(_, blows)| blows.len() != 2) {
        return vec![RestFinding::Blows { count: blows.len() }.into()];
    }
    let rate_hz = felt.iter().map(|(channel, _)| channel.sample_rate_hz).fold(f64::INFINITY, f64::min);
    let between_s = |blows: &[TapAnswer]| blows[1].at_s - blows[0].at_s;
    let is_before =
        |first: &[TapAnswer], second: &[TapAnswer]| between_s(first) + SAMPLES / rate_hz < between_s(second);
    let exchanged = |(channel, blows): &(&Channel, Vec<TapAnswer>)| {
        let mut others = felt.iter().filter(|(other, _)| other.end != channel.end);
        let (is_exchanged, struck) = match channel.end {
            End::First => (others.any(|(_, other)| is_before(blows, other)), "second"),
            End::Second => (others.any(|(_, other)| is_before(other, blows)), "first"),
        };
        is_exchanged.then(|| RestFinding::OtherEnd { struck }.tag(&channel.name))
    };
    let found: Vec<Finding> = felt.iter().filter_map(exchanged).collect();
    if !found.is_empty() {
        return found;
    }
    let down = felt.iter().filter(|(channel, blows)| !blows[usize::from(channel.end == End::Second)].goes_up);
    let down = down.map(|(channel, _)| RestFinding::SwingsDown.tag(&channel.name));
    let reference = felt.iter().find(|(channel, _)| channel.end == End::First);
    let apart = felt.iter().filter_map(|(channel, blows)| {
        let (other, theirs) = reference?;
        let behind_s = (0..2).map(|i| blows[i].at_s - theirs[i].at_s).sum::<f64>() / 2.0;
        let is_apart = channel.end == End::Second && behind_s.abs() > APART_S + SAMPLES / rate_hz;
        let found = RestFinding::ClocksApart { behind_s, other: other.name.clone() };
        is_apart.then(|| found.tag(&channel.name))
    });
    down.chain(apart).collect()
}
