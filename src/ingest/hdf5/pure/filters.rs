//! What the bytes of a chunk went through, and back.

use super::super::answer::Filter;
use hdf5_reader::FilterRegistry;
use hdf5_reader::error::Error;
use hdf5_reader::messages::filter_pipeline::FilterDescription;

const SZIP: u16 = 4;
const LZF: u16 = 32000;
/// No chunk that is read unpacks to more.
const MOST_BYTES: usize = 1 << 28;

pub(super) fn named(filter: &FilterDescription) -> Filter {
    match filter.id {
        1 => Filter::Deflate(filter.client_data.first().map_or(0, |level| u8::try_from(*level).unwrap_or(9))),
        2 => Filter::Shuffle,
        3 => Filter::Fletcher32,
        SZIP => Filter::Other("SZIP".into()),
        5 => Filter::Other("N-bit".into()),
        6 => Filter::Other("scale-offset".into()),
        LZF => Filter::Lzf,
        id => Filter::Other(format!("number {id}")),
    }
}

/// Those that are undone: the library's but SZIP, which was compared with nothing, and LZF, which it lacks.
pub(super) fn registry() -> FilterRegistry {
    let mut registry = FilterRegistry::new();
    registry.register(SZIP, Box::new(|_, _, _| Err(Error::UnsupportedFilter("SZIP".into()))));
    registry.register(
        LZF,
        Box::new(|filter, packed, _| {
            let most = filter.client_data.get(2).map_or(0, |bytes| *bytes as usize);
            let unpacked = lzf(packed, most.min(MOST_BYTES));
            unpacked.ok_or_else(|| Error::DecompressionError("LZF".into()))
        }),
    );
    registry
}

/// What LZF's bytes unpack to, `most` of them at most; `None` where they are damaged.
fn lzf(mut packed: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut take = |count: usize| {
        let (taken, rest) = packed.split_at_checked(count)?;
        packed = rest;
        Some(taken)
    };
    let mut bytes = Vec::new();
    while let Some(&[head]) = take(1) {
        let mut length = usize::from(head >> 5);
        if length == 0 {
            bytes.extend(take(usize::from(head) + 1)?);
        } else {
            if length == 7 {
                length += usize::from(take(1)?[0]);
            }
            let back = (usize::from(head & 31) << 8) + usize::from(take(1)?[0]) + 1;
            let from = bytes.len().checked_sub(back)?;
            // What is repeated may reach into what it makes.
            (from..from + length + 2).for_each(|at| bytes.push(bytes[at]));
        }
        if bytes.len() > most {
            return None;
        }
    }
    Some(bytes)
}
