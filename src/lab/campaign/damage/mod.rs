//! A number to a kind of damage and its size, and what it does to a drop, its recording or what is stated of it.

mod chain;
mod samples;
mod stated;

use super::Case;
use super::draw::Wish;
use crate::lab::data::SyntheticRecording;

/// One kind of damage.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    pub name: &'static str,
    /// From small to gross, in `unit`.
    pub sizes: &'static [f64],
    pub unit: &'static str,
    /// What the drop must be like.
    pub wish: fn(f64) -> Wish,
    /// What it does to scene and cask file.
    pub before: fn(&mut Case, f64),
    /// What it does to the recorded samples.
    pub after: fn(&mut Case, &mut SyntheticRecording, f64),
}

/// A kind that does nothing yet.
const SOUND: Kind = Kind {
    name: "",
    sizes: &[0.0],
    unit: "",
    wish: |_| Wish { slow_recorder: true, ..Wish::new() },
    before: |_, _| {},
    after: |_, _, _| {},
};

/// A record with the rest before the release in it, or without.
fn rest(is_shown: bool) -> Wish {
    Wish { rest: Some(is_shown), slow_recorder: true, ..Wish::new() }
}

/// All kinds.
fn all() -> impl Iterator<Item = &'static Kind> + Clone {
    chain::KINDS.iter().chain(samples::KINDS).chain(stated::KINDS)
}

/// Names of all kinds, and their sizes with the unit.
pub fn kinds() -> impl Iterator<Item = (&'static str, &'static [f64], &'static str)> {
    all().map(|kind| (kind.name, kind.sizes, kind.unit))
}

/// What is wrong with damaged scene `number`: kinds take turns, then sizes.
pub(super) fn of(number: u32) -> (&'static Kind, f64) {
    let number = usize::try_from(number).unwrap_or(0);
    let count = all().count();
    let kind = all().nth(number % count).unwrap_or(&SOUND);
    (kind, kind.sizes[(number / count) % kind.sizes.len()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_kind_has_a_name_of_its_own_and_sizes_that_grow() {
        let names: BTreeSet<&str> = all().map(|kind| kind.name).collect();
        assert_eq!(names.len(), all().count());
        for kind in all() {
            assert!(!kind.sizes.is_empty(), "{}", kind.name);
            assert!(kind.sizes.windows(2).all(|pair| pair[0] < pair[1]), "{}", kind.name);
        }
    }

    #[test]
    fn numbers_go_through_all_kinds_and_sizes() {
        let count = u32::try_from(all().count()).expect("some");
        let most = all().map(|kind| kind.sizes.len()).max().expect("some");
        let seen: BTreeSet<(&str, u64)> = (0..count * u32::try_from(most).expect("some"))
            .map(|n| (of(n).0.name, of(n).1.to_bits()))
            .collect();
        assert_eq!(seen.len(), all().map(|kind| kind.sizes.len()).sum::<usize>());
    }
}
