//! The calls of the page `dropcheck.html`: a block of bytes with what is asked to the parts of the answer.
//!
//! A question is the length of a header (four bytes, the lowest first), the header (JSON) and the recording;
//! an answer the number of its parts, then where each lies and how long it is: a header, and what the page
//! shows or saves. The module imports nothing: it can reach no file and no network.

mod cask_text;
mod question;

use question::{Answer, Question};

/// Memory for a block of so many bytes, which the page fills in and hands to [`call`].
#[unsafe(no_mangle)]
pub extern "C" fn alloc(length: usize) -> *mut u8 {
    Box::leak(vec![0_u8; length].into_boxed_slice()).as_mut_ptr()
}

/// The answer to the question in a block, which is taken.
///
/// # Safety
/// The block is one that [`alloc`] handed out, of that length, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn call(block: *mut u8, length: usize) -> *mut u8 {
    // SAFETY: the block was leaked as a box of this length.
    let block = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(block, length)) };
    let answer = Question::of(&block).and_then(|question| {
        drop(block);
        question.answered()
    });
    let Answer { header, bodies } = answer.unwrap_or_else(|refusal| question::refused(&refusal));
    let parts = std::iter::once(header.to_string().into_bytes()).chain(bodies);
    let parts: Vec<&[u8]> = parts.map(|part| &*part.leak()).collect();
    let places = parts.iter().flat_map(|part| [part.as_ptr().addr(), part.len()]);
    let words = std::iter::once(parts.len()).chain(places);
    let table: Vec<u8> =
        words.flat_map(|word| u32::try_from(word).unwrap_or(u32::MAX).to_le_bytes()).collect();
    table.leak().as_mut_ptr()
}
