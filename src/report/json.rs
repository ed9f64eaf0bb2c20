//! Writes results and listings as JSON: pretty, keys in the documented order, never a value that is not a
//! number.

use super::ReportError;
use super::text::steers_line;

/// Writes a result, a listing or the like as a file: two spaces of indentation and a line feed at the end.
///
/// # Errors
///
/// [`ReportError::Json`] if the writer fails.
pub fn pretty<T: serde::Serialize>(value: &T) -> Result<Vec<u8>, ReportError> {
    Ok((escape(serde_json::to_string_pretty(value)?) + "\n").into_bytes())
}

/// Writes any value as JSON in a single line, without a line end.
///
/// # Errors
///
/// [`ReportError::Json`] if the writer fails.
pub fn to_line<T: serde::Serialize>(value: &T) -> Result<String, ReportError> {
    Ok(escape(serde_json::to_string(value)?))
}

/// Escapes the characters in JSON that a terminal would obey.
fn escape(text: String) -> String {
    if !text.contains(steers) {
        return text;
    }
    let escaped = |c: char| if steers(c) { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() };
    text.chars().map(escaped).collect()
}

/// True for characters that JSON may contain unescaped although a terminal would obey them: controls beyond
/// ASCII, line ends and directions of Unicode.
fn steers(c: char) -> bool {
    steers_line(c) || ('\u{7f}'..='\u{9f}').contains(&c)
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use crate::data::Estimate;
    use serde_json::Value;

    #[test]
    fn words_of_a_file_do_not_steer_a_terminal() {
        let words = "A\u{9b}2J\u{202e}\u{1b}[2J\u{7f}é";
        let text = String::from_utf8(pretty(&words).unwrap()).unwrap();
        assert_eq!(text.trim_end(), r#""A\u009b2J\u202e\u001b[2J\u007fé""#);
        assert_eq!(serde_json::from_str::<String>(&text).unwrap(), words);
    }

    #[test]
    fn the_result_has_the_keys_of_the_contract() {
        let json: Value = serde_json::from_slice(&pretty(&sample::analysis().result).unwrap()).unwrap();
        assert_eq!(json["schema"], "dropcheck.result/1");
        assert_eq!(json["k"]["unit"], "1");
        assert_eq!(json["verdict"], "review");
        assert_eq!(json["model"]["name"], "body");
        assert_eq!(json["predictions"][0]["contact"], "rough");
        assert_eq!(json["quality"][0]["code"], "clipped");
        assert_eq!(json["reconstruction"]["rung"], "flight");
        assert_eq!(json["reconstruction"]["closures"][1]["kind"], "turning");
        assert_eq!(json["reconstruction"]["chi_square"][1], 2);
        for key in ["time", "flight_time", "speed", "vertical_velocity", "horizontal_velocity", "angle"] {
            assert!(json["slap_down"][key]["u95"].is_f64(), "{key}");
        }
    }

    #[test]
    fn half_a_quantity_is_null() {
        let mut analysis = sample::analysis();
        analysis.result.k = Some(Estimate::new(f64::NAN, 0.1, "1"));
        analysis.result.slap_down.speed = Some(Estimate::new(20.0, f64::INFINITY, "m/s"));
        let choice = analysis.result.reconstruction.as_mut().expect("the sample has one");
        choice.candidates[0].k = Some(Estimate::new(f64::NAN, 0.1, "1"));
        choice.closures[0].miss_in_u = f64::NAN;
        choice.chi_square = Some((f64::INFINITY, 2));
        let json: Value = serde_json::from_slice(&pretty(&analysis.result).unwrap()).unwrap();
        assert!(json["k"].is_null());
        assert!(json["slap_down"]["speed"].is_null());
        let choice = &json["reconstruction"];
        assert!(choice["candidates"][0]["k"].is_null() && choice["chi_square"][0].is_null());
        assert!(choice["closures"][0]["miss_in_u"].is_null());
        assert!(choice["candidates"][1]["k"]["value"].is_f64());
    }
}
