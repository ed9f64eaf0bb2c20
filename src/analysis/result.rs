//! Assembles the results of the stages into one [`Analysis`].

use super::comparison::JudgedFlight;
use super::end_drop::EndImpact;
use super::flight::FlightResult;
use super::setup::sticking;
use super::{AfterImpact, impacts};
use crate::data::{
    Analysis, At, Axis, CaskFile, Channel, ChannelSummary, Curves, Drop, DropFinding, DropResult, End,
    Estimate, Events, Finding, FindingKind, FirstImpact, ImpactTable, Input, JoinedRecording, LazyCurves,
    ModelChoice, Prediction, Quantities, Recording, Rung, Setting, Severity, Signal, SlapDown, Untested,
};
use crate::numerics::reduce::peak;
use crate::{compare, fit, judge, motion, predict};
use std::sync::Arc;

/// Delay of a recorder's anti-alias filter, in samples: 1.0 to 1.7 for one of fourth order at 0.4 to 0.25 of
/// the rate, 2.0 for one of eighth order at 0.4 (Butterworth, at low frequency).
const FILTER_DELAY_SAMPLES: f64 = 2.0;

/// Result without an impact.
pub(super) fn without_impact(recording: &Recording, file: &CaskFile, findings: Vec<Finding>) -> Analysis {
    let result = result(recording, file, findings, Events::default(), None);
    analysis(recording, file, result, Curves::default)
}

/// Result of a recording with a first impact, as far as the analysis came; `measured` holds what may be
/// stated.
pub(super) fn after_impact(
    recording: &Recording,
    file: &CaskFile,
    findings: Vec<Finding>,
    AfterImpact { impact, mut events, mut solution, on_end }: AfterImpact,
    shown: ShownSignals,
    measured: Option<JudgedFlight>,
) -> Analysis {
    // Checks and comparison used the contact as a whole; the intervals that are stated also include its two
    // possible touches.
    if let Some(solution) = &mut solution
        && let Some(tables) = &solution.tables
    {
        tables.widen_end(&mut solution.method.quantities);
    }
    if let Some(solution) = &mut solution {
        widen_for_touches(solution, &findings);
        widen_times(solution, &mut events);
    }
    let stated = solution.as_ref().filter(|_| measured.is_some());
    let quantities = stated.map(|solution| &solution.method.quantities);
    let effect = stated.and_then(|solution| filter_effect(&shown.smooth, &events, solution));
    let signals = impact.recorded();
    let recorded = signals.len();
    let mut result = result(recording, file, findings, events, quantities);
    for (signal, smooth) in signals.iter().zip(&shown.smooth) {
        let Some(summary) = result.channels.iter_mut().find(|c| c.name == signal.name) else { continue };
        let peak = |s: &Signal| peak(&s.force_m_s2[motion::visible(s, &events)]);
        summary.offset_m_s2 = Some(signal.removed_offset_m_s2);
        summary.noise_m_s2 = Some(signal.noise_m_s2);
        summary.peak_raw_m_s2 = Some(peak(signal));
        summary.peak_filtered_m_s2 = Some(peak(smooth));
        summary.clipped.clone_from(&signal.clipped);
    }
    let mut motion = None;
    let opened_inputs =
        solution.as_ref().map_or_else(Vec::new, |solution| solution.method.opened_inputs.clone());
    let tables = stated.and_then(|solution| solution.tables.as_ref());
    result.impacts = impacts::complete_tables(file, signals, &result, tables);
    if let Some(EndImpact { first, k }) = on_end {
        let numbers = &mut result.impacts[0].numbers;
        (numbers.duration, numbers.restitution) = (first.duration, Some(k));
        result.first_impact = FirstImpact { time: result.first_impact.time, ..first };
        result.k = Some(k);
    }
    result.filters = impacts::filter_table(file, signals, &result);
    result.amplification = impacts::amplification(&result);
    result.settings.splice(0..0, curve_settings(file, effect));
    match solution.map(|solution| (solution, measured)) {
        None => {}
        Some((solution, None)) => {
            result.flight = Some(solution.flight);
            // A warning removed the numbers: the failed checks of the motion are the reason.
            if result.quality.iter().all(|f| f.severity < Severity::Error) {
                result.reconstruction = Some(solution.method.choice.without_numbers());
            }
        }
        Some((solution, Some(measured))) => {
            result.reconstruction = Some(solution.method.choice);
            result.predictions =
                predictions(file, Some((&solution.method.quantities, measured.model.as_ref())));
            result.model = measured.model;
            result.comparison = measured.comparison;
            result.budget = solution.method.budget;
            result.slap_down.local_speed = solution.local_speed;
            result.untested = solution.untested;
            let effect = |input: &Untested| input.moves.in_half_widths(&solution.method.quantities);
            result.untested.sort_by(|a, b| effect(b).total_cmp(&effect(a)));
            result.flight = Some(solution.flight);
            motion = Some(solution.motion.curve);
        }
    }
    let ShownSignals { mut signals, .. } = shown;
    signals.truncate(recorded);
    let (setup, (cutoff_hz, _)) = (sticking(file), motion::cutoff_hz(file.filter, file.cask.mass_kg));
    let channels = move || motion::channel_curves(&signals, &events, cutoff_hz, &setup);
    let curves = move || Curves { channels: channels(), motion, ..Curves::default() };
    Analysis { opened_inputs, ..analysis(recording, file, result, curves) }
}

/// Widens the intervals by events that the motion does not follow: a possible landing of L before R strikes,
/// a step in the flight.
fn widen_for_touches(solution: &mut FlightResult, findings: &[Finding]) {
    let v0_m_s = solution.method.quantities.impact_velocity.value;
    for finding in findings {
        let (effect_m_s, k_effect) = match finding.what {
            FindingKind::Drop(DropFinding::MayLand { effect_m_s, .. }) => (effect_m_s, 0.0),
            FindingKind::Drop(DropFinding::SmallBlow { step_m_s, .. }) => (step_m_s, step_m_s / v0_m_s),
            _ => continue,
        };
        let Quantities { speed, vertical_velocity, k, .. } = &mut solution.method.quantities;
        k.u95 += k_effect;
        for speed in [speed, vertical_velocity, &mut solution.local_speed].into_iter().flatten() {
            speed.u95 += effect_m_s;
        }
    }
}

/// Widens the intervals of times and lengths by the delay between corner and sensor; its effect on the
/// checks, too small in a rigid body, is not included there.
fn widen_times(solution: &mut FlightResult, events: &mut Events) {
    let [first_s, second_s] = solution.u_late_s;
    let times = [&mut events.first_contact, &mut events.separation, &mut events.slap_down];
    for (at, u_s) in times.into_iter().zip([first_s, first_s, second_s]) {
        if let Some(at) = at {
            at.u_s = at.u_s.hypot(u_s);
        }
    }
    let Quantities { duration, flight_time, .. } = &mut solution.method.quantities;
    duration.u95 = duration.u95.hypot(fit::COVERAGE * first_s);
    if let Some(flight_time) = flight_time {
        flight_time.u95 = flight_time.u95.hypot(fit::COVERAGE * first_s.hypot(second_s));
    }
}

fn analysis(
    recording: &Recording,
    file: &CaskFile,
    result: DropResult,
    curves: impl FnOnce() -> Curves + Send + 'static,
) -> Analysis {
    let (others, events) = (Arc::clone(&recording.others), result.events);
    let curve = move |other: &Channel| motion::other_curve(other, &events);
    let other_curves = move || others.channels.iter().filter_map(curve).collect();
    let curves = LazyCurves::new(Box::new(move || Curves { others: other_curves(), ..curves() }));
    let start_unix_ns = recording.start_unix_ns;
    Analysis { result, cask_file: file.clone(), curves, start_unix_ns, opened_inputs: Vec::new() }
}

/// Fills the result with the times of the events and the quantities, if they were measured.
fn result(
    recording: &Recording,
    file: &CaskFile,
    mut findings: Vec<Finding>,
    events: Events,
    quantities: Option<&Quantities>,
) -> DropResult {
    let verdict = judge::verdict(&mut findings);
    let channels: Vec<ChannelSummary> = recording.channels.iter().map(|c| summary(c, file)).collect();
    let rates_hz = channels.iter().filter(|c| c.axis == Axis::Transverse).map(|c| c.sample_rate_hz);
    // The delay of all channels by the recorder's filters is part of the interval of a time, and of no other.
    let delay_s = FILTER_DELAY_SAMPLES / rates_hz.fold(f64::INFINITY, f64::min);
    let time = |at: At| Estimate::new(at.time_s, (fit::COVERAGE * at.u_s).hypot(delay_s), "s");
    DropResult {
        schema: "dropcheck.result/1",
        version: env!("CARGO_PKG_VERSION"),
        input: Input {
            recording: recording.path.display().to_string(),
            recording_sha256: recording.sha256.clone(),
            format: recording.format,
            reader: recording.reader.clone(),
            cask: file.path.display().to_string(),
            cask_sha256: file.sha256.clone(),
            rest: recording.rest.as_ref().map(|rest| rest.path.display().to_string()),
            rest_sha256: recording.rest.as_ref().map(|rest| rest.sha256.clone()),
            ..Input::default()
        },
        first_impact: FirstImpact::new(events.first_contact.map(time), quantities),
        slap_down: SlapDown::new(events.slap_down.map(time), quantities),
        k: quantities.map(|q| q.k),
        impacts: [End::First, End::Second].map(ImpactTable::empty),
        predictions: predictions(file, None),
        test: file.test.clone(),
        quality: findings,
        verdict,
        events,
        channels,
        settings: cask_file_settings(file, &events)
            .into_iter()
            .chain(rest_setting(recording, &events))
            .chain(recorder_settings(recording))
            .collect(),
        cask_text: file.text.clone(),
        ..DropResult::default()
    }
}

/// Predicts rod and body: the four borderline cases, and the contact law and k of the test, with the duration
/// of its contact if the selected model includes it.
fn predictions(file: &CaskFile, measured: Option<(&Quantities, Option<&ModelChoice>)>) -> Vec<Prediction> {
    let mut all = Vec::new();
    for body in predict::bodies(&file.cask) {
        all.extend(predict::borderline_cases(&body, &file.drop));
        all.extend(measured.map(|(measured, model)| {
            let contact = compare::contact_as_measured(file, measured);
            let is_timed = model.is_some_and(|m| m.rung == Rung::FinitePulse && m.name == body.model);
            let contact_duration_s = if is_timed { measured.duration.value.max(0.0) } else { 0.0 };
            let drop = Drop { contact_duration_s, ..file.drop };
            predict::predict(&body, &drop, contact, measured.k.value.clamp(0.0, 1.0))
        }));
    }
    all
}

/// Signals over the interval that the curves show.
pub(super) struct ShownSignals {
    signals: Vec<Signal>,
    /// Signals after the curves' low-pass.
    smooth: Vec<Signal>,
}

impl ShownSignals {
    pub fn new(signals: &[Signal], events: &Events, file: &CaskFile) -> Self {
        let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
        let signals = motion::cut_shown(signals, events, cutoff_hz);
        Self { smooth: motion::filter(&signals, cutoff_hz), signals }
    }
}

/// Change of the numbers if the curves' low-pass had been used for them, in words.
fn filter_effect(
    smooth: &[Signal],
    events: &Events,
    FlightResult { setup, method, flight, .. }: &FlightResult,
) -> Option<String> {
    let quantities = &method.quantities;
    let speed = quantities.speed?;
    let integrated = motion::Integrated::new(smooth, events.first_contact?.time_s);
    let flight = motion::with_modes(&integrated, flight, quantities.angular_velocity.value, setup.cog_m)?;
    let motion = motion::outcome(&integrated, &flight, events, setup)?;
    let (horizontal_m_s, vertical_m_s) = motion.second_end_m_s?;
    // Adding 0 turns −0 into 0, which has no sign.
    let rounded = |value: f64, parts: f64| (value * parts).round() / parts + 0.0;
    Some(format!(
        "slap-down speed {:+.2} m/s, k {:+.3}",
        rounded(horizontal_m_s.hypot(vertical_m_s) - speed.value, 100.0),
        rounded(motion.rebound_m_s / setup.impact_velocity_m_s - quantities.k.value, 1000.0)
    ))
}

fn setting(name: &str, value: impl Into<String>, origin: &str) -> Setting {
    Setting { name: name.into(), value: value.into(), origin: origin.into() }
}

/// Lists the settings of the curves, and the effect of their low-pass.
fn curve_settings(file: &CaskFile, effect: Option<String>) -> Vec<Setting> {
    let (cutoff_hz, origin) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
    let effect = effect.map(|effect| {
        setting("effect of that low-pass, had it been applied before integrating", effect, "from the data")
    });
    let shown = format!("−3 dB at {cutoff_hz:.1} Hz, zero phase (two passes, second order)");
    let low_pass = setting("low-pass of the curves shown", shown, origin);
    let integrated = setting("samples that are integrated", "unfiltered, offset removed", "default");
    [low_pass].into_iter().chain(effect).chain([integrated]).collect()
}

/// Lists the inputs of the analysis, and the free fall if it was recorded.
fn cask_file_settings(file: &CaskFile, events: &Events) -> Vec<Setting> {
    let origin = |key: &str| if file.defaults.iter().any(|d| d == key) { "default" } else { "cask file" };
    let (cask, drop) = (&file.cask, &file.drop);
    let is_given = drop.impact_velocity_given;
    let mut settings = vec![
        setting("mass", format!("{} kg", cask.mass_kg), "cask file"),
        setting("length", format!("{} m", cask.length_m), "cask file"),
        setting("section in the plane of the drop", format!("{} m", cask.height_m), origin("cask.height_m")),
        setting("centre of gravity from the first end", format!("{:.3} m", cask.cog_m), origin("cask.cog_m")),
        setting("inertia", format!("{:.0} kg m²", cask.inertia_kg_m2), origin("cask.inertia_kg_m2")),
        setting("drop angle", format!("{:.1}°", drop.angle_rad.to_degrees()), "cask file"),
        setting(
            "impact velocity",
            format!("{:.3} m/s", drop.impact_velocity_m_s),
            if is_given { "cask file" } else { "√(2 g h)" },
        ),
        setting("gravity", format!("{} m/s²", drop.gravity_m_s2), origin("drop.gravity_m_s2")),
        setting("contact law of the first end", file.contact.to_string(), origin("contact.friction")),
    ];
    settings.extend(file.is_rotation_measured.then(|| {
        let turns = format!("{:.2}°/s, by an angular-rate sensor", drop.angular_velocity_rad_s.to_degrees());
        setting("rotation at first contact", turns, "from the data")
    }));
    settings.extend(events.release_s.zip(events.fall_end_s).map(|(release_s, end_s)| {
        let stated = if is_given { "impact velocity over g" } else { "√(2 h / g)" };
        let stated_s = drop.impact_velocity_m_s / drop.gravity_m_s2;
        setting(
            "free fall seen",
            format!("{:.4} s, {stated} is {stated_s:.4} s", end_s - release_s),
            "from the data",
        )
    }));
    settings
}

/// Lists the recordings of other recorders, and the shifts of their clocks.
fn recorder_settings(recording: &Recording) -> impl Iterator<Item = Setting> {
    recording.joined.iter().map(|joined| {
        let JoinedRecording { file, sha256, shift_s, u_s, .. } = joined;
        let by_ms = format!("{:+.3} ± {:.3} ms", 1e3 * shift_s, 2e3 * u_s);
        let value = format!("{by_ms}, by the first contact; SHA-256 {sha256}");
        setting(&format!("shift of the times of {file}"), value, "from the data")
    })
}

/// Source of the rest before the drop, if it is a separate file.
fn rest_setting(recording: &Recording, events: &Events) -> Option<Setting> {
    let file = recording.rest.as_ref()?.path.display();
    let value = match events.release_s {
        Some(_) => format!("that of the recording itself; {file} is not used"),
        None => file.to_string(),
    };
    Some(setting("rest before the drop", value, "a file of its own"))
}

fn summary(channel: &Channel, file: &CaskFile) -> ChannelSummary {
    let spec = file.channels.iter().find(|spec| spec.name == channel.name);
    ChannelSummary {
        name: channel.name.clone(),
        end: channel.end,
        axis: channel.axis,
        source: channel.source.clone(),
        samples: channel.samples.len(),
        sample_rate_hz: channel.sample_rate_hz,
        unit: format!("{} ({})", channel.unit, channel.unit_origin),
        sensor: spec.map(|spec| spec.sensor.clone()).unwrap_or_default(),
        ..ChannelSummary::default()
    }
}
