//! The tables of `prediction.html`: what was asked, the predictions, the ladder, critical angles, Monte Carlo, sensitivities.

use super::super::rounding::{MISSING, fixed, optional, optional_fixed, percent, plain};
use super::super::text::{printable, sentence};
use super::models::verdict;
use super::summary::{has_quantiles, larger_sentence, nearest};
use super::words::{
    KEPT_SENTENCE, bands_words, contact_words, criterion_value, criterion_words, degrees, has_ranges,
    kept_mark, range_words, rung_short, through_words, uncertain_words, variable_words,
};
use crate::data::{
    Criterion, CriticalAngle, LADDER_TOLERANCE_PERCENT, Ladder, PredictionRow, Request, Rung, Study, Sweep,
};
use maud::{Markup, html};

/// Predictions on the page; the CSV has them all.
pub(super) const MOST_ROWS: usize = 200;
/// Rows of any other table.
const MOST_CASES: usize = 48;

/// Contact laws, k, angle and sweeps.
pub(super) fn asked(study: &Study) -> Markup {
    let Request { contacts, ks, angle_deg, sweeps, band_percent, .. } = &study.request;
    let contacts: Vec<String> = contacts.iter().map(|c| contact_words(*c)).collect();
    let ks: Vec<String> = ks.iter().map(|k| plain(*k, 3)).collect();
    html! {
        table class="whole" {
            caption { "Cases" }
            tbody {
                tr { th scope="row" { "Contact of the first end" } td { (contacts.join(", ")) } }
                tr { th scope="row" { "Coefficient of restitution k" } td { (ks.join(", ")) } }
                tr { th scope="row" { "Drop angle, where one is needed" } td { (plain(*angle_deg, 4)) "°" } }
                @for sweep in sweeps { tr { th scope="row" { "Sweep: " (variable_words(sweep.variable)) } td { (sweep_words(sweep)) } } }
                tr { th scope="row" { "Critical band" } td { "within " (plain(*band_percent, 3)) " % of the largest value" } }
            }
        }
    }
}

fn sweep_words(sweep: &Sweep) -> String {
    match (sweep.values.first(), sweep.values.last()) {
        (Some(from), Some(to)) => format!("{}, {} values", range_words((*from, *to)), sweep.values.len()),
        _ => MISSING.to_owned(),
    }
}

/// The predictions asked for.
pub(super) fn predictions(study: &Study) -> Markup {
    let left_out = study.rows.len().saturating_sub(MOST_ROWS);
    let rows = &study.rows[..study.rows.len() - left_out];
    let any = |wanted: fn(&PredictionRow) -> bool| study.rows.iter().any(wanted);
    let varies = |value: fn(&PredictionRow) -> f64| {
        study.rows.iter().any(|row| value(row).to_bits() != value(&study.rows[0]).to_bits())
    };
    let (lengths, heights) = (varies(|r| r.length_m), varies(|r| r.drop_height_m));
    let held = any(|row| row.prediction.closed_form_speed_m_s.is_some());
    html! {
        table class="many" {
            caption { "Velocity of the second end just before it strikes. Energy: kinetic, before the slap-down over before the first impact."
                @if held { " Closed form: [P] Table 2 for k = 0, the first end held on the target whatever the force." } }
            thead { tr {
                th class="n" { "φ0, °" } @if lengths { th class="n" { "Length, m" } } @if heights { th class="n" { "Drop, m" } }
                th { "Model" } th { "Contact" } th class="n" { "k" } th class="n" { "Speed, m/s" } th class="n" { "Vertical, m/s" }
                th class="n" { "Horizontal, m/s" } th class="n" { "ω, rad/s" } th class="n" { "Flight, ms" } th class="n" { "Energy" }
                th class="n" { "Friction to stick" } th class="n" { "Impacts of first end" } @if held { th class="n" { "Closed form, m/s" } }
            } }
            tbody { @for row in rows { (prediction(row, [lengths, heights, held])) } }
        }
        @if left_out > 0 { p class="note" { "… and " (left_out) " more: prediction.csv and prediction.json hold them all." } }
        @if any(|row| row.prediction.slap_down_speed_m_s.is_none()) { p class="note" { "– the second end never strikes by this impact alone." } }
        @if any(|row| !kept_mark(row.prediction.regime).is_empty()) { p class="note" { (KEPT_SENTENCE) } }
    }
}

fn prediction(row: &PredictionRow, [lengths, heights, held]: [bool; 3]) -> Markup {
    let p = &row.prediction;
    html! { tr {
        td class="n" { (plain(row.angle_deg, 6)) }
        @if lengths { td class="n" { (plain(row.length_m, 5)) } } @if heights { td class="n" { (plain(row.drop_height_m, 5)) } }
        td { (p.model.as_str()) } td class="u" { (contact_words(p.contact)) (kept_mark(p.regime)) } td class="n" { (plain(p.k, 3)) }
        td class="n" { (optional_fixed(p.slap_down_speed_m_s, 2)) } td class="n" { (optional_fixed(p.vertical_velocity_m_s, 2)) }
        td class="n" { (optional_fixed(p.horizontal_velocity_m_s, 2)) } td class="n" { (fixed(p.angular_velocity_rad_s, 2)) }
        td class="n" { (optional_fixed(p.flight_time_s.map(|t| t * 1e3), 1)) } td class="n" { (optional_fixed(p.energy_ratio, 3)) }
        td class="n" { (optional(Some(p.friction_to_stick), 3)) } td class="n" { (p.first_end_impacts) }
        @if held { td class="n" { @if let Some(v) = p.closed_form_speed_m_s { (optional_fixed(Some(v), 2)) } } }
    } }
}

/// Every rung's speed, and which suffices.
pub(super) fn ladders(study: &Study) -> Markup {
    let Some(first) = study.ladders.first() else { return html! {} };
    let left_out = study.ladders.len().saturating_sub(MOST_CASES);
    html! {
        h2 { "Models" }
        p class="lead" { "Slap-down speed, m/s, at " (degrees(first.angle_deg)) "° by each model, the simplest first; each adds one thing to the one \
            before it. One suffices where no richer one moves the speed by more than " (plain(LADDER_TOLERANCE_PERCENT, 3)) " %." }
        @if let [one] = &study.ladders[..] { (one_ladder(one)) } @else {
            table class="whole" {
                thead { tr { th { "Contact" } th class="n" { "k" }
                    @for rung in Rung::ALL { th class="n" { (sentence(rung_short(rung)).trim_end_matches('.')) } }
                    th { "Suffices" } } }
                tbody { @for ladder in study.ladders.iter().take(MOST_CASES) { tr {
                    td class="u" { (contact_words(ladder.contact)) } td class="n" { (plain(ladder.k, 3)) }
                    @for step in &ladder.steps { td class="n" { (optional_fixed(step.prediction.slap_down_speed_m_s, 2)) } }
                    td { (ladder.suffices.words()) }
                } } }
            }
            @if left_out > 0 { p class="note" { "… and " (left_out) " more: see prediction.json." } }
            p class="note" { @for (i, rung) in Rung::ALL.into_iter().enumerate() {
                @if i > 0 { "; " } (rung_short(rung)) " – " (rung.adds()) } ". L is the first end, R the second." }
        }
    }
}

fn one_ladder(ladder: &Ladder) -> Markup {
    html! {
        table class="whole" {
            caption { (contact_words(ladder.contact)) ", k = " (plain(ladder.k, 3)) }
            thead { tr { th { "Model" } th { "Adds" } th class="n" { "Speed, m/s" } th class="n" { "Change" } th class="n" { "Impacts of the first end" } } }
            tbody { @for step in &ladder.steps { tr class=[(step.rung == ladder.suffices).then_some("chosen")] {
                th scope="row" { (step.rung.words()) @if step.rung == ladder.suffices { " (suffices)" } } td { (step.adds) }
                td class="n" { (optional_fixed(step.prediction.slap_down_speed_m_s, 2)) }
                td class="n" { (step.change_percent.map_or_else(|| MISSING.into(), percent)) }
                td class="n" { (step.prediction.first_end_impacts) }
            } } }
        }
        p { (verdict(ladder)) }
    }
}

/// Critical angle, largest value and band of every case and criterion.
pub(super) fn critical(study: &Study) -> Markup {
    let speeds: Vec<&CriticalAngle> =
        study.critical.iter().filter(|c| c.criterion == Criterion::Speed).collect();
    let found = |of: &CriticalAngle, criterion| {
        let same = |c: &&CriticalAngle| (c.model, c.contact, c.k) == (of.model, of.contact, of.k);
        study.critical.iter().filter(same).find(move |c| c.criterion == criterion && c.angle_deg.is_finite())
    };
    let left_out = speeds.len().saturating_sub(MOST_CASES);
    html! {
        @if speeds.is_empty() { p { "No case has a slap-down at any angle." } } @else {
            table class="many" {
                caption { "At: the angle at which each is largest. Band: the angles within " (plain(study.request.band_percent, 3)) " % of that value." }
                thead {
                    tr { th colspan="3" {} @for criterion in Criterion::ALL { th class="group" colspan="3" { (sentence(criterion_words(criterion)).trim_end_matches('.')) } } }
                    tr { th { "Model" } th { "Contact" } th class="n" { "k" }
                        @for criterion in Criterion::ALL {
                            th class="n" { @if criterion == Criterion::EnergyRatio { "Largest" } @else { "Largest, m/s" } } th class="n" { "At, °" } th class="band" { "Band, °" } } }
                }
                tbody { @for of in speeds.iter().take(MOST_CASES) { tr {
                    td { (of.model.as_str()) } td class="u" { (contact_words(of.contact)) } td class="n" { (plain(of.k, 3)) }
                    @for criterion in Criterion::ALL {
                        @match found(of, criterion) {
                            Some(c) => { td class="n" { (criterion_value(criterion, c.largest).trim_end_matches(" m/s")) } td class="n" { (degrees(c.angle_deg)) } td class="band" { (bands_words(&c.bands_deg)) } },
                            None => { td class="n" { (MISSING) } td {} td {} },
                        }
                    }
                } } }
            }
            @if left_out > 0 { p class="note" { "… and " (left_out) " more: see prediction.json." } }
            @if let Some(text) = larger_sentence(study) { p class="note" { (text) } }
        }
    }
}

/// Critical angles over the ranges of k and friction.
pub(super) fn ranges(study: &Study) -> Markup {
    html! { @if !study.ranges.is_empty() && has_ranges(&study.request) {
        table class="whole" {
            caption { "Over " (through_words(&study.request)) ", all else as stated. Common band: the angles that lie in the band of every one of them." }
            thead { tr { th { "Model" } th { "Largest" } th class="n" { "Critical angle, °" } th class="n" { "Worst case" } th { "Where" } th { "Common band, °" } } }
            tbody { @for r in &study.ranges { tr {
                td { (r.model.as_str()) } td { (criterion_words(r.criterion)) } td class="n" { (bands_words(&[r.angle_deg])) }
                td class="n" { (criterion_value(r.criterion, r.largest)) }
                td { (degrees(r.worst.0)) "°, " (contact_words(r.worst.1)) ", k = " (plain(r.worst.2, 3)) }
                td { (bands_words(&r.common_bands_deg)) }
            } } }
        }
    } }
}

/// What was drawn from, and what came of it.
pub(super) fn monte_carlo(study: &Study) -> Markup {
    let found = &study.monte_carlo;
    if found.uncertain.draws == 0 {
        return html! { h2 { "Monte Carlo" } p { "No draws were asked for." } };
    }
    html! {
        h2 { "Monte Carlo" }
        p class="lead" { (found.uncertain.draws) " draws of the " (found.model.as_str()) ", seed " (found.uncertain.seed)
            ": what is not known before a test is drawn, and the critical angle sought for each draw." }
        div class="pair" {
            table class="whole" {
                caption { "Drawn" }
                tbody { @for (name, value) in uncertain_words(&found.uncertain, found.contact) { tr { th scope="row" { (name) } td { (value) } } } }
            }
            table class="whole" {
                caption { "Found: median and the range of 95 % of the draws. Robust band: there at least 95 % of the draws are within "
                    (plain(found.band_percent, 3)) " % of their own largest." }
                thead { tr { th { "Largest" } th class="n" { "Critical angle, °" } th class="n" { "How large" } th { "Robust band, °" } } }
                tbody {
                    @if has_quantiles(found) {
                        @for q in &found.quantiles { tr {
                            th scope="row" { (criterion_words(q.criterion)) }
                            td class="n" { (degrees(q.critical_angle_deg[2])) " (" (bands_words(&[(q.critical_angle_deg[0], q.critical_angle_deg[4])])) ")" }
                            td class="n" { (criterion_value(q.criterion, q.largest[2])) br; span class="soft" { (between(q.criterion, &q.largest)) } }
                            td { (bands_words(&q.robust_bands_deg)) }
                        } }
                    } @else { tr { td colspan="4" { "none: too few draws have a slap-down" } } }
                }
            }
        }
    }
}

/// The outer quantiles, without their unit.
fn between(criterion: Criterion, quantiles: &[f64; 5]) -> String {
    let bare = |value| criterion_value(criterion, value).trim_end_matches(" m/s").to_owned();
    format!("({}–{})", bare(quantiles[0]), bare(quantiles[4]))
}

/// Gradients at the angle asked for, and where the speed does not tell k.
pub(super) fn sensitivities(study: &Study) -> Markup {
    let at = study.request.angle_deg;
    let single = |angles: &[f64]| angles.iter().map(|a| (*a, *a)).collect::<Vec<_>>();
    html! {
        h2 { "Sensitivity" }
        @if !study.sensitivities.is_empty() {
            table class="whole" {
                caption { "Gradient of the slap-down speed at " (plain(at, 4)) "°. Blind angle: ∂v/∂k is nil and k cannot be told from the speed. \
                    Poorly told: 1 % of the speed is more than 0.1 in k." }
                thead { tr { th { "Model" } th { "Contact" } th class="n" { "k" } th class="n" { "∂v/∂k, m/s" } th class="n" { "∂v/∂φ, m/s per °" }
                    th { "Blind angle, °" } th { "k poorly told, °" } } }
                tbody { @for s in study.sensitivities.iter().take(MOST_CASES) { tr {
                    td { (s.model.as_str()) } td class="u" { (contact_words(s.contact)) } td class="n" { (plain(s.k, 3)) }
                    td class="n" { (optional_fixed(nearest(&s.angle_deg, &s.by_k_m_s, at), 2)) }
                    td class="n" { (optional_fixed(nearest(&s.angle_deg, &s.by_angle_m_s_deg, at), 3)) }
                    td { (bands_words(&single(&s.blind_angles_deg))) } td { (bands_words(&s.blind_bands_deg)) }
                } } }
            }
        }
    }
}

/// Which file, which version.
pub(super) fn provenance(study: &Study) -> Markup {
    html! {
        h2 { "Provenance" }
        table class="whole" { tbody {
            tr { th scope="row" { "Cask file" } td { (printable(&study.cask_file.path.display().to_string())) } }
            tr { th scope="row" { "its SHA-256" } td { code { (printable(&study.cask_file.sha256)) } } }
            tr { th scope="row" { "Program" } td { "dropcheck " (env!("CARGO_PKG_VERSION")) " · schema dropcheck.prediction/1" } }
        } }
    }
}
