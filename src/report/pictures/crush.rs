//! Both impacts to the force of the target over how far the corner was crushed.

use super::draw::{Picture, Plate};
use super::panel::{COLOURS, Curve, Panel, PanelAxis};
use crate::data::{Analysis, End, ImpactTable};

/// The force over crush of either end, from touching to leaving as far as the recording goes.
pub(super) fn picture(analysis: &Analysis) -> Picture {
    let line = |impact: &ImpactTable| {
        let curve = &impact.force_over_crush;
        let points = curve.crush_m.iter().zip(&curve.force_n).map(|(m, n)| (m * 1e3, n * 1e-6)).collect();
        let (colour, name) = match impact.end {
            End::First => (COLOURS[0], "first end"),
            End::Second => (COLOURS[1], "second end"),
        };
        Curve::new(colour, points).named(name)
    };
    let panel = Panel {
        title: "Force over crush".to_owned(),
        x: PanelAxis::new("crush of the corner, mm"),
        y: PanelAxis::new("vertical force, MN"),
        height: 350,
        lines: analysis.result.impacts.iter().map(line).filter(|line| !line.points.is_empty()).collect(),
        ..Panel::default()
    };
    let filter = &analysis.result.impacts[0].rigid_body_deceleration.filter;
    let caption = format!(
        "Vertical force of the target, the stated mass times the acceleration of S through the low-pass {filter}, over how far the corner of \
         the undeformed cask is below where it touched. The area within is about what the contact takes."
    );
    Plate::new("crush", "Force over crush", caption).picture(&[panel])
}
