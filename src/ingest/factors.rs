//! Numbers beside samples to those by which the samples may be meant to be multiplied, and are not: unknown
//! is not 1.

use super::refusal::Refusal;
use super::statement::number_and_unit;
use super::vocabulary;
use super::{RawChannel, error};
use crate::data::{ChannelSpec, Samples, acceleration_unit_m_s2};

/// Parts of names, as [`plain`] has them, of a factor between stored numbers and a quantity.
const FACTORS: &str = "scal skal factor faktor gain verst resol aufl lsb tovolt bitvolt volts perbit \
                       percount perdigit perunit countsper calib kalib coef koef mult slope steigung \
                       conver umrechn sensit empfind polynom formula";
/// Parts of names of what is no factor, whatever its value.
const OTHERS: &str = "time zeit date datum start begin trigger delay duration dauer version firmware \
                      software revis model serial seri number nummer channel kanal count anzahl samples \
                      rows zeilen index temp humid feucht mass weight gewicht height höhe hoehe length \
                      länge laenge width breite angle winkel position distance abstand speed geschw press \
                      druck filter cutoff grenz bandwidth frequ frequenz rate bits latitude longitude \
                      altitude year month page offset min x0 xorg xoff xzero deltax max peak spitze mean \
                      mittel rms sum std battery sensor device gravity";
/// Words for stored numbers that are in no unit.
const COUNTS: [&str; 12] =
    ["lsb", "lsbs", "count", "counts", "cts", "digit", "digits", "raw", "adc", "adu", "bit", "bits"];

/// In lower case without what parts its words.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn has_part(parts: &str, plain: &str) -> bool {
    parts.split_whitespace().any(|part| plain.contains(part))
}

/// Whether a name says by itself that its number turns stored numbers into a quantity.
pub(super) fn is_factor(name: &str) -> bool {
    let plain = plain(name);
    let is_ratio = plain.ends_with("tog") || plain.ends_with("toms2") || plain.ends_with("perg");
    let is_sensor = plain.contains("sensor") && !has_part("scal skal factor faktor gain", &plain);
    (is_ratio || has_part(FACTORS, &plain)) && !plain.contains("fullscale") && !is_sensor
}

/// `name = text` where its number may be a factor of the samples beside it, and nothing else explains it.
pub(super) fn unexplained(name: &str, text: &str) -> Option<String> {
    let shown = || format!("{} = {}", name.trim(), text.trim());
    if vocabulary::meaning(name).is_some() || vocabulary::is_named_time(name) {
        return None;
    }
    let is_named = is_factor(name);
    let Some((number, unit)) = number_and_unit(text) else {
        // A formula in words: "g = raw * 0.9".
        let is_formula =
            is_named || text.contains(['*', '·', '×']) || has_part("raw lsb counts", &text.to_lowercase());
        let mut words = text.split(|c: char| !c.is_ascii_digit() && c != '.');
        let has_fraction = words.any(|word| word.parse::<f64>().is_ok_and(|number| number.fract() != 0.0));
        return (is_formula && has_fraction).then(shown);
    };
    let number: f64 = number.parse().ok()?;
    // "12.3.2026" and "4/5" are no numbers.
    let is_cut = unit.starts_with(['-', '/', '.', ':']) || !number.is_finite();
    let unit = unit.trim_matches(['[', ']', '(', ')']);
    let is_of_samples = unit.contains(['/', '*']) && vocabulary::rate_unit_hz(unit).is_none()
        || acceleration_unit_m_s2(unit).is_some()
        || COUNTS.contains(&&*unit.to_lowercase())
        || matches!(&*unit.to_lowercase(), "" | "v" | "mv" | "µv" | "uv" | "volt" | "volts");
    let is_idle = number == 0.0 || number - 1.0 == 0.0;
    let is_open = is_named || (number.fract() != 0.0 && !has_part(OTHERS, &plain(name)));
    (!is_cut && !is_idle && is_of_samples && is_open).then(shown)
}

/// Refuses stored counts beside which a factor may stand that nobody applied, unless the cask file states its
/// `scale`.
pub(super) fn settled(spec: &ChannelSpec, raw: &RawChannel) -> Result<(), Refusal> {
    let unit = raw.recorded_unit().unwrap_or_default();
    let is_quantity =
        |unit: &str| unit.is_empty() || acceleration_unit_m_s2(unit).is_some() || vocabulary::is_unit(unit);
    let bare = unit.trim_matches(['[', ']', '(', ')']).to_lowercase();
    let are_counts = COUNTS.contains(&bare.as_str());
    let has_number = !is_quantity(unit) && unit.contains(|c: char| c.is_ascii_digit());
    let are_whole = || are_whole(&raw.uniform.samples);
    let unit_says = (are_counts || has_number && are_whole()).then(|| format!("the unit {unit:?}"));
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
