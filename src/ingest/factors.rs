//! Numbers beside samples to those by which the samples may be meant to be multiplied, and are not: unknown
//! is not 1.

use super::refusal::Refusal;
use super::statement::number_and_unit;
use super::vocabulary::{self, has_listed_part, has_part, has_word, plain};
use super::{RawChannel, error};
use crate::data::{ChannelSpec, Samples, acceleration_unit_m_s2};
use std::collections::BTreeMap;

/// Whether a name says by itself that its number turns stored numbers into a quantity.
pub(super) fn is_factor(name: &str) -> bool {
    let plain = plain(name);
    let is_ratio = plain.ends_with("tog") || plain.ends_with("toms2") || plain.ends_with("perg");
    let is_sensor = plain.contains("sensor") && !has_part("scal skal factor faktor gain", &plain);
    (is_ratio || has_listed_part("factor", &plain)) && !plain.contains("fullscale") && !is_sensor
}

/// `name = text` where a number in it may be a factor of the samples beside it, and nothing else explains it.
pub(super) fn unexplained(name: &str, text: &str) -> Option<String> {
    if vocabulary::meaning(name).is_some() || vocabulary::is_named_time(name) {
        return None;
    }
    let line = format!("{name} {text}");
    let parts = line.split(|c: char| c.is_whitespace() || "=;|()[]{}\"'".contains(c));
    let words: Vec<&str> =
        parts.map(|word| word.trim_matches([':', ','])).filter(|word| !word.is_empty()).collect();
    // What stands before a number explains it, and those that follow at once.
    let (mut label, mut is_open, mut is_new) = (String::new(), false, false);
    for (at, word) in words.iter().enumerate() {
        let Some((number, unit)) = number_of(word) else {
            label = if is_new { plain(word) } else { label + &plain(word) };
            is_new = false;
            continue;
        };
        let unit = if unit.is_empty() { words.get(at + 1).copied().unwrap_or_default() } else { unit };
        let number = if unit == "%" { number / 100.0 } else { number };
        let is_explained = has_listed_part("no factor", &label);
        let is_named = is_factor(&label) || (has_listed_part("weak factor", &label) && !is_explained);
        let is_idle = number == 0.0 || number - 1.0 == 0.0 || is_other_unit(unit);
        is_open |= !is_idle && (is_named || (number.fract() != 0.0 && !is_explained));
        is_new = true;
    }
    let shown = match (name.trim(), text.trim()) {
        (name, "") => name.to_owned(),
        (name, text) => format!("{name} = {}", text.chars().take(60).collect::<String>()),
    };
    is_open.then_some(shown)
}

/// So many entries of one metadata are looked at.
pub(super) const MOST_METADATA: usize = 64;

/// Those among what a channel or a file states by names.
pub(super) fn among(stated: &BTreeMap<String, String>) -> Vec<String> {
    stated.iter().take(MOST_METADATA).filter_map(|(name, text)| unexplained(name, text)).collect()
}

/// The number that a word is, with a unit behind it: `0.9g`, `x0.9`, `9/10`, `90%`. A date is none, nor `A1`.
fn number_of(word: &str) -> Option<(f64, &str)> {
    if let Some((above, below)) = word.split_once('/')
        && let (Ok(above), Ok(below)) = (above.parse::<f64>(), below.parse::<f64>())
    {
        return Some((above / below, ""));
    }
    let (number, unit) = number_and_unit(word.trim_start_matches(['x', '×', '*', '·']))?;
    let number: f64 = number.parse().ok()?;
    let is_cut = unit.starts_with(['-', '/', '.', ':', ',']) || !number.is_finite();
    (!is_cut).then_some((number, unit))
}

/// Whether a unit is known, and none of samples or of what converts them.
fn is_other_unit(unit: &str) -> bool {
    let lower = unit.to_lowercase();
    let is_of_samples = acceleration_unit_m_s2(unit).is_some()
        || has_word("unit of counts", &lower)
        || matches!(&*lower, "v" | "mv" | "µv" | "uv" | "volt" | "volts" | "-" | "–" | "1" | "%")
        || lower.ends_with("/g");
    vocabulary::is_unit(unit) && !is_of_samples
}

/// Refuses stored counts beside which a factor may stand that nobody applied, unless the cask file states its
/// `scale`.
pub(super) fn settled(spec: &ChannelSpec, raw: &RawChannel) -> Result<(), Refusal> {
    let unit = raw.recorded_unit().unwrap_or_default();
    let bare = unit.trim_matches(['[', ']', '(', ')']).to_lowercase();
    let are_counts = has_word("unit of counts", &bare);
    let is_quantity = acceleration_unit_m_s2(unit).is_some()
        || matches!(&*bare, "" | "-" | "1" | "v" | "mv" | "µv" | "uv" | "volt" | "volts");
    let are_whole = || are_whole(&raw.uniform.samples);
    // A unit that is none of acceleration is asked about where the cask file states none.
    let is_other = spec.unit.is_some() && !is_quantity;
    let unit_says = (are_counts || is_other && are_whole()).then(|| format!("the unit {unit:?}"));
    let stated: Vec<&String> = raw.factors.iter().filter(|_| are_counts || are_whole()).collect();
    let names: Vec<&str> = unit_says.iter().chain(stated).map(String::as_str).collect();
    if names.is_empty() || spec.scale.is_some() {
        return Ok(());
    }
    Err(Refusal::new(
        format!(
            "{} holds stored numbers, beside which stands {}, and nothing says whether these are converted \
             by it already",
            spec.source,
            error::handful(&names)
        ),
        "write into this [[channel]] of the cask file what the numbers are to be multiplied by to be in \
         `unit`, such as scale = 0.9, or scale = 1 where they are converted already",
    ))
}

/// Whether all samples are whole numbers, and not all the same.
fn are_whole(samples: &Samples) -> bool {
    let numbers = || (0..samples.len()).map(|i| samples.get(i)).filter(|x| x.is_finite());
    let first = numbers().next();
    numbers().all(|x| x.fract() == 0.0) && numbers().any(|x| Some(x) != first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_nothing_explains_may_be_a_factor() {
        for (name, text) in [
            ("Scale factor", "0.9"),
            ("ascale", "0.9"),
            ("Faktor", "0.9"),
            ("VResolution", "9.0e-1"),
            ("1 LSB", "0.9 g"),
            ("Gain", "2"),
            ("bit_volts", "0.9"),
            ("YMult", "0.9"),
            ("counts_to_g", "0.9"),
            ("counts_per_g", "16384"),
            ("Sensitivity", "10.2 mV/g"),
            ("q", "0.9"),
            ("conversion", "g = raw * 0.9"),
        ] {
            assert!(unexplained(name, text).is_some(), "{name}");
        }
        for (name, text) in [
            ("Sample rate", "0.5 Hz"),
            ("Temperature", "21.5"),
            ("Air", "21.5 °C"),
            ("Drop height", "0.8"),
            ("Serial number", "20311.5"),
            ("Date", "12.5"),
            ("Version", "1.2"),
            ("Channels", "2"),
            ("Scale", "1.0"),
            ("Gain", "high"),
            ("Operator", "A. B."),
            ("Trigger level", "2.5 g"),
            ("Tested", "27.11.2026"),
        ] {
            assert_eq!(unexplained(name, text), None, "{name}");
        }
    }
}
