//! The bytes of a text file to lines in an encoding whose digits and delimiters are ASCII, each ended by \n
//! alone.

use super::error::{self, IngestError};
use super::{Limits, RecordingFile};
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::borrow::Cow;
use std::io::{Cursor, Read};
use std::path::Path;

/// How much of a file is looked at for its layout.
const HEAD_BYTES: u64 = 1 << 16;

/// A text file, opened.
pub(super) struct Text {
    /// Its beginning, without a byte-order mark.
    pub head: Vec<u8>,
    /// Whether `head` is all there is.
    pub is_whole: bool,
    /// What follows `head`.
    pub rest: Lines,
    /// Its size on disk.
    pub bytes: u64,
    /// How it is encoded, for people.
    pub encoding: &'static str,
}

impl Text {
    /// The text of a file.
    pub(super) fn open(file: RecordingFile, limits: Limits) -> Result<Self, IngestError> {
        let io = |source| error::io(file.path, &source);
        Self::read(file.path, Box::new(file.opened().map_err(io)?), file.length().map_err(io)?, limits)
    }

    /// The text of so many bytes that `file` gives, which messages call `path`.
    pub(super) fn read(
        path: &Path,
        mut file: Box<dyn Read + Send>,
        bytes: u64,
        limits: Limits,
    ) -> Result<Self, IngestError> {
        let io = |source| error::io(path, &source);
        let mut head = Vec::new();
        (&mut file).take(HEAD_BYTES).read_to_end(&mut head).map_err(io)?;
        if let Some(is_low_first) = wide_text(&head) {
            let (coding, name): (&Encoding, _) = if is_low_first {
                (UTF_16LE, "UTF-16 (little-endian)")
            } else {
                (UTF_16BE, "UTF-16 (big-endian)")
            };
            // It is turned into UTF-8 in memory as a whole.
            limits.hold(path, &format!("it is a text in {name} and takes"), bytes, limits.part_bytes())?;
            file.read_to_end(&mut head).map_err(io)?;
            let text = coding.decode(&head).0.into_owned();
            return Self::of(Box::new(Cursor::new(text)), bytes, name).map_err(io);
        }
        let has_mark = head.starts_with(b"\xEF\xBB\xBF");
        if has_mark {
            head.drain(..3);
        }
        // A letter cut in two at the head's end is no reason to call the text Latin-1.
        let is_utf8 = std::str::from_utf8(&head).map_or_else(|error| error.error_len().is_none(), |_| true);
        let encoding = match (is_utf8, has_mark) {
            (true, true) => "UTF-8 with byte-order mark",
            (true, false) => "UTF-8",
            (false, _) => "Latin-1 (Windows-1252)",
        };
        Self::of(Box::new(Cursor::new(head).chain(file)), bytes, encoding).map_err(io)
    }

    /// The text that `source` gives.
    pub(super) fn of(
        source: Box<dyn Read + Send>,
        bytes: u64,
        encoding: &'static str,
    ) -> std::io::Result<Self> {
        let mut rest = Lines::of(source);
        let mut head = Vec::new();
        let read = (&mut rest).take(HEAD_BYTES).read_to_end(&mut head)?;
        Ok(Self { head, is_whole: (read as u64) < HEAD_BYTES, rest, bytes, encoding })
    }

    /// The whole lines of the head.
    pub(super) fn lines(&self) -> Vec<Line<'_>> {
        let mut offset = 0;
        let all = self.head.split_inclusive(|&byte| byte == b'\n').map(|line| {
            offset += line.len();
            (offset - line.len(), line)
        });
        // Past the head's end its last line goes on.
        let whole = all.filter(|(_, line)| self.is_whole || line.ends_with(b"\n"));
        whole
            .map(|(offset, line)| Line { offset, text: text(line.strip_suffix(b"\n").unwrap_or(line)) })
            .collect()
    }
}

/// The bytes of a text in UTF-8 where a mark at their beginning says that they are UTF-16: Windows PowerShell
/// writes so what a command is made to print into a file.
pub(crate) fn in_utf8(bytes: Vec<u8>) -> Vec<u8> {
    match Encoding::for_bom(&bytes).filter(|(coding, _)| [UTF_16LE, UTF_16BE].contains(coding)) {
        Some((coding, _)) => coding.decode(&bytes).0.into_owned().into_bytes(),
        None => bytes,
    }
}

/// A text in UTF-16: whether the lower byte of each letter stands first, by its mark or by the zero bytes
/// between plain letters.
pub(super) fn wide_text(head: &[u8]) -> Option<bool> {
    /// Bytes that are looked at, and the least that tell.
    const LOOKED_AT: usize = 256;
    const LEAST: usize = 8;
    match head {
        [0xFF, 0xFE, ..] => return Some(true),
        [0xFE, 0xFF, ..] => return Some(false),
        _ => {}
    }
    let (pairs, _) = head.get(..LOOKED_AT.min(head.len())).unwrap_or_default().as_chunks::<2>();
    // Three of four: a minus of its own in every cell is another letter.
    let most = |is_letter: fn(&[u8; 2]) -> bool| {
        4 * pairs.iter().filter(|pair| is_letter(pair)).count() >= 3 * pairs.len()
    };
    match pairs.len() {
        0..LEAST => None,
        _ if most(|pair| is_plain(pair[0]) && pair[1] == 0) => Some(true),
        _ if most(|pair| pair[0] == 0 && is_plain(pair[1])) => Some(false),
        _ => None,
    }
}

fn is_plain(byte: u8) -> bool {
    matches!(byte, b'\t' | b'\n' | b'\r' | b' '..=b'~')
}

/// A text as it is read, up to its first zero byte; \r\n, \n\r and \r alone are turned into \n.
pub(super) struct Lines {
    source: Box<dyn Read + Send>,
    /// Whether a \r came last: a \n that follows belongs to it.
    is_behind_return: bool,
    /// Whether a \n of its own came last: a \r that follows belongs to it.
    is_behind_feed: bool,
    /// Whether a zero byte ended the text.
    pub has_zeros: bool,
}

impl Read for Lines {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        while !self.has_zeros && !buffer.is_empty() {
            let read = self.source.read(buffer)?;
            let kept = self.settle(&mut buffer[..read]);
            // All that was read may be the \n of a "\r\n".
            if kept > 0 || read == 0 {
                return Ok(kept);
            }
        }
        Ok(0)
    }
}

impl Lines {
    /// The text that `source` gives.
    pub(super) fn of(source: Box<dyn Read + Send>) -> Self {
        Self { source, is_behind_return: false, is_behind_feed: false, has_zeros: false }
    }

    /// Ends the lines of `text`; how many of its bytes are left.
    fn settle(&mut self, text: &mut [u8]) -> usize {
        let (mut at, mut kept) = (0, 0);
        let was_behind_feed = std::mem::take(&mut self.is_behind_feed);
        while at < text.len() {
            if std::mem::take(&mut self.is_behind_return) && text[at] == b'\n' {
                at += 1;
            }
            let odd = memchr::memchr2(b'\r', 0, &text[at..]).map_or(text.len(), |found| at + found);
            let is_behind_feed = if odd > at { text[odd - 1] == b'\n' } else { odd == 0 && was_behind_feed };
            if kept < at {
                text.copy_within(at..odd, kept);
            }
            kept += odd - at;
            at = odd + 1;
            match text.get(odd) {
                None => self.is_behind_feed = is_behind_feed,
                Some(0) => {
                    self.has_zeros = true;
                    return kept;
                }
                Some(_) if is_behind_feed => {}
                Some(_) => {
                    self.is_behind_return = true;
                    text[kept] = b'\n';
                    kept += 1;
                }
            }
        }
        kept
    }
}

/// A line of the beginning of a text.
pub(super) struct Line<'a> {
    /// Where it begins in [`Text::head`].
    pub offset: usize,
    /// Without its line break.
    pub text: Cow<'a, str>,
}

/// A line as text: UTF-8, else Latin-1.
pub(super) fn text(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(line).0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text that is left of `bytes`, read so many at a time.
    fn settled(bytes: &'static [u8], at_a_time: usize) -> (Vec<u8>, bool) {
        let mut lines = Lines::of(Box::new(Cursor::new(bytes)));
        let (mut text, mut buffer) = (Vec::new(), vec![0; at_a_time]);
        while let read @ 1.. = lines.read(&mut buffer).unwrap() {
            text.extend_from_slice(&buffer[..read]);
        }
        (text, lines.has_zeros)
    }

    #[test]
    fn lines_end_in_one_byte_wherever_they_are_cut() {
        for at_a_time in [1, 2, 3, 64, 1000] {
            for (bytes, expected, has_zeros) in [
                (&b"a\r\nb\rc\n\n"[..], &b"a\nb\nc\n\n"[..], false),
                (b"\r\n\r\n\r\r\n", b"\n\n\n\n", false),
                (b"a\nb\r", b"a\nb\n", false),
                (b"a\r\n1\0\0\nb", b"a\n1", true),
                (b"a\n\rb\n\r\n\rc\n\r", b"a\nb\n\nc\n", false),
                (b"a\n\r\nb\r\n\rc", b"a\n\nb\n\nc", false),
                (b"\0", b"", true),
                (&[b'x'; 300], &[b'x'; 300], false),
            ] {
                assert_eq!(settled(bytes, at_a_time), (expected.to_vec(), has_zeros), "{at_a_time}");
            }
        }
    }
}
