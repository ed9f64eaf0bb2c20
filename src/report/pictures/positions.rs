//! Drawings of the positions of a body from first contact to the slap-down, as in Figs. 2 and 3 of the paper.

use super::super::rounding::{fixed, plain};
use super::super::words::case_words;
use super::draw::{Figure, Picture};
use super::panel::{COLOURS, Curve, Dash, INK, WIDTH};
use super::svg::{Anchor, Svg};
use crate::data::{Body, BodyPath, Pose, Study};

/// Room around a drawing, its height at the most, and the room of its words, in units of the drawing.
const MARGIN: f64 = 60.0;
const HEIGHT: f64 = 420.0;
const WORDS: f64 = 50.0;

/// Body outlines at even times, one drawing a contact law and k.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let plate = |caption| Figure::new(name, "Positions of the cask", caption);
    let Some(first) = study.paths.first() else {
        let nothing =
            ("There is nothing to show.", "No case goes from one impact to the slap-down in one way.");
        return plate(String::new()).empty(nothing).picture(&[]);
    };
    let all = || study.paths.iter().flat_map(|p| &p.poses).flat_map(|pose| corners(&first.body, pose));
    let [left_m, right_m, top_m] = all().fold([0.0, 0.0, 0.0], |[left, right, top]: [f64; 3], (x, z)| {
        [left.min(x), right.max(x), top.max(z)]
    });
    let width = WIDTH / 2.0;
    let scale = ((width - 2.0 * MARGIN) / (right_m - left_m)).min(HEIGHT / top_m);
    let high = WORDS + scale * top_m + 2.0 * MARGIN;
    let mut svg = Svg::default();
    let mut at = (0.0, 0.0);
    for path in &study.paths {
        svg.from(at, |svg| {
            svg.word(&case_words(path.contact, path.k), (width / 2.0, WORDS / 2.0), Anchor::Middle);
            let place = |(x, z): (f64, f64)| (MARGIN + scale * (x - left_m), high - MARGIN - scale * z);
            draw(svg, path, &place);
        });
        at = if at.0 > 0.0 { (0.0, at.1 + high) } else { (width, at.1) };
    }
    let bottom = if at.0 > 0.0 { at.1 + high } else { at.1 };
    let case = |path: &BodyPath| {
        let time_s = path.poses.last().map_or(f64::NAN, |pose| pose.time_s);
        format!("{}: R strikes after {} ms", case_words(path.contact, path.k), fixed(time_s * 1e3, 1))
    };
    let cases: Vec<String> = study.paths.iter().map(case).collect();
    let cases = cases.join("; ");
    let caption = format!(
        "The {} at {}° from first contact (blue) to the slap-down (orange), as Figs. 2 and 3 of the paper; \
         dotted the way of S. {cases}.",
        first.body.model.as_str(),
        plain(study.request.angle_deg, 4)
    );
    plate(caption).into_picture(svg, bottom, &cases)
}

/// Draws one path: the outline at each pose, the target, the path of S.
fn draw(svg: &mut Svg, path: &BodyPath, place: &dyn Fn((f64, f64)) -> (f64, f64)) {
    let last = path.poses.len() - 1;
    for (i, pose) in path.poses.iter().enumerate() {
        let outline = corners(&path.body, pose).map(place);
        let points = [&outline[..], &outline[..1]].concat();
        let line = match i {
            0 => Curve::new(COLOURS[0], points),
            i if i == last => Curve::new(COLOURS[1], points),
            _ => Curve { stroke: 2, opacity: 0.5, ..Curve::new(INK, points) },
        };
        svg.line(&line);
    }
    let ground = path.poses.iter().flat_map(|pose| corners(&path.body, pose)).map(|(x, _)| x);
    let (from, to) = ground.fold((0.0_f64, 0.0_f64), |(from, to), x| (from.min(x), to.max(x)));
    svg.line(&Curve { stroke: 6, ..Curve::new(INK, vec![place((from, 0.0)), place((to, 0.0))]) });
    let centres: Vec<(f64, f64)> =
        path.poses.iter().map(|pose| place((pose.along_m, pose.height_m))).collect();
    svg.circle(centres[0], 6, INK, Some(3));
    svg.line(&Curve { stroke: 3, ..Curve::new(INK, centres).broken(Dash::Dotted) });
}

/// The corners of a body, from L's lower one on, along and above the target, m.
fn corners(body: &Body, pose: &Pose) -> [(f64, f64); 4] {
    let (sin, cos) = pose.angle_rad.sin_cos();
    let corner = |along_m: f64, across_m: f64| {
        (pose.along_m + along_m * cos - across_m * sin, pose.height_m + along_m * sin + across_m * cos)
    };
    let (first_m, second_m, half_m) = (-body.cog_m, body.length_m - body.cog_m, body.height_m / 2.0);
    [corner(first_m, -half_m), corner(second_m, -half_m), corner(second_m, half_m), corner(first_m, half_m)]
}
