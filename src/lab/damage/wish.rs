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
    /// The contact of L, as it is where the kind does not change it.
    pub contact: Option<Contact>,
    /// Whether there is an axial channel; `None`: as it comes.
    pub axial: Option<bool>,
    /// Whether the rest before the release is recorded; `None`: as it comes.
    pub rest: Option<bool>,
    /// Two transverse channels on the first end.
    pub third_channel: bool,
    /// The kind that it is for, and its size; empty for an undamaged drop.
    pub kind: &'static str,
    /// See `kind`.
    pub size: f64,
}

impl Wish {
    /// Of words such as "friction no_axial", for a damage of this size.
    pub(super) fn of(words: &str, size: f64) -> Self {
        let has = |word: &str| words.split(' ').any(|one| one == word);
        let either = |yes: &str, no: &str| has(yes).then_some(true).or(has(no).then_some(false));
        let flights = [("lands_again", BetweenImpacts::LandsAgain), ("short_flight", BetweenImpacts::Short)];
        let contacts = [
            ("friction", Contact::Coulomb(size)),
            ("stated_rough", Contact::Rough),
            ("unstated", Contact::Unknown),
        ];
        Self {
            flight: flights.iter().find(|(word, _)| has(word)).map(|(_, flight)| *flight).unwrap_or_default(),
            contact: contacts.iter().find(|(word, _)| has(word)).map(|(_, contact)| *contact),
            axial: either("axial", "no_axial"),
            rest: either("rest", "no_rest"),
            third_channel: has("third_channel"),
            ..Self::default()
        }
    }
}
