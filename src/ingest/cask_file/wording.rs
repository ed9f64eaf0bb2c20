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

pub(super) fn unit_mend(number: &str, unit: &str) -> String {
    format!(
        "write the number only, {number}: the unit is in the key's name (convert it if {unit} is another)"
    )
}

/// ", in kg", from the key's ending.
pub(super) fn unit_of(key: &str) -> &'static str {
    const ENDINGS: [(&str, &str); 14] = [
        ("inertia_kg_m2", ", in kg m²"),
        ("_m_s2", ", in m/s²"),
        ("_m_s", ", in m/s"),
        ("_kg", ", in kg"),
        ("_n_m", ", in N/m"),
        ("_m", ", in m"),
        ("_hz", ", in Hz"),
        ("_s", ", in s"),
        ("_ms", ", in ms"),
        ("_g", ", in g"),
        ("_n", ", in N"),
        ("_percent", ", in percent"),
        ("_deg", ", in degrees"),
        ("sensitivity", ", in mV per g; a sensor mounted the other way round has polarity = -1"),
    ];
    ENDINGS.iter().find(|(ending, _)| key.ends_with(ending)).map_or("", |(_, unit)| unit)
}
