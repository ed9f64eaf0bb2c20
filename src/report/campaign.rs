//! Collects lines of results as a campaign: its table, CSV, JSON and page; a recording that failed is a row
//! with its reason.

mod columns;
mod drop_curves;
mod files;
mod page;
mod pictures;
mod series;
mod summary;

pub use columns::{CampaignColumn, campaign_columns};
pub use drop_curves::drop_curves;
pub use files::CampaignFiles;
pub use series::PredictedCurve;

use super::text::dedup;
use crate::data::keys::{CHANNEL, TABLES, Takes};
use crate::data::shown::show;
use crate::data::{Comparison, Estimate, Verdict};
use columns::{Columns, NamedQuantity};
use drop_curves::DropCurves;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};

/// Most rows on a page: a program must read more.
const MOST_ROWS: usize = 2000;
/// Most casks with a chapter and pictures on a page; `campaign.json` pools all.
const MOST_SERIES: usize = 100;

/// One recording of a campaign.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct BatchRow {
    /// Name of the recording in the campaign.
    pub id: String,
    /// The recording, as given.
    pub recording: String,
    /// Cask file, as given.
    pub cask: Option<String>,
    /// Report under `--out`.
    pub report: Option<String>,
    /// The exit status that `analyze` would have.
    pub exit: u8,
    /// The verdict; `None` if the recording could not be analysed.
    pub verdict: Option<Verdict>,
    /// Slap-down speed, m/s.
    pub slap_down_speed: Option<Estimate>,
    /// Coefficient of restitution.
    pub k: Option<Estimate>,
    /// The limits that are exceeded, by their keys.
    pub exceeded: Vec<String>,
    /// The selected model.
    pub model: Option<String>,
    /// Measured beside predicted.
    pub comparison: Option<Comparison>,
    /// Warnings and errors among the findings.
    pub findings: usize,
    /// Codes, each once: first those that removed k or the slap-down speed, then errors, then warnings.
    pub codes: Vec<String>,
    /// Codes of the notes.
    pub note_codes: Vec<String>,
    /// Why it could not be analysed.
    pub error: Option<String>,
    /// An earlier row of the same recording, which counts once among the repeats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub same_recording_as: Option<String>,
    /// Position in the pictures.
    #[serde(skip)]
    pub(crate) at: DropPoint,
    /// Drop with all quantities and curves, for as many rows as fit on a page.
    #[serde(skip)]
    quantities: Vec<NamedQuantity>,
    #[serde(skip)]
    curves: Option<DropCurves>,
    /// The manifest's own columns.
    #[serde(skip)]
    carried: Columns,
}

/// Names that Windows reserves for devices, with any extension.
const DEVICES: &str = "CON PRN AUX NUL COM1 COM2 COM3 COM4 COM5 COM6 COM7 COM8 COM9 LPT1 LPT2 LPT3 LPT4 LPT5 \
                       LPT6 LPT7 LPT8 LPT9";

/// Turns the name of a test into the name of a folder that stays inside its parent.
pub fn folder_name(test: &str) -> String {
    let is_plain = |c: char| !c.is_control() && !"/\\:*?\"<>|".contains(c);
    let plain: String = test.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
    // "..." would leave the folder, and ".x" is hidden.
    let plain = plain.trim_matches(['.', ' ']);
    let device = plain.split('.').next().unwrap_or_default().trim_end();
    if plain.is_empty() {
        "recording".to_owned()
    } else if DEVICES.split(' ').any(|name| device.eq_ignore_ascii_case(name)) {
        format!("_{plain}")
    } else {
        plain.to_owned()
    }
}

/// The first number among a line's settings that no cask file may state, with its path: such a line is not
/// from this program.
pub fn impossible(line: &Value) -> Option<String> {
    for (name, stated) in line["settings"].as_object().into_iter().flatten() {
        let channels = stated.as_array().map_or(std::slice::from_ref(stated), Vec::as_slice);
        let keys = TABLES.iter().find(|table| *name == table.name).map_or(&CHANNEL[..], |table| table.keys);
        for (stated, key) in channels.iter().flat_map(|stated| keys.iter().map(move |key| (stated, key))) {
            let number = stated[key.name]["value"].as_f64();
            if let (Takes::Number(allowed), Some(number)) = (key.takes, number)
                && !allowed.holds(number)
            {
                let (key, number) = (key.name, show(number));
                return Some(format!("settings.{name}.{key} is {number}, which no cask file may state"));
            }
        }
    }
    None
}

/// Values of a drop for pictures and pools.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct DropPoint {
    /// Number in the campaign, from 1.
    pub(crate) number: u32,
    /// Name of the cask, with all statements on it and its fall except the angle.
    pub(crate) cask: String,
    pub(crate) series: String,
    pub(crate) angle_deg: Option<f64>,
    /// Half-width of the stated angle, degrees.
    pub(crate) angle_u95_deg: f64,
    /// Date of the test, as in RFC 3339.
    pub(crate) date: Option<String>,
    /// Largest deceleration of the struck end, m/s², and energy absorbed, J, of both impacts.
    pub(crate) peaks_m_s2: [Option<f64>; 2],
    pub(crate) energies_j: [Option<f64>; 2],
}

/// A part of a line; `None` if it is missing or has another form.
fn part<T: DeserializeOwned>(line: &Value, place: &str) -> Option<T> {
    T::deserialize(line.pointer(place)?).ok()
}

impl BatchRow {
    /// The reason why it was not analysed, or the exceeded limits and the findings.
    fn reason(&self) -> String {
        let exceeded = self.exceeded.iter().map(|key| format!("exceeds its limit of {key}"));
        let found = exceeded.chain(self.codes.iter().cloned());
        self.error.clone().unwrap_or_else(|| found.collect::<Vec<_>>().join(", "))
    }

    /// Reads the row of a line.
    pub fn from_line(line: &Value) -> Self {
        let verdict: Option<Verdict> = part(line, "/verdict");
        // A path outside the campaign's folder would make a link to elsewhere in its page.
        let folder = part(line, "/campaign/report").filter(|folder: &String| folder_name(folder) == *folder);
        let codes = |severity| {
            let all = line["quality"].as_array().into_iter().flatten();
            all.filter(move |found| found["severity"] == severity).filter_map(|found| found["code"].as_str())
        };
        let limits = line["limits"].as_array().into_iter().flatten();
        let exceeded = limits.filter(|limit| limit["state"] == "exceeded");
        let exceeded: Vec<String> = exceeded.filter_map(|limit| part(limit, "/name")).collect();
        let missing = line["missing"].as_array().into_iter().flatten();
        let missing = missing.filter(|m| m["quantity"] == "k" || m["quantity"] == "slap_down.speed");
        let took = missing.filter_map(|m| line["quality"].get(usize::try_from(m["because"].as_u64()?).ok()?));
        let took = took.filter_map(|found| found["code"].as_str());
        let grave: Vec<&str> = codes("error").chain(codes("warning")).collect();
        Self {
            id: part(line, "/id").unwrap_or_default(),
            recording: part(line, "/campaign/recording").unwrap_or_default(),
            cask: part(line, "/campaign/cask"),
            report: verdict.and(folder).map(|folder| format!("{folder}/report.html")),
            exit: verdict.map_or(2, |it| u8::from(it != Verdict::Pass || !exceeded.is_empty())),
            verdict,
            slap_down_speed: part(line, "/slap_down/speed"),
            k: part(line, "/k"),
            exceeded,
            model: part(line, "/model/name"),
            comparison: part(line, "/comparison"),
            findings: grave.len(),
            codes: dedup(took.chain(grave)).into_iter().map(str::to_owned).collect(),
            note_codes: dedup(codes("note")).into_iter().map(str::to_owned).collect(),
            error: part(line, "/error"),
            same_recording_as: None,
            at: DropPoint::from_line(line),
            quantities: columns::quantities(line),
            curves: part(line, "/curves"),
            carried: columns::extras(line).map(|(name, value)| (name.clone(), value.clone())).collect(),
        }
    }
}

impl DropPoint {
    fn from_line(line: &Value) -> Self {
        let stated = |table: &str| line["settings"][table].as_object().into_iter().flatten();
        let of_drop = stated("drop").filter(|(key, _)| *key != "angle_deg");
        let series = stated("cask").chain(of_drop).map(|(_, entry)| entry["value"].clone());
        let of_impacts = |quantity: &str| {
            let of_impact = |i| part(line, &format!("/impacts/{i}/{quantity}")).map(|e: Estimate| e.value);
            [0, 1].map(of_impact)
        };
        Self {
            number: part(line, "/campaign/number").map_or(1, |index: u32| index.saturating_add(1)),
            cask: part(line, "/settings/cask/name/value").unwrap_or_default(),
            series: series.collect::<Value>().to_string(),
            angle_deg: part(line, "/settings/drop/angle_deg/value"),
            angle_u95_deg: part(line, "/settings/tolerance/angle_deg/value").unwrap_or_default(),
            date: part(line, "/settings/test/date/value"),
            peaks_m_s2: of_impacts("rigid_body_deceleration/at_struck_end"),
            energies_j: of_impacts("energy_absorbed"),
        }
    }
}

/// A campaign.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Batch {
    /// The manifest or the cask file.
    pub source: String,
    /// Rows of the recordings, in the order given.
    pub rows: Vec<BatchRow>,
    /// Columns that the manifest adds to the tables.
    carried: BTreeSet<String>,
    /// The first row of each recording, by its hash.
    recordings: HashMap<String, String>,
}

impl Batch {
    /// An empty campaign with this manifest or cask file.
    pub fn new(source: String) -> Self {
        Self { source, ..Self::default() }
    }

    /// Adds a line: a result, or the reason why there is none.
    pub fn add(&mut self, line: &Value) {
        let mut row = BatchRow::from_line(line);
        if self.rows.len() >= MOST_ROWS {
            (row.quantities, row.curves) = (Vec::new(), None);
        }
        if let Some(hash) = part::<String>(line, "/input/recording_sha256") {
            let first = self.recordings.entry(hash).or_insert_with(|| row.id.clone());
            row.same_recording_as = Some(first.clone()).filter(|first| *first != row.id);
        }
        self.carried.extend(row.carried.keys().cloned());
        self.rows.push(row);
    }

    /// True if a recording has a name in the manifest other than that of its file.
    fn has_ids(&self) -> bool {
        self.rows.iter().any(|row| !row.recording.contains(&row.id))
    }

    /// True if a file with this beginning is a `campaign.csv` of this program.
    pub fn begins(head_of_file: &[u8]) -> bool {
        let first = columns::names().take(10).collect::<Vec<_>>().join(",");
        head_of_file.starts_with(first.as_bytes())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::sample;
    use super::super::text::WIDTH;
    use super::*;
    use serde_json::json;

    /// Lines of the sample and of a recording that failed.
    pub(super) fn lines() -> Vec<Value> {
        let mut sound = serde_json::to_value(sample::analysis().result).unwrap();
        sound["id"] = json!("a");
        sound["campaign"] =
            json!({"number": 0, "recording": "a.mcap", "report": "a", "carried": {"hall": "=3", "no": "-3"}});
        let failed = json!({"id": "b", "exit": 2, "error": "b.mcap is empty; record it again",
            "campaign": {"number": 1, "recording": "=b.mcap", "report": "b"}});
        vec![sound, failed]
    }

    pub(super) fn campaign(lines: &[Value]) -> Batch {
        let mut campaign = Batch::new("runs.csv".into());
        for line in lines {
            campaign.add(line);
        }
        campaign
    }

    fn text(lines: &[Value]) -> String {
        anstream::adapter::strip_str(&campaign(lines).table(WIDTH)).to_string()
    }

    #[test]
    fn a_failed_recording_is_a_row_with_its_reason() {
        let text = text(&lines());
        assert!(text.contains("ERROR") && text.contains("record it again"));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
    }

    #[test]
    fn the_table_shows_names_whole_and_what_was_found() {
        let mut lines = lines();
        lines[0]["campaign"]["recording"] = json!("of/a/test site/damaged-truncated.mcap");
        lines[0]["quality"] =
            json!([{"code": "gap", "severity": "warning"}, {"code": "ends_early", "severity": "error"}]);
        lines[1]["campaign"]["recording"] = json!("of/a/test site/b.mcap");
        let together = text(&lines);
        assert!(together.contains("recordings in of/a/test site\n"), "{together}");
        assert!(together.contains("\n  damaged-truncated.mcap  REVIEW"), "{together}");
        assert!(together.contains("review  damaged-truncated.mcap\n      ends_early, gap\n"), "{together}");
        lines[1]["campaign"]["recording"] = json!("b.mcap");
        assert!(!text(&lines).contains("recordings in"));
    }
}
