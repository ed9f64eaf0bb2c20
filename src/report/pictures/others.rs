//! The channels that take no part in the motion to a curve and a spectrum each.

use super::curves::{panel, points};
use super::draw::{Picture, Plate};
use super::panel::{self, COLOURS, Curve, Panel, PanelAxis};
use crate::data::{Analysis, OtherCurve};

const CAPTION: &str = "As recorded, neither filtered nor with an offset removed: each channel over time, and \
                       its one-sided amplitude spectrum over the same time without the mean, up to half the \
                       sample rate.";

/// The curve and the spectrum of each, one below the other.
pub(super) fn picture(analysis: &Analysis) -> Picture {
    let of_channel = |(i, curve): (usize, &OtherCurve)| {
        let line = |points| Curve::new(COLOURS[i % COLOURS.len()], points);
        let OtherCurve { channel, unit, .. } = curve;
        let over_time = vec![line(points(&curve.time_s, &curve.values, 1.0))];
        let spectrum = line(panel::points(&curve.frequency_hz, &curve.magnitude, [1.0, 1.0]));
        let magnitude = PanelAxis::new(format!("magnitude, {unit} s")).logarithmic();
        let frequency = PanelAxis::new("frequency, Hz").logarithmic();
        let spectrum = Panel {
            lines: vec![Curve { stroke: 3, ..spectrum }],
            ..Panel::new(format!("{channel}, spectrum"), frequency, magnitude, 300)
        };
        [panel(analysis, channel, unit, over_time), spectrum]
    };
    let panels: Vec<Panel> = analysis.curves.others.iter().enumerate().flat_map(of_channel).collect();
    Plate::new("other_channels", "Other channels", CAPTION).picture(&panels)
}
