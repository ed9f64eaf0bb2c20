//! Interpolates curves with different grids to any time, and writes `curves.csv`: one table on the finest
//! channel's times, units in the header.

use super::ReportError;
use super::records::{finish, text_cell};
use crate::data::{ChannelCurve, Curves, Events, MotionCurve, STANDARD_GRAVITY_M_S2};
use crate::numerics::{as_count, as_f64, nanoseconds, to_f32};
use std::io::Write;

/// One quantity of a curve: its name with its unit, its values, and the factor to that unit.
pub(super) struct CurveSeries<'a> {
    pub(super) name: &'static str,
    pub(super) values: &'a [f64],
    pub(super) factor: f64,
}

/// Columns of a channel.
pub(super) fn channel_series(curve: &ChannelCurve) -> [CurveSeries<'_>; 3] {
    [
        ("raw_g", &curve.raw_m_s2, 1.0 / STANDARD_GRAVITY_M_S2),
        ("filtered_g", &curve.filtered_m_s2, 1.0 / STANDARD_GRAVITY_M_S2),
        ("velocity_m_s", &curve.velocity_m_s, 1.0),
    ]
    .map(|(name, values, factor)| CurveSeries { name, values, factor })
}

/// Columns of the motion.
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

/// The events by name, s; `None` for an event that was not found.
pub(super) fn named_events(events: &Events) -> [(&'static str, Option<f64>); 4] {
    [
        ("release", events.release_s),
        ("first contact", events.first_contact_s()),
        ("separation", events.separation_s()),
        ("slap-down", events.slap_down_s()),
    ]
}

/// Step of a uniform time vector, s; `None` if it has fewer than two points or does not rise.
pub(super) fn step_s(time_s: &[f64]) -> Option<f64> {
    let (first, last) = (time_s.first()?, time_s.last()?);
    let step = (last - first) / as_f64(time_s.len().checked_sub(1)?);
    (step.is_finite() && step > 0.0).then_some(step)
}

/// The times of the finest channel, extended over the span of every curve of the motion and its channels.
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
    // Curves far apart would need empty rows: then the times of the finest channel alone are used.
    if !(rows.is_finite() && rows <= 4.0 * as_f64(held) + 4.0) {
        return finest.to_vec();
    }
    (0..as_count(rows)).map(|i| finest[0] + (as_f64(i) - before) * step).collect()
}

/// A uniform grid of a curve's points.
pub(super) struct Grid {
    start_s: f64,
    step_s: f64,
    last: f64,
}

/// A position on a grid: the index of the point before it, and the fraction of a step.
#[derive(Clone, Copy)]
pub(super) struct GridPlace {
    below: usize,
    weight: f64,
}

impl Grid {
    /// The grid of these times; `None` if they form none.
    pub(super) fn new(time_s: &[f64]) -> Option<Self> {
        Some(Self { start_s: *time_s.first()?, step_s: step_s(time_s)?, last: as_f64(time_s.len() - 1) })
    }

    /// The position of `time_s`; `None` outside the curve.
    pub(super) fn place(&self, time_s: f64) -> Option<GridPlace> {
        /// Positions that differ from a grid point by less are on it: the rounding of times, in steps.
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
    /// The value there, linear between two points; `None` if it is not finite.
    pub(super) fn interpolate(self, values: &[f64]) -> Option<f64> {
        let below = *values.get(self.below)?;
        let value = if self.weight > 0.0 {
            below * (1.0 - self.weight) + values.get(self.below + 1)? * self.weight
        } else {
            below
        };
        value.is_finite().then_some(value)
    }
}

/// The table; a cell outside its curve is empty.
///
/// # Errors
///
/// [`ReportError::Csv`] if the writer fails.
pub(super) fn table_bytes(curves: &Curves) -> Result<Vec<u8>, ReportError> {
    let groups = groups(curves);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_field("time_s")?;
    for (of, series) in groups.iter().flat_map(|group| group.series.iter().map(|series| (&group.of, series)))
    {
        writer.write_field(text_cell(&format!("{of}{}", series.name)))?;
    }
    writer.write_record(None::<&[u8]>)?;
    // A number needs no quotes, so it is appended to the head without a search for special characters.
    let (mut table, mut digits) = (finish(writer)?, zmij::Buffer::new());
    for time_s in common_time_s(curves) {
        put_nanoseconds(&mut table, time_s);
        for CurveGroup { grid, series, .. } in &groups {
            let place = grid.place(time_s);
            for CurveSeries { values, factor, .. } in series {
                table.push(b',');
                if let Some(value) = place.and_then(|place| place.interpolate(values)) {
                    table.extend_from_slice(digits.format(to_f32(value * factor)).as_bytes());
                }
            }
        }
        table.push(b'\n');
    }
    Ok(table)
}

/// Converts a CSV of this program for a German spreadsheet: semicolons between cells, decimal commas.
///
/// # Errors
///
/// [`ReportError::Csv`] if the writer fails.
pub fn in_german(table: &[u8]) -> Result<Vec<u8>, ReportError> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(table);
    let mut writer = csv::WriterBuilder::new().delimiter(b';').from_writer(Vec::new());
    for (i, row) in reader.records().enumerate() {
        let is_head = i == 0;
        writer.write_record(
            row?.iter().map(|cell| if is_head { cell.to_owned() } else { cell.replace('.', ",") }),
        )?;
    }
    finish(writer)
}

/// Columns of one grid: a channel's or the motion's.
struct CurveGroup<'a> {
    /// Beginning of their names.
    of: String,
    grid: Grid,
    series: Vec<CurveSeries<'a>>,
}

fn groups(curves: &Curves) -> Vec<CurveGroup<'_>> {
    let channels = curves.channels.iter().map(|curve| {
        let series = channel_series(curve).into();
        Some(CurveGroup { of: format!("{}_", curve.channel), grid: Grid::new(&curve.time_s)?, series })
    });
    let motion = curves.motion.iter().map(|motion| {
        let series = motion_series(motion).into();
        Some(CurveGroup { of: String::new(), grid: Grid::new(&motion.time_s)?, series })
    });
    let others = curves.others.iter().map(|curve| {
        let series = vec![CurveSeries { name: "", values: &curve.values, factor: 1.0 }];
        let (grid, name) = (Grid::new(&curve.time_s)?, format!("{}_raw_{}", curve.channel, curve.unit));
        Some(CurveGroup { of: name, grid, series })
    });
    channels.chain(motion).chain(others).flatten().collect()
}

/// Writes a time to the nanosecond, by whole numbers: among ten cells of a row it would otherwise be the
/// slowest.
fn put_nanoseconds(table: &mut Vec<u8>, time_s: f64) {
    let time_ns = nanoseconds(time_s);
    let (sign, time_ns) = (if time_ns < 0 { "-" } else { "" }, time_ns.unsigned_abs());
    // Writing to memory does not fail.
    let _ = write!(table, "{sign}{}.{:09}", time_ns / 1_000_000_000, time_ns % 1_000_000_000);
}

#[cfg(test)]
mod tests {
    use super::super::sample;
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
        let at = |time_s| grid.place(time_s)?.interpolate(&curve.velocity_m_s);
        assert_eq!(at(0.99), None);
        assert_eq!(at(2.01), None);
        // A line is read exactly but for round-off.
        assert!((at(1.234).unwrap() - 2.468).abs() < 1e-12);
    }

    fn rows(curves: &Curves) -> Vec<csv::StringRecord> {
        let bytes = table_bytes(curves).unwrap();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        reader.records().map(Result::unwrap).collect()
    }

    #[test]
    fn the_header_carries_names_and_units() {
        let rows = rows(&sample::analysis().curves);
        let header: Vec<&str> = rows[0].iter().take(5).collect();
        assert_eq!(header, ["time_s", "A1_raw_g", "A1_filtered_g", "A1_velocity_m_s", "A2_raw_g"]);
        assert!(rows[0].iter().any(|name| name == "vertical_velocity_first_m_s"));
        assert_eq!(rows.len(), 2001);
    }

    #[test]
    fn a_german_table_has_decimal_commas_and_the_same_heads() {
        let german = in_german(b"time_s,\"A,1.0_raw_g\"\n0.5,-1.25e-3\n1.0,\n").unwrap();
        assert_eq!(String::from_utf8(german).unwrap(), "time_s;A,1.0_raw_g\n0,5;-1,25e-3\n1,0;\n");
    }

    #[test]
    fn values_return_as_they_were() {
        let curves = sample::analysis().curves;
        let rows = rows(&curves);
        for (i, row) in rows[1..].iter().enumerate().step_by(97) {
            // Single precision, printed so that it reads back to the same bits.
            let velocity: f32 = row[3].parse().unwrap();
            assert_eq!(velocity.to_bits(), to_f32(curves.channels[0].velocity_m_s[i]).to_bits(), "row {i}");
        }
    }

    #[test]
    fn cells_outside_the_motion_are_empty() {
        let rows = rows(&sample::analysis().curves);
        assert_eq!(&rows[1][7], "");
        assert_ne!(&rows[300][7], "");
    }

    #[test]
    fn a_name_cannot_be_a_formula() {
        let mut curves = sample::analysis().curves;
        for name in ["=HYPERLINK(\"x\")", "+1", "-1", "@A1", "\t=1", " =1", "\u{ff1d}1"] {
            curves.channels[0].channel = name.into();
            let header = rows(&curves)[0][1].to_owned();
            assert!(header.starts_with('\''), "{header}");
        }
    }
}
