//! From the source text to who uses whom: holds the layers of `docs/architecture.md`, the first line of
//! files, and what fits a window.

use crate::house::{imports, modules};
use crate::run::{files_below, root};
use std::fs;
use std::path::Path;

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
        // `analysis` alone knows the order of its stages.
        "cli" | "main" => {
            Some(vec!["data", "ingest", "analysis", "predict", "report", "lab", "ordered_parallel"])
        }
        _ => None,
    }
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

#[test]
fn stages_use_only_data_and_numerics() {
    let product = modules();
    let mut wrong = Vec::new();
    for file in files_below(&root().join("src"), "rs") {
        let path = module_path(&file);
        let Some(module) = path.first().filter(|module| *module != "lib") else { continue };
        let Some(allowed) = allowed(module) else {
            wrong.push(format!("`{module}` has no place in the layers; give it one in `allowed`"));
            continue;
        };
        let code = code_of(&fs::read_to_string(&file).expect("UTF-8"));
        // Unit tests may use the laboratory.
        let is_test = !product.contains_key(&path);
        let begin = if is_test { 0 } else { code.find("mod tests {").unwrap_or(code.len()) };
        for (part, may_use_lab) in [(&code[..begin], false), (&code[begin..], true)] {
            let used = imports(&path, part, &product, true);
            let used = used.iter().filter_map(|used| used.first()).filter(|used| *used != module);
            let may = |used: &str| allowed.contains(&used) || (may_use_lab && used == "lab");
            let trespass = used.filter(|used| !may(used));
            wrong.extend(trespass.map(|used| format!("{} uses {used}", file.display())));
        }
    }
    assert!(wrong.is_empty(), "the star has become a chain:\n{}", wrong.join("\n"));
}

#[test]
fn recordings_are_opened_in_one_place() {
    let owners = ["ingest", "cli", "main"];
    // The HDF5 library writes to files only; ways are timed from theirs on, and the own recordings are read
    // like a site's.
    let through_a_file = ["curves_h5", "ways", "references"];
    for file in files_below(&root().join("src"), "rs") {
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

/// Characters of a line; one with the number of an equation at its end may be longer.
const WIDEST: usize = 110;

#[test]
fn files_say_what_they_do_and_fit_a_window() {
    let mut wrong = Vec::new();
    for file in
        ["src", "tests", "benches", "examples"].map(|name| files_below(&root().join(name), "rs")).concat()
    {
        let text = fs::read_to_string(&file).expect("UTF-8");
        if !text.starts_with("//! ") {
            wrong.push(format!("{}: the first line does not say what it turns into what", file.display()));
        }
        // Numbers of equations stand far right, and a table's row is a line.
        let is_wide =
            |line: &&str| !line.contains("   (") && !line.contains("//! |") && line.chars().count() > WIDEST;
        wrong.extend(text.lines().filter(is_wide).map(|line| format!("{}: {line}", file.display())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_closure_is_called_of() {
    for file in ["src", "tests", "python/src"].map(|name| files_below(&root().join(name), "rs")).concat() {
        let code = code_of(&fs::read_to_string(&file).expect("UTF-8"));
        assert!(!code.contains("let of ="), "{}: name what the closure gives", file.display());
    }
}
