//! From the numbers in prose to where each comes from: a table that a program wrote, or a definition.
//!
//! A measured number stands in a mark, `<!-- FILE › ROW › COLUMN -->97.2 %<!-- / -->`: the page of `docs`
//! without `.md`, the first cells of the table's row, the head of the column. `BLESS=1` writes what the cell
//! holds.

use super::{PAGES, lines_without_code, pages_beside, text, written_pages};
use crate::moved;
use crate::run::root;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::PoisonError;

const OPENS: &str = "<!-- ";
const CLOSES: &str = "<!-- / -->";
/// Between the parts of an address: a bar would end the cell of a table.
const BETWEEN: &str = " › ";

/// Words of a sentence that says what was measured.
const MEASURED: [&str; 23] = [
    "simulat",
    "measured",
    "drops",
    "scenes",
    "seed ",
    "median",
    "percentile",
    "intervals hold",
    "held in",
    " MB",
    " kB",
    " GB",
    " MiB",
    " GiB",
    "processor time",
    "minutes",
    "seconds on",
    "in version",
    "executions",
    "killed",
    "reached",
    "at most off",
    "were missed",
];

/// Tables of a page: the cells of each head and of each row.
fn tables(page: &str) -> Vec<Vec<Vec<String>>> {
    let cells = |line: &str| -> Vec<String> {
        line.trim()
            .trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().trim_matches('`').to_owned())
            .collect()
    };
    let is_rule =
        |row: &Vec<String>| row.iter().all(|cell| !cell.is_empty() && cell.chars().all(|c| "-:".contains(c)));
    let lines: Vec<&str> = page.lines().collect();
    let blocks = lines.chunk_by(|a, b| a.starts_with('|') == b.starts_with('|'));
    let table = |block: &[&str]| block.iter().map(|line| cells(line)).filter(|row| !is_rule(row)).collect();
    blocks.filter(|block| block[0].starts_with('|')).map(table).collect()
}

/// The cell at an address, the one table of its page that has it.
fn cell(address: &str) -> String {
    let parts: Vec<&str> = address.split(BETWEEN).collect();
    let [file, row @ .., column] = &parts[..] else { panic!("{address}: FILE › ROW › COLUMN") };
    let page = text(&root().join("docs").join(format!("{file}.md")));
    let mut found = Vec::new();
    for table in tables(&page) {
        let Some(at) = table[0].iter().position(|head| head == column) else { continue };
        let rows = table[1..].iter().filter(|cells| row.iter().zip(*cells).all(|(key, cell)| key == cell));
        found.extend(rows.map(|cells| cells[at].clone()));
    }
    found.dedup();
    assert_eq!(found.len(), 1, "{address}: {found:?}");
    // A terminal has no heads: there a cell says "found 0.7".
    found.swap_remove(0).trim_start_matches(column).trim().to_owned()
}

/// Runs over the marks of a page: what stands before each, its address, what it holds; then the rest.
fn with_marks(page: &str, mut each: impl FnMut(&str, &str, &str)) -> String {
    let mut rest = page;
    let mut start = 0;
    while let Some(begin) = rest[start..].find(OPENS).map(|at| start + at) {
        let Some((address, after)) = rest[begin + OPENS.len()..].split_once(" -->") else { break };
        if !address.contains(BETWEEN) {
            start = begin + OPENS.len();
            continue;
        }
        let (value, after) =
            after.split_once(CLOSES).unwrap_or_else(|| panic!("no {CLOSES} behind {address}"));
        each(&rest[..begin], address, value);
        (rest, start) = (after, 0);
    }
    rest.to_owned()
}

/// A page without what programs wrote into it: tables between marks, and numbers in marks.
pub(super) fn by_hand(page: &str) -> String {
    let mut kept = String::new();
    let rest = with_marks(page, |before, _, _| kept.push_str(before));
    let mut page = kept + &rest;
    while let Some(begin) = page.find(": begin -->\n") {
        let from = page[..begin].rfind(OPENS).expect("the start of the mark");
        let end = format!("{}: end -->\n", &page[from..begin]);
        let length = page[from..].find(&end).unwrap_or_else(|| panic!("no {end}")) + end.len();
        page.replace_range(from..from + length, "");
    }
    page
}

/// A line as a reader sees it: without the marks around numbers.
pub(super) fn as_shown(line: &str) -> String {
    let mut shown = String::new();
    let rest = with_marks(line, |before, _, value| shown.extend([before, value]));
    shown + &rest
}

/// The pages that a person wrote, with their names; `docs/measured` has one beside the tables.
fn pages() -> impl Iterator<Item = (String, std::path::PathBuf)> {
    let name = |page: &Path| page.strip_prefix(root()).expect("a page of this folder").display().to_string();
    let measured = root().join("docs/measured/performance.md");
    let all = written_pages().into_iter().chain(pages_beside()).chain([measured]);
    all.map(move |page| (name(&page), page))
}

#[test]
fn a_number_in_a_mark_is_that_of_the_table_it_names() {
    let _alone = PAGES.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut aged, mut looked_at) = (Vec::new(), 0);
    for (name, path) in pages() {
        let page = text(&path);
        let mut renewed = String::new();
        let rest = with_marks(&page, |before, address, value| {
            looked_at += 1;
            let found = cell(address);
            if found != value {
                aged.push(format!("{name}: {address} is {found}, not {value}"));
            }
            renewed.extend([before, OPENS, address, " -->", &found, CLOSES]);
        });
        if moved::is_renewed() {
            fs::write(&path, renewed + &rest).expect("the page can be written");
        }
    }
    assert!(looked_at > 20, "the marks were not found: {looked_at}");
    assert!(aged.is_empty() || moved::is_renewed(), "write these with BLESS=1:\n{}", aged.join("\n"));
}

/// Sentences of a page that a person wrote, each behind the heading above it: without code, links and what
/// programs wrote.
fn sentences(page: &str) -> Vec<(String, String)> {
    let page = by_hand(page);
    let lines = lines_without_code(&page);
    let mut found: Vec<(String, String)> = Vec::new();
    let (mut heading, mut passage, mut last) = (String::new(), String::new(), 0);
    let mut flush = |heading: &str, passage: &mut String| {
        let prose = without_links(&passage.split('`').step_by(2).collect::<String>());
        found.extend(
            prose.split_inclusive(". ").map(|sentence| (heading.to_owned(), sentence.trim().to_owned())),
        );
        passage.clear();
    };
    for (number, line) in lines {
        let begins = ["- ", "* ", "|", "#"].iter().any(|sign| line.trim_start().starts_with(sign));
        if begins || line.trim().is_empty() || number != last + 1 {
            flush(&heading, &mut passage);
        }
        if let Some(title) = line.strip_prefix('#') {
            title.trim_start_matches('#').trim().clone_into(&mut heading);
        } else {
            passage.push(' ');
            passage.push_str(line.trim());
        }
        last = number;
    }
    flush(&heading, &mut passage);
    found.retain(|(_, sentence)| !sentence.is_empty());
    found
}

/// Text without the targets of its links.
fn without_links(text: &str) -> String {
    let mut parts = text.split("](");
    let mut prose = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        prose.push_str(part.split_once(')').map_or(part, |(_, after)| after));
    }
    prose
}

/// Words that hold a number: not the references to equations, `(12)`, nor names such as A1, φ0 and ISO 6487.
fn numbers(sentence: &str) -> Vec<String> {
    let trimmed =
        |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric() && !"%−+".contains(c)).to_owned();
    let mut words: Vec<&str> = sentence.split_whitespace().collect();
    words.retain(|word| {
        !(word.starts_with('(') && word.trim_end_matches(['.', ',', ';', ':']).ends_with(')'))
    });
    let is_number = |word: &String| {
        word.starts_with(|c: char| c.is_ascii_digit() || "−+".contains(c))
            && word.contains(|c: char| c.is_ascii_digit())
    };
    words.into_iter().map(trimmed).filter(is_number).collect()
}

/// Sentences that speak of measurements and state a number that is defined: page, words of it or its
/// #chapter, why.
fn definitions() -> Vec<[String; 3]> {
    let table = text(&root().join("tests/it/documents/definitions.tsv"));
    let row = |line: &str| {
        let cells: Vec<String> = line.split('\t').map(str::to_owned).collect();
        cells.try_into().unwrap_or_else(|cells| panic!("page, words, why: {cells:?}"))
    };
    table.lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

#[test]
fn a_sentence_that_says_what_was_measured_has_its_numbers_from_a_table() {
    let _alone = PAGES.lock().unwrap_or_else(PoisonError::into_inner);
    let definitions = definitions();
    let mut used = vec![false; definitions.len()];
    let mut loose = Vec::new();
    for (name, path) in pages() {
        for (heading, sentence) in sentences(&text(&path)) {
            let is_measured = MEASURED.iter().any(|word| sentence.contains(word));
            if !is_measured || numbers(&sentence).is_empty() {
                continue;
            }
            let is_of = |words: &str| {
                words.strip_prefix('#').map_or(sentence.contains(words), |chapter| heading == chapter)
            };
            match definitions.iter().position(|[page, words, _]| *page == name && is_of(words)) {
                Some(row) => used[row] = true,
                None => loose.push(format!("{name}: {sentence}")),
            }
        }
    }
    assert!(loose.is_empty(), "put these numbers into marks, or take them out:\n{}", loose.join("\n"));
    let stale: Vec<_> = definitions.iter().zip(used).filter(|(_, used)| !used).map(|(row, _)| row).collect();
    assert!(stale.is_empty(), "no page says this: {stale:#?}");
}

/// Each number that a person wrote is a definition: a default, a range, a limit of the code, a constant. One
/// that is changed by hand differs from the record, which `BLESS=1` writes: read the difference.
#[test]
fn the_numbers_that_pages_define_are_those_on_record() {
    let _alone = PAGES.lock().unwrap_or_else(PoisonError::into_inner);
    let mut record =
        "# The words with digits of each chapter that stand in no mark, in their order.\n".to_owned();
    for (name, path) in pages() {
        let mut chapters: Vec<(String, Vec<String>)> = Vec::new();
        for (heading, sentence) in sentences(&text(&path)) {
            if chapters.last().is_none_or(|(last, _)| *last != heading) {
                chapters.push((heading, Vec::new()));
            }
            let words =
                sentence.split_whitespace().filter(|word| word.contains(|c: char| c.is_ascii_digit()));
            chapters.last_mut().expect("a chapter").1.extend(words.map(str::to_owned));
        }
        for (heading, numbers) in chapters.iter().filter(|(_, numbers)| !numbers.is_empty()) {
            let _ = writeln!(record, "{name}\t{heading}\t{}", numbers.join(" "));
        }
    }
    moved::hold(&root().join("tests/same/numbers.tsv"), &record, moved::lines);
}

#[test]
fn a_changed_number_is_found_in_a_mark_and_outside() {
    let page = "## Speed\n\nHalf of 12 drops (3), <!-- a › b › c -->97.2 %<!-- / -->, A1 at `9 m`.\n";
    assert_eq!(by_hand(page), "## Speed\n\nHalf of 12 drops (3), , A1 at `9 m`.\n");
    assert_eq!(as_shown("<!-- a › b › c -->97.2 %<!-- / --> pass"), "97.2 % pass");
    let found: BTreeMap<String, String> = sentences(page).into_iter().collect();
    assert_eq!(numbers(&found["Speed"]), ["12"]);
    assert_eq!(without_links("as [here](a.md#12), [there](b) 3"), "as [here, [there 3");
    let table = "| drops | pass |\n|---|---|\n| `turning` | 97.2 % |\n\n| a | b |\n|---|---|\n";
    assert_eq!(tables(table)[0][1], ["turning", "97.2 %"]);
}
