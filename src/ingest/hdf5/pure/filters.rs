//! What the bytes of a chunk went through, and back.

use super::super::answer::Filter;
use hdf5_reader::FilterRegistry;
use hdf5_reader::error::Error;
use hdf5_reader::messages::filter_pipeline::FilterDescription;

const SZIP: u16 = 4;
const LZF: u16 = 32000;

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

/// Those that are undone: the library's but SZIP, which was compared with nothing; LZF it lacks.
pub(super) fn registry() -> FilterRegistry {
    let mut registry = FilterRegistry::new();
    for (id, name) in [(SZIP, "SZIP"), (LZF, "LZF")] {
        registry.register(id, Box::new(move |_, _, _| Err(Error::UnsupportedFilter(name.into()))));
    }
    registry
}
