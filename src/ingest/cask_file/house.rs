//! A cask file that names the file of its house to one that states what the house file does.

use super::section::{Document, HOUSE, HOUSE_FILE, with_ascii_minus};
use super::{no_cask_file, read, record, text, tolerance};
use crate::data::Cask;
use crate::ingest::IngestError;
use std::path::Path;
use toml::Spanned;
use toml::de::DeTable;
use toml_edit::DocumentMut;

/// The text of the sound cask file at `path` with what its house file states and it does not; `None` where it
/// names none.
pub(super) fn text_with_house(
    path: &Path,
    own: &str,
    cask: &Cask,
    photos: Option<&Path>,
) -> Result<Option<String>, IngestError> {
    let own = with_ascii_minus(own);
    let Ok(root) = DeTable::parse(&own) else { return Ok(None) };
    let Some((key, named)) = root.get_ref().get_key_value(HOUSE) else { return Ok(None) };
    let mend = "write house = \"house.toml\", the path of the house file from the folder of the cask file";
    let name = named.get_ref().as_str();
    let name = name.ok_or_else(|| no_cask_file(path, "house is not the path of a file", mend))?;
    // The text holds what it states, and needs the file no more.
    let at = Spanned::span(key).start;
    let Ok(mut document) = format!("{}# {}", &own[..at], &own[at..]).parse::<DocumentMut>() else {
        return Ok(None);
    };
    let house_path = path.parent().unwrap_or(Path::new("")).join(name);
    let bytes = read(&house_path, &HOUSE_FILE)?;
    let house = text(&house_path, &bytes, &HOUSE_FILE)?;
    // Its own lines are named where a value in it is wrong.
    let sections = Document::new(&HOUSE_FILE, &house_path, house);
    let root = sections.root()?;
    tolerance::tolerances(&root.table("tolerance")?, cask, &[])?;
    record::letterhead(&root.table("report")?, photos)?;
    let house: DocumentMut = with_ascii_minus(house).parse().unwrap_or_default();
    for (table, stated) in house.iter().filter_map(|(name, table)| Some((name, table.as_table_like()?))) {
        let place = document.entry(table).or_insert_with(toml_edit::table).as_table_like_mut();
        let Some(place) = place else { continue };
        let lacking = stated.iter().filter(|(key, _)| !place.contains_key(key));
        let lacking: Vec<_> = lacking.map(|(key, value)| (key.to_owned(), value.clone())).collect();
        for (key, value) in lacking {
            place.insert(&key, value);
        }
    }
    Ok(Some(document.to_string()))
}

#[cfg(test)]
mod tests {
    use super::super::{of_text, parse};
    use crate::data::CaskFile;

    const CASK: &str = "house = \"../house.toml\" # ours\n[cask]\nmass_kg = 10\nlength_m = 2.0\nheight_m = \
                        0.4\n[drop]\nheight_m = 1\nangle_deg = 5\n[tolerance]\nangle_deg = 0.2\n";

    fn with(house: Option<&str>, cask: &str) -> Result<CaskFile, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("a")).unwrap();
        if let Some(house) = house {
            std::fs::write(folder.path().join("house.toml"), house).unwrap();
        }
        let path = folder.path().join("a/cask.toml");
        std::fs::write(&path, cask).unwrap();
        parse(&path).map_err(|error| format!("{error} {}", miette::Diagnostic::help(&error).unwrap()))
    }

    #[test]
    fn a_cask_file_takes_what_it_does_not_state_from_its_house_file() {
        let house = "[tolerance]\nangle_deg = 1.0\nlength_m = 0.03\n[report]\nheader = \"Hall 3\"\n";
        let file = with(Some(house), CASK).unwrap();
        assert!((file.tolerances.angle_rad.to_degrees() - 0.2).abs() < 1e-12);
        assert!((file.tolerances.length - 0.015).abs() < 1e-12);
        assert_eq!(file.letterhead.header.as_deref(), Some("Hall 3"));
        assert!(!file.defaults.iter().any(|key| key == "tolerance.length_m"));
        let again = of_text(&file.path, &file.text).unwrap();
        assert_eq!((again.sha256, again.tolerances), (file.sha256.clone(), file.tolerances));
        let other = with(Some("[tolerance]\nlength_m = 0.04\n"), CASK).unwrap();
        assert_ne!(other.sha256, file.sha256);
    }

    #[test]
    fn a_house_file_that_is_missing_or_states_more_is_refused_in_one_sentence() {
        for (house, cask, parts) in [
            (None, CASK.to_owned(), &["the house file cannot be read", "house.toml"][..]),
            (
                Some("[drop]\nheight_m = 9\n"),
                CASK.to_owned(),
                &["house.toml, line 1", "knows no table drop", "tolerance, report"],
            ),
            (
                Some("[tolerance]\nangle_deg = -1\n"),
                CASK.to_owned(),
                &["house.toml, line 2", "angle_deg is -1"],
            ),
            (Some(""), CASK.to_owned(), &["the house file is empty"]),
            (
                None,
                CASK.replace("\"../house.toml\"", "3"),
                &["house is not the path of a file", "house.toml"],
            ),
        ] {
            let refused = with(house, &cask).unwrap_err();
            assert!(parts.iter().all(|part| refused.contains(part)), "{refused}");
        }
    }
}
