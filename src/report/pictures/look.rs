//! Contact laws and k to colours and strokes, so that a case looks the same in every picture; and the axis of
//! the angle.

use super::super::rounding::plain;
use super::super::words::contact_words;
use super::panel::{COLOURS, Colour, Curve, Dash, Mark, Panel, PanelAxis};
use crate::data::{BodyModel, Cask, Contact, StudyRequest};

/// Contact laws that a picture shows: more lines than these cannot be told apart.
pub(super) const MOST_CONTACTS: usize = 3;

/// The k that a picture shows beside several contact laws, each with a stroke of its own, and beside one,
/// each with a colour.
const MOST_KS: usize = 3;
const MOST_KS_ALONE: usize = 5;

/// The cases that pictures show, and how.
pub(super) struct Look {
    /// Contact laws; each has a colour where there are several.
    pub(super) contacts: Vec<Contact>,
    /// Coefficients of restitution, ascending.
    pub(super) ks: Vec<f64>,
    left_out: bool,
}

impl Look {
    /// The look of these cases; the first contact laws, and k spread over all, where there are too many.
    pub(super) fn of(contacts: &[Contact], ks: &[f64]) -> Self {
        let mut sorted = ks.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let shown = &contacts[..contacts.len().min(MOST_CONTACTS)];
        let ks = spread(&sorted, if shown.len() > 1 { MOST_KS } else { MOST_KS_ALONE });
        let left_out = shown.len() < contacts.len() || ks.len() < sorted.len();
        Self { contacts: shown.to_vec(), ks, left_out }
    }

    /// Whether this case is drawn.
    pub(super) fn shows(&self, contact: Contact, k: f64) -> bool {
        self.contacts.contains(&contact) && self.k_index(k).is_some()
    }

    /// Place of k from the highest.
    fn k_index(&self, k: f64) -> Option<usize> {
        self.ks.iter().rev().position(|shown| shown.to_bits() == k.to_bits())
    }

    /// Of the contact law, or of k where there is only one law.
    pub(super) fn colour(&self, contact: Contact, k: f64) -> Colour {
        let index = if self.contacts.len() > 1 {
            self.contacts.iter().position(|c| *c == contact)
        } else {
            self.k_index(k)
        };
        COLOURS[index.unwrap_or(0) % COLOURS.len()]
    }

    /// Of k where several contact laws take the colours: the highest is solid.
    pub(super) fn dash(&self, k: f64) -> Dash {
        if self.contacts.len() < 2 {
            return Dash::Solid;
        }
        match self.k_index(k) {
            Some(1) => Dash::Dashed,
            Some(2) => Dash::Dotted,
            _ => Dash::Solid,
        }
    }

    /// A sentence on the cases that are not drawn, or nothing.
    pub(super) fn left_out(&self) -> String {
        if !self.left_out {
            return String::new();
        }
        let contacts: Vec<String> = self.contacts.iter().map(|c| contact_words(*c)).collect();
        let ks: Vec<String> = self.ks.iter().map(|k| plain(*k, 3)).collect();
        format!(" Of all cases asked for only {} with k = {} are drawn.", contacts.join(", "), ks.join(", "))
    }
}

/// At most `most` of the values, the first and the last among them, the others spread between.
pub(super) fn spread(values: &[f64], most: usize) -> Vec<f64> {
    if values.len() <= most {
        return values.to_vec();
    }
    let last = values.len() - 1;
    (0..most).map(|i| values[(i * last + (most - 1) / 2) / (most - 1)]).collect()
}

/// "Thin rod, l = 5.512 m", and of the body its section; without the length where that is swept.
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
    PanelAxis::new("drop angle, °").over(ends.filter(|(from, to)| from < to))
}

/// An empty panel over the angles of the study, the angle asked for marked.
pub(super) fn angle_panel(request: &StudyRequest, title: String, y_label: &str) -> Panel {
    let at = request.angle_deg;
    Panel {
        title,
        x: angle_axis(request),
        y: PanelAxis::new(y_label),
        height: 400,
        marks: vec![Mark { at, label: format!("{}°", plain(at, 4)) }],
        ..Panel::default()
    }
}

/// The borders of cells around `centres`: half way between them, the outer ones on the outer centres.
pub(super) fn edges(centres: &[f64]) -> Vec<f64> {
    let inner = centres.windows(2).map(|w| f64::midpoint(w[0], w[1]));
    centres.first().copied().into_iter().chain(inner).chain(centres.last().copied()).collect()
}

/// What the pale parts of lines are.
pub(super) const PALE: &str = " Pale: the cask turns over (a somersault) before the second end strikes.";

/// A line without the points at which the cask turns over, and these as a pale one without a name.
pub(super) fn apart(line: Curve, turns_over: &[bool]) -> Vec<Curve> {
    let only = |wanted: bool| {
        let of =
            |(point, over): (&(f64, f64), &bool)| (point.0, if *over == wanted { point.1 } else { f64::NAN });
        line.points.iter().zip(turns_over).map(of).collect()
    };
    let pale = turns_over.contains(&true).then(|| Curve {
        label: None,
        opacity: 0.3,
        points: only(true),
        ..line.clone()
    });
    let points = only(false);
    std::iter::once(Curve { points, ..line }).chain(pale).collect()
}

/// The sentence on pale lines, where there are any.
pub(super) fn pale_sentence(panels: &[Panel]) -> &'static str {
    let any =
        panels.iter().flat_map(|panel| &panel.lines).any(|line| line.label.is_none() && line.opacity < 1.0);
    if any { PALE } else { "" }
}

/// From 0 to a little above the largest value that is drawn.
pub(super) fn from_zero(panel: &Panel) -> Option<(f64, f64)> {
    let largest = panel
        .lines
        .iter()
        .flat_map(|line| &line.points)
        .filter(|p| panel.drawable(**p))
        .map(|p| p.1)
        .fold(0.0, f64::max);
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
        assert_eq!(spread(&values, 5), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(spread(&values[..2], 5), [0.0, 0.01]);
        assert_eq!(spread(&values[..6], 5), [0.0, 0.01, 0.03, 0.04, 0.05]);
    }

    #[test]
    fn every_case_shown_looks_different() {
        let contacts = [Contact::Rough, Contact::Smooth, Contact::Coulomb(0.3), Contact::Coulomb(0.5)];
        let look = Look::of(&contacts, &[1.0, 0.0, 0.5, 0.25]);
        assert_eq!(look.ks, [0.0, 0.5, 1.0]);
        assert!(!look.shows(Contact::Coulomb(0.5), 1.0) && !look.shows(Contact::Rough, 0.25));
        assert!(look.left_out().contains("rough, smooth, μ 0.3 with k = 0, 0.5, 1"));
        let mut seen = Vec::new();
        for contact in look.contacts.clone() {
            for k in look.ks.clone() {
                let way = (look.colour(contact, k), look.dash(k));
                assert!(!seen.contains(&way), "{contact} {k}");
                seen.push(way);
            }
        }
        assert_eq!(Look::of(&contacts[..1], &[0.0, 0.5]).left_out(), "");
    }
}
