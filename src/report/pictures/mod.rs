//! An analysis to its pictures, a study to its charts, as SVG text.

mod angle_curves;
mod axes;
mod comparison;
mod critical;
mod curves;
mod decimate;
pub(crate) mod draw;
mod fit;
mod legend;
mod live;
mod look;
mod monte_carlo;
mod others;
pub(crate) mod panel;
mod positions;
mod recorded;
mod setup;
mod study;
mod svg;
mod sweep;

pub(super) use recorded::recorded;
pub(super) use setup::picture as of_setup;
pub(super) use study::{draw_study, names as study_names};

use crate::data::{Analysis, CaskFile};
use draw::Picture;
use rayon::prelude::*;

/// The drawing of the set-up, SVG.
pub fn setup_picture(file: &CaskFile) -> String {
    setup::picture(file).svg
}

/// Set-up, curves of both impacts, velocities, motion, spectra and comparison; one that has nothing to show
/// says so.
pub(super) fn draw(analysis: &Analysis) -> Vec<Picture> {
    let all: [fn(&Analysis) -> Picture; 9] = [
        |analysis| setup::picture(&analysis.cask_file),
        curves::accelerations,
        curves::impacts,
        curves::crush,
        curves::velocities,
        fit::picture,
        curves::motion,
        curves::spectra,
        comparison::picture,
    ];
    let others = (!analysis.result.other_channels.is_empty()).then_some(others::picture as fn(&_) -> _);
    all.par_iter().chain(&others).map(|picture| picture(analysis)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample;
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
}
