//! Values and keys of a cask file to the words that a diagnostic needs.

use crate::ingest::error::alike;
use toml::de::DeValue;

/// Below this similarity (Jaro–Winkler, 0 to 1) a word is another word rather than a misspelling.
const ALIKE: f64 = 0.75;

/// The line, from 1, of byte `at`.
pub(super) fn line_of(text: &[u8], at: usize) -> usize {
    text[..at.min(text.len())].split(|&b| b == b'\n').count()
}

/// The known word that is most like `word`, where one is.
pub(super) fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    known
        .iter()
        .map(|&candidate| (alike(word, candidate), candidate))
        .filter(|(alike, _)| *alike >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

pub(super) fn described(value: &DeValue) -> String {
    match value {
        DeValue::String(text) if text.trim().is_empty() => "empty".into(),
        DeValue::String(text) => format!("the text \"{text}\""),
        DeValue::Integer(number) => format!("the number {}", number.as_str()),
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(value) => format!("{value}"),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(_) => "a list".into(),
        DeValue::Table(_) => "a table".into(),
    }
}

/// "4466 kg" to the number and its unit.
pub(super) fn number_with_unit(text: &str) -> Option<(&str, &str)> {
    let digits = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '_')))?;
    let (number, unit) = text.split_at(digits);
    let is_unit = unit.trim_start().starts_with(|c: char| c.is_alphabetic() || matches!(c, '°' | '%' | 'µ'));
    (number.parse::<f64>().is_ok() && is_unit).then_some((number, unit.trim()))
}

/// How to write the number of a key that has its unit behind it: converted where that is no guess.
pub(super) fn unit_mend(key: &str, number: &str, unit: &str) -> String {
    const PARTS: [(&str, &str, f64); 5] =
        [("km/h", "m/s", 3.6), ("mm", "m", 1e3), ("cm", "m", 1e2), ("ms", "s", 1e3), ("t", "kg", 1e-3)];
    let own = unit_of(key).unwrap_or_default();
    let part = PARTS.iter().find(|(from, to, _)| *from == unit && *to == own);
    let converted = part.and_then(|(.., parts)| Some(format!("{:?}", number.parse::<f64>().ok()? / parts)));
    match converted.or_else(|| (unit == own).then(|| number.to_owned())) {
        Some(number) => format!("write the number alone in {own}: {number}"),
        None => format!("write the number alone, converted from {unit}: the unit is in the key's name"),
    }
}

/// "kg", from the key's ending.
pub(super) fn unit_of(key: &str) -> Option<&'static str> {
    #[rustfmt::skip]
    const ENDINGS: [(&str, &str); 14] = [
        ("inertia_kg_m2", "kg m²"), ("_m_s2", "m/s²"), ("_m_s", "m/s"), ("_kg", "kg"), ("_n_m", "N/m"), ("_m", "m"),
        ("_hz", "Hz"), ("_s", "s"), ("_ms", "ms"), ("_g", "g"), ("_n", "N"), ("_percent", "percent"),
        ("_deg", "degrees"), ("sensitivity", "mV per g; a sensor mounted the other way round has polarity = -1"),
    ];
    ENDINGS.iter().find(|(ending, _)| key.ends_with(ending)).map(|(_, unit)| *unit)
}
