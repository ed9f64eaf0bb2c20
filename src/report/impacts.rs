//! Both impacts to the chapter that tabulates them: in short on a terminal, one table per impact on a page.

use super::document::{Chapter, ChapterPart, PartContent};
use super::medium::Medium;
use super::rounding::{MISSING, fixed, interval, pair, plain};
use super::table::ReportTable;
use super::text::distinct;
use crate::data::{
    ChannelPeak, DropResult, End, Estimate, ImpactTable, IssueCode, RigidBodyDeceleration,
    STANDARD_GRAVITY_M_S2,
};

/// A number of an impact: its name, unit and factor to it, and whether a terminal shows it.
struct ImpactRow {
    name: &'static str,
    unit: &'static str,
    factor: f64,
    is_short: bool,
    number: fn(&ImpactTable) -> Option<Estimate>,
}

impl ImpactRow {
    const fn new(
        name: &'static str,
        unit: &'static str,
        factor: f64,
        is_short: bool,
        number: fn(&ImpactTable) -> Option<Estimate>,
    ) -> Self {
        Self { name, unit, factor, is_short, number }
    }

    fn words(&self, impact: &ImpactTable) -> String {
        scaled((self.number)(impact), self.factor, self.unit)
    }
}

const G: f64 = 1.0 / STANDARD_GRAVITY_M_S2;

const ROWS: [ImpactRow; 16] = [
    ImpactRow::new("start", "ms", 1e3, false, |i| i.start),
    ImpactRow::new("duration", "ms", 1e3, true, |i| i.numbers.duration),
    ImpactRow::new("velocity change of the end", "m/s", 1.0, true, |i| i.numbers.velocity_change),
    ImpactRow::new("restitution", "", 1.0, true, |i| i.numbers.restitution),
    ImpactRow::new("impulse upwards", "kN s", 1e-3, true, |i| i.numbers.impulse_z),
    ImpactRow::new("impulse along the target", "kN s", 1e-3, false, |i| i.numbers.impulse_x),
    ImpactRow::new("friction, one over the other", "", 1.0, false, |i| i.numbers.friction),
    ImpactRow::new("kinetic energy before", "kJ", 1e-3, true, |i| i.numbers.energy_before),
    ImpactRow::new("energy taken", "kJ", 1e-3, true, |i| i.numbers.energy_absorbed),
    ImpactRow::new("kinetic energy after", "kJ", 1e-3, false, |i| i.numbers.energy_after),
    ImpactRow::new("before, over that of the first", "", 1.0, false, |i| i.numbers.energy_ratio),
    ImpactRow::new("taken, over that of the first", "", 1.0, true, |i| i.numbers.absorbed_ratio),
    ImpactRow::new("crush", "mm", 1e3, true, |i| i.numbers.crush),
    ImpactRow::new("largest force", "MN", 1e-6, true, |i| i.numbers.force_peak),
    ImpactRow::new("deceleration of the body at S", "g", G, true, |i| i.rigid_body_deceleration.at_cog),
    ImpactRow::new("the same at the end", "g", G, true, |i| i.rigid_body_deceleration.at_struck_end),
];

fn scaled(estimate: Option<Estimate>, factor: f64, unit: &'static str) -> String {
    estimate.map_or_else(|| MISSING.to_owned(), |e| pair(factor * e.value, factor * e.u95, unit))
}

/// The chapter; nothing where neither impact is told.
pub(super) fn impacts(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Both impacts, ± 95 %");
    let [first, second] = &result.impacts;
    if first.numbers.crush.is_none() && result.impacts.iter().all(|i| i.channels.is_empty()) {
        return chapter;
    }
    let short: Vec<&ImpactRow> = ROWS.iter().filter(|row| row.is_short).collect();
    let table = ReportTable::of(&short)
        .head("", |row| row.name)
        .number("first end", |row| row.words(first))
        .number("second end", |row| row.words(second));
    let facts = result.impacts.iter().map(of_one).collect::<Vec<_>>();
    let missing = result.quality.iter().find(|f| f.code == IssueCode::SecondImpact);
    let why = missing.filter(|_| second.numbers.crush.is_none());
    let why = why.map(|f| ChapterPart::note(format!("{MISSING} could not be had: {}", f.message)));
    chapter
        .with(ChapterPart::from(table).only(Medium::Terminal))
        .with(ChapterPart::text(filter_words(result)))
        .with_all(facts.into_iter().flatten())
        .with_all(why)
        .with_all(energy_words(result).map(ChapterPart::text))
}

/// Which low-pass, and where it overshoots.
fn filter_words(result: &DropResult) -> String {
    let peaks = || result.impacts.iter().flat_map(|i| &i.channels);
    let low_pass = peaks().next().map_or_else(String::new, |peak| {
        format!(
            "Forces and decelerations through the low-pass {} (−3 dB at {} Hz).",
            peak.filter,
            plain(peak.cutoff_hz, 4)
        )
    });
    let above = distinct(peaks().filter(|p| p.is_above_raw).map(|p| p.name.as_str()));
    if above.is_empty() {
        return low_pass;
    }
    format!("{low_pass} It overshoots: the filtered peak of {} lies above the raw one.", above.join(", "))
}

/// What is left for the second end, measured beside predicted as Fig. 8 of [P] has it, and the amplification.
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

/// The tables of one impact on a page: the rigid body, its decelerations by low-pass, the channels.
fn of_one(impact: &ImpactTable) -> Vec<ChapterPart> {
    let end = if impact.end == End::First { "First impact" } else { "Second impact" };
    let numbers = ReportTable::of(&ROWS)
        .caption(format!(
            "{end}: the rigid body, free of ringing; impulse, energy and force with the stated mass"
        ))
        .head("Quantity", |row| row.name)
        .number("± 95 %", |row| row.words(impact));
    let taken = &impact.rigid_body_deceleration;
    let decelerations = ReportTable::of(&taken.others)
        .caption(format!("{end}: largest deceleration of the rigid body by low-pass, g"))
        .chosen(|d| d.filter == taken.filter)
        .head("Low-pass", |d| &d.filter[..])
        .number("−3 dB, Hz", |d: &RigidBodyDeceleration| plain(d.cutoff_hz, 4))
        .number("At S", |d| scaled(d.at_cog, G, ""))
        .number("At the end", |d| scaled(d.at_struck_end, G, ""));
    let channels = ReportTable::of(&impact.channels)
        .caption(format!("{end}: what the channels read, ringing and all"))
        .head("Channel", |c: &ChannelPeak| &c.name[..])
        .number("Raw peak, g", |c| scaled(c.peak_raw, G, ""))
        .number("Filtered, g", |c| scaled(c.peak_filtered, G, ""))
        .number("At, ms", |c| scaled(c.time, 1e3, ""))
        .number("Pulse, ms", |c| scaled(c.pulse_length, 1e3, ""));
    let beside = [(!taken.others.is_empty()).then(|| decelerations.into()), Some(channels.into())];
    let beside = PartContent::Beside([vec![numbers.into()], beside.into_iter().flatten().collect()]);
    vec![ChapterPart::from(beside).only(Medium::Page)]
}
