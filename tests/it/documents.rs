//! From the pages that a person wrote to their budget: words, length of lines, links that lead somewhere,
//! answers that are the program's.

use crate::run::{analyze, dropcheck, files_below, fixture, root};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What a newcomer reads in five minutes, words.
const README_WORDS: usize = 1350;
/// Words of all pages, but for `docs/measured`, which programs write.
const ALL_WORDS: usize = 30_000;
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

/// The pages beside fixtures, fuzzing, module and packages.
fn pages_beside() -> [PathBuf; 4] {
    ["fixtures/README.md", "tests/fuzz/README.md", "python/README.md", "packaging/RELEASING.md"]
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

#[test]
fn the_pages_keep_their_budget_of_words() {
    let is_word = |word: &&str| word.contains(char::is_alphanumeric); // the bars of tables are none
    let count = |page: &PathBuf| text(page).split_whitespace().filter(is_word).count();
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
            let length = line.chars().count();
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
