//! The wanted columns of a table in memory: each value, or of times on an even grid their rule.

use super::super::times::Counted;
use super::even::Even;
use crate::ingest::counting::with_missing;
use std::borrow::Cow;

/// One wanted column.
#[derive(Debug, Clone, Default)]
pub(super) struct HeldColumn {
    /// The rule that all values keep, where they keep to one.
    pub even: Option<Even>,
    /// The values; none where they keep to a rule.
    pub each: Vec<f64>,
}

impl HeldColumn {
    /// Takes the next values; `is_time`: those of rising times, which may keep to a rule.
    pub(super) fn extend(&mut self, values: &[f64], is_time: bool) {
        if is_time && self.even.is_none() && self.each.is_empty() {
            self.even = Even::of(values);
        }
        match &mut self.even {
            Some(even) if even.keeps(values) => even.count += values.len(),
            _ => self.each_mut().extend_from_slice(values),
        }
    }

    /// How many values it holds.
    pub(super) fn len(&self) -> usize {
        self.even.map_or(self.each.len(), |even| even.count)
    }

    /// The values, whether or not they keep to a rule.
    pub(super) fn values(&self) -> Cow<'_, [f64]> {
        self.even.map_or(Cow::Borrowed(&self.each), |even| Cow::Owned(even.values().collect()))
    }

    /// The values, written out.
    pub(super) fn each_mut(&mut self) -> &mut Vec<f64> {
        if let Some(even) = self.even.take() {
            self.each.extend(even.values());
        }
        &mut self.each
    }

    /// What the bare numbers say of the time that they count.
    pub(super) fn counted(&self) -> Option<Counted> {
        self.even.map_or_else(|| Counted::of(&self.each), |even| even.counted())
    }

    /// Puts in rows without a value, so many behind each row that is named.
    pub(super) fn put_in(&mut self, missing: &[(usize, f64)]) {
        self.each = with_missing(self.each_mut(), missing);
    }

    /// The values times `scale`.
    pub(super) fn scale(&mut self, scale: f64) {
        match &mut self.even {
            Some(even) => even.scale *= scale,
            None if (scale - 1.0).abs() > 0.0 => self.each.iter_mut().for_each(|value| *value *= scale),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Samples;
    use crate::ingest::clock::Claims;
    use crate::ingest::time_base::{ChannelTimes, Uniform};
    use proptest::prelude::*;

    fn column(pieces: &[&[f64]]) -> HeldColumn {
        let mut column = HeldColumn::default();
        for piece in pieces {
            column.extend(piece, true);
        }
        column
    }

    /// Times as a recorder writes them: a rule in decimal digits.
    fn times(first: i64, step: i64, decimals: usize, count: i64) -> Vec<f64> {
        let digits = |value: i64| {
            let digits = format!("{:0>width$}", value.abs(), width = decimals + 1);
            let (whole, fraction) = digits.split_at(digits.len() - decimals);
            format!("{}{whole}.{fraction}", if value < 0 { "-" } else { "" }).parse().unwrap()
        };
        (0..count).map(|i| digits(first + i * step)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

        #[test]
        fn even_times_are_a_rule_and_come_back_to_the_bit(
            first in -1_000_000_i64..1_000_000_000,
            step in 1_i64..100_000,
            decimals in 0_usize..10,
            cut in 2_usize..300,
            odd in proptest::option::of((0_usize..300, -1.0e-3_f64..1.0)),
        ) {
            // A negative zero is written by nobody and kept apart.
            prop_assume!(first >= 0 || (-first) % step != 0);
            let mut values = times(first, step, decimals, 300);
            if let Some((at, by)) = odd {
                values[at] += by;
            }
            let is_odd = values != times(first, step, decimals, 300);
            let held = column(&[&values[..cut], &values[cut..]]);
            prop_assert_eq!(held.even.is_some(), !is_odd);
            prop_assert_eq!((held.values(), held.len()), (Cow::Borrowed(&values[..]), 300));
            let mut spelled = held.clone();
            prop_assert_eq!(spelled.each_mut(), &values);
        }
    }

    #[test]
    fn a_rule_gives_the_base_of_its_times() {
        let values = times(-5, 2, 5, 1000);
        let mut samples = vec![1.0; 1000];
        samples[7] = f64::NAN;
        let even = column(&[&values]).even.expect("a rule");
        for declared_hz in [None, Some(50_010.0), Some(48_000.0)] {
            let claims = Claims::of_cask(declared_hz);
            let ours = even.place(Samples::F64(samples.clone()), &claims).unwrap();
            let theirs = ChannelTimes::new(&values).place(Samples::F64(samples.clone()), &claims).unwrap();
            assert!((ours.sample_rate_hz / theirs.sample_rate_hz - 1.0).abs() < 1e-12);
            assert_eq!((ours.start_s, &ours.gaps), (theirs.start_s, &theirs.gaps));
            let said = |uniform: &Uniform| {
                let mut said: Vec<_> = uniform.issues.iter().map(|issue| issue.message.clone()).collect();
                said.sort();
                said
            };
            assert_eq!(said(&ours), said(&theirs));
        }
        assert!(even.place(Samples::F64(vec![0.0; 999]), &Claims::default()).is_err());
    }

    #[test]
    fn a_rule_has_the_clock_of_its_times_in_any_unit() {
        let values = times(3, 20, 3, 500);
        let mut held = column(&[&values]);
        let (ours, theirs) = (held.counted().unwrap(), Counted::of(&values).unwrap());
        for (own, other) in [
            (ours.first, theirs.first),
            (ours.last, theirs.last),
            (ours.rate, theirs.rate),
            (ours.span, theirs.span),
        ] {
            assert!((own / other - 1.0).abs() < 1e-9, "{own} {other}");
        }
        for (first, counts) in [(7, true), (5, false)] {
            let values: Vec<f64> = (0..99).map(|i| f64::from(i) + f64::from(first) / 7.0).collect();
            let [ours, theirs] = [column(&[&values]).counted(), Counted::of(&values)]
                .map(|counted| counted.unwrap().is_counter);
            assert_eq!((ours, theirs), (counts, counts));
        }
        held.scale(1e-3);
        let even = held.even.expect("a rule");
        let last = even.values().last().unwrap();
        assert!((even.counted().unwrap().rate - 50_000.0).abs() < 1e-6 && (last - 9.983e-3).abs() < 1e-15);
    }

    #[test]
    fn times_that_do_not_rise_or_are_no_decimals_keep_no_rule() {
        for values in
            [vec![], vec![1.0], vec![1.0, 1.0], vec![2.0, 1.0], vec![0.0, 1.0 / 3.0], vec![f64::NAN, 1.0]]
        {
            assert_eq!(column(&[&values]).even, None, "{values:?}");
        }
    }
}
