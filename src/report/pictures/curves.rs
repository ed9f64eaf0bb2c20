//! Accelerations (Fig. 12), velocities (Fig. 13), the fit of the flight, motion, spectra and the channels
//! that take no part in it to panels.

use super::draw::{Figure, Picture};
use super::live::MOST_VALUES;
use super::panel::{self, COLOURS, Colour, Curve, Dash, Mark, Panel, PanelAxis};
use crate::data::{
    Analysis, Axis, ChannelCurve, End, FlightFit, ImpactTable, Mode, OtherCurve, STANDARD_GRAVITY_M_S2,
};
use crate::report::grid::{Grid, named_events};
use crate::report::spectrum;
use crate::report::text::json_word;
use std::ops::Range;

pub(super) const TIME_LABEL: &str = "time from the recording's first sample, ms";

/// Picture of the deceleration of both ends, unfiltered and filtered.
pub(super) fn accelerations(analysis: &Analysis) -> Picture {
    let panels = [(End::First, "First end"), (End::Second, "Second end")].map(|(end, title)| {
        let channels = channel_lines(analysis).filter(|line| line.end == end);
        let lines = channels.flat_map(|line| line.decelerations(0..line.curve.time_s.len()));
        let calculated = calculated_lines(analysis).filter(|line| line.end == end);
        let calculated = calculated.map(|line| line.calculated_deceleration(0..line.curve.time_s.len()));
        panel(analysis, title, "deceleration, g", lines.chain(calculated).collect())
    });
    let filter = analysis
        .result
        .settings
        .iter()
        .find(|setting| setting.name.starts_with("low-pass"))
        .map_or_else(String::new, |setting| format!(" Filter: {}; {}.", setting.value, setting.origin));
    let caption = format!(
        "As Fig. 12 of [P]: specific force at both ends over time, offset removed: unfiltered (faint) \
         and filtered (bold), 1 g = 9.80665 m/s². A decelerating end reads positive on its transverse \
         axis.{filter}"
    );
    Figure::new("accelerations", "Deceleration of both ends", caption).zoomable().picture(&panels)
}

/// Time shown beside an impact, s, and after an impact without a known end.
const BESIDE_S: f64 = 3e-3;
const LONGEST_S: f64 = 0.02;

/// Picture of both contacts, each in a separate panel.
pub(super) fn impacts(analysis: &Analysis) -> Picture {
    let events = &analysis.result.events;
    let impact = |title: &str, from: Option<f64>, to: Option<f64>| {
        let lines = from.map_or_else(Vec::new, |from| {
            let to = to.unwrap_or(from + LONGEST_S);
            let shown = |line: &ChannelLine| {
                let at = |time_s: f64| line.curve.time_s.partition_point(|s| *s < time_s);
                at(from - BESIDE_S)..at(to + BESIDE_S)
            };
            let lines = channel_lines(analysis).flat_map(|line| line.decelerations(shown(&line)));
            let calculated = calculated_lines(analysis);
            lines.chain(calculated.map(|line| line.calculated_deceleration(shown(&line)))).collect()
        });
        panel(analysis, title, "deceleration, g", lines)
    };
    let panels = [
        impact("First impact", events.first_contact_s(), events.separation_s()),
        impact("Second impact", events.slap_down_s(), None),
    ];
    let caption =
        "Specific force of every channel about both impacts, unfiltered (faint) and filtered (bold).";
    // They are part of the accelerations if these are not thinned.
    let count: usize = channel_lines(analysis).map(|line| 2 * line.curve.time_s.len()).sum();
    let count = count + calculated_lines(analysis).map(|line| line.curve.time_s.len()).sum::<usize>();
    let lines_of = if count > MOST_VALUES { "" } else { "accelerations" };
    Figure::new("impacts", "Both impacts", caption).zoomable_with(lines_of).picture(&panels)
}

/// Picture of the force over crush of either end during its contact, as far as the recording goes.
pub(super) fn crush(analysis: &Analysis) -> Picture {
    let line = |impact: &ImpactTable| {
        let curve = &impact.force_over_crush;
        let (colour, name) = match impact.end {
            End::First => (COLOURS[0], "first end"),
            End::Second => (COLOURS[1], "second end"),
        };
        Curve::new(colour, panel::points(&curve.crush_m, &curve.force_n, [1e3, 1e-6])).label(name)
    };
    let lines = analysis.result.impacts.iter().map(line).filter(|line| !line.points.is_empty()).collect();
    let axes = Panel::new("Force over crush", "crush of the corner, mm", "vertical force, MN", 350);
    let filter = &analysis.result.impacts[0].rigid_body_deceleration.filter;
    let caption = format!(
        "Vertical force of the target, the stated mass times the acceleration of the centre of gravity \
         through the low-pass {filter}, over how far the corner of the undeformed cask is below where it \
         touched. The area within is about the energy that the contact absorbs."
    );
    Figure::new("crush", "Force over crush", caption).picture(&[Panel { lines, ..axes }])
}

/// Picture of the velocity of both ends, from the sensors and from the rigid body.
pub(super) fn velocities(analysis: &Analysis) -> Picture {
    let mut channels: Vec<ChannelLine> = channel_lines(analysis).collect();
    channels.sort_by_key(|line| line.end == End::Second);
    let sensor = |line: ChannelLine| {
        let ChannelLine { curve, colour, end, .. } = line;
        let (dash, note) = line.line_look();
        let points = points(&curve.time_s, &curve.velocity_m_s, 1.0);
        Curve::new(colour, points)
            .label(format!("{} ({} end{note})", curve.channel, json_word(end)))
            .broken(dash)
    };
    let calculated =
        |line: ChannelLine| line.calculation(0..line.curve.time_s.len(), |c| &c.velocity_m_s, 1.0);
    let calculated = calculated_lines(analysis).map(calculated);
    let sensors = channels.into_iter().map(sensor).chain(calculated).collect();
    let mut panels = vec![panel(analysis, "Along the sensors", "velocity, m/s", sensors)];
    if let Some(motion) = &analysis.curves.motion {
        let line = |label: &str, colour: usize, dash, values: &[f64]| {
            Curve::new(COLOURS[colour], points(&motion.time_s, values, 1.0)).label(label).broken(dash)
        };
        let lines = vec![
            line("first end, vertical", 0, Dash::Solid, &motion.first_end_vertical_m_s),
            line("second end, vertical", 1, Dash::Solid, &motion.second_end_vertical_m_s),
            line("second end, horizontal", 1, Dash::Dashed, &motion.second_end_horizontal_m_s),
        ];
        panels.push(panel(analysis, "Of the rigid body", "velocity, m/s", lines));
    }
    let caption = "As Fig. 13 of [P]: velocity over time. Above: each sensor's unfiltered signal \
                   integrated along its axis, gravity left out between the contacts. Below: the ends of the \
                   rigid body that all channels share, up positive.";
    Figure::new("velocities", "Velocity of both ends", caption).zoomable().picture(&panels)
}

/// Heights of both ends and the inclination.
pub(super) fn motion(analysis: &Analysis) -> Picture {
    let mut panels = Vec::new();
    if let Some(motion) = &analysis.curves.motion {
        let line = |colour: usize, values: &[f64], factor: f64| {
            Curve::new(COLOURS[colour], points(&motion.time_s, values, factor))
        };
        let heights = vec![
            line(0, &motion.first_end_height_m, 1.0).label("first end"),
            line(1, &motion.second_end_height_m, 1.0).label("second end"),
        ];
        panels.push(panel(analysis, "Height above the target", "height, m", heights));
        let angle = vec![line(2, &motion.angle_rad, 180.0 / std::f64::consts::PI)];
        panels.push(panel(analysis, "Inclination of the axis", "angle, °", angle));
    }
    let caption = "The rigid body's motion from just before first contact to the slap-down: height of the \
                   corner of each end that touches the target, and inclination of the axis above the \
                   horizontal.";
    Figure::new("motion", "Motion of the cask", caption).zoomable().picture(&panels)
}

/// The amplitude spectra of all channels up to half the sample rate.
pub(super) fn spectra(analysis: &Analysis) -> Picture {
    let line = |line: ChannelLine| {
        let (frequency_hz, magnitude_m_s) = spectrum(line.curve);
        let points = panel::points(&frequency_hz, &magnitude_m_s, [1.0, 1.0]);
        Curve { opacity: 0.9, stroke: 3, ..Curve::new(line.colour, points).label(&line.curve.channel[..]) }
    };
    let lines = channel_lines(analysis).map(line).collect();
    let modes = analysis.result.flight.as_ref().map_or(&[][..], |flight| &flight.modes[..]);
    let mark =
        |mode: &Mode| Mark { at: mode.frequency_hz, label: format!("mode {:.0} Hz", mode.frequency_hz) };
    let is_drawn = |mode: &&Mode| mode.frequency_hz.is_finite() && mode.frequency_hz > 0.0;
    let [x, y] = ["frequency, Hz", "magnitude, m/s"].map(|label| PanelAxis::new(label).logarithmic());
    let panel = Panel {
        lines,
        marks: modes.iter().filter(is_drawn).map(mark).collect(),
        ..Panel::new("Amplitude spectrum", x, y, 560)
    };
    let caption = "One-sided amplitude spectrum of the unfiltered specific force over the event window, up \
                   to half the sample rate; both axes logarithmic. Marked: the bending modes that the fit of \
                   the flight took.";
    Figure::new("spectra", "Spectra", caption).picture(&[panel])
}

/// Values over time from the recording's first sample, as results and files count it, in ms.
pub(super) fn points(time_s: &[f64], values: &[f64], factor: f64) -> Vec<(f64, f64)> {
    panel::points(time_s, values, [1e3, factor])
}

/// A panel of lines over that time, with the events within it.
pub(super) fn panel(analysis: &Analysis, title: &str, y_label: &str, lines: Vec<Curve>) -> Panel {
    let mut panel = Panel { lines, ..Panel::new(title, TIME_LABEL, y_label, 350) };
    let Range { start, end } = panel.x_range();
    // An event slightly beyond the curve, such as the slap-down that ends the motion, is marked at its end.
    let slack = 0.01 * (end - start);
    let reached = |(label, time_s): (&str, Option<f64>)| {
        let at = time_s? * 1e3;
        let is_reached = (start - slack..=end + slack).contains(&at);
        is_reached.then(|| Mark { at: at.clamp(start, end), label: label.into() })
    };
    panel.marks = named_events(&analysis.result.events).into_iter().filter_map(reached).collect();
    panel.x.range = (start <= end).then_some((start, end));
    panel
}

/// A channel's curve with its colour, end and axis, the same in every picture.
pub(super) struct ChannelLine<'a> {
    pub(super) curve: &'a ChannelCurve,
    pub(super) colour: Colour,
    end: End,
    axis: Axis,
}

/// The curves of all channels.
pub(super) fn channel_lines(analysis: &Analysis) -> impl Iterator<Item = ChannelLine<'_>> {
    analysis.curves.channels.iter().enumerate().filter_map(|(i, curve)| {
        let summary = analysis.result.channels.iter().find(|c| c.name == curve.channel)?;
        Some(ChannelLine { curve, colour: COLOURS[i % COLOURS.len()], end: summary.end, axis: summary.axis })
    })
}

/// The calculated curves, in the colours of the measured ones.
fn calculated_lines(analysis: &Analysis) -> impl Iterator<Item = ChannelLine<'_>> {
    analysis.curves.calculated.iter().filter_map(|curve| {
        let measured = channel_lines(analysis).find(|line| line.curve.channel == curve.channel)?;
        Some(ChannelLine { curve, ..measured })
    })
}

impl ChannelLine<'_> {
    /// A calculated curve over these samples, dotted.
    fn calculation(&self, samples: Range<usize>, of: fn(&ChannelCurve) -> &Vec<f64>, factor: f64) -> Curve {
        let (time_s, values) = (&self.curve.time_s[samples.clone()], &of(self.curve)[samples]);
        let line = Curve::new(self.colour, points(time_s, values, factor));
        line.label(format!("{} calculated", self.curve.channel)).broken(Dash::Dotted)
    }

    fn calculated_deceleration(&self, samples: Range<usize>) -> Curve {
        self.calculation(samples, |curve| &curve.filtered_m_s2, 1.0 / STANDARD_GRAVITY_M_S2)
    }

    /// Dash of its line, and the suffix of its name: an axial channel stands out.
    fn line_look(&self) -> (Dash, &'static str) {
        match self.axis {
            Axis::Transverse => (Dash::Solid, ""),
            Axis::Axial => (Dash::Dashed, ", axial"),
        }
    }

    /// The deceleration over these samples, unfiltered and faint, and filtered.
    fn decelerations(&self, samples: Range<usize>) -> [Curve; 2] {
        let (curve, (dash, note)) = (self.curve, self.line_look());
        let line = |values: &[f64], label: String| {
            let (time_s, values) = (&curve.time_s[samples.clone()], &values[samples.clone()]);
            Curve::new(self.colour, points(time_s, values, 1.0 / STANDARD_GRAVITY_M_S2)).label(label)
        };
        let raw = line(&curve.raw_m_s2, format!("{} unfiltered", curve.channel));
        let filtered = line(&curve.filtered_m_s2, format!("{} filtered{note}", curve.channel));
        [Curve { opacity: 0.32, stroke: 2, ..raw }, filtered.broken(dash)]
    }
}

/// Values of the fit over its window: four per period of 1 kHz in 100 ms.
const STEPS: u32 = 400;

/// Velocities around the window of the fit, the fit on them, and the difference.
pub(super) fn fit(analysis: &Analysis) -> Picture {
    let (mut lines, mut left) = (Vec::new(), Vec::new());
    for channel in channel_lines(analysis) {
        let curve = channel.curve;
        let Some(fit) = analysis.result.flight.as_ref().and_then(|fit| fitted_curve(analysis, fit, curve))
        else {
            continue;
        };
        let line = |values: &[f64]| Curve::new(channel.colour, points(&fit.time_s, values, 1.0));
        let named = |values: &[f64], what: &str| line(values).label(format!("{} {what}", curve.channel));
        lines.push(Curve { opacity: 0.45, stroke: 6, ..named(&fit.measured, "measured") });
        lines.push(Curve { stroke: 2, ..named(&fit.ringing, "fit") });
        lines.push(Curve { stroke: 2, ..named(&fit.plateau, "plateau").broken(Dash::Dashed) });
        let off: Vec<f64> = fit.measured.iter().zip(&fit.ringing).map(|(m, f)| m - f).collect();
        left.push(line(&off).label(&curve.channel[..]));
    }
    let panels = [
        panel(analysis, "Fit of the flight", "velocity, m/s", lines),
        panel(analysis, "What the fit leaves", "residual, m/s", left),
    ];
    let caption = "The window of the flight that k and speed rest on. Above: each velocity as measured, the \
                   plateau with its modes \
                   fitted to it, and the plateau alone (with its drift). Below: measured minus fitted.";
    Figure::new("fit", "Fit of the flight", caption).zoomable().picture(&panels)
}

/// The fit of a channel at times of its window: the measured values, the plateau with its drift, and the sum
/// with the modes.
struct FittedCurve {
    time_s: Vec<f64>,
    measured: Vec<f64>,
    plateau: Vec<f64>,
    ringing: Vec<f64>,
}

/// The fit (20), continued to where the channel's curve begins: before first contact nothing had changed its
/// velocity.
fn fitted_curve(analysis: &Analysis, fit: &FlightFit, curve: &ChannelCurve) -> Option<FittedCurve> {
    let plateau = fit.plateau(&curve.channel)?;
    let contact_s = analysis.result.events.first_contact_s()?;
    let spec = analysis.cask_file.channels.iter().find(|spec| spec.name == curve.channel)?;
    let arm_m = match spec.axis {
        Axis::Transverse => spec.offset_m,
        Axis::Axial => spec.position_m - analysis.cask_file.cask.cog_m,
    };
    // f_η holds −Ω² η   (14), which the fit subtracts.
    let turning = analysis.result.first_impact.angular_velocity.map_or(0.0, |w| w.value);
    let slope_m_s2 = plateau.zero_shift_m_s2 - turning * turning.abs() * arm_m;
    let grid = Grid::new(&curve.time_s)?;
    let velocity_m_s = |time_s: f64| grid.place(time_s)?.interpolate(&curve.velocity_m_s);
    let begin_m_s = velocity_m_s(contact_s - BEFORE_S)? + plateau.velocity_step_m_s;
    let time_s: Vec<f64> =
        (0..=STEPS).map(|i| fit.from_s + f64::from(i) / f64::from(STEPS) * (fit.to_s - fit.from_s)).collect();
    let straight = |t: &f64| begin_m_s + slope_m_s2 * (t - fit.from_s);
    let modes = |t: &f64| -> f64 {
        let mode = |(mode, (a, b)): (&Mode, &(f64, f64))| {
            let phase = std::f64::consts::TAU * mode.frequency_hz * (t - fit.from_s);
            (-mode.damping * phase).exp() * (a * phase.cos() + b * phase.sin())
        };
        fit.modes.iter().zip(&plateau.ringing_m_s).map(mode).sum()
    };
    let plateau = time_s.iter().map(straight).collect();
    let ringing = time_s.iter().map(|t| straight(t) + modes(t)).collect();
    let measured = time_s.iter().map(|t| velocity_m_s(*t).unwrap_or(f64::NAN)).collect();
    Some(FittedCurve { time_s, measured, plateau, ringing })
}

/// This long before first contact the velocity is that of the fall, s.
const BEFORE_S: f64 = 5e-4;

const CAPTION: &str = "As recorded, neither filtered nor with an offset removed: each channel over time, and \
                       its one-sided amplitude spectrum over the same time without the mean, up to half the \
                       sample rate.";

/// Picture of the curve and the spectrum of each, one below the other.
pub(super) fn others(analysis: &Analysis) -> Picture {
    let of_channel = |(i, curve): (usize, &OtherCurve)| {
        let line = |points| Curve::new(COLOURS[i % COLOURS.len()], points);
        let OtherCurve { channel, unit, .. } = curve;
        let over_time = vec![line(points(&curve.time_s, &curve.values, 1.0))];
        let spectrum = line(panel::points(&curve.frequency_hz, &curve.magnitude, [1.0, 1.0]));
        let magnitude = PanelAxis::new(format!("magnitude, {unit} s")).logarithmic();
        let frequency = PanelAxis::new("frequency, Hz").logarithmic();
        let spectrum = Panel {
            lines: vec![Curve { stroke: 3, ..spectrum }],
            ..Panel::new(format!("{channel}, spectrum"), frequency, magnitude, 300)
        };
        [panel(analysis, channel, unit, over_time), spectrum]
    };
    let panels: Vec<Panel> = analysis.curves.others.iter().enumerate().flat_map(of_channel).collect();
    Figure::new("other_channels", "Other channels", CAPTION).picture(&panels)
}
