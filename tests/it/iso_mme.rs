//! From one drop as CSV and as ISO-MME, folder and zip, to the same result; from what pyisomme writes to its
//! samples.

use crate::run::{analyze, dropcheck, fixture, number, words};
use crate::same::cask;
use crate::stored::stored;
use dropcheck::ingest;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const CODES: [&str; 2] = ["T0CASK00L100ACZ0", "T0CASK00R100ACZ0"];

/// The files of the drop in `anf10-plain.csv`, by their names.
pub fn drop_files() -> Vec<(String, String)> {
    let table = fs::read_to_string(fixture("anf10-plain.csv")).expect("a fixture");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let mut files = vec![("T1.mme".to_owned(), "Data format edition number :1.6\n".to_owned())];
    let mut index = "Number of channels :2\n".to_owned();
    for (number, code) in (1..).zip(CODES) {
        let mut text = format!(
            "Channel code :{code}\nUnit :g\nSampling interval :0.00008\nTime of first sample :0\nNumber of \
             samples :{}\n",
            rows.len()
        );
        for row in &rows {
            writeln!(text, "{}", row[number]).expect("a text");
        }
        writeln!(index, "Name of channel {number:03} :{code}").expect("a text");
        files.push((format!("Channel/T1.{number:03}"), text));
    }
    files.push(("Channel/T1.chn".to_owned(), index));
    files
}

/// A zip of files, each deflated.
fn zipped(files: &[(String, String)]) -> Vec<u8> {
    let (mut zip, mut list) = (Vec::new(), Vec::new());
    for (name, text) in files {
        let mut packed = vec![0; text.len() + 64];
        let mut packer = libdeflater::Compressor::new(libdeflater::CompressionLvl::default());
        let count = packer.deflate_compress(text.as_bytes(), &mut packed).expect("room");
        packed.truncate(count);
        let [sum, bytes] = [crc32fast::hash(text.as_bytes()), text.len().try_into().expect("short")];
        let sizes = [sum, packed.len().try_into().expect("short"), bytes].map(u32::to_le_bytes).concat();
        let length = u16::try_from(name.len()).expect("short").to_le_bytes();
        // Version, flags, method, time and date; then check sum, sizes, lengths of name and extras.
        let shared = [&[20, 0, 0, 0, 8, 0, 0, 0, 0x21, 0x5a][..], &sizes, &length, &[0, 0]].concat();
        let at = u32::try_from(zip.len()).expect("short").to_le_bytes();
        list.extend([&b"PK\x01\x02\x14\0"[..], &shared, &[0; 10], &at, name.as_bytes()].concat());
        zip.extend([&b"PK\x03\x04"[..], &shared, name.as_bytes(), &packed].concat());
    }
    let count = u16::try_from(files.len()).expect("few").to_le_bytes();
    let [bytes, at] = [list.len(), zip.len()].map(|size| u32::try_from(size).expect("short").to_le_bytes());
    [&zip[..], &list, b"PK\x05\x06\0\0\0\0", &count, &count, &bytes, &at, &[0, 0]].concat()
}

/// Writes files into a folder, and the cask file of the drop beside it, whose path is returned.
pub fn written(files: &[(String, String)], folder: &Path) -> PathBuf {
    fs::create_dir_all(folder.join("Channel")).expect("a folder");
    for (name, text) in files {
        fs::write(folder.join(name), text).expect("a file");
    }
    let mut cask = fs::read_to_string(fixture("anf10-plain.toml")).expect("a fixture");
    for (source, code) in ["A1", "A2"].iter().zip(CODES) {
        cask = cask.replace(&format!("source = \"{source}\""), &format!("source = \"{code}\""));
    }
    fs::write(folder.with_extension("toml"), cask).expect("a cask file");
    folder.with_extension("toml")
}

#[test]
fn one_drop_as_csv_folder_and_zip_has_one_speed() {
    let place = tempfile::tempdir().expect("a folder");
    let [folder, zip] = ["T1", "T1.zip"].map(|name| place.path().join(name));
    let files = drop_files();
    let cask = written(&files, &folder);
    fs::write(&zip, zipped(&files)).expect("a zip");
    let table = analyze(&fixture("anf10-plain.csv"), &fixture("anf10-plain.toml")).json();
    for recording in [&folder, &zip] {
        let result = analyze(recording, &cask).json();
        assert_eq!(result["input"]["format"], "ISO-MME");
        assert_eq!(result["input"]["recording_sha256"], ingest::sha256(recording).expect("a hash"));
        for pointer in ["/slap_down/speed/value", "/k/value"] {
            let half = number(&table, &pointer.replace("value", "u95")).expect("a half-width");
            let [own, other] = [&result, &table].map(|result| number(result, pointer).expect("a number"));
            assert!((own - other).abs() < 1e-3 * half, "{pointer}: {own} for {other} ± {half}");
        }
        let listed = dropcheck(words!["inspect", recording, "--json", "-"]).json();
        assert_eq!(listed["channels"][1]["source"], CODES[1]);
        let form = dropcheck(words!["init", recording]).stdout;
        assert!(form.contains(&format!("source = \"{}\"", CODES[0])), "{form}");
        assert!(form.contains("acceleration, vertical (Z), unfiltered (0)"), "{form}");
    }
    // A campaign takes the folder by itself and by the folder that it lies in.
    for paths in [&folder, place.path()] {
        let answer = dropcheck(words!["batch", paths, "--cask", cask, "--jsonl", "-"]);
        assert!(answer.stdout.lines().all(|line| line.contains("\"ISO-MME\"")), "{}", answer.stderr);
        assert_eq!(answer.stdout.lines().count(), if paths == folder { 1 } else { 2 });
    }
    let manifest = place.path().join("runs.csv");
    fs::write(&manifest, "recording\nT1\n").expect("a manifest");
    assert!(dropcheck(words!["batch", "--manifest", manifest, "--jsonl", "-"]).status < 2);
    // Nothing is written into the recording.
    let refused = dropcheck(words!["analyze", folder, "--cask", cask, "--out", folder]);
    assert!(refused.status == 2 && refused.stderr.contains("input"), "{}", refused.stderr);
    let refused = dropcheck(words!["batch", folder, "--cask", cask, "--out", place.path()]);
    assert!(refused.status == 2 && !folder.join("report.html").exists(), "{}", refused.stderr);
}

#[test]
fn what_pyisomme_writes_is_read_to_the_last_digit() {
    let place = tempfile::tempdir().expect("a folder");
    let [zip, path] = ["T1.zip", "T1.toml"].map(|name| place.path().join(name));
    fs::write(&zip, &stored("odd/mme.jsonl")["mme/by_pyisomme-0.zip"]).expect("a zip");
    let sources = [CODES[0], "T0CASK00R100ACZA.002", "T0CASK00R100ACZA.003"];
    fs::write(&path, cask(&sources.map(|source| format!("source = \"{source}\"\n")))).expect("a cask file");
    let file = ingest::cask_file(&path).expect("a cask file");
    let read = dropcheck::read(&zip, &file, &|_| ()).expect("a recording");
    for (number, channel) in (0_u8..).zip(&read.channels) {
        // Those of `fixtures/reference/iso_mme.py`.
        let written = (0..48).map(|i| (f64::from(i * i32::from(37 + number) % 101) - 50.0) / 8.0);
        for (at, written) in written.enumerate() {
            let own = channel.samples.get(at);
            assert!(
                if (number, at) == (2, 5) { own.is_nan() } else { own.total_cmp(&written).is_eq() },
                "{number}, {at}: {own}"
            );
        }
        assert_eq!((channel.sample_rate_hz, channel.start_s, channel.samples.len()), (1000.0, 0.0, 48));
        assert_eq!(channel.unit, ["g", "m / s2", "m / s2"][usize::from(number)]);
    }
}
