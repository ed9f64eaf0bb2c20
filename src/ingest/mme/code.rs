//! A channel code of ISO-MME to what it says, in words.

/// Quantities that are measured on a cask or beside it; others are shown as their letters.
#[rustfmt::skip]
const QUANTITIES: [(&str, &str); 16] = [
    ("AC", "acceleration"), ("AA", "angular acceleration"), ("AV", "angular velocity"), ("AN", "angle"),
    ("DS", "displacement"), ("DC", "distance"), ("VE", "velocity"), ("FO", "force"), ("MO", "moment"),
    ("ST", "strain"), ("SR", "stress"), ("PR", "pressure"), ("TE", "temperature"), ("TI", "time"),
    ("VO", "voltage"), ("EV", "event"),
];

/// The quantity of a code that has the format of one: sixteen letters and digits, or "?".
pub(super) fn quantity(code: &str) -> Option<&str> {
    let is_code = code.len() == 16 && code.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'?');
    let letters = code.get(12..14).filter(|_| is_code)?;
    Some(QUANTITIES.iter().find(|(of, _)| *of == letters).map_or(letters, |(_, words)| words))
}

/// Quantity, direction, filter and place of a code, in words; `None` where it is none.
pub(super) fn meaning(code: &str) -> Option<String> {
    let quantity = quantity(code)?;
    let direction = match &code[14..15] {
        "X" | "1" => "longitudinal",
        "Y" | "2" => "lateral",
        "Z" | "3" => "vertical",
        "R" => "resultant",
        _ => "no direction",
    };
    let filter = match &code[15..] {
        "0" => "unfiltered",
        "A" | "E" => "CFC 1000",
        "B" | "F" => "CFC 600",
        "C" | "G" => "CFC 180",
        "D" | "H" => "CFC 60",
        _ => "filter class",
    };
    let (axis, class) = (&code[14..15], &code[15..]);
    let place = [0..1, 1..2, 2..6, 6..8, 8..10, 10..12].map(|part| &code[part]).join(" ");
    Some(format!("{quantity}, {direction} ({axis}), {filter} ({class}), at {place}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_says_quantity_direction_place_and_filter() {
        for (code, expected) in [
            ("T0CASK01L1LEACX0", "acceleration, longitudinal (X), unfiltered (0), at T 0 CASK 01 L1 LE"),
            ("11HEAD0000H3AVRC", "angular velocity, resultant (R), CFC 180 (C), at 1 1 HEAD 00 00 H3"),
            ("??CASK000000QU0?", "QU, no direction (0), filter class (?), at ? ? CASK 00 00 00"),
        ] {
            assert_eq!(meaning(code).as_deref(), Some(expected), "{code}");
        }
        for code in ["", "A1", "11HEAD0000H3ACR", "11HEAD0000H3ACRCC", "11HEAD 000H3ACRC", "11HÄAD0000H3ACR"]
        {
            assert_eq!(meaning(code), None, "{code}");
        }
        assert_eq!(quantity("T0CASK01L1LEFOX0"), Some("force"));
    }
}
