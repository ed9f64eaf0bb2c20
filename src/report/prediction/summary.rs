//! What a study found besides its predictions to blocks for the terminal, 80 columns wide.

use super::super::columns::{columns, fitting_columns};
use super::super::rounding::{MISSING, fixed, optional_fixed, percent, plain};
use super::super::text::{Style, WIDTH, styled, wrap};
use super::words::{
    angles_words, band_around_words, bands_words, contact_words, criterion_short, criterion_value, degrees,
    rung_short, through_words, uncertain_short, widest_bands_words,
};
use crate::data::{
    BodyModel, Criterion, CriticalAngle, LADDER_TOLERANCE_PERCENT, Ladder, MonteCarlo, Rung, Study,
};

/// Rows of a block: more are in the JSON.
const MOST_ROWS: usize = 16;

/// Every block that has something to say.
pub(super) fn blocks(study: &Study) -> String {
    [critical(study), ranges(study), monte_carlo(study), ladders(study), blind(study)].concat()
}

fn heading(words: &str) -> String {
    format!("\n{}\n", styled(Style::Bold, words))
}

/// The rows that fit a block, and a line that says how many are left out.
fn block(header: &[&str], mut rows: Vec<Vec<String>>, right: &[usize]) -> String {
    let left_out = rows.len().saturating_sub(MOST_ROWS);
    rows.truncate(MOST_ROWS);
    let mut out = fitting_columns(header, &rows, right);
    if left_out > 0 {
        out.push_str(&wrap(&format!("… and {left_out} more: see prediction.json."), WIDTH, 2));
    }
    out
}

fn critical(study: &Study) -> String {
    if study.critical.is_empty() {
        return String::new();
    }
    let band = plain(study.request.band_percent, 3);
    let mut out = heading("Critical angles");
    out.push_str(&wrap(
        &format!("Where each is largest, °, and the angles within {band} % of it."),
        WIDTH,
        2,
    ));
    let mut rows: Vec<Vec<String>> = Vec::new();
    for speed in study.critical.iter().filter(|c| c.criterion == Criterion::Speed) {
        let same = |c: &&CriticalAngle| (c.model, c.contact, c.k) == (speed.model, speed.contact, speed.k);
        let place = |criterion| {
            let found = study.critical.iter().filter(same).find(|c| c.criterion == criterion);
            found.filter(|c| c.angle_deg.is_finite()).map_or_else(
                || MISSING.to_owned(),
                |c| format!("{} ({})", degrees(c.angle_deg), band_around_words(&c.bands_deg, c.angle_deg)),
            )
        };
        rows.push(vec![
            speed.model.as_str().to_owned(),
            contact_words(speed.contact),
            plain(speed.k, 3),
            optional_fixed(Some(speed.largest), 2),
            place(Criterion::Speed),
            place(Criterion::VerticalSpeed),
            place(Criterion::EnergyRatio),
        ]);
    }
    let header = ["model", "contact", "k", "v m/s", "speed", "vertical", "energy"];
    out.push_str(&block(&header, rows, &[2, 3]));
    out.push_str(&larger_sentence(study).map_or_else(String::new, |text| wrap(&text, WIDTH, 2)));
    out
}

/// Where the speed is larger still, as the first end strikes again before the second.
pub(super) fn larger_sentence(study: &Study) -> Option<String> {
    let larger = study.ranges.iter().filter(|r| r.criterion == Criterion::Speed);
    let larger = larger.filter_map(|r| r.further_impacts.map(|at| (r.model, at)));
    let of_cases = study.critical.iter().filter(|c| c.criterion == Criterion::Speed);
    let of_cases = of_cases.filter_map(|c| c.further_impacts.map(|at| (c.model, at)));
    let all: Vec<(BodyModel, (f64, f64))> = larger.chain(of_cases).collect();
    let most = |model: BodyModel| {
        let of_model = all.iter().filter(|found| found.0 == model).map(|found| found.1);
        let (angle_deg, speed) = of_model.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!("{} {} m/s at {}°", model.as_str(), fixed(speed, 2), degrees(angle_deg)))
    };
    let words: Vec<String> = [BodyModel::Rod, BodyModel::Body].into_iter().filter_map(most).collect();
    (!words.is_empty()).then(|| {
        format!(
            "While the first end strikes once. Where it strikes again the speed jumps from angle to angle and can be larger: {}.",
            words.join(", ")
        )
    })
}

fn ranges(study: &Study) -> String {
    if study.ranges.is_empty() {
        return String::new();
    }
    let rows = study
        .ranges
        .iter()
        .map(|r| {
            let (angle_deg, contact, k) = r.worst;
            vec![
                r.model.as_str().to_owned(),
                criterion_short(r.criterion).to_owned(),
                bands_words(&[r.angle_deg]),
                criterion_value(r.criterion, r.largest),
                format!("{}°, {}, k = {}", degrees(angle_deg), contact_words(contact), plain(k, 3)),
                widest_bands_words(&r.common_bands_deg, 2),
            ]
        })
        .collect();
    let header = ["model", "largest", "critical °", "worst", "at", "every band °"];
    heading(&format!("Over {}", through_words(&study.request))) + &block(&header, rows, &[])
}

/// Whether any draw had a slap-down; where none was asked for there is none.
pub(super) fn has_quantiles(found: &MonteCarlo) -> bool {
    found.quantiles.iter().any(|q| q.critical_angle_deg[2].is_finite())
}

fn monte_carlo(study: &Study) -> String {
    let found = &study.monte_carlo;
    if !has_quantiles(found) {
        return String::new();
    }
    let u = &found.uncertain;
    let mut out = heading(&format!("Monte Carlo, {} draws of the {}", u.draws, found.model.as_str()));
    out.push_str(&wrap(&uncertain_short(u, found.contact), WIDTH, 2));
    let between = |low: f64, high: f64, decimals| {
        format!("{}–{}", optional_fixed(Some(low), decimals), optional_fixed(Some(high), decimals))
    };
    let rows = found
        .quantiles
        .iter()
        .map(|q| {
            let (angles, largest) = (&q.critical_angle_deg, &q.largest);
            let decimals = if q.criterion == Criterion::EnergyRatio { 3 } else { 2 };
            vec![
                criterion_short(q.criterion).to_owned(),
                format!("{}° ({})", degrees(angles[2]), bands_words(&[(angles[0], angles[4])])),
                format!(
                    "{} ({})",
                    optional_fixed(Some(largest[2]), decimals),
                    between(largest[0], largest[4], decimals)
                ),
                widest_bands_words(&q.robust_bands_deg, 3),
            ]
        })
        .collect();
    out.push_str(&block(&["largest", "critical (95 %)", "how large (95 %)", "robust band °"], rows, &[]));
    let band = plain(found.band_percent, 3);
    let text = format!("robust: there at least 95 % of the draws are within {band} % of their own largest.");
    out.push_str(&wrap(&text, WIDTH, 2));
    out.push_str(&at_the_angle(study).map_or_else(String::new, |text| wrap(&text, WIDTH, 2)));
    out
}

/// What the draws say of the slap-down speed at the angle asked for.
fn at_the_angle(study: &Study) -> Option<String> {
    let found = &study.monte_carlo;
    let q = found.quantiles.iter().find(|q| q.criterion == Criterion::Speed)?;
    let at = |values: &[f64]| nearest(&found.angle_deg, values, study.request.angle_deg);
    Some(format!(
        "At {}°: {} m/s, 95 % of the draws between {} and {} m/s.",
        degrees(at(&found.angle_deg)?),
        fixed(at(&q.q50)?, 2),
        fixed(at(&q.q025)?, 2),
        fixed(at(&q.q975)?, 2)
    ))
}

fn ladders(study: &Study) -> String {
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

fn blind(study: &Study) -> String {
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

/// The value at the angle nearest to `at_deg`.
pub(super) fn nearest(angles_deg: &[f64], values: &[f64], at_deg: f64) -> Option<f64> {
    let off = |angle: &f64| (angle - at_deg).abs();
    let pairs = angles_deg.iter().zip(values);
    pairs.min_by(|a, b| off(a.0).total_cmp(&off(b.0))).map(|(_, v)| *v).filter(|v| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::super::super::sample_study;
    use super::super::table::study_table;
    use super::*;
    use crate::data::{Sweep, SweepVariable};

    fn bare(study: &Study) -> String {
        anstream::adapter::strip_str(&study_table(study)).to_string()
    }

    /// One contact law and one k at one angle.
    fn single() -> Study {
        let mut study = sample_study::swept();
        study.rows.retain(|row| row.angle_deg.to_bits() == 15.0_f64.to_bits());
        study.request.sweeps.clear();
        study.ladders.truncate(1);
        study
    }

    #[test]
    fn eighty_columns_hold_it() {
        let mut wide = sample_study::swept();
        wide.rows.truncate(300);
        for (i, row) in wide.rows.iter_mut().enumerate() {
            row.drop_height_m = if i % 2 == 0 { 0.333 } else { 9.125 };
            row.angle_deg = 88.25;
            row.prediction.first_end_impacts = 2;
            row.prediction.closed_form_speed_m_s = Some(20.12);
        }
        wide.cask_file.cask.name = "A cask with a name ".repeat(8);
        let studies =
            [sample_study::study(), sample_study::swept(), sample_study::without_slap_down(), single(), wide];
        for study in studies {
            let text = bare(&study);
            for line in text.lines() {
                assert!(line.chars().count() <= WIDTH, "{} columns: {line}\n{text}", line.chars().count());
            }
        }
    }

    #[test]
    fn every_block_has_its_figures() {
        let text = bare(&sample_study::study());
        for words in [
            "held: closed form for k = 0",
            "Critical angles",
            "12 (3.5–28)",
            "12 (0–24.2, …)",
            "Over k 0 to 1 and μ 0.2 to 0.6",
            "12°, rough, k = 1",
            "Monte Carlo, 2000 draws of the body",
            "12° (4.5–19.5)",
            "seed 1",
            "At 15°: ",
            "suffices: the simplest that no richer one moves by more than 0.1 %",
            "35.3",
            "rod 30.20 m/s at 89°",
        ] {
            assert!(text.contains(words), "{words} is missing in\n{text}");
        }
    }

    #[test]
    fn one_case_shows_every_rung() {
        let text = bare(&single());
        for rung in Rung::ALL {
            assert!(text.contains(rung_short(rung)) && text.contains(rung.adds()), "{text}");
        }
        assert!(text.contains("−8.0 %") && text.contains("The model \"body\" suffices"), "{text}");
    }

    #[test]
    fn a_long_table_shows_its_ends_and_says_what_is_left_out() {
        let study = sample_study::swept();
        let text = bare(&study);
        assert!(text.contains(&format!(
            "… {} of {} rows are left out here",
            study.rows.len() - 24,
            study.rows.len()
        )));
        assert!(text.lines().count() < 100, "{text}");
        let first = text.lines().filter(|line| line.trim_start().starts_with("0 ")).count();
        let last = text.lines().filter(|line| line.trim_start().starts_with("90 ")).count();
        // Three lengths of two bodies at 0° and at 90°: the twelve rows at either end reach over both.
        assert_eq!((first, last), (6, 6), "{text}");
    }

    #[test]
    fn the_closed_form_stands_beside_the_flying_value() {
        let mut study = sample_study::study();
        study.rows[0].prediction.closed_form_speed_m_s = Some(20.12);
        let text = bare(&study);
        let row = text.lines().find(|line| line.trim_start().starts_with("15  rod    rough    0")).unwrap();
        assert!(row.contains("19.9") && row.ends_with("20.12"), "{row}");
        study.rows.retain(|row| row.prediction.k > 0.0);
        assert!(!bare(&study).contains("held"));
    }

    #[test]
    fn names_from_files_cannot_colour_the_terminal() {
        let mut study = sample_study::study();
        study.cask_file.cask.name = "\u{1b}[31mX".into();
        assert!(!study_table(&study).contains("\u{1b}[31m"));
    }

    #[test]
    fn the_friction_that_sticking_needs_is_said_once() {
        let mut study = sample_study::study();
        assert!(bare(&study).contains("friction is at least 0.624 (rod), 0.624 (body)"));
        study.request.sweeps = vec![Sweep { variable: SweepVariable::Angle, values: vec![15.0, 16.0] }];
        // It depends on the angle: over several there is no one value.
        let body = study.rows.iter().position(|row| row.prediction.model == BodyModel::Body).unwrap();
        study.rows[body].prediction.friction_to_stick = 0.5;
        assert!(!bare(&study).contains("friction is at least"));
    }
}
