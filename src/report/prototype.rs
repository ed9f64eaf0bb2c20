//! What holds of the prototype of a scale model to a table beside what was measured.

use super::document::{Chapter, ChapterPart, ReportTable};
use super::impacts;
use super::rounding::{MISSING, interval};
use crate::data::{CaskFile, DropResult, QuantityRow};

/// The chapter; empty where no scale is stated.
pub(super) fn prototype(result: &DropResult, file: &CaskFile) -> Chapter {
    let chapter = Chapter::new("Model and prototype, ± 95 %");
    let Some(prototype) = &result.prototype else { return chapter };
    let (g, scale) = (file.drop.gravity_m_s2, prototype.scale);
    let mut rows: Vec<[String; 3]> = Vec::new();
    let mut add = |name: &str, of: [Vec<(&'static str, String)>; 2]| {
        let [model, full] = of;
        rows.extend(model.into_iter().zip(full).map(|((of, a), (_, b))| [format!("{name}: {of}"), a, b]));
    };
    let words = |rows: Vec<QuantityRow>| rows.iter().map(|r| (r.name, interval(r.value.as_ref()))).collect();
    add("first impact", [&result.first_impact, &prototype.first_impact].map(|of| words(of.rows())));
    add("slap-down", [&result.slap_down, &prototype.slap_down].map(|of| words(of.rows())));
    for (i, name) in ["first impact", "second impact"].into_iter().enumerate() {
        add(name, [&result.impacts, &prototype.impacts].map(|of| impacts::in_short(&of[i])));
    }
    rows.retain(|[_, model, _]| model != MISSING);
    let table = ReportTable::of(&rows)
        .caption("The same materials, the same drop height: velocities, angles and k are equal.")
        .head("Quantity", |row| row[0].clone())
        .number(format!("Model, 1:{}", super::rounding::plain(1.0 / scale, 3)), |row| row[1].clone())
        .number("Prototype", |row| row[2].clone());
    let flight_s = result.slap_down.flight_time.map_or(0.0, |flight| flight.value);
    let longer = format!(
        "Not scaled: gravity, which acts {:.3} times as long on the prototype and adds about {:.2} m/s to \
         the fall of its second end (`predict` with the prototype's sizes has it); rates of strain, which \
         are {:.3} times as high in the model, so that its materials may be stiffer; fracture, welds and \
         gaps.",
        1.0 / scale,
        g * flight_s * (1.0 / scale - 1.0),
        1.0 / scale
    );
    chapter.with(table).with(ChapterPart::note(longer))
}
