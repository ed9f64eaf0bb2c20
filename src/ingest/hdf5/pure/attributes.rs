//! Attributes as they stand in the file to what they hold.

use super::super::answer::{AttributeValue, Bytes};
use super::super::names;
use super::super::tree::{MOST_BYTES, MOST_VALUES, TEXT_BYTES, joined};
use super::super::types::{ValueKind, ValueType, of_message};
use super::words::{beyond, words};
use hdf5_reader::messages::dataspace::DataspaceType;
use hdf5_reader::{Hdf5File, RawAttribute};

/// Those that may say something of samples.
pub(super) fn held(
    file: &Hdf5File,
    raw: &[RawAttribute],
) -> Result<Vec<(String, AttributeValue)>, Vec<Bytes>> {
    let mut held = Vec::new();
    let names = names::likeliest(raw.iter().map(|attribute| attribute.name().to_owned()).collect());
    for attribute in raw.iter().filter(|attribute| names.iter().any(|name| name == attribute.name())) {
        let (message, space) = (attribute.message(), &attribute.message().dataspace);
        let count = match space.dataspace_type {
            DataspaceType::Null => 0,
            DataspaceType::Scalar => 1,
            DataspaceType::Simple => space.dims.iter().fold(1, |all: u64, size| all.saturating_mul(*size)),
        };
        let value = value(file, attribute.raw_datatype(), &message.raw_data, count);
        let is_read = names::is_read(attribute.name());
        if let Some(value) = if is_read { value? } else { value.unwrap_or_default() } {
            held.push((message.name.clone(), value));
        }
    }
    held.sort_by(|one, other| one.0.cmp(&other.0));
    Ok(held)
}

/// The type that a message states.
pub(super) fn type_of(message: &[u8]) -> Result<ValueType, Vec<Bytes>> {
    let dtype = of_message::of(message).ok_or_else(|| beyond("values of an unknown type"))?;
    if matches!(dtype.kind, ValueKind::OddNumber) {
        return Err(beyond(&format!("numbers of an unusual kind, {} bytes each", dtype.bytes)));
    }
    Ok(dtype)
}

/// What `count` values of the type that `message` states are; `None` where that is too much.
pub(super) fn value(
    file: &Hdf5File,
    message: &[u8],
    values: &[u8],
    count: u64,
) -> Result<Option<AttributeValue>, Vec<Bytes>> {
    let dtype = type_of(message)?;
    let Some(count) = usize::try_from(count).ok().filter(|count| *count <= MOST_VALUES) else {
        return Ok(None);
    };
    if dtype.bytes.saturating_mul(count) > MOST_BYTES {
        return Ok(None);
    }
    // A text of varying length: its length, the address of a heap and its number in it.
    let bytes = if matches!(dtype.kind, ValueKind::VaryingText) { 16 } else { dtype.bytes };
    let short = || vec![b"an attribute has fewer values than it states".to_vec()];
    let each = || values.chunks_exact(bytes.max(1)).take(count);
    if each().len() < count {
        return Err(short());
    }
    Ok(Some(match dtype.kind {
        ValueKind::VaryingText => {
            let root = file.root_group().map_err(words)?;
            let texts =
                each().map(|place| root.resolve_vlen_reference_bytes(place, 1).map(|text| cut(&text)));
            AttributeValue::Texts(joined(texts.collect::<Result<_, _>>().map_err(words)?))
        }
        ValueKind::Text => {
            let is_padded = message.get(1).is_some_and(|flags| flags & 15 == 2);
            let texts = each().map(|text| if is_padded { cut(text.trim_ascii_end()) } else { cut(text) });
            AttributeValue::Texts(joined(texts.collect()))
        }
        _ => {
            // Named values are numbers, of the type that stands behind their size.
            let named = matches!(dtype.kind, ValueKind::Named).then(|| type_of(&message[8..])).transpose()?;
            named.as_ref().unwrap_or(&dtype).to_number().map_or(AttributeValue::Other, |number| {
                AttributeValue::Numbers(joined(each().map(number).collect()))
            })
        }
    }))
}

/// Up to the first zero, no longer than any text that is read.
fn cut(text: &[u8]) -> Bytes {
    text.iter().take_while(|byte| **byte != 0).take(TEXT_BYTES).copied().collect()
}
