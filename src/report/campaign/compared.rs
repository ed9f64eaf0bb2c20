//! Two rows to what they differ by, quantity by quantity.

use super::BatchRow;
use super::columns::NamedQuantity;
use crate::data::Estimate;
use crate::numerics::pooled::e_n;
use crate::report::document::ChapterPart;
use crate::report::rounding::{fixed, interval};
use crate::report::table::{ReportTable, TableCell};

/// The table of two rows.
pub(super) fn table<'a>(a: &'a BatchRow, b: &'a BatchRow) -> ChapterPart {
    let e_n = |(a, b): &(&NamedQuantity, &NamedQuantity)| {
        e_n((b.estimate.value, b.estimate.u95), (a.estimate.value, a.estimate.u95))
    };
    let pair =
        |of_a: &'a NamedQuantity| Some((of_a, b.quantities.iter().find(|of_b| of_b.name == of_a.name)?));
    let pairs: Vec<(&NamedQuantity, &NamedQuantity)> =
        a.quantities.iter().filter_map(pair).filter(|pair| e_n(pair).is_finite()).collect();
    let difference = |(a, b): &(&NamedQuantity, &NamedQuantity)| {
        let (a, b) = (a.estimate, b.estimate);
        interval(Some(&Estimate::new(b.value - a.value, a.u95.hypot(b.u95), a.unit)))
    };
    let word = |pair: &(&NamedQuantity, &NamedQuantity)| {
        TableCell::marked(fixed(e_n(pair), 2), if e_n(pair).abs() > 1.0 { "differ" } else { "" })
    };
    ReportTable::of(&pairs)
        .class("many")
        .caption(format!(
            "{} and {}: E_n = difference over the root of the squares of both half-widths; within ±1 they \
             agree.",
            a.id, b.id
        ))
        .head("quantity", |(a, _)| a.name)
        .number(&a.id[..], |(a, _)| interval(Some(&a.estimate)))
        .number(&b.id[..], |(_, b)| interval(Some(&b.estimate)))
        .number("difference", difference)
        .number("E_n", word)
        .into()
}
