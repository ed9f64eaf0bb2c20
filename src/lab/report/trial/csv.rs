//! Points and maps of a trial to CSV, a row a number.

use crate::lab::data::{Trial, TrialLine, TrialMap, TrialPoint};
use crate::report::ReportError;
use crate::report::records::{CsvColumn, records};

/// A point and whether it is on the front.
type PointRow<'a> = (&'a TrialPoint, bool);

/// `points.csv`.
pub(super) fn points(trial: &Trial) -> Result<Vec<u8>, ReportError> {
    let columns: [CsvColumn<PointRow>; 13] = [
        ("family", |(p, _)| p.family.clone()),
        ("class", |(p, _)| p.class.clone()),
        ("method", |(p, _)| p.method.clone()),
        ("is_default", |(p, _)| p.is_default.to_string()),
        ("is_on_front", |(_, on_front)| on_front.to_string()),
        ("median_error", |(p, _)| format!("{:e}", p.median_error)),
        ("p95_error", |(p, _)| format!("{:e}", p.p95_error)),
        ("error_unit", |(p, _)| p.error_unit.clone()),
        ("time_ns", |(p, _)| p.time_ns.to_string()),
        ("time_lower_quartile_ns", |(p, _)| p.time_quartiles_ns[0].to_string()),
        ("time_upper_quartile_ns", |(p, _)| p.time_quartiles_ns[1].to_string()),
        ("time_per", |(p, _)| p.time_per.clone()),
        ("cases", |(p, _)| p.cases.to_string()),
    ];
    records(&columns, trial.points.iter().zip(trial.is_on_front.iter().copied()))
}

/// A stress of a line of a map, by its place.
#[derive(Clone, Copy)]
struct Stressed<'a> {
    map: &'a TrialMap,
    line: &'a TrialLine,
    place: usize,
}

/// `maps.csv`.
pub(super) fn maps(trial: &Trial) -> Result<Vec<u8>, ReportError> {
    let columns: [CsvColumn<Stressed>; 8] = [
        ("map", |at| at.map.name.clone()),
        ("method", |at| at.line.method.clone()),
        ("stress_is", |at| at.map.stress.clone()),
        ("stress", |at| format!("{:e}", at.map.stresses[at.place])),
        ("error_is", |at| at.map.error.clone()),
        ("error", |at| at.line.errors[at.place].map_or_else(String::new, |e| format!("{e:e}"))),
        ("limit", |at| format!("{:e}", at.map.limit)),
        ("noticed", |at| at.line.noticed[at.place].map_or_else(String::new, |n| n.to_string())),
    ];
    let rows = trial.maps.iter().flat_map(|map| {
        map.lines.iter().flat_map(move |line| {
            let places = map.stresses.len().min(line.errors.len()).min(line.noticed.len());
            (0..places).map(move |place| Stressed { map, line, place })
        })
    });
    records(&columns, rows)
}
