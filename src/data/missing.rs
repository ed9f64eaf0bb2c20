//! The JSON of a result to the quantities that are null, each with the finding that took it.

use super::finding::{DropFinding, Finding, FindingKind, ResultPart};
use super::unit::acceleration_unit_m_s2;
use serde::Serialize;
use serde_json::Value;

/// A quantity that the result lacks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct MissingQuantity {
    /// Its place in the result: `slap_down.speed`, `impacts[1].crush`.
    pub quantity: String,
    /// The place in `quality` of the finding that took it.
    pub because: Option<usize>,
    /// Why it is missing, where no finding took it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'static str>,
    /// That, or what the finding says.
    #[serde(skip)]
    pub words: String,
}

/// Where quantities stand in a result, and the part that each of the others belongs to; all else is of the
/// first impact.
const PLACES: [&str; 7] =
    ["first_impact", "slap_down", "k", "amplification", "impacts", "shocks", "comparison"];
const PARTS: [(&str, ResultPart); 5] = [
    ("slap_down.local_speed", ResultPart::SecondImpact),
    ("slap_down", ResultPart::SlapDown),
    ("amplification", ResultPart::SlapDown),
    ("impacts[1]", ResultPart::SecondImpact),
    ("comparison", ResultPart::SlapDown),
];

const NOT_SHOWN: &str = "this recording does not determine it";
const PULSE_NOT_SHOWN: &str = "the channel does not show this pulse whole";

/// What is null in a result; the first of the findings that takes its part took it.
pub(super) fn missing_in(result: &Value, found: &[Finding]) -> Vec<MissingQuantity> {
    let missing = |quantity: String| {
        let is_in = |(place, _): &&(&str, ResultPart)| quantity.starts_with(place);
        let part = PARTS.iter().find(is_in).map_or(ResultPart::FirstImpact, |(_, part)| *part);
        let takes = |f: &Finding| f.takes(part) || f.takes(ResultPart::Motion);
        // The mass properties replace an end in all but in the course of a contact.
        let is_end = |f: &Finding| matches!(f.what, FindingKind::Drop(DropFinding::MissingEnd { .. }));
        let channel = channel(result, &quantity);
        let takes_pulse = |f: &Finding| f.takes(ResultPart::Channel) && f.channel.as_deref() == channel;
        let because = match channel {
            Some(_) => found.iter().position(takes_pulse),
            None => found.iter().position(takes).or_else(|| found.iter().position(is_end)),
        };
        let reason = if channel.is_some() { PULSE_NOT_SHOWN } else { NOT_SHOWN };
        let reason = because.is_none().then_some(reason);
        let words = because.map_or(reason.unwrap_or_default().into(), |place| found[place].with_channel());
        MissingQuantity { quantity, because, reason, words }
    };
    let all = PLACES.iter().flat_map(|place| nulls(&result[place], (*place).to_owned()));
    all.filter(|quantity| is_meant(result, quantity)).map(missing).collect()
}

/// The shock of a place, and which number of it.
fn shock<'a, 'b>(result: &'a Value, place: &'b str) -> Option<(&'a Value, &'b str)> {
    let (row, number) = place.strip_prefix("shocks[")?.split_once("].")?;
    Some((result.pointer(&format!("/shocks/{row}"))?, number))
}

/// Whether a quantity has a velocity: strain has none.
fn is_meant(result: &Value, place: &str) -> bool {
    let is_of_motion = |number: &str| number.starts_with("velocity") || number.starts_with("displacement");
    let is_acceleration = |shock: &Value| shock["unit"].as_str().and_then(acceleration_unit_m_s2).is_some();
    shock(result, place).is_none_or(|(shock, number)| is_acceleration(shock) || !is_of_motion(number))
}

/// The name of the channel that a shock, or a pulse of an impact, belongs to.
fn channel<'a>(result: &'a Value, place: &str) -> Option<&'a str> {
    if let Some((shock, _)) = shock(result, place) {
        return shock["channel"].as_str();
    }
    let (impact, pulse) = place.strip_prefix("impacts[")?.split_once("].channels[")?;
    let number = pulse.split(']').next()?;
    result.pointer(&format!("/impacts/{impact}/channels/{number}/name"))?.as_str()
}

fn nulls(value: &Value, place: String) -> Vec<String> {
    match value {
        Value::Null => vec![place],
        Value::Object(parts) => {
            parts.iter().flat_map(|(key, part)| nulls(part, format!("{place}.{key}"))).collect()
        }
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.flat_map(|(i, item)| nulls(item, format!("{place}[{i}]"))).collect()
        }
        _ => Vec::new(),
    }
}
