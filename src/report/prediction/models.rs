//! Chapters on the models, and on the plan of a measurement.

use crate::data::{
    ChannelNeeds, ExpectedIntervals, LADDER_TOLERANCE_PERCENT, Ladder, MeasuringPlan, Rung, Study,
};
use crate::report::document::{Chapter, ChapterPart, Medium, ReportTable, TableShape, Words};
use crate::report::rounding::{optional_fixed, percent, plain, significant};
use crate::report::text::capital;
use crate::report::words::{MOST_ON_PAGE, MOST_ROWS, OTHERS, case_words, contact_words, degrees, rung_short};

/// Chapter on the speed of every model, and on the one that suffices.
pub(super) fn models_chapter(study: &Study) -> Chapter {
    let tolerance = plain(LADDER_TOLERANCE_PERCENT, 3);
    let lead = format!(
        "Slap-down speed by each model, the simplest first; each adds one thing to the one before it. One \
         suffices where no richer one moves the speed by more than {tolerance} %."
    );
    let lead = ChapterPart::lead(lead).only_on(Medium::Page);
    match &study.ladders[..] {
        [] => Chapter::new(""),
        [one] => {
            let heading =
                format!("Models at {}°, {}", degrees(one.angle_deg), case_words(one.contact, one.k));
            Chapter::new(heading).then(lead).then(compare_models(one)).then(ChapterPart::text(verdict(one)))
        }
        many => {
            let heading = format!("Models at {}°, each richer by one thing, m/s", degrees(many[0].angle_deg));
            let suffices =
                format!("suffices: the simplest that no richer one moves by more than {tolerance} %.");
            let adds = Rung::ALL.map(|rung| format!("{} – {}", rung_short(rung), rung.physics())).join("; ");
            let adds = ChapterPart::note(format!("{adds}. L is the first end, R the second."));
            Chapter::new(heading)
                .then(lead)
                .then(compare_cases(many))
                .then(ChapterPart::note(suffices).only_on(Medium::Terminal))
                .then(adds.only_on(Medium::Page))
        }
    }
}

fn compare_cases(ladders: &[Ladder]) -> ChapterPart {
    let mut table = ReportTable::from_rows(ladders)
        .shape(TableShape::Fitting)
        .limit_rows(MOST_ROWS, MOST_ON_PAGE, OTHERS)
        .line(Words::with_short("Contact", "contact"), |ladder| contact_words(ladder.contact))
        .number("k", |ladder| plain(ladder.k, 3));
    for (i, rung) in Rung::ALL.into_iter().enumerate() {
        let head = Words::with_short(capital(&rung_short(rung)), rung_short(rung).replace(' ', "\n"));
        table = table.number(head, move |ladder| {
            ladder
                .steps
                .get(i)
                .map_or_else(String::new, |step| optional_fixed(step.prediction.slap_down_speed_m_s, 2))
        });
        table = table.show_if(ladders.iter().any(|ladder| ladder.steps.len() > i));
    }
    let suffices = |ladder: &Ladder| Words::with_short(ladder.suffices.words(), rung_short(ladder.suffices));
    table.text(Words::with_short("Suffices", "suffices"), suffices).into()
}

fn compare_models(ladder: &Ladder) -> ChapterPart {
    let name = |rung: Rung| {
        let mark = if rung == ladder.suffices { " (suffices)" } else { "" };
        Words::with_short(format!("{}{mark}", rung.words()), rung_short(rung))
    };
    ReportTable::from_rows(&ladder.steps)
        .mark_chosen(|step| step.rung == ladder.suffices)
        .head(Words::with_short("Model", "model"), |step| name(step.rung))
        .text(Words::with_short("Adds", "adds"), |step| step.adds)
        .number(Words::with_short("Speed, m/s", "v m/s"), |step| {
            optional_fixed(step.prediction.slap_down_speed_m_s, 2)
        })
        .number(Words::with_short("Change", "change"), |step| percent(step.change_percent))
        .number("Impacts of the first end", |step| step.prediction.first_end_impacts.to_string())
        .only_on(Medium::Page)
        .into()
}

/// Sentence on the model that suffices, and the changes by the richer ones.
fn verdict(ladder: &Ladder) -> String {
    if ladder.steps.last().is_some_and(|last| last.rung == ladder.suffices) {
        return "Only the last suffices: each simpler one is moved by a richer one.".to_owned();
    }
    format!(
        "The model \"{}\" suffices: no richer one moves the speed by more than {} %.",
        ladder.suffices.words(),
        plain(LADDER_TOLERANCE_PERCENT, 3)
    )
}

const LEAD: &str = "What the drop at this angle needs, by the rules that `dropcheck check` judges a set-up \
                    by. Peaks: a half sine that throws the first end back with k = 1, without ringing.";

/// Chapter on the requirements of the recorder, and the measures that would narrow the intervals.
pub(super) fn plan(plan: &MeasuringPlan) -> Chapter {
    let needs = &plan.needs;
    let mut ranges = ReportTable::from_rows(&needs.channels).head("Channel", |c| &c.name[..]);
    for (i, peak) in needs.channels.iter().flat_map(|c| &c.peaks).take(lengths(&needs.channels)).enumerate() {
        let head = format!("Range above, g, impact of {} ms", plain(1e3 * peak.lasts_s, 3));
        ranges = ranges.number(head, move |c| c.peaks.get(i).map_or(String::new(), |p| plain(p.peak_g, 3)));
    }
    Chapter::new("Measuring plan")
        .then(ChapterPart::lead(LEAD).only_on(Medium::Page))
        .then(ChapterPart::text(short_plan(plan)))
        .then(ChapterPart::from(ReportTable::from(ranges)).only_on(Medium::Page))
        .then(ChapterPart::lead(expected_words(plan)))
        .with_all((!plan.intervals.is_empty()).then(|| intervals(&plan.intervals)))
}

fn lengths(channels: &[ChannelNeeds]) -> usize {
    channels.first().map_or(0, |channel| channel.peaks.len())
}

fn short_plan(plan: &MeasuringPlan) -> String {
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

fn expected_words(plan: &MeasuringPlan) -> String {
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
    ReportTable::from_rows(all)
        .head(
            "Channels",
            |row| if row.with.is_empty() { "as stated".into() } else { format!("+ {}", row.with) },
        )
        .number("speed ± 95 %, m/s", |row| significant(row.slap_down_speed_u95_m_s, 2))
        .number("k ± 95 %", |row| significant(row.k_u95, 2))
        .into()
}
