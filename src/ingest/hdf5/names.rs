//! Names of attributes and datasets to what they say of samples.

use crate::ingest::factors;
use crate::ingest::vocabulary::{self, Meaning, has_part, plain};

/// What an attribute says of samples, apart from their rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::ingest) enum AttributeRole {
    Unit,
    /// When the first of them was taken, in s or what the name says.
    Start,
    /// The same in a unit that stands beside it.
    OpenStart,
    Scale,
    Offset,
    /// A stored value that stands for a missing sample.
    Fill,
    /// That stored numbers of a signed type are meant without sign.
    Unsigned,
    /// The least, the largest, or both, of the stored numbers that are samples.
    Valid,
    /// What each column holds.
    Columns,
    /// How counts become volts or g in the recorder's own program; nothing here does it.
    Conversion,
    /// The same where the samples are whole numbers, else plain facts of the recorder.
    CountsConversion,
}

/// Names, so written as [`plain`] has them. Scale factor, add offset, fill and missing value are those of the
/// CF conventions of netCDF, conversion is that of NWB, unit string that of LabVIEW. Other names hold parts
/// of the last: `calibration_date`, `trigger_slope`.
const ROLES: [(&str, AttributeRole); 10] = [
    ("t0 startingtime wfstartoffset", AttributeRole::Start),
    ("starttime timestart starttimestamp wfstarttime x0 xorg", AttributeRole::OpenStart),
    ("unit units unitstring physicalunit", AttributeRole::Unit),
    ("scale scalefactor conversion", AttributeRole::Scale),
    ("offset addoffset", AttributeRole::Offset),
    ("fillvalue missingvalue", AttributeRole::Fill),
    ("columns columnnames channelnames", AttributeRole::Columns),
    ("unsigned", AttributeRole::Unsigned),
    ("validrange validmin validmax", AttributeRole::Valid),
    (
        "cal calib calibration coeffs coefficient coefficients factor slope multiplier",
        AttributeRole::Conversion,
    ),
];

/// Parts of the names of conversions (`binToVoltFactor` of Elsys' TPC5 is one), and of those of counts on a
/// dataset itself: on a group they may be of anything.
const CONVERSIONS: [(&str, AttributeRole); 2] = [
    (
        "tovolt tophysical conversion perbit percount lsb gain calfactor calibrationfactor scalingfactor",
        AttributeRole::Conversion,
    ),
    ("range slope factor resolution", AttributeRole::CountsConversion),
];

/// What an attribute of this name says, `distance` groups above the samples.
pub(in crate::ingest) fn role(name: &str, distance: usize) -> Option<AttributeRole> {
    let [whole, bare] = [name, vocabulary::split(name).0].map(plain);
    let is_in = |names: &str, name: &str| names.split(' ').any(|known| known == name);
    let known = ROLES.iter().find(|(names, _)| is_in(names, &whole));
    let part = CONVERSIONS[..2 - distance.min(1)].iter().find(|(parts, _)| has_part(parts, &whole));
    let start = ROLES[..2].iter().any(|(names, _)| is_in(names, &bare)).then_some(AttributeRole::Start);
    known.map(|known| known.1).or(start).or(part.map(|part| part.1))
}

/// Whether an attribute of this name states a rate or an interval.
pub(super) fn rate_meaning(name: &str) -> Option<Meaning> {
    vocabulary::meaning(name).filter(|meaning| *meaning != Meaning::Count)
}

/// Whether an attribute of this name states a unit, of the samples or of another attribute.
pub(super) fn ends_in_unit(name: &str) -> bool {
    plain(name).trim_end_matches('s').ends_with("unit")
}

/// Whether `unit` names the unit of what `name` names: `sample_rate_unit` that of `sample_rate`, `XUnits`
/// that of `XInc` and `XOrg`.
pub(super) fn is_unit_of(unit: &str, name: &str) -> bool {
    let (unit, name) = (plain(unit), plain(name));
    let bare = unit.trim_end_matches('s').trim_end_matches("unit");
    bare == name || bare.len() == 1 && ["0", "inc", "org"].contains(&name.replace(bare, "").as_str())
}

/// The attribute by which MATLAB says what a dataset of numbers stands for.
pub(super) const MATLAB_CLASS: &str = "MATLAB_class";

/// Whether an attribute of this name says something of samples; NWB has the rate as `rate` of
/// `starting_time`.
pub(super) fn is_read(name: &str) -> bool {
    ends_in_unit(name)
        || ["rate", MATLAB_CLASS].contains(&name)
        || role(name, 0).is_some()
        || rate_meaning(name).is_some()
        || factors::is_factor(name)
}

/// Those names first that say something of samples; a number of any other name may be a factor of them.
pub(super) fn likeliest(mut names: Vec<String>) -> Vec<String> {
    /// No place says more of its samples.
    const MOST: usize = 256;
    names.sort_by_key(|name| !is_read(name));
    names.truncate(MOST);
    names
}

/// Whether a dataset or field of this name is one of times; `axis1` is the index of a pandas frame.
pub(super) fn is_time(name: &str) -> bool {
    let last = name.rsplit_once('.').map_or(name, |(_, last)| last);
    last == "axis1" || vocabulary::is_time(vocabulary::split(last).0)
}

/// Whether a dataset or field of this name says of which sensor each sample is.
pub(super) fn is_sensor(name: &str) -> bool {
    vocabulary::is_sensor_of_rows(name.rsplit('.').next().unwrap_or_default())
}
