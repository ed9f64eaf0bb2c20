//! The table of damages, and drops with them: with a size that the campaign draws, or with one that grows
//! until the analysis fails.

mod chain;
mod samples;
mod stated;
mod wish;

use super::data::{BendingMode, KnownSilence, SyntheticRecording};
use super::drawn::{DrawnDrop, DropPlan};
use std::sync::LazyLock;
pub(super) use wish::{BetweenImpacts, Wish};

/// A row of `damages.tsv`: one damage to a recording or its cask file, or one property that makes a drop
/// difficult.
pub struct DamageKind {
    /// Object of the damage: "chain", "samples" or "stated" (the cask file); "flight": a drop with such a
    /// flight; "drop": a drop that grows more difficult; "sound": no damage, a rare kind of sound drop, which
    /// should pass.
    of: &'static str,
    /// Name of the kind.
    pub name: &'static str,
    /// Unit of the sizes; empty if there is only one size.
    pub unit: &'static str,
    /// Sizes from small to gross, for the campaign to draw from; empty: not in the campaign.
    pub sizes: Vec<f64>,
    /// Requirements on the drop, in words of [`Wish::parse`].
    needs: &'static str,
    /// Codes of findings, one of which must name the damage if it is gross; empty: no finding is required.
    pub(super) expected_codes: Vec<&'static str>,
    /// Sizes from harmless to gross: 13, 7, 4 or 1 of them; empty: does not grow.
    pub(super) growing: Vec<f64>,
    /// Measurement at the site that replaces what the recording may not show; empty if it does.
    pub(super) instead: &'static str,
    /// Description for a reader.
    pub(super) what: &'static str,
}

static TABLE: LazyLock<Vec<DamageKind>> = LazyLock::new(|| {
    let lines = include_str!("damages.tsv").lines();
    lines.filter(|line| !line.is_empty() && !line.starts_with('#')).map(DamageKind::from_line).collect()
});

/// Kinds that the campaign draws from, of damage and of sound drops, in the order of its numbers.
pub fn campaign_kinds() -> impl Iterator<Item = &'static DamageKind> {
    TABLE.iter().filter(|kind| !kind.sizes.is_empty())
}

/// The kinds that grow.
pub(super) fn growing_kinds() -> impl Iterator<Item = &'static DamageKind> {
    TABLE.iter().filter(|kind| !kind.growing.is_empty())
}

/// The kind with this name.
pub(super) fn find_kind(name: &str) -> Option<&'static DamageKind> {
    TABLE.iter().find(|kind| kind.name == name)
}

/// Result of the recorded full run for the damage of this name, if it was silent.
pub(super) fn known_silence(name: &str) -> Option<KnownSilence> {
    let rows = include_str!("silent.tsv").lines().filter_map(|line| line.split_once('\t'));
    let (_, cells) = rows.into_iter().find(|(own, _)| *own == name)?;
    let (becomes, off) = cells.split_once('\t')?;
    Some(KnownSilence { becomes, off })
}

impl DamageKind {
    /// Reads a line of cells between tabs; "-" is an empty cell.
    fn from_line(line: &'static str) -> Self {
        let mut cells = line.split('\t').map(|cell| if cell == "-" { "" } else { cell });
        let mut next = || cells.next().unwrap_or_default();
        let numbers =
            |cell: &str| cell.split_whitespace().map(|n| n.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
        Self {
            of: next(),
            name: next(),
            unit: next(),
            sizes: numbers(next()),
            needs: next(),
            expected_codes: next().split_whitespace().collect(),
            growing: numbers(next()),
            instead: next(),
            what: next(),
        }
    }

    /// True if the kind is not damage: its drops should pass, and their intervals hold.
    pub fn is_sound(&self) -> bool {
        self.of == "sound"
    }

    /// Requirements on a drop with damage of this size.
    pub(super) fn wish(&self, size: f64) -> Wish {
        Wish { kind: self.name, size, ..Wish::parse(self.needs, size) }
    }

    /// Damages the drop and its cask file, then its recording.
    pub(super) fn apply(&self, drop: &mut DrawnDrop, size: f64) -> SyntheticRecording {
        stated::apply(self.name, drop, size);
        chain::apply(self.name, drop, size);
        let mut recording = drop.record();
        samples::apply(self.name, drop, &mut recording, size);
        recording
    }

    /// The drop of a sound plan, and its recording, with damage of this size.
    pub(super) fn grow(&self, plan: &DropPlan, size: f64) -> (DrawnDrop, SyntheticRecording) {
        let mut plan = plan.clone();
        harden(self.name, &mut plan, size);
        let wish = self.wish(size);
        plan.contact = wish.contact.unwrap_or(plan.contact);
        let mut drop = plan.draw_with(|scene, stated, chance| wish.equip(scene, stated, chance));
        let recording = self.apply(&mut drop, size);
        (drop, recording)
    }
}

/// A mode must show this many periods in a flight to be determined by itself.
const CLEAR_PERIODS: f64 = 3.0;

/// Makes a sound plan more difficult; a kind of damage has no effect.
fn harden(kind: &str, plan: &mut DropPlan, size: f64) {
    let flight_s = if kind.contains("mode") { plan.flight_s() } else { 1.0 };
    let clear = DropPlan::mode(1, CLEAR_PERIODS / flight_s);
    if kind.contains("mode") {
        plan.elastic = None;
    }
    match kind {
        "mode_frequency" => plan.modes = vec![DropPlan::mode(1, size / flight_s)],
        "mode_damping" => plan.modes = vec![BendingMode { damping: size, ..clear }],
        "close_modes" => {
            plan.modes = vec![clear, DropPlan::mode(2, clear.frequency_hz * (1.0 + size / 100.0))];
        }
        "mode_strength" => plan.modes = vec![BendingMode { strength: size, ..clear }],
        "k_small" => plan.ends[0].restitution = size,
        "k_large" => plan.ends[0].restitution = 1.0 - size,
        "pulse" => plan.ends[0].duration_s = 1e-3 * size,
        "angle_small" | "angle_large" => plan.angle_deg = size,
        "recontact" => (plan.ends[0].restitution, plan.angle_deg) = (0.1, size),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawn::ANF_18;
    use super::*;
    use crate::data::Contact;
    use std::collections::BTreeSet;

    #[test]
    fn every_kind_has_a_name_of_its_own_and_sizes_that_grow() {
        let names: BTreeSet<&str> = TABLE.iter().map(|kind| kind.name).collect();
        assert_eq!(names.len(), TABLE.len());
        for DamageKind { name, sizes, growing, what, .. } in TABLE.iter() {
            assert!(!what.is_empty() && sizes.len() + growing.len() > 0, "{name}");
            assert!(sizes.iter().chain(growing).all(|size| size.is_finite()), "{name}");
            assert!(sizes.windows(2).all(|pair| pair[0] < pair[1]), "{name}");
            // The quick run takes every third: it holds the first and the last.
            assert!([0, 1, 4, 7, 13].contains(&growing.len()), "{name}");
            assert!(growing.is_sorted() || growing.iter().rev().is_sorted(), "{name}");
        }
    }

    #[test]
    fn what_is_known_to_be_silent_grows_and_says_what_to_measure() {
        let rows: Vec<&str> = include_str!("silent.tsv").lines().skip(1).collect();
        assert!(!rows.is_empty());
        for row in rows {
            let name = row.split('\t').next().expect("a name");
            let kind = growing_kinds().find(|kind| kind.name == name).expect(name);
            let known = known_silence(name).expect(name);
            assert!(known.becomes.starts_with("unnoticed from") && known.off.parse::<f64>().is_ok(), "{row}");
            assert!(!kind.instead.is_empty(), "{name}");
        }
    }

    #[test]
    fn every_kind_does_something() {
        let mut plan = DropPlan::new(ANF_18, 15.0, 0.5, 1);
        plan.rate_hz = 5e3;
        plan.contact = Contact::Coulomb(0.25);
        plan.chain.anti_alias_hz = Some(4e3);
        let sound = || {
            let mut drop = plan.draw();
            drop.scene.channels.push(drop.scene.channels[0].clone());
            drop.stated.channels.push(drop.stated.channels[0].clone());
            drop
        };
        let describe = |drop: &DrawnDrop, recording: &SyntheticRecording| {
            format!("{:?} {:?} {recording:?}", drop.scene, drop.stated)
        };
        let untouched = describe(&sound(), &sound().record());
        for kind in TABLE.iter() {
            let size = kind.sizes.last().or(kind.growing.last()).copied().expect("a size");
            let mut struck = sound();
            let is_struck = {
                let recording = kind.apply(&mut struck, size);
                describe(&struck, &recording) != untouched
            };
            let is_hard = !kind.growing.is_empty() && {
                let (hard, recording) = kind.grow(&plan, size);
                assert!(!recording.channels.is_empty());
                format!("{:?}", hard.scene) != format!("{:?}", plan.draw().scene)
            };
            let mut made = sound();
            kind.wish(size).fulfil(&mut made.scene, &mut made.stated, &mut made.chance);
            let is_made = describe(&made, &made.record()) != untouched;
            let is_wished = Wish::parse(kind.needs, size).flight != BetweenImpacts::Free;
            assert_eq!(is_struck, !["drop", "flight"].contains(&kind.of) && !is_made, "{}", kind.name);
            assert!(is_struck || is_hard || is_made || is_wished, "{}", kind.name);
        }
    }
}
