//! From a packed file of `fixtures`, JSON lines, to the bytes of its cases by their names: what
//! `fixtures/cases.py` writes.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::collections::BTreeMap;
use std::path::Path;

/// A line: bytes that are UTF-8 stand as `text`, all others as `base64`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    name: String,
    text: Option<String>,
    base64: Option<String>,
}

/// The bytes of each case of that file below `fixtures`, sorted by name.
pub fn stored(packed: &str) -> BTreeMap<String, Vec<u8>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(packed);
    let lines = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut cases = BTreeMap::new();
    for line in lines.split_terminator('\n') {
        let line: Line = serde_json::from_str(line).unwrap_or_else(|error| panic!("{packed}: {error}"));
        let bytes = match (line.text, line.base64) {
            (Some(text), None) => text.into_bytes(),
            (None, Some(coded)) => {
                STANDARD.decode(coded).unwrap_or_else(|error| panic!("{}: {error}", line.name))
            }
            _ => panic!("{}: either a text or base64", line.name),
        };
        let twice = cases.insert(line.name.clone(), bytes);
        assert!(twice.is_none(), "{packed}: {} stands twice", line.name);
    }
    cases
}
