//! The flight fit that decides to its picture: what was measured, plateaus with their modes, and what they
//! leave.

use super::super::grid::Grid;
use super::curves::{channel_lines, panel, points};
use super::draw::{Picture, Plate};
use super::panel::{Curve, Dash};
use crate::data::{Analysis, Axis, ChannelCurve, FlightFit, Mode};

/// Values of the fit over its window: four a period of 1 kHz in 100 ms.
const STEPS: u32 = 400;

/// Velocities around the window of the fit, the fit on them, and the difference.
pub(super) fn picture(analysis: &Analysis) -> Picture {
    let (mut lines, mut left) = (Vec::new(), Vec::new());
    for channel in channel_lines(analysis) {
        let curve = channel.curve;
        let Some(fit) = analysis.result.flight.as_ref().and_then(|fit| fitted(analysis, fit, curve)) else {
            continue;
        };
        let line = |values: &[f64]| Curve::new(channel.colour, points(&fit.time_s, values, 1.0));
        let named = |values: &[f64], what: &str| line(values).named(format!("{} {what}", curve.channel));
        lines.push(Curve { opacity: 0.45, stroke: 6, ..named(&fit.measured, "measured") });
        lines.push(Curve { stroke: 2, ..named(&fit.ringing, "fit") });
        lines.push(Curve { stroke: 2, ..named(&fit.plateau, "plateau").broken(Dash::Dashed) });
        let off: Vec<f64> = fit.measured.iter().zip(&fit.ringing).map(|(m, f)| m - f).collect();
        left.push(line(&off).named(&curve.channel[..]));
    }
    let panels = [
        panel(analysis, "Fit of the flight", "velocity, m/s", lines),
        panel(analysis, "What the fit leaves", "residual, m/s", left),
    ];
    let caption = "The window of the flight that k and speed rest on. Above: each velocity as measured, the \
                   plateau with its modes \
                   fitted to it, and the plateau alone (with its drift). Below: measured minus fitted.";
    Plate::new("fit", "Fit of the flight", caption).live().picture(&panels)
}

/// The fit of a channel on times of its window: what was measured, the plateau with its drift, and with the
/// modes.
struct FittedCurve {
    time_s: Vec<f64>,
    measured: Vec<f64>,
    plateau: Vec<f64>,
    ringing: Vec<f64>,
}

/// The fit (20) where the channel's curve begins: before first contact nothing had changed its velocity.
fn fitted(analysis: &Analysis, fit: &FlightFit, curve: &ChannelCurve) -> Option<FittedCurve> {
    let plateau = fit.plateau(&curve.channel)?;
    let contact_s = analysis.result.events.first_contact_s()?;
    let spec = analysis.cask_file.channels.iter().find(|spec| spec.name == curve.channel)?;
    let arm_m = match spec.axis {
        Axis::Transverse => spec.offset_m,
        Axis::Axial => spec.position_m - analysis.cask_file.cask.cog_m,
    };
    // f_η holds −Ω² η   (14), which the fit takes off.
    let turning = analysis.result.first_impact.angular_velocity.map_or(0.0, |w| w.value);
    let slope_m_s2 = plateau.zero_shift_m_s2 - turning * turning.abs() * arm_m;
    let grid = Grid::new(&curve.time_s)?;
    let velocity_m_s = |time_s: f64| grid.place(time_s)?.of(&curve.velocity_m_s);
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

/// So long before first contact the velocity is that of the fall, s.
const BEFORE_S: f64 = 5e-4;
