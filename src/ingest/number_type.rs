//! Bytes of a number, as files of several formats store it, to its value.

use serde::{Deserialize, Serialize};

/// A number as Rust has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum NumberType {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// An integer of so many bytes; `None` where Rust has none.
    pub(super) fn integer(bytes: usize, is_signed: bool) -> Option<Self> {
        Some(match (bytes, is_signed) {
            (1, true) => Self::I8,
            (2, true) => Self::I16,
            (4, true) => Self::I32,
            (8, true) => Self::I64,
            (1, false) => Self::U8,
            (2, false) => Self::U16,
            (4, false) => Self::U32,
            (8, false) => Self::U64,
            _ => return None,
        })
    }

    /// Whether it is an integer.
    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Whether it is held as f64.
    pub(super) fn is_wide(self) -> bool {
        matches!(self, Self::F64 | Self::I32 | Self::I64 | Self::U32 | Self::U64)
    }

    /// Bytes of one.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// From as many bytes as it has.
    #[allow(clippy::cast_precision_loss, reason = "counts beyond 2^53 lose what no sensor resolves")]
    pub(super) fn value(self, stored: &[u8], is_big_endian: bool) -> f64 {
        let (mut bytes, length) = ([0; 8], stored.len());
        bytes[..length].copy_from_slice(stored);
        if is_big_endian {
            bytes[..length].reverse();
        }
        let (unsigned, beside) = (u64::from_le_bytes(bytes), 64 - 8 * u32::try_from(length).unwrap_or(8));
        match self {
            Self::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]).into(),
            Self::F64 => f64::from_bits(unsigned),
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => unsigned as f64,
            _ => ((unsigned << beside).cast_signed() >> beside) as f64,
        }
    }
}
