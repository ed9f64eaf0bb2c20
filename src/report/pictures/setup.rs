//! Drawing of the set-up from a cask file: cask, angle, ends and sensors, to scale.

use super::draw::{Figure, Picture};
use super::panel::{COLOURS, Colour, Curve, INK, WIDTH};
use super::svg::{Anchor, Svg};
use crate::data::{Axis, CaskFile, ChannelSpec};
use crate::numerics::as_f64;
use crate::report::rounding::plain;

/// Room around the cask, and its height at the most, in units of the drawing.
const MARGIN: f64 = 120.0;
const ABOVE: f64 = 60.0;
const HEIGHT: f64 = 640.0;
/// A thin rod is drawn as thick as this share of its length.
const ROD: f64 = 0.01;
const ARROW: f64 = 70.0;
/// Half the width of the words at the first end, which a flat cask has at the edge.
const HALF_LABEL: f64 = 170.0;
const PAPER: Colour = Colour(245, 247, 249);

/// Maps places on the cask, in metres from L's lower corner along the axis and across it, to the drawing.
struct OnCask {
    scale: f64,
    direction: (f64, f64),
    foot: (f64, f64),
}

impl OnCask {
    fn to_drawing(&self, along_m: f64, across_m: f64) -> (f64, f64) {
        let (cos, sin) = self.direction;
        let (x, y) = (along_m * cos - across_m * sin, along_m * sin + across_m * cos);
        (self.foot.0 + self.scale * x, self.foot.1 - self.scale * y)
    }

    /// Moves a place in the drawing by this much, in a direction on the cask.
    fn offset(&self, from: (f64, f64), (along, across): (f64, f64), units: f64) -> (f64, f64) {
        let (cos, sin) = self.direction;
        (from.0 + units * (along * cos - across * sin), from.1 - units * (along * sin + across * cos))
    }
}

/// Cask, target, ends and sensors, each with the direction in which it reads positive.
pub(in super::super) fn picture(file: &CaskFile) -> Picture {
    let (cask, drop) = (&file.cask, &file.drop);
    let section_m = if cask.height_m > 0.0 { cask.height_m } else { ROD * cask.length_m };
    let (sin, cos) = drop.angle_rad.sin_cos();
    let wide_m = cask.length_m * cos + section_m * sin;
    let high_m = cask.length_m * sin + section_m * cos;
    let scale = ((WIDTH - 2.0 * MARGIN) / wide_m).min(HEIGHT / high_m);
    let ground = ABOVE + scale * high_m;
    let left = (WIDTH - scale * wide_m) / 2.0 + scale * section_m * sin;
    let place = OnCask { scale, direction: (cos, sin), foot: (left, ground) };
    let mut svg = Svg::default();
    svg.line(&Curve { stroke: 6, ..Curve::new(INK, vec![(60.0, ground), (WIDTH - 60.0, ground)]) });
    svg.word("target", (WIDTH - 60.0, ground + 26.0), Anchor::End);
    let corners =
        [(0.0, 0.0), (cask.length_m, 0.0), (cask.length_m, section_m), (0.0, section_m), (0.0, 0.0)]
            .map(|(along_m, across_m)| place.to_drawing(along_m, across_m));
    svg.area(&corners[..4], PAPER, 1.0);
    svg.line(&Curve::new(INK, corners.to_vec()));
    let angle = plain(drop.angle_rad.to_degrees(), 4);
    let first = format!("first end, L, {angle}° to the target");
    svg.word(&first, (left.max(HALF_LABEL), ground + 26.0), Anchor::Middle);
    let second = place.to_drawing(cask.length_m, section_m);
    svg.word("second end, R", (second.0, second.1 - 30.0), Anchor::Middle);
    let cog = place.to_drawing(cask.cog_m, section_m / 2.0);
    svg.circle(cog, 7, INK, Some(3));
    svg.word("S", (cog.0, cog.1 + 26.0), Anchor::Middle);
    for (i, spec) in file.channels.iter().enumerate() {
        let is_beside = |other: &&ChannelSpec| {
            (other.position_m - spec.position_m).abs() * scale < ARROW && other.end == spec.end
        };
        let before = file.channels[..i].iter().filter(is_beside).count();
        sensor(&mut svg, &place, spec, section_m, before);
    }
    let named = |spec: &ChannelSpec| format!("{} at {} m", spec.name, plain(spec.position_m, 5));
    let names: Vec<String> = file.channels.iter().map(named).collect();
    let caption = "To scale, as the cask file states it. Each sensor stands at its place; its arrow points \
                   to where its reading is positive, polarity included. S: centre of gravity.";
    let shown = format!("{} at {angle}°; {}", cask.name, names.join(", "));
    Figure::new("setup", "Set-up", caption).into_picture(svg, ground + 70.0, &shown)
}

/// Draws one sensor: its place, its positive direction, its name; `before` others stand beside it.
fn sensor(svg: &mut Svg, place: &OnCask, spec: &ChannelSpec, section_m: f64, before: usize) {
    let colour = COLOURS[usize::from(spec.axis != Axis::Transverse)];
    let at = place.to_drawing(spec.position_m, section_m / 2.0 + spec.offset_m);
    let direction = match spec.axis {
        Axis::Transverse => (0.0, spec.polarity),
        Axis::Axial => (spec.polarity, 0.0),
    };
    let tip = place.offset(at, direction, ARROW);
    let barb = |side: f64| {
        place.offset(tip, (-direction.0 + side * direction.1, -direction.1 + side * direction.0), 16.0)
    };
    svg.circle(at, 9, colour, None);
    for points in [vec![at, tip], vec![barb(0.6), tip, barb(-0.6)]] {
        svg.line(&Curve::new(colour, points));
    }
    // The name goes below the sensor, and below the names of those beside it.
    let below = 28.0 + 26.0 * as_f64(before);
    svg.word(&spec.name, (at.0, at.1 + below), Anchor::Middle);
}
