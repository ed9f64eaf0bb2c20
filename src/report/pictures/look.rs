//! Colours and strokes of contact laws and k, so that a case looks the same in every picture; and the axis of
//! the angle.

use super::super::rounding::plain;
use super::super::words::contact_words;
use super::panel::{COLOURS, Colour, Curve, Dash, Mark, Panel, PanelAxis};
use crate::data::{BodyModel, Cask, Contact, StudyRequest};

/// Most contact laws in a picture: more lines cannot be distinguished.
pub(super) const MOST_CONTACTS: usize = 3;

/// Most k in a picture beside several contact laws, each with another stroke, and beside one, each with
/// another colour.
const MOST_KS: usize = 3;
const MOST_KS_ALONE: usize = 5;

/// The strokes of k from the highest on.
pub(super) const DASHES: [Dash; 3] = [Dash::Solid, Dash::Dashed, Dash::Dotted];

/// The sentence and the caption of an empty picture.
pub(super) const NO_SLAP_DOWN: (&str, &str) =
    ("There is nothing to show: the second end never strikes.", "No case of this study has a slap-down.");

/// The cases that pictures show, and how.
pub(super) struct Look {
    /// Contact laws; each has a colour if there are several.
    pub(super) contacts: Vec<Contact>,
    /// Coefficients of restitution, ascending.
    pub(super) ks: Vec<f64>,
    left_out: bool,
}

impl Look {
    /// Chooses the look of these cases; if there are too many, the first contact laws, and k spread over all.
    pub(super) fn new(contacts: &[Contact], ks: &[f64]) -> Self {
        let mut sorted = ks.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let shown = &contacts[..contacts.len().min(MOST_CONTACTS)];
        let ks = pick_evenly(&sorted, if shown.len() > 1 { MOST_KS } else { MOST_KS_ALONE });
        let left_out = shown.len() < contacts.len() || ks.len() < sorted.len();
        Self { contacts: shown.to_vec(), ks, left_out }
    }

    /// Keeps only the highest and the lowest k.
    pub(super) fn with_ends(self) -> Self {
        Self { ks: pick_evenly(&self.ks, 2), ..self }
    }

    /// Position of a case among those drawn: the index of its contact law, and that of k from the highest.
    pub(super) fn place(&self, contact: Contact, k: f64) -> Option<[usize; 2]> {
        let of_contact = self.contacts.iter().position(|shown| *shown == contact)?;
        let of_k = self.ks.iter().rev().position(|shown| shown.to_bits() == k.to_bits())?;
        Some([of_contact, of_k])
    }

    /// True if this case is drawn.
    pub(super) fn shows(&self, contact: Contact, k: f64) -> bool {
        self.place(contact, k).is_some()
    }

    /// Colour of the contact law, or of k if there is only one law.
    pub(super) fn colour(&self, contact: Contact, k: f64) -> Colour {
        let place = self.place(contact, k).unwrap_or_default();
        COLOURS[place[usize::from(self.contacts.len() < 2)] % COLOURS.len()]
    }

    /// The line of a case: if the contact laws use the colours each k has a stroke.
    pub(super) fn line(&self, contact: Contact, k: f64, points: Vec<(f64, f64)>) -> Curve {
        let of_k = self.place(contact, k).filter(|_| self.contacts.len() > 1).map_or(0, |place| place[1]);
        Curve::new(self.colour(contact, k), points).broken(DASHES[of_k % DASHES.len()])
    }

    /// A sentence on the cases that are not drawn, or nothing.
    pub(super) fn left_out_sentence(&self) -> String {
        if !self.left_out {
            return String::new();
        }
        let contacts: Vec<String> = self.contacts.iter().map(|c| contact_words(*c)).collect();
        let ks: Vec<String> = self.ks.iter().map(|k| plain(*k, 3)).collect();
        format!(" Of all cases asked for only {} with k = {} are drawn.", contacts.join(", "), ks.join(", "))
    }
}

/// Picks at most `most` of the values, the first and the last among them, the others evenly between.
pub(super) fn pick_evenly(values: &[f64], most: usize) -> Vec<f64> {
    if values.len() <= most {
        return values.to_vec();
    }
    let last = values.len() - 1;
    (0..most).map(|i| values[(i * last + (most - 1) / 2) / (most - 1)]).collect()
}

/// Formats "Thin rod, l = 5.512 m", and for the body its section; without the length if that is swept.
pub(super) fn body_words(model: BodyModel, cask: &Cask, with_length: bool) -> String {
    let length = if with_length { format!(", l = {} m", plain(cask.length_m, 4)) } else { String::new() };
    match model {
        BodyModel::Rod => format!("Thin rod{length}"),
        BodyModel::Body => format!("Body{length}, section {} m", plain(cask.height_m, 4)),
    }
}

/// The axis of the drop angle, as far as the study goes.
pub(super) fn angle_axis(request: &StudyRequest) -> PanelAxis {
    let ends = request.angles_deg.first().copied().zip(request.angles_deg.last().copied());
    PanelAxis::new("drop angle, °").range(ends.filter(|(from, to)| from < to))
}

/// An empty panel over the angles of the study, with the requested angle marked.
pub(super) fn angle_panel(request: &StudyRequest, title: impl Into<String>, y_label: &str) -> Panel {
    let at = request.angle_deg;
    let marks = vec![Mark { at, label: format!("{}°", plain(at, 4)) }];
    Panel { marks, ..Panel::new(title, angle_axis(request), y_label, 400) }
}

/// The borders of cells around `centres`: half way between them, the outer ones on the outer centres.
pub(super) fn edges(centres: &[f64]) -> Vec<f64> {
    let inner = centres.windows(2).map(|w| f64::midpoint(w[0], w[1]));
    centres.first().copied().into_iter().chain(inner).chain(centres.last().copied()).collect()
}

/// Splits off the points at which the cask turns over, as a pale line without a name.
pub(super) fn split_turnovers(line: Curve, turns_over: &[bool]) -> Vec<Curve> {
    let part = |wanted: bool| {
        let points = line.points.iter().zip(turns_over);
        points.map(|((x, y), over)| (*x, if *over == wanted { *y } else { f64::NAN })).collect()
    };
    let pale = Curve { label: None, opacity: 0.3, points: part(true), ..line.clone() };
    let whole = Curve { points: part(false), ..line };
    [whole].into_iter().chain(turns_over.contains(&true).then_some(pale)).collect()
}

/// Stroke of the closed forms: no other line is as thin.
pub(super) const HELD_STROKE: u32 = 3;

/// Sentences on the ends of lines, and on lines that are pale or dotted.
pub(super) fn line_sentences(panels: &[Panel]) -> String {
    const OPEN: &str = "Where a line is broken off the second end never strikes; where the first end strikes \
                        again before it, the line may jump.";
    const HELD: &str = " Dotted: the closed form for k = 0 ([P] Table 2), the first end held on the target \
                        whatever the force.";
    const PALE: &str = " Pale: the cask turns over (a somersault) before the second end strikes.";
    let any = |is_so: fn(&Curve) -> bool| panels.iter().flat_map(|panel| &panel.lines).any(is_so);
    let held = if any(|line| line.stroke == HELD_STROKE) { HELD } else { "" };
    let pale = if any(|line| line.label.is_none() && line.opacity < 1.0) { PALE } else { "" };
    format!("{OPEN}{held}{pale}")
}

/// Range from 0 to a little above the largest value that is drawn.
pub(super) fn range_from_zero(panel: &Panel) -> Option<(f64, f64)> {
    let largest = panel.points().map(|p| p.1).fold(0.0, f64::max);
    (largest > 0.0).then_some((0.0, largest * 1.08))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_lie_between_the_cells() {
        assert_eq!(edges(&[0.0, 1.0, 3.0]), [0.0, 0.5, 2.0, 3.0]);
    }

    #[test]
    fn many_values_are_thinned_and_keep_their_ends() {
        let values: Vec<f64> = (0..101).map(|i| f64::from(i) / 100.0).collect();
        assert_eq!(pick_evenly(&values, 5), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(pick_evenly(&values[..2], 5), [0.0, 0.01]);
        assert_eq!(pick_evenly(&values[..6], 5), [0.0, 0.01, 0.03, 0.04, 0.05]);
    }

    #[test]
    fn every_case_shown_looks_different() {
        let contacts = [Contact::Rough, Contact::Smooth, Contact::Coulomb(0.3), Contact::Coulomb(0.5)];
        let look = Look::new(&contacts, &[1.0, 0.0, 0.5, 0.25]);
        assert_eq!(look.ks, [0.0, 0.5, 1.0]);
        assert!(!look.shows(Contact::Coulomb(0.5), 1.0) && !look.shows(Contact::Rough, 0.25));
        assert!(look.left_out_sentence().contains("rough, smooth, μ 0.3 with k = 0, 0.5, 1"));
        let mut seen = Vec::new();
        for contact in look.contacts.clone() {
            for k in look.ks.clone() {
                let Curve { colour, dash, .. } = look.line(contact, k, Vec::new());
                let way = (colour, dash);
                assert!(!seen.contains(&way), "{contact} {k}");
                seen.push(way);
            }
        }
        assert_eq!(Look::new(&contacts[..1], &[0.0, 0.5]).left_out_sentence(), "");
    }
}
