//! Accelerations (Fig. 12), velocities (Fig. 13), motion and spectra to panels.

use super::super::grid::{STANDARD_GRAVITY_M_S2, named_events};
use super::super::spectrum;
use super::super::text::json_word;
use super::draw::{Picture, Plate};
use super::panel::{COLOURS, Colour, Curve, Dash, Mark, Panel, PanelAxis};
use crate::data::{Analysis, Axis, ChannelCurve, End};

const TIME_LABEL: &str = "time from the recording's first sample, ms";

/// The deceleration of both ends, unfiltered and filtered.
pub(super) fn accelerations(analysis: &Analysis) -> Picture {
    let panels: Vec<Panel> = [(End::First, "First end"), (End::Second, "Second end")]
        .into_iter()
        .map(|(end, title)| {
            let mut lines = Vec::new();
            for EndCurve { curve, colour, axis } in curves_of(analysis, end) {
                let in_g = |values: &[f64]| points(&curve.time_s, values, 1.0 / STANDARD_GRAVITY_M_S2);
                let raw =
                    Curve::new(colour, in_g(&curve.raw_m_s2)).named(format!("{} unfiltered", curve.channel));
                let (dash, note) = axis_look(axis);
                let label = format!("{} filtered{note}", curve.channel);
                lines.push(Curve { opacity: 0.32, stroke: 2, ..raw });
                lines.push(Curve::new(colour, in_g(&curve.filtered_m_s2)).named(label).broken(dash));
            }
            panel(analysis, title, "deceleration, g", lines)
        })
        .collect();
    let filter = analysis
        .result
        .settings
        .iter()
        .find(|setting| setting.name.starts_with("low-pass"))
        .map_or_else(String::new, |setting| format!(" Filter: {}.", setting.value));
    let caption = format!(
        "As Fig. 12 of the paper: specific force at both ends over time, offset removed: unfiltered (faint) and filtered (bold), 1 g = 9.80665 m/s². \
         A decelerating end reads positive on its transverse axis.{filter}"
    );
    Plate::new("accelerations", "Deceleration of both ends", caption).live().picture(&panels)
}

/// What both contacts show, each in a panel of its own.
pub(super) fn impacts(analysis: &Analysis) -> Picture {
    let events = &analysis.result.events;
    let impact = |title: &str, from: Option<f64>, to: Option<f64>| {
        let lines = from.map_or_else(Vec::new, |from| {
            let to = to.unwrap_or(from + LONGEST_S) + BESIDE_S;
            let shown = |curve: &ChannelCurve| {
                let at = |t: f64| curve.time_s.partition_point(|s| *s < t);
                at(from - BESIDE_S)..at(to)
            };
            let of = |(i, curve): (usize, &ChannelCurve)| {
                let part = shown(curve);
                let line = |values: &[f64], what: &str| {
                    let points = points(
                        &curve.time_s[part.clone()],
                        &values[part.clone()],
                        1.0 / STANDARD_GRAVITY_M_S2,
                    );
                    Curve::new(COLOURS[i % COLOURS.len()], points).named(format!("{} {what}", curve.channel))
                };
                let raw = line(&curve.raw_m_s2, "unfiltered");
                [Curve { opacity: 0.4, stroke: 2, ..raw }, line(&curve.filtered_m_s2, "filtered")]
            };
            analysis.curves.channels.iter().enumerate().flat_map(of).collect()
        });
        panel(analysis, title, "deceleration, g", lines)
    };
    let panels = [
        impact("First impact", events.first_contact_s(), events.separation_s()),
        impact("Second impact", events.slap_down_s(), None),
    ];
    let caption =
        "Specific force of every channel about both impacts, unfiltered (faint) and filtered (bold)."
            .to_owned();
    Plate::new("impacts", "Both impacts", caption).live().picture(&panels)
}

/// Beside an impact so much is shown, s, and of one whose end nothing tells.
const BESIDE_S: f64 = 3e-3;
const LONGEST_S: f64 = 0.02;

/// The velocity of both ends, from the sensors and as the rigid body moves.
pub(super) fn velocities(analysis: &Analysis) -> Picture {
    let mut sensors = Vec::new();
    for end in [End::First, End::Second] {
        for EndCurve { curve, colour, axis } in curves_of(analysis, end) {
            let (dash, note) = axis_look(axis);
            let label = format!("{} ({} end{note})", curve.channel, json_word(end));
            let points = points(&curve.time_s, &curve.velocity_m_s, 1.0);
            sensors.push(Curve::new(colour, points).named(label).broken(dash));
        }
    }
    let mut panels = vec![panel(analysis, "Along the sensors", "velocity, m/s", sensors)];
    if let Some(motion) = &analysis.curves.motion {
        let line = |label: &str, colour: usize, dash, values: &[f64]| {
            Curve::new(COLOURS[colour], points(&motion.time_s, values, 1.0)).named(label).broken(dash)
        };
        let lines = vec![
            line("first end, vertical", 0, Dash::Solid, &motion.first_end_vertical_m_s),
            line("second end, vertical", 1, Dash::Solid, &motion.second_end_vertical_m_s),
            line("second end, horizontal", 1, Dash::Dashed, &motion.second_end_horizontal_m_s),
        ];
        panels.push(panel(analysis, "Of the rigid body", "velocity, m/s", lines));
    }
    let caption = "As Fig. 13 of the paper: velocity over time. Above: each sensor's unfiltered signal integrated along its axis, gravity left out between \
                   the contacts. Below: the ends of the rigid body that all channels share, up positive."
        .to_owned();
    Plate::new("velocities", "Velocity of both ends", caption).live().picture(&panels)
}

/// Heights of both ends and the inclination.
pub(super) fn motion(analysis: &Analysis) -> Picture {
    let mut panels = Vec::new();
    if let Some(motion) = &analysis.curves.motion {
        let line = |colour: usize, values: &[f64], factor: f64| {
            Curve::new(COLOURS[colour], points(&motion.time_s, values, factor))
        };
        let heights = vec![
            line(0, &motion.first_end_height_m, 1.0).named("first end"),
            line(1, &motion.second_end_height_m, 1.0).named("second end"),
        ];
        panels.push(panel(analysis, "Height above the target", "height, m", heights));
        let angle = vec![line(2, &motion.angle_rad, 180.0 / std::f64::consts::PI)];
        panels.push(panel(analysis, "Inclination of the axis", "angle, °", angle));
    }
    let caption = "The rigid body's motion from just before first contact to the slap-down: height of the corner of each end that \
                   touches the target, and inclination of the axis above the horizontal."
        .to_owned();
    Plate::new("motion", "Motion of the cask", caption).live().picture(&panels)
}

/// The amplitude spectra of all channels up to half the sample rate.
pub(super) fn spectra(analysis: &Analysis) -> Picture {
    let line = |(i, curve): (usize, &ChannelCurve)| {
        let (frequency_hz, magnitude_m_s) = spectrum(curve);
        let points = frequency_hz.into_iter().zip(magnitude_m_s).collect();
        Curve {
            opacity: 0.9,
            stroke: 3,
            ..Curve::new(COLOURS[i % COLOURS.len()], points).named(&curve.channel[..])
        }
    };
    let lines = analysis.curves.channels.iter().enumerate().map(line).collect();
    let modes = analysis.result.flight.as_ref().map_or(&[][..], |flight| &flight.modes[..]);
    let panel = Panel {
        title: "Amplitude spectrum".into(),
        x: PanelAxis::new("frequency, Hz").logarithmic(),
        y: PanelAxis::new("magnitude, m/s").logarithmic(),
        height: 560,
        lines,
        marks: modes
            .iter()
            .filter(|mode| mode.frequency_hz.is_finite() && mode.frequency_hz > 0.0)
            .map(|mode| Mark { at: mode.frequency_hz, label: format!("mode {:.0} Hz", mode.frequency_hz) })
            .collect(),
        ..Panel::default()
    };
    let caption = "One-sided amplitude spectrum of the unfiltered specific force over the event window, up to half the sample rate; \
                   both axes logarithmic. Marked: the bending modes that the fit of the flight took."
        .to_owned();
    Plate::new("spectra", "Spectra", caption).picture(&[panel])
}

/// Values over the time that results and files count, from the recording's first sample, in ms.
pub(super) fn points(time_s: &[f64], values: &[f64], factor: f64) -> Vec<(f64, f64)> {
    time_s.iter().zip(values).map(|(t, v)| (t * 1e3, v * factor)).collect()
}

/// Lines over that time, with the events that they reach.
pub(super) fn panel(analysis: &Analysis, title: &str, y_label: &str, lines: Vec<Curve>) -> Panel {
    let ends = ends(&lines);
    let marks = named_events(&analysis.result.events)
        .into_iter()
        .filter_map(|(label, at)| {
            let at = at.filter(|t| t.is_finite())? * 1e3;
            // An event a hair beyond the curve, as the slap-down that ends the motion, is marked at its end.
            let (from, to) = ends?;
            let slack = 0.01 * (to - from);
            let shown = (from - slack..=to + slack).contains(&at);
            let at = at.clamp(from, to);
            shown.then(|| Mark { at, label: label.into() })
        })
        .collect();
    Panel {
        title: title.to_owned(),
        x: PanelAxis::new(TIME_LABEL).over(ends),
        y: PanelAxis::new(y_label),
        height: 350,
        lines,
        marks,
        ..Panel::default()
    }
}

/// First and last time over all lines.
fn ends(lines: &[Curve]) -> Option<(f64, f64)> {
    let times = || {
        lines.iter().flat_map(|line| line.points.first().into_iter().chain(line.points.last())).map(|p| p.0)
    };
    let from = times().min_by(f64::total_cmp)?;
    let to = times().max_by(f64::total_cmp)?;
    (from <= to).then_some((from, to))
}

/// The curve of a channel with its colour, which is the same in every picture.
struct EndCurve<'a> {
    curve: &'a ChannelCurve,
    colour: Colour,
    axis: Axis,
}

/// The curves of one end.
fn curves_of(analysis: &Analysis, end: End) -> impl Iterator<Item = EndCurve<'_>> {
    analysis.curves.channels.iter().enumerate().filter_map(move |(i, curve)| {
        let summary = analysis.result.channels.iter().find(|c| c.name == curve.channel)?;
        let colour = COLOURS[i % COLOURS.len()];
        (summary.end == end).then_some(EndCurve { curve, colour, axis: summary.axis })
    })
}

/// How a channel's line is broken, and what its name is followed by: an axial one stands out.
fn axis_look(axis: Axis) -> (Dash, &'static str) {
    match axis {
        Axis::Transverse => (Dash::Solid, ""),
        Axis::Axial => (Dash::Dashed, ", axial"),
    }
}
