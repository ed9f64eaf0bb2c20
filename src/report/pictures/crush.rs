//! Both impacts to the force of the target over how far the corner was crushed.

use super::draw::{Picture, Plate};
use super::panel::{COLOURS, Curve, Panel, points};
use crate::data::{Analysis, End, ImpactTable};

/// The force over crush of either end, from touching to leaving as far as the recording goes.
pub(super) fn picture(analysis: &Analysis) -> Picture {
    let line = |impact: &ImpactTable| {
        let curve = &impact.force_over_crush;
        let (colour, name) = match impact.end {
            End::First => (COLOURS[0], "first end"),
            End::Second => (COLOURS[1], "second end"),
        };
        Curve::new(colour, points(&curve.crush_m, &curve.force_n, [1e3, 1e-6])).named(name)
    };
    let lines = analysis.result.impacts.iter().map(line).filter(|line| !line.points.is_empty()).collect();
    let axes = Panel::new("Force over crush", "crush of the corner, mm", "vertical force, MN", 350);
    let filter = &analysis.result.impacts[0].rigid_body_deceleration.filter;
    let caption = format!(
        "Vertical force of the target, the stated mass times the acceleration of the centre of gravity \
         through the low-pass {filter}, over how far the corner of the undeformed cask is below where it \
         touched. The area within is about the energy that the contact absorbs."
    );
    Plate::new("crush", "Force over crush", caption).picture(&[Panel { lines, ..axes }])
}
