//! Points of a trial to families that share a chart, and what their classes show.

use crate::lab::data::{Trial, TrialPoint};

/// Points that share a chart: one purpose, one unit of the error, one of the time.
pub(super) struct Family<'a> {
    pub(super) name: &'a str,
    pub(super) error_unit: &'a str,
    pub(super) time_per: &'a str,
    /// Each with whether it is on the front.
    pub(super) points: Vec<(&'a TrialPoint, bool)>,
}

impl<'a> Family<'a> {
    /// Methods in the order in which they first stand.
    pub(super) fn methods(&self) -> Vec<&'a str> {
        distinct(self.points.iter().map(|(p, _)| p.method.as_str()))
    }

    /// Classes in the order in which they first stand.
    pub(super) fn classes(&self) -> Vec<&'a str> {
        distinct(self.points.iter().map(|(p, _)| p.class.as_str()))
    }

    /// The points of a class.
    pub(super) fn of_class(&self, class: &str) -> Vec<(&'a TrialPoint, bool)> {
        self.points.iter().filter(|(p, _)| p.class == class).copied().collect()
    }

    /// Classes in which the default is not on the front.
    pub(super) fn beaten(&self) -> Vec<&'a str> {
        let beaten = self.points.iter().filter(|(p, on_front)| p.is_default && !on_front);
        distinct(beaten.map(|(p, _)| p.class.as_str()))
    }

    /// Rivals in the program that are on the front of no class.
    pub(super) fn never_on_front(&self) -> Vec<&'a str> {
        let on = |method: &&str| {
            self.points.iter().any(|(p, on_front)| p.method == *method && (*on_front || p.is_default))
        };
        self.methods().into_iter().filter(|method| !on(method) && !self.is_peer(method)).collect()
    }

    /// Whether this method is a program of others.
    pub(super) fn is_peer(&self, method: &str) -> bool {
        self.points.iter().any(|(p, _)| p.method == method && p.is_peer())
    }

    /// A name for files.
    pub(super) fn file_name(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        let name: String = self.name.chars().map(plain).collect();
        format!("speed-{}", name.trim_matches('-'))
    }
}

fn distinct<'a>(words: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for word in words {
        if !found.contains(&word) {
            found.push(word);
        }
    }
    found
}

/// The families in the order in which they first stand.
pub(super) fn families(trial: &Trial) -> Vec<Family<'_>> {
    let mut families: Vec<Family> = Vec::new();
    let fronts = trial.is_on_front.iter().copied().chain(std::iter::repeat(false));
    for (point, on_front) in trial.points.iter().zip(fronts) {
        let same = |f: &&mut Family| {
            f.name == point.family && f.error_unit == point.error_unit && f.time_per == point.time_per
        };
        match families.iter_mut().find(same) {
            Some(family) => family.points.push((point, on_front)),
            None => families.push(Family {
                name: &point.family,
                error_unit: &point.error_unit,
                time_per: &point.time_per,
                points: vec![(point, on_front)],
            }),
        }
    }
    families
}
