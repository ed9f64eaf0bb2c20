//! Parses the value of an option into a number, a range or a contact law; each error says how to correct it.

use crate::data::{Contact, LONGEST_CONTACT_S, SHORTEST_CONTACT_S};

/// Largest half-width of angle and geometry, in degrees and percent: a larger one would draw another cask.
const LARGEST_TOLERANCE: f64 = 20.0;

/// Largest number of draws: a million take minutes, and more change no quantile that a person reads.
const MOST_DRAWS: u32 = 1_000_000;

/// Parses a finite number with a decimal point or comma: no list is written with commas here.
pub fn number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    match text.replace(',', ".").parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("{text} is no finite number")),
        Err(_) => Err(format!("{text} is no number: write one decimal point, and it without a unit")),
    }
}

pub fn angle(text: &str) -> Result<f64, String> {
    within(text, 0.0, 90.0, "the angle lies between 0 (flat) and 90 (upright) degrees")
}

pub fn restitution(text: &str) -> Result<f64, String> {
    let range = "k lies between 0 (the first end does not rebound) and 1 (it rebounds at full speed)";
    within(text, 0.0, 1.0, range)
}

pub fn duration(text: &str) -> Result<f64, String> {
    let span = format!("{SHORTEST_CONTACT_S} to {LONGEST_CONTACT_S}");
    let range = format!("the first impact lasts 0 (an impulse), or {span} seconds: 20 ms are 0.02");
    let duration_s = within(text, 0.0, LONGEST_CONTACT_S, &range)?;
    if duration_s == 0.0 || duration_s >= SHORTEST_CONTACT_S { Ok(duration_s) } else { Err(range) }
}

fn within(text: &str, least: f64, most: f64, range: &str) -> Result<f64, String> {
    let value = number(text).map_err(|why| format!("{why}; {range}"))?;
    if (least..=most).contains(&value) { Ok(value) } else { Err(range.into()) }
}

pub fn contact(text: &str) -> Result<Contact, String> {
    let other = |_| "give rough, smooth or a friction coefficient such as 0.4".to_owned();
    match text.trim().to_lowercase().as_str() {
        "rough" => Ok(Contact::Rough),
        "smooth" => Ok(Contact::Smooth),
        _ => friction(number(text).map_err(other)?).map(Contact::Coulomb),
    }
}

fn friction(value: f64) -> Result<f64, String> {
    let range = "a friction coefficient is not negative: 0 is smooth, 0.4 is common for steel";
    if value >= 0.0 { Ok(value) } else { Err(range.into()) }
}

/// Parses FROM:TO within 0 to 1.
pub fn restitution_range(text: &str) -> Result<(f64, f64), String> {
    range(text, "0.3:0.7", restitution)
}

/// Parses FROM:TO of friction coefficients.
pub fn friction_range(text: &str) -> Result<(f64, f64), String> {
    range(text, "0.2:0.6", |end| friction(number(end)?))
}

fn range(text: &str, example: &str, end: impl Fn(&str) -> Result<f64, String>) -> Result<(f64, f64), String> {
    let Some((from, to)) = text.split_once(':').filter(|(_, to)| !to.contains(':')) else {
        return Err(format!("give FROM:TO, such as {example}"));
    };
    let (from, to) = (end(from)?, end(to)?);
    check_order(from, to)?;
    Ok((from, to))
}

/// Refuses a TO below FROM.
pub fn check_order(from: f64, to: f64) -> Result<(), String> {
    if to < from { Err(format!("TO ({to}) lies below FROM ({from}): exchange them")) } else { Ok(()) }
}

/// Parses the width of a band, percent.
pub fn band(text: &str) -> Result<f64, String> {
    let (percent, range) = (number(text)?, "the band is above 0 and at most 50 percent wide; 5 is usual");
    if percent > 0.0 && percent <= 50.0 { Ok(percent) } else { Err(range.into()) }
}

/// Parses the half-width of the angle, degrees.
pub fn angle_tolerance(text: &str) -> Result<f64, String> {
    within(text, 0.0, LARGEST_TOLERANCE, "the tolerance of the angle lies between 0 and 20 degrees")
}

/// Parses the half-width of the geometry, percent.
pub fn geometry_tolerance(text: &str) -> Result<f64, String> {
    within(text, 0.0, LARGEST_TOLERANCE, "the tolerance of the geometry lies between 0 and 20 percent")
}

pub fn draws(text: &str) -> Result<u32, String> {
    let whole = text.trim().parse::<u32>().ok().filter(|draws| *draws <= MOST_DRAWS);
    whole.ok_or_else(|| {
        "give a whole number from 0 (no draws) to 1000000, without separators, such as 10000".into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_comma_is_a_decimal_point() {
        assert_eq!(number("0,5"), Ok(0.5));
        assert_eq!(number(" 12.5 "), Ok(12.5));
        assert_eq!(contact("0,4"), Ok(Contact::Coulomb(0.4)));
        assert_eq!(restitution_range("0,3:0,7"), Ok((0.3, 0.7)));
        for text in ["1.000,5", "1,000,000", "0,5,"] {
            assert!(number(text).unwrap_err().contains("one decimal point"), "{text}");
        }
    }

    #[test]
    fn the_limits_of_each_range_are_in_it() {
        assert_eq!((angle("0"), angle("90")), (Ok(0.0), Ok(90.0)));
        assert_eq!((restitution("0"), restitution("1")), (Ok(0.0), Ok(1.0)));
        assert_eq!(contact("0"), Ok(Contact::Coulomb(0.0)));
        assert_eq!((duration("0"), duration("0,2")), (Ok(0.0), Ok(0.2)));
        assert!(["20", "1e-6"].iter().all(|wrong| duration(wrong).unwrap_err().contains("0.02")));
        assert_eq!(contact("Rough"), Ok(Contact::Rough));
        assert_eq!((band("50"), draws("0"), draws("1000000")), (Ok(50.0), Ok(0), Ok(1_000_000)));
        assert_eq!(friction_range("0:0"), Ok((0.0, 0.0)));
        assert_eq!((angle_tolerance("0"), geometry_tolerance("20")), (Ok(0.0), Ok(20.0)));
    }

    #[test]
    fn a_slip_is_told_with_its_remedy() {
        for (told, part) in [
            (angle("120"), "between 0 (flat) and 90"),
            (angle("15°"), "15° is no number"),
            (angle("15 deg"), "without a unit"),
            (angle("steep"), "steep is no number"),
            (angle(""), "is no number"),
            (restitution("NaN"), "no finite number"),
            (restitution("-0.1"), "between 0"),
            (band("0"), "above 0"),
            (band("5%"), "without a unit"),
            (geometry_tolerance("21"), "between 0 and 20 percent"),
        ] {
            assert!(told.as_ref().unwrap_err().contains(part), "{told:?} {part}");
        }
        assert!(contact("sticky").unwrap_err().contains("rough, smooth"));
        assert!(contact("-0.1").unwrap_err().contains("not negative"));
        assert!(restitution_range("0.5").unwrap_err().contains("FROM:TO"));
        assert!(restitution_range("0.1:0.2:0.3").unwrap_err().contains("FROM:TO"));
        assert!(friction_range("0.6:0.2").unwrap_err().contains("exchange"));
        for text in ["1e4", "10,000", "-1", "1000001"] {
            assert!(draws(text).unwrap_err().contains("whole number"), "{text}");
        }
    }
}
