//! The lines above the rows to the columns' names and units.

use super::super::lines::Line;
use super::cells::Delimiter;
use super::dialect::Judged;
use crate::ingest::{number, vocabulary};

/// So many lines above the rows may be the header: below it stand its units, and minima, maxima or remarks.
const MOST_LINES: usize = 5;

/// One column of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TableColumn {
    /// Its header as written, or its number from 1.
    pub header: String,
    /// The header without its unit.
    pub name: String,
    /// Its unit, from the header or the row of units.
    pub unit: Option<String>,
    /// Whether its cells are numbers.
    pub is_numeric: bool,
    /// Whether its cells are date-time stamps or clock times.
    pub is_stamped: bool,
    /// Its cell in the first row; of words, the first one that is a number with thousands marked.
    pub example: String,
}

/// The header of a table.
pub(super) struct Header {
    /// Index of its line.
    pub line: usize,
    cells: Vec<String>,
    units: Option<Vec<String>>,
    /// Seconds from a row to the next.
    pub interval: Option<String>,
}

/// The header above the rows, with the row of units where there is one; else why the line that looks most
/// like it is none, in brackets, or nothing.
pub(super) fn header(
    above: &[Line],
    delimiter: Delimiter,
    judged: &Judged,
    has_row_names: bool,
) -> Result<Header, String> {
    let filled = (0..above.len()).rev().filter(|&line| !above[line].text.trim().is_empty());
    let cells = |line: usize| {
        let mut cells = header_cells(&above[line].text, delimiter);
        // R heads no column of the names of its rows.
        if has_row_names && cells.len() + 1 == judged.columns {
            cells.insert(0, String::new());
        }
        (line, cells)
    };
    // MSR's loggers mark what follows: `*CHANNEL`, `*UNIT`, `*DATA`.
    let is_mark = |(_, cells): &(usize, Vec<String>)| matches!(&cells[..], [one] if one.starts_with('*'));
    let mut nearest: Vec<(usize, Vec<String>)> =
        filled.clone().map(cells).filter(|it| !is_mark(it)).take(MOST_LINES).collect();
    // Rigol's oscilloscopes head "X,CH1,Start,Increment", and below "Sequence,Volt,-0.05,1e-6" stand fewer
    // cells.
    let mut interval = None;
    if let [(_, units), (_, names), ..] = &mut nearest[..]
        && let Some(at) = names.windows(2).position(|pair| pair[0] == "Start" && pair[1] == "Increment")
    {
        interval = units.get(at + 1).cloned();
        names.truncate(at);
        units.truncate(at);
    }
    let titled = |is: fn(&str) -> bool| filled.clone().map(cells).find(|(_, cells)| is(&cells[0]));
    let of_title = titled(vocabulary::titles_units).filter(|(_, cells)| is_units(&cells[1..]));
    // LabVIEW's title stands above no column where there is none of times.
    let is_beside = |cells: &[String]| cells.iter().filter(|cell| !cell.is_empty()).count() > judged.columns;
    let of_title = of_title.map(|(_, cells)| {
        let before = vec![String::new(); usize::from(!is_beside(&cells))];
        [before, cells[1..].to_vec()].concat()
    });
    let fitting = |cells: &[String]| fitting(cells.to_vec(), judged);
    // Keysight's oscilloscopes number their channels: `x-axis,1,2` above `second,Volt,Volt`.
    let is_numbered = |cells: &[String]| {
        cells.len() > 1
            && is_names(&cells[..1], 1)
            && cells.iter().enumerate().skip(1).all(|(at, cell)| *cell == at.to_string())
    };
    let is_names = |cells: &[String]| is_names(cells, judged.columns) || is_numbered(cells);
    for pair in nearest.windows(2) {
        let [(_, units), (line, names)] = pair else { continue };
        if is_units(units)
            && is_names(names)
            && !is_units(names)
            && let (Some(mut units), Some(cells)) = (fitting(units), fitting(names))
        {
            if vocabulary::titles_units(&units[0]) {
                units[0].clear();
            }
            return Ok(Header { line: *line, cells, units: Some(units), interval });
        }
    }
    // A line that does not fit is no reason to take one above it, unless it is a remark.
    let named = nearest.iter().find(|(_, cells)| is_names(cells));
    let titled = titled(vocabulary::titles_names);
    let mut found = titled.iter().chain(named).chain(nearest.first());
    let header = found.find_map(|(line, cells)| {
        Some(Header { line: *line, cells: fitting(cells)?, units: of_title.clone(), interval: None })
    });
    header.ok_or_else(|| unfit(&nearest, delimiter, judged.columns))
}

fn unfit(nearest: &[(usize, Vec<String>)], delimiter: Delimiter, columns: usize) -> String {
    let mut named = nearest.iter().filter(|(_, cells)| cells.len() > 1 && is_names(cells, columns));
    let Some((at, cells)) = named.next() else { return String::new() };
    let is_twofold = delimiter.0 == b',' && columns == 2 * cells.len();
    let twofold = ": the comma is the decimal mark too; export it again with semicolons between the cells";
    let why = if is_twofold { twofold } else { "" };
    format!(" (line {} has {} cells, the rows {columns}{why})", at + 1, cells.len())
}

/// Whether cells may name columns: no "Minimum;1,5;-5", no "Kommentar: von Hand", no "Bemerkung;;".
fn is_names(cells: &[String], columns: usize) -> bool {
    let is_number =
        |cell: &String| [b'.', b','].iter().any(|mark| number::of_cell(cell.as_bytes(), *mark).is_some());
    let is_remark = columns > 1 && cells[1..].iter().all(String::is_empty);
    !is_remark && !cells.iter().any(is_number)
}

/// Whether cells are units, at least half of them known ones.
fn is_units(cells: &[String]) -> bool {
    // Of nothing, or of what has none, "-" or "1".
    let filled = cells.iter().filter(|cell| !matches!(cell.as_str(), "" | "-" | "1"));
    let known = filled.clone().filter(|cell| is_unit(cell)).count();
    known > 0 && 2 * known >= filled.count()
}

/// The cells of a header if they are as many as the columns.
fn fitting(mut cells: Vec<String>, judged: &Judged) -> Option<Vec<String>> {
    // A delimiter may end the header and not the rows; LabVIEW heads a column of remarks that rows without
    // one leave out.
    while cells.len() > judged.columns
        && cells.last().is_some_and(|cell| cell.is_empty() || (cells.len() > 2 && cell == "Comment"))
    {
        cells.pop();
    }
    // Delimiters may end the rows and not the header; one short of a column of numbers would head the wrong
    // ones.
    let spare = judged.is_empty.iter().rev().take_while(|is_empty| **is_empty).count();
    let spare = spare.max(usize::from(judged.is_numeric.last() == Some(&false)));
    (cells.len() <= judged.columns && cells.len() + spare >= judged.columns).then_some(cells)
}

/// A header's cells, without the mark of a comment before them.
pub(super) fn header_cells(line: &str, delimiter: Delimiter) -> Vec<String> {
    let is_mark = |c: char| matches!(c, '#' | '%') || (c == ';' && delimiter.0 != b';');
    let line = line.trim_start_matches(is_mark).trim_start_matches(' ').trim_start_matches("Headers,");
    delimiter.cells(line).into_iter().map(|cell| cell.replace("\"\"", "\"")).collect()
}

/// Whether a cell is a unit: `g`, `[furlong]`, `hh:mm:ss.000`; "A1 [g]" is a name with its unit.
fn is_unit(cell: &str) -> bool {
    let is_bracketed = cell.starts_with(['[', '(']) && cell.ends_with([']', ')']);
    let is_clock =
        cell.contains(':') && cell.to_lowercase().bytes().all(|b| b"dmyhsf0:.,/- []()".contains(&b));
    is_bracketed || is_clock || vocabulary::is_unit(cell)
}

/// The columns with their names and units; `example` is a row.
pub(super) fn columns(header: Option<&Header>, judged: &Judged, example: &[&str]) -> Vec<TableColumn> {
    (0..judged.columns)
        .map(|index| {
            let header_text = match header {
                Some(header) => header.cells.get(index).cloned().unwrap_or_default(),
                None => (index + 1).to_string(),
            };
            let (name, own_unit) = name_and_unit(&header_text);
            let row_unit = header.and_then(|h| h.units.as_ref()).and_then(|units| units.get(index));
            let row_unit = row_unit.map(|unit| unit.trim_matches(['[', ']', '(', ')']).to_owned());
            TableColumn {
                name: name.to_owned(),
                unit: row_unit.filter(|unit| !unit.is_empty()).or_else(|| own_unit.map(str::to_owned)),
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
