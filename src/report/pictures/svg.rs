//! Writes lines, areas, circles and words as the text of an SVG drawing, in units of half a pixel of the
//! page.

use super::super::text::sanitize;
use super::panel::{Colour, Curve, INK};
use std::fmt::{Arguments, Write};

/// Side of the words that stands at their place.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A drawing under way.
#[derive(Default)]
pub(super) struct Svg(String);

impl Svg {
    fn append(&mut self, text: Arguments) {
        // Writing to a string does not fail.
        let _ = self.0.write_fmt(text);
        self.0.push('\n');
    }

    /// Draws `paint`, with its places relative to `at`.
    pub(super) fn from(&mut self, at: (f64, f64), paint: impl FnOnce(&mut Self)) {
        self.append(format_args!("<g transform=\"translate({:.0},{:.0})\">", at.0, at.1));
        paint(self);
        self.append(format_args!("</g>"));
    }

    /// Draws `paint` within a rectangle from (0, 0), and at most half a stroke beyond it.
    pub(super) fn clip_to(&mut self, (width, height): (f64, f64), paint: impl FnOnce(&mut Self)) {
        const OVER: f64 = 4.0;
        let (width, height) = (width + 2.0 * OVER, height + 2.0 * OVER);
        let frame = format!("x=\"-{OVER}\" y=\"-{OVER}\" width=\"{width:.0}\" height=\"{height:.0}\"");
        self.append(format_args!("<svg {frame} viewBox=\"-{OVER} -{OVER} {width:.0} {height:.0}\">"));
        paint(self);
        self.append(format_args!("</svg>"));
    }

    /// A line in its colour; its points are places.
    pub(super) fn line(&mut self, line: &Curve) {
        let pieces = line
            .dash
            .pieces()
            .map_or_else(String::new, |[piece, gap]| format!(" stroke-dasharray=\"{piece} {gap}\""));
        let (colour, stroke, points) = (line.colour, line.stroke, places(&line.points));
        let opacity = opacity("stroke", line.opacity);
        self.append(format_args!(
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{stroke}\"{opacity}{pieces} \
             points=\"{points}\"/>"
        ));
    }

    /// An area in its colour.
    pub(super) fn area(&mut self, corners: &[(f64, f64)], colour: Colour, share: f64) {
        let (points, opacity) = (places(corners), opacity("fill", share));
        self.append(format_args!("<polygon fill=\"{colour}\"{opacity} points=\"{points}\"/>"));
    }

    /// A circle, full or as a stroke of this width.
    pub(super) fn circle(&mut self, (x, y): (f64, f64), radius: i32, colour: Colour, stroke: Option<u32>) {
        let look = stroke.map_or_else(
            || format!("fill=\"{colour}\""),
            |width| format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\""),
        );
        self.append(format_args!("<circle cx=\"{x:.0}\" cy=\"{y:.0}\" r=\"{radius}\" {look}/>"));
    }

    /// Words at their middle height.
    pub(super) fn word(&mut self, text: &str, at: (f64, f64), anchor: Anchor) {
        self.words(text, at, anchor, "font-size=\"24\"");
    }

    /// Writes words with additional attributes.
    pub(super) fn words(&mut self, text: &str, (x, y): (f64, f64), anchor: Anchor, attributes: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escape(text);
        self.append(format_args!(
            "<text x=\"{x:.0}\" y=\"{y:.0}\" dy=\".35em\" text-anchor=\"{anchor}\" fill=\"{INK}\" \
             {attributes}>{text}</text>"
        ));
    }

    /// Returns the picture with this size, and with a name for screen readers.
    pub(super) fn finish(self, (width, height): (f64, f64), title: &str) -> String {
        let size = format!("width=\"{:.0}\" height=\"{:.0}\"", width / 2.0, height / 2.0);
        format!(
            "<svg {size} role=\"img\" viewBox=\"0 0 {width:.0} {height:.0}\" \
             xmlns=\"http://www.w3.org/2000/svg\" \
             font-family=\"Helvetica, Arial, sans-serif\">\n<title>{}</title>\n\
             <rect width=\"{width:.0}\" height=\"{height:.0}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escape(title),
            self.0
        )
    }
}

fn escape(text: &str) -> String {
    sanitize(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn opacity(kind: &str, share: f64) -> String {
    if share < 1.0 { format!(" {kind}-opacity=\"{share}\"") } else { String::new() }
}

/// Formats points to a tenth of a unit, without which a shallow line is a staircase; points far outside of
/// every picture are moved closer.
fn places(points: &[(f64, f64)]) -> String {
    const FAR: f64 = 20_000.0;
    let tenths = |place: f64| (10.0 * place.clamp(-FAR, FAR)).round() / 10.0;
    let place = |&(x, y): &(f64, f64)| format!("{},{}", tenths(x), tenths(y));
    points.iter().map(place).collect::<Vec<_>>().join(" ")
}
