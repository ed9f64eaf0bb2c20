//! Points and maps of a trial to CSV, a row a number.

use crate::lab::data::Trial;
use crate::report::ReportError;

fn finished(writer: ::csv::Writer<Vec<u8>>) -> Result<Vec<u8>, ReportError> {
    writer.into_inner().map_err(|error| ReportError::Csv(::csv::Error::from(error.into_error())))
}

/// `points.csv`.
pub(super) fn points(trial: &Trial) -> Result<Vec<u8>, ReportError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "family",
        "class",
        "method",
        "is_default",
        "is_on_front",
        "median_error",
        "p95_error",
        "error_unit",
        "time_ns",
        "time_lower_quartile_ns",
        "time_upper_quartile_ns",
        "time_per",
        "cases",
    ])?;
    for (p, on_front) in trial.points.iter().zip(&trial.is_on_front) {
        writer.write_record([
            p.family.clone(),
            p.class.clone(),
            p.method.clone(),
            p.is_default.to_string(),
            on_front.to_string(),
            format!("{:e}", p.median_error),
            format!("{:e}", p.p95_error),
            p.error_unit.clone(),
            p.time_ns.to_string(),
            p.time_quartiles_ns[0].to_string(),
            p.time_quartiles_ns[1].to_string(),
            p.time_per.clone(),
            p.cases.to_string(),
        ])?;
    }
    finished(writer)
}

/// `maps.csv`.
pub(super) fn maps(trial: &Trial) -> Result<Vec<u8>, ReportError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer.write_record(["map", "method", "stress_is", "stress", "error_is", "error", "limit", "noticed"])?;
    for map in &trial.maps {
        for line in &map.lines {
            for ((stress, error), noticed) in map.stresses.iter().zip(&line.errors).zip(&line.noticed) {
                writer.write_record([
                    map.name.clone(),
                    line.method.clone(),
                    map.stress.clone(),
                    format!("{stress:e}"),
                    map.error.clone(),
                    error.map_or_else(String::new, |e| format!("{e:e}")),
                    format!("{:e}", map.limit),
                    noticed.map_or_else(String::new, |n| n.to_string()),
                ])?;
            }
        }
    }
    finished(writer)
}
