//! Packed bytes to what they were: by C libraries, and in a page by libraries in Rust alone.

use std::io::{self, Read};

/// What a frame of zstd unpacks to, `most` bytes at most, into what is empty; whether that `is_all` of it.
#[cfg(feature = "native")]
pub(super) fn zstd(packed: &[u8], most: u64, is_all: bool, into: &mut Vec<u8>) -> io::Result<usize> {
    if !is_all {
        let decoder = zstd::stream::read::Decoder::with_buffer(packed)?;
        return decoder.take(most).read_to_end(into);
    }
    // Right into its place: bulk needs no window of what came before.
    into.reserve_exact(usize::try_from(most).unwrap_or_default());
    zstd::bulk::Decompressor::new()?.decompress_to_buffer(packed, into)
}

/// What a frame of zstd unpacks to, `most` bytes at most, into what is empty.
#[cfg(not(feature = "native"))]
pub(super) fn zstd(packed: &[u8], most: u64, _: bool, into: &mut Vec<u8>) -> io::Result<usize> {
    let decoder = ruzstd::decoding::StreamingDecoder::new(packed).map_err(io::Error::other)?;
    decoder.take(most).read_to_end(into)
}

/// What a frame of lz4 unpacks to, `most` bytes at most, into what is empty.
pub(super) fn lz4(packed: &[u8], most: u64, into: &mut Vec<u8>) -> io::Result<usize> {
    #[cfg(feature = "native")]
    let decoder = lz4::Decoder::new(packed)?;
    #[cfg(not(feature = "native"))]
    let decoder = lz4_flex::frame::FrameDecoder::new(packed);
    decoder.take(most).read_to_end(into)
}

/// Unpacks deflated bytes, in the wrapping of zlib or bare, into their place; the count of those that came.
pub(super) fn inflate(packed: &[u8], is_wrapped: bool, into: &mut [u8]) -> Option<usize> {
    #[cfg(feature = "native")]
    let count = {
        let mut unpacker = libdeflater::Decompressor::new();
        if is_wrapped {
            unpacker.zlib_decompress(packed, into)
        } else {
            unpacker.deflate_decompress(packed, into)
        }
    };
    #[cfg(not(feature = "native"))]
    let count =
        miniz_oxide::inflate::decompress_slice_iter_to_slice(into, [packed].into_iter(), is_wrapped, false);
    count.ok()
}
