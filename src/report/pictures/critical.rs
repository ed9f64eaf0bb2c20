//! Picture of critical angles: a row per case, a bar for its band and a dot for the maximum.

use super::super::rounding::{MISSING, plain};
use super::super::words::{case_words, criterion_value, criterion_words, degrees};
use super::draw::{Figure, Picture};
use super::look::{Look, NO_SLAP_DOWN, angle_axis, angle_panel};
use super::panel::{Curve, Fill, Panel, PointShape, Points, RowWords};
use crate::data::{Criterion, CriticalAngle, Study};

/// Height of a row.
const ROW: u32 = 46;

/// One row of the picture: a case with its words; a heading has only words.
struct CriticalRow<'a> {
    words: RowWords,
    case: Option<&'a CriticalAngle>,
}

/// The picture.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let look = Look::new(&study.request.contacts, &study.request.ks);
    let rows = rows(study, &look);
    let panel = angle_axis(&study.request).range.map(|_| panel(study, &look, &rows));
    Figure::new(name, "Critical angles", caption(study, &look, &rows))
        .empty(NO_SLAP_DOWN)
        .picture(panel.as_slice())
}

fn caption(study: &Study, look: &Look, rows: &[CriticalRow]) -> String {
    let rings = " Rings: angles at which the first end strikes again and the value is larger still; it jumps \
                 there from angle to angle.";
    let words_if = |is_so: bool, words| if is_so { words } else { "" };
    let is_larger = |row: &CriticalRow| row.case.is_some_and(|case| case.further_impacts.is_some());
    format!(
        "Dots: the drop angle at which each quantity is largest while the first end strikes once, with the \
         value at the right. Bars: the angles within {} % of it.{} Dashed: {}°.{}{}",
        plain(study.request.band_percent, 3),
        words_if(rows.iter().any(is_larger), rings),
        plain(study.request.angle_deg, 4),
        look.left_out_sentence(),
        words_if(is_crowded(study, look), " Single cases of the body only.")
    )
}

/// A heading for each criterion, and its cases.
fn rows<'a>(study: &'a Study, look: &Look) -> Vec<CriticalRow<'a>> {
    let is_crowded = is_crowded(study, look);
    let is_drawn = |case: &&CriticalAngle| {
        look.shows(case.contact, case.k) && !(is_crowded && case.model != study.monte_carlo.model)
    };
    let mut rows: Vec<CriticalRow> = Vec::new();
    for criterion in Criterion::ALL {
        let of_criterion = |case: &&CriticalAngle| case.criterion == criterion;
        let cases = study.critical.iter().filter(of_criterion).filter(is_drawn);
        let cases: Vec<CriticalRow> =
            cases.map(|case| CriticalRow { words: words(case), case: Some(case) }).collect();
        let left = format!("Largest {}", criterion_words(criterion));
        let words = RowWords { left, right: String::new(), is_heading: true };
        rows.extend((!cases.is_empty()).then_some(CriticalRow { words, case: None }));
        rows.extend(cases);
    }
    rows
}

/// With more cases than this the rod is omitted in favour of the body: the picture must fit a page.
const MOST_CASES: usize = 12;

fn is_crowded(study: &Study, look: &Look) -> bool {
    let speeds = study.critical.iter().filter(|c| c.criterion == Criterion::Speed);
    speeds.filter(|c| look.shows(c.contact, c.k)).count() > MOST_CASES
}

/// Words of a row: "body, rough, k = 0.5" at the left; "25.04 m/s at 12.5°" at the right, or the dash if
/// there is none.
fn words(case: &CriticalAngle) -> RowWords {
    let right = if case.largest.is_finite() && case.angle_deg.is_finite() {
        format!("{} at {}°", criterion_value(case.criterion, case.largest), degrees(case.angle_deg))
    } else {
        MISSING.to_owned()
    };
    let left = format!("{}, {}", case.model.as_str(), case_words(case.contact, case.k));
    RowWords { left, right, is_heading: false }
}

fn panel(study: &Study, look: &Look, rows: &[CriticalRow]) -> Panel {
    let Panel { x, marks, .. } = angle_panel(&study.request, "", "");
    let words = rows.iter().map(|row| row.words.clone()).collect();
    let mut panel = Panel { x, marks, ..Panel::from_rows(words, ROW, (400, 330)) };
    for (i, row) in rows.iter().enumerate() {
        if let Some(case) = row.case {
            let y = panel.row_middle(i);
            add_case(&mut panel, look, case, y);
        }
    }
    panel
}

/// Draws the band of a case as a bar, its critical angle as a dot, a larger value at another angle as a ring.
fn add_case(panel: &mut Panel, look: &Look, case: &CriticalAngle, y: f64) {
    /// Half the height of a bar.
    const HALF: f64 = 0.24;
    let colour = look.colour(case.contact, case.k);
    let (first, last) = panel.x.range.unwrap_or_default();
    for band in &case.bands_deg {
        let (from, to) = (band.0.clamp(first, last), band.1.clamp(first, last));
        let upright = |x: f64| Curve { stroke: 3, ..Curve::new(colour, vec![(x, y - HALF), (x, y + HALF)]) };
        panel.lines.extend([from, to].map(upright));
        let area = Fill::rectangle((from, to), (y - HALF, y + HALF));
        panel.fills.push(Fill::new(colour, 0.32, vec![area]));
    }
    let dot = |angle_deg, is_hollow| Points {
        is_hollow,
        radius: 8,
        ..Points::new(colour, PointShape::Dot, vec![(angle_deg, y)])
    };
    panel.points.extend(case.further_impacts.map(|(angle_deg, _)| dot(angle_deg, true)));
    panel.points.push(dot(case.angle_deg, false));
}
