//! From the source text to who uses whom: holds the layers of `docs/architecture.md`, the length and the
//! first line of files.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Longest file, lines: one sitting's reading.
const LONGEST_FILE: usize = 400;

/// Modules that turn one thing into the next and know only structs and mathematics.
const STAGES: [&str; 9] =
    ["ingest", "condition", "events", "motion", "fit", "predict", "compare", "judge", "report"];

/// What a top-level module may use besides itself; `None` for a module that has no place in the layers yet.
fn allowed(module: &str) -> Option<Vec<&'static str>> {
    match module {
        "data" | "numerics" | "ordered_parallel" => Some(vec![]),
        // The order of the whole, and all of the product, which uses nothing of it.
        "analysis" => Some([&STAGES[..], &["data", "numerics"]].concat()),
        "lab" => Some([&STAGES[..], &["data", "numerics", "analysis", "ordered_parallel"]].concat()),
        stage if STAGES.contains(&stage) => Some(vec!["data", "numerics"]),
        _ => None,
    }
}

pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every Rust file below `directory`, sorted.
pub(crate) fn rust_files(directory: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The module path of a file below `src`: `src/a/b.rs` and `src/a/b/mod.rs` are both `[a, b]`.
pub(crate) fn module_path(file: &Path) -> Vec<String> {
    let relative = file.strip_prefix(root().join("src")).expect("below src").with_extension("");
    let mut parts: Vec<String> = relative.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| last == "mod") {
        parts.pop();
    }
    parts
}

/// The text without comments and strings, so that neither is taken for a path.
pub(crate) fn code_of(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    for line in text.lines() {
        let mut rest = line.split("//").next().unwrap_or_default();
        while let Some((before, after)) = rest.split_once('"') {
            code.push_str(before);
            rest = after.split_once('"').map_or("", |(_, behind)| behind);
        }
        code.push_str(rest);
        code.push('\n');
    }
    code
}

/// The first names of what follows `crate::` or the like: `a::b` gives a, `{a::b, c}` gives a and c.
fn first_names(after: &str) -> Vec<String> {
    let name = |text: &str| -> String {
        text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    let Some(group) = after.strip_prefix('{') else { return vec![name(after)] };
    let (mut depth, mut item, mut names) = (0_i32, String::new(), Vec::new());
    for c in group.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(name(&std::mem::take(&mut item))),
            _ => {}
        }
        item.push(c);
    }
    names.push(name(item.trim_start_matches(',')));
    names.retain(|found| !found.is_empty());
    names
}

/// Top-level modules that `code` in module `path` names, by `crate::` or by climbing out with `super::`.
fn uses(code: &str, path: &[String]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        if !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '$') {
            found.extend(first_names(&code[at + "crate::".len()..]));
        }
    }
    let tests_begin = code.find("mod tests {").unwrap_or(code.len());
    for (at, _) in code.match_indices("super::") {
        if code[..at].ends_with("::") {
            continue;
        }
        let mut after = &code[at..];
        let mut climbed = 0;
        while let Some(behind) = after.strip_prefix("super::") {
            after = behind;
            climbed += 1;
        }
        if climbed == path.len() + usize::from(at > tests_begin) {
            found.extend(first_names(after));
        }
    }
    found
}

/// Names that a file uses and may not. Tests may use the laboratory.
fn trespasses(code: &str, path: &[String]) -> Vec<String> {
    let module = &path[0];
    let allowed = allowed(module).unwrap_or_default();
    let of_product = code.split("mod tests {").next().unwrap_or_default();
    let is_test = path.iter().any(|part| part == "fuzz" || part.ends_with("tests"));
    let needs_lab = !is_test && uses(of_product, path).contains("lab");
    let may = |used: &str| used == module || allowed.contains(&used) || (used == "lab" && !needs_lab);
    uses(code, path).into_iter().filter(|used| !may(used)).collect()
}

#[test]
fn stages_use_only_data_and_numerics() {
    let mut wrong = Vec::new();
    for file in rust_files(&root().join("src")) {
        let path = module_path(&file);
        match path.first().map(String::as_str) {
            None | Some("lib" | "main" | "cli") => {}
            Some(module) if allowed(module).is_none() => {
                wrong.push(format!(
                    "{}: `{module}` has no place in the layers; give it one in `allowed`",
                    file.display()
                ));
            }
            Some(_) => {
                let code = code_of(&fs::read_to_string(&file).expect("UTF-8"));
                wrong.extend(
                    trespasses(&code, &path).iter().map(|used| format!("{} uses {used}", file.display())),
                );
            }
        }
    }
    assert!(wrong.is_empty(), "the star has become a chain:\n{}", wrong.join("\n"));
}

#[test]
fn the_command_line_uses_no_stage_of_the_analysis() {
    let stages = ["compare", "condition", "events", "fit", "judge", "motion", "numerics", "stages"];
    for file in rust_files(&root().join("src")) {
        let path = module_path(&file);
        if matches!(path.first().map(String::as_str), Some("main" | "cli")) {
            let text = fs::read_to_string(&file).expect("UTF-8");
            let used = uses(&code_of(&text), &path);
            let private: Vec<&String> = used.iter().filter(|used| stages.contains(&used.as_str())).collect();
            assert!(
                private.is_empty(),
                "{} uses {private:?}: `analysis` alone knows their order",
                file.display()
            );
        }
    }
}

#[test]
fn recordings_are_opened_in_one_place() {
    let owners = ["ingest", "cli", "main"];
    // The HDF5 library writes to files only; ways are timed from theirs on, and the own recordings are read
    // like a site's.
    let through_a_file = ["curves_h5", "ways", "references"];
    for file in rust_files(&root().join("src")) {
        let path = module_path(&file);
        let owner = path.first().is_some_and(|module| owners.contains(&module.as_str()));
        if owner || path.last().is_some_and(|file| through_a_file.contains(&&file[..])) {
            continue;
        }
        let code = code_of(&fs::read_to_string(&file).expect("UTF-8"));
        let before_tests = code.split("#[cfg(test)]").next().unwrap_or_default();
        for opening in ["File::open(", "fs::read(", "fs::read_to_string(", "fs::write(", "fs::rename("] {
            assert!(!before_tests.contains(opening), "{} calls {opening}…)", file.display());
        }
    }
}

#[test]
fn files_are_short_and_say_what_they_do() {
    let mut wrong = Vec::new();
    for directory in ["src", "tests", "benches"] {
        for file in rust_files(&root().join(directory)) {
            let text = fs::read_to_string(&file).expect("UTF-8");
            let lines = text.lines().count();
            if lines > LONGEST_FILE {
                wrong.push(format!("{}: {lines} lines, at most {LONGEST_FILE}", file.display()));
            }
            if !text.starts_with("//! ") {
                wrong.push(format!(
                    "{}: the first line does not say what it turns into what (`//! …`)",
                    file.display()
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Characters of a line of comment; one with the number of an equation at its end may be longer.
const WIDEST_COMMENT: usize = 110;

#[test]
fn comments_fit_a_window() {
    let mut wide = Vec::new();
    for file in ["src", "tests", "benches", "examples"].map(|name| rust_files(&root().join(name))).concat() {
        let text = fs::read_to_string(&file).expect("UTF-8");
        let is_wide = |line: &&str| {
            let is_comment = line.trim_start().starts_with("//") && !line.contains("   (");
            is_comment && !line.contains("//! |") && line.chars().count() > WIDEST_COMMENT
        };
        wide.extend(text.lines().filter(is_wide).map(|line| format!("{}: {line}", file.display())));
    }
    assert!(wide.is_empty(), "{}", wide.join("\n"));
}

#[test]
fn no_page_holds_a_half_merged_passage() {
    let pages = fs::read_dir(root().join("docs")).expect("docs").flatten().map(|entry| entry.path());
    let pages: Vec<PathBuf> = pages.filter(|page| page.extension().is_some_and(|e| e == "md")).collect();
    assert!(pages.len() > 5, "the pages were not found: {pages:?}");
    for page in pages.into_iter().chain([root().join("README.md")]) {
        let text = fs::read_to_string(&page).expect("UTF-8");
        let is_mark =
            |line: &&str| line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> ") || *line == "=======";
        assert_eq!(text.lines().find(is_mark), None, "{}", page.display());
    }
}

#[test]
fn modules_are_named_for_what_they_are() {
    for file in rust_files(&root().join("src")) {
        for part in module_path(&file) {
            let vague =
                ["util", "utils", "helper", "helpers", "common", "manager", "misc"].contains(&part.as_str());
            assert!(!vague, "{}: `{part}` says nothing", file.display());
        }
    }
}

#[test]
fn the_reader_of_use_lines_sees_a_trespass() {
    let path = ["fit".to_owned(), "modes".to_owned()];
    let named = |text: &str| trespasses(&code_of(text), &path);
    assert_eq!(named("use crate::ingest::read;"), ["ingest"]);
    assert_eq!(named("use crate::{data::{A, B}, numerics, report::html};"), ["report"]);
    assert_eq!(named("let x = super::super::compare::agree();"), ["compare"]);
    assert_eq!(named("mod tests {\n use super::super::super::events::find;\n}"), ["events"]);
    assert_eq!(named("mod tests {\n use super::*;\n use super::super::plateau;\n}"), [""; 0]);
    assert_eq!(named("use crate::lab::synth;\nmod tests {\n}"), ["lab"]);
    assert_eq!(named("mod tests {\n use crate::lab::synth;\n}"), [""; 0]);
    assert_eq!(named("// crate::ingest\nlet s = \"crate::ingest\"; use crate::data::Cask;"), [""; 0]);
}
