//! A text file to bytes in which digits and delimiters are ASCII, whatever its encoding.

use super::super::Limits;
use super::super::detect;
use super::super::error::{self, IngestError};
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::borrow::Cow;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

/// How much of a file is looked at for its layout.
const HEAD_BYTES: u64 = 1 << 16;

/// A text file, opened.
pub(super) struct Input {
    /// Its beginning, without a byte-order mark.
    pub head: Vec<u8>,
    /// Whether `head` is all there is.
    pub is_whole: bool,
    /// What follows `head`.
    pub rest: Box<dyn Read + Send>,
    /// Its size on disk.
    pub bytes: u64,
    /// How it is encoded, for people.
    pub encoding: &'static str,
}

impl Input {
    /// A text in memory, in UTF-8 or what is taken for it.
    #[cfg(test)]
    pub(super) fn of_bytes(text: &[u8]) -> Self {
        let (head, rest) = text.split_at(text.len().min(1 << 16));
        Self {
            head: head.to_vec(),
            is_whole: rest.is_empty(),
            rest: Box::new(Cursor::new(rest.to_vec())),
            bytes: text.len() as u64,
            encoding: "UTF-8",
        }
    }

    pub(super) fn open(path: &Path, limits: Limits) -> Result<Self, IngestError> {
        let io = |source| error::io(path, source);
        let mut file = File::open(path).map_err(io)?;
        let bytes = file.metadata().map_err(io)?.len();
        let mut head = Vec::new();
        (&mut file).take(HEAD_BYTES).read_to_end(&mut head).map_err(io)?;
        let coding = |is_low_first: bool| {
            if is_low_first {
                (UTF_16LE, "UTF-16 (little-endian)")
            } else {
                (UTF_16BE, "UTF-16 (big-endian)")
            }
        };
        let wide = detect::wide_text(&head).map(coding);
        if let Some((coding, name)) = wide {
            // It is turned into UTF-8 in memory as a whole.
            if bytes > limits.part_bytes() {
                let what = format!("it is a text in {name} and takes");
                return Err(limits.refusal(path, &what, limits.part_bytes()));
            }
            file.read_to_end(&mut head).map_err(io)?;
            return Ok(Self::decoded(&head, bytes, (coding, name)));
        }
        let has_mark = head.starts_with(b"\xEF\xBB\xBF");
        if has_mark {
            head.drain(..3);
        }
        // A letter cut in two at the head's end is no reason to call it Latin-1.
        let is_utf8 = match std::str::from_utf8(&head) {
            Ok(_) => true,
            Err(error) => error.error_len().is_none(),
        };
        let encoding = match (is_utf8, has_mark) {
            (true, true) => "UTF-8 with byte-order mark",
            (true, false) => "UTF-8",
            (false, _) => "Latin-1 (Windows-1252)",
        };
        let is_whole = bytes <= HEAD_BYTES;
        // Lines that end in a carriage return alone, as old Macintosh programs write them.
        let is_returned = head.contains(&b'\r') && !head.contains(&b'\n');
        if is_returned {
            to_breaks(&mut head);
        }
        let rest: Box<dyn Read + Send> = if is_returned { Box::new(Returned(file)) } else { Box::new(file) };
        Ok(Self { head, is_whole, rest, bytes, encoding })
    }

    fn decoded(head: &[u8], bytes: u64, coding: (&'static Encoding, &'static str)) -> Self {
        let (text, _, _) = coding.0.decode(head);
        let mut text = text.into_owned().into_bytes();
        if !text.contains(&b'\n') {
            to_breaks(&mut text);
        }
        let rest = text.split_off(text.len().min(1 << 16));
        let is_whole = rest.is_empty();
        Self { head: text, is_whole, rest: Box::new(Cursor::new(rest)), bytes, encoding: coding.1 }
    }
}

/// A text whose lines end in carriage returns, with line breaks in their place.
struct Returned(File);

impl Read for Returned {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.0.read(buffer)?;
        to_breaks(&mut buffer[..read]);
        Ok(read)
    }
}

fn to_breaks(text: &mut [u8]) {
    text.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
}

/// Where the line that goes on at `at` ends: its line break, a carriage return without one, a zero byte, or the text's end.
pub(super) fn end_of_line(text: &[u8], at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    // One comparison a byte for all but control characters.
    let Some(found) = rest.iter().position(|&b| b <= b'\r' && matches!(b, 0 | b'\n' | b'\r')) else {
        return text.len();
    };
    if rest[found] != b'\r' {
        return at + found;
    }
    // Several before a line break are one end.
    match rest[found..].iter().position(|&b| b != b'\r').map(|more| found + more) {
        Some(behind) if rest[behind] == b'\n' => at + behind,
        Some(_) => at + found,
        None => text.len(),
    }
}

/// Line breaks in a text.
pub(super) fn breaks(text: &[u8]) -> u64 {
    text.iter().map(|&byte| u64::from(byte == b'\n')).sum()
}

/// The same of a text and what follows it.
pub(super) fn breaks_to_end(text: &[u8], rest: &mut dyn Read) -> std::io::Result<u64> {
    let mut count = breaks(text);
    let mut buffer = vec![0; 1 << 16];
    loop {
        let read = rest.read(&mut buffer)?;
        if read == 0 {
            return Ok(count);
        }
        count += breaks(&buffer[..read]);
    }
}

/// A line as text: UTF-8, else Latin-1.
pub(super) fn text(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(line).0,
    }
}
