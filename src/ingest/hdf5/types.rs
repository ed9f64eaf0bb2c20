//! A type in an HDF5 file to numbers, fields of numbers, and words for people.

#[cfg(feature = "native")]
pub(super) mod of_library;
#[cfg(any(not(feature = "native"), test, fuzzing))]
pub(super) mod of_message;

use super::answer::{Bytes, Dataset, RecordField, Storage};
use crate::ingest::number_type::NumberType;

/// A type with more fields than this is no table of channels; nested types multiply.
const MOST_FIELDS: usize = 4096;

/// Types within types are followed so far.
const DEEPEST: usize = 8;

/// The type of one value or record, as the file has it.
#[derive(Debug)]
pub(super) struct ValueType {
    pub kind: ValueKind,
    pub bytes: usize,
    /// Of all numbers in it; not told of a field.
    pub order: Order,
}

/// What values of a type are.
#[derive(Debug)]
pub(super) enum ValueKind {
    Number(NumberType),
    /// A number that has no name in Rust: half precision, odd widths.
    OddNumber,
    Text,
    VaryingText,
    List(Box<ValueType>, usize),
    VaryingList,
    /// Named values.
    Named,
    References,
    /// Names of fields, where they begin in a record (bytes), and what they are.
    Record(Vec<TypeField>),
    Other,
}

/// A field of a record.
#[derive(Debug)]
pub(super) struct TypeField {
    pub name: Bytes,
    /// Where it begins in a record, bytes.
    pub from: usize,
    pub held: ValueType,
}

/// Which byte of a number stands first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// Nothing in it has an order.
    None,
    Lowest,
    Highest,
    /// Of several, or of numbers that are not stored as in memory.
    Mixed,
}

impl ValueType {
    /// A dataset of which nothing else is known.
    pub(super) fn dataset(&self) -> Dataset {
        Dataset {
            type_name: self.name(),
            value_bytes: self.bytes as u64,
            number: self.number(),
            is_plain: self.is_plain(),
            fields: self.fields(),
            is_records: matches!(self.kind, ValueKind::Record(_)),
            shape: None,
            storage: Storage::Virtual,
            filters: Vec::new(),
            stored_bytes: 0,
            attributes: Vec::new(),
        }
    }

    /// How numbers of this type are read; `None` where they are none.
    pub(super) fn number(&self) -> Option<NumberType> {
        match self.kind {
            ValueKind::Number(number) => Some(number),
            ValueKind::OddNumber if self.bytes <= 2 => Some(NumberType::F32),
            ValueKind::OddNumber => Some(NumberType::F64),
            _ => None,
        }
    }

    /// Whether values are stored as their [`Self::number`] is, the lowest byte first.
    fn is_plain(&self) -> bool {
        matches!(self.kind, ValueKind::Number(_))
            && (self.order == Order::Lowest || self.bytes == 1 && self.order != Order::Mixed)
    }

    /// A type for people: `int16`, big-endian where it is.
    fn name(&self) -> Bytes {
        let name = match &self.kind {
            ValueKind::Record(fields) => {
                let names: Vec<&[u8]> = fields.iter().map(|field| &field.name[..]).collect();
                return [&b"records ("[..], &names.join(&b", "[..]), b")"].concat();
            }
            ValueKind::Text | ValueKind::VaryingText => return b"text".to_vec(),
            ValueKind::List(..) | ValueKind::VaryingList => return b"lists".to_vec(),
            ValueKind::Named => return b"named values".to_vec(),
            ValueKind::References => return b"references".to_vec(),
            ValueKind::Number(number) => number_name(*number),
            // IEEE 754 binary16 is the only one that loggers write and Rust has no type for.
            ValueKind::OddNumber if self.bytes == 2 => "float16".into(),
            ValueKind::OddNumber => format!("{}-byte number", self.bytes),
            ValueKind::Other => return b"another type".to_vec(),
        };
        match self.order {
            Order::Highest if self.bytes > 1 => format!("{name} big-endian"),
            _ => name,
        }
        .into_bytes()
    }

    /// The fields of numbers; none where the type is no record, or none whose layout in the file the library
    /// tells: fields that differ in byte order, and references, texts and lists of varying length, which take
    /// other room in the file than in memory.
    fn fields(&self) -> Vec<RecordField> {
        let mut fields = Vec::new();
        if let ValueKind::Record(inner) = &self.kind
            && self.order != Order::Mixed
            && !self.varies()
        {
            let is_big_endian = self.order == Order::Highest;
            let outer = Outer { name: b"", from: 0, depth: 0, record_bytes: self.bytes, is_big_endian };
            outer.add(inner, &mut fields);
        }
        fields
    }

    fn varies(&self) -> bool {
        match &self.kind {
            ValueKind::Record(fields) => fields.iter().any(|field| field.held.varies()),
            ValueKind::List(base, _) => base.varies(),
            ValueKind::VaryingList | ValueKind::VaryingText | ValueKind::References => true,
            _ => false,
        }
    }
}

fn number_name(number: NumberType) -> String {
    let kind = match number {
        NumberType::F32 | NumberType::F64 => "float",
        NumberType::U8 | NumberType::U16 | NumberType::U32 | NumberType::U64 => "uint",
        _ => "int",
    };
    format!("{kind}{}", 8 * number.bytes())
}

/// The record, or a field of it that holds fields itself.
struct Outer<'a> {
    name: &'a [u8],
    from: usize,
    depth: usize,
    record_bytes: usize,
    is_big_endian: bool,
}

impl Outer<'_> {
    fn add(&self, inner: &[TypeField], fields: &mut Vec<RecordField>) {
        for field in inner {
            let name = [self.name, &field.name].concat();
            let from = self.from.saturating_add(field.from);
            let (base, count) = match &field.held.kind {
                ValueKind::Record(inner) if self.depth < DEEPEST => {
                    let name = &[&name, &b"."[..]].concat();
                    Outer { name, from, depth: self.depth + 1, ..*self }.add(inner, fields);
                    continue;
                }
                ValueKind::List(base, count) => (&**base, *count),
                _ => (&field.held, 1),
            };
            // A damaged type may place a field outside its record.
            let end = count.checked_mul(base.bytes).and_then(|all| all.checked_add(from));
            if let ValueKind::Number(number) = base.kind
                && end.is_some_and(|end| end <= self.record_bytes)
                && count > 0
                && fields.len() < MOST_FIELDS
            {
                fields.push(RecordField { name, number, count, from, is_big_endian: self.is_big_endian });
            }
        }
    }
}
