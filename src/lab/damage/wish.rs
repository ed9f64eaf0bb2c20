//! Words of the table to what a damage needs of the drop that it strikes.

use crate::data::Contact;

/// What happens between the two impacts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in super::super) enum BetweenImpacts {
    /// L flies until R strikes.
    #[default]
    Free,
    /// L touches again before.
    LandsAgain,
    /// The same as free, for so short a time that no undamaged drop has it.
    Short,
}

/// What a damage needs of the drop that it strikes; by default nothing, as of an undamaged one.
#[derive(Debug, Clone, Copy, Default)]
pub(in super::super) struct Wish {
    /// What happens between the impacts.
    pub flight: BetweenImpacts,
    /// The contact of L, as it is.
    pub contact: Option<Contact>,
    /// Whether there is an axial channel; `None`: as it comes.
    pub axial: Option<bool>,
    /// Whether the rest before the release is recorded; `None`: as it comes.
    pub rest: Option<bool>,
    /// Two transverse channels on the first end.
    pub third_channel: bool,
    /// Nothing that makes thousands of samples more than the damage needs.
    pub slow_recorder: bool,
}

impl Wish {
    /// Of words such as "friction no_axial", for a damage of this size.
    pub(super) fn of(words: &str, size: f64) -> Self {
        let has = |word: &str| words.split(' ').any(|one| one == word);
        let either = |yes: &str, no: &str| has(yes).then_some(true).or(has(no).then_some(false));
        Self {
            flight: match () {
                () if has("lands_again") => BetweenImpacts::LandsAgain,
                () if has("short_flight") => BetweenImpacts::Short,
                () => BetweenImpacts::Free,
            },
            contact: has("friction").then_some(Contact::Coulomb(size)),
            axial: either("axial", "no_axial"),
            rest: either("rest", "no_rest"),
            third_channel: has("third_channel"),
            slow_recorder: true,
        }
    }
}
