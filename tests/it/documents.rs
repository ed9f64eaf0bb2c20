//! From the pages that a person wrote to their budget: words, length of lines, links that lead somewhere,
//! answers that are the program's.

mod numbers;
mod paper;

use crate::run::{analyze, dropcheck, files_below, fixture, root, truth};
use dropcheck::data::CODES;
use dropcheck::report::{CampaignColumn, campaign_columns};
use dropcheck::stages::{Allowed, INNER_TABLES, TABLES, Takes};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// What a newcomer reads in five minutes, words.
const README_WORDS: usize = 1300;
/// Words of all pages that a person writes, without `docs/measured` and the generated tables.
const ALL_WORDS: usize = 24_000;
/// Characters of a line of prose; tables and code may be wider.
const WIDTH: usize = 120;

/// README, guide of contributors, changelog and `docs`, without what programs write.
fn written_pages() -> Vec<PathBuf> {
    let mut pages = files_below(&root().join("docs"), "md");
    pages.retain(|page| !page.starts_with(root().join("docs/measured")));
    pages.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root().join(name)));
    assert!(pages.len() > 15, "the pages were not found: {pages:?}");
    pages
}

/// The pages beside fixtures, finite elements, fuzzing, module and packages.
fn pages_beside() -> [PathBuf; 6] {
    [
        "fixtures/README.md",
        "fixtures/reference/fe/README.md",
        "tests/fuzz/README.md",
        "python/README.md",
        "packaging/RELEASING.md",
        "packaging/START.md",
    ]
    .map(|name| root().join(name))
}

fn text(page: &Path) -> String {
    fs::read_to_string(page).unwrap_or_else(|error| panic!("{}: {error}", page.display()))
}

/// Lines of a page with their number, without fenced and indented code.
fn lines_without_code(text: &str) -> Vec<(usize, &str)> {
    let mut is_code = false;
    let outside = |(_, line): &(usize, &str)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence && !line.starts_with("    ")
    };
    text.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(outside).collect()
}

/// What stands in the brackets of `](…)`, code in backticks left out.
fn links(text: &str) -> Vec<String> {
    let lines: Vec<&str> = lines_without_code(text).into_iter().map(|(_, line)| line).collect();
    let prose: String = lines.join(" ").split('`').step_by(2).collect();
    prose.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(to, _)| to.to_owned()).collect()
}

/// The anchor of each heading, as code hosts make them: `## What is left, 2` is `what-is-left-2`.
fn anchors(text: &str) -> Vec<String> {
    let headings = lines_without_code(text).into_iter().filter_map(|(_, line)| {
        let title = line.trim_start_matches('#');
        (title.len() < line.len()).then_some(title.trim())
    });
    let is_kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    headings
        .map(|title| title.to_lowercase().chars().filter(is_kept).collect::<String>().replace(' ', "-"))
        .collect()
}

/// The first block of a page's code that begins with the command, without that line.
fn answer<'a>(page: &'a str, command: &str) -> &'a str {
    let (_, rest) = page.split_once(&format!("$ {command}")).expect("the command");
    let (_, block) = rest.split_once('\n').expect("an answer");
    block.split("```").next().unwrap_or_default()
}

/// The lines that stand around a generated table.
fn marks(name: &str) -> [String; 2] {
    ["begin", "end"].map(|side| format!("<!-- {name}: {side} -->\n"))
}

/// Who writes a page: tests run beside each other.
static PAGES: Mutex<()> = Mutex::new(());

/// Holds the table of a page between its marks equal to what the program has; `BLESS=1` writes it.
fn hold(page: &str, name: &str, table: &str) {
    let _alone = PAGES.lock().unwrap_or_else(PoisonError::into_inner);
    let path = root().join(page);
    let (written, [begin, end]) = (text(&path), marks(name));
    let (before, rest) = written.split_once(&begin).expect("the mark before the table");
    let (found, after) = rest.split_once(&end).expect("the mark behind the table");
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, [before, &begin, table, &end, after].concat()).expect("the page can be written");
    } else {
        assert_eq!(found, table, "{page}: write the table `{name}` with BLESS=1");
    }
}

/// The unit that the name of a key ends in.
fn unit(key: &str) -> &'static str {
    let units = [
        ("_e_n", ""),
        ("_kg_m2", "kg m²"),
        ("_m_s2", "m/s²"),
        ("_rad_s", "rad/s"),
        ("_deg_s", "°/s"),
        ("_n_s", "N s"),
        ("_n", "N"),
        ("_j", "J"),
        ("_m_s", "m/s"),
        ("_percent", "%"),
        ("_deg", "°"),
        ("_kg", "kg"),
        ("_hz", "Hz"),
        ("_m", "m"),
        ("_s", "s"),
        ("_c", "°C"),
    ];
    units.iter().find(|(ending, _)| key.ends_with(ending)).map_or("", |(_, unit)| unit)
}

/// The table of the keys of a cask file: a row for each table, then one for each of its keys.
fn table_of_keys() -> String {
    let mut rows =
        "| key | unit | example | default | meaning and range |\n|---|---|---|---|---|\n".to_owned();
    let code = |text: &str| if text.is_empty() { String::new() } else { format!("`{text}`") };
    let number = |n: f64| if n.abs() < 1e5 { n.to_string() } else { format!("{n:e}") };
    for table in &TABLES {
        let name = match table.name {
            name if INNER_TABLES.contains(&name) => format!("{name} = {{ … }}"),
            "channel" => "[[channel]]".to_owned(),
            name => format!("[{name}]"),
        };
        let _ = writeln!(rows, "| **`{name}`** | | | | {} |", table.remark);
        for key in table.keys {
            let range = match key.takes {
                Takes::Number(Allowed::FromZero) => "0 or more".to_owned(),
                Takes::Number(Allowed::AboveZero) => "above 0".to_owned(),
                Takes::Number(Allowed::Within(least, most, _)) => {
                    format!("{} to {}", number(least), number(most))
                }
                Takes::Number(Allowed::ZeroOrWithin(least, most, _)) => {
                    format!("0, or {} to {}", number(least), number(most))
                }
                _ => String::new(),
            };
            let meaning =
                [key.remark, &range].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>();
            let cells =
                [&code(key.name), unit(key.name), &code(key.example), key.default, &meaning.join("; ")];
            let _ = writeln!(rows, "| {} |", cells.join(" | "));
        }
    }
    rows
}

#[test]
fn the_table_of_keys_is_that_of_the_program() {
    hold("docs/formats.md", "keys", &table_of_keys());
}

#[test]
fn the_table_of_columns_is_that_of_the_program() {
    let mut rows = "| column | unit | meaning |\n|---|---|---|\n".to_owned();
    for CampaignColumn { names, meaning, .. } in campaign_columns() {
        let _ = writeln!(rows, "| `{}` | {} | {meaning} |", names.join("`, `"), unit(&names[0]));
    }
    hold("docs/formats.md", "columns", &rows);
}

#[test]
fn the_table_of_checks_is_that_of_the_program_and_each_has_its_section() {
    let word = |code| serde_json::to_value(code).expect("a word").as_str().expect("a word").to_owned();
    let mut rows = "| about | code | a finding means |\n|---|---|---|\n".to_owned();
    let mut codes = Vec::new();
    for group in ["File", "Channel", "Channels together", "Drop"] {
        for (_, (code, meaning)) in CODES.iter().filter(|(own, _)| *own == group) {
            codes.push(word(code));
            let _ = writeln!(rows, "| {group} | [`{0}`](#{0}) | {meaning} |", word(code));
        }
    }
    assert_eq!(codes.len(), CODES.len(), "a check of no group");
    hold("docs/quality.md", "codes", &rows);
    let page = text(&root().join("docs/quality.md"));
    let sections: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    assert_eq!(sections, codes, "docs/quality.md: a section for each code, in the order of the table");
}

#[test]
fn the_pages_keep_their_budget_of_words() {
    let is_word = |word: &&str| word.contains(char::is_alphanumeric); // the bars of tables are none
    let count = |page: &PathBuf| numbers::by_hand(&text(page)).split_whitespace().filter(is_word).count();
    let readme = count(&root().join("README.md"));
    assert!(readme < README_WORDS, "the README has {readme} words, below {README_WORDS} is meant");
    let counts: Vec<(usize, PathBuf)> =
        written_pages().into_iter().map(|page| (count(&page), page)).collect();
    let all: usize = counts.iter().map(|(words, _)| words).sum();
    assert!(all < ALL_WORDS, "{all} words, below {ALL_WORDS} is meant: {counts:#?}");
}

#[test]
fn lines_of_prose_fit_a_window() {
    let mut wide = Vec::new();
    for page in written_pages().into_iter().chain(pages_beside()) {
        let text = text(&page);
        for (number, line) in lines_without_code(&text) {
            let length = numbers::as_shown(line).chars().count();
            if length >= WIDTH && !line.trim_start().starts_with('|') {
                wide.push(format!("{}:{number}: {length} characters", page.display()));
            }
        }
    }
    assert!(wide.is_empty(), "prose is below {WIDTH} characters a line:\n{}", wide.join("\n"));
}

#[test]
fn no_page_holds_a_half_merged_passage() {
    let is_mark =
        |line: &&str| line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> ") || *line == "=======";
    for page in written_pages() {
        assert_eq!(text(&page).lines().find(is_mark), None, "{}", page.display());
    }
}

#[test]
fn links_lead_somewhere() {
    let mut dead = Vec::new();
    let mut looked_at = 0;
    for page in
        files_below(&root().join("docs"), "md").into_iter().chain(written_pages()).chain(pages_beside())
    {
        for link in links(&text(&page)) {
            if link.starts_with("http") {
                continue;
            }
            looked_at += 1;
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            let is_there = target.exists()
                && (anchor.is_empty() || anchors(&text(&target)).iter().any(|found| found == anchor));
            if !is_there {
                dead.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(looked_at > 100, "the links were not found: {looked_at}");
    assert!(dead.is_empty(), "links that lead nowhere:\n{}", dead.join("\n"));
}

#[test]
fn source_files_that_the_pages_name_are_there() {
    let (mut gone, mut looked_at) = (Vec::new(), 0);
    for page in written_pages().into_iter().chain(pages_beside()) {
        let text = text(&page);
        let prose: Vec<&str> = lines_without_code(&text).into_iter().map(|(_, line)| line).collect();
        let prose = prose.join(" ");
        let is_rust = |path: &Path| path.extension().is_some_and(|extension| extension == "rs");
        let is_file = |word: &&str| word.contains('/') && !word.contains(' ') && is_rust(Path::new(word));
        for name in prose.split('`').skip(1).step_by(2).filter(is_file) {
            looked_at += 1;
            if !["", "src"].iter().any(|folder| root().join(folder).join(name).exists()) {
                gone.push(format!("{}: {name}", page.display()));
            }
        }
    }
    assert!(looked_at > 50, "the names were not found: {looked_at}");
    assert!(gone.is_empty(), "files that are not there:\n{}", gone.join("\n"));
}

#[test]
fn what_the_pages_show_is_what_the_program_says() {
    let page = text(&root().join("README.md"));
    let shown = answer(&page, "dropcheck analyze fixtures/examples/anf18-json.mcap");
    let golden = text(&root().join("tests/golden/anf18-json.txt"));
    assert!(golden.starts_with(shown), "README.md shows another table than tests/golden/anf18-json.txt");

    let words = "predict --cask fixtures/examples/anf18-json.toml --k 0.5 --contact 0.4 \
                 --k-range 0.3:0.7 --friction-range 0.2:0.6";
    let page = text(&root().join("docs/predicting.md"));
    let shown = answer(&page, &format!("dropcheck {words}"));
    let cask = root().join("fixtures/examples/anf18-json.toml");
    let words: Vec<String> = words
        .split(' ')
        .map(|word| word.replace("fixtures/examples/anf18-json.toml", &cask.to_string_lossy()))
        .collect();
    let said = dropcheck(&words).stdout;
    assert!(said.starts_with(shown), "docs/predicting.md shows another table than the program:\n{said}");
}

/// The names of all fields of a JSON value.
fn keys(value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(fields) => {
            for (key, inner) in fields {
                found.insert(key.clone());
                keys(inner, found);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| keys(item, found)),
        _ => {}
    }
}

#[test]
fn every_field_of_the_result_is_documented() {
    let mut result = analyze(&fixture("vhlw-rest.h5"), &fixture("vhlw-rest.toml")).json();
    // Its keys are those of the cask file, whose table another test holds.
    assert_eq!(
        result["settings"]["cask"]["mass_kg"],
        serde_json::json!({"value": 20_950.0, "from": "stated"})
    );
    result["settings"] = Value::Null;
    let mut found = BTreeSet::new();
    keys(&result, &mut found);
    assert!(found.len() > 100, "{found:?}");
    let page = text(&root().join("docs/formats.md"));
    let (_, chapter) = page.split_once("\n## result.json\n").expect("the chapter");
    let (chapter, _) = chapter.split_once("\n## ").expect("its end");
    found.retain(|key| !chapter.contains(&format!("\"{key}\"")));
    assert!(found.is_empty(), "docs/formats.md, result.json, does not name {found:?}");
}

#[test]
fn the_page_of_dependencies_names_every_direct_crate() {
    let manifest: toml::Table = text(&root().join("Cargo.toml")).parse().unwrap();
    let page = text(&root().join("docs/dependencies.md"));
    let targets = manifest["target"].as_table().unwrap().values().map(|target| &target["dependencies"]);
    for crates in [&manifest["dependencies"], &manifest["dev-dependencies"]].into_iter().chain(targets) {
        for name in crates.as_table().unwrap().keys() {
            assert!(page.contains(&format!("`{name}`")), "docs/dependencies.md does not name {name}");
        }
    }
}

/// A recorded "20.62 ± 0.40" with its digits cut to two of the half-width, as reports round it.
fn rounded(recorded: &str) -> String {
    let numbers = recorded
        .split_once(" ± ")
        .and_then(|(value, u95)| value.parse::<f64>().ok().zip(u95.parse::<f64>().ok()));
    let Some((value, u95)) = numbers else { return "–".to_owned() };
    let decimals = (0_u8..9).find(|d| (u95 * 10_f64.powi((*d).into())).round() >= 10.0).unwrap_or(9).into();
    format!("{value:.decimals$} ± {u95:.decimals$}")
}

/// What the program says of each example as `tests/same` records it, beside its truth.
#[test]
fn the_table_of_fixtures_is_that_of_the_program() {
    let mut rows = "| recording | expect | findings | speed | true speed | k | true k |\n\
                    |---|---|---|---|---|---|---|\n"
        .to_owned();
    for line in text(&root().join("tests/same/fixtures.tsv")).lines() {
        let cells: Vec<&str> = line.split('\t').collect();
        let [name, verdict, codes, speed, k, ..] = cells[..] else { continue };
        if !root().join("fixtures/examples").join(name).exists() {
            continue;
        }
        let truth = truth(name.split('.').next().expect("a stem"));
        let known =
            |key: &str, decimals: usize| format!("{:.decimals$}", truth[key].as_f64().expect("a truth"));
        let _ = writeln!(
            rows,
            "| `{name}` | {verdict} | {codes} | {} | {} | {} | {} |",
            rounded(speed),
            known("speed", 2),
            rounded(k),
            known("k", 3)
        );
    }
    hold("fixtures/README.md", "expected", &rows);
}
