//! A type and bytes of it in the file to a number.

use super::super::answer::{Bytes, NumberType};
use super::super::types::{Order, ValueKind, ValueType, of_message};
use super::words::beyond;

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
    #[allow(clippy::cast_precision_loss, reason = "counts beyond 2^53 lose what no sensor resolves")]
    pub(super) fn value(self, stored: &[u8]) -> f64 {
        let (mut bytes, length) = ([0; 8], stored.len());
        bytes[..length].copy_from_slice(stored);
        if self.is_big_endian {
            bytes[..length].reverse();
        }
        let (unsigned, beside) = (u64::from_le_bytes(bytes), 64 - 8 * u32::try_from(length).unwrap_or(8));
        match self.number {
            NumberType::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]).into(),
            NumberType::F64 => f64::from_bits(unsigned),
            NumberType::U8 | NumberType::U16 | NumberType::U32 | NumberType::U64 => unsigned as f64,
            _ => ((unsigned << beside).cast_signed() >> beside) as f64,
        }
    }
}
