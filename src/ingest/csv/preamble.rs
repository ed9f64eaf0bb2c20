//! The lines above a table to what they state of it: how many rows it has, and at what rate they were taken.

use super::header;
use super::layout::Line;
use crate::data::{Issue, IssueCode, Severity};
use crate::ingest::stated_rate::{self, Agreement, StatedRate};
use crate::ingest::time_unit;

/// What precedes a count of rows, in lower case.
const COUNT_NAMES: [&str; 14] = [
    // LabVIEW's, which the rest of its files keep to.
    "samples",
    "number of samples",
    "no. of samples",
    "sample count",
    "samples per channel",
    "record length",
    "number of points",
    "number of rows",
    "points",
    "anzahl werte",
    "anzahl messwerte",
    "anzahl abtastwerte",
    "anzahl samples",
    "anzahl punkte",
];

/// What precedes a rate, in lower case.
const RATE_NAMES: [&str; 11] = [
    "sample rate",
    "samplerate",
    "sampling rate",
    "samplingrate",
    "sampling frequency",
    "sample frequency",
    "abtastrate",
    "abtastfrequenz",
    "samplingfrequenz",
    "scan rate",
    "fs",
];

/// What precedes the interval between samples, in lower case.
const INTERVAL_NAMES: [&str; 8] = [
    "dt",
    "delta t",
    "sample interval",
    "sampling interval",
    "sample period",
    "sampling period",
    "abtastintervall",
    "abtastperiode",
];

/// Times the number that stands there, where its unit does not: in Hz, kHz or MHz, or as intervals in s, ms, µs or ns.
const UNSTATED: [f64; 4] = [1.0, 1e3, 1e6, 1e9];

/// What is stated above a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Preamble {
    counts: Vec<u64>,
    rates: Vec<Rate>,
}

/// A rate, with whether its unit is stated; without, it may be any of several.
#[derive(Debug, Clone, PartialEq)]
struct Rate {
    stated: StatedRate,
    has_unit: bool,
}

impl Preamble {
    /// Of the lines above the header.
    pub(super) fn of(above: &[Line], delimiter: u8) -> Self {
        let mut preamble = Self::default();
        for line in above {
            let Some((key, values)) = entry(&line.text, delimiter) else { continue };
            let (name, unit) = header::name_and_unit(&key);
            // A full scale, a dead time.
            if ["FS", "DT"].contains(&name) {
                continue;
            }
            let name = name.to_lowercase().replace('_', " ");
            let (name, unit) =
                name.strip_suffix(" hz").map_or((name.as_str(), unit), |name| (name, Some("Hz")));
            if COUNT_NAMES.contains(&name) {
                preamble.counts.extend(same(&values).and_then(|count| count.parse::<u64>().ok()));
            } else {
                preamble.rates.extend(rate(name, unit, &values));
            }
        }
        preamble
    }

    /// A warning where fewer rows are there than every count that is stated; `rows` are those of the table and, where its times tell, those
    /// with the gaps between. Programs that write on behind a header leave more, and some count the cells of all `columns`.
    pub(super) fn of_rows(&self, rows: (usize, usize), columns: usize) -> Option<Issue> {
        let (there, told) = (rows.0 as u64, rows.1.max(rows.0) as u64);
        let stated = *self.counts.iter().min()?;
        let is_of_cells = (2..=columns as u64).any(|columns| stated == there * columns);
        (told < stated && !is_of_cells).then(|| {
            let message = format!(
                "the header states {stated} samples, and the table has {there} rows: what is missing was lost, or the file was cut off; where it \
                 is missing nothing shows, and every time behind would be early"
            );
            Issue::new(IssueCode::Truncated, Severity::Warning, message)
        })
    }

    /// A warning where none of the rates stated is the one taken, in Hz; the times give theirs to `rounding`, as a part of it.
    pub(super) fn of_rate(&self, taken_hz: f64, times: Option<f64>) -> Option<Issue> {
        let agrees = |rate: &Rate| {
            let stated = rate.nearest(taken_hz);
            let is_same = |hz: f64| stated.agreement(hz, times.unwrap_or(0.0)) == Agreement::Same;
            // A recorder states its own rate where a whole part of the samples was exported, as the times show.
            let every = (stated.rate_hz / taken_hz).round();
            is_same(taken_hz) || (times.is_some() && every > 1.0 && is_same(taken_hz * every))
        };
        let stated = self.rates.first().filter(|_| !self.rates.iter().any(agrees))?.nearest(taken_hz);
        let says = if times.is_some() { "by the times or the cask file" } else { "by the cask file" };
        let message = format!(
            "the lines above the table state {}, {says} the samples were taken at {} Hz: one of the two is wrong, and every velocity goes with \
             the rate",
            stated.shown(),
            stated_rate::shown_hz(taken_hz)
        );
        Some(Issue::new(IssueCode::Clock, Severity::Warning, message))
    }
}

impl Rate {
    /// It in the unit that brings it nearest to a rate, where none is stated.
    fn nearest(&self, rate_hz: f64) -> StatedRate {
        let scales = if self.has_unit { &UNSTATED[..1] } else { &UNSTATED[..] };
        let far = |scale: &f64| (self.stated.rate_hz * scale / rate_hz).ln().abs();
        let scale = scales.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(1.0);
        StatedRate { rate_hz: self.stated.rate_hz * scale, ..self.stated.clone() }
    }
}

/// `Sample rate [Hz]: 50000` to what stands before the mark and the cells behind it; numbers with a point.
fn entry(line: &str, delimiter: u8) -> Option<(String, Vec<String>)> {
    let is_mark =
        |c: char| matches!(c, ':' | '=' | ';' | '\t' | ',') || c == char::from(delimiter) && c != ' ';
    let line = line.trim_start_matches(['#', '%', ' ']);
    let (key, rest) = line.split_at(line.find(is_mark)?);
    let bare = |cell: &str| cell.trim().trim_matches(['"', ':', '=']).trim().to_owned();
    // Where a comma parts cells none is a decimal mark.
    let is_comma = delimiter == b',' || rest.starts_with(',');
    let cells = rest.split(|c: char| matches!(c, ';' | '\t' | '|') || (c == ',' && is_comma));
    let cells = cells.map(bare).filter(|cell| !cell.is_empty()).map(|cell| cell.replace(',', "."));
    Some((bare(key), cells.collect()))
}

/// The number that all cells with numbers hold.
fn same(cells: &[String]) -> Option<&str> {
    let mut numbers = cells.iter().filter(|cell| cell.parse::<f64>().is_ok());
    let first = numbers.next()?;
    numbers.all(|other| other == first).then_some(first)
}

/// `50 kHz`, or `50` with its unit in the next cell or beside its name.
fn rate(name: &str, unit: Option<&str>, values: &[String]) -> Option<Rate> {
    let is_rate = RATE_NAMES.contains(&name);
    if !is_rate && !INTERVAL_NAMES.contains(&name) {
        return None;
    }
    let (first, own) = stated_rate::number_and_unit(values.first()?)?;
    let next = values.get(1).map(String::as_str).filter(|next| next.parse::<f64>().is_err());
    // Several numbers are of several channels.
    if first == values[0] && same(values).is_none() {
        return None;
    }
    let unit = Some(own).filter(|own| !own.is_empty()).or(unit).or(next);
    let scale = match unit {
        None => 1.0,
        Some(unit) if is_rate => stated_rate::hz_a_unit(unit)?,
        Some(unit) => time_unit::seconds(unit)?,
    };
    let value = first.parse::<f64>().ok()? * scale;
    let rate_hz = if is_rate { value } else { value.recip() };
    let stated = StatedRate {
        place: format!(
            "{name} = {first}{}{}",
            if unit.is_some() { " " } else { "" },
            unit.unwrap_or_default()
        ),
        rate_hz,
        rounding: stated_rate::rounding(first),
    };
    (rate_hz.is_finite() && rate_hz > 0.0).then_some(Rate { stated, has_unit: unit.is_some() })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cask_file, read_bytes};
    use super::*;
    use std::fmt::Write as _;

    /// What is said of a table of so many rows at 20 kHz below these lines; `lost` rows are missing behind the first hundred.
    fn said(
        above: &str,
        header: &str,
        (rows, lost): (usize, usize),
        rate_hz: Option<f64>,
    ) -> Vec<(IssueCode, String)> {
        let mut text = format!("{above}\n{header}\n");
        for i in (0..rows).map(|i| if i < 100 { i } else { i + lost }) {
            let time = if header.starts_with("Zeit") {
                format!("{}.{:05};", i / 20_000, i % 20_000 * 5)
            } else {
                String::new()
            };
            let _ = writeln!(text, "{time}{}.5;{}.25", i * 7919 % 13, i * 104_729 % 17);
        }
        let mut cask = cask_file(&["A1", "A2"]);
        cask.channels.iter_mut().for_each(|spec| spec.sample_rate_hz = rate_hz);
        let recording = read_bytes(text.as_bytes(), &cask).unwrap();
        recording.issues.into_iter().map(|issue| (issue.code, issue.message)).collect()
    }

    #[test]
    fn rows_short_of_those_stated_are_told() {
        let rate_hz = Some(20_000.0);
        for above in [
            "Samples\t500\t500",
            "Number of samples: 500",
            "\"Record Length\",500,Points",
            "Anzahl Werte;500",
        ] {
            let [(code, message)] = &said(above, "A1;A2", (499, 0), rate_hz)[..] else { panic!("{above}") };
            assert_eq!(*code, IssueCode::Truncated);
            assert!(message.contains("states 500 samples") && message.contains("499 rows"), "{message}");
            // Renumbered times show no gap either; others say themselves where rows are missing.
            assert_eq!(said(above, "Zeit;A1;A2", (480, 0), None).len(), 1, "{above}");
            assert_eq!(said(above, "Zeit;A1;A2", (480, 20), None), [], "{above}");
            for rows in [500, 650] {
                assert_eq!(said(above, "A1;A2", (rows, 0), rate_hz), [], "{above}");
            }
            assert_eq!(said(above, "A1;A2", (250, 0), rate_hz), [], "cells of both columns: {above}");
        }
        for above in [
            "Samples;500;400",
            "Samples;many",
            "Samples per second;500",
            "Points of interest;500",
            "Channels;500",
        ] {
            assert_eq!(said(above, "A1;A2", (300, 0), rate_hz), [], "{above}");
        }
    }

    #[test]
    fn a_stated_rate_that_is_not_the_one_taken_is_told() {
        for above in [
            "Abtastrate;20400",
            "Abtastrate [kHz];20,4",
            "# Sampling frequency [Hz]: 20400",
            "Sample rate;20.4 kHz",
            "Sample rate,20.4,kHz",
            "sample_rate_hz = 20400",
            "fs=20,4",
            "dt;4,9e-5",
            "Sample Interval: 49 us",
        ] {
            for (header, rate_hz) in [("Zeit;A1;A2", None), ("A1;A2", Some(20_000.0))] {
                let [(code, message)] = &said(above, header, (500, 0), rate_hz)[..] else {
                    panic!("{above} {header}")
                };
                assert_eq!(*code, IssueCode::Clock);
                assert!(message.contains("which is 204") && message.contains("20000 Hz"), "{message}");
            }
        }
    }

    #[test]
    fn a_stated_rate_that_fits_says_nothing() {
        for above in [
            "Abtastrate;20000",
            "Abtastrate;20",
            "Sample rate: 20010 Hz",
            "Sample rate;20000;20000",
            "Sample rate;10000;20000",
            "Sample rate: 10 kHz\nSample rate: 20 kHz",
            "Sample rate: 20 V",
            "Sample rate: fast",
            "dt;5e-5",
            "dt;0,05",
            "dt;50",
            "Heart rate;70",
            "FS;2000",
            "DT;0,4",
            "dt",
            "fs=",
        ] {
            for (header, rate_hz) in [("Zeit;A1;A2", None), ("A1;A2", Some(20_000.0))] {
                assert_eq!(said(above, header, (500, 0), rate_hz), [], "{above} {header}");
            }
        }
        // Each fifth of a recorder's samples was exported, as the times show; without times nothing does.
        assert_eq!(said("Sample rate: 100 kHz", "Zeit;A1;A2", (500, 0), None), []);
        assert_eq!(said("Sample rate: 100 kHz", "A1;A2", (500, 0), Some(20_000.0)).len(), 1);
    }
}
