//! Units by their names.

/// Standard gravity, m/s²: the meaning of "g" in a data sheet (3rd CGPM, 1901); not the site's gravity.
pub const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

/// The ways in which units of acceleration are written, in lower case without blanks and powers, with m/s²
/// per unit.
const ACCELERATIONS: [(&str, f64); 7] = [
    ("g gn g0 gee gs g's g_n g_0 gunits gravity standardgravity", STANDARD_GRAVITY_M_S2),
    ("m/s2 m/s/s ms-2 m.s-2 m/sec2 m/sec/sec m/ss mps2 m_s2", 1.0),
    ("meterspersecondsquared metrespersecondsquared meterpersecondsquared metrepersecondsquared", 1.0),
    ("mm/s2 mms-2 mm/s/s", 1e-3),
    ("cm/s2 cms-2 gal", 1e-2),
    ("km/s2", 1e3),
    ("ft/s2", 0.3048),
];

/// Factor to m/s² for the ways in which an acceleration's unit is written; `None` for any other text.
///
/// Case matters only where it could mislead: "Mg" would be a megagram.
pub fn acceleration_unit_m_s2(text: &str) -> Option<f64> {
    let plain = simplify(text);
    match plain.as_str() {
        "mg" | "mgn" | "milli-g" | "millig" => return Some(STANDARD_GRAVITY_M_S2 / 1000.0),
        "Mg" | "MG" => return None,
        _ => {}
    }
    look_up(&ACCELERATIONS, &plain)
}

/// The ways in which units of a rate of turn are written, likewise, with rad/s per unit.
const RATES_OF_TURN: [(&str, f64); 5] = [
    ("rad/s rad/sec rads-1 rad.s-1", 1.0),
    ("mrad/s", 1e-3),
    ("deg/s deg/sec degree/s degrees/s degs-1 °/s °s-1 dps", DEGREE),
    ("mdeg/s", 1e-3 * DEGREE),
    ("rpm", 6.0 * DEGREE),
];
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Factor to rad/s for the ways in which a unit of angular rate is written; `None` for any other text.
pub fn rate_unit_rad_s(text: &str) -> Option<f64> {
    look_up(&RATES_OF_TURN, &simplify(text))
}

/// Without blanks, brackets and powers.
fn simplify(text: &str) -> String {
    let text = text.trim().trim_matches(['[', ']']).replace('²', "2").replace(['⁻', '−'], "-");
    text.replace(|c: char| c.is_whitespace() || "^*·{}()".contains(c), "")
}

/// Looks up a simplified name in a table, ignoring case.
fn look_up(table: &[(&str, f64)], plain: &str) -> Option<f64> {
    let plain = plain.to_lowercase().replace('¹', "1");
    let is_it = |(names, _): &&(&str, f64)| names.split(' ').any(|name| name == plain);
    table.iter().find(is_it).map(|(_, size)| *size)
}

/// True if a unit is one of angular rate, such as "deg/s" or "rad/s", or of its change, rather than of
/// acceleration.
pub fn is_rate_of_turn(text: &str) -> bool {
    let plain = text.trim_matches(['[', '(', ' ']).to_lowercase();
    RATES_OF_TURN.iter().flat_map(|(names, _)| names.split(' ')).any(|unit| plain.starts_with(unit))
}
