//! Table of a result for LaTeX, with the values that a paper or a test report quotes.

use super::rounding::{MISSING, interval};
use crate::data::{DropResult, Estimate, QuantityRow};

/// Writes `results.tex`: a `tabular` of two columns, to be included with `\input`; needs no package.
pub(super) fn table(result: &DropResult) -> Vec<u8> {
    let own = |impact: &'static str, rows: Vec<QuantityRow>| {
        rows.into_iter().map(move |row| (format!("{impact}: {}", row.name), row.value))
    };
    let rows = own("First impact", result.first_impact.rows())
        .chain([("Coefficient of restitution $k$".to_owned(), result.k)])
        .chain(own("Slap-down", result.slap_down.rows()))
        .chain([("Slap-down speed over impact velocity".to_owned(), result.amplification)]);
    let line = |(name, value): (String, Option<_>)| format!("{name} & {} \\\\\n", cell(value.as_ref()));
    let lines = rows.map(line).collect::<Vec<String>>().concat();
    format!(
        "% dropcheck {}, SHA-256 of the recording: {}\n\\begin{{tabular}}{{lr}}\n\\hline\nQuantity & Value \
         $\\pm$ 95\\,\\% \\\\\n\\hline\n{lines}\\hline\n\\end{{tabular}}\n",
        result.version, result.input.recording_sha256
    )
    .into_bytes()
}

/// "$20.62 \pm 0.40$ m/s".
fn cell(value: Option<&Estimate>) -> String {
    let words = interval(value);
    if words == MISSING {
        return "--".to_owned();
    }
    let number_ends = words.char_indices().rev().find(|(_, c)| c.is_ascii_digit()).map_or(0, |(i, _)| i + 1);
    let (number, unit) = words.split_at(number_ends);
    let number = number.replace('−', "-").replace('±', "\\pm");
    let unit = unit.trim().replace('°', "$^\\circ$");
    format!("${number}$ {unit}").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_mathematics_and_its_unit_is_not() {
        let latex = |value, u95, unit| cell(Some(&Estimate::new(value, u95, unit)));
        assert_eq!(latex(-20.553, 0.51, "m/s"), "$-20.55 \\pm 0.51$ m/s");
        assert_eq!(latex(-4.98, 0.37, "deg"), "$-4.98 \\pm 0.37$ $^\\circ$");
        assert_eq!(latex(0.5507, 0.04, "1"), "$0.551 \\pm 0.040$");
        assert_eq!(cell(None), "--");
    }
}
