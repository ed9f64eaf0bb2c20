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
        let ValueKind::Record(inner) = &self.kind else { return Vec::new() };
        if self.order == Order::Mixed || self.varies() {
            return Vec::new();
        }
        let is_big_endian = self.order == Order::Highest;
        // A damaged type may place a field outside its record.
        let is_within = |field: &RecordField| {
            let bytes = field.count.checked_mul(field.number.bytes());
            let end = bytes.and_then(|bytes| bytes.checked_add(field.from));
            field.count > 0 && end.is_some_and(|end| end <= self.bytes)
        };
        let fields = numbers(inner, DEEPEST).into_iter().filter(is_within).take(MOST_FIELDS);
        fields.map(|field| RecordField { is_big_endian, ..field }).collect()
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

/// The fields of numbers among those of a record, and among those of the records in it, so many deep.
fn numbers(fields: &[TypeField], deepest: usize) -> Vec<RecordField> {
    let of_field = |field: &TypeField| {
        let (base, count) = match &field.held.kind {
            ValueKind::Record(inner) if deepest > 0 => {
                let within = |inner: RecordField| {
                    let name = [&field.name, &b"."[..], &inner.name].concat();
                    RecordField { name, from: field.from.saturating_add(inner.from), ..inner }
                };
                return numbers(inner, deepest - 1).into_iter().map(within).collect();
            }
            ValueKind::List(base, count) => (&**base, *count),
            _ => (&field.held, 1),
        };
        let ValueKind::Number(number) = base.kind else { return Vec::new() };
        let (name, from) = (field.name.clone(), field.from);
        vec![RecordField { name, number, count, from, is_big_endian: false }]
    };
    fields.iter().flat_map(of_field).collect()
}
