//! The plan of a measurement to a chapter.

use super::super::document::{Chapter, ChapterPart, Medium, ReportTable};
use super::super::rounding::{plain, significant};
use crate::data::{ChannelNeeds, ExpectedIntervals, MeasuringPlan};

const LEAD: &str = "What the drop at this angle needs, by the rules that `dropcheck check` judges a set-up \
                    by. Peaks: a half sine that throws the first end back with k = 1, without ringing.";

/// What records the drop, and what would narrow its intervals.
pub(super) fn plan(plan: &MeasuringPlan) -> Chapter {
    let needs = &plan.needs;
    let mut ranges = ReportTable::of(&needs.channels).head("Channel", |c| &c.name[..]);
    for (i, peak) in needs.channels.iter().flat_map(|c| &c.peaks).take(lengths(&needs.channels)).enumerate() {
        let head = format!("Range above, g, impact of {} ms", plain(1e3 * peak.lasts_s, 3));
        ranges = ranges.number(head, move |c| c.peaks.get(i).map_or(String::new(), |p| plain(p.peak_g, 3)));
    }
    Chapter::new("Measuring plan")
        .with(ChapterPart::lead(LEAD).only(Medium::Page))
        .with(ChapterPart::text(in_short(plan)))
        .with(ChapterPart::from(ReportTable::from(ranges)).only(Medium::Page))
        .with(ChapterPart::lead(expected(plan)))
        .with_all((!plan.intervals.is_empty()).then(|| intervals(&plan.intervals)))
}

fn lengths(channels: &[ChannelNeeds]) -> usize {
    channels.first().map_or(0, |channel| channel.peaks.len())
}

fn in_short(plan: &MeasuringPlan) -> String {
    let needs = &plan.needs;
    let peaks = (0..lengths(&needs.channels)).map(|i| {
        let of_length = || needs.channels.iter().filter_map(|channel| channel.peaks.get(i));
        let largest_g = of_length().map(|peak| peak.peak_g).fold(0.0, f64::max);
        let lasts_ms = of_length().next().map_or(f64::NAN, |peak| 1e3 * peak.lasts_s);
        format!("{} g for an impact of {} ms", plain(largest_g, 3), plain(lasts_ms, 3))
    });
    format!(
        "Ranges above {}; {} Hz; a low-pass that leaves nothing above {} Hz; {} s before the first contact \
         (more than {} s to hold the rest) and {} s behind it.",
        peaks.collect::<Vec<_>>().join(", "),
        plain(needs.sample_rate_hz, 4),
        plain(needs.nothing_from_hz, 4),
        plain(needs.before_s, 3),
        plain(needs.fall_s, 3),
        plain(needs.after_s, 3)
    )
}

fn expected(plan: &MeasuringPlan) -> String {
    match plan.why_no_intervals {
        Some(why) => format!("Expected intervals: none, since {why}."),
        None => format!(
            "Expected intervals by the tolerances, for k = {}, without noise and ringing: a guide. Sixteen \
             drops had 0.7 to 1.0 times that of the speed, 0.8 to 1.2 times that of k:",
            plain(plan.k, 3)
        ),
    }
}

fn intervals(all: &[ExpectedIntervals]) -> ChapterPart {
    ReportTable::of(all)
        .head(
            "Channels",
            |row| if row.with.is_empty() { "as stated".into() } else { format!("+ {}", row.with) },
        )
        .number("speed ± 95 %, m/s", |row| significant(row.slap_down_speed_u95_m_s, 2))
        .number("k ± 95 %", |row| significant(row.k_u95, 2))
        .into()
}
