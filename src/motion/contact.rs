//! Values of a test report for one contact of the rigid motion: force, decelerations without ringing, crush.

use super::Integrated;
use super::curves::{cut_wide, filter};
use super::reconstruct::{corner, corner_height_m};
use crate::data::{ChannelPulse, End, MotionState, PulseLength, Setup, Signal, transverse};
use crate::numerics::filter::LowPass;
use crate::numerics::quadrature::running_integral;
use crate::numerics::{as_f64, reduce};
use std::borrow::Cow;
use std::f64::consts::PI;

/// Smallest second maximum of the force, as a share of the larger; and the share of the lower maximum to
/// which the force falls between two touches: this happens in the corner that bends and touches twice within
/// 5 ms, and in 8 of 230 sound drops with modes as fast as the contact.
const SECOND_MAXIMUM: f64 = 0.3;
const TWO_TOUCHES: f64 = 0.35;
/// If the force falls below this share, the cask may have left the target; the force on the sensor, in means
/// over an eighth of the contact, did so in 12 of 13 simulated drops of elastic bodies that touched twice,
/// and in 23 of 132 others.
const LEFT_SHARE: f64 = 0.1;
const MEAN_SHARE: f64 = 0.125;
/// From the time on after which the rotation gains no more than this share, k is as uncertain as the times
/// are: otherwise its interval would be up to ten times narrower in 28 of 520 sound drops that hold it.
const ENDED_SHARE: f64 = 0.05;
/// A corner that comes down faster than this share of the impact velocity has not left.
const COMES_DOWN: f64 = -0.1;

/// Effect of one contact on the rigid body, in steps of equal length.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactCourse {
    /// The first and the last state of the contact.
    pub ends: [MotionState; 2],
    /// Vertical velocity of the struck corner as it touches, m/s, up positive.
    pub struck_m_s: f64,
    /// Velocity of the corner after each step, if the cask turned on without an impact.
    pub corner_m_s: Vec<f64>,
    /// Horizontal velocity gained by S, and vertical velocity gained without gravity, m/s: the impulse over
    /// the mass.
    pub impulse_m_s: [f64; 2],
    /// Vertical force of the target over the mass, m/s².
    pub up_m_s2: Vec<f64>,
    /// Reading of a transverse sensor at S on the rigid body, m/s².
    pub at_cog_m_s2: Vec<f64>,
    /// Reading of a sensor at the struck end of the axis   (14)
    pub at_end_m_s2: Vec<f64>,
    /// Depth of the struck corner of the undeformed cask below the point of first touch, m, in the middle of
    /// each step.
    pub crush_m: Vec<f64>,
    step_s: f64,
}

impl ContactCourse {
    /// Derives the course from the states of a contact and the course of its force; `None` for fewer than two
    /// states, and for a contact that gives nothing.
    pub fn from_states(measured: &[MotionState], setup: &Setup, by: ForceCourse) -> Option<Self> {
        let states = &follow_one_force(measured, setup.gravity_m_s2, by)?;
        let ends = [*states.first()?, *states.last()?];
        let step_s = (ends[1].time_s - ends[0].time_s) / as_f64(states.len().checked_sub(1)?);
        let steps = states.windows(2).map(|pair| (pair[0], pair[1]));
        let force = |(a, b): (MotionState, MotionState)| {
            let along = (b.horizontal_velocity_m_s - a.horizontal_velocity_m_s) / step_s;
            let up = (b.vertical_velocity_m_s - a.vertical_velocity_m_s) / step_s + setup.gravity_m_s2;
            let (sin, cos) = f64::midpoint(a.angle_rad, b.angle_rad).sin_cos();
            let turning = (b.angular_velocity_rad_s - a.angular_velocity_rad_s) / step_s;
            let across = up * cos - along * sin;
            [up, across, across + turning * setup.cog_m]
        };
        let forces: Vec<[f64; 3]> = steps.map(force).collect();
        let component = |i: usize| forces.iter().map(|f| f[i]).collect::<Vec<f64>>();
        let heights_m: Vec<f64> = states.iter().map(|s| corner_height_m(setup, s, setup.cog_m)).collect();
        let crush_m = heights_m.windows(2).map(|h| heights_m[0] - f64::midpoint(h[0], h[1])).collect();
        let gained = |number: fn(&MotionState) -> f64| number(&ends[1]) - number(&ends[0]);
        let fallen_m_s = setup.gravity_m_s2 * (ends[1].time_s - ends[0].time_s);
        Some(Self {
            struck_m_s: corner(setup, &ends[0], setup.cog_m).1,
            corner_m_s: states[1..].iter().map(|s| corner(setup, s, setup.cog_m).1).collect(),
            impulse_m_s: [
                gained(|s| s.horizontal_velocity_m_s),
                gained(|s| s.vertical_velocity_m_s) + fallen_m_s,
            ],
            up_m_s2: component(0),
            at_cog_m_s2: component(1),
            at_end_m_s2: component(2),
            crush_m,
            ends,
            step_s,
        })
    }

    /// Kinetic energy over the mass at the contact's beginning and end, m²/s²; Θ/m in m².
    pub fn kinetic_m2_s2(&self, inertia_m2: f64) -> [f64; 2] {
        self.ends.map(|s| {
            let square = s.horizontal_velocity_m_s.powi(2) + s.vertical_velocity_m_s.powi(2);
            0.5 * (square + inertia_m2 * s.angular_velocity_rad_s.powi(2))
        })
    }

    /// Work of the vertical force up to the greatest crush over the mass, m²/s².
    pub fn work_to_greatest_crush_m2_s2(&self) -> f64 {
        let greatest_m = largest(&self.crush_m);
        let steps = self.crush_m.windows(2).zip(self.up_m_s2.windows(2));
        let sinking = steps.take_while(|(crush_m, _)| crush_m[0] < greatest_m);
        sinking.map(|(crush_m, up)| (crush_m[1] - crush_m[0]) * f64::midpoint(up[0], up[1])).sum()
    }

    /// Filters courses of forces with a zero-phase low-pass of this −3 dB cut-off, Hz, assuming zero before
    /// and after them; the length does not change.
    pub fn low_pass<const N: usize>(&self, courses_m_s2: [&[f64]; N], cutoff_hz: f64) -> [Vec<f64>; N] {
        match LowPass::with_cutoff_hz(cutoff_hz, 1.0 / self.step_s) {
            Some(filter) => filter.apply_to_pulses(courses_m_s2),
            None => courses_m_s2.map(<[f64]>::to_vec),
        }
    }
}

/// The first of two possible touches within the force of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstTouch {
    /// Lowest force, as a share of the lower of the two maxima around it.
    pub dip: f64,
    /// k from the corner's velocity then.
    pub k: f64,
    /// Time before the contact's end at which the corner may have left first, s; 0 if it had not.
    pub earlier_s: f64,
    /// Root mean square change of k from then on.
    pub k_moves: f64,
}

impl ContactCourse {
    /// The first of two touches, if the force through a low-pass of this −3 dB cut-off, Hz, or that on the
    /// first end's sensor falls between two maxima; k belongs to the whole contact.
    pub fn first_touch(&self, k: f64, cutoff_hz: f64, integrated: &Integrated) -> Option<FirstTouch> {
        let [up] = self.low_pass([&self.up_m_s2], cutoff_hz);
        let by_rotation = dips(&up);
        let at_sensor = dips(&self.struck_sensor_force(integrated)?);
        let last_m_s = self.corner_m_s.last()?;
        let k_then = |corner_m_s: &f64| k - (corner_m_s - last_m_s) / self.struck_m_s;
        let ks: Vec<f64> = self.corner_m_s.iter().map(k_then).collect();
        let whole = reduce::sum(&self.up_m_s2);
        // Time from which the rotation gains no more than this share, when the force may have ended.
        let ended = |most: f64| {
            let mut gains = whole;
            let lets_go = |&i: &usize| {
                gains -= self.up_m_s2[i];
                let at_sensor = at_sensor[i] < LEFT_SHARE && gains < most * whole;
                (by_rotation[i] < LEFT_SHARE || at_sensor) && ks[i] > COMES_DOWN
            };
            (0..ks.len()).find(lets_go).unwrap_or(ks.len())
        };
        let rest = &ks[ended(ENDED_SHARE)..];
        let square: f64 = rest.iter().map(|later| (later - k).powi(2)).sum();
        let lowest = |dips: &[f64]| (0..dips.len()).min_by(|&a, &b| dips[a].total_cmp(&dips[b]));
        let rotation_at = lowest(&by_rotation)?;
        let is_by_rotation = by_rotation[rotation_at] < TWO_TOUCHES;
        let (dips, at) =
            if is_by_rotation { (&by_rotation, rotation_at) } else { (&at_sensor, lowest(&at_sensor)?) };
        (is_by_rotation || dips[at] < LEFT_SHARE).then(|| FirstTouch {
            dip: dips[at],
            k: ks[at],
            earlier_s: self.step_s * as_f64(ks.len() - ended(1.0)),
            k_moves: (square / as_f64(rest.len().max(1))).sqrt(),
        })
    }

    /// Force on the first end's transverse sensor, in means of [`MEAN_SHARE`] about the middle of each step,
    /// in any unit.
    fn struck_sensor_force(&self, integrated: &Integrated) -> Option<Vec<f64>> {
        let struck = transverse(&integrated.signals, End::First)?;
        let at = integrated.signals.iter().position(|s| s.name == struck.name)?;
        let [begin, end] = &self.ends;
        let half_s = MEAN_SHARE * (end.time_s - begin.time_s) / 2.0;
        let gained_m_s = |i: usize| {
            let [from_m_s, to_m_s] = [-half_s, half_s].map(|by_s| {
                integrated.velocities[at].velocity_at(begin.time_s + (as_f64(i) + 0.5) * self.step_s + by_s)
            });
            to_m_s - from_m_s
        };
        Some((0..self.up_m_s2.len()).map(gained_m_s).collect())
    }
}

/// Level to which a force falls at each point, as a share of the lower of the two maxima on either side; 1 if
/// one of them is missing.
fn dips(force: &[f64]) -> Vec<f64> {
    let least = SECOND_MAXIMUM * largest(force);
    let highest = |most: &mut f64, f: &f64| {
        *most = most.max(*f);
        Some(*most)
    };
    let before: Vec<f64> = force.iter().scan(0.0, highest).collect();
    let mut after: Vec<f64> = force.iter().rev().scan(0.0, highest).collect();
    after.reverse();
    let dip = |i: usize| {
        let lower = before[i].min(after[i]);
        if lower > least { force[i] / lower } else { 1.0 }
    };
    (0..force.len()).map(dip).collect()
}

/// Source of the course of the one force in a contact: the growth of the share that it has given   (42)
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceCourse {
    /// The rotation, which does not contain the first bending mode, since that rings alike at both ends.
    Rotation,
    /// The velocity of S across the axis, in which the first mode rings most.
    Translation,
    /// A half sine, from the measured duration of the contact alone.
    HalfSine,
}

/// Replaces every velocity change in a contact by this course: one force turns and throws the cask.
fn follow_one_force(states: &[MotionState], gravity_m_s2: f64, by: ForceCourse) -> Option<Vec<MotionState>> {
    let (first, last) = (states.first()?, states.last()?);
    let given = |s: &MotionState| {
        let since_s = s.time_s - first.time_s;
        let up_m_s = s.vertical_velocity_m_s + gravity_m_s2 * since_s;
        match by {
            ForceCourse::Rotation => s.angular_velocity_rad_s,
            ForceCourse::Translation => {
                up_m_s * s.angle_rad.cos() - s.horizontal_velocity_m_s * s.angle_rad.sin()
            }
            ForceCourse::HalfSine => -(PI * since_s / (last.time_s - first.time_s)).cos(),
        }
    };
    let (from, whole) = (given(first), given(last) - given(first));
    let fall_m_s = |s: &MotionState| gravity_m_s2 * (s.time_s - first.time_s);
    let up_m_s = last.vertical_velocity_m_s - first.vertical_velocity_m_s + fall_m_s(last);
    let along_m_s = last.horizontal_velocity_m_s - first.horizontal_velocity_m_s;
    let turned_rad_s = last.angular_velocity_rad_s - first.angular_velocity_rad_s;
    let mut before = *first;
    let moved = |state: &MotionState| {
        let share = (given(state) - from) / whole;
        let vertical_velocity_m_s = first.vertical_velocity_m_s + share * up_m_s - fall_m_s(state);
        let mean_m_s = f64::midpoint(before.vertical_velocity_m_s, vertical_velocity_m_s);
        before = MotionState {
            angular_velocity_rad_s: first.angular_velocity_rad_s + share * turned_rad_s,
            horizontal_velocity_m_s: first.horizontal_velocity_m_s + share * along_m_s,
            vertical_velocity_m_s,
            height_m: before.height_m + mean_m_s * (state.time_s - before.time_s),
            ..*state
        };
        before
    };
    (whole.abs() > 0.0).then(|| states.iter().map(moved).collect())
}

/// The largest value.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(f64::NEG_INFINITY, |most, value| most.max(*value))
}

/// A pulse, with its change of velocity and displacement, ends where its filtered reading falls to this share
/// of its peak: for a half sine 5e-5 of the change of velocity lies beyond.
const PULSE_FOOT: f64 = 0.01;

/// The pulse of each channel between two times, s, and that after a low-pass with this −3 dB cut-off, Hz;
/// `None` if samples are clipped or lost.
pub fn pulses(signals: &[Signal], between_s: [f64; 2], cutoff_hz: f64) -> Vec<Option<ChannelPulse>> {
    vector_pulses(signals, 1, between_s, cutoff_hz)
}

/// Finds the pulses of vectors, whose components follow one another and share their times: pulses of the
/// magnitude, with the magnitudes of the vectors of change of velocity and displacement   (56)
pub fn vector_pulses(
    signals: &[Signal],
    components: usize,
    between_s: [f64; 2],
    cutoff_hz: f64,
) -> Vec<Option<ChannelPulse>> {
    let [from_s, to_s] = between_s;
    let is_whole =
        |s: &Signal| ![&s.clipped, &s.gaps].into_iter().any(|spans| s.overlaps(spans, from_s, to_s));
    // Without a low-pass the ends of the pulse are sought as far away as with a slow one.
    let margin_hz = if cutoff_hz.is_finite() { cutoff_hz } else { 100.0 };
    let wide: Vec<Signal> = signals.iter().map(|s| cut_wide(s, (from_s, to_s), margin_hz)).collect();
    let smooth = filter(&wide, cutoff_hz);
    let [signals, wide, smooth] = [signals, &wide, &smooth].map(|all| all.chunks(components));
    let all = signals.zip(wide.zip(smooth));
    all.map(|(signals, (wide, smooth))| {
        pulse([wide, smooth], between_s).filter(|_| signals.iter().all(is_whole))
    })
    .collect()
}

/// A single component with its sign; for several the magnitude of their vector.
fn magnitude(components: impl ExactSizeIterator<Item = f64>) -> f64 {
    if components.len() == 1 { components.sum() } else { components.map(|x| x * x).sum::<f64>().sqrt() }
}

/// Magnitudes of the vectors, sample by sample.
fn magnitudes(components: &[Signal]) -> Cow<'_, Signal> {
    if let [one] = components {
        return Cow::Borrowed(one);
    }
    let count = components.iter().map(|s| s.force_m_s2.len()).min().unwrap_or_default();
    let at = |i: usize| magnitude(components.iter().map(|s| s.force_m_s2[i]));
    Cow::Owned(components[0].cut_with(0, (0..count).map(at).collect()))
}

fn pulse(components: [&[Signal]; 2], [from_s, to_s]: [f64; 2]) -> Option<ChannelPulse> {
    let [wide, smooth] = components.map(magnitudes);
    let peak = |of: &Signal| {
        let values = &of.force_m_s2;
        let within = of.index_from(from_s)..of.index_from(to_s);
        within.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs())).map(|i| (i, values[i]))
    };
    let (at, peak_m_s2) = peak(&smooth)?;
    let (filtered, sample_s) = (&smooth.force_m_s2, 1.0 / smooth.sample_rate_hz);
    // Times at which the reading passes a share of the peak before and after it, in samples, and the delay
    // with which it passes a higher level: on a line from a sample below the level to its neighbour above.
    let passed = |share: f64| {
        let level_m_s2 = share * peak_m_s2.abs();
        let above = |i: usize| filtered[i] * peak_m_s2.signum() - level_m_s2;
        let on_line = |below: usize, beside: usize| {
            let (from, step) = (as_f64(below), as_f64(beside) - as_f64(below));
            let rise_m_s2 = above(beside) - above(below);
            [from - step * above(below) / rise_m_s2, step / rise_m_s2]
        };
        let began = (0..at).rev().find(|&i| above(i) < 0.0).map(|i| on_line(i, i + 1));
        let ended = (at..filtered.len()).find(|&i| above(i) < 0.0).map(|i| on_line(i, i - 1));
        began.zip(ended)
    };
    let length = passed(0.1).map(|(began, ended)| PulseLength {
        length_s: (ended[0] - began[0]) * sample_s,
        by_level: began[1].hypot(ended[1]) * sample_s,
    });
    let integrals = passed(PULSE_FOOT).map(|(began, ended)| {
        let index = |position: f64| wide.index_from(smooth.start_s + position * sample_s);
        let (pulse, step_s) = (index(began[0])..index(ended[0]), 1.0 / wide.sample_rate_hz);
        let squares = components[0].iter().map(|component| {
            let velocity_m_s = running_integral(&component.force_m_s2[pulse.clone()], step_s);
            let way_m = running_integral(&velocity_m_s, step_s);
            [velocity_m_s, way_m].map(|course| course.last().copied().unwrap_or_default())
        });
        let squares: Vec<[f64; 2]> = squares.collect();
        [0, 1].map(|i| magnitude(squares.iter().map(|integrals| integrals[i])))
    });
    let raw = peak(&wide)?.1;
    Some(ChannelPulse { raw, filtered: peak_m_s2, time_s: smooth.time_s(at), sample_s, length, integrals })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    /// A contact of two half sines of 3 ms, the second of this share, with a pause of 4 ms.
    fn contact(second: f64) -> ContactCourse {
        let half_sine = |t: f64| if (0.0..3.0).contains(&t) { 3000.0 * (PI * t / 3.0).sin() } else { 0.0 };
        let up_m_s2: Vec<f64> = (0..100)
            .map(|i| 0.1 * f64::from(i))
            .map(|t| half_sine(t) + second * half_sine(t - 7.0))
            .collect();
        let at = |time_s: f64| MotionState {
            time_s,
            angle_rad: 0.2,
            angular_velocity_rad_s: 0.0,
            horizontal_velocity_m_s: 0.0,
            vertical_velocity_m_s: 0.0,
            height_m: 0.0,
        };
        let whole: f64 = up_m_s2.iter().sum();
        let gain_m_s = |corner_m_s: &mut f64, up: &f64| {
            *corner_m_s += 14.0 * up / whole;
            Some(*corner_m_s)
        };
        ContactCourse {
            ends: [at(0.0), at(0.01)],
            struck_m_s: -10.0,
            corner_m_s: up_m_s2.iter().scan(-10.0, gain_m_s).collect(),
            impulse_m_s: [0.0, 1.0],
            at_cog_m_s2: up_m_s2.clone(),
            at_end_m_s2: up_m_s2.clone(),
            crush_m: vec![],
            up_m_s2,
            step_s: 1e-4,
        }
    }

    #[test]
    fn a_pause_that_the_corner_leaves_in_leaves_its_end_open() {
        let first_touch = |second: f64| {
            let contact = contact(second);
            let force_m_s2 = [vec![0.0; 20], contact.up_m_s2.clone(), vec![0.0; 20]].concat();
            let signal = Signal { start_s: -2e-3, ..example::signal(1e4, force_m_s2) };
            contact.first_touch(0.4, 1e3, &Integrated::new(&[signal], 0.0))
        };
        assert_eq!(first_touch(0.0), None);
        let touch = first_touch(0.4).unwrap();
        assert!(touch.dip < 0.01 && (6e-3..8e-3).contains(&touch.earlier_s), "{touch:?}");
        // After the first touch k is 1.4/1.4 − 1 = 0.
        assert!((0.25..0.4).contains(&touch.k_moves), "{touch:?}");
        let comes_down = first_touch(2.0).unwrap();
        assert_eq!((comes_down.earlier_s, comes_down.k_moves), (0.0, 0.0));
    }
}
