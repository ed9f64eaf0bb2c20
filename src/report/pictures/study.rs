//! A study to its charts, and a request to their names.

use super::super::rounding::plain;
use super::super::text::distinct;
use super::draw::Picture;
use super::look::MOST_CONTACTS;
use super::{angle_curves, critical, monte_carlo, positions, sweep};
use crate::data::{Contact, Study, StudyRequest};
use rayon::prelude::*;

/// A study and a picture's name to the picture.
type Draw = Box<dyn Fn(&Study, &str) -> Picture + Send + Sync>;

/// One chart by its name, and what draws it.
type StudyChart = (String, Draw);

/// The charts of a request, in the order in which a reader meets them.
fn charts(request: &StudyRequest) -> Vec<StudyChart> {
    let chart = |name: &str, draw: fn(&Study, &str) -> Picture| (name.to_owned(), Box::new(draw) as Draw);
    let shown = distinct(request.contacts.iter().copied());
    let both = shown.len() == 2 && shown.contains(&Contact::Smooth) && shown.contains(&Contact::Rough);
    let mut charts = vec![chart(if both { "smooth-rough" } else { "speeds" }, angle_curves::speeds)];
    charts.extend(shown.into_iter().take(MOST_CONTACTS).map(|contact| {
        let draw = move |study: &Study, name: &str| angle_curves::components(study, contact, name);
        (components_name(contact), Box::new(draw) as Draw)
    }));
    charts.push(chart("positions", positions::picture));
    charts.push(chart("energy-ratio", angle_curves::energies));
    charts.push(chart("section", angle_curves::sections));
    charts.push(chart("critical-angles", critical::picture));
    charts.extend((request.uncertain.draws > 0).then(|| chart("monte-carlo", monte_carlo::picture)));
    charts.extend((!request.sweeps.is_empty()).then(|| chart("sweep", sweep::picture)));
    charts
}

/// "components-rough", "components-smooth" or "components-friction-0.3".
fn components_name(contact: Contact) -> String {
    match contact {
        Contact::Coulomb(coefficient) if coefficient == 0.0 || (1e-4..1e4).contains(&coefficient) => {
            format!("components-friction-{}", plain(coefficient, 4))
        }
        // The decimals of an extreme coefficient are longer than a file name may be.
        Contact::Coulomb(coefficient) => format!("components-friction-{coefficient:.3e}"),
        contact => format!("components-{contact}"),
    }
}

/// The names of the pictures, in their order.
pub(in super::super) fn names(request: &StudyRequest) -> Vec<String> {
    charts(request).into_iter().map(|(name, _)| name).collect()
}

/// Every picture of a study; one that has nothing to show says so.
pub(in super::super) fn draw_study(study: &Study) -> Vec<Picture> {
    charts(&study.request).into_par_iter().map(|(name, draw)| draw(study, &name)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::sample_study;
    use super::*;

    #[test]
    fn the_names_tell_the_contact_laws() {
        let mut request = sample_study::study().request;
        assert_eq!(
            names(&request),
            [
                "smooth-rough",
                "components-rough",
                "components-smooth",
                "positions",
                "energy-ratio",
                "section",
                "critical-angles",
                "monte-carlo"
            ]
        );
        request.contacts = vec![Contact::Coulomb(0.3), Contact::Coulomb(0.3), Contact::Rough];
        request.sweeps = sample_study::swept().request.sweeps;
        let names = names(&request);
        assert_eq!(names[..3], ["speeds", "components-friction-0.3", "components-rough"]);
        assert_eq!(names.last().map(String::as_str), Some("sweep"));
    }

    #[test]
    fn pictures_are_small_and_self_contained() {
        for study in [sample_study::study(), sample_study::swept()] {
            for picture in draw_study(&study) {
                let Picture { name, svg, .. } = &picture;
                assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{name}");
                assert!(svg.len() < 200_000, "{name}: {} bytes", svg.len());
                assert!(!svg.contains("href") && !svg.contains("NaN") && !svg.contains("2147483"), "{name}");
                assert!(svg.contains("</text>") && !svg.contains("nothing to show"), "{name}");
            }
        }
    }

    #[test]
    fn gaps_stay_gaps() {
        let mut study = sample_study::study();
        // Only whole lines are drawn as one element with many points; dashes have a few each.
        let solid = |study: &Study| {
            let svg = draw_study(study).swap_remove(0).svg;
            svg.split("<polyline").filter(|line| line.matches(',').count() > 40).count()
        };
        let whole = solid(&study);
        // Rough, k = 1, of the rod: a solid line.
        study.curves[1].speed_m_s[80..90].fill(f64::NAN);
        assert_eq!(solid(&study), whole + 1);
    }

    #[test]
    fn without_a_slap_down_pictures_say_so() {
        for picture in draw_study(&sample_study::without_slap_down()) {
            assert!(picture.svg.contains("nothing to show"), "{}", picture.name);
        }
    }

    #[test]
    fn other_cases_name_themselves() {
        let pictures = draw_study(&sample_study::swept());
        for picture in pictures.iter().filter(|p| !["section", "monte-carlo"].contains(&p.name.as_str())) {
            let words = format!("{}{}{}", picture.title, picture.svg, picture.caption);
            assert!(words.contains("μ 0.3"), "{}", picture.name);
            assert!(!words.contains("rough") && !words.contains("k = 1"), "{}", picture.name);
        }
    }
}
