//! Values that only scene files have, yes or no, whole numbers, shares and spans of time, to numbers or diagnostics.

use crate::ingest::cask_file::CaskFileError;
use crate::ingest::cask_file::section::{Placed, Section};
use toml::de::DeValue;

/// `true` or `false`; false where the key is missing.
pub(super) fn flag(table: &Section, key: &str) -> Result<bool, CaskFileError> {
    let Some(value) = table.value(key) else { return Ok(false) };
    match value.get_ref() {
        DeValue::Boolean(flag) => Ok(*flag),
        _ => Err(table.wrong(
            value.span(),
            format!("{key} is neither true nor false"),
            "true or false".into(),
            &format!("write {key} = true, or delete the line"),
        )),
    }
}

/// A whole number of 0 or more.
pub(super) fn whole(table: &Section, key: &str) -> Result<Option<Placed<u64>>, CaskFileError> {
    let Some(value) = table.value(key) else { return Ok(None) };
    let number = match value.get_ref() {
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().replace('_', "").parse().ok(),
        _ => None,
    };
    match number {
        Some(number) => Ok(Some(Placed { value: number, span: value.span() })),
        None => Err(table.wrong(
            value.span(),
            format!("{key} is no whole number of 0 or more"),
            "a whole number".into(),
            &format!("write it without point, sign and quotes: {key} = 1"),
        )),
    }
}

/// A number, `default` where the key is missing.
pub(super) fn number_or(table: &Section, key: &str, default: f64) -> Result<f64, CaskFileError> {
    Ok(table.number(key)?.map_or(default, |number| number.value))
}

/// A number of 0 or more, `default` where the key is missing.
pub(super) fn size_or(table: &Section, key: &str, default: f64) -> Result<f64, CaskFileError> {
    Ok(table.not_negative(key)?.map_or(default, |number| number.value))
}

/// A list of `[from, to]`, in s after the first sample.
pub(super) fn spans_s(table: &Section, key: &str) -> Result<Vec<(f64, f64)>, CaskFileError> {
    let Some(value) = table.value(key) else { return Ok(Vec::new()) };
    let spans = match value.get_ref() {
        DeValue::Array(items) => items.iter().map(|item| pair(item.get_ref())).collect(),
        _ => None,
    };
    spans.ok_or_else(|| {
        table.wrong(
            value.span(),
            format!("{key} is no list of spans"),
            "[[from, to], …]".into(),
            &format!(
                "write {key} = [[0.12, 0.14]]: from and to in s after the first sample, the later behind"
            ),
        )
    })
}

fn pair(value: &DeValue) -> Option<(f64, f64)> {
    let DeValue::Array(ends) = value else { return None };
    let [from, to] = ends.iter().collect::<Vec<_>>()[..] else { return None };
    let seconds = |value: &DeValue| {
        let text = match value {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str(),
            DeValue::Float(float) => float.as_str(),
            _ => return None,
        };
        text.replace('_', "").parse::<f64>().ok().filter(|s| s.is_finite() && *s >= 0.0)
    };
    let (from_s, to_s) = (seconds(from.get_ref())?, seconds(to.get_ref())?);
    (from_s < to_s).then_some((from_s, to_s))
}
