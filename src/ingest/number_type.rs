//! Bytes of numbers, as files of several formats store them, to their values.

use crate::data::Samples;
use serde::{Deserialize, Serialize};

macro_rules! number_types {
    ($($name:ident = $number:ident as $sample:ident in $samples:ident),*) => {
        /// A number as Rust has it.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub(super) enum NumberType {
            $($name),*
        }

        #[allow(clippy::cast_lossless, clippy::cast_precision_loss, reason = "counts beyond 2^53 lose what \
            no sensor resolves")]
        impl NumberType {
            /// Bytes of one.
            pub(super) fn bytes(self) -> usize {
                match self { $(Self::$name => size_of::<$number>()),* }
            }

            /// Whether it is held as f64.
            pub(super) fn is_wide(self) -> bool {
                match self { $(Self::$name => size_of::<$sample>() == 8),* }
            }

            /// From as many bytes as it has.
            pub(super) fn value(self, stored: &[u8], is_big_endian: bool) -> f64 {
                match self {
                    $(Self::$name => {
                        let bytes = stored.first_chunk().copied().unwrap_or_default();
                        let [low, high] = [$number::from_le_bytes(bytes), $number::from_be_bytes(bytes)];
                        (if is_big_endian { high } else { low }) as f64
                    })*
                }
            }

            /// Numbers one behind another.
            pub(super) fn samples(self, stored: &[u8], is_big_endian: bool) -> Samples {
                match self {
                    $(Self::$name => {
                        let numbers = stored.as_chunks().0.iter();
                        Samples::$samples(if is_big_endian {
                            numbers.map(|bytes| $number::from_be_bytes(*bytes) as $sample).collect()
                        } else {
                            numbers.map(|bytes| $number::from_le_bytes(*bytes) as $sample).collect()
                        })
                    })*
                }
            }
        }
    };
}

/// Hands all types to a macro, each with what it is held as: f32 are f32 itself and short integers.
macro_rules! for_number_types {
    ($of_types:ident) => {
        $of_types!(
            I8 = i8 as f32 in F32,
            I16 = i16 as f32 in F32,
            I32 = i32 as f64 in F64,
            I64 = i64 as f64 in F64,
            U8 = u8 as f32 in F32,
            U16 = u16 as f32 in F32,
            U32 = u32 as f64 in F64,
            U64 = u64 as f64 in F64,
            F32 = f32 as f32 in F32,
            F64 = f64 as f64 in F64
        );
    };
}
pub(super) use for_number_types;

for_number_types!(number_types);

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
}
