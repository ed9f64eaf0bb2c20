//! From a result alone to the same result again, and to what differs.

use crate::command_line::{Bench, at_fault};
use crate::run::{analyze, dropcheck, fixture, in_a_browser, number, words};
use std::fs;
use std::path::Path;

#[test]
fn a_result_alone_gives_the_same_result_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (recording, cask) = (fixture("vhlw-rest.h5"), fixture("vhlw-rest.toml"));
    let (first, second) = (folder.path().join("first.json"), folder.path().join("second.json"));
    let with = |more: [&std::ffi::OsStr; 4], json: &Path| {
        let words = words!["analyze", recording, "--json", json];
        dropcheck(words.into_iter().chain(more.into_iter().filter(|word| !word.is_empty())))
    };
    with(words!["--cask", cask, "--without", "hum"], &first);
    let answer = with(words!["--from", first, "", ""], &second);
    assert!(answer.stdout.starts_with("The same recording; every number within 1e-9."), "{}", answer.stdout);
    let [before, after] = [&first, &second].map(|path| fs::read(path).expect("a result"));
    assert!(before == after, "not to the byte");
    let result: serde_json::Value = serde_json::from_slice(&before).expect("JSON");
    let text = fs::read_to_string(&cask).expect("a cask file");
    assert_eq!(result["cask_text"], text.as_str());
    assert_eq!(result["analysed"], "1970-01-01T00:00:00Z");
    assert_eq!(result["program"]["name"], "dropcheck");
    // Every key is there as a number or a text, and says where it is from.
    let settings = &result["settings"];
    assert_eq!(settings["drop"]["angle_deg"], serde_json::json!({"value": 15.0, "from": "stated"}));
    assert_eq!(settings["tolerance"]["angle_deg"], serde_json::json!({"value": 0.4, "from": "default"}));
    assert_eq!(settings["channel"][0]["sample_rate_hz"]["from"], "recording");
    for (name, table) in settings.as_object().expect("tables").iter().filter(|(name, _)| *name != "channel") {
        for (key, entry) in table.as_object().expect("keys") {
            assert!(entry.get("value").is_some() && entry["from"].is_string(), "{name}.{key}");
        }
    }
    // What is changed is said.
    let changed = String::from_utf8(before).expect("UTF-8").replace("angle_deg = 15", "angle_deg = 16");
    fs::write(&first, changed).expect("a file");
    let answer = with(words!["--from", first, "", ""], &second);
    assert!(
        answer.stdout.contains("settings.drop.angle_deg.value: 15.0 before, 16.0 now"),
        "{}",
        answer.stdout
    );
    at_fault(&with(words!["--from", cask, "", ""], &second), &["not JSON"]);
}

#[test]
fn a_repetition_says_first_whether_recording_and_numbers_are_the_same() {
    let bench = Bench::new();
    let (recording, cask) = (fixture("anf18-german.csv"), fixture("anf18-german.toml"));
    let first = analyze(&recording, &cask).stdout;
    let another = bench.put("other.csv", fs::read_to_string(&recording).expect("a recording") + "\n");
    let k =
        first.split("\"k\": {\n    \"value\": ").nth(1).expect("a k").split(',').next().expect("a number");
    let moved = |by: f64| first.replace(k, &(k.parse::<f64>().expect("a number") * by).to_string());
    for (record, analysed, begins, status) in [
        (first.clone(), &recording, "The same recording; every number within 1e-9.", 0),
        (moved(1.0 + 1e-11), &recording, "The same recording; every number within 1e-9.", 0),
        (moved(1.0 + 1e-6), &recording, "The same recording; ", 1),
        (
            first.replace("\"limits\": []", "\"limits\": [0]"),
            &recording,
            "The same recording; 1 of its values",
            1,
        ),
        (first.clone(), &another, "Another recording: SHA-256 \"", 1),
    ] {
        let record = bench.put("result.json", record);
        let answer = dropcheck(words!["analyze", analysed, "--from", record]);
        let line = answer.stdout.lines().next().unwrap_or_default();
        assert!(line.starts_with(begins), "{begins}: {line}");
        assert_eq!(answer.status, status, "{line}");
        assert_eq!(
            line.contains("most of all impacts[0].restitution.value: 0."),
            begins.ends_with("; "),
            "{line}"
        );
    }
}

#[test]
fn the_report_of_another_recording_is_not_replaced_unasked() {
    let bench = Bench::new();
    let (out, cask) = (bench.0.path().join("report"), fixture("anf18-german.toml"));
    let text = fs::read_to_string(fixture("anf18-german.csv")).expect("a recording");
    let with = |recording: &Path, more: &[&str]| {
        let words = words!["analyze", recording, "--cask", cask, "--out", out];
        dropcheck(words.into_iter().chain(more.iter().map(std::ffi::OsStr::new)))
    };
    let own = bench.put("drop7.csv", &text);
    assert_eq!(with(&own, &[]).status, 0);
    let before = fs::read(out.join("result.json")).expect("a result");
    let other = bench.put("drop8.csv", text + "\n");
    at_fault(&with(&other, &[]), &["holds the report of another recording", "drop7.csv", "add --force"]);
    assert!(fs::read(out.join("result.json")).is_ok_and(|kept| kept == before), "nothing is lost");
    assert_eq!(with(&own, &[]).status, 0, "the same recording anew");
    assert_eq!(with(&other, &["--force"]).status, 0);
}

#[test]
fn a_limit_is_kept_exceeded_or_undecided() {
    let bench = Bench::new();
    let (recording, stated) = (fixture("anf18-json.mcap"), fixture("anf18-json.toml"));
    let stated = fs::read_to_string(stated).expect("a cask file");
    let with = |limits: &str| {
        let cask = bench.put("c.toml", format!("{stated}\n[limits]\n{limits}\n"));
        analyze(&recording, &cask)
    };
    // 20.62 ± 0.40 m/s, k 0.551 ± 0.040.
    for (limit, state) in [
        ("slap_down_speed_m_s = { most = 25.0 }", "kept"),
        ("slap_down_speed_m_s = { most = 20.5 }", "undecided"),
        ("slap_down_speed_m_s = { most = 20.0 }", "exceeded"),
        ("slap_down_speed_m_s = { least = 22.0, most = 25.0 }", "exceeded"),
        ("k = { least = 0.2 }", "kept"),
        ("k = { least = 0.2, most = 0.56 }", "undecided"),
    ] {
        assert_eq!(with(limit).json()["limits"][0]["state"], state, "{limit}");
    }
    let all = "rigid_body_deceleration_g = { most = 1e6 }\nforce_mn = { most = 1e6 }\n\
               crush_mm = { most = 1e6 }\nenergy_kj = { most = 1e6 }";
    let result = with(all).json();
    assert_eq!(result["verdict"], "pass");
    for (row, place, scale) in [
        (0, "/rigid_body_deceleration/at_cog", 9.80665),
        (1, "/force_peak", 1e6),
        (2, "/crush", 1e-3),
        (3, "/energy_absorbed", 1e3),
    ] {
        let value = |impact: usize| number(&result["impacts"][impact], &format!("{place}/value"));
        let larger = value(0).zip(value(1)).map(|(first, second)| first.max(second) / scale);
        let row = &result["limits"][row];
        let measured = number(row, "/measured/value");
        assert!(measured.zip(larger).is_some_and(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{row}");
        assert_eq!(row["state"], "kept", "{row}");
    }
    // What is not determined is undecided.
    let cask = fs::read_to_string(fixture("damaged-ends-early.toml")).expect("a cask file");
    let cask = bench.put("c.toml", format!("{cask}\n[limits]\ncrush_mm = {{ most = 1e6 }}\n"));
    let row = &analyze(&fixture("damaged-ends-early.csv"), &cask).json()["limits"][0];
    assert!(row["measured"].is_null() && row["state"] == "undecided", "{row}");
    for (wrong, named) in [
        ("slapdown_speed_m_s = { most = 25.0 }", "did you mean slap_down_speed_m_s?"),
        ("k = 0.5", "write it as in k = { least"),
        ("k = { }", "k has no least or most"),
        ("k = { least = 0.6, most = 0.5 }", "a least above its most"),
        ("k = { highest = 0.6 }", "knows no key highest"),
    ] {
        at_fault(&with(wrong), &[named]);
    }
}

#[test]
fn a_site_puts_its_own_words_and_logo_around_the_report() {
    let bench = Bench::new();
    let stated = fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    let svg =
        "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"><script>alert(1)</script></svg>";
    bench.put("logo.svg", svg);
    bench.put("logo.txt", "no picture");
    let out = bench.0.path().join("report");
    let with = |report: &str| {
        let cask = bench.put("c.toml", format!("{report}\n{stated}"));
        dropcheck(words!["analyze", fixture("anf18-json.mcap"), "--cask", cask, "--out", out])
    };
    let words = "[report]\nheader = \"<b>Centre\"\nfooter = \"</style>7\"\nlogo = \"logo.svg\"\n\
                 [test]\nrevisions = [\"2026-11-22, 0.1.0, first issue\", \
                 \"2026-11-30, 0.2.0, angle, by film\"]\n";
    assert_eq!(with(words).status, 0);
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    for (held, count) in [
        ("<img class=\"logo\" alt=\"logo.svg\" src=\"data:image/svg+xml;base64,PD94", 1),
        ("alert(1)", 0),
        ("<p>&lt;b&gt;Centre</p>", 1),
        ("<p>&lt;/style&gt;7</p></footer>", 1),
        ("@bottom-center { content: \"\\3c \\2f style\\3e 7\"", 1),
        ("</style>", 1),
        ("Revisions of this report", 1),
        ("0.2.0", 1),
        ("angle, by film", 1),
    ] {
        assert_eq!(page.matches(held).count(), count, "{held}");
    }
    for (wrong, named) in [
        ("[report]\nlogo = \"none.svg\"", "none.svg cannot be read"),
        ("[report]\nlogo = \"a/logo.svg\"", "is not the name of a file"),
        ("[report]\nlogo = \"logo.txt\"", "logo.txt is no PNG, JPEG or SVG"),
        ("[test]\nphotos = [\"logo.svg\"]", "logo.svg is no PNG or JPEG"),
        ("[report]\nheading = \"Centre\"", "did you mean header?"),
    ] {
        at_fault(&with(wrong), &[named]);
    }
}

#[test]
fn what_is_said_of_the_test_stands_in_the_record_and_what_was_seen_is_held_against_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let stated = std::fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    let sensor = "[[channel]]\nserial = \"A-20311\"\ncertificate = \"K-118\"\ncalibrated = 2026-03-02\n";
    let with = |test: &str| {
        let cask = folder.path().join("c.toml");
        std::fs::write(&cask, format!("{test}\n{}", stated.replacen("[[channel]]", sensor, 1)))
            .expect("room");
        analyze(&fixture("anf18-json.mcap"), &cask)
    };
    // A PNG of one pixel, by another writer.
    let pixel = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x02\0\0\0\x90wS\xde\0\0\0\x0c\
        IDATx\x9cc\xf8\xcf\xc0\0\0\x03\x01\x01\0\xc9\xfe\x92\xef\0\0\0\0IEND\xaeB`\x82";
    std::fs::write(folder.path().join("before.png"), pixel).expect("room");
    std::fs::write(folder.path().join("words.png"), "no picture").expect("room");
    let test = "[test]\nid = \"SD-14\"\ndate = 2026-11-22T09:40:00+01:00\n\
                photos = [\"before.png\"]\n[test.more]\nHook = 4\n";
    // Corner 18.18 ± 0.45 m/s: (18.18 − 18.0)/√(0.45² + 0.30²) = 0.33; k 0.556 ± 0.035: (0.556 −
    // 0.7)/√(0.035² + 0.030²) = −3.1.
    let seen = "[observed]\nlocal_speed_m_s = { value = 18.0, u95 = 0.3, by = \"video\" }\n\
                k = { value = 0.7, u95 = 0.03 }\n";
    let result = with(&format!("{test}{seen}")).json();
    assert_eq!(result["test"]["id"], "SD-14");
    assert_eq!(result["test"]["date"], "2026-11-22T09:40:00+01:00");
    assert_eq!(result["test"]["more"]["Hook"], "4");
    assert_eq!(result["test"]["photos"][0], "before.png");
    assert_eq!(result["settings"]["test"]["date"]["from"], "stated");
    assert_eq!(result["channels"][0]["calibrated"], "2026-03-02");
    assert!((result["observed"][0]["e_n"].as_f64().expect("both known") - 0.34).abs() < 0.02);
    assert!((result["observed"][1]["e_n"].as_f64().expect("both known") + 3.1).abs() < 0.1);
    assert_eq!((&result["verdict"], &result["quality"][0]["code"]), (&"review".into(), &"observed".into()));
    for (wrong, named) in [
        ("[test]\nphotos = [\"none.jpg\"]\n", "none.jpg cannot be read"),
        ("[test]\nphotos = [\"words.png\"]\n", "words.png is no PNG or JPEG"),
        ("[test]\nphotos = [\".\"]\n", ". is not the name of a file"),
        ("[test]\ndate = \"2026-11-22\"\n", "not a date without quotes"),
        ("[test]\nsignatures = \"Reviewer\"\n", "a list of texts"),
        ("[test.more]\nHook = true\n", "a text or a number"),
        ("[observed]\nk = 0.5\n", "write it as in k = { value = 0.55, u95 = 0.05 }"),
        ("[observed]\nspeed = { value = 1.0, u95 = 0.1 }\n", "knows no key speed"),
    ] {
        at_fault(&with(wrong), &[named]);
    }
}

#[test]
fn a_report_goes_to_paper_and_to_other_programs() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("report");
    let (recording, cask) = (fixture("anf18-json.mcap"), fixture("anf18-json.toml"));
    let with = |path: &str, more: &[&str]| {
        std::process::Command::new(env!("CARGO_BIN_EXE_dropcheck"))
            .env("PATH", path)
            .arg("analyze")
            .arg(&recording)
            .arg("-c")
            .arg(&cask)
            .arg("-o")
            .arg(&out)
            .args(more)
            .output()
            .expect("the program")
    };
    let without = with("/none", &["--pdf", "--csv-locale", "de"]);
    assert_eq!(without.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&without.stderr).contains("no Chromium, Chrome or Edge was found"));
    assert!(!out.join("report.pdf").exists());
    let curves = fs::read_to_string(out.join("curves.csv")).expect("curves");
    assert!(
        curves.starts_with("time_s;A1_raw_g;")
            && curves.lines().nth(1).is_some_and(|row| row.contains("0,0"))
    );
    let table = fs::read_to_string(out.join("results.tex")).expect("a table");
    assert!(table.contains("Slap-down: speed (rigid cask) & $20.59 \\pm 0.37$ m/s \\\\"), "{table}");
    let path = std::env::var("PATH").unwrap_or_default();
    if std::env::split_paths(&path).all(|folder| !folder.join("chromium").is_file()) {
        println!("skipped: no chromium to print with");
        return;
    }
    let printed = with(&path, &["--pdf"]);
    assert_eq!(String::from_utf8_lossy(&printed.stderr), "");
    let pdf = fs::read(out.join("report.pdf")).expect("a PDF");
    assert!(pdf.starts_with(b"%PDF-"));
    let again = with(&path, &[]);
    assert!(String::from_utf8_lossy(&again.stderr).contains("of an earlier run"));
    assert!(fs::read(out.join("report.pdf")).is_ok_and(|kept| kept == pdf), "nothing is lost");
}

#[test]
fn a_shell_completes_and_man_has_pages() {
    for (shell, mark) in [
        ("bash", "complete -F"),
        ("zsh", "#compdef"),
        ("fish", "complete -c"),
        ("powershell", "Register-ArgumentCompleter"),
    ] {
        let answer = dropcheck(["completions", shell]);
        assert!(
            answer.stdout.contains(mark) && answer.stdout.contains("csv-locale"),
            "{shell}: {}",
            answer.stderr
        );
    }
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(dropcheck(words!["man", folder.path()]).status, 0);
    let page = fs::read_to_string(folder.path().join("dropcheck-analyze.1")).expect("a page");
    assert!(page.contains(".TH") && page.contains("csv\\-locale"));
}

#[test]
fn the_page_works_in_a_browser() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("report");
    let cask = fixture("anf18-json.toml");
    dropcheck(words!["analyze", fixture("anf18-json.mcap"), "-c", cask, "-o", out]);
    in_a_browser("page.py", &out.join("report.html"));
}
