//! From the source text to circles between files, tuples in signatures, type names that stand twice, and the
//! count of lines: holds what `docs/architecture.md` says.

use crate::run::{files_below, root};
use crate::tidy::{code_of, module_path};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

/// The files of the program by their module, without comments, strings and unit tests.
pub(crate) fn modules() -> BTreeMap<Vec<String>, String> {
    let is_test = |path: &Vec<String>| {
        path.last()
            .is_some_and(|last| last.ends_with("tests") || ["fuzz", "written"].contains(&last.as_str()))
            || path.iter().any(|part| part.starts_with("sample"))
    };
    let files = files_below(&root().join("src"), "rs").into_iter();
    let read = files.map(|file| {
        let code = code_of(&fs::read_to_string(&file).expect("UTF-8"));
        let code = code.split("mod tests {").next().unwrap_or_default().to_owned();
        let mut path = module_path(&file);
        path.retain(|part| part != "lib");
        (path, code)
    });
    read.filter(|(path, _)| !is_test(path)).collect()
}

/// The paths that a tree of `use` names: `a::{b, c::D}` names `a::b` and `a::c::D`.
fn paths(tree: &str, before: &[String]) -> Vec<Vec<String>> {
    let (mut depth, mut item, mut items) = (0_i32, String::new(), Vec::new());
    for c in tree.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            items.push(std::mem::take(&mut item));
        } else {
            item.push(c);
        }
    }
    items.push(item);
    let words = |text: &str| -> Vec<String> {
        let text = text.split(" as ").next().unwrap_or_default();
        text.split("::").map(|word| word.trim().to_owned()).filter(|word| !word.is_empty()).collect()
    };
    let of_item = |item: &String| match item.split_once('{') {
        Some((head, group)) => {
            let head = [before, &words(head)].concat();
            paths(group.rsplit_once('}').map_or(group, |(group, _)| group), &head)
        }
        None => vec![[before, &words(item)].concat()],
    };
    items.iter().filter(|item| !item.trim().is_empty()).flat_map(of_item).collect()
}

/// The module that a path in module `own` leads to, where it is one of the program's.
fn led_to(path: &[String], own: &[String], modules: &BTreeMap<Vec<String>, String>) -> Option<Vec<String>> {
    let mut rest = path;
    let mut base = own.to_vec();
    match rest.first()?.as_str() {
        "crate" => (base, rest) = (Vec::new(), &rest[1..]),
        "self" => rest = &rest[1..],
        "super" => {
            while rest.first().is_some_and(|word| word == "super") {
                base.pop();
                rest = &rest[1..];
            }
        }
        child => {
            modules.get(&[own, &[child.to_owned()]].concat())?;
        }
    }
    for word in rest {
        let deeper = [&base[..], std::slice::from_ref(word)].concat();
        if !modules.contains_key(&deeper) {
            break;
        }
        base = deeper;
    }
    (base != own).then_some(base)
}

/// Which modules a module names by `use` or by a path, with or without those that it only passes on
/// (`pub use`).
pub(crate) fn imports(
    own: &[String],
    code: &str,
    modules: &BTreeMap<Vec<String>, String>,
    passed_on: bool,
) -> BTreeSet<Vec<String>> {
    let (mut found, mut body) = (BTreeSet::new(), String::new());
    let mut rest = code;
    while let Some((before, (visible, tree, behind))) = next_use(rest) {
        body.push_str(before);
        if visible.is_empty() || passed_on {
            found.extend(paths(tree, &[]).iter().filter_map(|path| led_to(path, own, modules)));
        }
        rest = behind;
    }
    body.push_str(rest);
    for start in ["crate::", "super::"] {
        for (at, _) in body.match_indices(start) {
            if !body[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':') {
                let is_path = |c: &char| c.is_alphanumeric() || "_:".contains(*c);
                let path: String = body[at..].chars().take_while(is_path).collect();
                let path: Vec<String> = path.split("::").map(str::to_owned).collect();
                found.extend(led_to(&path, own, modules));
            }
        }
    }
    found
}

/// What stands before the next `use`; who may see what it names, its tree, and what stands behind it.
fn next_use(code: &str) -> Option<(&str, (&str, &str, &str))> {
    for (at, _) in code.match_indices("use ") {
        let line = code[..at].rfind('\n').map_or(0, |end| end + 1);
        let visible = code[line..at].trim();
        if visible.is_empty() || visible == "pub" || (visible.starts_with("pub(") && visible.ends_with(')')) {
            let (tree, behind) = code[at + 4..].split_once(';')?;
            return Some((&code[..line], (visible, tree, behind)));
        }
    }
    None
}

/// Files that lead back to themselves, each with the way.
fn circles(modules: &BTreeMap<Vec<String>, String>) -> Vec<String> {
    let used = |(own, code): (&Vec<String>, &String)| (own.clone(), imports(own, code, modules, false));
    let imports: BTreeMap<Vec<String>, BTreeSet<Vec<String>>> = modules.iter().map(used).collect();
    let reached = |from: &Vec<String>| {
        let (mut all, mut open) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(next) = open.pop() {
            let new = imports.get(&next).into_iter().flatten().filter(|to| !all.contains(*to)).cloned();
            let new: Vec<Vec<String>> = new.collect();
            all.extend(new.iter().cloned());
            open.extend(new);
        }
        all
    };
    let all: BTreeMap<&Vec<String>, BTreeSet<Vec<String>>> =
        modules.keys().map(|own| (own, reached(own))).collect();
    let is_in_one = |own: &&Vec<String>| all[*own].contains(*own);
    let back = |own: &Vec<String>| {
        let to: Vec<String> =
            imports[own].iter().filter(|to| all[*to].contains(own)).map(|to| to.join("::")).collect();
        format!("{} uses {}", own.join("::"), to.join(", "))
    };
    modules.keys().filter(is_in_one).map(back).collect()
}

/// Functions of which the signature holds a tuple of three and more, `(a, b, c)` but not `Fn(a, b, c)`.
fn wide_tuples(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        let name: String = code[at + 3..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let Some(open) = code[at..].find('(').filter(|_| !name.is_empty()) else { continue };
        let signature = &code[at + open + 1..];
        let signature = &signature[..signature.find(['{', ';']).unwrap_or(signature.len())];
        // For each open bracket whether it is a tuple, and its commas.
        let mut brackets: Vec<(bool, usize)> = Vec::new();
        let mut is_wide = false;
        let mut before = ' ';
        for (i, c) in signature.char_indices() {
            match c {
                '(' => brackets.push((!(before.is_alphanumeric() || before == '_'), 0)),
                '<' | '[' => brackets.push((false, 0)),
                ')' | ']' => {
                    let Some((is_tuple, commas)) = brackets.pop() else { continue };
                    let ends_in_comma = signature[..i].trim_end().ends_with(',');
                    is_wide |= is_tuple && commas + usize::from(!ends_in_comma) >= 3;
                }
                '>' if before != '-' => drop(brackets.pop()),
                ',' => brackets.iter_mut().last().into_iter().for_each(|bracket| bracket.1 += 1),
                _ => {}
            }
            before = c;
        }
        found.extend(is_wide.then_some(name));
    }
    found
}

/// The names of types that a text declares.
fn types(code: &str) -> Vec<String> {
    let lines = code.lines().map(str::trim_start);
    let declared = lines.filter_map(|line| {
        let line = line.strip_prefix("pub").map_or(line, |rest| {
            rest.strip_prefix('(').and_then(|rest| rest.split_once(')')).map_or(rest, |(_, rest)| rest)
        });
        let line = line.trim_start();
        ["struct ", "enum ", "trait "].iter().find_map(|word| line.strip_prefix(word))
    });
    let names = declared.map(|rest| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect());
    // The name of a type that a macro declares stands where the macro is used.
    names.filter(|name: &String| !name.is_empty()).collect()
}

#[test]
fn no_file_leads_back_to_itself() {
    let circles = circles(&modules());
    assert!(circles.is_empty(), "give the noun its own file:\n{}", circles.join("\n"));
}

#[test]
fn no_signature_holds_a_tuple_of_three() {
    let named = |(path, code): (&Vec<String>, &String)| {
        wide_tuples(code).into_iter().map(|name| format!("{}::{name}", path.join("::"))).collect::<Vec<_>>()
    };
    let found: Vec<String> = modules().iter().flat_map(named).collect();
    assert!(found.is_empty(), "what goes together is a struct:\n{}", found.join("\n"));
}

#[test]
fn no_type_name_stands_twice() {
    // Of each command its own words.
    let allowed = ["Arguments"];
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (path, code) in modules() {
        for name in types(&code).into_iter().filter(|name| !allowed.contains(&name.as_str())) {
            places.entry(name).or_default().push(path.join("::"));
        }
    }
    let twice: Vec<String> = places
        .iter()
        .filter(|(_, places)| places.len() > 1)
        .map(|(name, places)| format!("{name}: {}", places.join(", ")))
        .collect();
    assert!(twice.is_empty(), "one name, one meaning:\n{}", twice.join("\n"));
}

/// Lines of code in `src` at most: who deletes some lowers it, who needs more deletes elsewhere.
const BUDGET: usize = 50_670;

/// How many lines of a text are code, neither blank nor comment nor of tests, and the modules that it has for
/// tests alone.
fn counted(text: &str) -> (usize, Vec<String>) {
    let (mut count, mut depth, mut tests) = (0, 0_usize, Vec::new());
    let (mut is_test, mut is_comment) = (false, false);
    for line in text.lines().map(str::trim) {
        let [opened, closed] = ['{', '}'].map(|brace| line.matches(brace).count());
        if is_comment || line.starts_with("/*") {
            is_comment = !line.contains("*/");
        } else if line.is_empty() || line.starts_with("//") {
        } else if depth > 0 {
            depth = (depth + opened).saturating_sub(closed);
        } else if line.starts_with("#[cfg(test") || line.starts_with("#[cfg(all(test") {
            is_test = true;
        } else if !is_test {
            count += 1;
        } else if !line.starts_with("#[") {
            (depth, is_test) = (opened.saturating_sub(closed), false);
            let module = line.strip_suffix(';').and_then(|line| line.split_once("mod "));
            tests.extend(module.map(|(_, name)| name.to_owned()));
        }
    }
    (count, tests)
}

#[test]
fn the_program_keeps_within_its_budget_of_lines() {
    let read = |file: PathBuf| (module_path(&file), counted(&fs::read_to_string(file).expect("UTF-8")));
    let files: Vec<_> = files_below(&root().join("src"), "rs").into_iter().map(read).collect();
    let below = |path: &Vec<String>, name: &String| [&path[..], std::slice::from_ref(name)].concat();
    let tests: BTreeSet<Vec<String>> =
        files.iter().flat_map(|(path, (_, tests))| tests.iter().map(|name| below(path, name))).collect();
    let is_code = |path: &Vec<String>| !tests.contains(path) && !path.join("_").ends_with("_tests");
    let count: usize = files.iter().filter(|(path, _)| is_code(path)).map(|(_, (count, _))| count).sum();
    assert!(count <= BUDGET, "src has {count} lines of code, {} beyond its budget", count - BUDGET);
    let text = "/* a\n*/\nlet a = 1; // b\n\n#[cfg(test)]\n#[x]\nmod t {\n  f();\n}\n#[cfg(test)]\nmod u;";
    assert_eq!(counted(text), (1, vec!["u".to_owned()]));
}

#[test]
fn the_reader_of_the_house_sees_a_fault() {
    let texts = |pairs: &[(&str, &str)]| -> BTreeMap<Vec<String>, String> {
        let path = |text: &str| text.split("::").map(str::to_owned).collect();
        pairs.iter().map(|(own, code)| (path(own), code_of(code))).collect()
    };
    let pair = |one: &str, other: &str| circles(&texts(&[("a", ""), ("a::b", one), ("a::c", other)])).len();
    assert_eq!(pair("use super::c::{D, e};", "fn f() { super::b::g() }"), 2);
    assert_eq!(pair("use crate::a::c::D;", "use super::{b::E, x};"), 2);
    assert_eq!(pair("use super::c::D;", "pub(super) use super::b::E;"), 0);
    assert_eq!(pair("use super::c::D;", "// super::b\n"), 0);
    assert_eq!(wide_tuples("fn f(a: (f64, f64), g: impl Fn(u8, u8, u8)) -> u8 {"), [""; 0]);
    assert_eq!(wide_tuples("fn f(a: u8) -> Result<(u8, Vec<(u8, u8)>, f64), E> {"), ["f"]);
    assert_eq!(wide_tuples("fn f((a, b, c): (u8, u8, u8));\nfn g(a: [(f64, &[u8], u8,); 2]) {"), ["f", "g"]);
    assert_eq!(types("pub(super) struct A {\nenum B<T> {\nimpl A {\n  pub trait C: D {"), ["A", "B", "C"]);
}
