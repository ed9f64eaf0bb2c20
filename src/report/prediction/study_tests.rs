//! Texts of a study on a terminal and on its page.

use super::super::sample_study;
use super::super::text::WIDTH;
use super::super::words::rung_short;
use super::rows::MOST_ON_PAGE;
use super::{study_files, study_table};
use crate::data::{BodyModel, Rung, Study, Sweep, SweepVariable};
use crate::report::pictures::study_names;

fn bare(study: &Study) -> String {
    anstream::adapter::strip_str(&study_table(study, WIDTH)).to_string()
}

#[test]
fn eighty_columns_hold_it() {
    let mut wide = sample_study::sweep_study();
    wide.rows.truncate(300);
    for (i, row) in wide.rows.iter_mut().enumerate() {
        row.drop_height_m = if i % 2 == 0 { 0.333 } else { 9.125 };
        row.angle_deg = 88.25;
        row.prediction.first_end_impacts = 2;
        row.prediction.closed_form_speed_m_s = Some(20.12);
    }
    wide.cask_file.cask.name = "A cask with a name ".repeat(8);
    let studies = [
        sample_study::study(),
        sample_study::sweep_study(),
        sample_study::without_slap_down(),
        sample_study::single_study(),
        wide,
    ];
    for study in studies {
        let text = bare(&study);
        for line in text.lines() {
            assert!(line.chars().count() <= WIDTH, "{} columns: {line}\n{text}", line.chars().count());
        }
    }
}

#[test]
fn a_somersault_is_marked_in_table_and_chart() {
    let mut study = sample_study::study();
    assert!(!bare(&study).contains('§'));
    study.rows[1].prediction.slap_down_angle_deg = Some(-374.0);
    study.curves[1].turns_over[60..70].fill(true);
    let text = bare(&study);
    let sentence = text.split_once("§ the cask turns over").expect("it says so").0;
    assert_eq!(sentence.matches("rough§").count(), 1, "{text}");
    let page = study_files(&study).unwrap().into_iter().find(|file| file.0 == "prediction.html").unwrap().1;
    assert!(String::from_utf8(page).unwrap().contains("Pale: the cask turns over"));
}

#[test]
fn every_block_has_its_figures() {
    let mut study = sample_study::study();
    study.critical[0].bands_deg = vec![(0.0, 24.2), (61.0, 70.0)];
    let text = bare(&study);
    for words in [
        "held: closed form for k = 0",
        "Critical angles",
        "1.9 (0–14)",
        "4 (0–24.2, …)",
        "Monte Carlo, 100 draws of the body",
        "3.5° (0.9–8.2)",
        "seed 1",
        "Drop between 5° and 10°",
        "Your 15° gives 21.87 m/s (95 %",
        "suffices: the simplest that no richer one moves by more than 0.1 %",
        "rod 30.15 m/s at 89°",
    ] {
        assert!(text.contains(words), "{words} is missing in\n{text}");
    }
}

#[test]
fn where_no_band_is_what_is_too_uncertain_is_said() {
    let mut study = sample_study::study();
    study.advice.band_deg = None;
    let said = |study: &Study| bare(study).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said(&study).contains("largest: k, friction and the contact's length are too uncertain."));
    (study.advice.drawn.friction, study.advice.drawn.contact_s) = (None, (0.02, 0.02));
    (study.advice.own_share, study.advice.own_m_s) = (0.25, f64::NAN);
    let said = said(&study);
    assert!(said.contains("largest: k is too uncertain.") && !said.contains("Your 15°"), "{said}");
    assert!(said.contains("Of the draws at 15° 75 % have no slap-down."), "{said}");
}

#[test]
fn the_limits_are_those_of_the_request() {
    let mut study = sample_study::study();
    assert!(made(&study).contains("first contact an impulse, draws: first contact 5 to 30 ms (uniform);"));
    study.cask_file.drop.contact_duration_s = 0.02;
    study.advice.drawn.contact_s = (0.02, 0.02);
    let page = made(&study);
    assert!(page.contains("first contact 20 ms, draws: first contact 20 ms;"));
    assert!(!page.contains("no time") && !page.contains("an impulse,"));
}

#[test]
fn one_case_shows_every_rung() {
    let text = bare(&sample_study::single_study());
    for rung in Rung::ALL {
        assert!(text.contains(&rung_short(rung)) && text.contains(rung.physics()), "{text}");
    }
    assert!(text.contains("−13.3 %") && text.contains("The model \"body\" suffices"), "{text}");
}

#[test]
fn without_draws_there_is_no_block_of_them() {
    let mut study = sample_study::study();
    study.monte_carlo.uncertain.draws = 0;
    for q in &mut study.monte_carlo.quantiles {
        q.critical_angle_deg = [f64::NAN; 5];
    }
    assert!(!bare(&study).contains("Monte Carlo"));
}

#[test]
fn a_long_table_shows_its_ends_and_says_what_is_left_out() {
    let study = sample_study::sweep_study();
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
    assert!(row.contains("19.81") && row.ends_with("20.12"), "{row}");
    study.rows.retain(|row| row.prediction.k > 0.0);
    assert!(!bare(&study).contains("held"));
}

#[test]
fn names_from_files_cannot_colour_the_terminal() {
    let mut study = sample_study::study();
    study.cask_file.cask.name = "\u{1b}[31mX".into();
    assert!(!study_table(&study, WIDTH).contains("\u{1b}[31m"));
}

#[test]
fn the_friction_that_sticking_needs_is_said_once() {
    let mut study = sample_study::study();
    assert!(bare(&study).contains("friction is at least 0.624 (rod), 0.741 (body)"));
    study.request.sweeps = vec![Sweep { variable: SweepVariable::Angle, values: vec![15.0, 16.0] }];
    // It depends on the angle: over several there is no one value.
    let body = study.rows.iter().position(|row| row.prediction.model == BodyModel::Body).unwrap();
    study.rows[body].prediction.friction_to_stick = 0.5;
    assert!(!bare(&study).contains("friction is at least"));
}

fn made(study: &Study) -> String {
    String::from_utf8(study_files(study).unwrap().swap_remove(0).1).unwrap()
}

#[test]
fn it_stands_alone() {
    let page = made(&sample_study::study());
    for call in ["src=", "href=", "url(", "@import", "<script", "http://", "https://"] {
        let hits = page.matches(call).count();
        // The only address is the name of the SVG vocabulary.
        let allowed = if call == "http://" { page.matches("http://www.w3.org/2000/svg").count() } else { 0 };
        assert_eq!(hits, allowed, "{call}");
    }
    assert!(page.len() < 1_500_000, "{} bytes", page.len());
}

#[test]
fn it_shows_every_picture() {
    for study in [sample_study::study(), sample_study::sweep_study(), sample_study::without_slap_down()] {
        let page = made(&study);
        assert_eq!(page.matches("<figure").count(), study_names(&study.request).len());
    }
}

#[test]
fn words_from_files_are_escaped() {
    let mut study = sample_study::study();
    let evil = "<img src=x onerror=alert(1)>\"'\u{1b}[2J";
    study.cask_file.cask.name = evil.into();
    study.cask_file.path = evil.into();
    study.cask_file.sha256 = evil.into();
    let page = made(&study);
    assert!(!page.contains("<img") && !page.contains('\u{1b}'));
    assert!(page.contains("&lt;img"));
}

#[test]
fn a_long_sweep_points_to_the_csv() {
    let study = sample_study::sweep_study();
    let page = made(&study);
    assert!(study.rows.len() > MOST_ON_PAGE);
    assert!(page.contains(&format!("{} more", study.rows.len() - MOST_ON_PAGE)));
    assert!(page.contains("prediction.csv"));
    assert!(page.find("All predictions") > page.find("Monte Carlo"));
}

#[test]
fn without_a_slap_down_it_says_so() {
    assert!(made(&sample_study::without_slap_down()).contains("the second end never strikes"));
}
