//! A file's first bytes to its format, whatever its name.

use super::error::{self, IngestError};
use super::mme::MmeFiles;
use super::recording_file::{OpenFile, RecordingFile};
use super::refusal::Refusal;
use super::{lines, number, unsupported};
use crate::data::RecordingFormat;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

const HDF5_SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// How much of a text is looked at for rows of numbers: beyond any preamble seen in loggers' exports.
pub(super) const HEAD_BYTES: u64 = 1 << 16;
const FORMATS: &str = "dropcheck reads MCAP, HDF5, delimited text (CSV) and ISO-MME";

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
    if let Some((what, remedy)) = unsupported::named(&head) {
        return Err(unknown(path, &format!("it is {what}"), remedy.text()));
    }
    // A text in UTF-16: only its reader decodes it and can say whether it holds rows.
    if lines::wide_text(&head).is_some() || looks_like_rows(&head) {
        return Ok(RecordingFormat::Csv);
    }
    Err(stranger(path, &head))
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

/// Whether two lines one after the other have as many cells each and numbers in them.
fn looks_like_rows(head: &[u8]) -> bool {
    // A file that its logger reserved ahead ends in zero bytes.
    let head = head.split(|&byte| byte == 0).next().unwrap_or_default();
    let text = String::from_utf8_lossy(head);
    let mut lines = text.split(['\n', '\r']).map(str::trim_end).filter(|line| !line.trim().is_empty());
    let cells_of = |line: &str| [';', '\t', ',', '|', ' '].map(|delimiter| numeric_row(line, delimiter));
    let Some(first) = lines.next() else { return false };
    let (mut before, mut count) = (cells_of(first), 1);
    for line in lines {
        let cells = cells_of(line);
        if before.iter().zip(&cells).any(|(before, cells)| before.is_some() && before == cells) {
            return true;
        }
        (before, count) = (cells, count + 1);
    }
    // The last line may be cut off, a single one may be all there is after a header.
    (2..=3).contains(&count) && before.iter().any(Option::is_some)
}

/// Number of cells of a line that holds numbers, `None` where it holds none, or words alone.
fn numeric_row(line: &str, delimiter: char) -> Option<usize> {
    let blanks = |c: char| if delimiter == ' ' { c.is_whitespace() } else { c == delimiter };
    let cells = line.split(blanks).map(|cell| cell.trim().trim_matches('"'));
    let cells: Vec<&str> = cells.filter(|cell| delimiter != ' ' || !cell.is_empty()).collect();
    let is_number = |cell: &str| {
        let cell = cell.replace(',', ".");
        number::of_cell(cell.as_bytes(), b'.').is_some() || cell.parse::<f64>().is_ok()
    };
    let numbers = cells.iter().filter(|cell| is_number(cell)).count();
    let all_numbers = numbers > 0 && cells.iter().all(|cell| cell.is_empty() || is_number(cell));
    // Prose has blanks and commas too: there a row must be numbers throughout, or else numbers and words in
    // clear columns.
    if all_numbers || (numbers > 0 && cells.len() >= 2 && delimiter != ' ') {
        Some(cells.len())
    } else {
        None
    }
}

/// The error for content of no format that is read: its name where it is known, else its first bytes.
fn stranger(path: &Path, head: &[u8]) -> IngestError {
    if head.windows(11).any(|window| window == b"[[channel]]") {
        return unknown(
            path,
            "it is a cask file",
            "name the recording here; the cask file stands after `--cask`",
        );
    }
    if head.starts_with(b"\x89MCAP") {
        let what = if head.len() < mcap::MAGIC.len() {
            format!("it begins as MCAP and ends after {} bytes", head.len())
        } else {
            "it begins as MCAP of an unknown version".to_owned()
        };
        return unknown(path, &what, "take the original from the logger again; MCAP version 0 is read");
    }
    let shown = &head[..head.len().min(24)];
    let is_text = !head.contains(&0)
        && std::str::from_utf8(shown)
            .is_ok_and(|text| !text.contains(|c: char| c.is_control() && !c.is_whitespace()));
    if is_text {
        let text = String::from_utf8_lossy(shown);
        return unknown(
            path,
            &format!("it is text without rows of numbers and begins {text:?}"),
            &format!("{FORMATS}, whatever the name; text needs one row a sample, in columns"),
        );
    }
    let hex: Vec<String> = shown.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    unknown(
        path,
        &format!("its first bytes are {}", hex.join(" ")),
        &format!("{FORMATS}, told by content, not by name; export the recording as one of these"),
    )
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
    fn rows_of_numbers_are_csv_with_any_delimiter_header_or_preamble() {
        for text in [
            "time_s,a1\n0,1.5\n1,2\n",
            "Logger 7\nDate;1.2.2026\n\nt;a\n0,1;2,5\n0,2;2,6\n",
            "0.1\t-3\n0.2\t-4\n",
            "a\n1\n",
            "when,a\n2026-01-01T00:00:00,1\n2026-01-01T00:00:01,2\n",
            "time_s,word\n0,ok\n1,bad\n",
            "t|a\n0|1\n1|2\n",
            "\"t\" \"a\"\n\"1\" 0 1\n\"2\" 1 2\n",
            "t;a\r0;1\r1;2\r",
            "t;a\n0;−1,5\n1;−2,5\n",
            "t;a\n0;1\n1;2\n\0\0\0\0",
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
            (
                b"Dear colleague,\nthe test is done.\nAll went well, we think, and so on.\n",
                "text without rows",
            ),
            (b"#ROSBAG V2.0\n", "ROS 1"),
            (b"[cask]\nname = \"x\"\n\n[[channel]]\n", "cask file"),
            (b"\x89MCA", "89 4d 43 41"),
            (b"\x89MCAP", "ends after 5 bytes"),
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
