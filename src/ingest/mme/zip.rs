//! A zip to the files in it, stored or deflated: what ISO-MME is sent in, and no more of that format
//! (APPNOTE.TXT of PKWARE, 4.3).

use crate::ingest::recording_file::{RecordingFile, bytes_at};
use crate::ingest::unpack;
use std::io;

/// Lengths of a file's head before its bytes, of its entry in the list of all, and of the end behind that
/// list: without names and remarks, of which the longest has 64 KiB.
const HEAD_BYTES: u64 = 30;
const ENTRY_BYTES: usize = 46;
const END_BYTES: usize = 22;
const LONGEST_REMARK: u64 = 0xFFFF;

/// A file's entry in the list.
#[derive(Debug, Clone)]
pub(super) struct ZipEntry([u8; ENTRY_BYTES]);

/// The paths of the files in a zip, parted by "/", with their entries; none without a list of
/// them.
pub(super) fn entries(zip: RecordingFile) -> io::Result<Vec<(String, ZipEntry)>> {
    let mut file = zip.opened()?;
    let longest = END_BYTES as u64 + LONGEST_REMARK;
    let tail = bytes_at(&mut file, zip.length()?.saturating_sub(longest), longest)?;
    let end = tail.windows(END_BYTES).rev().find(|end| end.starts_with(b"PK\x05\x06"));
    let Some(end) = end else { return Ok(Vec::new()) };
    let list = bytes_at(&mut file, number(end, 16, 4), number(end, 12, 4))?;
    let (mut entries, mut rest) = (Vec::new(), &list[..]);
    while let Some((entry, behind)) = rest.split_first_chunk().filter(|_| rest.starts_with(b"PK\x01\x02")) {
        let bytes = |at| usize::try_from(number(entry, at, 2)).unwrap_or_default();
        let Some((name, behind)) = behind.split_at_checked(bytes(28)) else { break };
        entries.push((String::from_utf8_lossy(name).replace('\\', "/"), ZipEntry(*entry)));
        rest = behind.get(bytes(30) + bytes(32)..).unwrap_or_default();
    }
    Ok(entries)
}

impl ZipEntry {
    /// The file's size when unpacked, as stated.
    pub(super) fn bytes(&self) -> u64 {
        number(&self.0, 24, 4)
    }

    /// The file's bytes, unpacked and held against their check sum.
    ///
    /// # Errors
    /// It is packed in another way, or damaged.
    pub(super) fn unpacked(&self, zip: RecordingFile) -> io::Result<Vec<u8>> {
        let (mut file, head_at) = (zip.opened()?, number(&self.0, 42, 4));
        let head = bytes_at(&mut file, head_at, HEAD_BYTES)?;
        let behind = if head.starts_with(b"PK\x03\x04") { head.get(26..30) } else { None };
        let behind = behind.map_or(0, |lengths| number(lengths, 0, 2) + number(lengths, 2, 2));
        let packed = bytes_at(&mut file, head_at + HEAD_BYTES + behind, number(&self.0, 20, 4))?;
        let bytes = match number(&self.0, 10, 2) {
            0 => packed,
            8 => {
                let mut bytes = vec![0; usize::try_from(self.bytes()).unwrap_or_default()];
                let count = unpack::inflate(&packed, false, &mut bytes);
                bytes.truncate(count.unwrap_or_default());
                bytes
            }
            method => {
                return Err(io::Error::other(format!("it is packed by method {method}, not by deflate")));
            }
        };
        if bytes.len() as u64 != self.bytes() || u64::from(crc32fast::hash(&bytes)) != number(&self.0, 16, 4)
        {
            return Err(io::Error::other("it is damaged or encrypted: its check sum is another"));
        }
        Ok(bytes)
    }
}

/// A number of so many bytes, the lowest first.
fn number(bytes: &[u8], at: usize, count: usize) -> u64 {
    bytes[at..at + count].iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
}
