//! Values of scene files, numbers with their defaults, yes or no, whole numbers and spans of time, to
//! themselves or to diagnostics.

use crate::ingest::cask_file::CaskFileError;
use crate::ingest::cask_file::section::Section;
use serde::Deserialize;
use serde::de::IntoDeserializer;

/// A number, the key's default where it is left out.
pub(super) fn value(table: &Section, key: &str) -> Result<f64, CaskFileError> {
    let default = || table.row(key).and_then(|row| row.default.parse().ok()).unwrap_or(0.0);
    Ok(table.given(key)?.unwrap_or_else(default))
}

/// `true` or `false`; false where the key is missing.
pub(super) fn flag(table: &Section, key: &str) -> Result<bool, CaskFileError> {
    Ok(table.flag(key)?.unwrap_or(false))
}

/// A whole number of 0 or more, within the key's range.
pub(super) fn whole<T: std::str::FromStr>(table: &Section, key: &str) -> Result<Option<T>, CaskFileError> {
    if table.given(key)?.is_none() {
        return Ok(None);
    }
    let written = table.value(key).and_then(|value| value.get_ref().as_integer());
    let whole = written.and_then(|integer| integer.as_str().replace('_', "").parse().ok());
    whole.map(Some).ok_or_else(|| {
        let mend = format!("write it without point, sign and quotes: {key} = 1");
        table.refuse(key, format!("{key} is no whole number of 0 or more"), &mend)
    })
}

/// A list of `[from, to]`, in s after the first sample.
pub(super) fn spans_s(table: &Section, key: &str) -> Result<Vec<(f64, f64)>, CaskFileError> {
    let Some(value) = table.value(key) else { return Ok(Vec::new()) };
    let spans = Vec::<Vec<f64>>::deserialize(value.clone().into_deserializer()).ok();
    let span = |span: Vec<f64>| match span[..] {
        [from_s, to_s] if 0.0 <= from_s && from_s < to_s && to_s.is_finite() => Some((from_s, to_s)),
        _ => None,
    };
    let spans: Option<Vec<_>> = spans.and_then(|spans| spans.into_iter().map(span).collect());
    spans.ok_or_else(|| {
        let mend = format!(
            "write {key} = [[0.12, 0.14]]: from and to in s after the first sample, the later behind"
        );
        table.refuse(key, format!("{key} is no list of spans"), &mend)
    })
}

/// Refuses the first of each pair of keys where the second is left out.
pub(super) fn needs(table: &Section, pairs: &[(&'static str, &str)]) -> Result<(), CaskFileError> {
    for (key, other) in pairs {
        if table.value(key).is_some() && table.value(other).is_none() {
            let mend = format!("add {other}, or delete {key}");
            return Err(contradicts(table, key, &format!("no meaning without {other}"), &mend));
        }
    }
    Ok(())
}

/// The refusal of a key that the other keys of its table leave no meaning.
pub(super) fn contradicts(table: &Section, key: &str, expected: &str, mend: &str) -> CaskFileError {
    let message = format!("{key} contradicts its table: {expected}");
    table.refuse(key, message, mend)
}
