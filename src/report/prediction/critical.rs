//! Chapters on the critical angles of a study, as stated and under uncertain inputs.

use super::super::document::{Chapter, ChapterPart, Medium, ReportTable, TableShape, Words};
use super::super::rounding::{MISSING, fixed, plain};
use super::super::words::{
    MOST_ON_PAGE, MOST_ROWS, OTHERS, band_around_words, bands_words, contact_length_words, contact_words,
    criterion_short, criterion_value, criterion_words, degrees, uncertain_words,
};

use crate::data::{
    Advice, BodyModel, Criterion, CriticalAngle, MonteCarlo, QuantileCurves, Study, Uncertain,
};

/// Formats a value of the criterion, with the unit left to the head of its column.
fn format_value(criterion: Criterion, value: f64) -> String {
    criterion_value(criterion, value).trim_end_matches(" m/s").to_owned()
}

/// Chapter on critical angle, largest value and band of every case and criterion.
pub(super) fn critical(study: &Study) -> Chapter {
    let speeds: Vec<&CriticalAngle> =
        study.critical.iter().filter(|c| c.criterion == Criterion::Speed).collect();
    let chapter = Chapter::new("Critical angles");
    let picture = ChapterPart::picture("critical-angles", "tall");
    if speeds.is_empty() {
        let none = ChapterPart::text("No case has a slap-down at any angle.").only_on(Medium::Page);
        return chapter.then(none).then(picture);
    }
    let found = |case: &CriticalAngle, criterion| {
        let same = |c: &&CriticalAngle| (c.model, c.contact, c.k) == (case.model, case.contact, case.k);
        study.critical.iter().filter(same).find(|c| c.criterion == criterion && c.angle_deg.is_finite())
    };
    let largest = |criterion| {
        move |case: &&CriticalAngle| {
            found(case, criterion).map_or(MISSING.into(), |c| format_value(criterion, c.largest))
        }
    };
    let place = |criterion| {
        move |case: &&CriticalAngle| {
            let Some(c) = found(case, criterion) else { return MISSING.into() };
            let at = degrees(c.angle_deg);
            let around = band_around_words(&c.bands_deg, c.angle_deg);
            Words::with_short(format!("{at} ({})", bands_words(&c.bands_deg)), format!("{at} ({around})"))
        }
    };
    let at = |short: &str| Words::with_short("at, ° (band)", short);
    let table = ReportTable::from_rows(&speeds)
        .class("many")
        .shape(TableShape::Fitting)
        .limit_rows(MOST_ROWS, MOST_ON_PAGE, OTHERS)
        .text(Words::with_short("Model", "model"), |c| c.model.as_str())
        .line(Words::with_short("Contact", "contact"), |c| contact_words(c.contact))
        .number("k", |c| plain(c.k, 3))
        .number(Words::with_short("Speed, m/s", "v m/s"), largest(Criterion::Speed))
        .text(at("speed"), place(Criterion::Speed))
        .number("Vertical, m/s", largest(Criterion::VerticalSpeed))
        .only_on(Medium::Page)
        .text(at("vertical"), place(Criterion::VerticalSpeed))
        .number("Energy ratio", largest(Criterion::EnergyRatio))
        .only_on(Medium::Page)
        .text(at("energy"), place(Criterion::EnergyRatio));
    let band = plain(study.request.band_percent, 3);
    let lasts_s = study.cask_file.drop.contact_duration_s;
    let lasts = contact_length_words((lasts_s, lasts_s));
    chapter
        .then(ChapterPart::lead(format!(
            "Where each is largest, °, and the angles within {band} % of it; {lasts}."
        )))
        .then(table)
        .with_all(larger_sentence(study).map(ChapterPart::note))
        .then(picture)
}

/// Sentence on a larger speed, if the first end strikes again before the second.
fn larger_sentence(study: &Study) -> Option<String> {
    let of_cases = study.critical.iter().filter(|c| c.criterion == Criterion::Speed);
    let of_cases = of_cases.filter_map(|c| c.further_impacts.map(|at| (c.model, at)));
    let all: Vec<(BodyModel, (f64, f64))> = of_cases.collect();
    let most = |model: BodyModel| {
        let of_model = all.iter().filter(|found| found.0 == model).map(|found| found.1);
        let (angle_deg, speed) = of_model.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!("{} {} m/s at {}°", model.as_str(), fixed(speed, 2), degrees(angle_deg)))
    };
    let words: Vec<String> = [BodyModel::Rod, BodyModel::Body].into_iter().filter_map(most).collect();
    (!words.is_empty()).then(|| {
        format!(
            "While the first end strikes once. Where it strikes again the speed jumps from angle to angle \
             and can be larger: {}.",
            words.join(", ")
        )
    })
}

/// Draws of the slap-down speed; `None` if none was requested or too few slap down.
pub(super) fn speeds(found: &MonteCarlo) -> Option<&QuantileCurves> {
    let has_any = |q: &&QuantileCurves| q.critical_angle_deg[2].is_finite();
    found.quantiles.iter().find(|q| q.criterion == Criterion::Speed).filter(has_any)
}

/// Sentence on the recommended angle, the largest speed of all, and the result at the requested angle.
pub(super) fn advice(study: &Study) -> Option<String> {
    let (found, advice) = (&study.monte_carlo, &study.advice);
    speeds(found)?;
    let near = format!("within {} % of that draw's largest", plain(found.band_percent, 3));
    let drop = advice.band_deg.map(|(from_deg, to_deg)| {
        let [from, to] = [from_deg, to_deg].map(degrees);
        format!("Drop between {from}° and {to}°: there the slap-down speed is {near} in 95 % of the draws.")
    });
    let none = || {
        let open = open_words(&advice.drawn);
        format!("At no angle is the slap-down speed of 95 % of the draws {near}: {open} too uncertain.")
    };
    let flat_deg = advice.drawn.angle_deg;
    let is_flat = advice.band_deg.is_some_and(|band| band.0 <= flat_deg);
    let flat = format!(" At {}° or flatter both ends may strike together.", degrees(flat_deg));
    let largest = criterion_value(Criterion::Speed, advice.largest_m_s);
    let largest = format!(" The largest of the cask's body is {largest}, at {}°.", degrees(advice.at_deg));
    let flat = if is_flat { flat } else { String::new() };
    Some([drop.unwrap_or_else(none), largest, angle_sentence(advice), flat].concat())
}

/// Names the inputs drawn from a range, with the verb.
fn open_words(drawn: &Uncertain) -> String {
    let ranges = [("k", drawn.k), ("friction", drawn.friction.unwrap_or_default())];
    let ranges = ranges.into_iter().chain([("the contact's length", drawn.contact_s)]);
    let open: Vec<&str> = ranges.filter(|(_, range)| range.0 < range.1).map(|(name, _)| name).collect();
    match &open[..] {
        [] => "cask and drop are".to_owned(),
        [one] => format!("{one} is"),
        [most @ .., last] => format!("{} and {last} are", most.join(", ")),
    }
}

/// Sentence on the slap-down speed at the requested angle in the draws.
fn angle_sentence(advice: &Advice) -> String {
    let (angle_deg, share) = (degrees(advice.own_deg), 1.0 - advice.own_share);
    let [own, low, high] =
        [advice.own_m_s, advice.own_range_m_s.0, advice.own_range_m_s.1].map(|v| fixed(v, 2));
    let speed = format!(" Your {angle_deg}° gives {own} m/s (95 % of the draws: {low} to {high}).");
    let none = format!(" Of the draws at {angle_deg}° {} % have no slap-down.", plain(100.0 * share, 2));
    let sentences = [(advice.own_m_s.is_finite(), speed), (share > 0.0, none)];
    sentences.into_iter().filter_map(|(is_so, words)| is_so.then_some(words)).collect()
}

/// Chapter on the inputs of the draws, and their results.
pub(super) fn monte_carlo(study: &Study) -> Chapter {
    let found = &study.monte_carlo;
    let u = &found.uncertain;
    if u.draws == 0 {
        let none = ChapterPart::text("No draws were asked for.");
        return Chapter::new("Monte Carlo").only_on(Medium::Page).then(none);
    }
    let chapter = Chapter::new(format!("Monte Carlo, {} draws of the {}", u.draws, found.model.as_str()));
    let drawn = ChapterPart::text(uncertain_words(u, found.contact));
    let chapter = if speeds(found).is_some() {
        let band = plain(found.band_percent, 3);
        let robust = format!(
            "robust: there, whatever the contact's length, at least 95 % of the draws are within {band} % of \
             their own largest."
        );
        chapter.then(drawn).then(quantiles(&found.quantiles)).then(ChapterPart::note(robust))
    } else {
        let none = ChapterPart::text("Too few draws have a slap-down.");
        chapter.with_all([drawn, none].map(|passage| passage.only_on(Medium::Page)))
    };
    chapter.then(ChapterPart::picture("monte-carlo", "tall"))
}

/// Table of the median and the range of 95 % of the draws.
fn quantiles(found: &[QuantileCurves]) -> ChapterPart {
    let how_large = |q: &QuantileCurves| {
        let [low, _, median, _, high] = q.largest.map(|value| format_value(q.criterion, value));
        let unit = if q.criterion == Criterion::EnergyRatio { "" } else { " m/s" };
        Words::with_short(format!("{median}{unit} ({low}–{high})"), format!("{median} ({low}–{high})"))
    };
    let critical = |q: &QuantileCurves| {
        let [low, _, median, _, high] = q.critical_angle_deg;
        format!("{}° ({})", degrees(median), bands_words(&[(low, high)]))
    };
    let table = ReportTable::from_rows(found)
        .caption("Found: the median, and the range of 95 % of the draws.")
        .shape(TableShape::Fitting)
        .head(Words::with_short("Largest", "largest"), |q| {
            Words::with_short(criterion_words(q.criterion), criterion_short(q.criterion))
        })
        .text(Words::with_short("Critical angle (95 %)", "critical (95 %)"), critical)
        .text(Words::with_short("How large (95 %)", "how large (95 %)"), how_large)
        .text(Words::with_short("Robust band, °", "robust band °"), |q| bands_words(&q.robust_bands_deg));
    table.into()
}
