//! A protobuf message's bytes to its fields: numbers and what stands in them, no schema.

use prost_reflect::prost::encoding::{WireType, decode_key, decode_varint};

/// What stands in a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Item<'a> {
    /// Wire type 0.
    Varint(u64),
    /// Wire type 1.
    Fixed64([u8; 8]),
    /// Wire type 2: a string, a message, packed numbers.
    Bytes(&'a [u8]),
    /// Wire type 5.
    Fixed32([u8; 4]),
}

/// The bytes not yet read.
#[derive(Debug)]
pub(super) struct Wire<'a>(pub(super) &'a [u8]);

impl<'a> Wire<'a> {
    /// The next field, `None` at the end.
    ///
    /// # Errors
    /// The bytes end within it, or are none.
    pub(super) fn item(&mut self) -> Result<Option<(u32, Item<'a>)>, String> {
        if self.0.is_empty() {
            return Ok(None);
        }
        let (number, kind) = decode_key(&mut self.0).map_err(|error| error.to_string())?;
        let item = match kind {
            WireType::Varint => Item::Varint(self.varint()?),
            WireType::SixtyFourBit => Item::Fixed64(self.fixed()?),
            WireType::ThirtyTwoBit => Item::Fixed32(self.fixed()?),
            WireType::LengthDelimited => {
                let length = usize::try_from(self.varint()?).unwrap_or(usize::MAX);
                let (bytes, rest) = self.0.split_at_checked(length).ok_or(ENDS)?;
                self.0 = rest;
                Item::Bytes(bytes)
            }
            other => return Err(format!("field {number} has the wire type {other:?}, which is not read")),
        };
        Ok(Some((number, item)))
    }

    /// A number in base 128, the lowest digit first.
    ///
    /// # Errors
    /// The bytes end within it, or it has more than 64 bits.
    pub(super) fn varint(&mut self) -> Result<u64, String> {
        decode_varint(&mut self.0).map_err(|_| "a number in it is cut, or has more than 64 bits".to_owned())
    }

    /// So many bytes.
    ///
    /// # Errors
    /// There are fewer.
    pub(super) fn fixed<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(ENDS)?;
        self.0 = rest;
        Ok(*bytes)
    }
}

const ENDS: &str = "the message ends within a field";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_wire_type_is_read_and_a_cut_message_is_an_error() {
        let bytes = [0x08, 0x96, 0x01, 0x15, 1, 0, 0, 0, 0x1a, 2, 7, 8, 0x21, 1, 2, 3, 4, 5, 6, 7, 8];
        let mut wire = Wire(&bytes);
        assert_eq!(wire.item(), Ok(Some((1, Item::Varint(150)))));
        assert_eq!(wire.item(), Ok(Some((2, Item::Fixed32([1, 0, 0, 0])))));
        assert_eq!(wire.item(), Ok(Some((3, Item::Bytes(&[7, 8])))));
        assert_eq!(wire.item(), Ok(Some((4, Item::Fixed64([1, 2, 3, 4, 5, 6, 7, 8])))));
        assert_eq!(wire.item(), Ok(None));
        let whole = [0, 3, 8, 12, 21];
        for end in 0..bytes.len() {
            let mut wire = Wire(&bytes[..end]);
            let outcome = std::iter::from_fn(|| wire.item().transpose()).collect::<Result<Vec<_>, _>>();
            assert_eq!(outcome.is_ok(), whole.contains(&end), "{end}");
        }
    }

    #[test]
    fn a_length_beyond_the_message_takes_no_memory() {
        assert!(Wire(&[0x0a, 0xff, 0xff, 0xff, 0xff, 0x0f, 1]).item().is_err());
        assert!(Wire(&[0xff; 11]).item().is_err());
    }
}
