//! Document of a study, for the terminal and `prediction.html`.

use super::super::document::{
    Chapter, ChapterPart, Fact, Frame, Medium, PartContent, ReportDocument, ReportTable,
};
use super::super::pictures::study_names;
use super::super::record::test_chapter;
use super::super::rounding::{MISSING, fixed, plain};
use super::super::words::{
    bands_words, contact_length_words, contact_words, criterion_value, degrees, range_words, variable_words,
};
use super::critical::{advice, critical, monte_carlo, speeds};
use super::models::models_chapter;
use super::models::plan;
use super::rows::{predictions, title};
use crate::data::{Criterion, Study, StudyRequest, Sweep};

/// A longer table of predictions goes to the end of the page, after the results.
const MOST_ROWS_AHEAD: usize = 40;

/// Other limits of the models, one or two sentences per line.
const LIMITS: &str = include_str!("limits.txt");

/// The whole document.
pub(super) fn document(study: &Study) -> ReportDocument {
    let file = &study.cask_file;
    let name = &file.cask.name;
    let on_page = predictions(&study.rows, Medium::Page);
    let is_long = study.rows.len() > MOST_ROWS_AHEAD;
    let later = format!("The {} predictions stand at the end of this page.", study.rows.len());
    let (ahead, at_end) = if is_long {
        (vec![ChapterPart::text(later).only_on(Medium::Page)], on_page)
    } else {
        (on_page, Vec::new())
    };
    let asked = ChapterPart::facts("Cases", request_facts(&study.request)).only_on(Medium::Page);
    ReportDocument {
        page: Frame {
            title: format!("Prediction for {name}"),
            product: "Prediction report",
            heading: format!("{name}: slap-down prediction"),
            about: file.path.display().to_string(),
            footer: "The drop angle is the inclination of the cask's axis above the horizontal at first \
                     contact. The first end is the low one, the second end slaps down. Vertical velocities \
                     are positive up. [P]: the BAM paper on slap-down impacts of packagings (PATRAM).",
            style: include_str!("../prediction.css"),
            ..Frame::default()
        },
        chapters: vec![
            Chapter::new("")
                .then(ChapterPart::title(title(&study.rows, file)).only_on(Medium::Terminal))
                .with_all(advice(study).map(ChapterPart::text))
                .with_all(figures(study).map(ChapterPart::from)),
            test_chapter(file, "What was asked").then(asked).only_on(Medium::Page),
            monte_carlo(study),
            Chapter::new("Predictions")
                .with_all(predictions(&study.rows, Medium::Terminal))
                .with_all(ahead)
                .then(ChapterPart::picture("sweep", "")),
            critical(study),
            angle_chapter(&study.request),
            models_chapter(study),
            study.plan.as_ref().map_or_else(|| Chapter::new(""), plan),
            paper_chapter(),
            Chapter::new("Limits").then(PartContent::List(limits(study))),
            Chapter::new("All predictions").with_all(at_end),
            provenance(study),
        ],
    }
}

/// Limits of the models, with the duration of the first impact in this study.
fn limits(study: &Study) -> Vec<String> {
    let lasts_s = study.cask_file.drop.contact_duration_s;
    let [stated, drawn] = [(lasts_s, lasts_s), study.advice.drawn.contact_s].map(contact_length_words);
    let first = format!(
        "One plane, a rigid cask and a rigid target. Tables and charts: {stated}, draws: {drawn}; a pulse is \
         a half sine, and later impacts are impulses."
    );
    std::iter::once(first).chain(LIMITS.lines().map(str::to_owned)).collect()
}

/// The pictures over the angle, in the order of their files.
fn angle_chapter(request: &StudyRequest) -> Chapter {
    let is_wanted = |name: &String| {
        ["smooth-rough", "speeds", "positions", "energy-ratio", "section"].contains(&name.as_str())
            || name.starts_with("components-")
    };
    let names = study_names(request).into_iter().filter(is_wanted);
    Chapter::new("Over the drop angle").with_all(names.map(|name| ChapterPart::picture(&name, "short")))
}

/// The three headline figures, over all uncertain inputs.
fn figures(study: &Study) -> Option<PartContent> {
    let (drawn, advice) = (&study.monte_carlo, &study.advice);
    let median = speeds(drawn)?.largest[2];
    let speed = |value| criterion_value(Criterion::Speed, value);
    let ((low, high), band) = (advice.own_range_m_s, plain(drawn.band_percent, 3));
    let near = format!("within {band} % of the draw's largest speed in 95 % of them");
    let at = format!("at {}°; half of the draws reach {}", degrees(advice.at_deg), speed(median));
    let own = format!("95 % of the draws {} to {}", fixed(low, 2), speed(high));
    Some(PartContent::Figures(vec![
        ["Where to drop, °".to_owned(), bands_words(advice.band_deg.as_slice()), near],
        ["Largest slap-down speed".to_owned(), speed(advice.largest_m_s), at],
        [format!("At {}°", plain(advice.own_deg, 4)), speed(advice.own_m_s), own],
    ]))
}

/// Contact laws, k, angle and sweeps.
fn request_facts(request: &StudyRequest) -> Vec<Fact> {
    let contacts: Vec<String> = request.contacts.iter().map(|c| contact_words(*c)).collect();
    let ks: Vec<String> = request.ks.iter().map(|k| plain(*k, 3)).collect();
    let band = format!("within {} % of the largest value", plain(request.band_percent, 3));
    let mut facts = vec![
        Fact::words("Contact of the first end", contacts.join(", ")),
        Fact::words("Coefficient of restitution k", ks.join(", ")),
        Fact::words("Drop angle, where one is needed", format!("{}°", plain(request.angle_deg, 4))),
    ];
    let sweep = |s: &Sweep| Fact::words(format!("Sweep: {}", variable_words(s.variable)), sweep_words(s));
    facts.extend(request.sweeps.iter().map(sweep));
    facts.push(Fact::words("Critical band", band));
    facts
}

fn sweep_words(sweep: &Sweep) -> String {
    match (sweep.values.first(), sweep.values.last()) {
        (Some(from), Some(to)) => format!("{}, {} values", range_words((*from, *to)), sweep.values.len()),
        _ => MISSING.to_owned(),
    }
}

/// Figures and tables of the paper, the file of this report that shows the same, and its content.
const OF_THE_PAPER: &str = include_str!("of_the_paper.tsv");

fn paper_chapter() -> Chapter {
    let rows: Vec<Vec<&str>> = OF_THE_PAPER.lines().map(|line| line.split('\t').collect()).collect();
    let table = ReportTable::from_rows(&rows)
        .head("[P]", |row| row[0])
        .code("File", |row| row[1])
        .text("Shows", |row| row[2]);
    Chapter::new("Figures and tables of the paper").only_on(Medium::Page).then(table)
}

/// Chapter on file and version.
fn provenance(study: &Study) -> Chapter {
    let facts = vec![
        Fact::words("Cask file", study.cask_file.path.display().to_string()),
        Fact::code("its SHA-256", &study.cask_file.sha256[..]),
        Fact::words(
            "Program",
            format!("dropcheck {} · schema dropcheck.prediction/1", env!("CARGO_PKG_VERSION")),
        ),
    ];
    Chapter::new("Provenance").only_on(Medium::Page).then(ChapterPart::facts("", facts))
}
