//! Curves on grids of their own to values at any time.

use crate::data::{ChannelCurve, Curves, Events, MotionCurve, STANDARD_GRAVITY_M_S2};
use crate::numerics::{as_count, as_f64};

/// One quantity of a curve: its name with its unit, its values, and what makes that unit of them.
pub(super) struct CurveSeries<'a> {
    pub(super) name: &'static str,
    pub(super) values: &'a [f64],
    pub(super) factor: f64,
}

/// What a table shows of a channel.
pub(super) fn channel_series(curve: &ChannelCurve) -> [CurveSeries<'_>; 3] {
    [
        ("raw_g", &curve.raw_m_s2, 1.0 / STANDARD_GRAVITY_M_S2),
        ("filtered_g", &curve.filtered_m_s2, 1.0 / STANDARD_GRAVITY_M_S2),
        ("velocity_m_s", &curve.velocity_m_s, 1.0),
    ]
    .map(|(name, values, factor)| CurveSeries { name, values, factor })
}

/// What a table shows of the motion.
pub(super) fn motion_series(motion: &MotionCurve) -> [CurveSeries<'_>; 7] {
    [
        ("angle_deg", &motion.angle_rad, 180.0 / std::f64::consts::PI),
        ("angular_velocity_rad_s", &motion.angular_velocity_rad_s, 1.0),
        ("vertical_velocity_first_m_s", &motion.first_end_vertical_m_s, 1.0),
        ("vertical_velocity_second_m_s", &motion.second_end_vertical_m_s, 1.0),
        ("horizontal_velocity_second_m_s", &motion.second_end_horizontal_m_s, 1.0),
        ("height_first_m", &motion.first_end_height_m, 1.0),
        ("height_second_m", &motion.second_end_height_m, 1.0),
    ]
    .map(|(name, values, factor)| CurveSeries { name, values, factor })
}

/// The events by name, s; `None` where one was not found.
pub(super) fn named_events(events: &Events) -> [(&'static str, Option<f64>); 4] {
    [
        ("release", events.release_s),
        ("first contact", events.first_contact_s()),
        ("separation", events.separation_s()),
        ("slap-down", events.slap_down_s()),
    ]
}

/// Step of a uniform time vector, s; `None` where it has fewer than two points or does not rise.
pub(super) fn step_s(time_s: &[f64]) -> Option<f64> {
    let (first, last) = (time_s.first()?, time_s.last()?);
    let step = (last - first) / as_f64(time_s.len().checked_sub(1)?);
    (step.is_finite() && step > 0.0).then_some(step)
}

/// The times of the finest channel, carried on over the span of every curve of the motion and its channels.
pub(super) fn common_time_s(curves: &Curves) -> Vec<f64> {
    let times = || {
        curves
            .channels
            .iter()
            .map(|c| c.time_s.as_slice())
            .chain(curves.motion.iter().map(|m| m.time_s.as_slice()))
    };
    let of_others = || curves.others.iter().map(|other| other.time_s.as_slice());
    let all = || times().chain(of_others());
    let Some((finest, step)) =
        all().filter_map(|t| step_s(t).map(|step| (t, step))).min_by(|a, b| a.1.total_cmp(&b.1))
    else {
        return Vec::new();
    };
    let from = times().filter_map(|t| t.first().copied()).fold(f64::INFINITY, f64::min);
    let to = times().filter_map(|t| t.last().copied()).fold(f64::NEG_INFINITY, f64::max);
    let before = ((finest[0] - from) / step).round();
    let rows = before + 1.0 + ((to - finest[0]) / step).round();
    let held: usize = all().map(<[f64]>::len).sum();
    // Curves that lie far apart would ask for rows that hold nothing: then the finest channel's own times
    // serve.
    if !(rows.is_finite() && rows <= 4.0 * as_f64(held) + 4.0) {
        return finest.to_vec();
    }
    (0..as_count(rows)).map(|i| finest[0] + (as_f64(i) - before) * step).collect()
}

/// The grid of a curve's points.
pub(super) struct Grid {
    start_s: f64,
    step_s: f64,
    last: f64,
}

/// A place on a grid: behind which point, and which part of a step.
#[derive(Clone, Copy)]
pub(super) struct GridPlace {
    below: usize,
    weight: f64,
}

impl Grid {
    /// The grid of these times; `None` where they are none.
    pub(super) fn new(time_s: &[f64]) -> Option<Self> {
        Some(Self { start_s: *time_s.first()?, step_s: step_s(time_s)?, last: as_f64(time_s.len() - 1) })
    }

    /// The place of `time_s`; `None` outside the curve.
    pub(super) fn place(&self, time_s: f64) -> Option<GridPlace> {
        /// Places that differ from a grid point by less are on it: the rounding of times, in steps.
        const ON_GRID: f64 = 1e-3;
        let place = (time_s - self.start_s) / self.step_s;
        if !(place > -ON_GRID && place < self.last + ON_GRID) {
            return None;
        }
        let place = place.clamp(0.0, self.last);
        let below = as_count(place);
        let weight = place - as_f64(below);
        Some(if weight < ON_GRID {
            GridPlace { below, weight: 0.0 }
        } else if weight > 1.0 - ON_GRID {
            GridPlace { below: below + 1, weight: 0.0 }
        } else {
            GridPlace { below, weight }
        })
    }
}

impl GridPlace {
    /// The value there, between two points on a line; `None` where it is not finite.
    pub(super) fn of(self, values: &[f64]) -> Option<f64> {
        let below = *values.get(self.below)?;
        let value = if self.weight > 0.0 {
            below * (1.0 - self.weight) + values.get(self.below + 1)? * self.weight
        } else {
            below
        };
        value.is_finite().then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::OtherCurve;

    fn curve(start_s: f64, step_s: f64, n: i32) -> ChannelCurve {
        let time_s: Vec<f64> = (0..n).map(|i| start_s + f64::from(i) * step_s).collect();
        let values: Vec<f64> = time_s.iter().map(|t| 2.0 * t).collect();
        ChannelCurve {
            channel: "A".into(),
            raw_m_s2: values.clone(),
            filtered_m_s2: values.clone(),
            velocity_m_s: values,
            time_s,
        }
    }

    #[test]
    fn the_finest_grid_covers_every_curve() {
        let curves =
            Curves { channels: vec![curve(0.0, 0.01, 11), curve(0.05, 0.001, 31)], ..Curves::default() };
        let time_s = common_time_s(&curves);
        assert_eq!(time_s.len(), 101);
        assert!(time_s[0].abs() < 1e-12 && (time_s[100] - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_fast_channel_outside_the_motion_makes_the_grid_finer_and_no_longer() {
        let dense = curve(-1.0, 0.001, 3001);
        let fast = OtherCurve {
            channel: "S1".into(),
            unit: "V".into(),
            time_s: dense.time_s,
            values: dense.raw_m_s2,
            frequency_hz: vec![],
            magnitude: vec![],
        };
        let curves = Curves { channels: vec![curve(0.0, 0.01, 11)], others: vec![fast], ..Curves::default() };
        let time_s = common_time_s(&curves);
        assert_eq!(time_s.len(), 101);
        assert!(time_s[0].abs() < 1e-12 && (time_s[100] - 0.1).abs() < 1e-12);
    }

    #[test]
    fn curves_far_apart_do_not_ask_for_endless_rows() {
        let curves =
            Curves { channels: vec![curve(0.0, 1e-6, 100), curve(1e6, 1e-6, 50)], ..Curves::default() };
        assert_eq!(common_time_s(&curves).len(), 100);
        assert!(common_time_s(&Curves::default()).is_empty());
    }

    #[test]
    fn a_grid_has_no_place_outside_its_curve() {
        let curve = curve(1.0, 0.1, 11);
        let grid = Grid::new(&curve.time_s).unwrap();
        let at = |time_s| grid.place(time_s)?.of(&curve.velocity_m_s);
        assert_eq!(at(0.99), None);
        assert_eq!(at(2.01), None);
        // A line is read exactly but for round-off.
        assert!((at(1.234).unwrap() - 2.468).abs() < 1e-12);
    }
}
