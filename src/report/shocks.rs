//! What single channels read in the impacts to a table, and the choice of the low-pass to a table of what
//! each would have made of the first impact.

use super::document::{Chapter, ChapterPart, ReportTable};
use super::rounding::{interval, optional, optional_fixed};
use super::text::json_word;
use crate::data::{DropResult, End, Estimate, FilteredPeak, RigidBodyDeceleration, Shock};

const CAPTION: &str = "At the report's low-pass, and unfiltered. An acceleration counts from the free fall, \
                       another quantity from its level before the release. Length: above a tenth of the \
                       peak. Change of velocity and displacement: over the pulse, unfiltered; the \
                       displacement is that against an undisturbed motion. srs.csv has the spectra.";

/// The chapter; empty where no channel shows an impact.
pub(super) fn shocks(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Shocks of every channel");
    if result.shocks.is_empty() {
        return chapter;
    }
    let millis = |seconds: Option<f64>| seconds.map(|s| 1e3 * s);
    let table = ReportTable::of(&result.shocks)
        .class("")
        .caption(CAPTION)
        .head("Channel", |s| &s.channel[..])
        .text("Impact", |s| json_word(s.event))
        .number("Peak", |s| with_interval(result, s, true))
        .number("Unfiltered", |s| with_interval(result, s, false))
        .text("Unit", |s| &s.unit[..])
        .number("At, ms", |s| optional_fixed(millis(s.time_s), 2))
        .number("Length, ms", |s| optional_fixed(millis(s.duration_s), 2))
        .number("Change of velocity, m/s", |s| optional_fixed(s.velocity_change_m_s, 2))
        .number("Displacement, mm", |s| optional_fixed(millis(s.displacement_m), 1));
    chapter.with(table)
}

/// A peak with the interval that the table of its impact has, in the shock's unit.
fn with_interval(result: &DropResult, shock: &Shock, is_filtered: bool) -> String {
    let impact = &result.impacts[usize::from(shock.event == End::Second)];
    let own = impact.channels.iter().find(|peak| peak.name == shock.channel);
    let estimate = own.and_then(|own| if is_filtered { own.peak_filtered } else { own.peak_raw });
    let in_unit = |e: Estimate, unit_m_s2: f64| Estimate::new(e.value / unit_m_s2, e.u95 / unit_m_s2, "1");
    match estimate.zip(shock.unit_m_s2) {
        Some((estimate, unit_m_s2)) => interval(Some(&in_unit(estimate, unit_m_s2))),
        None => optional(if is_filtered { shock.peak } else { shock.peak_unfiltered }, 4),
    }
}

/// What each low-pass makes of the first impact, and of the decelerations of both.
pub(super) fn what_if(result: &DropResult, scaled_g: fn(Option<Estimate>) -> String) -> Vec<ChapterPart> {
    if result.filters.is_empty() {
        return Vec::new();
    }
    let impact = |i: usize, filter: &FilteredPeak| {
        let own = &result.impacts[i].rigid_body_deceleration;
        own.others.iter().find(|other| other.filter == filter.name)
    };
    let cell = |i: usize, number: fn(&RigidBodyDeceleration) -> Option<Estimate>| {
        move |filter: &FilteredPeak| scaled_g(impact(i, filter).and_then(number))
    };
    let table = ReportTable::of(&result.filters)
        .caption(
            "What another low-pass would make of it: peak and length of the first end's transverse channel \
             in the first impact, and the decelerations of the rigid body's centre of gravity S and struck \
             end in both",
        )
        .head("Low-pass", |f| &f.name[..])
        .number("−3 dB, Hz", |f| optional(f.cutoff_hz, 4))
        .number("Peak, g", |f| optional(f.peak_g, 4))
        .number("Length, ms", |f| optional_fixed(f.duration_s.map(|s| 1e3 * s), 2))
        .number("1st: S, g", cell(0, |d| d.at_cog))
        .number("1st: end, g", cell(0, |d| d.at_struck_end))
        .number("2nd: S, g", cell(1, |d| d.at_cog))
        .number("2nd: end, g", cell(1, |d| d.at_struck_end));
    vec![table.into()]
}
