//! Sentences of a report that name a first, simplest, lowest, largest or all, held against the numbers beside
//! them, on every example and on drawn drops; and quantities by their names, one value each.

use crate::run::{analyze, dropcheck, fixture, fixtures, read_json, words};
use dropcheck::data::{
    Analysis, Contribution, DropResult, Estimate, FlightScore, MethodCandidate, ModelCandidate, Verdict,
};
use dropcheck::lab::campaign;
use dropcheck::lab::data::SceneNumber;
use dropcheck::lab::in_memory;
use dropcheck::{ingest, report};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// The examples that are recordings with a cask file.
fn examples() -> Vec<(PathBuf, PathBuf)> {
    let mut found: Vec<(PathBuf, PathBuf)> = fs::read_dir(fixtures().join("examples"))
        .expect("the examples")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "mcap" || e == "h5" || e == "csv"))
        .map(|path| (path.clone(), path.with_extension("toml")))
        .filter(|(_, cask)| cask.exists())
        .collect();
    found.sort();
    assert!(found.len() >= 10, "{}", found.len());
    found
}

fn analysis(recording: &Path, cask: &Path) -> Analysis {
    ingest::read_hdf5_with(Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    let file = ingest::cask_file(cask).expect("a cask file");
    dropcheck::analyze(&dropcheck::read(recording, &file, &|_| ()).expect("a recording"), &file)
}

/// Every example, and so many drawn drops that a campaign makes of its seed.
fn reports(drawn: u32) -> Vec<(String, Analysis)> {
    let drawn: Vec<SceneNumber> = (0..drawn).map(SceneNumber::Undamaged).collect();
    let drawn = drawn.into_par_iter().filter_map(|number| {
        let (file, synthetic) = campaign::scene(11, number, false);
        let recording = in_memory::synthetic(&synthetic, &file.stated).ok()?;
        Some((number.to_string(), dropcheck::analyze(&recording, &file.stated)))
    });
    let examples = examples();
    let read = examples
        .par_iter()
        .map(|(recording, cask)| (recording.display().to_string(), analysis(recording, cask)));
    read.chain(drawn).collect()
}

/// All tables of the terminal, and of an example all words of the page, each run of white space as one space.
fn text(analysis: &Analysis) -> String {
    let mut words = report::table(analysis, 200);
    // Pages are drawn in seconds: those of the examples stand for all.
    if Path::new(&analysis.result.input.recording).exists() {
        let page = report::files(analysis).expect("files").swap_remove(0).1;
        let page = String::from_utf8(page).expect("UTF-8");
        words.extend(
            page.split('<').filter_map(|part| Some(part.split_once('>')?.1)).flat_map(|it| [it, " "]),
        );
    }
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a model agrees, all richer ones agree, and none lies farther from it than the speed is known.
fn is_sufficient(models: &[ModelCandidate], known_m_s: f64) -> bool {
    let apart_m_s = |other: &ModelCandidate| Some((models[0].predicted? - other.predicted?).abs());
    models.iter().all(|model| model.consistent && apart_m_s(model).is_some_and(|by| by <= known_m_s))
}

fn hold_model(result: &DropResult, name: &str) -> Option<()> {
    let (choice, speed) = (result.model.as_ref()?, result.slap_down.speed?);
    let reason = &choice.reason;
    let all = &choice.candidates;
    let taken = all.iter().position(|model| model.rung == choice.rung).expect("the model taken");
    let first = (0..all.len()).find(|i| is_sufficient(&all[*i..], speed.u95));
    assert_eq!(taken, first.unwrap_or(all.len() - 1), "{name}: {reason}");
    assert_eq!(
        reason.contains("is the simplest model that agrees"),
        taken + 1 < all.len(),
        "{name}: {reason}"
    );
    assert_eq!(reason.contains("is the richest model"), taken + 1 == all.len(), "{name}: {reason}");
    assert_eq!(reason.contains("does not agree within"), !all[taken].consistent, "{name}: {reason}");
    // Each simpler one of which the table says that it agrees is named with what speaks against it.
    let simpler = all[..taken].iter().filter(|model| model.consistent).count();
    assert_eq!(reason.matches(", which agrees, but ").count(), simpler, "{name}: {reason}");
    Some(())
}

fn hold_flight(result: &DropResult, text: &str, name: &str) -> Option<&'static str> {
    let all = &result.flight.as_ref()?.candidates;
    let taken = all.iter().find(|score| score.taken)?;
    let lowest = all.iter().min_by(|a, b| a.bic.total_cmp(&b.bic)).expect("a fit");
    let (_, said) = text.split_once("the number of bending modes is that of the ")?;
    if said.starts_with("fit with the lowest criterion.") {
        assert!(taken.bic <= lowest.bic, "{name}: {taken:?}, not {lowest:?}");
        return Some("lowest");
    }
    assert!(taken.bic > lowest.bic, "{name}: {said:.120}");
    if said.starts_with("smallest fit that gives the same velocity steps as the one with the lowest") {
        // Modes, each with two phases a channel where these are free, and drifts.
        let size = |of: &FlightScore| (of.modes + usize::from(of.modes > 0 && !of.driven), of.drift);
        let (own, other) = (size(taken), size(lowest));
        assert!(own.0 < other.0 || (!own.1 && other.1), "{name}: {taken:?} is not smaller than {lowest:?}");
        return Some("smallest");
    }
    assert!(
        said.starts_with("fit with the lowest criterion among those that the motion"),
        "{name}: {said:.120}"
    );
    Some("other")
}

fn hold_reconstruction(result: &DropResult, text: &str, name: &str) -> Option<()> {
    let choice = result.reconstruction.as_ref()?;
    let all = &choice.candidates;
    // "The first is taken that noise and tolerances explain and whose answer the next would neither change by
    // more than the narrower interval nor know better by a tenth."
    let within = |a: Option<Estimate>, b: Option<Estimate>| match (a, b) {
        (Some(a), Some(b)) => (a.value - b.value).abs() <= a.u95.min(b.u95) && b.u95 > 0.9 * a.u95,
        (a, b) => a.is_none() && b.is_none(),
    };
    let stays = |a: &MethodCandidate, b: &MethodCandidate| within(a.speed, b.speed) && within(a.k, b.k);
    let first = (0..all.len()).find(|&i| all[i].consistent && all[i + 1..].iter().all(|b| stays(&all[i], b)));
    // Where a finding takes the numbers away the table has none to hold the rung to.
    let is_told = all.iter().any(|candidate| candidate.k.is_some());
    assert!(!is_told || all[first.unwrap_or(all.len() - 1)].rung == choice.rung, "{name}");
    if let Some((before, said)) = text.split_once(" closures the worst, ") {
        let count = before.rsplit(' ').next().and_then(|count| count.parse().ok());
        assert_eq!(count, Some(choice.closures.len()), "{name}");
        // Of "level of A1" and "level of A11" it is the longer one.
        let named = choice.closures.iter().filter(|closure| said.starts_with(&closure.name));
        let worst = named.max_by_key(|closure| closure.name.len()).expect("a closure");
        let most_in_u = choice.closures.iter().map(dropcheck::data::Consistency::largest_residual);
        assert!(most_in_u.max_by(f64::total_cmp) <= Some(worst.largest_residual()), "{name}: {said:.200}");
    }
    let moved = choice.adjustments.iter().map(|input| input.moved_in_u.abs());
    assert!(moved.is_sorted_by(|a, b| a >= b), "{name}: what the joint fit moves, the largest first");
    Some(())
}

/// The inputs that nothing tests, by what a mistake moves in half-widths.
fn hold_untested(result: &DropResult, name: &str) {
    let in_half_widths =
        |by: Option<f64>, of: Option<Estimate>| by.zip(of).map_or(0.0, |(by, of)| by / of.u95);
    let effects = result.untested.iter().map(|input| {
        let speed = in_half_widths(input.moves.slap_down_speed_m_s, result.slap_down.speed);
        in_half_widths(input.moves.k, result.k).max(speed)
    });
    // Of numbers that are written with all their digits.
    assert!(effects.is_sorted_by(|a, b| *a >= *b * (1.0 - 1e-9)), "{name}: {:?}", result.untested);
}

/// "The largest for the speed is drop angle (41 % of the variance), for k …" beside the table of all inputs.
fn hold_budget(result: &DropResult, text: &str, name: &str) -> Option<()> {
    let change = |of: fn(&Contribution) -> Option<f64>| {
        let all = result.budget.iter().filter_map(move |input| Some((&input.input[..], of(input)?.abs())));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(input, _)| input)
    };
    let (_, said) = text.split_once("The largest for ")?;
    let largest = change(if said.starts_with("the speed") { |c| c.speed_m_s } else { |c| c.k })?;
    let (_, named) = said.split_once(" is ")?;
    assert!(named.starts_with(largest), "{name}: {largest}, not {named:.60}");
    Some(())
}

/// Holds all sentences of these reports; returns what decided for the number of modes.
fn hold(reports: &[(String, Analysis)]) -> Vec<&'static str> {
    let mut ways = Vec::new();
    for (name, analysis) in reports {
        let (result, text) = (&analysis.result, text(analysis));
        hold_model(result, name);
        ways.extend(hold_flight(result, &text, name));
        hold_reconstruction(result, &text, name);
        hold_budget(result, &text, name);
        hold_untested(result, name);
        hold_verdict(analysis, name);
        assert!(!text.contains("was taken, and every velocity goes with it"), "{name}");
    }
    ways
}

fn hold_verdict(analysis: &Analysis, name: &str) {
    let result = &analysis.result;
    let shown =
        |width| anstream::adapter::strip_str(&report::first_screen(analysis, None, width)).to_string();
    for (width, most) in [(60, 16), (80, 10), (120, 10), (160, 10)] {
        let screen = shown(width);
        assert!((3..=most).contains(&screen.lines().count()) && !screen.contains('…'), "{name}: {screen}");
        assert!(screen.lines().all(|line| line.chars().count() <= width), "{name}: {screen}");
        // The three of the largest effect, whole, and where the others are.
        let flat = screen.split_whitespace().collect::<Vec<_>>().join(" ");
        let unchecked = &result.untested;
        assert!(unchecked.iter().take(3).all(|input| flat.contains(&input.what)), "{name}: {screen}");
        assert_eq!(flat.contains("`--full` lists all"), unchecked.len() > 3, "{name}: {screen}");
    }
    let word = shown(80);
    let stated = [result.k, result.slap_down.speed].iter().flatten().count();
    let expected = match (result.verdict, stated) {
        (Verdict::Pass, _) => "DATA SOUND  ",
        (Verdict::Review, _) => "REVIEW  ",
        (Verdict::Fail, 0) => "NOT TO BE USED  ",
        (Verdict::Fail, _) => "PARTLY USABLE  ",
    };
    assert!(word.starts_with(expected), "{name}: {word}");
    assert_eq!(word.contains("k is valid"), stated == 1 && result.k.is_some(), "{name}: {word}");
}

#[test]
fn what_is_called_first_simplest_lowest_or_largest_is_it() {
    let ways = hold(&reports(4));
    for way in ["lowest", "smallest"] {
        assert!(ways.contains(&way), "no report shows {way}: {ways:?}");
    }
}

#[test]
#[ignore = "fifty drawn drops: .ci/long"]
fn sentences_of_fifty_drawn_drops_hold() {
    hold(&reports(50));
}

/// The keys of `[observed]` with the place of the same in the result.
const OBSERVED: [(&str, &str); 7] = [
    ("slap_down_speed_m_s", "/slap_down/speed"),
    ("local_speed_m_s", "/slap_down/local_speed"),
    ("k", "/k"),
    ("angular_velocity_rad_s", "/first_impact/angular_velocity"),
    ("angle_deg", "/slap_down/angle"),
    ("flight_time_s", "/slap_down/flight_time"),
    ("impact_velocity_m_s", "/first_impact/impact_velocity"),
];

#[test]
fn an_observation_equal_to_the_reported_number_agrees_and_a_limit_takes_the_same_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut corners = 0;
    for (recording, cask) in examples() {
        let before = analyze(&recording, &cask).json();
        let (mut observed, mut limits) = (String::new(), String::new());
        for (key, place) in OBSERVED {
            let Some(value) = before.pointer(&format!("{place}/value")).and_then(serde_json::Value::as_f64)
            else {
                continue;
            };
            let _ = writeln!(observed, "{key} = {{ value = {value:?}, u95 = 1e-6 }}");
            if ["slap_down_speed_m_s", "local_speed_m_s", "k"].contains(&key) {
                let _ = writeln!(limits, "{key} = {{ most = {value:?} }}");
            }
        }
        let stated = fs::read_to_string(&cask).expect("a cask file");
        let beside = folder.path().join(cask.file_name().expect("a name"));
        fs::write(&beside, format!("{stated}\n[observed]\n{observed}\n[limits]\n{limits}")).expect("room");
        let result = analyze(&recording, &beside).json();
        assert_eq!(result["verdict"], before["verdict"], "{}", recording.display());
        assert!(result["quality"].as_array().expect("findings").iter().all(|f| f["code"] != "observed"));
        for row in result["observed"].as_array().expect("rows") {
            let (_, place) = OBSERVED.into_iter().find(|(key, _)| row["name"] == *key).expect("a key");
            assert_eq!(&row["result"], result.pointer(place).expect("it"), "{row}");
            // JSON is read to the last bit but one, 1e-16 of the number; half-widths are 1e-3 of it and more.
            assert!(row["e_n"].as_f64().is_some_and(|e_n| e_n.abs() < 1e-12), "{row}");
        }
        for row in result["limits"].as_array().expect("rows") {
            let (_, place) = OBSERVED.into_iter().find(|(key, _)| row["name"] == *key).expect("a key");
            assert_eq!(&row["measured"], result.pointer(place).expect("it"), "{row}");
            assert_eq!(row["state"], "undecided", "{row}");
            corners += usize::from(row["name"] == "local_speed_m_s");
        }
    }
    assert!(corners > 3, "{corners}");
}

#[test]
fn a_number_of_the_full_tables_has_one_value_under_one_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let stated = fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    let cask = folder.path().join("c.toml");
    let more = "[observed]\nslap_down_speed_m_s = { value = 18.2, u95 = 0.3, by = \"film\" }\n\
                local_speed_m_s = { value = 18.2, u95 = 0.3 }\n\
                [limits]\nslap_down_speed_m_s = { most = 25.0 }\nlocal_speed_m_s = { most = 25.0 }\n";
    fs::write(&cask, format!("{stated}\n{more}")).expect("room");
    let answer = dropcheck(words!["analyze", fixture("anf18-json.mcap"), "--cask", cask, "--full"]);
    let said = answer.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    // What a film shows of the corner is no observation of the rigid cask's speed.
    for row in [
        "the slap-down speed of the rigid cask is 20.59 ± 0.37 m/s, but was observed by film as 18.2 ± 0.3 \
         m/s",
        " speed (rigid cask) 20.59 ± 0.37 m/s",
        " speed (corner) 18.18 ± 0.45 m/s",
        "slap-down speed of the rigid cask 20.59 ± 0.37 m/s – 25 kept",
        "speed of the corner that strikes 18.18 ± 0.45 m/s – 25 kept",
    ] {
        assert!(said.contains(row), "{row}: {}", answer.stdout);
    }
    assert!(!said.to_lowercase().contains("slap_down_speed_m_s is"), "{said}");
}

#[test]
fn a_limit_that_is_exceeded_stands_first_and_ends_with_1_here_and_in_a_batch() {
    let folder = tempfile::tempdir().expect("a folder");
    let stated = fs::read_to_string(fixture("anf18-json.toml")).expect("a cask file");
    let (cask, out) = (folder.path().join("c.toml"), folder.path().join("out"));
    let recording = fixture("anf18-json.mcap");
    let with = |limits: &str| {
        fs::write(&cask, format!("{stated}\n[limits]\n{limits}\n")).expect("room");
        let answer = dropcheck(words!["analyze", recording, "--cask", cask, "--out", out]);
        let page = fs::read_to_string(out.join("report.html")).expect("a page");
        (answer.status, answer.stdout, page)
    };
    let all_exceeded = "slap_down_speed_m_s = { most = 10.0 }\nlocal_speed_m_s = { most = 10.0 }\n\
                        k = { most = 0.1 }\nrigid_body_deceleration_g = { most = 1.0 }\n\
                        force_mn = { most = 0.1 }\ncrush_mm = { most = 1.0 }\nenergy_kj = { least = 1e4 }";
    // 20.59 ± 0.37 m/s, k 0.556 ± 0.035, crush 42 ± 35 mm.
    for (limits, status, first) in [
        (
            "crush_mm = { most = 5.0 }\nk = { most = 0.56 }\nslap_down_speed_m_s = { most = 25.0 }",
            1,
            "LIMIT EXCEEDED  crush 42 ± 35 mm (at most 5 mm); undecided: coefficient of restitution \
             0.556 ± 0.035 (at most 0.56); 1 kept",
        ),
        (
            all_exceeded,
            1,
            "LIMIT EXCEEDED  slap-down speed of the rigid cask 20.59 ± 0.37 m/s (at most 10 m/s);",
        ),
        ("k = { most = 0.56 }\ncrush_mm = { most = 100.0 }", 0, "DATA SOUND"),
        ("crush_mm = { most = 100.0 }", 0, "DATA SOUND"),
    ] {
        let (ended, screen, page) = with(limits);
        assert_eq!(ended, status, "{limits}: {screen}");
        let lines: Vec<&str> = screen.lines().collect();
        let flat = screen.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.starts_with(&first.replace("  ", " ")), "{first}: {screen}");
        assert!(
            lines.iter().any(|line| line.starts_with("DATA SOUND  ")) && lines.len() <= 16,
            "the data are as they were: {screen}"
        );
        // A page has it before the verdict, and names the rule.
        let banners: Vec<&str> = page.split("role=\"status\"><strong>").skip(1).collect();
        let words: Vec<&str> = banners.iter().filter_map(|b| b.split('<').next()).collect();
        let is_exceeded = status == 1;
        assert_eq!(
            words,
            if is_exceeded { vec!["LIMIT EXCEEDED", "DATA SOUND"] } else { vec!["DATA SOUND"] }
        );
        assert_eq!(page.contains(">Limits: "), !is_exceeded, "a row of page 1 where none is exceeded");
        let rule = "guard band of ± (JCGM 106:2012, 8.3)";
        assert!(page.contains(rule) && flat.contains(rule), "{screen}");
    }
    let (_, screen, _) = with(all_exceeded);
    assert!(screen.contains("4 more (`--full`)"), "{screen}");
    let batch = folder.path().join("batch");
    // A cask file of its name beside it would go before the one that is named.
    let alone = folder.path().join("drop.mcap");
    fs::copy(&recording, &alone).expect("room");
    let answer = dropcheck(words!["batch", alone, "--cask", cask, "--out", batch]);
    let row = &read_json(&batch.join("campaign.json"))["recordings"][0];
    assert_eq!(
        (answer.status, &row["exit"], &row["verdict"]),
        (1, &1.into(), &"pass".into()),
        "{}",
        answer.stdout
    );
    assert_eq!(row["exceeded"].as_array().map(Vec::len), Some(7), "{row}");
    let said = answer.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("1 beyond a limit. Outliers") && said.contains("exceeds its limit of crush_mm,"),
        "{said}"
    );
    assert_eq!(dropcheck(words!["batch", recording, "--cask", cask, "--exit-zero"]).status, 0);
}

#[test]
fn one_impact_beyond_a_limit_exceeds_it_whatever_the_other_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, stated) = (fixture("damaged-ends-early.csv"), fixture("damaged-ends-early.toml"));
    let first = analyze(&recording, &stated).json()["impacts"][0]["crush"]["value"].as_f64();
    let Some(first_mm) = first.map(|m| 1e3 * m) else { panic!("the first impact is recorded") };
    let cask = folder.path().join("c.toml");
    for (share, state) in [(0.5, "exceeded"), (2.0, "undecided")] {
        let limit = format!("[limits]\ncrush_mm = {{ most = {:?} }}\n", share * first_mm);
        let stated = fs::read_to_string(&stated).expect("a cask file");
        fs::write(&cask, format!("{stated}\n{limit}")).expect("room");
        assert_eq!(analyze(&recording, &cask).json()["limits"][0]["state"], state, "{limit}");
    }
}

#[test]
fn two_loggers_in_one_table_each_with_its_own_times_are_no_contradiction() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = fs::read_to_string(fixture("anf10-plain.csv")).expect("an example");
    let stated = fs::read_to_string(fixture("anf10-plain.toml")).expect("its cask file");
    let (path, cask) = (folder.path().join("two.csv"), folder.path().join("two.toml"));
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let mut two = "Time 1 [s],A1,Time 2 [s],A2\n".to_owned();
    for (i, row) in rows.iter().enumerate() {
        // The second logger has every other sample, and ends half-way down the table.
        let other = rows.get(2 * i).map_or(",".to_owned(), |other| format!("{},{}", other[0], other[2]));
        let _ = writeln!(two, "{},{},{other}", row[0], row[1]);
    }
    fs::write(&path, two).expect("room");
    let named = stated
        .replace("source = \"A1\"", "source = \"A1\"\ntime = \"Time 1\"")
        .replace("source = \"A2\"", "source = \"A2\"\ntime = \"Time 2\"");
    let with = |cask_text: &str| {
        fs::write(&cask, cask_text).expect("room");
        analyze(&path, &cask)
    };
    let result = with(&named).json();
    let found = result["quality"].as_array().expect("findings").iter();
    assert_eq!(found.filter(|finding| finding["code"] == "clock").count(), 0, "{result}");
    let rates = [0, 1].map(|i| result["channels"][i]["sample_rate_hz"].as_f64().expect("a rate").round());
    assert!(
        rates.iter().zip([12_500.0, 6_250.0]).all(|(rate, stated)| (rate - stated).abs() < 1e-6),
        "{rates:?}"
    );
    // Without a name each channel has the times at its left.
    let unnamed = with(&stated).json();
    assert_eq!(unnamed["channels"][1]["sample_rate_hz"], result["channels"][1]["sample_rate_hz"]);
    assert_eq!(unnamed["k"]["value"], result["k"]["value"]);
}
