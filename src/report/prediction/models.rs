//! The ladder of models to a chapter.

use super::super::document::{Chapter, ChapterPart, Medium, ReportTable, TableShape, Words};
use super::super::rounding::{optional_fixed, percent, plain};
use super::super::text::capital;
use super::super::words::{MOST_ON_PAGE, MOST_ROWS, OTHERS, case_words, contact_words, degrees, rung_short};

use crate::data::{LADDER_TOLERANCE_PERCENT, Ladder, Rung, Study};

/// Every rung's speed, and which suffices.
pub(super) fn ladders(study: &Study) -> Chapter {
    let tolerance = plain(LADDER_TOLERANCE_PERCENT, 3);
    let lead = format!(
        "Slap-down speed by each model, the simplest first; each adds one thing to the one before it. One \
         suffices where no richer one moves the speed by more than {tolerance} %."
    );
    let lead = ChapterPart::lead(lead).only(Medium::Page);
    match &study.ladders[..] {
        [] => Chapter::new(""),
        [one] => {
            let heading =
                format!("Models at {}°, {}", degrees(one.angle_deg), case_words(one.contact, one.k));
            Chapter::new(heading).with(lead).with(one_ladder(one)).with(ChapterPart::text(verdict(one)))
        }
        many => {
            let heading = format!("Models at {}°, each richer by one thing, m/s", degrees(many[0].angle_deg));
            let suffices =
                format!("suffices: the simplest that no richer one moves by more than {tolerance} %.");
            let adds = Rung::ALL.map(|rung| format!("{} – {}", rung_short(rung), rung.adds())).join("; ");
            let adds = ChapterPart::note(format!("{adds}. L is the first end, R the second."));
            Chapter::new(heading)
                .with(lead)
                .with(many_ladders(many))
                .with(ChapterPart::note(suffices).only(Medium::Terminal))
                .with(adds.only(Medium::Page))
        }
    }
}

fn many_ladders(ladders: &[Ladder]) -> ChapterPart {
    let mut table = ReportTable::of(ladders)
        .shape(TableShape::Fitting)
        .most(MOST_ROWS, MOST_ON_PAGE, OTHERS)
        .soft(Words::or("Contact", "contact"), |ladder| contact_words(ladder.contact))
        .number("k", |ladder| plain(ladder.k, 3));
    for (i, rung) in Rung::ALL.into_iter().enumerate() {
        let head = Words::or(capital(&rung_short(rung)), rung_short(rung).replace(' ', "\n"));
        table = table.number(head, move |ladder| {
            ladder
                .steps
                .get(i)
                .map_or_else(String::new, |step| optional_fixed(step.prediction.slap_down_speed_m_s, 2))
        });
        table = table.if_any(ladders.iter().any(|ladder| ladder.steps.len() > i));
    }
    let suffices = |ladder: &Ladder| Words::or(ladder.suffices.words(), rung_short(ladder.suffices));
    table.text(Words::or("Suffices", "suffices"), suffices).into()
}

fn one_ladder(ladder: &Ladder) -> ChapterPart {
    let name = |rung: Rung| {
        let mark = if rung == ladder.suffices { " (suffices)" } else { "" };
        Words::or(format!("{}{mark}", rung.words()), rung_short(rung))
    };
    ReportTable::of(&ladder.steps)
        .chosen(|step| step.rung == ladder.suffices)
        .head(Words::or("Model", "model"), |step| name(step.rung))
        .text(Words::or("Adds", "adds"), |step| step.adds)
        .number(Words::or("Speed, m/s", "v m/s"), |step| {
            optional_fixed(step.prediction.slap_down_speed_m_s, 2)
        })
        .number(Words::or("Change", "change"), |step| percent(step.change_percent))
        .number("Impacts of the first end", |step| step.prediction.first_end_impacts.to_string())
        .only(Medium::Page)
        .into()
}

/// Which rung suffices, and what the richer ones would change.
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
