//! What the stages found to one [`Analysis`].

use super::comparison::Measured;
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

/// What a recorder's anti-alias filter delays by, in samples: 1.0 to 1.7 for one of fourth order at 0.4 to
/// 0.25 of the rate, 2.0 for one of eighth order at 0.4 (Butterworth, at low frequency).
const CHAIN_DELAY_SAMPLES: f64 = 2.0;

/// The result where no impact was found.
pub(super) fn without_impact(recording: &Recording, file: &CaskFile, findings: Vec<Finding>) -> Analysis {
    let result = result(recording, file, findings, Events::default(), None);
    analysis(recording, file, result, Curves::default)
}

/// The result from the first impact on, as far as the analysis came; `measured`: what is to be stated.
pub(super) fn of(
    recording: &Recording,
    file: &CaskFile,
    findings: Vec<Finding>,
    AfterImpact { impact, mut events, mut flown, on_end }: AfterImpact,
    shown: ShownSignals,
    measured: Option<Measured>,
) -> Analysis {
    // Checks and comparison go by the contact as a whole; what is stated is open to both its touches.
    if let Some(flown) = &mut flown
        && let Some(tabulated) = &flown.tabulated
    {
        tabulated.doubt_end(&mut flown.quantities);
    }
    if let Some(flown) = &mut flown {
        doubt_unfollowed(flown, &findings);
        doubt_times(flown, &mut events);
    }
    let stated = flown.as_ref().filter(|_| measured.is_some());
    let quantities = stated.map(|flown| &flown.quantities);
    let effect = stated.and_then(|flown| filter_effect(&shown.smooth, &events, flown));
    let signals = impact.recorded();
    let recorded = signals.len();
    let mut result = result(recording, file, findings, events, quantities);
    for (signal, smooth) in signals.iter().zip(&shown.smooth) {
        let Some(summary) = result.channels.iter_mut().find(|c| c.name == signal.name) else { continue };
        let peak = |of: &Signal| peak(&of.force_m_s2[motion::visible(of, &events)]);
        summary.offset_m_s2 = Some(signal.removed_offset_m_s2);
        summary.noise_m_s2 = Some(signal.noise_m_s2);
        summary.peak_raw_m_s2 = Some(peak(signal));
        summary.peak_filtered_m_s2 = Some(peak(smooth));
        summary.clipped.clone_from(&signal.clipped);
    }
    let mut motion = None;
    let opened_inputs = flown.as_ref().map_or_else(Vec::new, |flown| flown.opened_inputs.clone());
    let tabulated = stated.and_then(|flown| flown.tabulated.as_ref());
    result.impacts = impacts::of_result(file, signals, &result, tabulated);
    if let Some(EndImpact { first, k }) = on_end {
        let numbers = &mut result.impacts[0].numbers;
        (numbers.duration, numbers.restitution) = (first.duration, Some(k));
        result.first_impact = FirstImpact { time: result.first_impact.time, ..first };
        result.k = Some(k);
    }
    result.filters = impacts::filters(file, signals, &result);
    result.amplification = impacts::amplification(&result);
    result.settings.splice(0..0, of_curves(file, effect));
    match flown.map(|flown| (flown, measured)) {
        None => {}
        Some((flown, None)) => {
            result.flight = Some(flown.flight);
            // A warning took the numbers away: what the motion misses is the reason.
            if result.quality.iter().all(|f| f.severity < Severity::Error) {
                result.reconstruction = Some(flown.reconstruction.without_numbers());
            }
        }
        Some((flown, Some(measured))) => {
            result.reconstruction = Some(flown.reconstruction);
            result.predictions = predictions(file, Some((&flown.quantities, measured.model.as_ref())));
            result.model = measured.model;
            result.comparison = measured.comparison;
            result.budget = flown.budget;
            result.slap_down.local_speed = flown.local_speed;
            result.untested = flown.untested;
            let effect = |input: &Untested| input.moves.in_half_widths(&flown.quantities);
            result.untested.sort_by(|a, b| effect(b).total_cmp(&effect(a)));
            result.flight = Some(flown.flight);
            motion = Some(flown.motion.curve);
        }
    }
    let ShownSignals { mut signals, .. } = shown;
    signals.truncate(recorded);
    let (setup, (cutoff_hz, _)) = (sticking(file), motion::cutoff_hz(file.filter, file.cask.mass_kg));
    let channels = move || motion::channel_curves(&signals, &events, cutoff_hz, &setup);
    let curves = move || Curves { channels: channels(), motion, ..Curves::default() };
    Analysis { opened_inputs, ..analysis(recording, file, result, curves) }
}

/// Lets the intervals reach as far as what is not followed: a landing of L that may come before R strikes, a
/// step in the flight.
fn doubt_unfollowed(flown: &mut FlightResult, findings: &[Finding]) {
    let v0_m_s = flown.quantities.impact_velocity.value;
    for finding in findings {
        let (effect_m_s, of_k) = match finding.what {
            FindingKind::Drop(DropFinding::MayLand { effect_m_s, .. }) => (effect_m_s, 0.0),
            FindingKind::Drop(DropFinding::SmallBlow { step_m_s, .. }) => (step_m_s, step_m_s / v0_m_s),
            _ => continue,
        };
        let Quantities { speed, vertical_velocity, k, .. } = &mut flown.quantities;
        k.u95 += of_k;
        for speed in [speed, vertical_velocity, &mut flown.local_speed].into_iter().flatten() {
            speed.u95 += effect_m_s;
        }
    }
}

/// Lets the intervals of times and lengths reach as far as the way from the corner to the sensor takes; what
/// they make of the closures, too little in a rigid body, is not theirs.
fn doubt_times(flown: &mut FlightResult, events: &mut Events) {
    let [first_s, second_s] = flown.u_late_s;
    let of_events = [&mut events.first_contact, &mut events.separation, &mut events.slap_down];
    for (at, u_s) in of_events.into_iter().zip([first_s, first_s, second_s]) {
        if let Some(at) = at {
            at.u_s = at.u_s.hypot(u_s);
        }
    }
    let Quantities { duration, flight_time, .. } = &mut flown.quantities;
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
    let of_others = move || others.channels.iter().filter_map(curve).collect();
    let curves = LazyCurves::new(Box::new(move || Curves { others: of_others(), ..curves() }));
    let start_unix_ns = recording.start_unix_ns;
    Analysis { result, cask_file: file.clone(), curves, start_unix_ns, opened_inputs: Vec::new() }
}

/// The result with the times of the events and, where they are measured, the quantities.
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
    // What the recorder's filters delay all channels by is part of the interval of a time, and of no other.
    let delay_s = CHAIN_DELAY_SAMPLES / rates_hz.fold(f64::INFINITY, f64::min);
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
        settings: of_cask_file(file, &events)
            .into_iter()
            .chain(of_rest(recording, &events))
            .chain(of_recorders(recording))
            .collect(),
        cask_text: file.text.clone(),
        ..DropResult::default()
    }
}

/// Rod and body: the four borderline cases, and the contact law and k of the test, with the length of its
/// contact where that is the model taken.
fn predictions(file: &CaskFile, measured: Option<(&Quantities, Option<&ModelChoice>)>) -> Vec<Prediction> {
    let mut all = Vec::new();
    for body in predict::bodies(&file.cask) {
        all.extend(predict::borderline_cases(&body, &file.drop));
        all.extend(measured.map(|(measured, taken)| {
            let contact = compare::contact_as_measured(file, measured);
            let is_timed = taken.is_some_and(|m| m.rung == Rung::FinitePulse && m.name == body.model);
            let contact_duration_s = if is_timed { measured.duration.value.max(0.0) } else { 0.0 };
            let drop = Drop { contact_duration_s, ..file.drop };
            predict::predict(&body, &drop, contact, measured.k.value.clamp(0.0, 1.0))
        }));
    }
    all
}

/// The signals over what the curves show.
pub(super) struct ShownSignals {
    signals: Vec<Signal>,
    /// As the curves' low-pass leaves them.
    smooth: Vec<Signal>,
}

impl ShownSignals {
    pub fn of(signals: &[Signal], events: &Events, file: &CaskFile) -> Self {
        let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
        let signals = motion::cut_shown(signals, events, cutoff_hz);
        Self { smooth: motion::filter(&signals, cutoff_hz), signals }
    }
}

/// What the curves' low-pass would have changed had it been used for the numbers, in words.
fn filter_effect(
    smooth: &[Signal],
    events: &Events,
    FlightResult { setup, quantities, flight, .. }: &FlightResult,
) -> Option<String> {
    let speed = quantities.speed?;
    let integrated = motion::Integrated::new(smooth, events.first_contact?.time_s);
    let flight = motion::with_modes(&integrated, flight, quantities.angular_velocity.value, setup.cog_m)?;
    let motion = motion::outcome(&integrated, &flight, events, setup)?;
    let (horizontal_m_s, vertical_m_s) = motion.second_end_m_s?;
    // No sign before nothing: −0 and 0 are 0.
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

/// What the curves are made with, and what that would have changed.
fn of_curves(file: &CaskFile, effect: Option<String>) -> Vec<Setting> {
    let (cutoff_hz, origin) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
    let effect = effect.map(|effect| {
        setting("effect of that low-pass, had it been applied before integrating", effect, "from the data")
    });
    let shown = format!("−3 dB at {cutoff_hz:.1} Hz, zero phase (two passes, second order)");
    let low_pass = setting("low-pass of the curves shown", shown, origin);
    let integrated = setting("samples that are integrated", "unfiltered, offset removed", "default");
    [low_pass].into_iter().chain(effect).chain([integrated]).collect()
}

/// What the analysis went by, and the free fall where it is seen.
fn of_cask_file(file: &CaskFile, events: &Events) -> Vec<Setting> {
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

/// The recordings of other recorders, and how their clocks were joined.
fn of_recorders(recording: &Recording) -> impl Iterator<Item = Setting> {
    recording.joined.iter().map(|joined| {
        let JoinedRecording { file, sha256, shift_s, u_s, .. } = joined;
        let by_ms = format!("{:+.3} ± {:.3} ms", 1e3 * shift_s, 2e3 * u_s);
        let value = format!("{by_ms}, by the first contact; SHA-256 {sha256}");
        setting(&format!("shift of the times of {file}"), value, "from the data")
    })
}

/// Where the rest before the drop is from, where it is a file of its own.
fn of_rest(recording: &Recording, events: &Events) -> Option<Setting> {
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
