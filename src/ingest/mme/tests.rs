//! Tests in ISO-MME, sound and odd, to what is read of them or refused by file and line.

use crate::data::{CaskFile, Recording, Unit};
use crate::ingest::mcap::written::cask_file;
use crate::ingest::{Limits, list, read_within, sha256};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const INDEX: &str = "Number of channels :3\nName of channel 001 :T0CASK01L1LEACX0 / left, along\n\
                     Name of channel 002 :T0CASK01L1LEACX0\nName of channel 003 :T0CASK01R1LEFOZA/right\n";
const HEADER: &str = "Name of the channel :left\nChannel code :T0CASK01L1LEACX0\nUnit :m/(s*s)\n\
                      Reference channel :implicit\nSampling interval :0.001\nTime of first sample :-0.002\n\
                      Number of samples :4\nData status :ok\n";

/// A test whose first channel is `first`, the second the same at 2 ms, the third a force.
fn test_of(index: &str, first: impl AsRef<[u8]>) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let channel = folder.path().join("CHANNEL");
    fs::create_dir(&channel).unwrap();
    let force = HEADER.replace("L1LEACX0", "R1LEFOZA").replace("m/(s*s)", "kN") + "1\n2\n3\n4\n";
    let second = HEADER.replace(":-0.002", ":0") + "1\n2\n3\n4\n";
    fs::write(folder.path().join("T1.MME"), "Title :Prüfung\n").unwrap();
    fs::write(channel.join("T1.CHN"), index).unwrap();
    fs::write(channel.join("t1.001"), first).unwrap();
    fs::write(channel.join("t1.002"), second).unwrap();
    fs::write(channel.join("t1.003"), force).unwrap();
    folder
}

fn read_of(folder: &Path, sources: &[&str]) -> Result<Recording, String> {
    read_within(folder, &cask_file(sources), Limits::default(), &|_| ()).map_err(|error| error.to_string())
}

fn samples(recording: &Recording) -> Vec<f64> {
    let samples = &recording.channels[0].samples;
    (0..samples.len()).map(|i| samples.get(i)).collect()
}

#[test]
fn rate_start_unit_and_samples_are_the_files() {
    let folder = test_of(INDEX, HEADER.to_owned() + "0.5\n-1.25e1\n 3 \n+4\n");
    let read = read_of(folder.path(), &["T0CASK01L1LEACX0.002", "T0CASK01L1LEACX0.001"]).unwrap();
    let [second, first] = &read.channels[..] else { panic!() };
    assert_eq!((first.sample_rate_hz, first.start_s, second.start_s), (1000.0, 0.0, 0.002));
    assert_eq!((first.scale_m_s2, first.unit.as_str(), first.is_unit_recorded), (1.0, "m/(s*s)", true));
    let first = read_of(folder.path(), &["T0CASK01L1LEACX0.001"]).unwrap();
    assert_eq!(samples(&first), [0.5, -12.5, 3.0, 4.0]);
    assert!(first.issues.is_empty(), "{:?}", first.issues);
}

#[test]
fn the_hash_of_a_folder_is_that_of_the_list_that_sha256sum_prints() {
    let folder = test_of(INDEX, "");
    fs::write(folder.path().join("CHANNEL/channel.txt"), "a remark").unwrap();
    let names = ["T1.MME", "CHANNEL/T1.CHN", "CHANNEL/t1.001", "CHANNEL/t1.002", "CHANNEL/t1.003"];
    let line = |name: &str| format!("{}  {name}\n", sha256(&folder.path().join(name)).unwrap());
    let printed = folder.path().join("printed");
    fs::write(&printed, names.map(line).concat()).unwrap();
    assert_eq!(sha256(folder.path()).unwrap(), sha256(&printed).unwrap());
}

#[test]
fn what_a_file_states_is_applied_or_refused_by_its_line() {
    let numbers = "0.5\n1\n2\n3\n";
    let with = |from: &str, to: &str| HEADER.replace(from, to) + numbers;
    for (first, part) in [
        (
            with("samples :4", "samples :3"),
            "CHANNEL/t1.001, line 12: it is number 4, and Number of samples is 3",
        ),
        (with("samples :4", "samples :four"), "line 7: Number of samples is \"four\", which is no number"),
        (with("L1LE", "L2LE"), "line 2: Channel code is \"T0CASK01L2LEACX0\", and the index states another"),
        (
            with("status :ok", "status :Channel failed"),
            "line 8: Data status is \"Channel failed\", and samples",
        ),
        (with("status :ok", "status :ok\nUnit :g"), "line 9: Unit is \"g\", and a line above states another"),
        (with(":-0.002", ":-2 ms"), "line 6: Time of first sample is \"-2 ms\", which is no number"),
        (with("interval :0.001", "interval :NOVALUE"), "CHANNEL/t1.001: Sampling interval is not stated"),
        (with("interval :0.001", "interval :0"), "CHANNEL/t1.001: Sampling interval is 0"),
        (with(":implicit", ":explicit"), "CHANNEL/t1.001: its times stand in another channel"),
        (with("Unit :m/(s*s)\n", ""), "neither the recording nor the cask file says the unit"),
        (with("m/(s*s)", "furlong"), "which is no unit of acceleration known here"),
        (HEADER.to_owned() + "0.5\n1,5\n", "line 10: \"1,5\" is no number with a decimal point"),
        (HEADER.to_owned() + "0.5\n\n2\n", "line 10: it is empty, and numbers follow"),
        (HEADER.to_owned() + "0.5 1\n", "line 9: \"0.5 1\" is no number"),
        (HEADER.to_owned(), "0 sample(s) make no record"),
        (with("", "a :b\n").repeat(2000), "is no number"),
    ] {
        let folder = test_of(INDEX, first);
        let refused = read_of(folder.path(), &["T0CASK01L1LEACX0.001"]).unwrap_err();
        assert!(refused.contains(part), "{part}: {refused}");
    }
    for (sources, part) in [
        (&["T0CASK01L1LEACX0"][..], "the index lists no channel \"T0CASK01L1LEACX0\""),
        (&["T0CASK01R1LEFOZA"], "\"kN\", which is no unit of acceleration"),
    ] {
        let refused = read_of(test_of(INDEX, with("", "")).path(), sources).unwrap_err();
        assert!(refused.contains(part), "{part}: {refused}");
    }
}

#[test]
fn files_that_are_missing_or_doubled_are_refused_by_name() {
    let sound = HEADER.to_owned() + "1\n2\n3\n4\n";
    let wanted = &["T0CASK01L1LEACX0.001"];
    let without = |name: &str| {
        let folder = test_of(INDEX, &sound);
        fs::remove_file(folder.path().join(name)).unwrap();
        read_of(folder.path(), wanted).unwrap_err()
    };
    assert!(without("T1.MME").contains("this is a directory, not a recording"));
    assert!(without("CHANNEL/T1.CHN").contains("beside T1.MME there is no index, Channel/….chn"));
    assert!(without("CHANNEL/t1.001").contains("there is no Channel/….001"));
    for name in ["T2.mme", "CHANNEL/T1.1", "CHANNEL/t1.chn"] {
        let folder = test_of(INDEX, &sound);
        fs::write(folder.path().join(name), "").unwrap();
        let refused = read_of(folder.path(), wanted).unwrap_err();
        assert!(refused.contains("its files: it holds ") && refused.contains(name), "{refused}");
    }
    let twice = INDEX.replace("channel 002", "channel 1");
    let refused = read_of(test_of(&twice, &sound).path(), wanted).unwrap_err();
    assert!(refused.contains("CHANNEL/T1.CHN, line 3: channel 1 is listed a second time"), "{refused}");
    // A Mac's remark on a file is none, and a channel that is not wanted may be anything.
    let folder = test_of(INDEX, &sound);
    fs::write(folder.path().join("._T1.mme"), "").unwrap();
    fs::write(folder.path().join("CHANNEL/t1.003"), "\0").unwrap();
    assert!(read_of(folder.path(), wanted).is_ok());
}

#[test]
fn what_is_missing_or_cut_is_told() {
    let read_and_told = |first: &str| {
        let read = read_of(test_of(INDEX, first).path(), &["T0CASK01L1LEACX0.001"]).unwrap();
        (
            samples(&read).len(),
            read.issues.into_iter().map(|issue| issue.message).collect::<Vec<_>>().join("; "),
        )
    };
    let whole = HEADER.to_owned() + "1\nNOVALUE\n3\n4";
    let (count, told) = read_and_told(&whole);
    assert!(count == 4 && told.contains("1 sample") && !told.contains("line"), "{told}");
    let (count, told) = read_and_told(&(HEADER.to_owned() + "1\n2\n3"));
    assert!(count == 2 && told.contains("line 11, the last, ends in the middle"), "{told}");
    assert!(told.contains("state 4 samples, and it has 3 rows"), "{told}");
    let (count, told) = read_and_told(&(HEADER.to_owned() + "1\n2\n3\n\0\0\0"));
    assert!(count == 3 && told.contains("from line 12 on stand zero bytes"), "{told}");
    assert_eq!(
        read_and_told(&(HEADER.to_owned() + "1\n2\n3\0\0\0")).0,
        2,
        "a number before zero bytes may be cut"
    );
    let (count, told) = read_and_told(&(whole.replace("samples :4", "samples :NOVALUE") + "\n\n"));
    assert!(count == 4 && !told.contains("line"), "{told}");
}

#[test]
fn any_encoding_and_end_of_line_is_read() {
    let text = "Comments :größer\n".to_owned() + HEADER + "1\n2\n3\n4\n";
    let latin = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect::<Vec<u8>>();
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let marked = format!("\u{feff}{text}").into_bytes();
    for first in [latin, wide, marked, text.replace('\n', "\r\n").into(), text.replace('\n', "\r").into()] {
        let folder = test_of(INDEX, &first);
        let read = read_of(folder.path(), &["T0CASK01L1LEACX0.001"]).unwrap();
        assert_eq!(samples(&read), [1.0, 2.0, 3.0, 4.0], "{}", first.escape_ascii());
    }
}

#[test]
fn the_cask_file_gives_what_the_files_lack_and_asks_for_no_more_than_there_is() {
    let none = HEADER.replace("interval :0.001", "interval :").replace("m/(s*s)", "NOVALUE");
    let folder = test_of(INDEX, none.replace(":-0.002", ":NOVALUE") + "1\n2\n3\n4\n");
    let mut cask = cask_file(&["T0CASK01L1LEACX0.001"]);
    cask.channels[0].sample_rate_hz = Some(500.0);
    cask.channels[0].unit = Some(Unit::G);
    let read = |cask: &CaskFile| {
        read_within(folder.path(), cask, Limits::default(), &|_| ()).map_err(|error| error.to_string())
    };
    let channel = &read(&cask.clone()).unwrap().channels[0];
    assert_eq!((channel.sample_rate_hz, channel.start_s), (500.0, 0.0));
    let mut both = cask.clone();
    both.channels.push(cask_file(&["T0CASK01L1LEACX0.002"]).channels.remove(0));
    assert!(read(&both).unwrap_err().contains("its file has no line Time of first sample"));
    cask.time = Some("t".into());
    assert!(read(&cask).unwrap_err().contains("`where` or `time` is stated"));
}

#[test]
fn a_code_that_says_another_quantity_than_the_unit_is_refused() {
    let index = INDEX.replace("L1LEACX0 / left", "L1LEFOX0 / left");
    let folder = test_of(&index, HEADER.replace("ACX0", "FOX0") + "1\n2\n3\n4\n");
    let mut cask = cask_file(&["T0CASK01L1LEFOX0"]);
    let refused = read_within(folder.path(), &cask, Limits::default(), &|_| ()).unwrap_err().to_string();
    assert!(refused.contains("its unit is one of acceleration, and its code says force"), "{refused}");
    cask.channels[0].unit = Some(Unit::MetrePerSecondSquared);
    assert!(read_within(folder.path(), &cask, Limits::default(), &|_| ()).is_ok());
}

#[test]
fn a_listing_has_every_channel_with_what_its_code_says() {
    let folder = test_of(INDEX, HEADER.to_owned() + "1\nNOVALUE\n-3\n4\n");
    fs::remove_file(folder.path().join("CHANNEL/t1.002")).unwrap();
    let listing = list(folder.path(), &|_| ()).unwrap();
    let [first, second, third] = &listing.channels[..] else { panic!() };
    assert_eq!(first.source, "T0CASK01L1LEACX0.001");
    let of_first = (first.samples, first.sample_rate_hz, first.start_s, first.range);
    assert_eq!(of_first, (Some(4), Some(1000.0), Some(-0.002), Some((-3.0, 4.0))));
    let said = "UTF-8; acceleration, longitudinal (X), unfiltered (0), at T 0 CASK 01 L1 LE; left, along";
    assert_eq!(first.encoding, said);
    assert_eq!(listing.issues[0].channel.as_deref(), Some("T0CASK01L1LEACX0.001"));
    let reason = "its files: beside T1.MME there is no Channel/….002: copy or export the test again, with \
                  all its files";
    assert_eq!(second.unreadable.as_deref(), Some(reason));
    assert_eq!((third.source.as_str(), third.unit.as_deref()), ("T0CASK01R1LEFOZA", Some("kN")));
}

#[test]
fn a_limit_is_named() {
    let folder = test_of(INDEX, HEADER.replace("samples :4", "samples :") + &"1\n".repeat(3 << 20));
    let read =
        |sources: &[&str]| read_within(folder.path(), &cask_file(sources), Limits::of_memory(0), &|_| ());
    let refused = read(&["T0CASK01L1LEACX0.001"]).unwrap_err().to_string();
    assert!(refused.contains("CHANNEL/t1.001 takes more than 4 MiB"), "{refused}");
    assert!(read(&["T0CASK01L1LEACX0.002"]).is_ok());
}
