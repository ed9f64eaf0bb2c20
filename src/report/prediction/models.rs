//! The ladder of models and the sensitivities of a study to chapters.

use super::super::document::{Chapter, ChapterPart};
use super::super::medium::{Medium, Words};
use super::super::rounding::{MISSING, optional_fixed, percent, plain};
use super::super::table::{ReportTable, TableShape};
use super::super::text::capital;
use super::super::words::{
    MOST_ON_PAGE, MOST_ROWS, OTHERS, angles_words, bands_words, case_words, contact_words, degrees, nearest,
    rung_short, widest_bands_words,
};

use crate::data::{LADDER_TOLERANCE_PERCENT, Ladder, Rung, Sensitivity, Study};

/// Every rung's speed, and which suffices.
pub(super) fn ladders(study: &Study) -> Chapter {
    let tolerance = plain(LADDER_TOLERANCE_PERCENT, 3);
    let lead = format!(
        "Slap-down speed by each model, the simplest first; each adds one thing to the one before it. One suffices where no richer one \
         moves the speed by more than {tolerance} %."
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
        let head = Words::or(capital(rung_short(rung)), rung_short(rung).replace(' ', "\n"));
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
        .number(Words::or("Change", "change"), |step| step.change_percent.map_or(MISSING.into(), percent))
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

/// Gradients at the angle asked for, and where the speed does not tell k.
pub(super) fn sensitivities(study: &Study) -> Chapter {
    let at = study.request.angle_deg;
    let here = |s: &Sensitivity, values: &[f64], decimals| {
        optional_fixed(nearest(&s.angle_deg, values, at), decimals)
    };
    let table = ReportTable::of(&study.sensitivities)
        .caption("Gradient of the slap-down speed.")
        .shape(TableShape::Fitting)
        .most(MOST_ROWS, MOST_ON_PAGE, OTHERS)
        .text(Words::or("Model", "model"), |s| s.model.as_str())
        .soft(Words::or("Contact", "contact"), |s| contact_words(s.contact))
        .number("k", |s| plain(s.k, 3))
        .number(Words::or("∂v/∂k, m/s", "dv/dk\nm/s"), |s| here(s, &s.by_k_m_s, 2))
        .number(Words::or("∂v/∂φ, m/s per °", "dv/dφ\nm/s per °"), |s| {
            here(s, &s.by_angle_m_s_deg, 3)
        })
        .text(Words::or("Blind angle, °", "blind °"), |s| {
            let angles = &s.blind_angles_deg;
            Words::or(angles_words(angles, angles.len()), angles_words(angles, 2))
        })
        .text(Words::or("k poorly told, °", "poorly told °"), |s| {
            Words::or(bands_words(&s.blind_bands_deg), widest_bands_words(&s.blind_bands_deg, 2))
        });
    let note = ChapterPart::note(
        "blind: dv/dk is nil there. Poorly told: 1 % of the speed is more than 0.1 in k. There k must come from the \
         rebound, the rotation or the flight time.",
    );
    let found = (!study.sensitivities.is_empty()).then(|| [table.into(), note]);
    Chapter::new(format!("Sensitivity at {}°, and where the speed does not tell k", degrees(at)))
        .with_all(found.into_iter().flatten())
        .with(ChapterPart::picture("sensitivity", "", ""))
}
