//! How the motion was had from the channels, and how sure its numbers are, to chapters of the report.

use super::document::{Chapter, ChapterPart, PartContent, ReportTable, TableCell};
use super::record::{Assumption, assumption};
use super::rounding::{MISSING, fixed, interval, optional, optional_fixed, significant};
use super::text::{distinct, rung_words, sentence, taken_mark, true_minus, yes};
use crate::data::{CaskFile, Contribution, DropResult, FlightFit, ReconstructionChoice, ReconstructionRung};

/// Moves of the joint fit that are listed; the smaller ones say nothing.
const MOST_MOVES: usize = 10;

/// The rung taken and why, the other rungs, the closures and the joint fit.
pub(super) fn reconstruction(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("How the motion was reconstructed");
    let Some(choice) = &result.reconstruction else { return chapter };
    let rungs = ReportTable::of(&choice.candidates)
        .caption(
            "The reconstructions of this recording, the simplest first; ± holds 95 %. The first is taken \
             that noise and tolerances explain and whose answer the next would neither change by more than \
             the narrower interval nor know better by a tenth.",
        )
        .chosen(|c| c.rung == choice.rung)
        .head("Reconstruction", |c| format!("{}{}", rung_words(c.rung), taken_mark(c.rung == choice.rung)))
        .number("Slap-down speed", |c| interval(c.speed.as_ref()))
        .number("k", |c| interval(c.k.as_ref()))
        .text("What it leaves", |c| true_minus(&c.residual))
        .text("Explained", |c| yes(c.consistent));
    let lead = ChapterPart::lead(sentence(&choice.reason));
    chapter.with(lead).with(rungs).with(closures(choice)).with_all(joint(choice))
}

fn closures(choice: &ReconstructionChoice) -> ReportTable {
    ReportTable::of(&choice.closures)
        .caption(
            "Closures: what the motion must meet beside the velocity steps. A miss within 2 standard \
             uncertainties (u) of all inputs \
             together is within noise and tolerances; one far beyond is a finding.",
        )
        .head("Closure", |c| &c.name[..])
        .number("Missed by", |c| true_minus(&c.miss))
        .number("in u", |c| fixed(c.miss_in_u, 1))
        .number("with the others met, in u", |c| fixed(c.beside_others_in_u, 1))
        .if_any(choice.closures.len() > 1)
        .into()
}

/// χ² of the joint fit and what it moved.
fn joint(choice: &ReconstructionChoice) -> Vec<ChapterPart> {
    let Some((chi_square, degrees)) = choice.chi_square else { return Vec::new() };
    let used = if choice.rung == ReconstructionRung::Joint {
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
    let moved = ReportTable::of(&choice.adjustments)
        .caption(
            "What the joint fit moves, the largest first. Left: the input's standard uncertainty after \
                  the fit over the one before.",
        )
        .most(MOST_MOVES, MOST_MOVES, "each moved by less.")
        .head("Input", |a| &a.input[..])
        .number("Standard uncertainty u", |a| &a.standard_uncertainty[..])
        .number("Moved by, in u", |a| fixed(a.moved_in_u, 2))
        .number("Left, %", |a| fixed(100.0 * a.left_share, 0));
    vec![ChapterPart::text(sentence), moved.into()]
}

/// The fit of the free-flight window: plateaus, modes, candidates.
pub(super) fn flight(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Fit of the flight");
    let Some(fit) = &result.flight else { return chapter };
    let modes = ReportTable::of(&fit.modes)
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
    let candidates = ReportTable::of(&fit.candidates)
        .caption(
            "Candidates that were tried. Criterion: BIC and, for a drift, −2 ln of the odds of its shifts",
        )
        .chosen(|c| c.taken)
        .text("Modes", |c| format!("{}{}", c.modes, taken_mark(c.taken)))
        .text("Phases", |c| phases(c.driven, c.modes))
        .text("Drift", |c| yes(c.drift))
        .number("Criterion", |c| fixed(c.bic, 1))
        .number("Residual, m/s", |c| significant(c.residual_m_s, 2));
    let plateaus = ReportTable::of(&fit.plateaus)
        .caption("Plateaus")
        .head("Channel", |p| &p.channel[..])
        .number("Velocity step, m/s", |p| fixed(p.velocity_step_m_s, 3))
        .number("u, m/s", |p| significant(p.u_m_s, 2))
        .number("Zero shift, m/s²", |p| significant(p.zero_shift_m_s2, 2))
        .number("Residual, m/s", |p| significant(p.residual_m_s, 2));
    chapter
        .with(ChapterPart::lead(flight_sentence(fit)))
        .with(PartContent::Beside([vec![plateaus.into()], vec![modes.into(), candidates.into()]]))
}

fn flight_sentence(fit: &FlightFit) -> String {
    let drift = if fit.drift { ", with a drift (zero shift)" } else { ", without drift" };
    let lowest = fit.candidates.iter().map(|c| c.bic).fold(f64::INFINITY, f64::min);
    // A simpler one that does as well stands before that of the lowest criterion, all others behind it.
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

/// Twice the root of the sum of squares of what the inputs contribute; `None` where one of them is not known.
fn total(budget: &[Contribution], change: impl Fn(&Contribution) -> Option<f64>) -> Option<f64> {
    let squares: Option<f64> = budget.iter().map(|c| change(c).map(|x| x * x)).sum();
    squares.map(|s| 2.0 * s.sqrt())
}

/// What each input contributes to the intervals, largest first, and what they come to.
pub(super) fn budget(result: &DropResult, file: &CaskFile) -> Chapter {
    let budget = &result.budget;
    let chapter = Chapter::new("Uncertainty");
    if budget.is_empty() {
        return chapter;
    }
    let sum = |change: fn(&Contribution) -> Option<f64>, decimals| {
        format!("± {}", optional_fixed(total(budget, change), decimals))
    };
    // The last row is that of their sum.
    let rows: Vec<Option<&Contribution>> = budget.iter().map(Some).chain([None]).collect();
    let all = "Interval (95 %): twice the root of the sum of squares";
    let table = ReportTable::of(&rows)
        .class("")
        .chosen(Option::is_none)
        .head("Input", |c| c.map_or(all, |c| &c.input[..]))
        .text("Known from", |c| c.map_or_else(|| "".into(), |c| known_from(c, result, file)))
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
    let untested = ReportTable::of(&result.untested)
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
    chapter.with(ChapterPart::lead(lead)).with(table).with(untested)
}

/// A formal report must not rest on an assumption that carries more of the variance, percent.
const WEIGHS_PERCENT: f64 = 10.0;

/// What is assumed, each with the percent that it carries of the variance of the speed, or of k where there
/// is no speed; the largest first.
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

/// How many assumptions a formal report must not rest on.
pub(super) fn weighty_assumptions(result: &DropResult, file: &CaskFile) -> usize {
    assumptions(result, file).iter().filter(|(_, percent)| *percent > WEIGHS_PERCENT).count()
}

/// "assumes …; state yours in `[tolerance]`": what the intervals rest on that nobody stated, in short by its
/// names alone; `None` where all of weight is stated.
pub(super) fn assumed(result: &DropResult, file: &CaskFile, is_short: bool) -> Option<String> {
    let is_heavy = |percent: f64| percent > WEIGHS_PERCENT;
    let mut named = assumptions(result, file);
    named.retain(|(assumed, percent)| assumed.is_unknown || is_heavy(*percent));
    let mut of_what = match result.slap_down.speed {
        _ if is_short => " of it",
        Some(_) => " of the variance",
        None => " of k's variance",
    };
    let mut said = Vec::new();
    for (assumed, percent) in &named {
        let words = if is_short { assumed.name } else { &assumed.words };
        said.push(if is_heavy(*percent) {
            format!("{words} ({percent:.0} %{})", std::mem::take(&mut of_what))
        } else {
            words.to_owned()
        });
    }
    let tables = distinct(named.iter().map(|(assumed, _)| format!("`{}`", assumed.table))).join(", ");
    let place = if is_short { String::new() } else { format!(" in {tables}") };
    (!said.is_empty()).then(|| format!("assumes {}; state yours{place}", said.join(", ")))
}

/// The inputs whose changes of a quantity are known, with the percent of its variance that each carries; none
/// where nothing changes it.
fn shares(all: &[Contribution], change: impl Fn(&Contribution) -> Option<f64>) -> Vec<(&Contribution, f64)> {
    let square = |c: &Contribution| change(c).map(|x| x * x);
    let sum: f64 = all.iter().filter_map(square).sum();
    let known = all.iter().filter(|_| sum > 0.0);
    known.filter_map(|c| Some((c, 100.0 * square(c)? / sum))).collect()
}

/// Which input weighs most, in the speed and in k.
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

/// Whether the recording tells an input's uncertainty, the cask file states it, or it is a default.
fn known_from(input: &Contribution, result: &DropResult, file: &CaskFile) -> TableCell {
    let is_closure =
        result.reconstruction.as_ref().is_some_and(|r| r.closures.iter().any(|c| c.name == input.input));
    match input.tolerance {
        _ if is_closure => "closure".into(),
        Some(_) if assumption(file, input).is_some() => TableCell::marked("", "default"),
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
    use crate::data::FlightModelScore;

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
            known_from(&own, &analysis.result, &analysis.cask_file)
        };
        let from = |input: &str| known(input).words.on(Medium::Page).to_owned();
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
        let score = |modes, bic, taken| FlightModelScore {
            modes,
            drift: false,
            driven: false,
            taken,
            bic,
            residual_m_s: 0.01,
        };
        let said = |scores: [(f64, bool); 3]| {
            let candidates =
                (1..).zip(scores).map(|(modes, (bic, taken))| score(modes, bic, taken)).collect();
            flight_sentence(&FlightFit { candidates, ..FlightFit::default() })
        };
        let lowest = said([(-9.0, true), (-8.0, false), (-7.0, false)]);
        assert!(lowest.ends_with("is that of the fit with the lowest criterion."), "{lowest}");
        // A simpler one that does as well stands first.
        let smallest = said([(-7.0, true), (-9.0, false), (-8.0, false)]);
        assert!(smallest.contains("smallest fit that gives the same velocity steps"), "{smallest}");
        // The motion contradicts the first.
        let other = said([(-9.0, false), (-8.0, true), (-7.0, false)]);
        assert!(other.ends_with("among those that the motion does not contradict."), "{other}");
        let lowest = said([(-7.0, false), (-9.0, true), (-8.0, false)]);
        assert!(lowest.ends_with("is that of the fit with the lowest criterion."), "{lowest}");
    }
}
