//! The lines above the rows to the columns' names and units.

use super::layout::{Column, Judged, Line};
use crate::ingest::stated_rate::{self, StatedRate};
use crate::ingest::time_unit;

/// Units beside those of time that a row of units may hold, in lower case.
const UNITS: [&str; 40] = [
    "g", "mg", "gn", "m/s2", "m/s^2", "m/s²", "m/s**2", "mm/s2", "mm/s^2", "v", "mv", "µv", "n", "kn", "hz",
    "khz", "°c", "degc", "k", "bar", "pa", "kpa", "mpa", "%", "-", "1", "mm", "m", "rad/s", "deg/s", "°/s",
    "deg", "°", "a", "ma", "µm/m", "um/m", "kg", "nm", "rad",
];

/// What closes the header of LabVIEW's measurement files, and that of the first segment in it.
const END_OF_HEADER: &str = "***End_of_Header***";

/// So many rows stand below that of the units at most: minima, maxima, remarks.
const MOST_EXTRA: usize = 3;

/// What begins a row below the header that holds no samples, in lower case.
const REMARKS: [&str; 20] = [
    "min",
    "minimum",
    "minima",
    "max",
    "maximum",
    "maxima",
    "mean",
    "average",
    "mittelwert",
    "rms",
    "comment",
    "comments",
    "kommentar",
    "kommentare",
    "bemerkung",
    "bemerkungen",
    "beschreibung",
    "description",
    "note",
    "remark",
];

/// The header of a table.
pub(super) struct Header {
    /// Index of its line.
    pub line: usize,
    cells: Vec<String>,
    units: Option<Vec<String>>,
}

/// How many lines the header of a measurement file of LabVIEW has; 0 in others.
pub(super) fn labview_lines(lines: &[Line]) -> usize {
    let is_end = |line: &Line| line.text.trim_start().starts_with(END_OF_HEADER);
    // A further one closes the header of a further segment, whose rows are another table.
    let ends = lines.iter().enumerate().filter(|(_, line)| is_end(line)).map(|(i, _)| i + 1).take(2);
    ends.last().unwrap_or(0)
}

/// The rate that each cell of Delta_X states, which stands above the rows of LabVIEW's files.
pub(super) fn labview_rates(lines: &[Line], delimiter: u8) -> Vec<Option<StatedRate>> {
    let cells_of = |name: &str| {
        let cells = lines.iter().rev().map(|line| header_cells(&line.text, delimiter));
        cells.into_iter().find(|cells| cells.first().is_some_and(|first| first == name))
    };
    let dimensions = cells_of("X_Dimension").unwrap_or_default();
    let is_time = |cell: usize| match dimensions.get(cell).or(dimensions.last()).map(String::as_str) {
        None | Some("" | "Time" | "X_Dimension") => true,
        Some(_) => false,
    };
    let rates = cells_of("Delta_X").unwrap_or_default().into_iter().enumerate().map(|(i, cell)| {
        let interval_s: f64 = cell.replace(',', ".").parse().ok()?;
        let rate_hz = interval_s.recip();
        (is_time(i) && rate_hz.is_finite() && rate_hz > 0.0).then(|| StatedRate {
            place: format!("Delta_X = {cell}"),
            rate_hz,
            rounding: stated_rate::rounding(&cell),
        })
    });
    rates.collect()
}

/// The header above the rows, with the row of units where there is one.
pub(super) fn header(above: &[Line], delimiter: u8, judged: &Judged) -> Option<Header> {
    let fitting = |line: usize| fitting(header_cells(&above[line].text, delimiter), judged);
    let is_filled = |i: &usize| !above[*i].text.trim().is_empty();
    let nearest: Vec<usize> = (0..above.len()).rev().filter(is_filled).take(MOST_EXTRA + 2).collect();
    for pair in nearest.windows(2) {
        if let Some(units) = fitting(pair[0])
            && units.iter().any(|cell| !cell.is_empty())
            && units.iter().all(|cell| is_unit(cell))
            && let Some(names) = fitting(pair[1])
            // "min" in a row of minima is a unit too.
            && names.iter().any(|name| !name.is_empty() && !is_unit(name))
        {
            return Some(Header { line: pair[1], cells: names, units: Some(units) });
        }
    }
    let is_remark = |line: usize| {
        let cells = header_cells(&above[line].text, delimiter);
        let first = cells.iter().find(|cell| !cell.is_empty()).map_or("", String::as_str).to_lowercase();
        // A line of its own goes on behind the word; beside other cells "Max A1" is a name.
        let word = if cells.len() == 1 {
            first.split([':', ' ']).next()
        } else {
            Some(first.trim_end_matches([':', '.']))
        };
        word.is_some_and(|word| REMARKS.contains(&word))
    };
    let past_remarks =
        nearest.iter().find(|&&line| !is_remark(line)).and_then(|&line| Some((line, fitting(line)?)));
    let nearest = nearest.first().and_then(|&line| Some((line, fitting(line)?)));
    past_remarks.or(nearest).map(|(line, cells)| Header { line, cells, units: None })
}

/// The cells of a header if they are as many as the columns.
fn fitting(mut cells: Vec<String>, judged: &Judged) -> Option<Vec<String>> {
    // A delimiter may end the header and not the rows; LabVIEW heads a column of remarks that rows without one leave out.
    while cells.len() > judged.columns
        && cells.last().is_some_and(|cell| cell.is_empty() || (cells.len() > 2 && cell == "Comment"))
    {
        cells.pop();
    }
    // Delimiters may end the rows and not the header; one short of a column of numbers would head the wrong ones.
    let spare = judged.is_empty.iter().rev().take_while(|is_empty| **is_empty).count();
    let spare = spare.max(usize::from(judged.is_numeric.last() == Some(&false)));
    (cells.len() <= judged.columns && cells.len() + spare >= judged.columns).then_some(cells)
}

/// A header's cells by the rules of CSV (quotes, doubled quotes), without the mark of a comment.
fn header_cells(line: &str, delimiter: u8) -> Vec<String> {
    let line = line.trim_start_matches(['#', '%']).trim_start_matches(' ');
    if delimiter == b' ' {
        return line.split_ascii_whitespace().map(str::to_owned).collect();
    }
    let mut reader = ::csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .trim(::csv::Trim::All)
        .from_reader(line.as_bytes());
    let record = reader.records().next().and_then(Result::ok).unwrap_or_default();
    record.iter().map(str::to_owned).collect()
}

fn is_unit(cell: &str) -> bool {
    let bare = cell.trim_matches(['[', ']', '(', ')']).to_lowercase();
    // "A1 [g]" is a name with its unit.
    let is_bracketed = cell.starts_with(['[', '(']) && cell.ends_with([']', ')']);
    // "hh:mm:ss.000".
    let is_clock = bare.contains(':') && bare.bytes().all(|b| b"dmyhsf0:.,/- ".contains(&b));
    cell.is_empty()
        || is_bracketed
        || is_clock
        || time_unit::seconds(&bare).is_some()
        || UNITS.contains(&bare.as_str())
}

/// The columns with their names and units; `example` is a row.
pub(super) fn columns(header: Option<&Header>, judged: &Judged, example: &[&str]) -> Vec<Column> {
    (0..judged.columns)
        .map(|index| {
            let header_text = match header {
                Some(header) => header.cells.get(index).cloned().unwrap_or_default(),
                None => (index + 1).to_string(),
            };
            let (name, own_unit) = name_and_unit(&header_text);
            let row_unit = header.and_then(|h| h.units.as_ref()).and_then(|units| units.get(index));
            let row_unit = row_unit.map(|unit| unit.trim_matches(['[', ']', '(', ')']).to_owned());
            Column {
                name: name.to_owned(),
                unit: row_unit.or_else(|| own_unit.map(str::to_owned)).filter(|unit| !unit.is_empty()),
                header: header_text,
                is_numeric: judged.is_numeric[index],
                is_stamped: judged.is_stamped[index],
                example: example.get(index).map_or("", |cell| cell).to_owned(),
            }
        })
        .collect()
}

/// "A1 [g]", "A1 (g)" or "A1 / g" to "A1" and "g".
pub(super) fn name_and_unit(header: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(rest) = header.strip_suffix(close)
            && let Some((name, unit)) = rest.rsplit_once(open)
            && !name.trim().is_empty()
        {
            // "time[0]" counts the columns.
            let is_index = unit.bytes().all(|b| b.is_ascii_digit());
            return (name.trim(), (!is_index).then(|| unit.trim()));
        }
    }
    match header.rsplit_once(" / ") {
        Some((name, unit)) if is_unit(unit.trim()) => (name.trim(), Some(unit.trim())),
        _ => (header, None),
    }
}
