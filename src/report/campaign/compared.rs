//! Two rows to what they differ by, quantity by quantity.

use super::BatchRow;
use super::columns::NamedQuantity;
use crate::data::Estimate;
use crate::numerics::pooled::e_n;
use crate::report::document::ChapterPart;
use crate::report::rounding::{fixed, interval};
use crate::report::table::{ReportTable, TableCell};
use crate::report::text::Style;

/// One quantity of both.
struct QuantityPair<'a> {
    name: &'a str,
    a: Estimate,
    b: Estimate,
}

impl QuantityPair<'_> {
    fn e_n(&self) -> f64 {
        e_n((self.b.value, self.b.u95), (self.a.value, self.a.u95))
    }
}

/// The table of two rows.
pub(super) fn table<'a>(a: &'a BatchRow, b: &'a BatchRow) -> ChapterPart {
    let pair = |of_a: &'a NamedQuantity| {
        let of_b = b.quantities.iter().find(|of_b| of_b.name == of_a.name)?;
        Some(QuantityPair { name: &of_a.name, a: of_a.estimate, b: of_b.estimate })
    };
    let pairs: Vec<QuantityPair> =
        a.quantities.iter().filter_map(pair).filter(|pair| pair.e_n().is_finite()).collect();
    let difference = |QuantityPair { a, b, .. }: &QuantityPair| {
        interval(Some(&Estimate::new(b.value - a.value, a.u95.hypot(b.u95), a.unit)))
    };
    let word = |pair: &QuantityPair| {
        let words = fixed(pair.e_n(), 2);
        if pair.e_n().abs() > 1.0 {
            TableCell::marked(words, "differ")
        } else {
            TableCell::toned(Style::Dim, words)
        }
    };
    ReportTable::of(&pairs)
        .class("many")
        .caption(format!(
            "{} and {}: E_n = difference over the root of the squares of both half-widths; within ±1 they \
             agree.",
            a.id, b.id
        ))
        .head("quantity", |pair| pair.name.replace('_', " "))
        .number(&a.id[..], |pair| interval(Some(&pair.a)))
        .number(&b.id[..], |pair| interval(Some(&pair.b)))
        .number("difference", difference)
        .number("E_n", word)
        .into()
}
