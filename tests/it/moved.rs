//! From a stored answer and a new one to what moved between them, and to the stored file renewed where
//! `BLESS=1` asks for it.

use serde_json::Value;
use std::fs;
use std::io::Write as _;
use std::path::Path;

/// Differences of one answer that are shown.
const SHOWN: usize = 20;

/// Whether stored answers are to be written anew.
pub fn is_renewed() -> bool {
    std::env::var_os("BLESS").is_some()
}

/// Says what a renewal changes: past the test's capture, since the test passes.
pub fn tell(text: &str) {
    writeln!(std::io::stderr(), "{text}").expect("standard error");
}

/// Holds a text against the stored one; `moved` says where they differ.
#[track_caller]
pub fn hold(path: &Path, found: &str, moved: impl Fn(&str, &str) -> Vec<String>) {
    let stored = fs::read_to_string(path).unwrap_or_default();
    if stored == found {
        return;
    }
    let differs = format!("{} differs:\n{}", path.display(), first(&moved(&stored, found)));
    assert!(is_renewed(), "{differs}");
    fs::write(path, found).expect("a stored answer can be written");
    tell(&differs);
}

/// The first differences and how many more there are.
pub fn first(moved: &[String]) -> String {
    let more = moved.len().saturating_sub(SHOWN);
    let shown = moved.iter().take(SHOWN).cloned();
    shown.chain((more > 0).then(|| format!("and {more} more"))).collect::<Vec<_>>().join("\n")
}

/// Lines of only one of two texts.
pub fn lines(old: &str, new: &str) -> Vec<String> {
    let without = |text: &str, other: &str, sign: &str| -> Vec<String> {
        let others: std::collections::BTreeSet<&str> = other.lines().collect();
        text.lines().filter(|line| !others.contains(line)).map(|line| format!("{sign} {line}")).collect()
    };
    [without(old, new, "-"), without(new, old, "+")].concat()
}

/// The JSON pointers at which two answers differ, with both values; of texts that are no JSON the lines.
pub fn pointers(old: &str, new: &str) -> Vec<String> {
    let [before, now] = [old, new].map(serde_json::from_str::<Value>);
    let mut found = Vec::new();
    if let (Ok(before), Ok(now)) = (before, now) {
        compare("", Some(&before), Some(&now), &mut found);
    }
    if found.is_empty() { lines(old, new) } else { found }
}

fn compare(pointer: &str, old: Option<&Value>, new: Option<&Value>, found: &mut Vec<String>) {
    match (old, new) {
        (Some(Value::Object(before)), Some(Value::Object(now))) => {
            for key in before.keys().chain(now.keys().filter(|key| !before.contains_key(*key))) {
                compare(&format!("{pointer}/{key}"), before.get(key), now.get(key), found);
            }
        }
        (Some(Value::Array(before)), Some(Value::Array(now))) => {
            for i in 0..before.len().max(now.len()) {
                compare(&format!("{pointer}/{i}"), before.get(i), now.get(i), found);
            }
        }
        _ if old == new => {}
        _ => {
            let [before, now] =
                [old, new].map(|value| value.map_or_else(|| "nothing".to_owned(), Value::to_string));
            found.push(format!("{pointer}: {before} → {now}{}", apart(&before, &now)));
        }
    }
}

/// How far two numbers are apart; nothing where one is none.
pub fn apart(old: &str, new: &str) -> String {
    let numbers = old.parse::<f64>().ok().zip(new.parse::<f64>().ok());
    numbers.map_or_else(String::new, |(old, new)| format!(" (|Δ| {:.1e})", (new - old).abs()))
}

#[test]
fn what_moved_is_told_by_its_pointer() {
    let old = r#"{"k": {"value": 0.5, "unit": ""}, "codes": ["a", "b"], "gone": 1}"#;
    let new = r#"{"k": {"value": 0.75, "unit": ""}, "codes": ["a"], "new": null}"#;
    assert_eq!(
        pointers(old, new),
        [
            "/codes/1: \"b\" → nothing",
            "/gone: 1 → nothing",
            "/k/value: 0.5 → 0.75 (|Δ| 2.5e-1)",
            "/new: nothing → null"
        ]
    );
    assert_eq!(pointers("refused: a\nb", "refused: c\nb"), ["- refused: a", "+ refused: c"]);
    assert_eq!(first(&vec![String::new(); SHOWN + 2]).lines().last(), Some("and 2 more"));
}
