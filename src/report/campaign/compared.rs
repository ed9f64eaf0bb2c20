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
    a: &'a NamedQuantity,
    b: &'a NamedQuantity,
}

impl QuantityPair<'_> {
    fn e_n(&self) -> f64 {
        e_n((self.b.value, self.b.u95), (self.a.value, self.a.u95))
    }
}

/// The table of two rows.
pub(super) fn table<'a>(a: &'a BatchRow, b: &'a BatchRow) -> ChapterPart {
    let pair =
        |a: &'a NamedQuantity| b.quantities.iter().find(|b| b.name == a.name).map(|b| QuantityPair { a, b });
    let pairs: Vec<QuantityPair> =
        a.quantities.iter().filter_map(pair).filter(|pair| pair.e_n().is_finite()).collect();
    let difference = |pair: &QuantityPair| {
        let (value, u95) = (pair.b.value - pair.a.value, pair.a.u95.hypot(pair.b.u95));
        shown(&NamedQuantity { value, u95, ..pair.a.clone() })
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
        .caption(format!("{} and {}: E_n = difference over the root of the squares of both half-widths; within ±1 they agree.", a.id, b.id))
        .head("quantity", |pair| pair.a.name.replace('_', " "))
        .number(&a.id[..], |pair| shown(pair.a))
        .number(&b.id[..], |pair| shown(pair.b))
        .number("difference", difference)
        .number("E_n", word)
        .into()
}

fn shown(quantity: &NamedQuantity) -> String {
    let known = ["s", "m/s", "rad/s", "deg", "1", "m", "m/s^2", "N", "N s", "J"];
    let unit = known.into_iter().find(|unit| *unit == quantity.unit).unwrap_or_default();
    interval(Some(&Estimate::new(quantity.value, quantity.u95, unit)))
}
