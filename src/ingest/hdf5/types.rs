//! A type in an HDF5 file to numbers, fields of numbers, and words for people.

use super::answer::{Bytes, NumberType, RecordField};
use hdf5_metno::Datatype;
use hdf5_metno::datatype::ByteOrder;
use hdf5_metno::types::{CompoundType, FloatSize, IntSize, TypeDescriptor};

/// A type with more fields than this is no table of channels; nested types multiply.
const MOST_FIELDS: usize = 4096;

/// Types within types are followed so far.
const DEEPEST: usize = 8;

/// How numbers of this type are read; `None` where they are none.
pub(super) fn number(dtype: &Datatype) -> Option<NumberType> {
    match dtype.to_descriptor() {
        Ok(descriptor) => described(&descriptor),
        // Half precision and odd widths have no name in Rust; the library converts them.
        Err(_) if dtype.size() <= 2 && dtype.conv_to::<f32>().is_some() => Some(NumberType::F32),
        Err(_) => dtype.conv_to::<f64>().map(|_| NumberType::F64),
    }
}

fn described(descriptor: &TypeDescriptor) -> Option<NumberType> {
    Some(match descriptor {
        TypeDescriptor::Integer(IntSize::U1) => NumberType::I8,
        TypeDescriptor::Integer(IntSize::U2) => NumberType::I16,
        TypeDescriptor::Integer(IntSize::U4) => NumberType::I32,
        TypeDescriptor::Integer(IntSize::U8) => NumberType::I64,
        TypeDescriptor::Unsigned(IntSize::U1) => NumberType::U8,
        TypeDescriptor::Unsigned(IntSize::U2) => NumberType::U16,
        TypeDescriptor::Unsigned(IntSize::U4) => NumberType::U32,
        TypeDescriptor::Unsigned(IntSize::U8) => NumberType::U64,
        TypeDescriptor::Float(FloatSize::U4) => NumberType::F32,
        TypeDescriptor::Float(_) => NumberType::F64,
        _ => return None,
    })
}

/// Whether values are stored as their [`number`] is, the lowest byte first.
pub(super) fn is_plain(dtype: &Datatype) -> bool {
    let is_one = dtype.to_descriptor().is_ok_and(|descriptor| described(&descriptor).is_some());
    is_one && (dtype.size() == 1 || dtype.byte_order() == ByteOrder::LittleEndian)
}

/// A type for people: `int16`, big-endian where it is.
pub(super) fn name(dtype: &Datatype) -> Bytes {
    let name = match dtype.to_descriptor() {
        Ok(TypeDescriptor::Compound(compound)) => {
            let names: Vec<Bytes> = compound.fields.into_iter().map(|f| f.name.into_bytes()).collect();
            return [&b"records ("[..], &names.join(&b", "[..]), b")"].concat();
        }
        Ok(
            TypeDescriptor::FixedAscii(_)
            | TypeDescriptor::FixedUnicode(_)
            | TypeDescriptor::VarLenAscii
            | TypeDescriptor::VarLenUnicode,
        ) => return b"text".to_vec(),
        Ok(TypeDescriptor::VarLenArray(_) | TypeDescriptor::FixedArray(..)) => return b"lists".to_vec(),
        Ok(TypeDescriptor::Enum(_) | TypeDescriptor::Boolean) => return b"named values".to_vec(),
        Ok(TypeDescriptor::Reference(_)) => return b"references".to_vec(),
        Ok(number) => number.to_string(),
        // IEEE 754 binary16 is the only one that loggers write and Rust has no type for.
        Err(_) if dtype.conv_to::<f64>().is_some() && dtype.size() == 2 => "float16".into(),
        Err(_) if dtype.conv_to::<f64>().is_some() => format!("{}-byte number", dtype.size()),
        Err(_) => return b"another type".to_vec(),
    };
    match dtype.byte_order() {
        ByteOrder::BigEndian if dtype.size() > 1 => format!("{name} big-endian"),
        _ => name,
    }
    .into_bytes()
}

/// The fields of numbers; none where the type is no record, or none whose layout in the file the library
/// tells: fields that differ in byte order, and references, texts and lists of varying length, which take
/// other room in the file than in memory.
pub(super) fn fields(dtype: &Datatype) -> Vec<RecordField> {
    let mut fields = Vec::new();
    let is_big_endian = match dtype.byte_order() {
        ByteOrder::BigEndian => true,
        ByteOrder::LittleEndian | ByteOrder::None => false,
        ByteOrder::Vax | ByteOrder::Mixed => return fields,
    };
    if let Ok(descriptor) = dtype.to_descriptor()
        && !varies(&descriptor)
        && let TypeDescriptor::Compound(compound) = descriptor
    {
        let outer = Outer { name: b"", from: 0, depth: 0, record_bytes: dtype.size(), is_big_endian };
        outer.add(compound, &mut fields);
    }
    fields
}

fn varies(descriptor: &TypeDescriptor) -> bool {
    match descriptor {
        TypeDescriptor::Compound(compound) => compound.fields.iter().any(|field| varies(&field.ty)),
        TypeDescriptor::FixedArray(base, _) => varies(base),
        TypeDescriptor::VarLenArray(_)
        | TypeDescriptor::VarLenAscii
        | TypeDescriptor::VarLenUnicode
        | TypeDescriptor::Reference(_) => true,
        _ => false,
    }
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
    fn add(&self, compound: CompoundType, fields: &mut Vec<RecordField>) {
        for inner in compound.fields {
            // The wrapper makes text of names of any bytes; they are bytes again before anybody looks at
            // them.
            let name = [self.name, &inner.name.into_bytes()].concat();
            let from = self.from.saturating_add(inner.offset);
            let (base, count) = match inner.ty {
                TypeDescriptor::Compound(compound) if self.depth < DEEPEST => {
                    let name = &[&name, &b"."[..]].concat();
                    Outer { name, from, depth: self.depth + 1, ..*self }.add(compound, fields);
                    continue;
                }
                TypeDescriptor::FixedArray(base, count) => (*base, count),
                base => (base, 1),
            };
            // A damaged type may place a field outside its record.
            let end = count.checked_mul(base.size()).and_then(|all| all.checked_add(from));
            if let Some(number) = described(&base)
                && end.is_some_and(|end| end <= self.record_bytes)
                && count > 0
                && fields.len() < MOST_FIELDS
            {
                fields.push(RecordField { name, number, count, from, is_big_endian: self.is_big_endian });
            }
        }
    }
}
