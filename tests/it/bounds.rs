//! From small inputs that claim much, never end, or lead elsewhere, to one refusal, or to a result that is as
//! if they did not.

use crate::command_line::{Bench, at_fault};
use crate::run::{Answer, dropcheck, fixture, read_json, words};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// A PNG by its beginning, of so many bytes.
fn picture(bytes: usize) -> Vec<u8> {
    let mut picture = b"\x89PNG\r\n\x1a\n".to_vec();
    picture.resize(bytes, 0);
    picture
}

/// Runs these words; those that begin with @ are files of the bench.
fn run(bench: &Bench, words: &str) -> Answer {
    let own = |word: &str| match word.strip_prefix('@') {
        Some(name) => bench.0.path().join(name),
        None => PathBuf::from(word),
    };
    dropcheck(words.split_whitespace().map(own))
}

/// A bench with a sound recording, `r.mcap`, its cask file, `r.toml`, and one with these photographs,
/// `p.toml`.
fn bench(photos: &[&str]) -> Bench {
    let bench = Bench::new();
    let cask = fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    bench.put("r.mcap", fs::read(fixture("anf18-json.mcap")).expect("a recording"));
    bench.put("r.toml", &cask);
    bench.put("p.toml", format!("[test]\nphotos = {photos:?}\n{cask}"));
    bench
}

#[test]
fn photographs_lie_beside_the_cask_file_and_are_bounded_together() {
    let outside = Bench::new();
    let elsewhere = outside.put("other.png", picture(100));
    let elsewhere = elsewhere.to_string_lossy();
    for (photos, words) in [
        (&["../other.png"][..], "not the name of a file"),
        (&["sub/a.png"], "not the name of a file"),
        (&["a.png/"], "not the name of a file"),
        (&[&elsewhere], "not the name of a file"),
        (&["sub"], "directory"),
        (&["large.png"], "large.png has more than 8 MiB"),
        (&["8m.png"; 5], "photographs up to 8m.png has more than 32 MiB"),
        #[cfg(unix)]
        (&["link.png"], "it is a link"),
    ] {
        let bench = bench(photos);
        fs::create_dir(bench.0.path().join("sub")).expect("a folder");
        bench.put("sub/a.png", picture(100));
        bench.put("a.png", picture(100));
        bench.put("8m.png", picture(8 << 20));
        bench.put("large.png", picture((8 << 20) + 1));
        #[cfg(unix)]
        std::os::unix::fs::symlink(&*elsewhere, bench.0.path().join("link.png")).expect("a link");
        for words_before in
            ["analyze @r.mcap --out @o --cask", "analyze @r.mcap --json - --cask", "predict --cask"]
        {
            at_fault(&run(&bench, &format!("{words_before} @p.toml")), &[words]);
        }
        assert!(!bench.0.path().join("o").exists());
    }
    let bench = bench(&["a.png", "a.png"]);
    bench.put("a.png", picture(100));
    assert_eq!(run(&bench, "analyze @r.mcap --cask @p.toml --out @o").status, 0);
    let page = fs::read_to_string(bench.0.path().join("o/report.html")).expect("a page");
    assert_eq!(page.matches("src=\"data:image/png").count(), 2);
}

#[cfg(unix)]
#[test]
fn no_pipe_or_device_is_read_or_written_for_a_file() {
    let bench = bench(&["pipe.png"]);
    for name in ["pipe.png", "pipe"] {
        let made = std::process::Command::new("mkfifo").arg(bench.0.path().join(name)).status();
        assert!(made.is_ok_and(|made| made.success()));
    }
    fs::create_dir(bench.0.path().join("o")).expect("a folder");
    fs::rename(bench.0.path().join("pipe"), bench.0.path().join("o/results.jsonl")).expect("a pipe");
    for file in ["/dev/zero", "/dev/urandom", "@pipe.png", "@o/results.jsonl"] {
        for words in [
            format!("merge {file} --out @m"),
            format!("analyze @r.mcap --from {file}"),
            format!("analyze @r.mcap --cask {file}"),
            format!("analyze {file} --cask @r.toml"),
            format!("predict --cask {file}"),
            format!("synth --scene {file} --out @s"),
            format!("batch --manifest {file}"),
            format!("batch @r.mcap --jsonl {file}"),
        ] {
            let answer = run(&bench, &words);
            let told = answer.stderr.contains("pipe or a device") || words.starts_with("synth");
            assert!(answer.status == 2 && told, "{words}: {}", answer.stderr);
        }
    }
    at_fault(
        &run(&bench, "analyze @r.mcap --cask @p.toml"),
        &["pipe.png cannot be read", "pipe or a device"],
    );
    at_fault(&run(&bench, "batch @r.mcap --out @o"), &["results.jsonl is a pipe or a device"]);
    let answer = run(&bench, "batch @r.mcap --cask @pipe.png --jsonl -");
    assert!(answer.status == 0, "{}", answer.stderr);
}

#[cfg(unix)]
#[test]
fn no_lines_are_written_through_a_link() {
    let bench = bench(&[]);
    let empty = bench.put("empty", "");
    fs::create_dir(bench.0.path().join("o")).expect("a folder");
    for link in ["link", "o/results.jsonl"] {
        std::os::unix::fs::symlink(&empty, bench.0.path().join(link)).expect("a link");
    }
    for words in ["--jsonl @link", "--out @o", "--out @o --resume"] {
        at_fault(&run(&bench, &format!("batch @r.mcap {words}")), &["is a symbolic link"]);
    }
    at_fault(&run(&bench, "analyze @r.mcap --cask @r.toml --json @link"), &["is a symbolic link"]);
    assert_eq!(fs::read(&empty).expect("the file"), b"");
}

#[test]
fn a_message_of_a_campaign_quotes_no_file_from_elsewhere() {
    let outside = Bench::new();
    outside.put("secret.env", "PASSWORD_OF_NOBODY=1\n");
    outside.put("token", "ghp_abcdefghijklmnopqrst");
    let bench = bench(&[]);
    let place = outside.0.path().display();
    let mut manifest =
        format!("recording,cask\nr.mcap,{place}/secret.env\n{place}/token,r.toml\n{place}/none,r.toml\n");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outside.0.path().join("token"), bench.0.path().join("link.csv"))
            .expect("a link");
        manifest += "link.csv,r.toml\n";
    }
    bench.put("runs.csv", manifest + "r.toml,r.toml\n");
    let answer = run(&bench, "batch --manifest @runs.csv --jsonl -");
    let errors: Vec<Value> =
        answer.stdout.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    for line in &errors {
        let error = line["error"].as_str().expect("a refusal");
        assert!(!error.contains("PASSWORD") && !error.contains("ghp_"), "{error}");
    }
    let told = |row: usize, words: &str| {
        assert!(errors[row]["error"].as_str().expect("words").contains(words), "{errors:?}");
    };
    told(0, "`dropcheck analyze r.mcap --cask");
    told(2, "No such file");
    // What lies beside the manifest is told as ever.
    told(errors.len() - 1, "it is a cask file");
    let files = outside.0.path().join("token");
    let words = words!["batch", files, "--cask", "none.toml"];
    assert!(dropcheck(words).stdout.contains("none.toml"));
}

/// A line of a campaign of one, as `batch` writes it.
fn line(bench: &Bench) -> Value {
    let answer = run(bench, "batch @r.mcap --jsonl -");
    serde_json::from_str(&answer.stdout).unwrap_or_else(|error| panic!("{error}: {}", answer.stderr))
}

fn merged(bench: &Bench, lines: &[Value]) -> Answer {
    let text = lines.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n") + "\n";
    // The key by which the file is known comes first.
    let text = text.replace(
        "{\"campaign\":{\"carried\"",
        "{\"campaign\":{\"schema\":\"dropcheck.batch-shard/1\",\"carried\"",
    );
    bench.put("s.jsonl", text);
    run(bench, "merge @s.jsonl --out @m")
}

#[test]
fn a_line_is_held_against_what_a_cask_file_may_state() {
    let bench = bench(&[]);
    let sound = line(&bench);
    assert_eq!(merged(&bench, std::slice::from_ref(&sound)).status, 0);
    for (place, number) in [
        ("/settings/drop/angle_deg/value", 1e308),
        ("/settings/drop/angle_deg/value", -1e308),
        ("/settings/drop/height_m/value", 1e-308),
        ("/settings/cask/mass_kg/value", 0.0),
        ("/settings/cask/length_m/value", -1.0),
        ("/settings/tolerance/angle_deg/value", -1.0),
        ("/settings/channel/0/sample_rate_hz/value", 1e308),
    ] {
        let mut line = sound.clone();
        let (above, key) = place.trim_end_matches("/value").rsplit_once('/').expect("a place");
        line.pointer_mut(above).unwrap_or_else(|| panic!("{above}"))[key] =
            json!({ "value": number, "from": "stated" });
        at_fault(&merged(&bench, &[line]), &["s.jsonl, line 1", key, "no cask file may state", "help"]);
    }
    // A count that is claimed takes no memory, and a report elsewhere is no link.
    let mut line = sound.clone();
    line["campaign"]["count"] = 1_000_000_000_000_u64.into();
    at_fault(&merged(&bench, &[line]), &["999999999999 of 1000000000000 lines"]);
    for report in ["//evil.example/x", "/etc/passwd", "../../x", "\\\\evil.example\\x", "a/b", "", "."] {
        let mut line = sound.clone();
        line["campaign"]["report"] = report.into();
        merged(&bench, &[line]);
        let page = fs::read_to_string(bench.0.path().join("m/campaign.html")).expect("a page");
        assert!(!page.contains("report.html\""), "{report}");
    }
}

#[test]
fn a_kept_line_that_its_report_contradicts_is_made_again() {
    let bench = bench(&[]);
    let batch = |more: &str| run(&bench, &format!("batch @r.mcap --out @o {more}")).status;
    assert_eq!(batch(""), 0);
    let path = bench.0.path().join("o/results.jsonl");
    let sound = fs::read_to_string(&path).expect("lines");
    // As it stands: what is read of it may be another last digit.
    let speed_in = |line: &str| {
        let (_, behind) = line.split_once("\"slap_down\":").expect("a slap-down");
        let (_, behind) = behind.split_once("\"speed\":{\"value\":").expect("a speed");
        behind.split_once(',').expect("more than a speed").0.to_owned()
    };
    let speed = speed_in(&sound);
    fs::write(&path, sound.replace(&format!("\"value\":{speed}"), "\"value\":99.0")).expect("a file");
    assert_eq!(batch("--resume"), 0);
    assert_eq!(speed_in(&fs::read_to_string(&path).expect("lines")), speed);
    let campaign = read_json(Path::new(&bench.0.path().join("o/campaign.json")));
    let shown = campaign["recordings"][0]["slap_down_speed"]["value"].as_f64().expect("a speed");
    assert!((shown / speed.parse::<f64>().expect("a number") - 1.0).abs() < 1e-15, "{shown} for {speed}");
}

#[test]
fn a_page_shows_a_hundred_casks_and_a_line_has_an_end() {
    let bench = bench(&[]);
    let sound = line(&bench);
    let lines: Vec<Value> = (0..103)
        .map(|number: usize| {
            let mut line = sound.clone();
            line["campaign"]["number"] = number.into();
            line["campaign"]["count"] = 103.into();
            line["settings"]["cask"]["name"]["value"] = format!("cask {number}").into();
            line
        })
        .collect();
    assert_eq!(merged(&bench, &lines).status, 0);
    let page = fs::read_to_string(bench.0.path().join("m/campaign.html")).expect("a page");
    assert!(page.contains("The first 100 of 103 casks"));
    let campaign = read_json(&bench.0.path().join("m/campaign.json"));
    let casks: std::collections::BTreeSet<&str> = campaign["pools"]
        .as_array()
        .expect("pools")
        .iter()
        .filter_map(|pool| pool["cask"].as_str())
        .collect();
    assert_eq!(casks.len(), 103);
    bench.put("s.jsonl", vec![b' '; 33 << 20]);
    at_fault(&run(&bench, "merge @s.jsonl --out @n"), &["s.jsonl", "more than 32 MiB"]);
}
