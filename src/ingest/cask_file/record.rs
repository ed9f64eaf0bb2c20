//! `[test]`, `[report]`, `[observed]` and `[limits]` to what stands around a report, and to what is held
//! against the result.

use super::section::Section;
use crate::data::keys::{LIMITS, OBSERVED};
use crate::data::shown::os_text;
use crate::data::{Letterhead, Limit, LimitState, Observed, Photo, TestRecord};
use crate::ingest::IngestError;
use crate::ingest::opened;
use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;

/// A larger photograph is refused: 2000 by 1500 pixels take a tenth of it as JPEG.
pub(super) const LARGEST_PHOTO_MIB: u64 = 8;
/// All photographs together: a page holds each whole, as often as it is named.
const ALL_PHOTOS_MIB: u64 = 32;

/// How the files begin that a page can show.
const IMAGES: [(&[u8], &str); 2] = [(b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg")];

/// Within so many bytes an SVG says that it is one.
const HEAD_OF_SVG: u64 = 4096;

/// `[test]`; its photographs are looked for in `folder`, and known by name alone where there is none.
pub(super) fn test(table: &Section, folder: Option<&Path>) -> Result<TestRecord, IngestError> {
    let mut left_bytes = ALL_PHOTOS_MIB << 20;
    let photos = table.texts("photos")?.into_iter().map(|name| picture(table, name, folder, &mut left_bytes));
    Ok(TestRecord {
        id: table.text("id")?,
        title: table.text("title")?,
        place: table.text("place")?,
        operator: table.text("operator")?,
        customer: table.text("customer")?,
        specimen: table.text("specimen")?,
        target: table.text("target")?,
        remarks: table.text("remarks")?,
        date: table.date("date")?,
        temperature_c: table.given("temperature_c")?,
        photos: photos.collect::<Result<_, _>>()?,
        signatures: table.texts("signatures")?,
        revisions: table.texts("revisions")?,
        more: table.table("more")?.own_names()?,
    })
}

/// `[report]`; its logo is looked for in `folder`, as the photographs.
pub(super) fn letterhead(table: &Section, folder: Option<&Path>) -> Result<Letterhead, IngestError> {
    let logo = table.text("logo")?.map(|name| picture(table, name, folder, &mut (LARGEST_PHOTO_MIB << 20)));
    Ok(Letterhead { header: table.text("header")?, footer: table.text("footer")?, logo: logo.transpose()? })
}

/// A photograph or a logo, of which only the beginning is looked at; it takes its share of `left_bytes`.
fn picture(
    table: &Section,
    name: String,
    folder: Option<&Path>,
    left_bytes: &mut u64,
) -> Result<Photo, IngestError> {
    let Some(folder) = folder else { return Ok(Photo { name, media_type: "", bytes: [].into() }) };
    let is_photo = table.row("photos").is_some();
    let (key, kinds) = if is_photo { ("photos", "PNG or JPEG") } else { ("logo", "PNG, JPEG or SVG") };
    let wrong = |what: String, mend: &str| table.refuse(key, what, mend);
    let mend = "pictures stand in the folder of the cask file, by the names of their files";
    // A cask file that was sent must not carry pictures from elsewhere into a report that goes back.
    if Path::new(&name).file_name() != Some(OsStr::new(&name)) {
        return Err(wrong(format!("{name} is not the name of a file in the folder of the cask file"), mend));
    }
    let path = folder.join(&name);
    let mut begin = Vec::new();
    let looked = std::fs::symlink_metadata(&path).and_then(|there| {
        if there.is_symlink() {
            return Err(std::io::Error::other("it is a link"));
        }
        opened(&path)?.take(HEAD_OF_SVG).read_to_end(&mut begin).map(|_| there.len())
    });
    let length =
        looked.map_err(|refusal| wrong(format!("{name} cannot be read: {}", os_text(&refusal)), mend))?;
    let is_svg = |begin: &[u8]| !is_photo && begin.windows(4).any(|word| word == b"<svg");
    let image =
        IMAGES.into_iter().find(|(kind, _)| begin.starts_with(kind)).map(|(_, media_type)| media_type);
    let Some(media_type) = image.or(is_svg(&begin).then_some("image/svg+xml")) else {
        return Err(wrong(format!("{name} is no {kinds}"), &format!("save it as {kinds}")));
    };
    for (most_mib, is_over, what) in [
        (LARGEST_PHOTO_MIB, length > LARGEST_PHOTO_MIB << 20, name.clone()),
        (ALL_PHOTOS_MIB, length > *left_bytes, format!("the list of photographs up to {name}")),
    ] {
        if is_over {
            let mend = "make it smaller: 2000 by 1500 pixels are enough for a page";
            return Err(wrong(
                format!("{what} has more than {most_mib} MiB, and the report holds it whole"),
                mend,
            ));
        }
    }
    *left_bytes -= length;
    Ok(Photo { name, media_type, bytes: [].into() })
}

/// `[observed]`, in the order of its keys.
pub(super) fn observed(table: &Section) -> Result<Vec<Observed>, IngestError> {
    let observed = |key: &'static str| {
        table.value(key)?;
        let observation = || {
            let seen = table.table_as(key, "observation")?;
            let (value, u95) = (seen.required_number("value")?, seen.required_number("u95")?);
            Ok(Observed { name: key, value, u95, by: seen.text("by")? })
        };
        Some(observation())
    };
    OBSERVED.iter().filter_map(|key| observed(key.name)).collect()
}

/// `[limits]`, in the order of its keys.
pub(super) fn limits(table: &Section) -> Result<Vec<Limit>, IngestError> {
    let limit = |name: &'static str| {
        let bounds = table.table_as(name, "limit")?;
        let (least, most) = (bounds.given("least")?, bounds.given("most")?);
        if least.or(most).is_some_and(|least| least <= most.unwrap_or(f64::INFINITY)) {
            return Ok(Limit { name, least, most, measured: None, state: LimitState::Undecided });
        }
        let message = format!("{name} has no least or most, or a least above its most");
        Err(table.refuse(name, message, &table.form(name)))
    };
    let stated = LIMITS.iter().filter(|key| table.value(key.name).is_some());
    stated.map(|key| limit(key.name)).collect()
}
