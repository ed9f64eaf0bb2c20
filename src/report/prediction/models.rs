//! The ladder of models and the sensitivities of a study to blocks for the terminal.

use super::super::columns::columns;
use super::super::rounding::{MISSING, optional_fixed, percent, plain};
use super::super::text::{WIDTH, wrap};
use super::summary::{block, heading, nearest};
use super::words::{angles_words, contact_words, degrees, rung_short, widest_bands_words};
use crate::data::{LADDER_TOLERANCE_PERCENT, Ladder, Rung, Study};

/// Every rung's speed, and which suffices.
pub(super) fn ladders(study: &Study) -> String {
    match &study.ladders[..] {
        [] => String::new(),
        [one] => one_ladder(one),
        many => {
            let rows = many
                .iter()
                .map(|ladder| {
                    let mut row = vec![contact_words(ladder.contact), plain(ladder.k, 3)];
                    row.extend(
                        ladder.steps.iter().map(|s| optional_fixed(s.prediction.slap_down_speed_m_s, 2)),
                    );
                    row.push(rung_short(ladder.suffices).to_owned());
                    row
                })
                .collect();
            let header =
                ["contact", "k", "rod", "body", "friction", "unilateral", "further\nimpacts", "suffices"];
            let mut out =
                heading(&format!("Models at {}°, each richer by one thing, m/s", degrees(many[0].angle_deg)));
            out.push_str(&block(&header, rows, &[1, 2, 3, 4, 5, 6]));
            out.push_str(&wrap(&suffices_sentence(), WIDTH, 2));
            out
        }
    }
}

fn suffices_sentence() -> String {
    format!(
        "suffices: the simplest that no richer one moves by more than {} %.",
        plain(LADDER_TOLERANCE_PERCENT, 3)
    )
}

fn one_ladder(ladder: &Ladder) -> String {
    let what = format!(
        "Models at {}°, {}, k = {}",
        degrees(ladder.angle_deg),
        contact_words(ladder.contact),
        plain(ladder.k, 3)
    );
    let rows: Vec<Vec<String>> = ladder
        .steps
        .iter()
        .map(|step| {
            vec![
                rung_short(step.rung).to_owned(),
                step.adds.to_owned(),
                optional_fixed(step.prediction.slap_down_speed_m_s, 2),
                step.change_percent.map_or_else(|| MISSING.to_owned(), percent),
            ]
        })
        .collect();
    let mut out = heading(&what);
    out.push_str(&columns(&["model", "adds", "v m/s", "change"], &rows, &[2, 3]));
    out.push_str(&wrap(&verdict(ladder), WIDTH, 2));
    out
}

/// Which rung suffices, and what the richer ones would change.
pub(super) fn verdict(ladder: &Ladder) -> String {
    let rung = ladder.suffices.words();
    if ladder.suffices == Rung::FurtherImpacts {
        return "Only the last suffices: each simpler one is moved by a richer one.".to_owned();
    }
    let tolerance = plain(LADDER_TOLERANCE_PERCENT, 3);
    let further = "no richer one moves the speed by more than";
    format!("The model \"{rung}\" suffices: {further} {tolerance} %.")
}

/// Gradients at the angle asked for, and where the speed does not tell k.
pub(super) fn sensitivities(study: &Study) -> String {
    let rows: Vec<Vec<String>> = study
        .sensitivities
        .iter()
        .map(|s| {
            let nearest = |values: &[f64]| nearest(&s.angle_deg, values, study.request.angle_deg);
            vec![
                s.model.as_str().to_owned(),
                contact_words(s.contact),
                plain(s.k, 3),
                optional_fixed(nearest(&s.by_k_m_s), 2),
                optional_fixed(nearest(&s.by_angle_m_s_deg), 3),
                angles_words(&s.blind_angles_deg, 2),
                widest_bands_words(&s.blind_bands_deg, 2),
            ]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let at = degrees(study.request.angle_deg);
    let mut out = heading(&format!("Sensitivity at {at}°, and where the speed does not tell k"));
    let header = ["model", "contact", "k", "dv/dk\nm/s", "dv/dφ\nm/s per °", "blind °", "poorly told °"];
    out.push_str(&block(&header, rows, &[2, 3, 4]));
    let text = "blind: dv/dk is nil there. Poorly told: 1 % of the speed is more than 0.1 in k. There k must come from \
                the rebound, the rotation or the flight time.";
    out.push_str(&wrap(text, WIDTH, 2));
    out
}
