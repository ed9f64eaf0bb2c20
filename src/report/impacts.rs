//! Chapter on both impacts, short on a terminal, with one table per impact on a page; and the table of the
//! prototype of a scale model.

use super::document::{Chapter, ChapterPart, ReportTable};
use super::rounding::{MISSING, fixed, interval, pair, plain};
use super::shocks::filter_table;
use super::text::{dedup, reasons};
use crate::data::{CaskFile, DropResult, Estimate, ImpactTable, QuantityRow, STANDARD_GRAVITY_M_S2};

/// A number of an impact: its name, unit and factor to it.
struct ImpactRow(&'static str, &'static str, f64, fn(&ImpactTable) -> Option<Estimate>);

impl ImpactRow {
    fn words(&self, impact: &ImpactTable) -> String {
        let Self(_, unit, factor, number) = self;
        scaled_words(number(impact), *factor, unit)
    }
}

const G: f64 = 1.0 / STANDARD_GRAVITY_M_S2;

const ROWS: [ImpactRow; 14] = [
    ImpactRow("duration", "ms", 1e3, |i| i.numbers.duration),
    ImpactRow("velocity change of the end", "m/s", 1.0, |i| i.numbers.velocity_change),
    ImpactRow("restitution", "", 1.0, |i| i.numbers.restitution),
    ImpactRow("impulse upwards I_z", "kN s", 1e-3, |i| i.numbers.impulse_z),
    ImpactRow("impulse along the target I_x", "kN s", 1e-3, |i| i.numbers.impulse_x),
    ImpactRow("impulse ratio I_x/I_z", "", 1.0, |i| i.numbers.friction),
    ImpactRow("kinetic energy before", "kJ", 1e-3, |i| i.numbers.energy_before),
    ImpactRow("energy absorbed", "kJ", 1e-3, |i| i.numbers.energy_absorbed),
    ImpactRow("kinetic energy after", "kJ", 1e-3, |i| i.numbers.energy_after),
    ImpactRow("absorbed, share of the initial energy", "", 1.0, |i| i.numbers.absorbed_ratio),
    ImpactRow("crush", "mm", 1e3, |i| i.numbers.crush),
    ImpactRow("largest force", "MN", 1e-6, |i| i.numbers.force_peak),
    ImpactRow("deceleration of the centre of gravity", "g", G, |i| i.rigid_body_deceleration.at_cog),
    ImpactRow("deceleration at the struck end", "g", G, |i| i.rigid_body_deceleration.at_struck_end),
];

fn scaled_words(estimate: Option<Estimate>, factor: f64, unit: &'static str) -> String {
    estimate.map_or_else(|| MISSING.to_owned(), |e| pair(factor * e.value, factor * e.u95, unit))
}

/// A note for each reason why quantities at these paths are missing.
pub(super) fn missing_notes(result: &DropResult, places: &[&str]) -> impl Iterator<Item = ChapterPart> {
    let note = |reason| ChapterPart::note(format!("{MISSING} not determined: {reason}"));
    reasons(result, places).into_iter().map(note)
}

/// The chapter; empty if neither impact is determined.
pub(super) fn impacts(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Both impacts, ± 95 %");
    let [first, second] = &result.impacts;
    if first.numbers.crush.is_none() && result.impacts.iter().all(|i| i.channels.is_empty()) {
        return chapter;
    }
    let table = ReportTable::from_rows(&ROWS)
        .caption("The rigid body, free of ringing; impulse, energy and force with the stated mass")
        .head("Quantity", |row| row.0)
        .number("First impact", |row| row.words(first))
        .number("Second impact", |row| row.words(second));
    chapter
        .then(ChapterPart::text(filter_words(result)))
        .then(table)
        .then(filter_table(result, |estimate| scaled_words(estimate, G, "")))
        .with_all(missing_notes(result, &["impacts[0]", "impacts[1]"]))
        .with_all(energy_words(result).map(ChapterPart::text))
}

/// Names the low-pass, and the readings in which it overshoots.
fn filter_words(result: &DropResult) -> String {
    let peaks = || result.impacts.iter().flat_map(|i| &i.channels);
    let low_pass = peaks().next().map_or_else(String::new, |peak| {
        let rule = if peak.filter.starts_with("SSG-26") {
            let [least, most] = [0.5, 1.0].map(|share| plain(share * peak.cutoff_hz, 4));
            format!(
                " × (100 t/m)^⅓, the upper end of the band that SSG-26 advises (100 to 200 Hz for 100 t, \
                 here {least} to {most} Hz)"
            )
        } else {
            String::new()
        };
        format!(
            "Forces, decelerations and filtered curves go through one low-pass: {}{rule} (−3 dB at {} Hz).",
            peak.filter,
            plain(peak.cutoff_hz, 4)
        )
    });
    let above = dedup(peaks().filter(|p| p.is_above_raw).map(|p| p.name.as_str()));
    if above.is_empty() {
        return low_pass;
    }
    format!(
        "{low_pass} It overshoots: the filtered peak of {} lies above the unfiltered one.",
        above.join(", ")
    )
}

/// Energy that remains for the second end, measured and predicted as in Fig. 8 of [P], and the amplification.
fn energy_words(result: &DropResult) -> Option<String> {
    let amplified = interval(Some(&result.amplification?));
    let left = result.impacts[1].numbers.energy_ratio.map(|ratio| {
        let predicted = result.predictions.last().and_then(|p| p.energy_ratio);
        let beside = predicted.map_or_else(String::new, |p| format!(", predicted {}", fixed(p, 3)));
        format!(
            " Energy left for the second end, over that before the first impact: {}{beside}.",
            interval(Some(&ratio))
        )
    });
    Some(format!("Slap-down speed over impact velocity: {amplified}.{}", left.unwrap_or_default()))
}

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
        let words = |of: &ImpactTable| ROWS.iter().map(|row| (row.0, row.words(of))).collect();
        add(name, [&result.impacts, &prototype.impacts].map(|of| words(&of[i])));
    }
    rows.retain(|[_, model, _]| model != MISSING);
    let table = ReportTable::from_rows(&rows)
        .caption("The same materials, the same drop height: velocities, angles and k are equal.")
        .head("Quantity", |row| row[0].clone())
        .number(format!("Model, 1:{}", plain(1.0 / scale, 3)), |row| row[1].clone())
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
    chapter.then(table).then(ChapterPart::note(longer))
}
