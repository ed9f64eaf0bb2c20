//! A cask file (TOML) to a checked [`CaskFile`], or to one diagnostic that shows the line.

mod blanks;
mod body;
mod cells;
pub(crate) mod channel;
pub(super) mod fault;
mod house;
mod list;
mod overrides;
mod range;
mod record;
pub(crate) mod section;
mod settings;
mod simulation;
mod texts;
pub(super) mod tolerance;
mod wording;

use super::error::{IngestError, of_file};
use super::lines::in_utf8;
use super::recording_file::bytes_of;
use super::refusal::Refusal;
use super::shown::os_text;
use crate::data::keys::TABLES;
use crate::data::{CaskFile, Contact, Drop, FilterChoice};
pub(crate) use body::{cask, drop};
use cells::ExpandedCaskFile;
pub use fault::WrongLine;
pub use list::delimiter;
pub use overrides::{key_of_column, with_columns};
pub use section::with_ascii_minus;
use section::{CASK_FILE, Document, Kind, Section};
pub use settings::settings;
use sha2::{Digest, Sha256};
use std::path::Path;

/// What the laboratory calls the error of a scene file, which is read as a cask file is.
#[cfg(feature = "lab")]
pub(crate) type CaskFileError = IngestError;

/// A larger file is no cask file: a thousand channels take 300 kB.
const LARGEST_MIB: u64 = 16;

/// Reads and checks the cask file at `path`; channels may be missing altogether, as `predict` needs none. Of
/// its photographs only the beginnings are looked at: [`with_photos`] reads them.
///
/// # Errors
/// [`IngestError`], one message that shows the line.
pub fn parse(path: &Path) -> Result<CaskFile, IngestError> {
    of_bytes(path, &read(path, &CASK_FILE)?, Some(path.parent().unwrap_or(Path::new(""))))
}

/// The cask file with its photographs and its logo, for a page.
///
/// # Errors
/// [`IngestError`] where one is no longer as it was.
pub fn with_photos(mut file: CaskFile) -> Result<CaskFile, IngestError> {
    let folder = file.path.parent().unwrap_or(Path::new("")).to_owned();
    // One whose kind is not known was never looked for.
    let pictures = file.test.photos.iter_mut().chain(&mut file.letterhead.logo);
    for photo in pictures.filter(|photo| !photo.media_type.is_empty()) {
        let path = folder.join(&photo.name);
        photo.bytes = bytes(&path, record::LARGEST_PHOTO_MIB, "the photograph")?.into();
    }
    Ok(file)
}

/// The cask file of which this is the text, such as a result holds it; `path` is what it was called. Its
/// photographs are not looked for.
///
/// # Errors
/// [`IngestError`], one message that shows the line.
pub fn of_text(path: &Path, text: &str) -> Result<CaskFile, IngestError> {
    of_bytes(path, text.as_bytes(), None)
}

fn of_bytes(path: &Path, bytes: &[u8], photos: Option<&Path>) -> Result<CaskFile, IngestError> {
    let own = text(path, bytes, &CASK_FILE)?;
    let mut cask_file = checked(path, own, photos)?;
    let whole = house::text_with_house(path, own, &cask_file.cask, photos)?;
    if let Some(whole) = &whole {
        cask_file = checked(path, whole, photos)?;
    }
    // With house file and sensor list it is the text with theirs: what a result is made again from.
    let whole = whole.as_ref().map_or(bytes, String::as_bytes);
    let whole = if cask_file.text.is_empty() { whole } else { cask_file.text.as_bytes() };
    let sha256 = super::unchanged::hexadecimal(&Sha256::digest(whole));
    let text = String::from_utf8_lossy(whole).into_owned();
    Ok(CaskFile { sha256, text, ..cask_file })
}

/// Whether the file has any channel, as `analyze` needs.
///
/// # Errors
/// [`IngestError`] that says how to get channels.
pub fn require_channels(cask_file: &CaskFile, recording: &Path) -> Result<(), IngestError> {
    if !cask_file.channels.is_empty() {
        return Ok(());
    }
    let problem = "the cask file has no [[channel]] of an accelerometer, with end = \"first\" or \"second\", \
                   so that none can be found in the recording";
    let mend = format!(
        "`dropcheck init {}` writes one [[channel]] table for each source in the recording: copy those of \
         the accelerometers",
        recording.display()
    );
    Err(no_cask_file(&cask_file.path, problem, &mend))
}

/// The refusal of a file that is no such file.
pub(crate) fn no_cask_file(path: &Path, problem: &str, mend: &str) -> IngestError {
    of_file(path, Refusal::new(problem, mend))
}

/// The text of a file of this kind, not yet checked to be UTF-8.
pub(crate) fn read(path: &Path, kind: &Kind) -> Result<Vec<u8>, IngestError> {
    bytes(path, LARGEST_MIB, kind.name).map(in_utf8)
}

fn bytes(path: &Path, most_mib: u64, name: &str) -> Result<Vec<u8>, IngestError> {
    bytes_of(path, most_mib).map_err(|refusal| {
        let problem = format!("{name} cannot be read: {}", os_text(&refusal));
        no_cask_file(path, &problem, "check the name, and that you may read it")
    })
}

/// The text, without a byte-order mark.
pub(crate) fn text<'a>(path: &Path, bytes: &'a [u8], kind: &Kind) -> Result<&'a str, IngestError> {
    if bytes.starts_with(b"\x89HDF") || bytes.starts_with(b"\x89MCAP") {
        let problem = format!("this is a recording, not {}", kind.name);
        let mend = "name the TOML file here; a recording comes first, its cask file after --cask";
        return Err(no_cask_file(path, &problem, mend));
    }
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = wording::line_of(bytes, error.valid_up_to());
        no_cask_file(
            path,
            &format!("line {line} is not UTF-8 text"),
            "save it as UTF-8 (in most editors: \"Save with encoding\"), or write the letter without its \
             accent",
        )
    })?;
    if text.trim().is_empty() {
        let mend = "write [cask] with mass_kg and length_m, and [drop] with height_m and angle_deg; \
                    `dropcheck init RECORDING` writes a cask file to fill in";
        return Err(no_cask_file(path, &format!("{} is empty", kind.name), mend));
    }
    Ok(text)
}

/// The checked file of this text, which it holds only where a sensor list adds tables; its photographs are
/// looked for in the folder `photos`, if any.
pub(super) fn checked(path: &Path, text: &str, photos: Option<&Path>) -> Result<CaskFile, IngestError> {
    let expanded = ExpandedCaskFile::read(path, text)?;
    let document = Document::with_list(&CASK_FILE, path, text, expanded.as_ref());
    let root = document.root()?;
    blanks::require_no_blanks(&root)?;
    let cask_table = root.required_table("cask")?;
    cask_table.required_number("height_m")?;
    let cask = cask(&cask_table, path)?;
    let scale = cask_table.given("scale")?;
    let contact_table = root.table("contact")?;
    let contact_duration_s = contact_table.given("duration_s")?;
    let lasts_s = contact_duration_s.unwrap_or(0.0);
    let drop = Drop { contact_duration_s: lasts_s, ..drop(&root.required_table("drop")?, &cask)? };
    let contact = contact(&contact_table)?;
    let filter = filter(&root.table("filter")?)?;
    let mut defaults = assumed(&root, &["cask", "drop", "contact", "tolerance"]);
    let tolerances = tolerance::tolerances(&root.table("tolerance")?, &cask, &defaults)?;
    let corrections = tolerance::corrections(&root.table("corrections")?)?;
    let of_recording = root.table("recording")?;
    let time = of_recording.text("time")?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let rest = of_recording.text("rest")?.map(|rest| folder.join(rest));
    let (channels, others) = channel::channels(&root, &cask)?;
    let test = record::test(&root.table("test")?, photos)?;
    let observed = record::observed(&root.table("observed")?)?;
    let limits = record::limits(&root.table("limits")?)?;
    let simulation = simulation::simulation(&root, folder, &channels)?;
    let letterhead = record::letterhead(&root.table("report")?, photos)?;
    if filter == FilterChoice::Auto {
        defaults.push("filter".into());
    }
    let text = expanded.as_ref().map_or_else(String::new, |expanded| expanded.text.clone());
    Ok(CaskFile {
        path: path.to_owned(),
        text,
        scale,
        contact_duration_s,
        filter,
        tolerances,
        corrections,
        time,
        rest,
        channels,
        others,
        test,
        observed,
        limits,
        simulation,
        letterhead,
        defaults,
        ..CaskFile::new(cask, drop, contact)
    })
}

/// The keys of these tables that the file leaves out and whose defaults enter the result.
pub(crate) fn assumed(root: &Section, tables: &[&str]) -> Vec<String> {
    let rows = TABLES.iter().filter(|table| tables.contains(&table.name));
    let keys = rows.flat_map(|table| table.keys.iter().map(move |key| (table.name, key)));
    let is_left_out = |table: &str, key: &str| {
        let table = root.value(table).and_then(|table| table.get_ref().as_table());
        table.is_none_or(|table| !table.contains_key(key))
    };
    keys.filter(|(table, key)| key.is_assumed() && is_left_out(table, key.name))
        .map(|(table, key)| format!("{table}.{}", key.name))
        .collect()
}

/// `[contact]`.
pub(crate) fn contact(table: &Section) -> Result<Contact, IngestError> {
    const MEND: &str = "friction = \"rough\" (no sliding), \"smooth\" (no friction), \"unknown\", or a \
                        coefficient such as 0.4";
    let Some(value) = table.value("friction") else { return Ok(Contact::Unknown) };
    if value.get_ref().is_str() {
        let words = [("rough", Contact::Rough), ("smooth", Contact::Smooth), ("unknown", Contact::Unknown)];
        return Ok(table.word("friction", &words, MEND)?.unwrap_or(Contact::Unknown));
    }
    let coefficient = table.required_number("friction")?;
    if coefficient < 0.0 {
        let message = format!("a coefficient of friction of {coefficient} cannot be");
        return Err(table.refuse("friction", message, MEND));
    }
    Ok(Contact::Coulomb(coefficient))
}

fn filter(table: &Section) -> Result<FilterChoice, IngestError> {
    const MEND: &str = "keep cfc (a class of SAE J211 / ISO 6487) or cutoff_hz (a −3 dB cut-off) and delete \
                        the other line";
    match (table.given("cfc")?, table.given("cutoff_hz")?) {
        (Some(_), Some(_)) => Err(table.refuse("cutoff_hz", "[filter] gives both cfc and cutoff_hz", MEND)),
        (Some(class), None) => Ok(FilterChoice::Cfc(class)),
        (None, Some(cutoff_hz)) => Ok(FilterChoice::CutoffHz(cutoff_hz)),
        (None, None) => Ok(FilterChoice::Auto),
    }
}

#[cfg(test)]
mod tests;
