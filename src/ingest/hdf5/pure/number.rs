//! A type and bytes of it in the file to a number.

use super::super::answer::Bytes;
use super::super::types::{Order, ValueKind, ValueType, of_message};
use super::words::beyond;
use crate::ingest::number_type::NumberType;

/// The type that a message states.
pub(super) fn type_of(message: &[u8]) -> Result<ValueType, Vec<Bytes>> {
    let dtype = of_message::of(message).ok_or_else(|| beyond("values of an unknown type"))?;
    if matches!(dtype.kind, ValueKind::OddNumber) {
        return Err(beyond(&format!("numbers of an unusual kind, {} bytes each", dtype.bytes)));
    }
    Ok(dtype)
}

/// How a number is stored.
#[derive(Clone, Copy)]
pub(super) struct NumberIn {
    number: NumberType,
    is_big_endian: bool,
}

impl NumberIn {
    /// `None` where the type is none of numbers.
    pub(super) fn of(dtype: &ValueType) -> Option<Self> {
        Some(Self { number: dtype.number()?, is_big_endian: dtype.order == Order::Highest })
    }

    pub(super) fn bytes(self) -> usize {
        self.number.bytes()
    }

    /// From its bytes.
    pub(super) fn value(self, stored: &[u8]) -> f64 {
        self.number.value(stored, self.is_big_endian)
    }
}
