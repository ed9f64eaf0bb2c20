//! Table of the readings of single channels in the impacts, and table of the first impact with each low-pass.

use super::document::{Chapter, ChapterPart, ReportTable};
use super::rounding::{optional, optional_fixed, pair};
use super::text::json_word;
use crate::data::{DropResult, Estimate, FilteredPeak, RigidBodyDeceleration, Shock};

const CAPTION: &str = "At the report's low-pass, and unfiltered. An acceleration counts from the free fall, \
                       another quantity from its level before the release. Length: above a tenth of the \
                       peak. Change of velocity and displacement: over the pulse, unfiltered; the \
                       displacement is that against an undisturbed motion. srs.csv has the spectra.";

const RESULTANT: &str = "Resultant: the magnitude of the vector of a mounting block's three sensors, each \
                         through the low-pass; so of the changes of velocity and displacement.";

/// The chapter; empty if no channel shows an impact.
pub(super) fn shocks(result: &DropResult) -> Chapter {
    let millis = |seconds: Option<f64>| seconds.map(|s| 1e3 * s);
    let table = ReportTable::from_rows(&result.shocks)
        .class("")
        .caption(CAPTION)
        .head("Channel", |s| &s.channel[..])
        .text("Impact", |s| json_word(s.event))
        .number("Peak", |s| with_interval(s, s.peak, s.known[0]))
        .number("Unfiltered", |s| with_interval(s, s.peak_unfiltered, s.known[1]))
        .text("Unit", |s| &s.unit[..])
        .number("At, ms", |s| optional_fixed(millis(s.time_s), 2))
        .number("Length, ms", |s| optional_fixed(millis(s.duration_s), 2))
        .number("Change of velocity, m/s", |s| optional_fixed(s.velocity_change_m_s, 2))
        .number("Displacement, mm", |s| optional_fixed(millis(s.displacement_m), 1));
    let has_resultant = result.shocks.iter().any(|shock| !shock.components.is_empty());
    Chapter::new("Shocks of every channel")
        .then(table)
        .with_all(has_resultant.then(|| ChapterPart::note(RESULTANT)))
}

/// A peak in the shock's unit, with its interval if it is known, m/s².
fn with_interval(shock: &Shock, peak: Option<f64>, known: Option<Estimate>) -> String {
    let in_unit = |(known, unit): (Estimate, f64)| pair(known.value / unit, known.u95 / unit, "");
    known.zip(shock.unit_m_s2).map_or_else(|| optional(peak, 4), in_unit)
}

/// Table of the first impact's peaks, and the decelerations in both impacts, for each low-pass.
pub(super) fn filter_table(result: &DropResult, scaled_g: fn(Option<Estimate>) -> String) -> ReportTable {
    let impact = |i: usize, filter: &FilteredPeak| {
        let own = &result.impacts[i].rigid_body_deceleration;
        own.others.iter().find(|other| other.filter == filter.name)
    };
    let cell = |i: usize, number: fn(&RigidBodyDeceleration) -> Option<Estimate>| {
        move |filter: &FilteredPeak| scaled_g(impact(i, filter).and_then(number))
    };
    ReportTable::from_rows(&result.filters)
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
        .number("2nd: end, g", cell(1, |d| d.at_struck_end))
        .into()
}
