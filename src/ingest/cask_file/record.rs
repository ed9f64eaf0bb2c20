//! `[test]` and `[observed]` to what stands in the head of a report, and to what is held against the result.

use super::CaskFileError;
use super::section::{Placed, Section};
use crate::data::keys::OBSERVED;
use crate::data::shown::bare;
use crate::data::{Observed, Photo, TestRecord};
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

/// `[test]`; its photographs are looked for in `folder`, and known by name alone where there is none.
pub(super) fn test(table: &Section, folder: Option<&Path>) -> Result<TestRecord, CaskFileError> {
    let text = |key: &str| table.text(key).map(|text| text.map(|text| text.value));
    let mut left_bytes = ALL_PHOTOS_MIB << 20;
    let photos = table.texts("photos")?.into_iter().map(|name| photo(table, name, folder, &mut left_bytes));
    Ok(TestRecord {
        id: text("id")?,
        title: text("title")?,
        place: text("place")?,
        operator: text("operator")?,
        customer: text("customer")?,
        specimen: text("specimen")?,
        target: text("target")?,
        remarks: text("remarks")?,
        date: table.date("date")?,
        temperature_c: table.number("temperature_c")?.map(|temperature| temperature.value),
        photos: photos.collect::<Result<_, _>>()?,
        signatures: table.texts("signatures")?.into_iter().map(|who| who.value).collect(),
        more: table.table("more")?.own_names()?,
    })
}

/// A photograph, of which only the beginning is looked at; it takes its share of `left_bytes`.
fn photo(
    table: &Section,
    name: Placed<String>,
    folder: Option<&Path>,
    left_bytes: &mut u64,
) -> Result<Photo, CaskFileError> {
    let Placed { value: name, span } = name;
    let Some(folder) = folder else { return Ok(Photo { name, media_type: "", bytes: [].into() }) };
    let wrong = |what: String, mend: &str| table.wrong(span.clone(), what, "PNG or JPEG".into(), mend);
    let mend = "photographs stand in the folder of the cask file, by the names of their files";
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
        opened(&path)?.take(8).read_to_end(&mut begin).map(|_| there.len())
    });
    let length =
        looked.map_err(|refusal| wrong(format!("{name} cannot be read: {}", bare(&refusal)), mend))?;
    let image = IMAGES.into_iter().find(|(kind, _)| begin.starts_with(kind));
    let Some((_, media_type)) = image else {
        return Err(wrong(format!("{name} is neither PNG nor JPEG"), "save it as PNG or JPEG"));
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
pub(super) fn observed(table: &Section) -> Result<Vec<Observed>, CaskFileError> {
    let observed = |key: &'static str| {
        table.value(key)?;
        let observation = || {
            let seen = table.table_as(key, "observation")?;
            let number = |part| seen.required_number(part).map(|number| number.value);
            let by = seen.text("by")?.map(|by| by.value);
            Ok(Observed { name: key, value: number("value")?, u95: number("u95")?, by })
        };
        Some(observation())
    };
    OBSERVED.iter().filter_map(|key| observed(key.name)).collect()
}
