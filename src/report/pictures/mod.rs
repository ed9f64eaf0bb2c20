//! Pictures of an analysis and charts of a study, as SVG text.

mod angle_curves;
mod axes;
mod comparison;
mod critical;
mod curves;
pub(crate) mod draw;
mod legend;
mod live;
mod look;
mod monte_carlo;
pub(crate) mod panel;
mod positions;
mod recorded;
mod setup;
mod svg;
mod sweep;

pub(super) use recorded::recorded;
pub(super) use setup::picture as of_setup;

use super::rounding::plain;
use super::text::dedup;
use crate::data::{Analysis, CaskFile, Contact, Study, StudyRequest};
use draw::Picture;
use look::MOST_CONTACTS;
use rayon::prelude::*;

/// The drawing of the set-up, SVG.
pub fn setup_picture(file: &CaskFile) -> String {
    setup::picture(file).svg
}

/// Pictures of set-up, curves of both impacts, velocities, motion, spectra and comparison; an empty picture
/// says so.
pub(super) fn draw(analysis: &Analysis) -> Vec<Picture> {
    let all: [fn(&Analysis) -> Picture; 9] = [
        |analysis| setup::picture(&analysis.cask_file),
        curves::accelerations,
        curves::impacts,
        curves::crush,
        curves::velocities,
        curves::fit,
        curves::motion,
        curves::spectra,
        comparison::picture,
    ];
    let others = (!analysis.result.other_channels.is_empty()).then_some(curves::others as fn(&_) -> _);
    all.par_iter().chain(&others).map(|picture| picture(analysis)).collect()
}

/// A study and a picture's name to the picture.
type Draw = Box<dyn Fn(&Study, &str) -> Picture + Send + Sync>;

/// One chart by its name, and the function that draws it.
type StudyChart = (String, Draw);

/// The charts of a request, in the order in which a reader meets them.
fn charts(request: &StudyRequest) -> Vec<StudyChart> {
    let chart = |name: &str, draw: fn(&Study, &str) -> Picture| (name.to_owned(), Box::new(draw) as Draw);
    let shown = dedup(request.contacts.iter().copied());
    let is_pair = shown.len() == 2 && shown.contains(&Contact::Smooth) && shown.contains(&Contact::Rough);
    let mut charts = vec![chart(if is_pair { "smooth-rough" } else { "speeds" }, angle_curves::speeds)];
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
pub(super) fn study_names(request: &StudyRequest) -> Vec<String> {
    charts(request).into_iter().map(|(name, _)| name).collect()
}

/// Every picture of a study; an empty picture says so.
pub(super) fn draw_study(study: &Study) -> Vec<Picture> {
    charts(&study.request).into_par_iter().map(|(name, draw)| draw(study, &name)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::super::sample_study;
    use super::*;

    #[test]
    fn pictures_are_small_and_self_contained() {
        for picture in draw(&sample::analysis()) {
            assert!(picture.svg.starts_with("<svg ") && picture.svg.trim_end().ends_with("</svg>"));
            assert!(picture.svg.len() < 600_000, "{}: {} bytes", picture.name, picture.svg.len());
            assert!(!picture.svg.contains("href"), "{} points elsewhere", picture.name);
            assert!(!picture.svg.contains("NaN"), "{}", picture.name);
        }
    }

    #[test]
    fn a_name_cannot_leave_its_text() {
        let mut analysis = sample::analysis();
        let name = "<script>alert(1)</script>\u{1}\u{ffff}";
        analysis.curves.channels[0].channel = name.into();
        analysis.result.channels[0].name = name.into();
        let svg: String = draw(&analysis).into_iter().map(|p| p.svg).collect();
        assert!(!svg.contains("<script") && !svg.contains(['\u{1}', '\u{ffff}']));
        assert!(svg.contains("&lt;script&gt;"));
    }

    #[test]
    fn holes_in_a_curve_are_left_open() {
        let mut analysis = sample::analysis();
        for i in 500..600 {
            analysis.curves.channels[0].raw_m_s2[i] = f64::NAN;
        }
        analysis.curves.channels[1].velocity_m_s.fill(f64::NAN);
        let pictures = draw(&analysis);
        assert!(!pictures[1].svg.contains("-2147483648") && !pictures[2].svg.contains("-2147483648"));
    }

    #[test]
    fn nothing_is_said_to_be_nothing() {
        let pictures = draw(&sample::without_anything());
        assert!(pictures[1..].iter().all(|p| p.svg.contains("nothing to show")));
    }

    #[test]
    fn the_names_tell_the_contact_laws() {
        let mut request = sample_study::study().request;
        assert_eq!(
            study_names(&request),
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
        request.sweeps = sample_study::sweep_study().request.sweeps;
        let names = study_names(&request);
        assert_eq!(names[..3], ["speeds", "components-friction-0.3", "components-rough"]);
        assert_eq!(names.last().map(String::as_str), Some("sweep"));
    }

    #[test]
    fn charts_are_small_and_self_contained() {
        for study in [sample_study::study(), sample_study::sweep_study()] {
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
        // Smooth, k = 1, of the rod: a solid line.
        study.curves[3].speed_m_s[60..70].fill(f64::NAN);
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
        let pictures = draw_study(&sample_study::sweep_study());
        for picture in pictures.iter().filter(|p| !["section", "monte-carlo"].contains(&p.name.as_str())) {
            let words = format!("{}{}{}", picture.title, picture.svg, picture.caption);
            assert!(words.contains("μ 0.3"), "{}", picture.name);
            assert!(!words.contains("rough") && !words.contains("k = 1"), "{}", picture.name);
        }
    }
}
