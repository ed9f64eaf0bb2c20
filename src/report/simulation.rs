//! Chapter on the calculation beside the test: ratings, and numbers of both.

use super::document::{Chapter, ChapterPart, ReportTable};
use super::rounding::{fixed, pair, percent};
use super::text::json_word;
use crate::data::{CalculatedNumber, DropResult};

/// The chapter; empty if the cask file names no calculation.
pub(super) fn simulation(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Calculation beside the test");
    let Some(file) = &result.input.simulation else { return chapter };
    let Some(first) = result.simulation.first() else {
        let words = format!("The calculation {file} is not rated; the findings say why.");
        return chapter.then(ChapterPart::text(words));
    };
    let caption = format!(
        "Ratings by ISO/TS 18571 of {file}, from first contact to the end of the shorter curve, both through \
         the low-pass of the curves: 1 equal, 0 beyond every limit; peak: against the measured one."
    );
    let shift = format!(
        "The times of the calculation are shifted by {} ms to the measured first contact.",
        fixed(1e3 * first.shift_s, 3)
    );
    let ratings = ReportTable::from_rows(&result.simulation)
        .caption(caption)
        .head("Channel", |row| &row.channel[..])
        .text("Quantity", |row| json_word(row.quantity))
        .number("Corridor", |row| fixed(row.corridor, 3))
        .number("Phase", |row| fixed(row.phase, 3))
        .number("Magnitude", |row| fixed(row.magnitude, 3))
        .number("Slope", |row| fixed(row.slope, 3))
        .number("Rating", |row| fixed(row.rating, 3))
        .number("Peak", |row| percent(100.0 * row.peak_difference));
    let measured = |number: &CalculatedNumber| match number.u95 {
        Some(u95) => pair(number.measured, u95, number.unit),
        None => format!("{} {}", fixed(number.measured, 2), number.unit),
    };
    let numbers = ReportTable::from_rows(&result.calculated)
        .caption(
            "Filtered curves of both. Pulse: above a tenth of the peak. The second pulse of the calculation \
             is sought from the middle of the measured flight on; the change of velocity is that from the \
             measured first contact to the measured separation.",
        )
        .head("Quantity", |number| &number.what[..])
        .number("Measured", measured)
        .number("Calculated", |number| fixed(number.calculated, 2))
        .number("Difference", |number| fixed(number.calculated - number.measured, 2));
    chapter.then(ratings).then(ChapterPart::note(shift)).then(numbers)
}
