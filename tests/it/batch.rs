//! From a manifest of fixtures to the campaign: tables, shards and what is wrong with them, runs that are
//! stopped and go on.

use crate::run::{Answer, dropcheck, fixture, read_json, tree, words};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A folder with some fixtures, one that is broken, and their manifest.
struct Series(tempfile::TempDir);

const MANIFEST: &str = "id,recording,cask,drop.angle_deg,test.date,hall
T1,anf18-json.mcap,anf18-json.toml,,2026-03-02,1
T2,anf18-json.mcap,anf18-json.toml,15.2,2026-03-03,2
T3,broken.csv,anf18-json.toml,,2026-03-04,2
T4,anf10-plain.csv,,,2026-03-05,007
T5,damaged-gap.mcap,damaged-gap.toml,,2026-03-06,-1
T6,vhlw-rest.h5,vhlw-rest.toml,,2026-03-07,=1+1
T7,none.mcap,anf18-json.toml,,,
";

impl Series {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["anf18-json.mcap", "anf10-plain.csv", "damaged-gap.mcap", "vhlw-rest.h5"] {
            let cask = Path::new(name).with_extension("toml");
            for name in [Path::new(name), &cask] {
                fs::copy(fixture(&name.to_string_lossy()), folder.path().join(name)).expect("a copy");
            }
        }
        fs::write(folder.path().join("broken.csv"), "no recording\n").expect("a file");
        fs::write(folder.path().join("runs.csv"), MANIFEST).expect("a file");
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// `batch --manifest runs.csv` with more words; those that begin with @ are files of the folder.
    fn batch(&self, words: &str) -> Answer {
        dropcheck(self.words(words))
    }

    fn words(&self, words: &str) -> Vec<PathBuf> {
        let own = |word: &str| match word.strip_prefix('@') {
            Some(name) => self.path(name),
            None => word.into(),
        };
        format!("batch --manifest @runs.csv {words}").split_whitespace().map(own).collect()
    }

    fn merge(&self, shards: &[&str]) -> Answer {
        let shards = shards.iter().map(|name| self.path(name));
        let words =
            std::iter::once("merge".into()).chain(shards).chain(["--out".into(), self.path("merged")]);
        dropcheck(words)
    }

    fn shards(&self) -> [&'static str; 3] {
        let names = ["s0.jsonl", "s1.jsonl", "s2.jsonl"];
        for (i, name) in names.iter().enumerate() {
            assert!(self.batch(&format!("--shard {i}/3 --jsonl @{name}")).status <= 2);
        }
        names
    }
}

#[track_caller]
fn are_equal(a: &BTreeMap<PathBuf, Vec<u8>>, b: &BTreeMap<PathBuf, Vec<u8>>) {
    assert!(a.keys().eq(b.keys()), "{:?}\n{:?}", a.keys(), b.keys());
    for (name, bytes) in a {
        assert!(b[name] == *bytes, "{} differs", name.display());
    }
}

fn lines(path: &Path) -> Vec<Value> {
    let text = fs::read_to_string(path).expect("lines");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

#[test]
fn a_manifest_makes_one_campaign_of_mixed_formats() {
    let series = Series::new();
    let answer = series.batch("--out @full --jobs 2");
    assert_eq!(answer.status, 2, "{}", answer.stderr);
    assert!(answer.stderr.contains("7 of 7"), "{}", answer.stderr);
    let campaign = read_json(&series.path("full/campaign.json"));
    let rows = campaign["recordings"].as_array().expect("rows");
    let column = |key: &str| rows.iter().map(|row| row[key].clone()).collect::<Vec<_>>();
    assert_eq!(column("id"), ["T1", "T2", "T3", "T4", "T5", "T6", "T7"]);
    assert_eq!(column("exit"), [0, 0, 2, 0, 1, 0, 2]);
    assert!(rows[2]["error"].as_str().is_some_and(|words| words.contains("broken.csv")), "{}", rows[2]);
    // The column overrides, an empty cell does not, and the cask file's text is that of the analysis.
    let columns = |row: usize, key: &str| rows[row]["columns"][key].clone();
    assert_eq!((columns(0, "drop.angle_deg"), columns(1, "drop.angle_deg")), (15.0.into(), 15.2.into()));
    assert_eq!((columns(3, "hall"), columns(5, "hall")), ("007".into(), "=1+1".into()));
    let result = series.path("full/T2/result.json");
    assert!(read_json(&result)["cask_text"].as_str().expect("text").contains("angle_deg = 15.2"));
    let again = dropcheck(words!["analyze", series.path("anf18-json.mcap"), "--from", result]);
    assert!(again.stdout.starts_with("The same recording; every number within 1e-9."), "{}", again.stdout);
    // T1 and T2 are one recording: it is named, and counts once.
    assert_eq!(column("same_recording_as")[..3], [Value::Null, "T1".into(), Value::Null]);
    assert!(answer.stdout.contains("counted once: T2 is T1"), "{}", answer.stdout);
    let pools = campaign["pools"].as_array().expect("pools");
    let of_anf18: Vec<&Value> =
        pools.iter().filter(|pool| pool["cask"] == "ANF-18" && pool["quantity"] == "k").collect();
    assert_eq!((of_anf18.len(), &of_anf18[0]["angle_deg"]), (1, &15.0.into()), "{pools:?}");
    let sum = "7 recordings: 4 sound, 1 for review, 0 partly or not usable, 2 not analysed, 0\n  beyond a \
               limit. Outliers: ";
    // Of two drops either is as far off their mean as the other.
    let outliers = answer.stdout.split(sum).nth(1).unwrap_or_else(|| panic!("{}", answer.stdout));
    let outliers = outliers.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(outliers.contains("T1 (k 0.556") && outliers.contains("T5 (k 0.506"), "{outliers}");
    let page = fs::read_to_string(series.path("full/campaign.html")).expect("a page");
    for part in
        ["href=\"T5/report.html\"", "class=\"many sortable\"", "script-src 'sha256-", "body, rough", "gap"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert!(series.path("full/T6/report.html").exists() && !series.path("full/T3").exists());
    assert_eq!(series.batch("--exit-zero --jsonl -").status, 2);
}

/// The heads of `campaign.csv`, and the columns that `campaign.json` has of any recording.
fn columns(out: &Path) -> (Vec<String>, BTreeSet<String>) {
    let table = fs::read_to_string(out.join("campaign.csv")).expect("a table");
    let heads = table.lines().next().expect("heads").split(',').map(str::to_owned).collect();
    let campaign = read_json(&out.join("campaign.json"));
    let rows = campaign["recordings"].as_array().expect("rows").iter();
    (heads, rows.flat_map(|row| row["columns"].as_object().expect("columns").keys().cloned()).collect())
}

#[test]
fn the_columns_are_the_same_whatever_was_dropped() {
    let series = Series::new();
    series.batch("--out @full");
    let (heads, of_all) = columns(&series.path("full"));
    assert_eq!(heads[..5], ["id", "cask.name", "drop.angle_deg", "test.date", "verdict"]);
    assert_eq!(heads.last().map(String::as_str), Some("hall"), "what is carried comes last");
    let missing: Vec<&String> = of_all.iter().filter(|name| !heads.contains(name)).collect();
    // Keys that nobody stated, what nobody observed, and channels outside the motion.
    let is_optional =
        |name: &str| name.contains('.') || name.starts_with("observed_") || name == "other_channels";
    let unused: Vec<&String> =
        heads.iter().filter(|name| !of_all.contains(*name) && !is_optional(name)).collect();
    assert!(missing.is_empty() && unused.is_empty(), "columns.tsv: {missing:?} {unused:?}");
    // What the result measures of the drop as a whole has a column.
    let (result, mut measured) = (read_json(&series.path("full/T6/result.json")), 0);
    let [first, second] = [0, 1].map(|i| &result["impacts"][i]);
    let parts = ["first_impact", "slap_down"].map(|name| (name, &result[name]));
    for (part, table) in parts.into_iter().chain([("impact_1", first), ("impact_2", second)]) {
        for (name, _) in table.as_object().expect("a part").iter().filter(|(_, q)| q["u95"].is_f64()) {
            measured += 1;
            let column = format!("{part}_{name}");
            assert!(heads.iter().any(|head| head.starts_with(&column)), "columns.tsv lacks {column}");
        }
    }
    assert!(measured > 20, "{measured}");
    fs::write(series.path("runs.csv"), "recording,k,hall\nbroken.csv,1,2\n").expect("a manifest");
    series.batch("--out @broken");
    let (of_broken, _) = columns(&series.path("broken"));
    assert_eq!(of_broken, heads, "a name that is taken is not carried");
}

#[test]
fn two_drops_are_compared_by_number_and_curve() {
    let series = Series::new();
    fs::write(series.path("runs.csv"), "recording\nanf10-plain.csv\nvhlw-rest.h5\n").expect("a manifest");
    series.batch("--out @two");
    let page = fs::read_to_string(series.path("two/campaign.html")).expect("a page");
    // The script sets their numbers side by side, and draws them over one another.
    assert_eq!(page.matches("[\"slap-down speed of the rigid cask\",").count(), 2);
    assert!(!page.contains("from the first sample\","));
    assert_eq!(page.matches("\"second_end_m_s\":[").count(), 2);
    let lines = lines(&series.path("two/results.jsonl"));
    for line in lines {
        let second = line["curves"]["second_end_m_s"].as_array().expect("a curve");
        // It falls along the sensor until first contact.
        let fall = line["first_impact"]["impact_velocity"]["value"].as_f64().expect("a speed");
        let first = second[0].as_f64().expect("a number");
        assert!(second.len() == 240 && (-1.0..-0.8).contains(&(first / fall)), "{first} beside {fall}");
    }
}

#[test]
fn every_line_is_a_result_or_why_there_is_none() {
    let series = Series::new();
    let answer = series.batch("--jsonl -");
    let told: Vec<Value> =
        answer.stdout.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(told.len(), 7);
    assert!(told[0]["schema"] == "dropcheck.result/1" && told[0]["slap_down"]["speed"]["value"].is_f64());
    assert!(told[2]["id"] == "T3" && told[2]["exit"] == 2 && told[2]["error"].is_string());
    let three =
        &MANIFEST.lines().take(2).chain(MANIFEST.lines().skip(5).take(1)).collect::<Vec<_>>().join("\n");
    fs::write(series.path("runs.csv"), three).expect("a manifest");
    assert_eq!((series.batch("").status, series.batch("--exit-zero").status), (1, 0));
}

#[test]
fn a_cask_file_beside_a_recording_goes_before_that_of_the_words() {
    let series = Series::new();
    for name in ["broken.csv", "runs.csv"] {
        fs::remove_file(series.path(name)).expect("a file");
    }
    let form = dropcheck(words!["init", series.0.path()]).stdout;
    assert!(form.starts_with("id,recording,cask,") && form.lines().count() == 5, "{form}");
    assert!(form.lines().nth(1).is_some_and(|row| row.contains("anf10-plain.toml")), "{form}");
    fs::remove_file(series.path("anf18-json.toml")).expect("a file");
    let pattern = series.path("*.mcap");
    let cask = fixture("anf18-json.toml");
    let out = series.path("out");
    let words = words!["batch", pattern, "--cask", cask, "--out", out];
    assert_eq!(dropcheck(words).status, 1);
    let rows = read_json(&out.join("campaign.json"));
    let casks: Vec<&str> =
        rows["recordings"].as_array().expect("rows").iter().filter_map(|row| row["cask"].as_str()).collect();
    assert!(
        casks[0].ends_with("fixtures/examples/anf18-json.toml")
            && casks[1] == series.path("damaged-gap.toml").to_string_lossy()
    );
}

#[test]
fn shards_make_what_one_run_makes_to_the_byte() {
    let series = Series::new();
    series.batch("--out @full");
    let shards = series.shards();
    let answer = series.merge(&[shards[2], shards[0], shards[1]]);
    assert_eq!(answer.status, 2, "{}", answer.stderr);
    let (mut full, merged) = (tree(&series.path("full")), tree(&series.path("merged")));
    full.retain(|name, _| name.to_string_lossy().starts_with("campaign"));
    assert!(full.len() >= 5);
    are_equal(&full, &merged);
}

#[test]
fn a_shard_that_is_missing_doubled_cut_foreign_or_of_another_version_is_named() {
    let series = Series::new();
    let [s0, s1, s2] = series.shards();
    let text = fs::read_to_string(series.path(s1)).expect("lines");
    let put = |name: &str, text: &str| fs::write(series.path(name), text).expect("a file");
    put("cut.jsonl", &text[..text.len() - 100]);
    put("short.jsonl", &text[..=text.find('\n').expect("a line")]);
    put(
        "old.jsonl",
        &text.replace(&format!("\"version\":\"{}\"", env!("CARGO_PKG_VERSION")), "\"version\":\"0.0.9\""),
    );
    put("empty.jsonl", "");
    put("other.jsonl", "{\"a\": 1}\n");
    fs::write(series.path("runs.csv"), MANIFEST.replace("15.2", "15.3")).expect("a manifest");
    series.batch("--shard 1/3 --jsonl @foreign.jsonl");
    let two = lines(&series.path(s1)).len();
    assert_eq!(two, 2);
    for (shards, words) in [
        (vec![s0, s2], vec!["shard 1/3 is missing", "2 of 7"]),
        (vec![s0, s1, s2, s1], vec!["s1.jsonl repeats T2 of shard 1/3"]),
        (vec![s0, "cut.jsonl", s2], vec!["cut.jsonl, line 2", "--resume"]),
        (vec![s0, "short.jsonl", s2], vec!["short.jsonl is cut: 1 of the 2 lines of shard 1/3"]),
        (vec![s0, "old.jsonl", s2], vec!["old.jsonl is of another version", "0.0.9"]),
        (vec![s0, "foreign.jsonl", s2], vec!["foreign.jsonl is of another campaign, or of another state"]),
        (vec![s0, "empty.jsonl", s2], vec!["empty.jsonl is no shard"]),
        (vec!["other.jsonl"], vec!["other.jsonl is no shard"]),
    ] {
        let answer = series.merge(&shards);
        let told = answer.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(answer.status, 2, "{shards:?}");
        for part in words {
            assert!(told.contains(part), "{part}: {told}");
        }
        assert!(!series.path("merged").exists());
    }
}

#[test]
fn what_cannot_be_meant_is_refused_before_the_work() {
    let series = Series::new();
    for (words, part) in [
        ("--resume", "--resume does not know what is done"),
        ("--shard 3/3", "from 0 to N - 1"),
        ("--jobs 0", "0"),
        ("--shard 7/9 --jsonl @s7.jsonl", "take --shard I/7 at most"),
        ("--jsonl @vhlw-rest.toml", "was not written by dropcheck"),
        ("--jsonl @runs.csv", "would overwrite"),
    ] {
        let answer = series.batch(words);
        assert!(answer.status == 2 && answer.stderr.contains(part), "{words}: {}", answer.stderr);
    }
    fs::create_dir(series.path("T1")).expect("a folder");
    fs::rename(series.path("anf18-json.mcap"), series.path("T1/curves.csv")).expect("a file");
    fs::write(series.path("runs.csv"), MANIFEST.replace("anf18-json.mcap", "T1/curves.csv"))
        .expect("a manifest");
    let answer = series.batch("--out @.");
    assert!(
        answer.status == 2 && answer.stderr.contains("lies where a report of this campaign would go"),
        "{}",
        answer.stderr
    );
}

#[test]
fn a_run_that_is_killed_at_any_moment_goes_on_to_the_same_files() {
    let series = Series::new();
    series.batch("--out @full --jobs 1");
    let full = tree(&series.path("full"));
    let mut moment = 1_u64;
    for round in 0..10 {
        let words = series.words(&format!("--out @again-{round} --resume --jobs {}", 1 + round % 2));
        for _ in 0..5 {
            let mut run = Command::new(env!("CARGO_BIN_EXE_dropcheck"));
            run.args(&words).env("SOURCE_DATE_EPOCH", "0").stdout(Stdio::null()).stderr(Stdio::null());
            let mut run = run.spawn().expect("the program starts");
            // Numerical Recipes' generator: moments of no pattern, the same each time.
            moment = moment.wrapping_mul(1_664_525).wrapping_add(1_013_904_223) % (1 << 32);
            std::thread::sleep(Duration::from_millis(moment % 400));
            run.kill().expect("it ends");
            run.wait().expect("it has ended");
        }
        let answer = dropcheck(&words);
        assert!(answer.status == 2 && !answer.stderr.contains("error:"), "{}", answer.stderr);
        are_equal(&full, &tree(&series.path(&format!("again-{round}"))));
    }
}

#[test]
fn what_is_done_is_not_done_again_unless_its_bytes_are_others() {
    let series = Series::new();
    series.batch("--out @full");
    let report = series.path("full/T1/report.html");
    let when = |path: &Path| fs::metadata(path).and_then(|file| file.modified()).expect("a time");
    let before = when(&report);
    series.batch("--out @full --resume");
    assert_eq!(when(&report), before);
    let mut bytes = fs::read(series.path("anf10-plain.csv")).expect("a recording");
    bytes.push(b'\n');
    fs::write(series.path("anf10-plain.csv"), bytes).expect("a recording");
    let other = series.path("full/T4/report.html");
    let of_other = when(&other);
    series.batch("--out @full --resume");
    assert!(when(&report) == before && when(&other) > of_other);
    assert_eq!(lines(&series.path("full/results.jsonl")).len(), 7);
}

/// Whether python3 has these modules.
fn has_modules(modules: &str) -> bool {
    let status =
        Command::new("python3").args(["-c", &format!("import {modules}")]).stderr(Stdio::null()).status();
    let has = status.is_ok_and(|status| status.success());
    if !has {
        println!("left out: python3 has no {modules}");
    }
    has
}

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name)
}

#[test]
#[ignore = "sixty drops: .ci/long"]
fn sixty_recordings_of_three_casks_give_back_what_they_were_made_with() {
    if !has_modules("csv") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let (series, out) = (folder.path().join("series"), folder.path().join("out"));
    let program = env!("CARGO_BIN_EXE_dropcheck").as_ref();
    let made = Command::new("python3")
        .args([script("series/make.py").as_os_str(), program, series.as_os_str()])
        .output();
    assert!(made.expect("python3 starts").status.success());
    let manifest = series.join("runs.csv");
    let answer = dropcheck(words!["batch", "--manifest", manifest, "--out", out]);
    assert_eq!(answer.status, 2);
    for words in ["60 recordings: 57 sound", "Outliers: ANF-18-15-2 (k 0.71"] {
        assert!(answer.stdout.contains(words), "{}", answer.stdout);
    }
    let (campaign, truth) = (read_json(&out.join("campaign.json")), read_json(&series.join("truth.json")));
    let rows = campaign["recordings"].as_array().expect("rows");
    let broken = rows.iter().filter(|row| row["exit"] == 2).map(|row| row["id"].clone());
    let mut expected = truth["broken"].as_array().expect("names").clone();
    expected.sort_by_key(|id| rows.iter().position(|row| row["id"] == *id));
    assert_eq!((rows.len(), broken.collect::<Vec<_>>()), (60, expected));
    let pools = campaign["pools"].as_array().expect("pools");
    for (cask, k) in truth["k"].as_object().expect("casks") {
        let pool = pools.iter().filter(|pool| pool["cask"] == *cask && pool["quantity"] == "k");
        let pool = pool.max_by_key(|pool| pool["count"].as_u64()).expect("a pool");
        let number = |key: &str| pool[key].as_f64().expect("a number");
        let off = number("mean") - k.as_f64().expect("a number");
        assert!(off.abs() < number("u95"), "{cask}: {off}");
        // The drops scatter by 0.01, the measurement adds its own to that: between both and what is stated.
        let scatter = truth["scatter"].as_f64().expect("a number");
        assert!((0.7 * scatter..2.0 * scatter).contains(&number("scatter")), "{pool}");
    }
    let repeats =
        pools.iter().filter(|pool| pool["quantity"] == "k").filter_map(|pool| pool["repeats"].as_array());
    let size = |repeat: &&Value| repeat["e_n"].as_f64().unwrap_or_default().abs();
    let farthest = repeats.flatten().max_by(|a, b| size(a).total_cmp(&size(b))).expect("repeats");
    assert!(farthest["id"] == truth["outlier"] && farthest["falls_out"] == true, "{farthest}");
    let page = fs::read_to_string(out.join("campaign.html")).expect("a page");
    assert!(page.contains("ANF-18-15-2</a></th><td>k 0.71"), "the page names the drop that is otherwise");
}

#[test]
fn pandas_and_duckdb_read_the_tables_without_effort() {
    if !has_modules("pandas, duckdb") {
        return;
    }
    let series = Series::new();
    series.batch("--out @full --jsonl @all.jsonl");
    let mut read = Command::new("python3");
    read.arg(script("series/read.py")).arg(series.path("full"));
    let read = read.arg(series.path("all.jsonl")).output();
    let read = read.expect("python3 starts");
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
}

#[test]
#[ignore = "engines for many machines: .ci/long"]
fn the_recipes_write_what_a_local_run_writes() {
    if !has_modules("csv") {
        return;
    }
    let series = Series::new();
    let mut engines = Command::new("python3");
    engines.arg(script("scale/engines.py")).arg(env!("CARGO_BIN_EXE_dropcheck")).arg(series.path("runs.csv"));
    let answer = engines.output().expect("python3 starts");
    println!("{}", String::from_utf8_lossy(&answer.stdout));
    assert!(answer.status.success(), "{}", String::from_utf8_lossy(&answer.stderr));
}
