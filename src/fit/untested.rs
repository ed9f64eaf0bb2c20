//! Stated inputs in which nothing in the recording tests a mistake: one that moves the speed or k by twice
//! the half-width of its interval is found by no check.

use super::FitData;
use super::inputs::{InputShift, Inputs, UncertainInput};
use crate::data::{FlightFit, MISSED_U, Quantities, Untested, UntestedMoves};

/// A number so many half-widths off is wrong.
const WRONG: f64 = 2.0;

/// A mistake of more than so many usual ones is not made: 20 % of a scale, 0.2 m of a place.
const MOST_USUAL: f64 = 20.0;

/// Remedies that more than one input has.
const REST: &str = "record the cask at rest before the release";
const SECOND_SENSOR: &str = "a second sensor at the same end";
const MEASURE: &str = "measure between the edges that strike";
const FILM: &str = "high-speed video of the fall";

/// What one standard uncertainty of an input does, where the file were off by it.
pub(super) struct Influence {
    pub quantities: Quantities<f64>,
    /// The largest miss that it gives a closure, over the closure's standard uncertainty by all inputs.
    pub miss_in_u: f64,
}

/// A key of the cask file that may be off.
struct StatedKey {
    what: String,
    key: String,
    /// A mistake as a person makes it, and how many standard uncertainties of the input it is.
    by: &'static str,
    by_u: f64,
    remedy: &'static str,
}

/// A mistake that no closure finds.
pub(super) struct SilentMistake {
    /// The input's place among all.
    input: usize,
    /// How large it is, in standard uncertainties of the input, where it makes the speed or k wrong.
    wrong_u: f64,
    untested: Untested,
}

/// The mistakes that no closure would find, largest effect first.
pub(super) fn silent(
    measured: &FitData,
    inputs: &[UncertainInput],
    influences: &[Influence],
    stated: &Quantities,
) -> Vec<SilentMistake> {
    let mut silent: Vec<(f64, SilentMistake)> = Vec::new();
    for (input, (own, influence)) in inputs.iter().zip(influences).enumerate() {
        let Some(StatedKey { what, key, by, by_u, remedy }) = stated_key(measured, own) else { continue };
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
        let untested = Untested { what, key, by, moves, remedy };
        silent.push((by_u / wrong_u, SilentMistake { input, wrong_u, untested }));
    }
    silent.sort_by(|a, b| b.0.total_cmp(&a.0));
    silent.into_iter().map(|(_, mistake)| mistake).collect()
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

/// The key that states an input; `None` where the recording itself gives the input.
fn stated_key(measured: &FitData, input: &UncertainInput) -> Option<StatedKey> {
    let of_key = |key: &str, by, by_u, remedy| StatedKey {
        what: input.name.clone(),
        key: key.to_owned(),
        by,
        by_u,
        remedy,
    };
    let of_channel = |channel: usize, key: &str, by, by_u, remedy| {
        let name = &measured.spec(channel)?.name;
        Some(of_key(&format!("channel.{name}.{key}"), by, by_u, remedy))
    };
    let shows_rest =
        |channel: usize| measured.rests.iter().any(|r| r.channel == measured.signals[channel].name);
    Some(match *input.changes.first()? {
        InputShift::Step { .. } | InputShift::Event { .. } => return None,
        InputShift::Scale { channel, share } => {
            let remedy = if shows_rest(channel) { SECOND_SENSOR } else { REST };
            return of_channel(channel, "calibration_percent", "1 %", 0.01 / share, remedy);
        }
        InputShift::Place { channel, by_m, .. } => {
            return of_channel(channel, "position_m", "10 mm", 0.01 / by_m, SECOND_SENSOR);
        }
        InputShift::Cross { channel, share, .. } => {
            let key =
                of_channel(channel, "axis", "1°", 1_f64.to_radians() / share, "check how the sensor sits");
            return key.map(|key| StatedKey { what: input.name.replace("cross axis", "tilt"), ..key });
        }
        InputShift::ImpactVelocity { share } if measured.setup.is_of_fall => {
            // v0 is that of the root of the height.
            let key = of_key("drop.height_m", "1 %", 0.005 / share, REST);
            StatedKey { what: "drop height".into(), ..key }
        }
        InputShift::ImpactVelocity { share } => of_key("drop.impact_velocity_m_s", "1 %", 0.01 / share, REST),
        InputShift::Angle { by_rad } => {
            of_key("drop.angle_deg", "1°", 1_f64.to_radians() / by_rad, "an inclinometer on the rigged cask")
        }
        InputShift::CentreOfGravity { by_m } => {
            of_key("cask.cog_m", "10 mm", 0.01 / by_m, "weigh the cask on two supports")
        }
        InputShift::Inertia { share } => {
            let key = of_key("cask.inertia_kg_m2", "10 %", 0.1 / share, "high-speed video of both ends");
            StatedKey { what: "inertia, with contents that move".into(), ..key }
        }
        InputShift::Friction { by, .. } => {
            of_key("contact.friction", "0.1", 0.1 / by, "an axial sensor at the first end")
        }
        InputShift::Clock { share } => of_key("tolerance.clock_percent", "1 %", 0.01 / share, REST),
        InputShift::Length { by_m } => {
            of_key("cask.length_m", "1 %", 0.01 * measured.setup.length_m / by_m, MEASURE)
        }
        InputShift::Section { by_m } => {
            of_key("cask.height_m", "1 %", 0.01 * measured.setup.height_m / by_m, MEASURE)
        }
        InputShift::AngularVelocity { by_rad_s } => {
            of_key("drop.angular_velocity_deg_s", "1°/s", 1_f64.to_radians() / by_rad_s, FILM)
        }
        InputShift::HorizontalVelocity { by_m_s } => {
            of_key("drop.horizontal_velocity_m_s", "0.1 m/s", 0.1 / by_m_s, FILM)
        }
    })
}
