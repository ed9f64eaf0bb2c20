//! First bytes of files that are no recording read here to their name, and to how to make one of them.

use Remedy::{Library, Lines, Words};

/// How to make a recording that is read here of a file of another format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Remedy {
    /// The word for a format that a library of its field reads, and the lines for a shell by which it does.
    Library(&'static str, &'static str),
    /// Lines for a shell. What a library warns of ends them; a number that no file states is to be filled in.
    Lines(&'static str),
    /// What to do.
    Words(&'static str),
}

impl Remedy {
    /// What to write or do; who has a page alone has no shell.
    pub(super) fn text(self) -> &'static str {
        match self {
            Library(..) | Lines(_) if cfg!(not(feature = "native")) => BY_ITS_PROGRAM,
            Library(_, text) | Lines(text) | Words(text) => text,
        }
    }
}

const BY_ITS_PROGRAM: &str = "export the channels from the program that wrote it as CSV, HDF5 or MCAP";
const EXPORT: Remedy = Words(BY_ITS_PROGRAM);
const UNPACK: Remedy = Words("unpack it first, and name the file that was in it");
const SHEET: Remedy = Words("save the sheet as CSV");
const TDMS: Remedy = Library("tdms", include_str!("convert/tdms.txt"));
const MDF: Remedy = Library("mdf", include_str!("convert/mdf.txt"));
const UFF: Remedy = Library("uff", include_str!("convert/uff.txt"));
const MATLAB: Remedy = Library("mat", include_str!("convert/matlab.txt"));
const IDE: Remedy = Library("ide", include_str!("convert/ide.txt"));
const ARROW: Remedy = Lines(include_str!("convert/arrow.txt"));
const JSON: Remedy = Lines(include_str!("convert/json.txt"));
const NETCDF: Remedy = Lines(include_str!("convert/netcdf.txt"));

/// Where a mark stands, its bytes, what the file is, and what to do with it.
#[rustfmt::skip]
const MARKS: [(usize, &[u8], &str, Remedy); 32] = [
    (0, b"#ROSBAG", "a ROS 1 bag", Words("convert it to MCAP: `mcap convert in.bag out.mcap`")),
    (0, b"SQLite format 3", "a SQLite file, perhaps a ROS 2 bag",
     Words("convert it to MCAP: `ros2 bag convert` or `mcap convert`")),
    (0, b"TDSm", "a TDMS file", TDMS),
    (0, b"TDSh", "the index of a TDMS file",
     Words("name the file beside it that holds the samples, exported as CSV or HDF5")),
    (0, b"MDF ", "an ASAM MDF file", MDF),
    (0, b"UnFinMF", "an unfinalised ASAM MDF file", MDF),
    (0, b"MATLAB 5.0", "a MATLAB file before version 7.3", MATLAB),
    (0, b"PK\x03\x04", "a ZIP archive that was cut or holds no .mme file, or an office document",
     Words("unpack it, or save the sheet as CSV")),
    (0, b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "an office document (.xls, .doc)", SHEET),
    (0, b"%PDF", "a PDF document", EXPORT),
    (0, b"\x1f\x8b", "a gzip archive", Words("unpack it first: `gunzip FILE`")),
    (0, b"\xFD7zXZ\0", "an xz archive", UNPACK),
    (0, b"BZh", "a bzip2 archive", UNPACK),
    (0, b"\x28\xB5\x2F\xFD", "a Zstandard archive", UNPACK),
    (0, b"\x04\x22\x4D\x18", "an LZ4 archive", UNPACK),
    (0, b"7z\xBC\xAF\x27\x1C", "a 7-Zip archive", UNPACK),
    (0, b"PAR1\x15", "a Parquet file", Lines(include_str!("convert/parquet.txt"))),
    (0, b"ARROW1\0", "an Arrow file", ARROW),
    (0, b"FEA1\0", "a Feather file", ARROW),
    (0, b"\x93NUMPY", "a NumPy array", Lines(include_str!("convert/numpy.txt"))),
    (0, b"CDF\x01", "a netCDF file before version 4", NETCDF),
    (0, b"CDF\x02", "a netCDF file before version 4", NETCDF),
    (8, b"WAVE", "a WAV sound file, which states no unit", Lines(include_str!("convert/wav.txt"))),
    (0, b"\x1A\x45\xDF\xA3", "an EBML file, such as .ide of an enDAQ or Slam Stick recorder", IDE),
    (0, b"|CF,", "an imc FAMOS file", EXPORT),
    (0, b"|CB,", "an imc FAMOS file", EXPORT),
    (0, b"DIAEXTENDED HEADER", "the header of a DIAdem file", EXPORT),
    (0, b"\x89MCAP0\n", "an MCAP file that lost bytes in a copy made in text mode",
     Words("copy it from the logger again, in binary mode")),
    (0, b"\x89PNG", "a picture", EXPORT),
    (0, b"\xFF\xD8\xFF", "a picture", EXPORT),
    (0, b"{\\rtf", "a text document (RTF)", EXPORT),
    (0, b"\x7FELF", "a program", Words("name the recording here")),
];

/// What lines of files in ISO-MME begin with.
const OF_MME: [&str; 4] =
    ["Test object number", "Name of the channel", "Name of channel ", "Data format edition number"];

/// What a file that begins so is and what to do, where it is known to be no recording read here.
pub(super) fn named(head: &[u8]) -> Option<(&'static str, Remedy)> {
    let has_mark = |(at, mark, ..): &&(usize, &[u8], &str, Remedy)| {
        head.get(*at..).is_some_and(|from| from.starts_with(mark))
    };
    let found = MARKS.iter().find(has_mark).map(|(_, _, what, mend)| (*what, *mend));
    found
        .or_else(|| is_matlab_4(head).then_some(("a MATLAB file of version 4", MATLAB)))
        .or_else(|| sheet(head))
}

/// A matrix of version 4: five whole numbers of four bytes for type, rows, columns, imaginary part and length
/// of the name, which follows with a zero byte (MathWorks, MAT-file format, appendix on level 4).
fn is_matlab_4(head: &[u8]) -> bool {
    let is_level_4 = |read: fn([u8; 4]) -> u32, least_type: u32| {
        let [kind, rows, columns, imaginary, length] = head.as_chunks().0.first_chunk()?.map(read);
        let kind = kind.checked_sub(least_type)?;
        let (end, name) = head.get(20..20 + length.min(64) as usize)?.split_last()?;
        let is_name = name.iter().all(|&byte| byte == b'_' || byte.is_ascii_alphanumeric());
        let is_type = kind <= 52 && kind % 10 <= 2 && imaginary <= 1;
        Some(is_type && rows > 0 && columns > 0 && *end == 0 && !name.is_empty() && is_name)
    };
    [is_level_4(u32::from_le_bytes, 0), is_level_4(u32::from_be_bytes, 1000)].contains(&Some(true))
}

/// Texts with numbers in them that are no table of samples.
fn sheet(head: &[u8]) -> Option<(&'static str, Remedy)> {
    let text = String::from_utf8_lossy(head);
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let (first, second) = (lines.next()?, lines.next().unwrap_or_default());
    // `-1` opens a data set, whose number follows: 58 holds samples, wrapped over lines; `58b` holds them in
    // binary.
    let number = second.split_whitespace().next().unwrap_or_default().trim_end_matches('b');
    if first == "-1" && (1..=4).contains(&number.len()) && number.bytes().all(|byte| byte.is_ascii_digit()) {
        return Some(("a universal file (UFF)", UFF));
    }
    let begin = format!("{first}{second}").replace(' ', "");
    if begin.starts_with("{\"") || begin.starts_with("[{") {
        return Some(("a JSON text", JSON));
    }
    if OF_MME.iter().any(|name| first.starts_with(name) || text.contains(&format!("\n{name}"))) {
        return Some((
            "a file of a test in ISO-MME (ISO/TS 13499)",
            Words("name the folder of its .mme file, or a zip of that folder"),
        ));
    }
    if first.starts_with(['-', '#']) && first.contains("EV5") {
        return Some((
            "an EV5 test sheet, which lists a test",
            Words("name the files of samples that it lists, exported as CSV"),
        ));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_programs_are_named() {
        let matlab = |words: [u32; 5], bytes: fn(u32) -> [u8; 4]| {
            words.into_iter().flat_map(bytes).chain(*b"acc\0\x01\x02").collect::<Vec<u8>>()
        };
        for (head, part) in [
            (b"RIFF\x24\0\0\0WAVEfmt ".to_vec(), "WAV"),
            (b"PAR1\x15\x04".to_vec(), "Parquet"),
            (b"[\n { \"t\": 0,\n".to_vec(), "JSON"),
            (b"{\"t\":0,\"A1\":[1,2,3]}\n{\"t\":1,\"A1\":[1,2,3]}\n".to_vec(), "JSON"),
            (b"    -1\n    58\nA1\n".to_vec(), "UFF"),
            (b"    -1\r\n   58b     1     2\r\n".to_vec(), "UFF"),
            (b"    -1\n   151\nmodel\n".to_vec(), "UFF"),
            (matlab([0, 1000, 1, 0, 4], u32::to_le_bytes), "version 4"),
            (matlab([1000, 1000, 1, 0, 4], u32::to_be_bytes), "version 4"),
        ] {
            assert!(named(&head).is_some_and(|(what, _)| what.contains(part)), "{part}");
        }
        for table in [
            &b"-1\n58.5\n60\n"[..],
            b"-1;58\n-2;59\n",
            b"t;a\n0;1\n",
            b"\0\0\0\0\x01\0\0\0\x01\0\0\0\0\0\0\0\x02\0\0\0\x01\0",
        ] {
            assert_eq!(named(table), None);
        }
    }
}
