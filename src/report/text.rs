//! Makes words from files safe and fit the page: no control characters, wrapped, coloured by SGR codes.

use super::rounding::{MISSING, plain};
use crate::data::{Drop, DropResult, Effect, Estimate, Finding, Method, MissingQuantity, Severity, Verdict};

/// Keeps each of `items` once, in the order of first appearance.
pub(super) fn dedup<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for item in items {
        if !found.contains(&item) {
            found.push(item);
        }
    }
    found
}

/// The lines, each with its end.
pub(super) fn lines(lines: impl IntoIterator<Item = String>) -> String {
    lines.into_iter().map(|text| text + "\n").collect()
}

/// Every line of `text` in `style`.
pub(super) fn styled_lines(style: Style, text: &str) -> String {
    lines(text.lines().map(|line| paint(style, line)))
}

#[cfg(test)]
pub(super) const WIDTH: usize = 80;

/// An SGR colour (ECMA-48, 8.3.117); the caller strips it if no terminal reads it.
#[derive(Clone, Copy)]
pub(crate) enum Style {
    /// A heading.
    Bold,
    /// Text of less importance.
    Dim,
    /// Good.
    Green,
    /// Needs a look.
    Yellow,
    /// Bad.
    Red,
}

/// Puts `text` between the codes of `style`.
pub(super) fn paint(style: Style, text: &str) -> String {
    let code = match style {
        Style::Bold => "1",
        Style::Dim => "2",
        Style::Green => "1;32",
        Style::Yellow => "1;33",
        Style::Red => "1;31",
    };
    format!("\u{1b}[{code}m{text}\u{1b}[0m")
}

/// Removes control and direction characters, which a file could use to write elsewhere on a terminal.
pub fn sanitize(text: &str) -> String {
    text.chars()
        .filter_map(|c| match c {
            '\t' | '\n' | '\r' | '\u{2028}' | '\u{2029}' => Some(' '),
            c => (!is_hidden(c)).then_some(c),
        })
        .collect()
}

/// True if a character steers a terminal or the direction of reading, or is not allowed in XML 1.0.
pub(super) fn is_hidden(c: char) -> bool {
    steers_line(c) || c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
}

/// True if a character ends a line or steers the direction of reading.
pub(super) fn steers_line(c: char) -> bool {
    matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Units that may follow a number.
const UNITS: [&str; 19] = [
    "%", "°", "m", "mm", "s", "ms", "g", "kg", "kN", "MN", "kJ", "Hz", "kHz", "m/s", "m/s²", "rad/s", "°/s",
    "°C", "V",
];

/// True if no line may end between these words: a number, its interval and its unit belong together.
fn belong_together(before: &str, word: &str) -> bool {
    let unit = word.trim_end_matches(['.', ',', ';', ':', ')']);
    let last = before.rsplit('\u{a0}').next().unwrap_or_default();
    let is_number = last.trim_start_matches(['(', '−', '+', '-']).starts_with(|c: char| c.is_ascii_digit())
        && last.ends_with(|c: char| c.is_ascii_digit());
    before.ends_with('±') || word.starts_with('±') || (is_number && UNITS.contains(&unit))
}

/// Breaks `text` between words to `width` columns, each line after `indent` spaces; a longer word stays
/// whole, as do words joined by a no-break space, and a number with its unit.
pub(super) fn wrap(text: &str, width: usize, indent: usize) -> String {
    let room = width.saturating_sub(indent).max(10);
    let text = sanitize(text);
    let mut words: Vec<String> = Vec::new();
    for word in text.split(|c: char| c.is_whitespace() && c != '\u{a0}').filter(|word| !word.is_empty()) {
        match words.last_mut().filter(|before| belong_together(before, word)) {
            Some(before) => before.extend(["\u{a0}", word]),
            None => words.push(word.to_owned()),
        }
    }
    let mut broken: Vec<String> = Vec::new();
    for word in words {
        let has_room = |line: &&mut String| line.chars().count() + 1 + word.chars().count() <= room;
        match broken.last_mut().filter(has_room) {
            Some(line) => line.extend([" ", &word]),
            None => broken.push(word),
        }
    }
    broken.extend(broken.is_empty().then(String::new));
    let pad = " ".repeat(indent);
    lines(broken.into_iter().map(|line| format!("{pad}{}", line.replace('\u{a0}', " "))))
}

/// The last `width` characters of `text`, after an ellipsis if some are omitted: the end of a path is most
/// informative.
pub(super) fn tail(text: &str, width: usize) -> String {
    let text = sanitize(text);
    let length = text.chars().count();
    if length <= width {
        return text;
    }
    let kept: String = text.chars().skip(length + 1 - width).collect();
    format!("…{kept}")
}

/// "1 note", "3 notes".
pub(super) fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// The verdict in capital words; an error may leave one number valid, k or the slap-down speed, or both.
pub(super) fn verdict_word(verdict: Verdict, number: Option<Estimate>) -> &'static str {
    match verdict {
        Verdict::Pass => "DATA SOUND",
        Verdict::Review => "REVIEW",
        Verdict::Fail if number.is_some() => "PARTLY USABLE",
        Verdict::Fail => "NOT TO BE USED",
    }
}

/// The verdict's colour.
pub(super) fn verdict_style(verdict: Verdict) -> Style {
    match verdict {
        Verdict::Pass => Style::Green,
        Verdict::Review => Style::Yellow,
        Verdict::Fail => Style::Red,
    }
}

/// Counts the findings as "2 errors (`clipped` A1), 1 warning (`gap` A2)"; `None` without either.
pub(super) fn grave_findings(result: &DropResult) -> Option<String> {
    let place = |f: &Finding| match &f.channel {
        Some(channel) => format!("`{}` {channel}", json_word(f.code)),
        None => format!("`{}`", json_word(f.code)),
    };
    let of_severity = |severity| {
        let all: Vec<&Finding> = result.quality.iter().filter(|f| f.severity == severity).collect();
        let places = dedup(all.iter().map(|f| place(f))).join(", ");
        (!all.is_empty()).then(|| format!("{} ({places})", plural(all.len(), &json_word(severity))))
    };
    let all: Vec<String> = [Severity::Error, Severity::Warning].into_iter().filter_map(of_severity).collect();
    (!all.is_empty()).then(|| all.join(", "))
}

/// Sentence on the quantities that are determined and those that are not, or on the findings to read first.
pub(super) fn verdict_sentence(result: &DropResult) -> String {
    match (result.k, result.slap_down.speed) {
        (Some(_), Some(_)) => grave_findings(result)
            .map_or_else(|| "No check found a problem.".to_owned(), |all| format!("Before use, read {all}.")),
        (Some(_), None) => "k is valid, the slap-down speed is not determined.".into(),
        (None, Some(_)) => "The slap-down speed is valid, k is not determined.".into(),
        (None, None) => "Not determined: k and the slap-down speed.".into(),
    }
}

/// Reasons why k and the slap-down speed are not determined, else the most severe finding; then the mistakes
/// that would explain them.
pub(super) fn causes(result: &DropResult) -> Vec<String> {
    let (hints, others): (Vec<&Finding>, Vec<&Finding>) =
        result.quality.iter().filter(|f| f.severity > Severity::Note).partition(|f| f.effect == Effect::Hint);
    let mut counts: Vec<String> =
        reasons(result, &["k", "slap_down.speed"]).into_iter().map(sentence).collect();
    let first = others.first().filter(|_| counts.is_empty() && hints.is_empty());
    counts.extend(first.into_iter().chain(&hints).map(|found| sentence(&found.with_channel())));
    counts
}

/// A word as the result's JSON writes it, such as "`ends_early`", "mcap" or "warning".
pub(crate) fn json_word<T: serde::Serialize + std::fmt::Debug>(value: T) -> String {
    match serde_json::to_value(&value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => format!("{value:?}"),
    }
}

/// The span of an issue in ms, or nothing.
pub(super) fn span_text(issue: &Finding) -> Option<String> {
    let from = issue.from_s.filter(|t| t.is_finite())? * 1e3;
    match issue.to_s.map(|t| t * 1e3).filter(|t| t.is_finite() && *t > from) {
        Some(to) => Some(format!("{from:.2}–{to:.2} ms")),
        None => Some(format!("{from:.2} ms")),
    }
}

/// A time in ms.
pub(super) fn moment(time_s: f64) -> String {
    format!("{} ms", plain(time_s * 1e3, 7))
}

/// Replaces the hyphen before each number by a true minus sign; text between backticks can be pasted and
/// stays.
pub(super) fn true_minus(text: &str) -> String {
    let (mut before, mut is_code) = (' ', false);
    let behind = text.chars().skip(1).chain([' ']);
    let letter = |(letter, next): (char, char)| {
        let begins = before.is_whitespace() || before == '(';
        before = letter;
        is_code ^= letter == '`';
        if letter == '-' && begins && !is_code && next.is_ascii_digit() { '−' } else { letter }
    };
    text.chars().zip(behind).map(letter).collect()
}

/// A number that stands alone, where a dash would be meaningless.
pub(super) fn or_unknown(number: String) -> String {
    if number == MISSING { "not determined".to_owned() } else { number }
}

/// "9 m at 15°".
pub(super) fn drop_words(drop: &Drop) -> String {
    format!("{} m at {}°", plain(drop.height_m, 5), plain(drop.angle_rad.to_degrees(), 5))
}

/// Name of a reconstruction method in a table.
pub(super) fn rung_words(rung: Method) -> &'static str {
    match rung {
        Method::Flight => "planar motion, flight fitted with modes and drift",
        Method::Joint => "joint fit of all inputs within their tolerances",
    }
}

/// Mark after the name of the selected row.
pub(super) fn chosen_mark(is_taken: bool) -> &'static str {
    if is_taken { " (taken)" } else { "" }
}

/// "yes" or "no".
pub(super) fn yes_no(so: bool) -> &'static str {
    if so { "yes" } else { "no" }
}

/// `words` with a capital.
pub(super) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}", first.to_uppercase(), letters.as_str()))
}

/// Turns a reason into a sentence: a capital and a full stop.
pub(super) fn sentence(reason: &str) -> String {
    let reason = true_minus(&sanitize(reason));
    let words = capital(reason.trim().trim_end_matches('.'));
    if words.is_empty() { words } else { words + "." }
}

/// Reasons why the quantities at or below these paths of the result are missing, each once.
pub(super) fn reasons<'a>(result: &'a DropResult, places: &[&str]) -> Vec<&'a str> {
    let is_meant = |missing: &&MissingQuantity| {
        places.iter().any(|place| missing.quantity.starts_with(place))
            && !missing.quantity.contains(".channels[")
    };
    dedup(result.missing.iter().filter(is_meant).map(|missing| &missing.words[..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::IssueCode;

    #[test]
    fn a_name_cannot_move_the_cursor() {
        assert_eq!(sanitize("A1\u{1b}[2J\u{7}\nB\u{202e}"), "A1[2J B");
    }

    #[test]
    fn lines_keep_within_the_width() {
        let text = wrap(&"word ".repeat(40), 30, 4);
        assert!(text.lines().all(|line| line.chars().count() <= 30 && line.starts_with("    ")));
        assert_eq!(text.split_whitespace().count(), 40);
    }

    #[test]
    fn no_line_ends_between_a_number_and_its_unit() {
        let text = "a word 20.37 ± 0.63 m/s, −0.1 % (5 mm) of a channel ± 2 % at 15 kN s";
        for width in 10..60 {
            for line in wrap(text, width, 0).lines().skip(1) {
                let units = ["±", "0.63", "m/s", "%", "mm", "2 %", "kN"];
                assert!(units.iter().all(|unit| !line.starts_with(unit)), "{width}: {line}");
            }
        }
    }

    #[test]
    fn a_long_path_keeps_its_end() {
        assert_eq!(tail("/a/long/way/to/test.mcap", 12), "…o/test.mcap");
        assert_eq!(tail("test.mcap", 12), "test.mcap");
    }

    #[test]
    fn a_sign_is_a_minus_and_a_hyphen_stays_one() {
        assert_eq!(
            true_minus("-0.8 % of A1-2 (-3), slap-down, 1e-3"),
            "−0.8 % of A1-2 (−3), slap-down, 1e-3"
        );
        assert_eq!(sentence("off by -1"), "Off by −1.");
        assert_eq!(sentence("reads -1: set `polarity = -1`"), "Reads −1: set `polarity = -1`.");
    }

    #[test]
    fn codes_are_written_as_in_the_json() {
        assert_eq!(json_word(IssueCode::DuplicateBlocks), "duplicate_blocks");
    }
}
