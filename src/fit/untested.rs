//! Stated inputs in which nothing in the recording tests a mistake: one that moves the speed or k by twice
//! the half-width of its interval is found by no check.

use super::FitData;
use super::inputs::{BASE_STRAIN, Inputs, LARGER_RANGE, RELEASE, REST, SECOND_SENSOR, UncertainInput};
use crate::data::{FlightFit, MISSED_U, Quantities, Untested, UntestedMoves};

/// A number so many half-widths off is wrong.
const WRONG: f64 = 2.0;

/// A mistake of more than so many usual ones is not made: 20 % of a scale, 0.2 m of a place.
const MOST_USUAL: f64 = 20.0;

/// A pulse whose peak is read 1 % too low by an amplifier that compresses, by the cube of the reading, loses
/// this many times 1 % of its area, where base strain of 1 % adds 1 %: ∫ sin³ over ∫ sin of half a sine.
const COMPRESSED: f64 = 2.0 / 3.0;

/// What one standard uncertainty of an input does, where the file were off by it.
pub(super) struct Influence {
    pub quantities: Quantities<f64>,
    /// The largest miss that it gives a closure, over the closure's standard uncertainty by all inputs.
    pub miss_in_u: f64,
}

/// A mistake that no closure finds.
pub(super) struct SilentMistake {
    /// The input's place among all.
    input: usize,
    /// How large it is, in standard uncertainties of the input, where it makes the speed or k wrong.
    wrong_u: f64,
    untested: Untested,
}

/// The mistakes that no closure would find.
pub(super) fn silent(
    measured: &FitData,
    inputs: &[UncertainInput],
    influences: &[Influence],
    stated: &Quantities,
) -> Vec<SilentMistake> {
    let mut silent = Vec::new();
    for (input, (own, influence)) in inputs.iter().zip(influences).enumerate() {
        let Some((of_key, by_u)) = of_key(measured, own) else { continue };
        let moved = &influence.quantities;
        // How far beyond its interval one standard uncertainty moves either.
        let k = moved.k.abs() / stated.k.u95;
        let speed = moved.speed.zip(stated.speed).map_or(0.0, |(by, speed)| by.abs() / speed.u95);
        let wrong_u = WRONG / k.max(speed);
        // An input that is stated without a tolerance has no size.
        let is_made = by_u.is_finite() && wrong_u <= MOST_USUAL * by_u;
        if !is_made || wrong_u * influence.miss_in_u > MISSED_U {
            continue;
        }
        let moves = UntestedMoves {
            k: Some(by_u * moved.k.abs()),
            slap_down_speed_m_s: moved.speed.map(|by_m_s| by_u * by_m_s.abs()),
        };
        let untested = Untested { moves, ..of_key };
        let with_it = linearity(own, &untested);
        silent.extend(std::iter::once(untested).chain(with_it).map(|untested| SilentMistake {
            input,
            wrong_u,
            untested,
        }));
    }
    silent
}

/// That a channel reads its peak as it does less, beside its base strain: either changes the velocity step
/// alone, and what finds one finds the other.
fn linearity(input: &UncertainInput, strain: &Untested) -> Option<Untested> {
    let channel = input.name.strip_prefix(BASE_STRAIN)?;
    let UntestedMoves { k, slap_down_speed_m_s } = strain.moves;
    let scaled = |by: f64| COMPRESSED * by;
    Some(Untested {
        what: format!("linearity at the peak of {channel}"),
        key: format!("channel.{channel}.full_scale"),
        moves: UntestedMoves { k: k.map(scaled), slap_down_speed_m_s: slap_down_speed_m_s.map(scaled) },
        remedy: LARGER_RANGE,
        ..strain.clone()
    })
}

/// Those of them that no other check finds either; `finds` says whether one does in velocity steps.
pub(super) fn untested(
    silent: &[SilentMistake],
    base: &Inputs,
    inputs: &[UncertainInput],
    finds: &dyn Fn(&FlightFit) -> bool,
) -> Vec<Untested> {
    let is_found = |mistake: &&SilentMistake| {
        let input = std::slice::from_ref(&inputs[mistake.input]);
        [-1.0, 1.0].iter().all(|sign| finds(&base.moved(input, &[sign * mistake.wrong_u]).flight))
    };
    silent.iter().filter(|mistake| !is_found(mistake)).map(|mistake| mistake.untested.clone()).collect()
}

/// An input that a file states, what a mistake in it moves left open, and how many of its standard
/// uncertainties a mistake is; `None` where the recording gives it.
fn of_key(measured: &FitData, input: &UncertainInput) -> Option<(Untested, f64)> {
    let stated = input.stated.as_ref()?;
    let what = match stated.key {
        "axis" => input.name.replace("cross axis", "tilt"),
        "drop.height_m" => "drop height".into(),
        "cask.inertia_kg_m2" => "inertia, with contents that move".into(),
        _ => input.name.clone(),
    };
    let (rests, by_rest) = (measured.rests, stated.remedy == REST);
    let (key, remedy) = if let Some(name) = &stated.channel {
        let is_at_rest = by_rest && rests.iter().any(|rest| rest.channel == *name);
        let remedy = if is_at_rest { SECOND_SENSOR } else { stated.remedy };
        (format!("channel.{name}.{}", stated.key), remedy)
    } else {
        let lacks_fall = by_rest && !rests.is_empty() && measured.fall_s.is_none();
        (stated.key.to_owned(), if lacks_fall { RELEASE } else { stated.remedy })
    };
    let untested = Untested { what, key, by: stated.by, moves: UntestedMoves::default(), remedy };
    Some((untested, stated.by_u))
}
