//! The calls of the page `dropcheck.html`: a block of bytes with what is asked to a block with the answer.
//!
//! A block is the length of a header (four bytes, the lowest first), the header (JSON), and what follows it: in
//! a question the recording, in an answer the length of a body and the body. The module imports nothing: it can
//! reach no file and no network.

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
    let Answer { header, body } = answer.unwrap_or_else(|refusal| question::refused(&refusal));
    let header = header.to_string();
    let length = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap_or(u32::MAX).to_le_bytes();
    let block = [&length(header.as_bytes()), header.as_bytes(), &length(&body), &body].concat();
    Box::leak(block.into_boxed_slice()).as_mut_ptr()
}
