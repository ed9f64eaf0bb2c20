//! Words for contact laws, criteria, bands and inputs of a study, which table, page and pictures share.

use super::rounding::{MISSING, fixed, plain};
use super::text::json_word;
use crate::data::{Contact, Criterion, FlightRegime, Rung, SweepVariable, Uncertain};

/// Most rows of a table of cases on a terminal and on a page, and the place that shows all.
pub(super) const MOST_ROWS: usize = 16;
pub(super) const MOST_ON_PAGE: usize = 48;
pub(super) const OTHERS: &str = "see prediction.json.";

/// Mark of a prediction whose first end stays on the target.
const REGIME_MARK: &str = "†";

/// Meaning of that mark.
pub(super) const REGIME_SENTENCE: &str =
    "† the first end stays on the target until the second strikes; in all other cases it flies.";

/// Mark of a prediction whose cask turns over, and its meaning.
pub(super) const TURNOVER_MARK: &str = "§";
pub(super) const OVER_SENTENCE: &str =
    "§ the cask turns over (a somersault) before the second end strikes: no slap-down of a drop test.";

/// The mark, where it applies.
pub(super) fn regime_mark(regime: FlightRegime) -> &'static str {
    match regime {
        FlightRegime::Free => "",
        FlightRegime::Contact | FlightRegime::Mixed => REGIME_MARK,
    }
}

/// "rough", "smooth" or "μ 0.4".
pub(super) fn contact_words(contact: Contact) -> String {
    match contact {
        Contact::Coulomb(coefficient) => format!("μ {}", plain(coefficient, 3)),
        contact => contact.to_string(),
    }
}

/// "rough, k = 0.5".
pub(super) fn case_words(contact: Contact, k: f64) -> String {
    format!("{}, k = {}", contact_words(contact), plain(k, 3))
}

/// Name of the largest quantity for a reader.
pub(super) fn criterion_words(criterion: Criterion) -> &'static str {
    match criterion {
        Criterion::Speed => "slap-down speed",
        Criterion::VerticalSpeed => "vertical speed",
        Criterion::EnergyRatio => "energy ratio",
    }
}

/// Short name for a narrow column.
pub(super) fn criterion_short(criterion: Criterion) -> &'static str {
    match criterion {
        Criterion::Speed => "speed",
        Criterion::VerticalSpeed => "vertical",
        Criterion::EnergyRatio => "energy",
    }
}

/// A value of the criterion with its unit.
pub(super) fn criterion_value(criterion: Criterion, value: f64) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    match criterion {
        Criterion::Speed | Criterion::VerticalSpeed => format!("{} m/s", fixed(value, 2)),
        Criterion::EnergyRatio => fixed(value, 3),
    }
}

/// An angle to a tenth of a degree, without the sign for degrees.
pub(super) fn degrees(angle_deg: f64) -> String {
    fixed(angle_deg, 1).trim_end_matches(".0").to_owned()
}

/// Formats "3.5–28, 61–70", or the dash if there are none.
pub(super) fn bands_words(bands_deg: &[(f64, f64)]) -> String {
    let band = |(from, to): &(f64, f64)| {
        let (from, to) = (degrees(*from), degrees(*to));
        if from == to { from } else { format!("{from}–{to}") }
    };
    let bands: Vec<String> = bands_deg.iter().map(band).collect();
    if bands.is_empty() { MISSING.to_owned() } else { bands.join(", ") }
}

/// The band that holds `angle_deg`, with an ellipsis if there are others.
pub(super) fn band_around_words(bands_deg: &[(f64, f64)], angle_deg: f64) -> String {
    let off = |band: &(f64, f64)| (band.0 - angle_deg).max(angle_deg - band.1);
    let Some(nearest) = bands_deg.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else {
        return MISSING.to_owned();
    };
    let dots = if bands_deg.len() > 1 { ", …" } else { "" };
    format!("{}{dots}", bands_words(&[*nearest]))
}

/// Name of a sweep's variable, with its unit.
pub(super) fn variable_words(variable: SweepVariable) -> &'static str {
    match variable {
        SweepVariable::Angle => "drop angle, °",
        SweepVariable::K => "coefficient of restitution k",
        SweepVariable::Friction => "friction coefficient μ",
        SweepVariable::Length => "length of the cask, m",
        SweepVariable::DropHeight => "height of the drop, m",
    }
}

/// A range, or its one value if both ends are equal.
pub(super) fn range_words((from, to): (f64, f64)) -> String {
    let (from, to) = (plain(from, 3), plain(to, 3));
    if from == to { from } else { format!("{from} to {to}") }
}

/// A range of uniform draws, or its one value, with its unit.
fn spread_words(range: (f64, f64), unit: &str) -> String {
    let evenly = if range.0 < range.1 { " (uniform)" } else { "" };
    format!("{}{unit}{evenly}", range_words(range))
}

/// The uncertain inputs in one sentence.
pub(super) fn uncertain_words(u: &Uncertain, contact: Contact) -> String {
    let share = |value: f64| format!("± {} %", plain(value * 100.0, 3));
    let friction = u.friction.map_or_else(
        || format!("contact {}", contact_words(contact)),
        |range| format!("μ {}", spread_words(range, "")),
    );
    format!(
        "Drawn: k {}, {friction}, {}; drop angle ± {}°, impact velocity {}, rotation ± {}°/s, sideways \
         velocity ± {} m/s, length {}, section {}, centre of gravity {} of the length, inertia {} (95 % of \
         normal distributions); seed {}.",
        spread_words(u.k, ""),
        contact_length_words(u.contact_s),
        plain(u.angle_deg, 3),
        share(u.impact_velocity),
        plain(u.angular_velocity_deg_s, 3),
        plain(u.horizontal_velocity_m_s, 3),
        share(u.length),
        share(u.height),
        share(u.cog),
        share(u.inertia),
        u.seed
    )
}

/// Says how long the first contact lasts in the draws.
pub(super) fn contact_length_words((from_s, to_s): (f64, f64)) -> String {
    if to_s > 0.0 {
        format!("first contact {}", spread_words((1e3 * from_s, 1e3 * to_s), " ms"))
    } else {
        "first contact an impulse".to_owned()
    }
}

/// Name of a model in a narrow column.
pub(super) fn rung_short(rung: Rung) -> String {
    json_word(rung).replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_read_well() {
        assert_eq!(bands_words(&[(3.5, 28.0), (61.04, 70.26)]), "3.5–28, 61–70.3");
        assert_eq!(bands_words(&[]), "–");
        assert_eq!(bands_words(&[(15.01, 15.04)]), "15");
        assert_eq!(degrees(f64::NAN), "–");
        let bands = [(1.0, 2.0), (5.0, 9.0), (20.0, 20.0), (30.0, 40.0)];
        assert_eq!(band_around_words(&bands, 6.0), "5–9, …");
        assert_eq!(band_around_words(&bands[..1], 6.0), "1–2");
    }

    #[test]
    fn a_range_of_one_value_is_that_value() {
        assert_eq!(range_words((0.4, 0.4)), "0.4");
        assert_eq!(range_words((0.0, 1.0)), "0 to 1");
    }
}
