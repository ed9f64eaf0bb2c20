//! From HDF5 files that do harm, or say what is no UTF-8, to one message or what they mean, and nothing of
//! any other file.

use crate::run::{Answer, dropcheck, fixture, fixtures, words};
use hdf5_metno::types::{FixedAscii, FixedUnicode, VarLenAscii, VarLenUnicode};
use hdf5_metno::{File, H5Type};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What stands in the files where bytes are to be that no `str` can be made of.
const PLACE: &str = "m/s#QQQQQQQ";

struct Made {
    folder: tempfile::TempDir,
    path: PathBuf,
}

/// An HDF5 file, without check sums over its parts.
fn made(fill: impl FnOnce(&File) -> hdf5_metno::Result<()>) -> Made {
    let folder = tempfile::tempdir().unwrap();
    let (path, written) = (folder.path().join("r.h5"), folder.path().join("written.h5"));
    let file = File::with_options().with_fapl(|access| access.libver_earliest()).create(&written).unwrap();
    fill(&file).unwrap();
    file.close().unwrap();
    // A program that another test starts meanwhile inherits the library's lock on the file, but not that of a
    // copy.
    std::fs::copy(written, &path).unwrap();
    Made { folder, path }
}

impl Made {
    /// Puts `new` where `old` stands, as often as it does.
    fn replace(&self, old: &[u8], mut new: impl FnMut() -> Vec<u8>) {
        let mut bytes = std::fs::read(&self.path).unwrap();
        let places: Vec<usize> = bytes
            .windows(old.len())
            .enumerate()
            .filter(|(_, found)| *found == old)
            .map(|(at, _)| at)
            .collect();
        assert!(!places.is_empty(), "nothing to replace");
        for at in places {
            let new = new();
            bytes[at..at + new.len()].copy_from_slice(&new);
        }
        std::fs::write(&self.path, bytes).unwrap();
    }

    fn inspect(&self) -> Answer {
        dropcheck(words!["inspect", self.path, "--json", "-"])
    }

    fn analyze(&self, source: &str) -> Answer {
        let text = std::fs::read_to_string(fixture("vhlw-rest.toml")).unwrap();
        let cask = self.folder.path().join("cask.toml");
        let text = text.replace("/daq/A1", source).replace("/daq/A2", "/b").replace("/daq/A3", "/x");
        std::fs::write(&cask, text).unwrap();
        crate::run::analyze(&self.path, &cask)
    }
}

fn samples(file: &File, name: &str) -> hdf5_metno::Result<hdf5_metno::Dataset> {
    let values: Vec<f32> = (0..3000_u16).map(f32::from).collect();
    file.new_dataset_builder().with_data(&values).create(name)
}

fn attribute<T: H5Type>(place: &hdf5_metno::Location, name: &str, value: &T) -> hdf5_metno::Result<()> {
    place.new_attr::<T>().create(name)?.write_scalar(value)
}

/// A file with text in every place that is read.
fn wordy() -> Made {
    #[derive(H5Type, Clone, Copy)]
    #[repr(C)]
    #[allow(non_snake_case, reason = "the name is what is replaced")]
    struct Record {
        QQQQQQQ: f32,
        b: f32,
    }
    made(|file| {
        let a = samples(file, "a")?;
        attribute(&a, "unit", &FixedAscii::<16>::from_ascii(PLACE).unwrap())?;
        attribute(&a, "units", &PLACE.parse::<VarLenUnicode>().unwrap())?;
        attribute(&a, "QQQQQQQ", &1.0)?;
        let b = samples(file, "b")?;
        attribute(&b, "unit", &VarLenAscii::from_ascii(PLACE).unwrap())?;
        attribute(&b, "fs", &PLACE.parse::<FixedUnicode<16>>().unwrap())?;
        attribute(file, "sample_rate_hz", &PLACE.parse::<VarLenUnicode>().unwrap())?;
        file.create_group("QQQQQQQ")?;
        samples(file, "QQQQQQQ/x")?;
        file.new_dataset_builder().with_data(&[Record { QQQQQQQ: 1.0, b: 2.0 }; 20]).create("r").map(drop)
    })
}

#[test]
fn text_that_is_not_utf_8_is_windows_1252() {
    let made = wordy();
    made.replace(PLACE.as_bytes(), || b"m/s\xb2\0\0\0\0\0\0\0".to_vec());
    let listing = made.inspect().json();
    let unit = |source: &str| {
        let channels = listing["channels"].as_array().unwrap();
        channels.iter().find(|channel| channel["source"] == source).unwrap()["unit"].clone()
    };
    assert_eq!((unit("/a").as_str(), unit("/b").as_str()), (Some("m/s²"), Some("m/s²")));
}

#[test]
fn random_bytes_in_every_text_are_read_or_refused() {
    let mut chance = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..24 {
        let made = wordy();
        made.replace(b"QQQQQQQ", || (0..7).map(|_| chance.random_range(1..=255)).collect());
        let answers = [made.inspect(), made.analyze("/a"), made.analyze("/r.b"), made.analyze("/c")];
        for answer in answers {
            match answer.status {
                0 | 1 => drop(answer.json()),
                2 => assert!(answer.stdout.is_empty() && answer.stderr.contains("help"), "{}", answer.stderr),
                other => panic!("exit status {other}"),
            }
        }
    }
}

#[test]
fn nothing_but_the_recording_is_read() {
    let other = made(|file| samples(file, "secret").map(drop));
    let raw = other.folder.path().join("raw.bin");
    std::fs::write(&raw, vec![7_u8; 12_000]).unwrap();
    let (raw, other) = (raw.to_str().unwrap(), other.path.to_str().unwrap().to_owned());
    let made = made(|file| {
        file.link_external(&other, "/secret", "link")?;
        file.link_soft("/link", "soft")?;
        file.new_dataset::<f32>().shape(3000).external(raw, 0, 12_000).create("raw")?;
        file.new_dataset::<f32>()
            .shape(3000)
            .virtual_map(&other, "secret", 3000, .., 3000, ..)
            .create("map")
            .map(drop)
    });
    for (source, reason) in [
        ("/link", "a link into another file, which is not followed"),
        ("/soft", "cannot be read"),
        ("/raw", "the data are in another file, which is not read"),
        ("/map", "it is put together from other datasets, which is not read"),
    ] {
        let answer = made.analyze(source);
        assert_eq!(answer.status, 2, "{source}: {}", answer.stderr);
        assert!(answer.stderr.contains(reason), "{source}: {}", answer.stderr);
    }
    let listing = made.inspect().json();
    for channel in listing["channels"].as_array().unwrap() {
        assert!(channel["unreadable"].is_string() && channel["range"].is_null(), "{channel}");
    }
}

#[test]
fn what_only_hdf5_2_stores_is_read() {
    let made = fixtures().join("reference/stored-by-hdf5-2.h5");
    let listing = dropcheck(words!["inspect", made, "--json", "-"]);
    let channel = &listing.json()["channels"][0];
    assert!(channel["samples"] == 100 && channel["range"].is_array(), "{channel}");
}

/// A file whose samples are packed by a filter that this program does not have.
fn packed_by_a_stranger() -> Made {
    let made = made(|file| {
        let values: Vec<f32> = (0..3000_u16).map(f32::from).collect();
        file.new_dataset_builder().lzf().chunk(500).with_data(&values).create("a").map(drop)
    });
    // The number of the filter, 32000, before the length of its name.
    made.replace(b"\x00\x7d\x08\x00", || b"\x0f\x7d\x08\x00".to_vec());
    made
}

#[cfg(unix)]
#[test]
fn no_plugin_runs() {
    let made = packed_by_a_stranger();
    let folder = made.folder.path();
    let (source, ran) = (folder.join("plugin.c"), folder.join("ran"));
    std::fs::write(
        &source,
        format!(
            "#include <stdio.h>\n\
             __attribute__((constructor)) static void run(void) {{ fclose(fopen({:?}, \"w\")); }}\n\
             int H5PLget_plugin_type(void) {{ return 0; }}\n\
             const void *H5PLget_plugin_info(void) {{ return 0; }}\n",
            ran.to_str().unwrap()
        ),
    )
    .unwrap();
    let mut compiler = Command::new("cc");
    compiler.args(["-shared", "-fPIC", "-o"]).arg(folder.join("libplugin.so")).arg(&source);
    assert!(compiler.status().expect("the C compiler that built HDF5").success());
    let report = folder.join("report");
    let run = |words: &[&std::ffi::OsStr]| {
        let program = Command::new(env!("CARGO_BIN_EXE_dropcheck"))
            .args(words)
            .envs([
                ("HDF5_PLUGIN_PATH", folder.as_os_str()),
                ("HDF5_VOL_CONNECTOR", "x".as_ref()),
                ("HDF5_DRIVER", "x".as_ref()),
            ])
            .output();
        program.expect("the program starts")
    };
    let inspected = run(&words!["inspect", made.path]);
    let shown = String::from_utf8(inspected.stdout).unwrap();
    let shown = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        shown.contains("packed by the filter number 32015, which is not read"),
        "{shown}{:?}",
        inspected.stderr
    );
    let (sound, cask) = (fixture("vhlw-rest.h5"), fixture("vhlw-rest.toml"));
    let analyzed = run(&words!["analyze", sound, "--cask", cask, "--out", report]);
    assert!(analyzed.status.success() && analyzed.stderr.is_empty(), "{analyzed:?}");
    assert!(report.join("curves.h5").exists() && !ran.exists());
}

/// Where Linux lets a process be traced: the files that are opened after the program of the C library has
/// begun.
#[cfg(target_os = "linux")]
#[test]
fn no_file_is_opened_but_the_recording() {
    let Ok(traced) = Command::new("strace").arg("-V").output() else {
        assert!(std::env::var_os("CI").is_none(), "strace is not installed");
        return;
    };
    assert!(traced.status.success());
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("trace");
    let (recording, cask) = (fixture("vhlw-rest.h5"), fixture("vhlw-rest.toml"));
    let status = Command::new("strace")
        .args(["-ff", "-e", "trace=open,openat,execve,seccomp,landlock_restrict_self", "-o"])
        .arg(&trace)
        .arg(env!("CARGO_BIN_EXE_dropcheck"))
        .args(words!["analyze", recording, "--cask", cask, "--json"])
        .arg("/dev/null")
        .output()
        .expect("strace runs");
    assert!(status.status.success(), "{status:?}");
    // One file a thread and process.
    let traces = std::fs::read_dir(folder.path()).unwrap().flatten();
    let traces: Vec<String> = traces.map(|entry| std::fs::read_to_string(entry.path()).unwrap()).collect();
    // The last two are what glibc's heap asks of the system where more than eight threads use it.
    let of_system = [
        "/proc/self/",
        "/sys/fs/cgroup/",
        "/etc/ld.so.",
        "/lib",
        "/usr/lib",
        "/dev/null",
        "/proc/sys/vm/overcommit_memory",
        "/sys/devices/system/cpu/online",
    ];
    let is_known = |path: &str| {
        of_system.iter().any(|place| path.starts_with(place))
            || [&recording, &cask].iter().any(|input| Path::new(path) == input.as_path())
    };
    let opens = |line: &&str| line.starts_with("open") && !line.contains("= -1");
    for line in traces.iter().flat_map(|trace| trace.lines()).filter(opens) {
        assert!(is_known(line.split('"').nth(1).unwrap_or_default()), "{line}");
    }
    let reader = traces.iter().find(|trace| trace.contains("\"__hdf5\"")).expect("a process for the library");
    let (_, walled) = reader.split_once("seccomp(").expect("a wall");
    let opened: Vec<&str> = walled.lines().filter(opens).collect();
    assert!(opened.len() == 1 && opened[0].contains("vhlw-rest.h5"), "{opened:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_missing_wall_is_told_and_no_soft_link_followed_without_it() {
    if Command::new("strace").arg("-V").output().is_err() {
        assert!(std::env::var_os("CI").is_none(), "strace is not installed");
        return;
    }
    let made = made(|file| {
        samples(file, "a")?;
        file.link_external("other.h5", "/x", "e")?;
        file.link_soft("/e", "s")
    });
    let trace = made.folder.path().join("trace");
    let mut strace = Command::new("strace");
    strace.args(["-f", "-e", "trace=open,openat,landlock_create_ruleset"]);
    strace.args(["-e", "inject=landlock_create_ruleset:error=ENOSYS", "-o"]).arg(&trace);
    let inspect = words!["inspect", made.path, "--json", "-"];
    let answer = strace.arg(env!("CARGO_BIN_EXE_dropcheck")).args(inspect).output().expect("strace runs");
    let told = String::from_utf8(answer.stdout).unwrap();
    assert!(
        told.contains("which this system keeps from no other file") && told.contains("a soft link"),
        "{told}"
    );
    assert!(!std::fs::read_to_string(&trace).unwrap().contains("other.h5"));
    assert!(!made.inspect().stdout.contains("keeps from no other file"));
}

/// A key of the index of chunks, changed so that the library does not find the last of A1 and reads zeros.
#[test]
fn samples_of_a_chunk_that_the_index_does_not_lead_to_are_named() {
    let mut bytes = std::fs::read(fixture("vhlw-rest.h5")).unwrap();
    let node = bytes.windows(5).position(|five| five == b"TREE\x01").unwrap();
    bytes[node + 24 + 3 * 32 + 22] = 0xff;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.h5");
    std::fs::write(&path, bytes).unwrap();
    let answer = crate::run::analyze(&path, &fixture("vhlw-rest.toml"));
    assert!(
        answer.status == 2 && answer.stderr.contains("/daq/A1 lacks its samples 12865 to 17149"),
        "{}",
        answer.stderr
    );
}
