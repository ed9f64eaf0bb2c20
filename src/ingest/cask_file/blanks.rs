//! A cask file that is not filled in to one message that names every value it lacks.

use super::section::Section;
use super::texts::is_left_open;
use crate::data::keys::{INNER_TABLES, Key, REQUIRED, TABLES};
use crate::ingest::IngestError;
use toml::Spanned;

const MEND: &str = "write the number or the word in place of each nan and \"FILL IN\", and add the keys that \
                    are missing; a channel that is no accelerometer of the motion has end = \"none\", or \
                    its table is deleted";

/// Refuses a file that lacks several values. A single one is refused where it is read, with an example.
pub(super) fn require_no_blanks(root: &Section) -> Result<(), IngestError> {
    if root.value("cask").is_none() && root.value("drop").is_none() {
        return Ok(());
    }
    let (mut first, mut count, mut tables) = (None, 0, Vec::new());
    for table in TABLES.iter().filter(|table| !INNER_TABLES.contains(&table.name)) {
        let sections = match table.name {
            "channel" => root.tables(table.name)?,
            "simulation" if root.value("simulation").is_none() => vec![],
            name => vec![root.table(name)?],
        };
        for (index, section) in sections.iter().enumerate() {
            let blanks: Vec<&Key> = table.keys.iter().filter(|key| section.is_blank(key)).collect();
            let Some(key) = blanks.first() else { continue };
            first.get_or_insert(section.place(key.name));
            count += blanks.len();
            let title = match section.value("name").and_then(|name| name.get_ref().as_str()) {
                Some(name) if table.name == "channel" => format!("channel {name}:"),
                None if table.name == "channel" => format!("channel {}:", index + 1),
                _ => format!("[{}]", table.name),
            };
            let named = |key: &&Key| match section.value(key.name) {
                Some(_) => format!("{} (line {})", key.name, section.line(key.name)),
                None => format!("{} (missing)", key.name),
            };
            tables.push(format!("{title} {}", blanks.iter().map(named).collect::<Vec<_>>().join(", ")));
        }
    }
    match first {
        Some(span) if count > 1 => {
            let message = format!("{count} values are still to be filled in: {}", tables.join("; "));
            Err(root.wrong(span, message, MEND))
        }
        _ => Ok(()),
    }
}

impl Section<'_> {
    /// Whether the key holds what `init` writes in place of a value, or must be there and is not.
    fn is_blank(&self, key: &Key) -> bool {
        if let Some(value) = self.value(key.name).map(Spanned::get_ref) {
            return is_left_open(value);
        }
        let is = |key: &str, word: &str| self.value(key).and_then(|v| v.get_ref().as_str()) == Some(word);
        let is_spared = match key.name {
            "height_m" => self.value("impact_velocity_m_s").is_some(),
            "axis" => is("end", "none") || self.value("around_deg").is_some(),
            "position_m" => is("end", "none") || is("axis", "rate"),
            _ => false,
        };
        key.default.starts_with(REQUIRED) && !is_spared
    }
}
