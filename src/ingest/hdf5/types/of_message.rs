//! A type as it stands in the file (HDF5 file format specification, IV.A.2.d).

use super::{Order, TypeField, ValueKind, ValueType};
use crate::ingest::number_type::NumberType;
use hdf5_reader::io::Cursor;
use hdf5_reader::messages::datatype::parse_datatype_description;

/// What stands behind the size of an IEEE 754 number of single and double precision: where its parts begin
/// and how long they are, bits, and the bias of its exponent.
const IEEE: [[u8; 12]; 2] =
    [[0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0], [0, 0, 64, 0, 52, 11, 0, 52, 255, 3, 0, 0]];

/// The type that a message states; `None` where it is damaged or unknown.
pub(in crate::ingest) fn of(message: &[u8]) -> Option<ValueType> {
    let (&[class, flags, more, _, s0, s1, s2, s3], rest) = message.split_first_chunk::<8>()?;
    let bytes = usize::try_from(u32::from_le_bytes([s0, s1, s2, s3])).ok()?;
    let stated = if flags & 1 == 0 { Order::Lowest } else { Order::Highest };
    let known = |kind, order| Some(ValueType { kind, bytes, order });
    match class & 15 {
        0 => {
            let is_whole = rest.get(..2)? == [0, 0] && rest.get(2..4)? == [s0.checked_mul(8)?, 0];
            let number = NumberType::integer(bytes, flags & 8 != 0).filter(|_| is_whole);
            known(number.map_or(ValueKind::OddNumber, ValueKind::Number), stated)
        }
        1 => {
            // The highest bit of the mantissa is not stored, the sign is the last bit, no VAX order.
            let is_ieee = flags & 0x70 == 0x20 && usize::from(more) + 1 == bytes.checked_mul(8)?;
            let kind = match IEEE.iter().position(|parts| is_ieee && rest.get(..12) == Some(parts)) {
                Some(0) => ValueKind::Number(NumberType::F32),
                Some(1) => ValueKind::Number(NumberType::F64),
                _ => ValueKind::OddNumber,
            };
            known(kind, stated)
        }
        3 => known(ValueKind::Text, Order::None),
        2 | 4 => known(ValueKind::Other, stated),
        5 => known(ValueKind::Other, Order::None),
        6 => record(message, bytes, usize::from(u16::from_le_bytes([flags, more]))),
        7 => known(ValueKind::References, Order::None),
        8 => known(ValueKind::Named, of(rest)?.order),
        // Of their room in memory.
        9 if flags & 15 == 1 => {
            Some(ValueType { kind: ValueKind::VaryingText, bytes: 8, order: of(rest)?.order })
        }
        9 => Some(ValueType { kind: ValueKind::VaryingList, bytes: 16, order: of(rest)?.order }),
        10 => {
            let (&count, rest) = rest.split_first()?;
            let (dimensions, before) = (4 * usize::from(count), if class >> 4 < 3 { 3 } else { 0 });
            let sizes = rest.get(before..before + dimensions)?.chunks_exact(4);
            let count = sizes.map(|size| u32::from_le_bytes(size.try_into().unwrap_or_default()));
            let count = count.fold(1_usize, |all, size| all.saturating_mul(size as usize));
            let permutation = if class >> 4 < 3 { dimensions } else { 0 };
            let base = of(rest.get(before + dimensions + permutation..)?)?;
            let order = base.order;
            let is_told = !matches!(base.kind, ValueKind::OddNumber | ValueKind::Other);
            known(if is_told { ValueKind::List(Box::new(base), count) } else { ValueKind::Other }, order)
        }
        _ => None,
    }
}

impl ValueType {
    /// What turns the bytes that begin with a value into its number; `None` where values are none.
    pub(in crate::ingest) fn to_number(&self) -> Option<impl Fn(&[u8]) -> f64 + use<>> {
        let (number, is_big_endian) = (self.number()?, self.order == Order::Highest);
        // Named values of a damaged type may be shorter than their numbers.
        let value = move |stored: &[u8]| number.value(stored, is_big_endian);
        Some(move |stored: &[u8]| stored.get(..number.bytes()).map_or(f64::NAN, value))
    }
}

/// A record of `count` fields.
fn record(message: &[u8], bytes: usize, count: usize) -> Option<ValueType> {
    let (version, mut at, mut fields, mut order) = (message[0] >> 4, 8, Vec::new(), Order::None);
    for _ in 0..count {
        let rest = message.get(at..)?;
        let length = rest.iter().position(|byte| *byte == 0)?;
        // Names are filled up to eight bytes in the first versions; a place takes as many as it needs in the
        // later ones; the first has the sizes of a list beside it.
        let name_bytes = if version < 3 { (length + 8) / 8 * 8 } else { length + 1 };
        let place_bytes = if version < 3 { 4 } else { bytes.checked_ilog2()? as usize / 8 + 1 };
        let place = rest.get(name_bytes..name_bytes + place_bytes)?;
        let from = place.iter().rev().fold(0, |from, byte| from << 8 | usize::from(*byte));
        let (mut from_bytes, mut list) = (name_bytes + place_bytes, None);
        if version == 1 {
            let sizes = rest.get(from_bytes..from_bytes + 28)?;
            list = (sizes[0] > 0).then_some(());
            from_bytes += 28;
        }
        let inner = rest.get(from_bytes..)?;
        let mut cursor = Cursor::new(inner);
        parse_datatype_description(&mut cursor).ok()?;
        let end = usize::try_from(cursor.position()).ok()?;
        let held = of(inner.get(..end)?).filter(|_| list.is_none())?;
        order = match (order, held.order) {
            (one, Order::None) => one,
            (Order::None, other) => other,
            (one, other) if one == other => one,
            _ => Order::Mixed,
        };
        fields.push(TypeField { name: rest[..length].to_vec(), from, held });
        at += from_bytes + end;
    }
    let is_told =
        fields.iter().all(|field| !matches!(field.held.kind, ValueKind::OddNumber | ValueKind::Other));
    Some(ValueType { kind: if is_told { ValueKind::Record(fields) } else { ValueKind::Other }, bytes, order })
}
