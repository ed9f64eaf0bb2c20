//! Chapters on the reconstruction of the motion from the channels, and on the uncertainty of its numbers.

use super::document::{Chapter, ChapterPart, PartContent, ReportTable, TableCell};
use super::record::{Assumption, assumption};
use super::rounding::{MISSING, fixed, interval, optional, optional_fixed, significant};
use super::text::{chosen_mark, dedup, rung_words, sentence, true_minus, yes_no};
use crate::data::{CaskFile, Contribution, DropResult, FlightFit, Method, MethodChoice};

/// Most corrections of the joint fit in the list; smaller ones are insignificant.
const MOST_MOVES: usize = 10;

/// Chapter on the selected method and its reason, the other methods, the consistency checks and the joint
/// fit.
pub(super) fn reconstruction(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("How the motion was reconstructed");
    let Some(choice) = &result.reconstruction else { return chapter };
    let rungs = ReportTable::from_rows(&choice.candidates)
        .caption(
            "The reconstructions of this recording, the simplest first; ± holds 95 %. The first is taken \
             that noise and tolerances explain and whose answer the next would neither change by more than \
             the narrower interval nor know better by a tenth.",
        )
        .mark_chosen(|c| c.rung == choice.rung)
        .head("Reconstruction", |c| format!("{}{}", rung_words(c.rung), chosen_mark(c.rung == choice.rung)))
        .number("Slap-down speed", |c| interval(c.speed.as_ref()))
        .number("k", |c| interval(c.k.as_ref()))
        .text("What it leaves", |c| true_minus(&c.residual))
        .text("Explained", |c| yes_no(c.consistent));
    let lead = ChapterPart::lead(sentence(&choice.reason));
    chapter.then(lead).then(rungs).then(closures(choice)).with_all(joint_fit_parts(choice))
}

fn closures(choice: &MethodChoice) -> ReportTable {
    ReportTable::from_rows(&choice.closures)
        .caption(
            "Closures: what the motion must meet beside the velocity steps. A miss within 2 standard \
             uncertainties (u) of all inputs \
             together is within noise and tolerances; one far beyond is a finding.",
        )
        .head("Closure", |c| &c.name[..])
        .number("Missed by", |c| true_minus(&c.miss))
        .number("in u", |c| fixed(c.miss_in_u, 1))
        .number("with the others met, in u", |c| fixed(c.beside_others_in_u, 1))
        .show_if(choice.closures.len() > 1)
        .into()
}

/// Parts on χ² of the joint fit and its corrections.
fn joint_fit_parts(choice: &MethodChoice) -> Vec<ChapterPart> {
    let Some((chi_square, degrees)) = choice.chi_square else { return Vec::new() };
    let used = if choice.rung == Method::Joint {
        "Its motion is the one reported."
    } else {
        "It serves as a check: the numbers of this report are those of the reconstruction taken."
    };
    let still = " It moves no input by more than a twentieth of its standard uncertainty.";
    let sentence = format!(
        "The joint fit moves every input within its tolerance until the closures are met: χ² = {} with \
         {degrees} degree{} of freedom, one a closure. {used}{}",
        significant(chi_square, 2),
        if degrees == 1 { "" } else { "s" },
        if choice.adjustments.is_empty() { still } else { "" }
    );
    let moved = ReportTable::from_rows(&choice.adjustments)
        .caption(
            "What the joint fit moves, the largest first. Left: the input's standard uncertainty after \
                  the fit over the one before.",
        )
        .limit_rows(MOST_MOVES, MOST_MOVES, "each moved by less.")
        .head("Input", |a| &a.input[..])
        .number("Standard uncertainty u", |a| &a.standard_uncertainty[..])
        .number("Moved by, in u", |a| fixed(a.moved_in_u, 2))
        .number("Left, %", |a| fixed(100.0 * a.left_share, 0));
    vec![ChapterPart::text(sentence), moved.into()]
}

/// Chapter on the fit of the free-flight window: plateaus, modes, candidates.
pub(super) fn flight(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Fit of the flight");
    let Some(fit) = &result.flight else { return chapter };
    let modes = ReportTable::from_rows(&fit.modes)
        .caption(if fit.modes.is_empty() {
            "Bending modes taken: none, nothing rings"
        } else {
            "Bending modes taken"
        })
        .number("Frequency, Hz", |m| fixed(m.frequency_hz, 1))
        .number("Damping ratio", |m| significant(m.damping, 2))
        .number("Amplitude, m/s", |m| significant(m.amplitude_m_s, 2));
    let phases = |driven, modes| match modes {
        _ if driven => "by the impact",
        0 => MISSING,
        _ => "free",
    };
    let candidates = ReportTable::from_rows(&fit.candidates)
        .caption(
            "Candidates that were tried. Criterion: BIC and, for a drift, −2 ln of the odds of its shifts",
        )
        .mark_chosen(|c| c.taken)
        .text("Modes", |c| format!("{}{}", c.modes, chosen_mark(c.taken)))
        .text("Phases", |c| phases(c.driven, c.modes))
        .text("Drift", |c| yes_no(c.drift))
        .number("Criterion", |c| fixed(c.bic, 1))
        .number("Residual, m/s", |c| significant(c.residual_m_s, 2));
    let plateaus = ReportTable::from_rows(&fit.plateaus)
        .caption("Plateaus")
        .head("Channel", |p| &p.channel[..])
        .number("Velocity step, m/s", |p| fixed(p.velocity_step_m_s, 3))
        .number("u, m/s", |p| significant(p.u_m_s, 2))
        .number("Zero shift, m/s²", |p| significant(p.zero_shift_m_s2, 2))
        .number("Residual, m/s", |p| significant(p.residual_m_s, 2));
    chapter
        .then(ChapterPart::lead(flight_sentence(fit)))
        .then(PartContent::Beside([vec![plateaus.into()], vec![modes.into(), candidates.into()]]))
}

fn flight_sentence(fit: &FlightFit) -> String {
    let drift = if fit.drift { ", with a drift (zero shift)" } else { ", without drift" };
    let lowest = fit.candidates.iter().map(|c| c.bic).fold(f64::INFINITY, f64::min);
    // An equally good simpler fit comes before that of the lowest criterion, all others after it.
    let why = match fit.candidates.iter().position(|c| c.taken) {
        Some(i) if fit.candidates[i].bic <= lowest => "is that of the fit with the lowest criterion",
        Some(0) => {
            "is that of the smallest fit that gives the same velocity steps as the one with the lowest \
             criterion"
        }
        _ => "is that of the fit with the lowest criterion among those that the motion does not contradict",
    };
    format!(
        "From {} to {} ms after the first sample: one plateau a channel{drift}; the number of bending modes \
         {why}.",
        fixed(fit.from_s * 1e3, 2),
        fixed(fit.to_s * 1e3, 2)
    )
}

/// Twice the root of the sum of squares of the inputs' contributions; `None` if one of them is not known.
fn total(budget: &[Contribution], change: impl Fn(&Contribution) -> Option<f64>) -> Option<f64> {
    let squares: Option<f64> = budget.iter().map(|c| change(c).map(|x| x * x)).sum();
    squares.map(|s| 2.0 * s.sqrt())
}

/// Chapter on the contribution of each input to the intervals, largest first, and the total.
pub(super) fn budget(result: &DropResult, file: &CaskFile) -> Chapter {
    let budget = &result.budget;
    let chapter = Chapter::new("Uncertainty");
    if budget.is_empty() {
        return chapter;
    }
    let sum = |change: fn(&Contribution) -> Option<f64>, decimals| {
        format!("± {}", optional_fixed(total(budget, change), decimals))
    };
    // The last row is the total.
    let rows: Vec<Option<&Contribution>> = budget.iter().map(Some).chain([None]).collect();
    let all = "Interval (95 %): twice the root of the sum of squares";
    let table = ReportTable::from_rows(&rows)
        .class("")
        .mark_chosen(Option::is_none)
        .head("Input", |c| c.map_or(all, |c| &c.input[..]))
        .text("Known from", |c| c.map_or_else(|| "".into(), |c| source_cell(c, result, file)))
        .number("Standard uncertainty", |c| c.map_or("", |c| &c.standard_uncertainty[..]))
        .number("Slap-down speed, m/s", |c| {
            c.map_or_else(|| sum(|c| c.speed_m_s, 3), |c| optional_fixed(c.speed_m_s, 3))
        })
        .number("k", |c| c.map_or_else(|| sum(|c| c.k, 4), |c| optional_fixed(c.k, 4)));
    let lead = format!(
        "Each line is what one standard uncertainty of the input changes. The changes add in squares, and an \
         interval is twice their root. {}",
        largest(budget)
    );
    let untested = ReportTable::from_rows(&result.untested)
        .class("")
        .caption(
            "What nothing in this recording tests: a mistake that moves k or the speed by two half-widths \
             misses no closure by 3.5 u and leaves no channel off the line of the others. The largest effect \
             first",
        )
        .head("Input", |i| &i.what[..])
        .code("Key", |i| &i.key[..])
        .number("A mistake of", |i| i.by)
        .number("moves the slap-down speed by, m/s", |i| optional(i.moves.slap_down_speed_m_s, 2))
        .number("and k by", |i| optional(i.moves.k, 2))
        .text("What would test it", |i| i.remedy);
    chapter.then(ChapterPart::lead(lead)).then(table).then(untested)
}

/// A formal report must not rest on an assumption with more than this share of the variance, percent.
const WEIGHS_PERCENT: f64 = 10.0;

/// Lists the assumptions, each with its percentage of the variance of the speed, or of k if there is no
/// speed; the largest first.
fn assumptions(result: &DropResult, file: &CaskFile) -> Vec<(Assumption, f64)> {
    let change = |c: &Contribution| result.slap_down.speed.map_or(c.k, |_| c.speed_m_s);
    let mut all: Vec<(Assumption, f64)> = Vec::new();
    for (input, percent) in shares(&result.budget, change) {
        let Some(assumed) = assumption(file, input) else { continue };
        match all.iter_mut().find(|(known, _)| *known == assumed) {
            Some((_, known)) => *known += percent,
            None => all.push((assumed, percent)),
        }
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}

/// Counts the assumptions on which a formal report must not rest.
pub(super) fn weighty_assumptions(result: &DropResult, file: &CaskFile) -> usize {
    assumptions(result, file).iter().filter(|(_, percent)| *percent > WEIGHS_PERCENT).count()
}

/// Sentence "assumes …; state yours in `[tolerance]`": the assumptions behind the intervals, in short by
/// their names alone; `None` if all that matter are stated.
pub(super) fn assumed(result: &DropResult, file: &CaskFile, is_short: bool) -> Option<String> {
    let is_heavy = |percent: f64| percent > WEIGHS_PERCENT;
    let mut named = assumptions(result, file);
    named.retain(|(assumed, percent)| assumed.is_unknown || is_heavy(*percent));
    let mut of_what = match result.slap_down.speed {
        _ if is_short => " of it",
        Some(_) => " of the variance",
        None => " of k's variance",
    };
    let mut sentences = Vec::new();
    for (assumed, percent) in &named {
        let words = if is_short { assumed.name } else { &assumed.words };
        sentences.push(if is_heavy(*percent) {
            format!("{words} ({percent:.0} %{})", std::mem::take(&mut of_what))
        } else {
            words.to_owned()
        });
    }
    let tables = dedup(named.iter().map(|(assumed, _)| format!("`{}`", assumed.table))).join(", ");
    let place = if is_short { String::new() } else { format!(" in {tables}") };
    (!sentences.is_empty()).then(|| format!("assumes {}; state yours{place}", sentences.join(", ")))
}

/// Inputs whose changes of a quantity are known, with the percentage of its variance from each; empty if
/// nothing changes it.
fn shares(all: &[Contribution], change: impl Fn(&Contribution) -> Option<f64>) -> Vec<(&Contribution, f64)> {
    let square = |c: &Contribution| change(c).map(|x| x * x);
    let sum: f64 = all.iter().filter_map(square).sum();
    let known = all.iter().filter(|_| sum > 0.0);
    known.filter_map(|c| Some((c, 100.0 * square(c)? / sum))).collect()
}

/// Names the input that contributes most to the speed and to k.
pub(super) fn largest(budget: &[Contribution]) -> String {
    let words = |change: fn(&Contribution) -> Option<f64>| {
        let (largest, percent) = shares(budget, change).into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!("{} ({percent:.0} % of the variance)", largest.input))
    };
    match (words(|c| c.speed_m_s), words(|c| c.k)) {
        (Some(speed), Some(k)) => format!("The largest for the speed is {speed}, for k {k}."),
        (Some(speed), None) => format!("The largest for the speed is {speed}."),
        (None, Some(k)) => format!("The largest for k is {k}."),
        (None, None) => String::new(),
    }
}

/// Source of an input's uncertainty: the recording, the cask file, or a default.
fn source_cell(input: &Contribution, result: &DropResult, file: &CaskFile) -> TableCell {
    let is_closure =
        result.reconstruction.as_ref().is_some_and(|r| r.closures.iter().any(|c| c.name == input.input));
    match input.tolerance {
        _ if is_closure => "closure".into(),
        Some(_) if assumption(file, input).is_some() => TableCell::with_mark("", "default"),
        Some(_) => "cask file".into(),
        None if input.input.is_empty() => MISSING.into(),
        None => "recording".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::document::{Medium, ReportDocument};
    use super::super::{as_html, sample};
    use super::*;
    use crate::data::FlightScore;

    fn page(chapter: Chapter) -> String {
        as_html::page(&ReportDocument { chapters: vec![chapter], ..ReportDocument::default() }, &[])
    }

    fn contribution(input: &str, speed_m_s: Option<f64>, k: f64) -> Contribution {
        let standard_uncertainty = "0.5 %".into();
        Contribution { input: input.into(), standard_uncertainty, tolerance: None, speed_m_s, k: Some(k) }
    }

    #[test]
    fn the_budget_adds_up_to_the_interval() {
        let analysis = sample::analysis();
        let result = &analysis.result;
        let speed = total(&result.budget, |c| c.speed_m_s).expect("all known");
        // The sample states its interval with two digits.
        assert!((speed - result.slap_down.speed.expect("a speed").u95).abs() < 0.005);
        let page = page(budget(result, &analysis.cask_file));
        assert!(page.contains("± 0.110") && page.contains("± 0.0102"), "{page}");
        assert!(page.contains(
            "for the speed is calibration of A2 (40 % of the variance), for k cross axis of A1 (61 %"
        ));
    }

    #[test]
    fn without_a_slap_down_there_is_no_total_of_its_speed() {
        let budget = [contribution("drop angle", None, 0.003), contribution("inertia", None, 0.004)];
        assert_eq!(total(&budget, |c| c.speed_m_s), None);
        assert!((total(&budget, |c| c.k).expect("all known") - 0.01).abs() < 1e-12);
        assert_eq!(largest(&budget), "The largest for k is inertia (64 % of the variance).");
    }

    #[test]
    fn a_tolerance_says_where_it_is_from() {
        let analysis = sample::analysis();
        let known = |input: &str| {
            let own = analysis.result.budget.iter().find(|own| own.input == input).cloned();
            let own = own.unwrap_or_else(|| contribution(input, None, 0.0));
            source_cell(&own, &analysis.result, &analysis.cask_file)
        };
        let from = |input: &str| known(input).words.text_on(Medium::Page).to_owned();
        assert_eq!(known("calibration of A2").mark, "default");
        assert_eq!(from("drop angle"), "cask file");
        assert_eq!(from("velocity step of A1"), "recording");
        assert_eq!(from("time of slap-down"), "recording");
        assert_eq!(from("height of the second end at slap-down"), "closure");
    }

    #[test]
    fn the_rung_taken_and_the_closures_are_there() {
        let found = page(reconstruction(&sample::analysis().result));
        for words in [
            "fitted with modes and drift (taken)",
            "−0.8 % of ω",
            "χ² = 0.22 with 2 degrees of freedom",
            "It serves as a check",
            "20.56 ± 0.11 m/s",
        ] {
            assert!(found.contains(words), "{words}: {found}");
        }
        assert!(!page(reconstruction(&sample::without_anything().result)).contains("<h2>"));
    }

    #[test]
    fn the_number_of_modes_is_explained_by_what_decided_it() {
        let score = |modes, bic, taken| FlightScore {
            modes,
            drift: false,
            driven: false,
            taken,
            bic,
            residual_m_s: 0.01,
        };
        let sentences = |scores: [(f64, bool); 3]| {
            let candidates =
                (1..).zip(scores).map(|(modes, (bic, taken))| score(modes, bic, taken)).collect();
            flight_sentence(&FlightFit { candidates, ..FlightFit::default() })
        };
        let lowest = sentences([(-9.0, true), (-8.0, false), (-7.0, false)]);
        assert!(lowest.ends_with("is that of the fit with the lowest criterion."), "{lowest}");
        // A simpler one that does as well stands first.
        let smallest = sentences([(-7.0, true), (-9.0, false), (-8.0, false)]);
        assert!(smallest.contains("smallest fit that gives the same velocity steps"), "{smallest}");
        // The motion contradicts the first.
        let other = sentences([(-9.0, false), (-8.0, true), (-7.0, false)]);
        assert!(other.ends_with("among those that the motion does not contradict."), "{other}");
        let lowest = sentences([(-7.0, false), (-9.0, true), (-8.0, false)]);
        assert!(lowest.ends_with("is that of the fit with the lowest criterion."), "{lowest}");
    }
}
