//! The rigid motion over one contact to what a test report tabulates of it: force, decelerations free of
//! ringing, crush.

use super::curves::{cut_wide, filtered};
use super::reconstruct::{corner, corner_height_m};
use crate::data::{MotionState, Setup, Signal};
use crate::numerics::as_f64;
use crate::numerics::filter::ZeroPhaseLowPass;
use std::f64::consts::PI;

/// What one contact does to the rigid body, by steps of equal length.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactCourse {
    /// The first and the last state of the contact.
    pub ends: [MotionState; 2],
    /// Vertical velocity of the struck corner as it touches, m/s, up positive.
    pub struck_m_s: f64,
    /// Horizontal velocity gained by S, and vertical velocity gained but for gravity, m/s: the impulse over
    /// the mass.
    pub impulse_m_s: [f64; 2],
    /// Vertical force of the target over the mass, m/s².
    pub up_m_s2: Vec<f64>,
    /// What a transverse sensor at S reads of the rigid body, m/s².
    pub at_cog_m_s2: Vec<f64>,
    /// The same at the struck end of the axis   (14)
    pub at_end_m_s2: Vec<f64>,
    /// How far the struck corner of the undeformed cask lies below where it touched, m, in the middle of each
    /// step.
    pub crush_m: Vec<f64>,
    step_s: f64,
}

impl ContactCourse {
    /// From the states of a contact by the one force that it is of; `None` of fewer than two states, and of a
    /// contact that gives nothing.
    pub fn of(measured: &[MotionState], setup: &Setup, by: ForceCourse) -> Option<Self> {
        let states = &by_one_force(measured, setup.gravity_m_s2, by)?;
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

    /// Whether the corner has passed its greatest crush.
    pub fn rises_again(&self) -> bool {
        self.crush_m.last().is_some_and(|last_m| *last_m < largest(&self.crush_m))
    }

    /// Work of the vertical force up to the greatest crush over the mass, m²/s².
    pub fn work_to_greatest_crush_m2_s2(&self) -> f64 {
        let greatest_m = largest(&self.crush_m);
        let steps = self.crush_m.windows(2).zip(self.up_m_s2.windows(2));
        let sinking = steps.take_while(|(crush_m, _)| crush_m[0] < greatest_m);
        sinking.map(|(crush_m, up)| (crush_m[1] - crush_m[0]) * f64::midpoint(up[0], up[1])).sum()
    }

    /// Courses of forces through the zero-phase low-pass with this −3 dB cut-off, Hz, nothing before and
    /// after them; as long as they are.
    pub fn low_passed<const N: usize>(&self, courses_m_s2: [&[f64]; N], cutoff_hz: f64) -> [Vec<f64>; N] {
        match ZeroPhaseLowPass::with_cutoff_hz(cutoff_hz, 1.0 / self.step_s) {
            Some(filter) => filter.apply_to_pulses(courses_m_s2),
            None => courses_m_s2.map(<[f64]>::to_vec),
        }
    }
}

/// What tells the course of the one force of a contact: how the share grows of what it gives in all   (42)
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceCourse {
    /// The rotation: the first bending mode, which rings alike at both ends, is none.
    Rotation,
    /// The velocity of S across the axis, which the first mode rings in most.
    Translation,
    /// Nothing measured but the contact's length.
    HalfSine,
}

/// The same contact with every velocity gained in this course: one force turns and throws the cask.
fn by_one_force(states: &[MotionState], gravity_m_s2: f64, by: ForceCourse) -> Option<Vec<MotionState>> {
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

/// One channel's pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelPulse {
    /// The largest of either sign, m/s².
    pub raw_m_s2: f64,
    /// The same through the low-pass, m/s².
    pub filtered_m_s2: f64,
    /// When that is reached, s.
    pub time_s: f64,
    /// From one time of that reading to the next, s.
    pub sample_s: f64,
    /// How long the filtered reading stays above a tenth of it.
    pub length: Option<PulseLength>,
}

/// How long a reading stays above a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseLength {
    /// s.
    pub length_s: f64,
    /// By how much that changes with the level, both ends apart, s/(m/s²).
    pub by_level: f64,
}

/// The pulse of each channel between two times, s, and through the low-pass with this −3 dB cut-off, Hz;
/// `None` where samples are clipped or lost.
pub fn pulses(signals: &[Signal], between_s: [f64; 2], cutoff_hz: f64) -> Vec<Option<ChannelPulse>> {
    let [from_s, to_s] = between_s;
    let is_whole =
        |s: &Signal| ![&s.clipped, &s.gaps].into_iter().any(|spans| s.touches(spans, from_s, to_s));
    let wide: Vec<Signal> = signals.iter().map(|s| cut_wide(s, (from_s, to_s), cutoff_hz)).collect();
    let all = signals.iter().zip(wide.iter().zip(filtered(&wide, cutoff_hz)));
    all.map(|(signal, (wide, smooth))| pulse(wide, &smooth, between_s).filter(|_| is_whole(signal))).collect()
}

fn pulse(wide: &Signal, smooth: &Signal, [from_s, to_s]: [f64; 2]) -> Option<ChannelPulse> {
    let peak = |of: &Signal| {
        let values = &of.force_m_s2;
        let within = of.index_from(from_s)..of.index_from(to_s);
        within.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs())).map(|i| (i, values[i]))
    };
    let (at, filtered_m_s2) = peak(smooth)?;
    let (filtered, sample_s) = (&smooth.force_m_s2, 1.0 / smooth.sample_rate_hz);
    let level_m_s2 = 0.1 * filtered_m_s2.abs();
    let above = |i: usize| filtered[i] * filtered_m_s2.signum() - level_m_s2;
    // On a line from a sample below the level to its neighbour above: when, in samples, and how much later a
    // higher level is passed.
    let passed = |below: usize, beside: usize| {
        let (from, step) = (as_f64(below), as_f64(beside) - as_f64(below));
        let rise_m_s2 = above(beside) - above(below);
        [from - step * above(below) / rise_m_s2, step / rise_m_s2]
    };
    let began = (0..at).rev().find(|&i| above(i) < 0.0).map(|i| passed(i, i + 1));
    let ended = (at..filtered.len()).find(|&i| above(i) < 0.0).map(|i| passed(i, i - 1));
    let length = began.zip(ended).map(|(began, ended)| PulseLength {
        length_s: (ended[0] - began[0]) * sample_s,
        by_level: began[1].hypot(ended[1]) * sample_s,
    });
    Some(ChannelPulse { raw_m_s2: peak(wide)?.1, filtered_m_s2, time_s: smooth.time_s(at), sample_s, length })
}
