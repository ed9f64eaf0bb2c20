//! Fits the free-flight window with plateaus, drift and as many damped modes as the data justify.

use super::{Integrated, Velocity, Window, clear_of_contact_s};
use crate::data::{Axis, FlightFit, FlightScore, Mode, Plateau, Signal};
use crate::numerics::damped_modes::{
    Drive, Fit, Form, Oscillation, Seeds, Series, SeriesFit, fit, uniform_ringing,
};
use crate::numerics::noise::integral_uncertainty_by;
use crate::numerics::{as_count, as_f64, extent, robust};
use rayon::prelude::*;

/// Most fits described: the selected one and those that could replace it.
const MOST_FITS: usize = 5;
/// Points a window: 240 over 60 ms resolve 400 Hz tenfold.
const POINTS: usize = 240;
/// Longest window fitted, s: eight periods of 80 Hz; a longer one would only coarsen the points.
pub(super) const LONGEST_S: f64 = 0.1;
/// The noise is determined from samples up to this time before first contact, s.
pub(super) const CLEAR_S: f64 = 5e-3;
/// Least noise of a velocity, as a share of its range in the window: linearity of the best sensors.
const LEAST_FLOOR: f64 = 1e-3;
/// Stretch before the end of a long flight that is compared with the fit, s: two periods of 100 Hz.
const LATE_S: f64 = 0.02;
/// A shorter stretch that is compared too, s, for events shortly before the slap-down.
const LAST_S: f64 = 0.004;
/// Stretch after the separation that is compared with the fit, s: at most half a period of 500 Hz, at least
/// the time before a fit that begins clear of the contact.
const LONGEST_EARLY_S: f64 = 1e-3;
const SHORTEST_EARLY_S: f64 = 5e-4;
/// A deviation over the shorter stretch counts by this share: a mode that is fitted poorly leaves a larger
/// residual there.
const LAST_SHARE: f64 = 0.5;
/// An offset from a quarter of a second predicts that of the next half to within this many of its standard
/// uncertainties (noise of 1/f).
const DRIFT_FACTOR: f64 = 3.5;
/// Share of the centrifugal force by which a sensor's reading may differ: 2 % of cross axis, and ω to 1.5 %,
/// which counts twice.
const TURNED_SHARE: f64 = 0.05;
/// Largest zero shift as a share of the channel's peak: data sheets of shock accelerometers give up to a few
/// percent of full scale.
const MOST_ZERO_SHIFT: f64 = 0.1;
/// Lowest frequency sought: this many periods in the window.
const LEAST_PERIODS: f64 = 0.6;
/// Fewest periods of a mode whose phase the contact force determines.
const LEAST_DRIVEN_PERIODS: f64 = 0.2;
/// Usual zero shift as a share of the channel's peak (data sheets of shock accelerometers).
const USUAL_ZERO_SHIFT: f64 = 0.005;
/// −2 ln of the odds that a sound channel shifts at all, one in e^10: a shift must show beyond doubt before
/// it is subtracted.
const DRIFT_ODDS: f64 = 20.0;
/// A mode that is seen for this many periods has its phase from the flight.
const CLEAR_PERIODS: f64 = 1.5;
/// The residual of such a fit must not exceed this many times the noise.
const CLEAR_RESIDUAL: f64 = 3.0;
/// No cask bends more slowly, Hz.
const LOWEST_HZ: f64 = 15.0;
/// Modes and drift that change no velocity step by this share of the largest one, and leave no larger
/// residual, are omitted: a tenth of the error of the usual calibration.
const IMMATERIAL_SHARE: f64 = 1e-3;
/// Residual of the velocities in any case, in standard deviations of their integrated noise.
const NOISE_LEFT: f64 = 1.5;
/// A candidate this close in BIC to the best cannot be distinguished from it (Kass & Raftery 1995: above 10
/// is very strong).
const EQUAL_BIC: f64 = 10.0;

/// Fits all velocities over the window, the most probable fit first, or one that does as well with fewer
/// modes; empty if the window is too short or nothing can be fitted.
///
/// Velocity v_j(t) = p_j + d_j t + Σ_m e^(−ζωt)(A cos ωt + B sin ωt)   (20), with modes common to all
/// channels and phases that are free or given by the contact force; the Bayesian information criterion (21)
/// decides the number of modes and if there is a drift.
pub fn fit_flights(
    integrated: &Integrated,
    window: &Window,
    drive: Option<&Drive>,
    cog_m: f64,
    most_modes: usize,
) -> Vec<FlightFit> {
    let cut = Window { to_s: window.to_s.min(window.from_s + LONGEST_S), ..*window };
    let series = series(integrated, &cut, cog_m);
    let mut fits = candidates(&series, &cut, drive, most_modes);
    let Integrated { signals, peaks_m_s2, .. } = integrated;
    fits.retain(|f| has_plausible_drift(peaks_m_s2, f));
    let Some(richest) = fits.iter().max_by_key(|f| f.parameters).map(|f| f.correlation) else {
        return Vec::new();
    };
    let mut scored: Vec<(f64, Fit)> =
        fits.into_iter().map(|f| (f.bic(&series, richest) + improbability(peaks_m_s2, &f), f)).collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let suffices = |(_, fit): &&(f64, Fit)| is_as_good(&series, fit, &scored[0].1);
    let fewest = scored.iter().filter(suffices).map(|(_, fit)| fit.parameters).min();
    let simplest = scored.iter().position(|of| Some(of.1.parameters) == fewest && suffices(&of)).unwrap_or(0);
    scored[..=simplest].rotate_right(1);
    (0..scored.len().min(MOST_FITS)).map(|i| describe_fit(signals, &cut, &scored, i)).collect()
}

/// True if a fit gives the velocity steps of the best one, and leaves no residual that matters.
fn is_as_good(series: &[Series], fit: &Fit, best: &Fit) -> bool {
    let largest_m_s = best.series.iter().map(|f| f.plateau.abs()).fold(0.0, f64::max);
    let material_m_s = IMMATERIAL_SHARE * largest_m_s;
    series.iter().zip(&fit.series).zip(&best.series).all(|((series, own), best)| {
        let length_s = series.time_s.last().copied().unwrap_or(0.0);
        // A drift is followed back into the contact.
        let before = |f: &SeriesFit| f.plateau - f.drift * length_s / 3.0;
        (own.plateau - best.plateau).abs() <= material_m_s
            && (before(own) - before(best)).abs() <= material_m_s
            && own.residual <= material_m_s.hypot(NOISE_LEFT * series.floor)
    })
}

/// Compares the end of the flight in `window` with its fit, for each channel   (20)
pub fn compare_late(flight: &mut FlightFit, integrated: &Integrated, window: &Window, cog_m: f64) {
    let mismatches: Vec<Option<f64>> =
        integrated.with_velocities().map(|of| late_mismatch_m_s(of, flight, window, cog_m)).collect();
    for (plateau, mismatch) in flight.plateaus.iter_mut().zip(mismatches) {
        plateau.late_mismatch_m_s = mismatch;
    }
}

/// Compares each channel after the separation at `left_s`, as long as more modes ring than are fitted, up to
/// `calm_s`, with the fit extrapolated back   (20)
pub fn compare_early(
    flight: &mut FlightFit,
    integrated: &Integrated,
    window: &Window,
    cog_m: f64,
    (left_s, calm_s): (f64, f64),
) {
    let from_s = clear_of_contact_s(integrated.contact_s, left_s);
    let length_s = LONGEST_EARLY_S.max(calm_s - from_s).min((flight.from_s - from_s) / 2.0);
    if length_s < SHORTEST_EARLY_S {
        return;
    }
    let mismatch_m_s = |(signal, velocity): (&Signal, &Velocity)| {
        let plateau = flight.plateau(&signal.name)?;
        let after_s = from_s - flight.from_s..from_s + length_s - flight.from_s;
        let slope_m_s2 =
            plateau.zero_shift_m_s2 + centrifugal_m_s2(signal, window.angular_velocity_rad_s, cog_m);
        let straight_m_s = plateau.velocity_step_m_s + slope_m_s2 * f64::midpoint(after_s.start, after_s.end);
        let ringing_m_s = mean_ringing_m_s(flight, plateau, after_s);
        Some(velocity.mean(from_s, from_s + length_s) - straight_m_s - ringing_m_s)
    };
    let mismatches: Vec<Option<f64>> = integrated.with_velocities().map(mismatch_m_s).collect();
    for (plateau, mismatch) in flight.plateaus.iter_mut().zip(mismatches) {
        plateau.early_mismatch_m_s = mismatch;
    }
}

/// Fits with every number of modes, with and without drift, in free phases, and in driven ones if the free
/// fits are not clear.
fn candidates(series: &[Series], window: &Window, drive: Option<&Drive>, most_modes: usize) -> Vec<Fit> {
    let length_s = window.to_s - window.from_s;
    let fewest = series.iter().map(|s| s.value.len()).min().unwrap_or(0);
    if length_s <= 0.0 || fewest < 8 {
        return Vec::new();
    }
    let highest_hz = (0.2 * as_f64(fewest) / length_s).min(1500.0);
    let band_hz = |periods: f64| ((periods / length_s).max(LOWEST_HZ), highest_hz);
    let drifts = if window.drift { &[false, true][..] } else { &[false] };
    let chains = |drive: Option<&Drive>, periods: f64| -> Vec<Vec<Fit>> {
        let seeds = Seeds::new(series, band_hz(periods), drive);
        drifts.par_iter().map(|&drift| chain(series, &seeds, Form { drift, drive }, most_modes)).collect()
    };
    let mut fits = chains(None, LEAST_PERIODS).concat();
    if drive.is_some() && fits.iter().all(|f| !is_clear(series, f, length_s)) {
        let driven = chains(drive, LEAST_DRIVEN_PERIODS);
        fits.extend(driven.into_iter().flat_map(|chain| chain.into_iter().skip(1)));
    }
    fits
}

/// Describes the fit at `taken` of those sorted by their score, with the others as its rivals.
fn describe_fit(signals: &[Signal], window: &Window, scored: &[(f64, Fit)], taken: usize) -> FlightFit {
    let (score, best) = &scored[taken];
    let mut order: Vec<usize> = (0..best.modes.len()).collect();
    order.sort_by(|&a, &b| best.modes[a].frequency_hz.total_cmp(&best.modes[b].frequency_hz));
    let rivals: Vec<&Fit> = scored.iter().filter(|s| (s.0 - score).abs() < EQUAL_BIC).map(|s| &s.1).collect();
    let mut plateaus = plateaus(signals, best, &rivals);
    for plateau in &mut plateaus {
        plateau.ringing_m_s = order.iter().map(|&i| plateau.ringing_m_s[i]).collect();
    }
    FlightFit {
        from_s: window.from_s,
        to_s: window.to_s,
        modes: order.iter().map(|&i| mode(best, i)).collect(),
        plateaus,
        drift: best.drift,
        candidates: scored
            .iter()
            .enumerate()
            .map(|(i, (bic, f))| FlightScore {
                modes: f.modes.len(),
                drift: f.drift,
                driven: f.driven,
                taken: i == taken,
                bic: *bic,
                residual_m_s: f.series.iter().map(|s| s.residual).fold(0.0, f64::max),
            })
            .collect(),
        ..FlightFit::default()
    }
}

/// A mode by its frequency and damping alone.
pub(super) fn oscillation(mode: &Mode) -> Oscillation {
    Oscillation { frequency_hz: mode.frequency_hz, damping: mode.damping }
}

/// Mean of a channel's modes over a stretch counted from the flight window's start, m/s.
fn mean_ringing_m_s(flight: &FlightFit, plateau: &Plateau, after_s: std::ops::Range<f64>) -> f64 {
    let points: u16 = 40;
    let step_s = (after_s.end - after_s.start) / f64::from(points);
    let of_mode = |(m, &(a, b)): (&Mode, &(f64, f64))| {
        let ringing = uniform_ringing(oscillation(m), after_s.start + step_s / 2.0, step_s);
        ringing.take(usize::from(points)).map(|z| (a * z.re + b * z.im) / f64::from(points)).sum::<f64>()
    };
    flight.modes.iter().zip(&plateau.ringing_m_s).map(of_mode).sum()
}

/// Deviation of the velocity by the end of the flight: another contact leaves a step.
fn late_mismatch_m_s(
    (signal, velocity): (&Signal, &Velocity),
    flight: &FlightFit,
    whole: &Window,
    cog_m: f64,
) -> Option<f64> {
    let to_s = whole.to_s.min(signal.end_s());
    if to_s < flight.from_s + 2.0 * LATE_S || signal.overlaps(&signal.gaps, flight.from_s, to_s) {
        return None;
    }
    let plateau = flight.plateau(&signal.name)?;
    let centrifugal_m_s2 = centrifugal_m_s2(signal, whole.angular_velocity_rad_s, cog_m);
    let off_m_s = |length_s: f64| {
        let from_s = to_s - length_s;
        let middle_s = f64::midpoint(from_s, to_s) - flight.from_s;
        let straight_m_s =
            plateau.velocity_step_m_s + (plateau.zero_shift_m_s2 + centrifugal_m_s2) * middle_s;
        let after_s = from_s - flight.from_s..to_s - flight.from_s;
        velocity.mean(from_s, to_s) - straight_m_s - mean_ringing_m_s(flight, plateau, after_s)
    };
    let (late_m_s, last_m_s) = (off_m_s(LATE_S), LAST_SHARE * off_m_s(LAST_S));
    let mismatch_m_s = if last_m_s.abs() > late_m_s.abs() { last_m_s } else { late_m_s };
    // A deviation that the offset may have accumulated is no contact.
    let since_s = to_s - flight.from_s;
    let noise_m_s = integral_uncertainty_by(&signal.noise_spectrum, signal.free_fall_s, since_s);
    let arms_m = (signal.position_m - cog_m).hypot(signal.offset_m);
    let turned_m_s = TURNED_SHARE * whole.angular_velocity_rad_s.powi(2) * arms_m * since_s;
    // A drift fitted over the window loses its validity for later times.
    let slope_m_s = if flight.drift { plateau.u_zero_shift_m_s2 * since_s } else { 0.0 };
    let gathered_m_s = noise_m_s.max(signal.u_offset_m_s2 * since_s).hypot(slope_m_s);
    let drifted_m_s = turned_m_s + DRIFT_FACTOR * gathered_m_s;
    Some(mismatch_m_s.signum() * (mismatch_m_s.abs() - drifted_m_s).max(0.0))
}

/// Distance along the axis to which the centrifugal force of a channel is proportional, m: f_η holds −Ω² η,
/// f_ξ holds −Ω² ξ   (14), (15)
pub(super) fn centrifugal_arm_m(signal: &Signal, cog_m: f64) -> f64 {
    match signal.axis {
        Axis::Transverse => signal.offset_m,
        Axis::Axial => signal.position_m - cog_m,
    }
}

pub(super) fn centrifugal_m_s2(signal: &Signal, turning_rad_s: f64, cog_m: f64) -> f64 {
    -turning_rad_s * turning_rad_s.abs() * centrifugal_arm_m(signal, cog_m)
}

/// True if the zero shift stays below this share of the peak: a larger one is a contact that the window
/// holds, or a slow mode.
fn has_plausible_drift(peaks_m_s2: &[f64], fit: &Fit) -> bool {
    peaks_m_s2.iter().zip(&fit.series).all(|(peak, series)| series.drift.abs() < MOST_ZERO_SHIFT * peak)
}

/// True if a fit leaves only the noise and shows each of its modes for long enough to know its phase from the
/// flight alone.
fn is_clear(series: &[Series], fit: &Fit, length_s: f64) -> bool {
    let lowest_hz = fit.modes.iter().map(|m| m.frequency_hz).fold(f64::INFINITY, f64::min);
    let is_noise = |(s, f): (&Series, &SeriesFit)| f.residual < CLEAR_RESIDUAL * s.floor;
    lowest_hz * length_s > CLEAR_PERIODS && series.iter().zip(&fit.series).all(is_noise)
}

/// −2 ln of the probability of a fit's zero shifts: each is normal with [`USUAL_ZERO_SHIFT`] of its channel's
/// peak, and none if the fit has no drift.
fn improbability(peaks_m_s2: &[f64], fit: &Fit) -> f64 {
    let share = |(peak, series): (&f64, &SeriesFit)| (series.drift / (USUAL_ZERO_SHIFT * peak)).powi(2);
    let shifts: f64 = peaks_m_s2.iter().zip(&fit.series).map(share).sum();
    if fit.drift { DRIFT_ODDS + shifts } else { 0.0 }
}

/// Fits with none, one, two … modes, each started from the last, until nothing remains to explain.
fn chain(series: &[Series], seeds: &Seeds, form: Form, most_modes: usize) -> Vec<Fit> {
    let Some(first) = fit(series, &[], None, form) else { return Vec::new() };
    let mut fits = vec![first];
    while fits.len() <= most_modes {
        let last = &fits[fits.len() - 1];
        if series.iter().zip(&last.series).all(|(s, f)| f.residual < 1.1 * s.floor) {
            break;
        }
        let start: Vec<Oscillation> = last.modes.clone();
        let Some(next) = fit(series, &start, Some(seeds), form) else { break };
        fits.push(next);
    }
    // With too few modes the residual hides the plateau, which one more mode may show.
    fits.retain(|fit| fit.modes.is_empty() || is_sound(series, fit));
    fits
}

/// True unless a mode is larger than the series themselves, or a plateau no better known than their range:
/// such a fit is singular.
fn is_sound(series: &[Series], fit: &Fit) -> bool {
    series.iter().zip(&fit.series).all(|(s, f)| {
        let range = range(&s.value);
        f.u_plateau < 0.5 * range.max(s.floor) && f.amplitudes.iter().all(|(a, b)| a.hypot(*b) < 3.0 * range)
    })
}

fn range(values: &[f64]) -> f64 {
    let (low, high) = extent(values.iter().copied());
    high - low
}

/// Each velocity over the window in [`POINTS`] means, without the centrifugal force and without lost samples.
pub(super) fn series(integrated: &Integrated, window: &Window, cog_m: f64) -> Vec<Series> {
    integrated.with_velocities().map(|of| make_series(of, integrated.contact_s, window, cog_m)).collect()
}

fn make_series(
    (signal, velocity): (&Signal, &Velocity),
    contact_s: f64,
    window: &Window,
    cog_m: f64,
) -> Series {
    let centrifugal_m_s2 = centrifugal_m_s2(signal, window.angular_velocity_rad_s, cog_m);
    let length_s = (window.to_s.min(signal.end_s()) - window.from_s).max(0.0);
    let points = as_count(length_s * signal.sample_rate_hz).min(POINTS);
    let bin_s = length_s / as_f64(points.max(1));
    let (mut time_s, mut value) = (Vec::with_capacity(points), Vec::with_capacity(points));
    for i in 0..points {
        let from_s = as_f64(i) * bin_s;
        let (a, b) = (window.from_s + from_s, window.from_s + from_s + bin_s);
        if signal.overlaps(&signal.gaps, a, b) {
            continue;
        }
        let t = from_s + bin_s / 2.0;
        time_s.push(t);
        value.push(velocity.mean(a, b) - centrifugal_m_s2 * t);
    }
    let steps_s = signal
        .gaps
        .iter()
        .map(|g| signal.time_s(g.from) - window.from_s)
        .filter(|t| *t > time_s.first().copied().unwrap_or(0.0) && *t < time_s.last().copied().unwrap_or(0.0))
        .collect();
    let floor =
        noise_floor((signal, velocity), contact_s, length_s).max(LEAST_FLOOR * range(&value).max(0.0));
    Series { time_s, value, steps_s, floor: floor.max(1e-9) }
}

/// RMS of the velocity about a line over a stretch of free fall of equal length before contact, m/s.
fn noise_floor((signal, velocity): (&Signal, &Velocity), contact_s: f64, length_s: f64) -> f64 {
    let to_s = contact_s - CLEAR_S;
    let from_s = (to_s - length_s).max(signal.start_s);
    let guessed = signal.noise_m_s2 * (length_s / signal.sample_rate_hz).sqrt() / 4.0;
    if to_s - from_s < 0.5 * length_s {
        return guessed;
    }
    let points: u32 = 60;
    let bin_s = (to_s - from_s) / f64::from(points);
    let time_s: Vec<f64> = (0..points).map(|i| f64::from(i) * bin_s).collect();
    let value = time_s.iter().map(|a| velocity.mean(from_s + a, from_s + a + bin_s)).collect();
    let line = Series { time_s, value, steps_s: vec![], floor: 1e-12 };
    fit(&[line], &[], None, Form::free(true)).map_or(guessed, |f| f.series[0].residual.max(0.5 * guessed))
}

fn mode(fit: &Fit, index: usize) -> Mode {
    let amplitude =
        fit.series.iter().map(|s| s.amplitudes[index].0.hypot(s.amplitudes[index].1)).fold(0.0, f64::max);
    Mode {
        frequency_hz: fit.modes[index].frequency_hz,
        damping: fit.modes[index].damping,
        amplitude_m_s: amplitude,
    }
}

/// Plateaus of the best fit; their uncertainty includes the differences to candidates that are equally good.
pub(super) fn plateaus(signals: &[Signal], best: &Fit, rivals: &[&Fit]) -> Vec<Plateau> {
    signals
        .iter()
        .enumerate()
        .map(|(i, signal)| {
            let own = &best.series[i];
            let apart: Vec<f64> = rivals.iter().map(|f| f.series[i].plateau - own.plateau).collect();
            let spread = robust::mean_and_rms(&apart);
            Plateau {
                channel: signal.name.clone(),
                velocity_step_m_s: own.plateau,
                u_m_s: own.u_plateau.hypot(spread.0).hypot(spread.1),
                zero_shift_m_s2: own.drift,
                u_zero_shift_m_s2: own.u_drift,
                residual_m_s: own.residual,
                slow_residual_m_s: own.slow_residual,
                ringing_m_s: own.amplitudes.clone(),
                late_mismatch_m_s: None,
                early_mismatch_m_s: None,
            }
        })
        .collect()
}
