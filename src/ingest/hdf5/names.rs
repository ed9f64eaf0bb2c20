//! Names of attributes and datasets to what they say of samples.

use crate::ingest::vocabulary::{self, Meaning};

/// What an attribute says of samples, apart from their rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AttributeRole {
    Unit,
    Start,
    Scale,
    Offset,
    /// A stored value that stands for a missing sample.
    Fill,
    /// How counts become volts or g in the recorder's own program; nothing here does it.
    Conversion,
}

/// `scale_factor`, `add_offset`, `_FillValue` and `missing_value` are those of the CF conventions of netCDF.
const ROLES: [(&str, AttributeRole); 9] = [
    ("unit", AttributeRole::Unit),
    ("units", AttributeRole::Unit),
    ("start_time_s", AttributeRole::Start),
    ("scale", AttributeRole::Scale),
    ("scale_factor", AttributeRole::Scale),
    ("offset", AttributeRole::Offset),
    ("add_offset", AttributeRole::Offset),
    ("_FillValue", AttributeRole::Fill),
    ("missing_value", AttributeRole::Fill),
];

/// Parts of the names of conversions, in lower case without what parts their words: `binToVoltFactor` of Elsys' TPC5 is one.
const CONVERSIONS: [&str; 6] = ["tovolt", "tophysical", "conversion", "perbit", "percount", "lsb"];

/// The same on a dataset itself; on a group they may be of anything.
const OWN_CONVERSIONS: [&str; 5] = ["range", "gain", "slope", "factor", "resolution"];

/// What an attribute of this name says, `distance` groups above the samples.
pub(super) fn role(name: &str, distance: usize) -> Option<AttributeRole> {
    if let Some((_, role)) = ROLES.iter().find(|(known, _)| *known == name) {
        return Some(*role);
    }
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let own = OWN_CONVERSIONS.iter().filter(|_| distance == 0);
    CONVERSIONS.iter().chain(own).any(|part| plain.contains(part)).then_some(AttributeRole::Conversion)
}

/// Whether an attribute of this name states a rate or an interval.
pub(super) fn rate_meaning(name: &str) -> Option<Meaning> {
    vocabulary::meaning(name).filter(|meaning| *meaning != Meaning::Count)
}

/// Whether an attribute of this name says something of samples.
pub(super) fn is_read(name: &str) -> bool {
    role(name, 0).is_some() || rate_meaning(name).is_some()
}

/// Whether a dataset or field of this name is one of times.
pub(super) fn is_time(name: &str) -> bool {
    let last = name.rsplit_once('.').map_or(name, |(_, last)| last);
    vocabulary::is_time(vocabulary::split(last).0)
}
