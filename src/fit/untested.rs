//! Stated inputs that this recording cannot check: no check finds a mistake that moves the speed or k by
//! twice the half-width of its interval.

use super::FitData;
use super::inputs::{BASE_STRAIN, Inputs, LARGER_RANGE, RELEASE, REST, SECOND_SENSOR, UncertainInput};
use crate::data::{FlightFit, MISSED_U, Quantities, Untested, UntestedMoves};

/// A number that is off by this many half-widths is wrong.
const WRONG_HALF_WIDTHS: f64 = 2.0;

/// Mistakes beyond this many usual ones are not expected: 20 % of a scale, 0.2 m of a position.
const MOST_USUAL: f64 = 20.0;

/// A pulse whose peak is read 1 % too low by an amplifier that compresses with the cube of the reading loses
/// this many times 1 % of its area, whereas base strain of 1 % adds 1 %: ∫ sin³ over ∫ sin of half a sine.
const COMPRESSION_LOSS: f64 = 2.0 / 3.0;

/// A usual radius of a corner that counts as sharp, m.
const ROUNDING_M: f64 = 0.01;

/// Effect of one standard uncertainty of an input, if the cask file were wrong by it.
pub(super) struct Influence {
    pub quantities: Quantities<f64>,
    /// Largest miss that it causes in a check, over the check's standard uncertainty from all inputs.
    pub miss_in_u: f64,
}

/// A mistake that no check finds.
pub(super) struct SilentMistake {
    /// The input's place among all; `None` if it is none of them, and no check knows it.
    input: Option<usize>,
    /// Smallest size that makes the speed or k wrong, in standard uncertainties of the input.
    wrong_u: f64,
    untested: Untested,
}

/// Lists the mistakes that no consistency check would find.
pub(super) fn find_silent(
    measured: &FitData,
    inputs: &[UncertainInput],
    influences: &[Influence],
    stated: &Quantities,
) -> Vec<SilentMistake> {
    let mut silent = Vec::new();
    for (input, (own, influence)) in inputs.iter().zip(influences).enumerate() {
        let Some((of_key, by_u)) = mistake_in_key(measured, own) else { continue };
        let moved = &influence.quantities;
        // One standard uncertainty moves speed and k beyond their intervals by this factor.
        let k = moved.k.abs() / stated.k.u95;
        let speed = moved.speed.zip(stated.speed).map_or(0.0, |(by, speed)| by.abs() / speed.u95);
        let wrong_u = WRONG_HALF_WIDTHS / k.max(speed);
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
        let silent_mistake = |untested| SilentMistake { input: Some(input), wrong_u, untested };
        silent.extend(std::iter::once(untested).chain(with_it).map(silent_mistake));
    }
    let round = rounded_corner(measured, stated);
    silent.extend(round.map(|untested| SilentMistake { input: None, wrong_u: 0.0, untested }));
    silent
}

/// A corner of the first end that is not sharp: it rolls on its radius as it leaves, and k of the point that
/// touches is less than that of the sharp corner by Δk = ω ρ (cos φ − sin φ)/v0.
fn rounded_corner(measured: &FitData, stated: &Quantities) -> Option<Untested> {
    let (sin, cos) = measured.setup.angle_rad.sin_cos();
    let k = (stated.angular_velocity.value * ROUNDING_M * (cos - sin) / stated.impact_velocity.value).abs();
    (WRONG_HALF_WIDTHS * stated.k.u95 <= MOST_USUAL * k).then(|| Untested {
        what: "radius of the first end's corner".into(),
        key: "cask.height_m".into(),
        by: "10 mm",
        moves: UntestedMoves { k: Some(k), slap_down_speed_m_s: stated.speed.map(|_| 0.0) },
        remedy: "measure the corner: k is that of a sharp one",
    })
}

/// Nonlinearity of a channel at its peak, beside its base strain: both change only the velocity step, so a
/// check finds both or neither.
fn linearity(input: &UncertainInput, strain: &Untested) -> Option<Untested> {
    let channel = input.name.strip_prefix(BASE_STRAIN)?;
    let UntestedMoves { k, slap_down_speed_m_s } = strain.moves;
    let scaled = |by: f64| COMPRESSION_LOSS * by;
    Some(Untested {
        what: format!("linearity at the peak of {channel}"),
        key: format!("channel.{channel}.full_scale"),
        moves: UntestedMoves { k: k.map(scaled), slap_down_speed_m_s: slap_down_speed_m_s.map(scaled) },
        remedy: LARGER_RANGE,
        ..strain.clone()
    })
}

/// Selects the mistakes that no other check finds either; `finds` says if one does in velocity steps.
pub(super) fn list_untested(
    silent: &[SilentMistake],
    base: &Inputs,
    inputs: &[UncertainInput],
    finds: &dyn Fn(&FlightFit) -> bool,
) -> Vec<Untested> {
    let is_found = |mistake: &&SilentMistake| {
        let Some(input) = mistake.input else { return false };
        let input = std::slice::from_ref(&inputs[input]);
        [-1.0, 1.0].iter().all(|sign| finds(&base.shift(input, &[sign * mistake.wrong_u]).flight))
    };
    silent.iter().filter(|mistake| !is_found(mistake)).map(|mistake| mistake.untested.clone()).collect()
}

/// Describes a mistake in an input that a file states, its effect left open, and its size in standard
/// uncertainties; `None` if the recording determines the input.
fn mistake_in_key(measured: &FitData, input: &UncertainInput) -> Option<(Untested, f64)> {
    let stated = input.stated.as_ref()?;
    let name = match stated.key {
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
    let untested = Untested { what: name, key, by: stated.by, moves: UntestedMoves::default(), remedy };
    Some((untested, stated.by_u))
}
