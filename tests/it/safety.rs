//! From names and sizes made to harm, full disks and killed runs to reports that are whole, clean and in
//! their place.

use crate::command_line::{Bench, at_fault};
use crate::run::{dropcheck, fixture, tree};
use std::ffi::OsString;
use std::fs;
use std::path::Path;

/// The words of an analysis of fixture `stem` in `recording` into `out`.
fn words(recording: &Path, cask: &Path, out: &Path) -> Vec<OsString> {
    let options = [recording, Path::new("--cask"), cask, Path::new("--out"), out];
    std::iter::once("analyze".into()).chain(options.map(|part| part.as_os_str().to_owned())).collect()
}

const EVIL: [&str; 5] = [
    "\\uFFFF\\uFFFE",
    "<script>alert(1)</script>",
    "=cmd|'/C calc'!A0",
    "../../../escape\\u001b]0;title\\u0007\\u009b2J\\u202e",
    "\\\"><img src=x onerror=alert(1)>",
];

/// Asserts that a file of a report can be opened by anyone.
fn harmless(path: &Path, bytes: Vec<u8>) {
    let ending = path.extension().expect("an ending").to_string_lossy().into_owned();
    if ["h5", "mcap"].contains(&ending.as_str()) {
        return;
    }
    let text = String::from_utf8(bytes).expect("UTF-8");
    assert!(!text.contains(['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}']), "{}", path.display());
    if ["html", "svg"].contains(&ending.as_str()) {
        // XML 1.0 has no such characters; JSON and text do.
        assert!(!text.contains(['\u{ffff}', '\u{fffe}']), "{}", path.display());
        assert!(!text.contains("<script>alert") && !text.contains("<img src=x"), "{}", path.display());
        // A report has its own scripts, by whose hashes alone it runs them, and the numbers of its charts.
        let own =
            text.matches("<script>").count() + text.matches("<script type=\"application/json\"").count();
        assert!(text.matches("<script").count() == own, "{}", path.display());
        assert!(text.matches("<script>").count() == 2 * usize::from(ending == "html"), "{}", path.display());
    }
    if ending == "csv" {
        let mut table = csv::Reader::from_reader(text.as_bytes());
        let header = table.headers().expect("a header").clone();
        assert!(header.iter().all(|cell| !cell.starts_with(['=', '+', '-', '@'])), "{header:?}");
        let names = usize::from(&header[0] == "channel");
        // Numbers stay numbers, negative ones too.
        for row in table.records().flatten() {
            assert!(row.iter().take(names).all(|name| !name.starts_with(['=', '+', '-', '@'])), "{row:?}");
            let mut numbers = row.iter().skip(names);
            assert!(numbers.all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok()), "{row:?}");
        }
    }
}

#[test]
fn names_in_a_file_stay_names() {
    let bench = Bench::new();
    let sound = fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    for (number, evil) in EVIL.iter().enumerate() {
        let mut text = sound.replace("name = \"A1\"", &format!("name = \"{evil}\""));
        text = text.replace("[cask]\n", &format!("[cask]\n# {number}\n"));
        let cask_name = sound.lines().find(|line| line.starts_with("name = ")).expect("a name");
        text = text.replacen(cask_name, &format!("name = \"{evil}\""), 1);
        assert_ne!(text, sound);
        let cask = bench.put("cask <b>.toml", text);
        let place = bench.0.path().join("place");
        let out = place.join("a/b");
        let answer = dropcheck(words(&fixture("anf18-json.mcap"), &cask, &out));
        assert!(answer.status < 2, "{}", answer.stderr);
        let printed = format!("{}{}", answer.stdout, answer.stderr);
        assert!(!printed.contains(['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}']), "{printed:?}");
        let files = tree(&place);
        assert!(
            files.keys().all(|path| place.join(path).parent() == Some(out.as_path())),
            "{evil}: files elsewhere"
        );
        for (path, bytes) in files {
            harmless(&path, bytes);
        }
        fs::remove_dir_all(&place).expect("the place");
    }
}

#[cfg(unix)]
#[test]
fn a_link_in_the_place_of_the_report_is_refused() {
    let bench = Bench::new();
    let elsewhere = bench.0.path().join("elsewhere");
    fs::create_dir(&elsewhere).expect("a folder");
    let out = bench.0.path().join("report");
    std::os::unix::fs::symlink(&elsewhere, &out).expect("a link");
    let answer = dropcheck(words(&fixture("anf10-plain.csv"), &fixture("anf10-plain.toml"), &out));
    at_fault(&answer, &["report", "symbolic link"]);
    assert!(tree(&elsewhere).is_empty());
}

#[test]
fn a_line_of_ten_megabytes_is_not_printed_whole() {
    let bench = Bench::new();
    let long = "x".repeat(10 << 20);
    let sound = fs::read_to_string(fixture("anf10-plain.toml")).expect("a cask file");
    for text in [
        format!("{sound}\n{long} = oops\n"),
        sound.replacen("mass_kg", &format!("mass_kg_{long}"), 1),
        sound.replacen("name = \"A1\"", &format!("name = \"{long}"), 1),
        sound.replacen("source = \"", &format!("source = \"{long}"), 1),
        format!("{sound}\nmass_kg = {long}\n"),
    ] {
        let answer = crate::run::analyze(&fixture("anf10-plain.csv"), &bench.put("cask.toml", text));
        at_fault(&answer, &[]);
        assert!(answer.stderr.len() < 4000, "{} bytes", answer.stderr.len());
    }
    let cells = format!("time_s,A1,A2\n0,1,1\n1,2,{}\n", &long[..1_000_000]);
    let answer = crate::run::analyze(&bench.put("cells.csv", cells), &fixture("anf10-plain.toml"));
    assert!(answer.stderr.len() < 4000, "{} bytes", answer.stderr.len());
}

#[cfg(unix)]
#[test]
fn a_pipe_is_no_cask_file_and_the_system_no_place_for_a_report() {
    let bench = Bench::new();
    let pipe = bench.0.path().join("pipe.toml");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.is_ok_and(|made| made.success()));
    at_fault(&crate::run::analyze(&fixture("anf10-plain.csv"), &pipe), &["pipe.toml", "pipe or a device"]);
    for out in ["/", "/usr", "/etc"] {
        let words = words(&fixture("anf10-plain.csv"), &fixture("anf10-plain.toml"), Path::new(out));
        at_fault(&dropcheck(words), &[out, "no place for a report", "folder of its own"]);
    }
}

#[test]
fn a_line_that_fills_the_memory_is_refused_with_the_option() {
    let bench = Bench::new();
    let text = format!("time_s,A1\n0,1\n1,2\n2,{}\n", "3".repeat(2 << 20));
    let answer = crate::run::analyze(&bench.put("long.csv", text), &fixture("anf10-plain.toml"));
    at_fault(&answer, &["long.csv"]);
    let text = format!("time_s,A1,A2\n0,1,1\n1,2,1\n2,{},1\n", "3".repeat(2 << 20));
    let answer = crate::run::analyze(&bench.put("long.csv", text), &fixture("anf10-plain.toml"));
    at_fault(&answer, &["line 4", "1 MiB", "--max-memory"]);
}

/// An MCAP file whose chunk unpacks to `messages` JSON blocks of half a million zeros each.
fn bomb(messages: i32) -> Vec<u8> {
    let options = mcap::WriteOptions::new().compression(Some(mcap::Compression::Zstd)).chunk_size(None);
    let mut writer = options.create(std::io::Cursor::new(Vec::new())).expect("a writer");
    let schema = writer.add_schema("dropcheck.AccelerationBlock", "jsonschema", b"{}").expect("a schema");
    let zeros = vec!["0"; 500_000].join(",");
    for topic in ["/daq/a1", "/daq/a2"] {
        let id =
            writer.add_channel(schema, topic, "json", &std::collections::BTreeMap::new()).expect("a channel");
        for number in 0..messages {
            let data = format!(
                "{{\"timestamp\":{{\"sec\":{},\"nsec\":0}},\"sample_rate_hz\":5e5,\"samples\":[{zeros}]}}",
                number + 1
            );
            let header =
                mcap::records::MessageHeader { channel_id: id, sequence: 0, log_time: 1, publish_time: 1 };
            writer.write_to_known_channel(&header, data.as_bytes()).expect("a message");
        }
    }
    writer.finish().expect("a file");
    writer.into_inner().into_inner()
}

#[test]
fn a_bomb_is_refused_with_the_option_that_would_let_it_in() {
    let bench = Bench::new();
    let bytes = bomb(8);
    assert!(bytes.len() < 100_000, "{} bytes are no bomb", bytes.len());
    let path = bench.put("bomb.mcap", bytes);
    let (cask, out) = (bench.put("cask.toml", bomb_cask()), bench.0.path().join("report"));
    let mut words = words(&path, &cask, &out);
    words.extend(["--max-memory".into(), "64MiB".into()]);
    at_fault(&dropcheck(&words), &["bomb.mcap", "claim to unpack", "64 MiB", "--max-memory"]);
    assert!(!out.exists());
    // Within what any file may unpack to it is read, and fails for what it holds.
    words.truncate(words.len() - 2);
    let answer = dropcheck(&words);
    assert!(!answer.stderr.contains("--max-memory"), "{}", answer.stderr);
    words.push("--max-memory".into());
    words.push("some".into());
    let answer = dropcheck(&words);
    assert!(answer.status == 2 && answer.stderr.contains("8GB"), "{}", answer.stderr);
}

fn bomb_cask() -> String {
    let text = fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    let mut number = 0;
    text.lines().fold(String::new(), |out, line| {
        if line.trim_start().starts_with("source") {
            number += 1;
            return format!("{out}source = \"/daq/a{number}.samples\"\n");
        }
        format!("{out}{line}\n")
    })
}

#[cfg(unix)]
mod interrupted {
    use super::*;
    use std::collections::BTreeMap;
    use std::path::PathBuf;
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    type Content = BTreeMap<PathBuf, Vec<u8>>;

    /// In the folder around `out`, whose name is that of all: a report holds the words and the date of its
    /// run.
    fn started(stem: &str, recording: &str, out: &Path) -> Child {
        let around = out.parent().expect("a parent");
        fs::create_dir_all(around).expect("a folder");
        let name = Path::new(out.file_name().expect("a name"));
        Command::new(env!("CARGO_BIN_EXE_dropcheck"))
            .current_dir(around)
            .env("SOURCE_DATE_EPOCH", "0")
            .args(words(&fixture(recording), &fixture(&format!("{stem}.toml")), name))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts")
    }

    const ONE: (&str, &str) = ("anf10-plain", "anf10-plain.csv");
    const OTHER: (&str, &str) = ("anf18-german", "anf18-german.csv");

    /// The two reports, each whole, and how long the second takes.
    fn both(bench: &Bench) -> (Content, Content, Duration) {
        let reports = [ONE, OTHER].map(|(stem, recording)| {
            let out = bench.0.path().join(stem).join("report");
            let begun = Instant::now();
            started(stem, recording, &out).wait().expect("a run");
            (tree(&out), begun.elapsed())
        });
        let [one, other] = reports;
        assert!(one.0.len() > 5 && other.0.len() > 5 && one.0 != other.0);
        (one.0, other.0, other.1)
    }

    #[test]
    fn a_killed_run_leaves_the_old_report_or_the_whole_one() {
        let bench = Bench::new();
        let (one, other, took) = both(&bench);
        let out = bench.0.path().join("place/report");
        let runs = std::env::var("DROPCHECK_KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(12_u32);
        let (mut kept, mut replaced) = (0, 0);
        for run in 0..runs {
            // The last report is replaced, not removed: a note whose other name is gone would be kept where a
            // killed run left it.
            started(ONE.0, ONE.1, &out).wait().expect("a run");
            fs::write(out.join("notes.txt"), "mine").expect("a note");
            let mut child = started(OTHER.0, OTHER.1, &out);
            // The last third of the run is where it writes.
            std::thread::sleep(took.mul_f64(0.6 + 0.6 * f64::from(run) / f64::from(runs)));
            let signal = if run % 2 == 0 { "-KILL" } else { "-INT" };
            let _ =
                Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
            child.wait().expect("a run");
            let mut found = tree(&out);
            found.remove(Path::new("notes.txt")).expect("the note");
            kept += usize::from(found == one);
            replaced += usize::from(found == other);
            assert!(found == one || found == other, "run {run}: a mixture");
        }
        println!("{kept} kept, {replaced} replaced");
        started(OTHER.0, OTHER.1, &out).wait().expect("a run");
        let left = fs::read_dir(out.parent().expect("a parent")).expect("a folder").count();
        assert_eq!(left, 1, "what killed runs left is cleared away by the next");
    }

    #[test]
    fn two_runs_at_once_leave_one_report_whole() {
        let bench = Bench::new();
        let (one, other, _) = both(&bench);
        for number in 0..3 {
            let out = bench.0.path().join(format!("place/{number}/report"));
            let children = [ONE, OTHER, ONE, OTHER].map(|(stem, recording)| started(stem, recording, &out));
            for mut child in children {
                assert!(child.wait().expect("a run").code().is_some_and(|code| code < 2));
            }
            let found = tree(&out);
            assert!(found == one || found == other, "a mixture");
        }
    }

    #[test]
    fn a_full_disk_leaves_the_old_report() {
        let bench = Bench::new();
        let out = bench.0.path().join("place/report");
        started(ONE.0, ONE.1, &out).wait().expect("a run");
        let old = tree(&out);
        // A limit on the size of a file is what a full disk is to whoever writes; the HDF5 library has its
        // own scratch file.
        for blocks in [1, 16, 60, 200] {
            let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
            let answer = Command::new("sh")
                .args(["-c", &script, "sh", env!("CARGO_BIN_EXE_dropcheck")])
                .args(words(&fixture(OTHER.1), &fixture("anf18-german.toml"), &out))
                .output()
                .expect("a shell");
            let stderr = String::from_utf8_lossy(&answer.stderr);
            assert_eq!(answer.status.code(), Some(2), "{blocks}: {stderr}");
            assert!(!stderr.contains("panicked") && stderr.contains("error"), "{stderr}");
            assert!(tree(&out) == old, "{blocks} blocks: the old report was touched");
            let left = fs::read_dir(out.parent().expect("a parent")).expect("a folder").count();
            assert_eq!(left, 1, "{blocks} blocks: something half-written is left");
        }
    }
}
