//! The sections of `report.html` that say how the motion was had from the channels, and how sure its numbers are.

use super::rounding::{MISSING, fixed, interval, optional_fixed, significant};
use super::settings::{TOLERANCES, is_default};
use super::text::{printable, rung_words, sentence, true_minus};
use crate::data::{
    CaskFile, Closure, Contribution, DropResult, ReconstructionCandidate, ReconstructionChoice,
    ReconstructionRung,
};
use maud::{Markup, html};

/// Moves of the joint fit that are listed; the smaller ones say nothing.
const MOST_MOVES: usize = 10;

/// The rung taken and why, the other rungs, the closures and the joint fit.
pub(super) fn reconstruction(result: &DropResult) -> Markup {
    let Some(choice) = &result.reconstruction else { return html! {} };
    html! {
        h2 { "How the motion was reconstructed" }
        p class="lead" { (sentence(&choice.reason)) }
        table class="whole" {
            caption { "The reconstructions of this recording, the simplest first; ± holds 95 %. The first is taken that noise and tolerances \
                explain and whose answer the next would neither change by more than the narrower interval nor know better by a quarter." }
            thead { tr { th { "Reconstruction" } th class="n" { "Slap-down speed" } th class="n" { "k" } th { "What it leaves" } th { "Explained" } } }
            tbody { @for c in &choice.candidates { (rung(c, c.rung == choice.rung)) } }
        }
        (closures(choice))
        (joint(choice))
    }
}

fn rung(c: &ReconstructionCandidate, taken: bool) -> Markup {
    html! {
        tr class=[taken.then_some("chosen")] {
            th scope="row" { (rung_words(c.rung)) @if taken { " (taken)" } }
            td class="n" { (interval(c.speed.as_ref())) }
            td class="n" { (interval(c.k.as_ref())) }
            td { (true_minus(&printable(&c.residual))) }
            td { @if c.consistent { "yes" } @else { "no" } }
        }
    }
}

fn closures(choice: &ReconstructionChoice) -> Markup {
    let fitted = choice.chi_square.is_some();
    html! {
        @if !choice.closures.is_empty() {
            table class="whole" {
                caption { "Closures: what the motion must meet beside the velocity steps. A miss within 2 standard uncertainties (u) of all \
                    inputs together is within noise and tolerances; one far beyond is a finding." }
                thead { tr { th { "Closure" } th class="n" { "Missed by" } th class="n" { "in u" }
                    @if fitted { th class="n" { "Left by the joint fit, in u of the closure" } } } }
                tbody { @for c in &choice.closures { (closure(c, fitted)) } }
            }
        }
    }
}

fn closure(c: &Closure, fitted: bool) -> Markup {
    html! {
        tr {
            th scope="row" { (printable(&c.name)) }
            td class="n" { (true_minus(&printable(&c.miss))) }
            td class="n" { (fixed(c.miss_in_u, 1)) }
            @if fitted { td class="n" { (fixed(c.left_in_u, 2)) } }
        }
    }
}

/// χ² of the joint fit and what it moved.
fn joint(choice: &ReconstructionChoice) -> Markup {
    let Some((chi_square, degrees)) = choice.chi_square else { return html! {} };
    let moved = &choice.adjustments;
    let used = if choice.rung == ReconstructionRung::Joint {
        "Its motion is the one reported."
    } else {
        "It serves as a check: the numbers of this report are those of the reconstruction taken."
    };
    html! {
        p { "The joint fit moves every input within its tolerance until the closures are met: χ² = " (significant(chi_square, 2)) " with "
            (degrees) " degree" (if degrees == 1 { "" } else { "s" }) " of freedom, one a closure. " (used)
            @if moved.is_empty() { " It moves no input by more than a twentieth of its standard uncertainty." } }
        @if !moved.is_empty() {
            table class="whole" {
                caption { "What the joint fit moves, the largest first. Left: the input's standard uncertainty after the fit over the one before." }
                thead { tr { th { "Input" } th class="n" { "Standard uncertainty u" } th class="n" { "Moved by, in u" } th class="n" { "Left, %" } } }
                tbody { @for a in moved.iter().take(MOST_MOVES) { tr {
                    th scope="row" { (printable(&a.input)) } td class="n" { (printable(&a.standard_uncertainty)) }
                    td class="n" { (fixed(a.moved_in_u, 2)) } td class="n" { (fixed(100.0 * a.left_share, 0)) }
                } } }
            }
            @if moved.len() > MOST_MOVES { p class="note" { "and " (moved.len() - MOST_MOVES) " more, each moved by less." } }
        }
    }
}

/// Twice the root of the sum of squares of what the inputs contribute; `None` where one of them is not known.
fn total(budget: &[Contribution], of: impl Fn(&Contribution) -> Option<f64>) -> Option<f64> {
    let squares: Option<f64> = budget.iter().map(|c| of(c).map(|x| x * x)).sum();
    squares.map(|s| 2.0 * s.sqrt())
}

/// What each input contributes to the intervals, largest first, and what they come to.
pub(super) fn budget(result: &DropResult, file: &CaskFile) -> Markup {
    let budget = &result.budget;
    if budget.is_empty() {
        return html! {};
    }
    html! {
        h2 { "Uncertainty" }
        p class="lead" { "Each line is what one standard uncertainty of the input changes. The changes add in squares, and an interval is twice \
            their root. " (largest(budget)) }
        table {
            thead { tr { th { "Input" } th { "Known from" } th class="n" { "Standard uncertainty" } th class="n" { "Slap-down speed, m/s" } th class="n" { "k" } } }
            tbody { @for c in budget { tr {
                th scope="row" { (printable(&c.input)) } td { (known_from(&c.input, result, file)) }
                td class="n" { (printable(&c.standard_uncertainty)) }
                td class="n" { (optional_fixed(c.speed_m_s, 3)) } td class="n" { (optional_fixed(c.k, 4)) }
            } } }
            tfoot { tr class="chosen" {
                th scope="row" colspan="3" { "Interval (95 %): twice the root of the sum of squares" }
                td class="n" { "± " (optional_fixed(total(budget, |c| c.speed_m_s), 3)) }
                td class="n" { "± " (optional_fixed(total(budget, |c| c.k), 4)) }
            } }
        }
        @if result.reconstruction.as_ref().is_some_and(|r| r.rung == ReconstructionRung::Channels) {
            p class="note" { "Speed and k were read off single channels, with the intervals given there: this table is that of the planar motion." }
        }
    }
}

/// Which input weighs most, in the speed and in k.
fn largest(budget: &[Contribution]) -> String {
    let most = |of: &dyn Fn(&Contribution) -> Option<f64>| -> Option<(String, f64)> {
        let squares: f64 = budget.iter().filter_map(of).map(|x| x * x).sum();
        let largest = budget
            .iter()
            .filter_map(|c| of(c).map(|x| (c, x)))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        (squares > 0.0).then(|| (printable(&largest.0.input), 100.0 * largest.1 * largest.1 / squares))
    };
    let share = |(input, percent): &(String, f64)| format!("{input} ({percent:.0} % of the variance)");
    match (most(&|c| c.speed_m_s), most(&|c| c.k)) {
        (Some(speed), Some(k)) if speed.0 == k.0 => {
            format!("The largest is {}, for the speed, and {:.0} % for k.", share(&speed), k.1)
        }
        (Some(speed), Some(k)) => {
            format!("The largest for the speed is {}, for k {}.", share(&speed), share(&k))
        }
        (None, Some(k)) => format!("The largest for k is {}.", share(&k)),
        (Some(speed), None) => format!("The largest for the speed is {}.", share(&speed)),
        (None, None) => String::new(),
    }
}

/// Whether the recording tells an input's uncertainty, the cask file states it, or it is a default.
fn known_from(input: &str, result: &DropResult, file: &CaskFile) -> Markup {
    let closure = result.reconstruction.as_ref().is_some_and(|r| r.closures.iter().any(|c| c.name == input));
    let tolerance = TOLERANCES.iter().find(|t| input.starts_with(t.input));
    html! {
        @match tolerance {
            _ if closure => { "closure" },
            Some(t) if is_default(file, t.key) => { span class="default" { "default" } },
            Some(_) => { "cask file" },
            None if input.is_empty() => { (MISSING) },
            None => { "recording" },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    fn contribution(input: &str, speed_m_s: Option<f64>, k: f64) -> Contribution {
        Contribution { input: input.into(), standard_uncertainty: "0.5 %".into(), speed_m_s, k: Some(k) }
    }

    #[test]
    fn the_budget_adds_up_to_the_interval() {
        let analysis = sample::analysis();
        let result = &analysis.result;
        let speed = total(&result.budget, |c| c.speed_m_s).expect("all known");
        // The sample states its interval with two digits.
        assert!((speed - result.slap_down.speed.expect("a speed").u95).abs() < 0.005);
        let page = budget(result, &analysis.cask_file).into_string();
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
        let from = |input: &str| known_from(input, &analysis.result, &analysis.cask_file).into_string();
        assert!(from("calibration of A2").contains("default"));
        assert_eq!(from("drop angle"), "cask file");
        assert_eq!(from("velocity step of A1"), "recording");
        assert_eq!(from("time of slap-down"), "recording");
        assert_eq!(from("height of the second end at slap-down"), "closure");
    }

    #[test]
    fn the_rung_taken_and_the_closures_are_there() {
        let page = reconstruction(&sample::analysis().result).into_string();
        for words in [
            "fitted with modes and drift (taken)",
            "−0.8 % of ω",
            "χ² = 0.22 with 2 degrees of freedom",
            "It serves as a check",
            "20.56 ± 0.11 m/s",
        ] {
            assert!(page.contains(words), "{words}: {page}");
        }
        assert!(reconstruction(&sample::without_anything().result).into_string().is_empty());
    }
}
