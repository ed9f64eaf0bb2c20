//! A type as the C library tells it.

use super::{Field, Kind, Order, Type};
use crate::ingest::hdf5::answer::NumberType;
use hdf5_metno::Datatype;
use hdf5_metno::datatype::ByteOrder;
use hdf5_metno::types::{FloatSize, IntSize, TypeDescriptor};

pub(in super::super) fn of(dtype: &Datatype) -> Type {
    let kind = match dtype.to_descriptor() {
        Ok(descriptor) => kind(descriptor),
        // Half precision and odd widths have no name in Rust; the library converts them.
        Err(_) if dtype.conv_to::<f64>().is_some() => Kind::OddNumber,
        Err(_) => Kind::Other,
    };
    let order = match dtype.byte_order() {
        ByteOrder::None => Order::None,
        ByteOrder::LittleEndian => Order::Lowest,
        ByteOrder::BigEndian => Order::Highest,
        ByteOrder::Vax | ByteOrder::Mixed => Order::Mixed,
    };
    Type { kind, bytes: dtype.size(), order }
}

fn kind(descriptor: TypeDescriptor) -> Kind {
    match descriptor {
        TypeDescriptor::Integer(IntSize::U1) => Kind::Number(NumberType::I8),
        TypeDescriptor::Integer(IntSize::U2) => Kind::Number(NumberType::I16),
        TypeDescriptor::Integer(IntSize::U4) => Kind::Number(NumberType::I32),
        TypeDescriptor::Integer(IntSize::U8) => Kind::Number(NumberType::I64),
        TypeDescriptor::Unsigned(IntSize::U1) => Kind::Number(NumberType::U8),
        TypeDescriptor::Unsigned(IntSize::U2) => Kind::Number(NumberType::U16),
        TypeDescriptor::Unsigned(IntSize::U4) => Kind::Number(NumberType::U32),
        TypeDescriptor::Unsigned(IntSize::U8) => Kind::Number(NumberType::U64),
        TypeDescriptor::Float(FloatSize::U4) => Kind::Number(NumberType::F32),
        TypeDescriptor::Float(_) => Kind::Number(NumberType::F64),
        TypeDescriptor::FixedAscii(_) | TypeDescriptor::FixedUnicode(_) => Kind::Text,
        TypeDescriptor::VarLenAscii | TypeDescriptor::VarLenUnicode => Kind::VaryingText,
        TypeDescriptor::FixedArray(base, count) => Kind::List(Box::new(field(*base)), count),
        TypeDescriptor::VarLenArray(_) => Kind::VaryingList,
        TypeDescriptor::Enum(_) | TypeDescriptor::Boolean => Kind::Named,
        TypeDescriptor::Reference(_) => Kind::References,
        TypeDescriptor::Compound(compound) => {
            // The wrapper makes text of names of any bytes; they are bytes again before anybody looks at
            // them.
            let fields = compound.fields.into_iter().map(|inner| Field {
                name: inner.name.into_bytes(),
                from: inner.offset,
                held: field(inner.ty),
            });
            Kind::Record(fields.collect())
        }
    }
}

fn field(descriptor: TypeDescriptor) -> Type {
    Type { bytes: descriptor.size(), kind: kind(descriptor), order: Order::None }
}
