//! ASCII digits with either decimal mark to the nearest f64.

/// Powers of ten that f64 holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// The number at the start of `text` and how many bytes it takes; `None` where none starts there.
///
/// Exact: up to 2⁵³ and 10²² one division or product rounds correctly (Clinger 1990); longer numbers go to
/// the library.
#[inline]
pub(super) fn leading(text: &[u8], decimal: u8) -> Option<(f64, usize)> {
    Leading::of(text, decimal).map(|number| (number.value, number.used))
}

/// The same of a number as JSON writes it: finite, digits on both sides of the mark, no zero before others,
/// no plus.
#[inline]
pub(super) fn leading_json(text: &[u8]) -> Option<(f64, usize)> {
    let number = Leading::of(text, b'.')?;
    let sign = usize::from(text.first() == Some(&b'-'));
    let is_json = number.whole > 0
        && (number.fraction > 0 || !number.has_mark)
        && (number.whole == 1 || text.get(sign) != Some(&b'0'))
        && text.first() != Some(&b'+')
        && number.value.is_finite();
    is_json.then_some((number.value, number.used))
}

/// A number at the start of a text.
struct Leading {
    value: f64,
    /// Bytes that it takes.
    used: usize,
    /// Digits before the mark and behind it.
    whole: usize,
    fraction: usize,
    has_mark: bool,
}

impl Leading {
    #[allow(clippy::inline_always, reason = "left alone it is handed over through memory")]
    #[inline(always)]
    fn of(text: &[u8], decimal: u8) -> Option<Self> {
        let first = text.first().copied().unwrap_or_default();
        let is_negative = first == b'-';
        let from = usize::from(matches!(first, b'-' | b'+'));
        let mut mantissa = 0_u64;
        let mut at = digits(text, from, &mut mantissa);
        let whole = at - from;
        let mut fraction = 0;
        let has_mark = text.get(at) == Some(&decimal);
        if has_mark {
            let from = at + 1;
            at = digits(text, from, &mut mantissa);
            fraction = at - from;
        }
        let count = whole + fraction;
        if count == 0 {
            return None;
        }
        // Fifteen digits stay below 2^53.
        if count > 15 || matches!(text.get(at), Some(b'e' | b'E')) {
            let (value, used) = with_exponent(text, at, mantissa, [count, fraction], decimal)?;
            return Some(Self { value, used, whole, fraction, has_mark });
        }
        let value = as_f64(mantissa) / POWERS[fraction];
        // The sign bit alone, without a jump that half of all samples would take.
        let value = f64::from_bits(value.to_bits() | (u64::from(is_negative) << 63));
        Some(Self { value, used: at, whole, fraction, has_mark })
    }
}

/// The number whose digits end at `at`, of any length and with its exponent; so many in all and so many
/// behind the mark make the `mantissa`.
#[cold]
fn with_exponent(
    text: &[u8],
    at: usize,
    mantissa: u64,
    [count, fraction]: [usize; 2],
    decimal: u8,
) -> Option<(f64, usize)> {
    let has_exponent = matches!(text.get(at), Some(b'e' | b'E'));
    let (exponent, at) = if has_exponent { exponent_at(text, at) } else { (0, at) };
    let power = exponent - i64::try_from(fraction).ok()?;
    let magnitude = usize::try_from(power.unsigned_abs()).ok().and_then(|index| POWERS.get(index));
    match magnitude {
        Some(&scale) if count <= 19 && mantissa <= 1 << 53 => {
            let digits = as_f64(mantissa);
            let value = if power < 0 { digits / scale } else { digits * scale };
            Some((if text.first() == Some(&b'-') { -value } else { value }, at))
        }
        _ => Some((by_library(text.get(..at)?, decimal)?, at)),
    }
}

#[allow(clippy::cast_precision_loss, reason = "at most 2^53")]
fn as_f64(mantissa: u64) -> f64 {
    // No processor but the newest takes an unsigned number in one step.
    mantissa.cast_signed() as f64
}

/// Appends the digits at `at` to `mantissa`, up to four at a time; where they end.
///
/// Jumps on their count, not sums of it: the processor foresees it in a column and begins the next number at
/// once.
#[inline]
fn digits(text: &[u8], mut at: usize, mantissa: &mut u64) -> usize {
    let mut append = |scale: u64, digits: u32| {
        *mantissa = mantissa.wrapping_mul(scale).wrapping_add(u64::from(digits));
    };
    while let Some(four) = text.get(at..).and_then(<[u8]>::first_chunk::<4>) {
        // Each byte less "0": adding 0x76 sets the highest bit of all but digits; a carry reaches later bytes
        // only.
        let bytes = u32::from_le_bytes(*four) ^ 0x3030_3030;
        let others = (bytes.wrapping_add(0x7676_7676) | bytes) & 0x8080_8080;
        if others == 0 {
            append(10_000, of_four(bytes));
            at += 4;
        } else if others & 0x0080_8080 == 0 {
            append(1000, of_four(bytes << 8));
            return at + 3;
        } else if others & 0x8080 == 0 {
            append(100, of_four(bytes << 16));
            return at + 2;
        } else if others & 0x80 == 0 {
            append(10, bytes & 0xff);
            return at + 1;
        } else {
            return at;
        }
    }
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit <= 9) {
        append(10, u32::from(digit));
        at += 1;
    }
    at
}

/// Four digits, the first in the lowest byte, as a number: to pairs, then to all.
#[inline]
fn of_four(digits: u32) -> u32 {
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8) & 0x00ff_00ff;
    pairs.wrapping_mul(100).wrapping_add(pairs >> 16) & 0xffff
}

/// The exponent whose "e" stands at `at`, and where it ends; 0 and `at` where no digits follow.
fn exponent_at(text: &[u8], at: usize) -> (i64, usize) {
    let sign = text.get(at + 1);
    let from = at + 1 + usize::from(matches!(sign, Some(b'+' | b'-')));
    let mut magnitude = 0;
    let to = digits(text, from, &mut magnitude);
    if to == from {
        return (0, at);
    }
    // 10^99999 is infinite and 10^-99999 zero, as the library has it.
    let magnitude = if to - from > 5 { 99_999 } else { i64::try_from(magnitude).unwrap_or(99_999) };
    (if sign == Some(&b'-') { -magnitude } else { magnitude }, to)
}

fn by_library(text: &[u8], decimal: u8) -> Option<f64> {
    let text = std::str::from_utf8(text).ok()?;
    if decimal == b'.' { text.parse().ok() } else { text.replace(char::from(decimal), ".").parse().ok() }
}

/// A whole cell as a number; U+2212 is the minus of typesetters and of spreadsheets in some languages.
pub(super) fn of_cell(cell: &[u8], decimal: u8) -> Option<f64> {
    let cell = cell.trim_ascii();
    let whole =
        |cell: &[u8]| leading(cell, decimal).filter(|&(_, used)| used == cell.len()).map(|(value, _)| value);
    match cell.strip_prefix("−".as_bytes()) {
        Some([b'-' | b'+', ..]) => None,
        Some(magnitude) => whole(magnitude).map(|value| -value),
        None => whole(cell).or_else(|| {
            // Fortran's double precision, "1.25D-04", always with a sign.
            let at = cell.windows(2).position(|pair| matches!(pair, [b'D' | b'd', b'-' | b'+']))?;
            whole(&[&cell[..at], b"e", &cell[at + 1..]].concat())
        }),
    }
}

/// What stands for no value, after a sign and "#": of spreadsheets, of C libraries, of loggers whose
/// converter ran over its range.
#[rustfmt::skip]
const MISSING: [&str; 41] = [
    "nan", "nan(ind)", "inf", "infinity", "∞", "null", "none", "na", "n/a", "nv", "novalue", "no value",
    "-", "--",
    "value!", "wert!", "div/0!", "num!", "zahl!", "ref!", "bezug!", "name?", "null!", "1.#qnan", "1.#ind",
    "1.#inf",
    "ol", "ovl", "ovld", "over", "overload", "overrange", "overflow",
    "err", "error", "n.a.", "nichtzahl", "\\n", "<na>", "no data", "Überlauf",
];

/// Whether a cell says that there is no value: `-`, `NaN`, `#N/A`, `-OVL`, `######`, `>400`.
pub(super) fn is_missing(cell: &[u8]) -> bool {
    let unmarked = |cell: &[u8]| cell.iter().take_while(|byte| matches!(byte, b'#' | b'*')).count();
    let bare = &cell[unmarked(cell)..];
    let bare = if let [b'-' | b'+', rest @ ..] = bare { rest } else { bare };
    let bare = &bare[unmarked(bare)..];
    bare.is_empty()
        || matches!(bare, [b'<' | b'>', b'0'..=b'9' | b'-' | b'.', ..])
        || MISSING.iter().any(|word| bare.eq_ignore_ascii_case(word.as_bytes()))
}

/// Whether a cell is a number whose thousands are marked too, such as "1.234,5", "1,234,567" or "12'345.6".
///
/// One mark alone is not taken for that of thousands, "1,234" may be a decimal fraction, but where it is not
/// the known decimal mark.
pub(super) fn is_grouped(cell: &str, decimal: Option<u8>) -> bool {
    let digits = cell.trim().trim_start_matches(['-', '+']);
    let mut groups = digits.split(['.', ',', '\'', '’', ' ', '\u{a0}', '\u{202f}']);
    let marks: Vec<char> = digits.chars().filter(|c| !c.is_ascii_digit()).collect();
    let Some((last, thousands)) = marks.split_last() else { return false };
    let has_fraction = thousands.first().is_some_and(|first| first != last);
    let is_digits = |group: &str| group.bytes().all(|b| b.is_ascii_digit());
    let is_first = groups.next().is_some_and(|first| (1..=3).contains(&first.len()) && is_digits(first));
    let rest: Vec<&str> = groups.collect();
    let whole = if has_fraction { &rest[..rest.len().saturating_sub(1)] } else { &rest[..] };
    // An unknown mark leaves a group that is not of three.
    is_first
        && (marks.len() > 1
            || !matches!(last, '.' | ',')
            || decimal.is_some_and(|mark| *last != char::from(mark)))
        && thousands.windows(2).all(|pair| pair[0] == pair[1])
        && whole.iter().all(|group| group.len() == 3)
        && rest.iter().all(|group| is_digits(group))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_are_those_of_the_standard_library_to_the_bit() {
        for text in [
            "0",
            "-0.0",
            "1",
            "-12.5",
            "+3.25",
            "0.1",
            ".5",
            "5.",
            "1e3",
            "-2.5E-7",
            "123456789012345678",
            "9007199254740993",
            "1.7976931348623157e308",
            "4.9e-324",
            "1e400",
            "1e-400",
            "0.30000000000000004",
            "12345678901234567890.123456789",
            "1e22",
            "1e23",
            "8.41e+05",
            "1e9999999",
        ] {
            let expected: f64 = text.parse().unwrap();
            let got = of_cell(text.as_bytes(), b'.').unwrap();
            assert_eq!(got.to_bits(), expected.to_bits(), "{text}");
            let comma = text.replace('.', ",");
            assert_eq!(of_cell(comma.as_bytes(), b',').unwrap().to_bits(), expected.to_bits(), "{comma}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(4096) })]

        #[test]
        fn any_number_is_that_of_the_standard_library(
            number in "[+-]?([0-9]{1,20}|[0-9]{0,12}\\.[0-9]{1,12}|[0-9]{1,5}\\.)(e[+-]?[0-9]{1,3})?",
            behind in "([,;\n\r :/ea-][0-9.]{0,9})?",
        ) {
            let expected: f64 = number.parse().unwrap();
            prop_assume!(behind.as_bytes().get(..2).is_none_or(|b| b[0] != b'e' || !b[1].is_ascii_digit()));
            let text = number.clone() + &behind;
            let (value, used) = leading(text.as_bytes(), b'.').unwrap();
            prop_assert_eq!((value.to_bits(), used), (expected.to_bits(), number.len()));
            let is_json = serde_json::from_str::<f64>(&number).is_ok();
            prop_assert_eq!(leading_json(text.as_bytes()).is_some(), is_json, "{}", number);
        }
    }

    #[test]
    fn words_are_no_numbers() {
        for (text, value) in
            [("−1.5", -1.5), (" −2e3 ", -2e3), ("−.5", -0.5), ("1.5D+02", 150.0), ("-2.d-1", -0.2)]
        {
            assert_eq!(of_cell(text.as_bytes(), b'.'), Some(value), "{text}");
        }
        for text in [
            "−",
            "–",
            "–1",
            "−+1",
            "−-1",
            "-−1",
            "",
            "-",
            "e5",
            ".",
            "1.2.3",
            "1,5",
            "12a",
            "0x10",
            "1D5",
            "1.5D-",
            "3D-2D",
            "1e",
            "--1",
            "20.11.2026",
        ] {
            assert_eq!(of_cell(text.as_bytes(), b'.'), None, "{text}");
        }
        for cell in ["1.234,5", "-1,234.5", "1,234,567", "12'345.67", "1 234", "1.234.567,0", "1\u{a0}234,5"]
        {
            assert!(is_grouped(cell, None), "{cell}");
        }
        assert!(is_grouped("-15,892", Some(b'.')) && !is_grouped("15.892", Some(b'.')));
        for cell in [
            "1,234",
            "1.5",
            "12345",
            "20.11.2026",
            "1,23,4.5",
            "a.bcd,e",
            "1234,567.8",
            "",
            "-",
            "1.234.",
            "OVL",
            "x 1",
        ] {
            assert!(!is_grouped(cell, None), "{cell}");
        }
        for cell in [
            "",
            "-",
            "--",
            "---",
            "NaN",
            "-nan(ind)",
            "+Inf",
            "#N/A",
            "#OVERFLOW",
            "-1.#IND",
            "-∞",
            "******",
            "####",
            "ERR",
            ">400",
            "<-400",
            "N.A.",
        ] {
            assert!(is_missing(cell.as_bytes()), "{cell}");
        }
        for cell in ["ok", "1", "nano", "–", "----", "*1", "#2", ">x"] {
            assert!(!is_missing(cell.as_bytes()), "{cell}");
        }
    }
}
