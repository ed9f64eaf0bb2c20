//! `[test]` and `[observed]` to what stands in the head of a report, and to what is held against the result.

use super::CaskFileError;
use super::section::{Placed, Section};
use crate::data::keys::OBSERVED;
use crate::data::{Observed, Photo, TestRecord};
use std::io::Read;
use std::path::Path;

/// A larger photograph is refused: 2000 by 1500 pixels take a tenth of it as JPEG.
const LARGEST_PHOTO_BYTES: u64 = 8 << 20;

/// How the files begin that a page can show.
const IMAGES: [(&[u8], &str); 2] = [(b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg")];

/// `[test]`; its photographs are looked for in `folder`, and known by name alone where there is none.
pub(super) fn test(table: &Section, folder: Option<&Path>) -> Result<TestRecord, CaskFileError> {
    let text = |key: &str| table.text(key).map(|text| text.map(|text| text.value));
    let photos = table.texts("photos")?;
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
        photos: photos.into_iter().map(|name| photo(table, name, folder)).collect::<Result<_, _>>()?,
        signatures: table.texts("signatures")?.into_iter().map(|who| who.value).collect(),
        more: table.table("more")?.own_names()?,
    })
}

fn photo(table: &Section, name: Placed<String>, folder: Option<&Path>) -> Result<Photo, CaskFileError> {
    let Placed { value: name, span } = name;
    let Some(folder) = folder else { return Ok(Photo { name, media_type: "", bytes: [].into() }) };
    let wrong = |what: String, mend: &str| table.wrong(span.clone(), what, "PNG or JPEG".into(), mend);
    let mut bytes = Vec::new();
    let path = folder.join(&name);
    std::fs::metadata(&path)
        .and_then(|of| if of.is_file() { Ok(()) } else { Err(std::io::Error::other("it is no file")) })
        .and_then(|()| std::fs::File::open(&path)?.take(LARGEST_PHOTO_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|refusal| {
            let mend = "photographs stand in the folder of the cask file, by the names of their files";
            wrong(format!("{name} cannot be read: {refusal}"), mend)
        })?;
    let image = IMAGES.into_iter().find(|(begin, _)| bytes.starts_with(begin));
    let Some((_, media_type)) = image else {
        return Err(wrong(format!("{name} is neither PNG nor JPEG"), "save it as PNG or JPEG"));
    };
    if bytes.len() as u64 > LARGEST_PHOTO_BYTES {
        let most = LARGEST_PHOTO_BYTES >> 20;
        return Err(wrong(
            format!("{name} has more than {most} MiB, and the report holds it whole"),
            "make it smaller: 2000 by 1500 pixels are enough for a page",
        ));
    }
    Ok(Photo { name, media_type, bytes: bytes.into() })
}

/// `[observed]`, in the order of its keys.
pub(super) fn observed(table: &Section) -> Result<Vec<Observed>, CaskFileError> {
    let of = |key: &'static str| {
        table.value(key)?;
        let of = || {
            let seen = table.table_as(key, "observation")?;
            let number = |part| seen.required_number(part).map(|number| number.value);
            let by = seen.text("by")?.map(|by| by.value);
            Ok(Observed { name: key, value: number("value")?, u95: number("u95")?, by })
        };
        Some(of())
    };
    OBSERVED.iter().filter_map(|key| of(key.name)).collect()
}
