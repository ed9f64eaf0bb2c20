//! A file's first bytes to its format, whatever its name.

use super::error::{self, IngestError};
use super::mme::MmeFiles;
use super::recording_file::{OpenFile, RecordingFile};
use super::refusal::Refusal;
use super::{lines, strangers};
use crate::data::RecordingFormat;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

const HDF5_SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// How much of a file is looked at: beyond any preamble seen in loggers' exports.
const HEAD_BYTES: u64 = 1 << 16;

/// The format of a recording.
///
/// # Errors
/// A directory, an unreadable, empty or unknown file, each by its own message.
pub fn format<'a>(recording: impl Into<RecordingFile<'a>>) -> Result<RecordingFormat, IngestError> {
    let recording = recording.into();
    let path = recording.path;
    if recording.is_folder() {
        return mme(recording)?.ok_or_else(|| error::directory(path));
    }
    let mut file = recording.opened().map_err(|source| error::io(path, &source))?;
    let length = recording.length().map_err(|source| error::io(path, &source))?;
    let mut head = Vec::new();
    (&mut file).take(HEAD_BYTES).read_to_end(&mut head).map_err(|source| error::io(path, &source))?;
    if head.is_empty() {
        return Err(unknown(path, "the file is empty", "take the original from the logger again"));
    }
    if head.starts_with(mcap::MAGIC) {
        return Ok(RecordingFormat::Mcap);
    }
    if has_hdf5_signature(&mut file, length).map_err(|source| error::io(path, &source))? {
        return Ok(RecordingFormat::Hdf5);
    }
    if head.starts_with(b"PK\x03\x04")
        && let Some(format) = mme(recording)?
    {
        return Ok(format);
    }
    if let Some((what, mend)) = strangers::named(&head) {
        return Err(unknown(path, &format!("it is {what}"), mend));
    }
    if memchr::memmem::find(&head, b"[[channel]]").is_some() {
        let mend = "name the recording here; the cask file stands after `--cask`";
        return Err(unknown(path, "it is a cask file", mend));
    }
    if lines::wide_text(&head).is_some() || is_text(&head) {
        return Ok(RecordingFormat::Csv);
    }
    let hex: Vec<String> = head.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    let mend = "dropcheck reads MCAP, HDF5, delimited text (CSV) and ISO-MME, told by content, not by name; \
                export the recording as one of these";
    Err(unknown(path, &format!("its first bytes are {}", hex.join(" ")), mend))
}

/// ISO-MME, where the folder or zip holds a test in it.
fn mme(recording: RecordingFile) -> Result<Option<RecordingFormat>, IngestError> {
    Ok(MmeFiles::of(recording)?.map(|_| RecordingFormat::Mme))
}

/// Whether the HDF5 signature stands at 0, 512, 1024, 2048 …: a user block may come first (HDF5 format
/// specification, II.A).
fn has_hdf5_signature(file: &mut OpenFile, length: u64) -> std::io::Result<bool> {
    let mut at = 0;
    while at + 8 <= length {
        let mut signature = [0; 8];
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(&mut signature)?;
        if signature == HDF5_SIGNATURE {
            return Ok(true);
        }
        at = if at == 0 { 512 } else { at.saturating_mul(2) };
    }
    Ok(false)
}

/// Whether a file begins with a line of text: a table of rows or none, which its reader finds out. One that
/// its logger reserved ahead ends in zero bytes.
fn is_text(head: &[u8]) -> bool {
    let text = head.split(|&byte| byte == 0).next().unwrap_or_default();
    // A form feed, and what closes files of DOS.
    let is_odd = |byte: &u8| *byte < b' ' && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c | 0x1a);
    text.iter().any(|byte| matches!(byte, b'\n' | b'\r')) && !text.iter().any(is_odd)
}

fn unknown(path: &Path, found: &str, mend: &str) -> IngestError {
    error::of_file(path, Refusal::new(format!("not a recording that dropcheck can read: {found}"), mend))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(content: &[u8]) -> Result<RecordingFormat, String> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("recording.mcap");
        std::fs::write(&path, content).unwrap();
        format(&path).map_err(|error| error.to_string())
    }

    #[test]
    fn content_decides_not_the_name() {
        assert_eq!(of(b"\x89MCAP0\r\n"), Ok(RecordingFormat::Mcap));
        assert_eq!(of(b"\x89HDF\r\n\x1a\nrest"), Ok(RecordingFormat::Hdf5));
        let mut user_block = vec![b' '; 1024];
        user_block.extend_from_slice(HDF5_SIGNATURE);
        assert_eq!(of(&user_block), Ok(RecordingFormat::Hdf5));
    }

    #[test]
    fn text_is_csv_with_any_delimiter_header_or_preamble() {
        for text in [
            "time_s,a1\n0,1.5\n1,2\n",
            "Logger 7\nDate;1.2.2026\n\nt;a\n0,1;2,5\n0,2;2,6\n",
            "0.1\t-3\n0.2\t-4\n",
            "a\n1\n",
            "when,a\n2026-01-01T00:00:00,1\n2026-01-01T00:00:01,2\n",
            "time_s,word\n0,ok\n1,bad\n",
            "t|a\n0|1\n1|2\n",
            "t;a\r0;1\r1;2\r",
            "t;a\n0;−1,5\n1;−2,5\n",
            "t;a\n0;1\n1;2\n\0\0\0\0",
            "Dear colleague,\nthe test is done.\n",
        ] {
            assert_eq!(of(text.as_bytes()), Ok(RecordingFormat::Csv), "{text:?}");
            for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
                let wide: Vec<u8> = text.trim_end_matches('\0').encode_utf16().flat_map(bytes).collect();
                let expected = if wide.len() < 16 { None } else { Some(RecordingFormat::Csv) };
                assert_eq!(of(&wide).ok(), expected, "{text:?}");
            }
        }
    }

    #[test]
    fn what_is_no_recording_is_said_to_be_what_it_is() {
        for (content, part) in [
            (&b""[..], "empty"),
            (b"#ROSBAG V2.0\n", "ROS 1"),
            (b"[cask]\nname = \"x\"\n\n[[channel]]\n", "cask file"),
            (b"\x89MCA", "89 4d 43 41"),
            (b"\x89MCAP", "ends within its first bytes"),
            (b"\x89MCAP1\r\n", "unknown version"),
            (b"\x00\x01\x02\x03", "00 01 02 03"),
        ] {
            let message = of(content).expect_err(part);
            assert!(message.contains(part), "{message}");
        }
    }

    #[cfg(unix)]
    fn told(path: &Path) -> String {
        format(path).unwrap_err().to_string()
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_no_file() {
        assert!(told(Path::new("/dev/null")).contains("a pipe or a device"));
    }

    #[cfg(unix)]
    #[test]
    fn a_directory_and_a_missing_file_are_told_apart() {
        let dir = tempfile::tempdir().unwrap();
        assert!(told(dir.path()).contains("this is a directory"));
        assert!(told(&dir.path().join("none")).contains("No such file"));
    }
}
