//! A cask file, checked.

use super::cask::{Cask, ChannelSpec, Contact, Drop, FilterChoice};
use super::other::OtherSpec;
use super::simulation::SimulationSpec;
use super::test_record::{Letterhead, Limit, Observed, TestRecord};
use super::tolerances::{Corrections, Tolerances};
use std::borrow::Cow;
use std::path::PathBuf;

/// A cask file, checked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CaskFile {
    /// The file.
    pub path: PathBuf,
    /// SHA-256 of the file, lower-case hexadecimal.
    pub sha256: String,
    /// Text of the file, with its byte-order mark; empty if there was no file.
    pub text: String,
    /// `[cask]`.
    pub cask: Cask,
    /// `[cask] scale`: length of the model over that of its prototype; `None` where it is no model.
    pub scale: Option<f64>,
    /// `[drop]`.
    pub drop: Drop,
    /// `[contact] friction`.
    pub contact: Contact,
    /// Duration of the first contact, s: `[contact] duration_s`, or the value that replaces it; `None` if not
    /// stated.
    pub contact_duration_s: Option<f64>,
    /// `[filter]`.
    pub filter: FilterChoice,
    /// `[tolerance]`.
    pub tolerances: Tolerances,
    /// `[corrections]`.
    pub corrections: Corrections,
    /// `[recording] time`.
    pub time: Option<String>,
    /// `[recording] rest`, relative to the working directory of the program.
    pub rest: Option<PathBuf>,
    /// `[[channel]]` of the accelerometers, in the file's order.
    pub channels: Vec<ChannelSpec>,
    /// `[[channel]]` with `end = "none"`, in the file's order.
    pub others: Vec<OtherSpec>,
    /// `[test]`.
    pub test: TestRecord,
    /// `[observed]`.
    pub observed: Vec<Observed>,
    /// `[limits]`.
    pub limits: Vec<Limit>,
    /// `[simulation]`.
    pub simulation: Option<SimulationSpec>,
    /// `[report]`.
    pub letterhead: Letterhead,
    /// True if an angular-rate sensor determines the rotation before the contact.
    pub is_rotation_measured: bool,
    /// Keys whose value is a default, as "table.key", so that the report can say so.
    pub defaults: Vec<String>,
}

impl CaskFile {
    /// The times that the file names for a channel, else those of the recording.
    pub fn time_source<'a>(&'a self, spec: &'a ChannelSpec) -> Option<&'a str> {
        spec.time.as_deref().or(self.time.as_deref())
    }

    /// 95 % half-width of a channel's scale, as a share: that of the channel, else that of all.
    pub fn scale_half_width(&self, channel: &str) -> f64 {
        let own = self.channels.iter().find(|spec| spec.name == channel).and_then(|spec| spec.calibration);
        own.unwrap_or(self.tolerances.calibration)
    }

    /// The file for readers of recordings: the other channels follow those of the motion.
    pub fn with_all_channels(&self) -> Cow<'_, Self> {
        if self.others.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut all = self.clone();
        all.channels.extend(self.others.iter().map(|other| other.read.clone()));
        Cow::Owned(all)
    }

    /// The file for one recorder: the channels of the recording that this key `file` names; for `None` those
    /// of the analysed recording.
    pub fn for_recorder(&self, file: Option<&str>) -> Cow<'_, Self> {
        let others = self.others.iter().map(|other| &other.read);
        if file.is_none() && self.channels.iter().chain(others).all(|spec| spec.file.is_none()) {
            return Cow::Borrowed(self);
        }
        let mut of_one = self.clone();
        of_one.channels.retain(|spec| spec.file.as_deref() == file);
        of_one.others.retain(|other| other.read.file.as_deref() == file);
        for spec in of_one.channels.iter_mut().chain(of_one.others.iter_mut().map(|other| &mut other.read)) {
            spec.file = None;
        }
        Cow::Owned(of_one)
    }

    /// True if the impulse ratio of L is open up to a bound: its friction is not stated, or without its
    /// tolerance.
    pub fn has_open_friction(&self) -> bool {
        let is_bound = || self.defaults.iter().any(|key| key == "tolerance.friction_percent");
        self.contact == Contact::Unknown || (matches!(self.contact, Contact::Coulomb(_)) && is_bound())
    }

    /// A file that states only cask, drop and contact, with the usual tolerances.
    pub fn new(cask: Cask, drop: Drop, contact: Contact) -> Self {
        Self { path: "cask.toml".into(), cask, drop, contact, ..Self::default() }
    }
}
