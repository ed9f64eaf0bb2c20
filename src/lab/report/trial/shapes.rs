//! Methods to marks of a colour and a shape of their own, and the legend that names them.

use crate::report::pictures::panel::{Area, COLOURS, FONT, INK, RIGHT, WIDTH};
use crate::report::rounding;
use crate::report::text::printable;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Height of a row of the legend.
pub(super) const ROW: i32 = 42;

pub(super) type Failure = DrawingAreaErrorKind<std::io::Error>;

/// The colour of the method at this place of its family.
pub(super) fn colour(index: usize) -> RGBColor {
    COLOURS[index % COLOURS.len()]
}

/// Draws the mark of the method at this place: colour and shape together tell 35 apart.
pub(super) fn mark(area: &Area, index: usize, (x, y): (i32, i32), hollow: bool) -> Result<(), Failure> {
    let corners: Vec<(i32, i32)> = match index % 5 {
        0 => (0..16)
            .map(|i| {
                let (sine, cosine) = (f64::from(i) * std::f64::consts::PI / 8.0).sin_cos();
                #[allow(clippy::cast_possible_truncation, reason = "ten units at most")]
                let corner = ((10.0 * cosine).round() as i32, (10.0 * sine).round() as i32);
                corner
            })
            .collect(),
        1 => vec![(-9, -9), (9, -9), (9, 9), (-9, 9)],
        2 => vec![(0, -12), (12, 9), (-12, 9)],
        3 => vec![(0, -13), (13, 0), (0, 13), (-13, 0)],
        _ => vec![(0, 12), (12, -9), (-12, -9)],
    };
    let mut corners: Vec<(i32, i32)> = corners.into_iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
    if hollow {
        area.draw(&Polygon::new(corners.clone(), WHITE.filled()))?;
        corners.push(corners[0]);
        return area.draw(&PathElement::new(corners, colour(index).stroke_width(4)));
    }
    area.draw(&Polygon::new(corners, colour(index).filled()))
}

/// Places of words in rows of the picture's width, each behind a sample of `sample` units; and the rows.
pub(super) fn rows(words: &[String], sample: i32) -> (Vec<(i32, i32)>, i32) {
    let (first, limit) = (30, WIDTH.cast_signed() - RIGHT);
    let (mut left, mut row) = (first, 0);
    let places = words
        .iter()
        .map(|word| {
            // A letter is about 15.5 units wide at 30 units.
            let takes = sample + 16 * i32::try_from(word.chars().count()).unwrap_or(0) + 36;
            if left + takes > limit && left > first {
                (left, row) = (first, row + 1);
            }
            let place = (left, row * ROW);
            left += takes;
            place
        })
        .collect();
    (places, row + 1)
}

/// Text at its left middle.
pub(super) fn word(area: &Area, text: &str, at: (i32, i32), size: i32) -> Result<(), Failure> {
    let style = TextStyle::from((FONT, size).into_font()).color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new(printable(text), at, style))
}

/// A tick of a logarithmic axis: powers of ten, and plain numbers near 1.
pub(super) fn tick(value: f64) -> String {
    if (0.009..2e4).contains(&value) {
        return rounding::plain(value, 3);
    }
    format!("{value:.0e}").replace('-', "−")
}
