//! The quick trial's accuracy figures, seeded, to the bounds that keep a change from losing accuracy. Times
//! are not looked at.

use crate::moved;
use crate::run::root;
use dropcheck::lab::data::{TrialLimit, TrialPoint, TrialRequest};
use dropcheck::lab::methods;
use std::fmt::Write as _;

const REQUEST: TrialRequest = TrialRequest { quick: true, seed: 1 };

/// The default's points, one a class.
fn defaults(part: &[TrialPoint]) -> impl Iterator<Item = &TrialPoint> {
    part.iter().filter(|p| p.is_default)
}

fn point<'a>(part: &'a [TrialPoint], method: &str, class: &str) -> &'a TrialPoint {
    part.iter().find(|p| p.method == method && p.class == class).expect("a point")
}

#[test]
fn the_program_is_near_from_file_to_answer() {
    let part = methods::ways(&REQUEST);
    for found in defaults(&part) {
        // Measured on simulated drops by another program: planar motion with the modes fitted is within 0.4 %
        // of speed and 0.011 of k. Noise of 5 g leaves 0.055 m/s on each step; three times that on both over
        // 16 m/s is 1.5 %, over v0 of 13.3 m/s 0.018 of k. A length off by 1 % is 1 % of what turns, which is
        // more than what strikes; of what is cut off, only the interval knows.
        let is_speed = found.family.starts_with("speed");
        let bound = match &found.class[..] {
            "5 g of noise" => [1.5, 0.018],
            "length off by 1 %" => [2.0, 0.011],
            "clean" | "one mode, 2 to 5 periods" | "limiter, 12 to 25 ms" => [0.4, 0.011],
            _ => continue,
        };
        assert!(found.p95_error < bound[usize::from(!is_speed)], "{found:?}");
        assert!(found.promised.is_some() && found.held > Some(0.9), "{found:?}");
    }
    // Reading has a time, and says nothing.
    assert_eq!(point(&part, "reading alone", "all").cases, 0);
}

#[test]
fn the_limits_of_ways_are_those_that_the_quick_trial_keeps() {
    let limits = methods::limits(&methods::ways(&REQUEST), &[], &[], None);
    let is_of_ways = |limit: &&TrialLimit| methods::WAYS.iter().any(|family| limit.name.starts_with(family));
    let of_ways: Vec<&TrialLimit> = limits.iter().filter(is_of_ways).collect();
    assert!(of_ways.len() == 11 && of_ways.iter().all(|limit| limit.is_met()), "{of_ways:?}");
}

/// The page of the recorded full run.
const FULL_RUN: &str = "docs/measured/trial/validation.md";

/// `validate --quick` shows what the full run found: the rows of `silent.tsv` are those of the recorded page,
/// and `BLESS=1` writes them.
#[test]
fn the_silent_damages_that_the_program_knows_are_those_of_the_recorded_full_run() {
    let page = std::fs::read_to_string(root().join(FULL_RUN)).expect("the recorded page");
    let (_, chapter) = page.split_once("### What is silent").expect("the chapter");
    let (count, _) =
        chapter.trim_start_matches(|c: char| !c.is_ascii_digit()).split_once(' ').expect("a count");
    // A damage that came after the run was recorded is one of which nothing is known.
    let damages = std::fs::read_to_string(root().join("src/lab/damage/damages.tsv")).expect("the damages");
    let grow = |row: &&str| !row.starts_with('#') && row.split('\t').nth(6).is_some_and(|sizes| sizes != "-");
    let tried = format!(" of {} damages ", damages.lines().filter(grow).count());
    assert!(chapter.contains(&tried), "the recorded run is not{tried}that there are");
    let (table, _) = chapter.split_once("\n### ").expect("the next chapter");
    let head =
        "# Recorded full run: a silent damage, from which size on what becomes of a drop, half-widths off.";
    let mut rows = format!("{head}\n");
    for row in table.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let _ = writeln!(rows, "{}\t{}\t{}", cells[0].trim_matches('`'), cells[2], cells[3]);
    }
    assert_eq!(Ok(rows.lines().count() - 1), count.parse(), "{rows}");
    moved::hold(&root().join("src/lab/damage/silent.tsv"), &rows, moved::lines);
}
