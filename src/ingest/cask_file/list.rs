//! A sensor list, a CSV with a row a channel, to the `[[channel]]` tables that say the same; each of their
//! lines knows its cell.

use super::cells::{ExpandedCaskFile, SENSORS, SensorList};
use super::overrides::value;
use super::wording::{line_of, nearest};
use super::{LARGEST_MIB, bytes, no_cask_file};
use crate::data::keys::{CHANNEL, Key};
use crate::ingest::error::of_file;
use crate::ingest::refusal::Refusal;
use crate::ingest::{IngestError, in_utf8};
use std::ffi::OsStr;
use std::fmt::Write;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeFloat, DeInteger, DeTable};

/// The column of a key that a list calls otherwise, as measuring plans do.
const PLANE: [&str; 2] = ["plane_m", "position_m"];

/// What a list has of a channel that takes no part in the motion, and its table does not: where it sits.
const OF_PLACE: [&str; 4] = ["position_m", "around_deg", "direction", "polarity"];

impl ExpandedCaskFile {
    /// The cask file at `path` of this text with its list; `None` where it names none, or is no TOML.
    pub fn read(path: &Path, text: &str) -> Result<Option<Self>, IngestError> {
        let Ok(root) = DeTable::parse(text) else { return Ok(None) };
        let Some((key, named)) = root.get_ref().get_key_value(SENSORS) else { return Ok(None) };
        let mend = "write sensors = \"list.csv\", the name of a CSV file in the folder of the cask file";
        // A cask file that was sent names nothing outside its folder.
        let name =
            named.get_ref().as_str().filter(|name| Path::new(name).file_name() == Some(OsStr::new(name)));
        let Some(name) = name else {
            let problem = "sensors is not the name of a file in the folder of the cask file";
            return Err(no_cask_file(path, problem, mend));
        };
        let of_cask = root.get_ref().get("cask").and_then(|cask| cask.get_ref().as_table());
        let length_m = of_cask.and_then(|cask| cask.get("length_m")).and_then(|length| {
            let length = length.get_ref();
            let digits =
                length.as_float().map(DeFloat::as_str).or(length.as_integer().map(DeInteger::as_str));
            digits?.replace('_', "").parse::<f64>().ok()
        });
        let list = SensorList::read(&path.parent().unwrap_or(Path::new("")).join(name), length_m)?;
        // The text holds the list, and needs the file no more.
        let at = Spanned::span(key).start;
        let mut text = format!("{}# {}", &text[..at], &text[at..]);
        let _ = write!(text, "\n\n# {name}, a table a row\n");
        let from = text.len();
        text.push_str(&list.tables);
        Ok(Some(Self { text, from, list }))
    }
}

impl SensorList {
    /// Reads the list at `path`; the nearer end is told by the length of the cask.
    fn read(path: &Path, length_m: Option<f64>) -> Result<Self, IngestError> {
        let text =
            String::from_utf8(in_utf8(bytes(path, LARGEST_MIB, "the sensor list")?)).map_err(|_| {
                no_cask_file(
                    path,
                    "it is not UTF-8 text",
                    "save it as CSV UTF-8, which every spreadsheet offers",
                )
            })?;
        let text = text.trim_start_matches('\u{feff}').to_owned();
        let mut list = Self::new(path, text);
        let text = list.text.clone();
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter(&text))
            .has_headers(false)
            .flexible(true)
            .from_reader(text.as_bytes());
        let mut heads: Option<Vec<&'static Key>> = None;
        for row in reader.records() {
            let row = row.map_err(|fault| no_cask_file(path, &fault.to_string(), "save it as CSV UTF-8"))?;
            if row.iter().all(|cell| cell.trim().is_empty()) {
                continue;
            }
            let begins = row.position().map_or(0, csv::Position::byte);
            let begins = usize::try_from(begins).unwrap_or(0);
            let begins =
                begins + text[begins..].len() - text[begins..].trim_start_matches(['\r', '\n']).len();
            match &heads {
                None => heads = Some(list.heads(&row)?),
                Some(heads) => list.add(&row, begins, heads, length_m)?,
            }
        }
        let mend =
            "write the columns' names in its first line, name and source among them, and a row a channel";
        if list.tables.is_empty() {
            return Err(no_cask_file(path, "the sensor list has no row", mend));
        }
        Ok(list)
    }

    /// The keys that the columns are named like.
    fn heads(&self, row: &csv::StringRecord) -> Result<Vec<&'static Key>, IngestError> {
        let refuse = |problem: String, mend: &str| Err(of_file(&self.path, Refusal::new(problem, mend)));
        let known: Vec<&str> = CHANNEL.iter().map(|key| column(key.name)).collect();
        let all = format!("the columns are: {}", known.join(", "));
        let mut heads: Vec<&'static Key> = Vec::new();
        for head in row.iter().map(|head| head.trim().to_lowercase()) {
            let Some(key) = CHANNEL.iter().find(|key| column(key.name) == head) else {
                let hint =
                    nearest(&head, &known).map_or(String::new(), |near| format!("did you mean {near}? "));
                return refuse(
                    format!("line 1: a sensor list has no column {head:?}"),
                    &format!("{hint}{all}"),
                );
            };
            if heads.iter().any(|before| before.name == key.name) {
                return refuse(format!("line 1: two columns are named {head}"), "rename one of them");
            }
            heads.push(key);
        }
        let missing = ["name", "source"].into_iter().find(|name| heads.iter().all(|key| key.name != *name));
        missing.map_or(Ok(heads), |name| refuse(format!("line 1: there is no column {name}"), &all))
    }

    /// Adds the table of a row that begins at a byte of the text.
    fn add(
        &mut self,
        row: &csv::StringRecord,
        begins: usize,
        heads: &[&'static Key],
        length_m: Option<f64>,
    ) -> Result<(), IngestError> {
        let mut at = begins;
        let ends = self.text[begins..].find(['\r', '\n']).map_or(self.text.len(), |length| begins + length);
        if row.len() > heads.len() {
            let line = line_of(self.text.as_bytes(), begins);
            let problem = format!("line {line}: {} cells, and there are {} columns", row.len(), heads.len());
            let mend = "put quotes around a cell that holds a separator";
            return Err(of_file(&self.path, Refusal::new(problem, mend)));
        }
        let cells: Vec<(&Key, &str)> = heads.iter().copied().zip(row.iter().map(str::trim)).collect();
        let cell =
            |name: &str| cells.iter().find(|(key, cell)| key.name == name && !cell.is_empty()).map(|of| of.1);
        let place = cell("position_m").and_then(|place| place.replace(',', ".").parse::<f64>().ok());
        let end = match (cell("end"), cell("position_m"), place.zip(length_m)) {
            (Some(stated), ..) => Some(stated),
            (None, None, _) => Some("none"),
            // Half-way there is no nearer end.
            (None, _, Some((place, length_m))) if place - length_m / 2.0 == 0.0 => None,
            (None, _, Some((place, length_m))) if place > length_m / 2.0 => Some("second"),
            (None, ..) => Some("first"),
        };
        self.push("[[channel]]", begins..ends, "");
        if let Some(end) = end.filter(|_| cell("end").is_none()) {
            self.push(&format!("end = \"{end}\""), begins..ends, "end");
        }
        // Along the axis it reads wherever around the skin it sits.
        let is_axial = ["around_deg", "axis"].iter().all(|name| cell(name).is_none());
        for (key, cell) in cells.iter().copied() {
            let found = self.text[at..ends].find(cell).map(|found| at + found);
            let span = found.map_or(begins..ends, |from| from..from + cell.len());
            at = found.map_or(at, |from| from + cell.len());
            let is_left_out = end == Some("none") && OF_PLACE.contains(&key.name);
            if key.name == "direction" && cell == "axial" && is_axial && !is_left_out {
                self.push("axis = \"axial\"", span, "direction");
            } else if !cell.is_empty() && !is_left_out {
                self.push(&format!("{} = {}", key.name, value(key, cell)), span, column(key.name));
            }
        }
        self.tables.push('\n');
        Ok(())
    }
}

/// What a list calls a key.
fn column(key: &'static str) -> &'static str {
    if key == PLANE[1] { PLANE[0] } else { key }
}

/// What separates the cells of a table for spreadsheets: what its first line has most of.
pub fn delimiter(text: &str) -> u8 {
    let first = text.lines().next().unwrap_or_default();
    let count = |delimiter: &u8| first.bytes().filter(|byte| byte == delimiter).count();
    [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',')
}
