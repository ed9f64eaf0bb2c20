//! Curves to `curves.csv`: one table on the finest channel's times, units in the header.

use super::ReportError;
use super::grid::{CurveSeries, Grid, channel_series, common_time_s, motion_series};
use super::records::{finished, text_cell};
use crate::data::Curves;
use crate::numerics::{nanoseconds, single};
use std::io::Write;

/// The table; a cell outside its curve is empty.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub(super) fn bytes(curves: &Curves) -> Result<Vec<u8>, ReportError> {
    let groups = groups(curves);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_field("time_s")?;
    for (of, series) in groups.iter().flat_map(|group| group.series.iter().map(|series| (&group.of, series)))
    {
        writer.write_field(text_cell(&format!("{of}{}", series.name)))?;
    }
    writer.write_record(None::<&[u8]>)?;
    // A number needs no quotes, and is put behind the head without being looked at for what would.
    let (mut table, mut digits) = (finished(writer)?, zmij::Buffer::new());
    for time_s in common_time_s(curves) {
        put_nanoseconds(&mut table, time_s);
        for CurveGroup { grid, series, .. } in &groups {
            let place = grid.place(time_s);
            for CurveSeries { values, factor, .. } in series {
                table.push(b',');
                if let Some(value) = place.and_then(|place| place.of(values)) {
                    table.extend_from_slice(digits.format(single(value * factor)).as_bytes());
                }
            }
        }
        table.push(b'\n');
    }
    Ok(table)
}

/// A CSV of this program as a German spreadsheet reads it: semicolons between cells, decimal commas.
///
/// # Errors
/// [`ReportError::Csv`] where the writer fails.
pub fn in_german(table: &[u8]) -> Result<Vec<u8>, ReportError> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(table);
    let mut writer = csv::WriterBuilder::new().delimiter(b';').from_writer(Vec::new());
    for (i, row) in reader.records().enumerate() {
        let is_head = i == 0;
        writer.write_record(
            row?.iter().map(|cell| if is_head { cell.to_owned() } else { cell.replace('.', ",") }),
        )?;
    }
    finished(writer)
}

/// Columns of one grid: a channel's or the motion's.
struct CurveGroup<'a> {
    /// What their names begin with.
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

/// A time to the nanosecond, by whole numbers: of ten cells of a row it is the one that would take longest.
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

    fn rows(curves: &Curves) -> Vec<csv::StringRecord> {
        let bytes = bytes(curves).unwrap();
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
            assert_eq!(velocity.to_bits(), single(curves.channels[0].velocity_m_s[i]).to_bits(), "row {i}");
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
