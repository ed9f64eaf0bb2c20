//! A type as the C library tells it.

use super::{Order, TypeField, ValueKind, ValueType};
use crate::ingest::number_type::NumberType;
use hdf5_metno::Datatype;
use hdf5_metno::datatype::ByteOrder;
use hdf5_metno::types::{FloatSize, IntSize, TypeDescriptor};

pub(in crate::ingest) fn of(dtype: &Datatype) -> ValueType {
    let descriptor = dtype.to_descriptor();
    let in_memory =
        descriptor.as_ref().ok().and_then(|descriptor| Datatype::from_descriptor(descriptor).ok());
    let kind = match descriptor {
        Ok(descriptor) => kind(descriptor),
        // Half precision and odd widths have no name in Rust; the library converts them.
        Err(_) if dtype.conv_to::<f64>().is_some() => ValueKind::OddNumber,
        Err(_) => ValueKind::Other,
    };
    let order = match dtype.byte_order() {
        ByteOrder::None => Order::None,
        // Whole numbers of 12 bits in two bytes: the library adds the bits of the sign.
        ByteOrder::LittleEndian
            if matches!(kind, ValueKind::Number(_)) && in_memory.is_none_or(|plain| plain != *dtype) =>
        {
            Order::Mixed
        }
        ByteOrder::LittleEndian => Order::Lowest,
        ByteOrder::BigEndian => Order::Highest,
        ByteOrder::Vax | ByteOrder::Mixed => Order::Mixed,
    };
    ValueType { kind, bytes: dtype.size(), order }
}

fn kind(descriptor: TypeDescriptor) -> ValueKind {
    let integer = |size: IntSize, is_signed| {
        NumberType::integer(size as usize, is_signed).map_or(ValueKind::OddNumber, ValueKind::Number)
    };
    match descriptor {
        TypeDescriptor::Integer(size) => integer(size, true),
        TypeDescriptor::Unsigned(size) => integer(size, false),
        TypeDescriptor::Float(FloatSize::U4) => ValueKind::Number(NumberType::F32),
        TypeDescriptor::Float(_) => ValueKind::Number(NumberType::F64),
        TypeDescriptor::FixedAscii(_) | TypeDescriptor::FixedUnicode(_) => ValueKind::Text,
        TypeDescriptor::VarLenAscii | TypeDescriptor::VarLenUnicode => ValueKind::VaryingText,
        TypeDescriptor::FixedArray(base, count) => ValueKind::List(Box::new(field(*base)), count),
        TypeDescriptor::VarLenArray(_) => ValueKind::VaryingList,
        TypeDescriptor::Enum(_) | TypeDescriptor::Boolean => ValueKind::Named,
        TypeDescriptor::Reference(_) => ValueKind::References,
        TypeDescriptor::Compound(compound) => {
            // The wrapper makes text of names of any bytes; they are bytes again before anybody looks at
            // them.
            let fields = compound.fields.into_iter().map(|inner| TypeField {
                name: inner.name.into_bytes(),
                from: inner.offset,
                held: field(inner.ty),
            });
            ValueKind::Record(fields.collect())
        }
    }
}

fn field(descriptor: TypeDescriptor) -> ValueType {
    ValueType { bytes: descriptor.size(), kind: kind(descriptor), order: Order::None }
}
