//! Lists the null quantities of a result, each with the finding that removed it.

use super::finding::{DropFinding, Finding, FindingKind, ResultPart};
use super::unit::acceleration_unit_m_s2;
use serde::Serialize;
use serde_json::Value;

/// A quantity that the result lacks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct MissingQuantity {
    /// Path of the quantity in the result: `slap_down.speed`, `impacts[1].crush`.
    pub quantity: String,
    /// Index in `quality` of the finding that removed it.
    pub because: Option<usize>,
    /// Why it is missing, where no finding took it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'static str>,
    /// That reason, or the sentence of the finding.
    #[serde(skip)]
    pub words: String,
}

/// Paths of quantities in a result, and the part to which each belongs; all others belong to the first
/// impact.
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

/// Lists the null quantities of a result; the first finding that removes a quantity's part is its reason.
pub(super) fn missing_in(result: &Value, found: &[Finding]) -> Vec<MissingQuantity> {
    let missing = |quantity: String| {
        let is_in = |(place, _): &&(&str, ResultPart)| quantity.starts_with(place);
        let part = PARTS.iter().find(is_in).map_or(ResultPart::FirstImpact, |(_, part)| *part);
        let takes = |f: &Finding| f.removes(part) || f.removes(ResultPart::Motion);
        // The mass properties replace an end, except for the course of a contact.
        let is_end = |f: &Finding| matches!(f.what, FindingKind::Drop(DropFinding::MissingEnd { .. }));
        let channel = channel(result, &quantity);
        let takes_pulse = |f: &Finding| f.removes(ResultPart::Channel) && f.channel.as_deref() == channel;
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
    all.filter(|quantity| has_meaning(result, quantity)).map(missing).collect()
}

/// The shock at a path, and the name of its number.
fn shock<'a, 'b>(result: &'a Value, place: &'b str) -> Option<(&'a Value, &'b str)> {
    let (row, number) = place.strip_prefix("shocks[")?.split_once("].")?;
    Some((result.pointer(&format!("/shocks/{row}"))?, number))
}

/// True if the quantity exists: strain has no velocity.
fn has_meaning(result: &Value, place: &str) -> bool {
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
