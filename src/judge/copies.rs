//! Finds channels that hold the samples of another one.

use crate::data::{Channel, ChannelFinding, Finding, Samples};

/// Names each channel that holds the samples of one before it: a sensor that is stated twice counts once, and
/// two ends never read the same.
pub fn judge_copies(channels: &[Channel]) -> Vec<Finding> {
    let copy = |at: usize| {
        let channel = &channels[at];
        let original = channels[..at].iter().find(|other| is_same(&channel.samples, &other.samples))?;
        let found =
            ChannelFinding::Copied { of: original.name.clone(), is_other_end: original.end != channel.end };
        Some(found.tag(&channel.name))
    };
    (1..channels.len()).filter_map(copy).collect()
}

/// True if both hold the same samples, and more than one value; two sensors differ by their noise within the
/// first samples.
fn is_same(one: &Samples, other: &Samples) -> bool {
    let is_copy = one.len() == other.len()
        && match (one, other) {
            (Samples::F32(a), Samples::F32(b)) => a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()),
            (Samples::F64(a), Samples::F64(b)) => a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()),
            _ => false,
        };
    is_copy && (1..one.len()).any(|i| one.get(i).total_cmp(&one.get(0)).is_ne())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_samples_are_a_copy_and_constant_ones_are_not() {
        let wide = |values: &[f64]| Samples::F64(values.to_vec());
        assert!(is_same(&wide(&[0.0, 1.0, f64::NAN]), &wide(&[0.0, 1.0, f64::NAN])));
        assert!(!is_same(&wide(&[0.0, 1.0]), &wide(&[0.0, 1.5])));
        assert!(!is_same(&wide(&[0.0, 1.0]), &wide(&[0.0, 1.0, 2.0])));
        assert!(!is_same(&wide(&[2.0, 2.0]), &wide(&[2.0, 2.0])), "both are dead");
        assert!(!is_same(&wide(&[]), &wide(&[])));
        assert!(!is_same(&wide(&[0.0, 1.0]), &Samples::F32(vec![0.0, 1.0])));
    }
}
