//! A compound type to the fields of numbers in its records, and where they lie.

use super::dataset::Kind;
use hdf5_metno::Datatype;
use hdf5_metno::datatype::ByteOrder;
use hdf5_metno::types::{CompoundType, TypeDescriptor};

/// A type with more fields than this is no table of channels; nested types multiply.
const MOST_FIELDS: usize = 4096;

/// Types within types are followed so far.
const DEEPEST: usize = 8;

/// A field of numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    /// Its name, with those of the fields it lies in before it: `imu.z`.
    pub name: String,
    pub kind: Kind,
    /// Numbers in it, one record: above 1 for a list.
    pub count: usize,
    /// Where it begins in a record, bytes.
    pub from: usize,
    /// Of one number, bytes.
    pub bytes: usize,
    /// Of a whole record, bytes.
    pub record_bytes: usize,
    /// Whether the highest byte stands first.
    pub is_big_endian: bool,
}

impl Field {
    /// One number of the list, as a field of its own.
    pub(super) fn element(&self, index: usize) -> Self {
        Self { count: 1, from: self.from + index * self.bytes, ..self.clone() }
    }
}

/// The fields of numbers; none where the type is no record, or none whose layout in the file the library tells: fields that differ in
/// byte order, and references, texts and lists of varying length, which take other room in the file than in memory.
pub(super) fn fields(dtype: &Datatype) -> Vec<Field> {
    let mut fields = Vec::new();
    let is_big_endian = match dtype.byte_order() {
        ByteOrder::BigEndian => true,
        ByteOrder::LittleEndian | ByteOrder::None => false,
        ByteOrder::Vax | ByteOrder::Mixed => return fields,
    };
    if let Ok(TypeDescriptor::Compound(compound)) = dtype.to_descriptor()
        && !varies(&TypeDescriptor::Compound(compound.clone()))
    {
        let outer = Outer { name: "", from: 0, depth: 0, record_bytes: dtype.size(), is_big_endian };
        outer.add(&compound, &mut fields);
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

/// Their names, as many as fit a message.
pub(super) fn names(fields: &[Field]) -> String {
    const HANDFUL: usize = 12;
    let names: Vec<&str> = fields.iter().take(HANDFUL).map(|field| field.name.as_str()).collect();
    let more = if fields.len() > HANDFUL { ", …" } else { "" };
    format!("{}{more}", names.join(", "))
}

/// The record, or a field of it that holds fields itself.
struct Outer<'a> {
    name: &'a str,
    from: usize,
    depth: usize,
    record_bytes: usize,
    is_big_endian: bool,
}

impl Outer<'_> {
    fn add(&self, compound: &CompoundType, fields: &mut Vec<Field>) {
        for inner in &compound.fields {
            let name = format!("{}{}", self.name, inner.name);
            let from = self.from.saturating_add(inner.offset);
            let (base, count) = match &inner.ty {
                TypeDescriptor::Compound(compound) if self.depth < DEEPEST => {
                    let name = &format!("{name}.");
                    Outer { name, from, depth: self.depth + 1, ..*self }.add(compound, fields);
                    continue;
                }
                TypeDescriptor::FixedArray(base, count) => (base.as_ref(), *count),
                base => (base, 1),
            };
            let bytes = base.size();
            // A damaged type may place a field outside its record.
            let end = count.checked_mul(bytes).and_then(|all| all.checked_add(from));
            if let Some(kind) = Kind::of(base)
                && end.is_some_and(|end| end <= self.record_bytes)
                && count > 0
                && fields.len() < MOST_FIELDS
            {
                let (record_bytes, is_big_endian) = (self.record_bytes, self.is_big_endian);
                fields.push(Field { name, kind, count, from, bytes, record_bytes, is_big_endian });
            }
        }
    }
}
