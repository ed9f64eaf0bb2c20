//! A text as it is read to batches of it, and a batch to pieces of whole lines that threads take side by
//! side.

use super::super::Limits;
use std::io::Read;
use std::ops::Range;

/// Bytes of a piece, unless a line is longer: it and its rows stay in a core's own cache.
const PIECE_BYTES: usize = 1 << 18;
/// A thread that is held up leaves some of its pieces to the others.
const PIECES_A_THREAD: usize = 4;
/// On a machine of many cores a batch takes no more than 16 MiB.
const MOST_PIECES: usize = 64;

/// How much of a text is taken at a time, and the most that is believed of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::struct_field_names, reason = "each name ends in its unit")]
pub(super) struct Sizes {
    /// Of a piece, unless a line is longer; at most `line_bytes`.
    pub piece_bytes: usize,
    /// Of a batch, unless a line is longer.
    pub batch_bytes: usize,
    /// Of the longest line allowed, with its line break.
    pub line_bytes: usize,
    /// Of all samples that may be held.
    pub samples_bytes: u64,
}

impl Sizes {
    /// Sizes within `limits` for a text of so many bytes; one thread or a short text gets batches of one
    /// piece.
    pub(super) fn of(limits: Limits, text_bytes: u64) -> Self {
        let line_bytes = usize::try_from(limits.line_bytes()).unwrap_or(usize::MAX);
        let piece_bytes = PIECE_BYTES.min(line_bytes);
        let is_short = text_bytes <= piece_bytes as u64;
        let pieces = match if is_short { 1 } else { rayon::current_num_threads() } {
            0 | 1 => 1,
            threads => threads.saturating_mul(PIECES_A_THREAD).min(MOST_PIECES),
        };
        let batch_bytes = pieces * piece_bytes;
        Self { piece_bytes, batch_bytes, line_bytes, samples_bytes: limits.samples_bytes() }
    }
}

/// A stretch of the text.
#[derive(Debug, Default)]
pub(super) struct TextBatch {
    pub text: Vec<u8>,
    /// Whether the text ends with it.
    pub is_last: bool,
}

impl TextBatch {
    /// Reads on behind the text held; a line that fills the batch gets twice the room.
    pub(super) fn fill(&mut self, rest: &mut impl Read, sizes: Sizes) -> std::io::Result<()> {
        let held = self.text.len();
        let most = if held < sizes.batch_bytes { sizes.batch_bytes } else { held.saturating_mul(2) };
        let room = most - held;
        let read = rest.take(room as u64).read_to_end(&mut self.text)?;
        self.is_last = read < room;
        Ok(())
    }
}

/// A batch cut at line breaks.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Cut {
    /// Whole lines, one piece after the other from the batch's beginning.
    pub pieces: Vec<Range<usize>>,
    /// Where the last piece ends.
    pub end: usize,
    /// Whether the line there is longer than any may be.
    pub is_too_long: bool,
}

impl Cut {
    /// The pieces of `text`, each as long as its size allows.
    pub(super) fn of(text: &[u8], sizes: Sizes) -> Self {
        let is_break = |&byte: &u8| byte == b'\n';
        let (mut pieces, mut end) = (Vec::new(), 0);
        loop {
            let rest = &text[end..];
            let (usual, more) = rest.split_at(rest.len().min(sizes.piece_bytes));
            let length = usual.iter().rposition(is_break).or_else(|| {
                let most = sizes.line_bytes.saturating_sub(usual.len()).min(more.len());
                more[..most].iter().position(is_break).map(|at| usual.len() + at)
            });
            let Some(length) = length else { break };
            pieces.push(end..end + length + 1);
            end += length + 1;
        }
        Self { pieces, end, is_too_long: text.len() - end >= sizes.line_bytes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: Sizes = Sizes { piece_bytes: 8, batch_bytes: 24, line_bytes: 12, samples_bytes: 1 << 20 };

    fn cut(text: &str) -> (Vec<&str>, bool) {
        let cut = Cut::of(text.as_bytes(), SIZES);
        (cut.pieces.into_iter().map(|piece| &text[piece]).collect(), cut.is_too_long)
    }

    #[test]
    fn pieces_are_whole_lines_of_about_their_size() {
        assert_eq!(cut(""), (vec![], false));
        assert_eq!(cut("1,2"), (vec![], false));
        assert_eq!(cut("1\n2\n3\n4\n5\n6"), (vec!["1\n2\n3\n4\n", "5\n"], false));
        // Longer than a piece, at most as long as a line may be.
        assert_eq!(cut("1\n2345678901\n2\n"), (vec!["1\n", "2345678901\n", "2\n"], false));
        assert_eq!(cut("12345678901\n2"), (vec!["12345678901\n"], false));
        assert_eq!(cut("1\n123456789012\n2"), (vec!["1\n"], true));
        assert_eq!((cut("12345678901").1, cut("123456789012").1), (false, true));
    }

    #[test]
    fn batches_are_filled_and_grow_with_their_line() {
        let mut rest: &[u8] = &[b'1'; 100];
        let mut batch = TextBatch { text: b"head".to_vec(), is_last: false };
        for (length, is_last) in [(24, false), (48, false), (96, false), (104, true)] {
            batch.fill(&mut rest, SIZES).unwrap();
            assert_eq!((batch.text.len(), batch.is_last), (length, is_last));
        }
    }

    #[test]
    fn sizes_keep_to_the_limits() {
        let small = Sizes::of(Limits::of_memory(0), u64::MAX);
        assert_eq!((small.piece_bytes, small.line_bytes), (1 << 14, 1 << 14));
        let usual = Sizes::of(Limits::default(), 1000);
        assert_eq!((usual.piece_bytes, usual.batch_bytes, usual.line_bytes), (1 << 18, 1 << 18, 1 << 20));
    }
}
