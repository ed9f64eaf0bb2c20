//! A plausible analysis of an ANF-18 drop, made by hand, for the tests of this module only.

use super::sample_reconstruction;
use crate::data::{
    Analysis, At, Axis, BodyModel, Cask, CaskFile, ChannelCurve, ChannelFinding, ChannelSpec, ChannelSummary,
    CogVelocity, Comparison, Contact, Curves, Drop, DropFinding, DropPart, DropResult, End, Estimate, Events,
    Extreme, Finding, FirstImpact, FlightFit, FlightRegime, FlightScore, ImpactTable, Input, IssueCode,
    LazyCurves, Mode, ModelCandidate, ModelChoice, MotionCurve, OtherCurve, OtherSummary, Plateau,
    Prediction, Program, RecordingFormat, Rung, Setting, SlapDown, SpectralLine, Unit, Verdict,
};
use std::f64::consts::PI;

const CONTACT_S: f64 = 0.150_827;
const SEPARATION_S: f64 = 0.157_3;
const SLAP_DOWN_S: f64 = 0.216_055;
const IMPACT_VELOCITY_M_S: f64 = 13.288;
const RATE_HZ: f64 = 20_000.0;

/// An analysis with every part filled in; the verdict is "review" because of a clipped channel.
pub(super) fn analysis() -> Analysis {
    Analysis {
        result: result(),
        cask_file: cask_file(),
        curves: LazyCurves::new(Box::new(curves)),
        start_unix_ns: Some(1_700_000_000_000_000_000),
        opened_inputs: vec![],
    }
}

/// The analysis with a strain gauge that takes no part in the motion.
pub(super) fn with_other() -> Analysis {
    let mut analysis = analysis();
    let extreme = |value, time_s| Some(Extreme { value, time_s });
    analysis.result.other_channels = vec![OtherSummary {
        name: "S1".into(),
        unit: "µm/m".into(),
        source: "/daq/s1".into(),
        samples: 30_000,
        sample_rate_hz: RATE_HZ,
        rest: Some(-12.5),
        noise: Some(1.5),
        smallest: extreme(-310.0, 0.2204),
        largest: extreme(902.0, 0.1541),
        strongest_line: Some(SpectralLine { frequency_hz: 95.0, magnitude: 3.1 }),
        findings: vec![IssueCode::Clipped],
        ..OtherSummary::default()
    }];
    let time_s: Vec<f64> = (0..2000).map(|i| 0.14 + f64::from(i) / RATE_HZ).collect();
    analysis.curves.others = vec![OtherCurve {
        channel: "S1".into(),
        unit: "µm/m".into(),
        values: time_s.iter().map(|t| 900.0 * (600.0 * t).sin()).collect(),
        time_s,
        frequency_hz: vec![0.0, 95.0, 190.0],
        magnitude: vec![0.0, 3.1, 0.2],
    }];
    analysis
}

/// An analysis that found nothing: no quantity, no curve, one error.
pub(super) fn without_anything() -> Analysis {
    let mut analysis = analysis();
    let result = &mut analysis.result;
    result.first_impact = FirstImpact::default();
    result.slap_down = SlapDown::default();
    result.k = None;
    result.reconstruction = None;
    result.budget.clear();
    result.model = None;
    result.comparison = None;
    result.events = Events::default();
    result.flight = None;
    result.predictions.clear();
    result.verdict = Verdict::Fail;
    result.quality = vec![Finding {
        message: "no impact was found: no channel exceeds 5 g; check units and sources in the cask file"
            .into(),
        ..DropFinding::NoImpact { least_m_s: 1.0, doubt: None, without_rise: None }.into()
    }];
    result.find_missing();
    *analysis.curves = Curves::default();
    analysis.start_unix_ns = None;
    analysis
}

#[allow(clippy::unnecessary_wraps, reason = "every field that takes it is optional")]
fn estimate(value: f64, u95: f64, unit: &'static str) -> Option<Estimate> {
    Some(Estimate::new(value, u95, unit))
}

/// The first impact with a number, and the second without any.
fn impacts() -> [ImpactTable; 2] {
    let [mut first, second] = [End::First, End::Second].map(ImpactTable::empty);
    first.numbers.crush = estimate(0.0315, 0.0008, "m");
    first.numbers.energy_absorbed = estimate(1.06e5, 2.0e4, "J");
    [first, second]
}

fn result() -> DropResult {
    DropResult {
        schema: "dropcheck.result/1",
        version: "0.1.0",
        program: Some(Program { commit: Some("0123abc"), sha256: Some("89ab".into()), ..Program::current() }),
        command: vec!["analyze".into()],
        analysed: Some("2026-11-24T02:00:00Z".into()),
        amplification: Some(Estimate::new(1.55, 0.03, "1")),
        impacts: impacts(),
        shocks: Vec::new(),
        filters: Vec::new(),
        test: crate::data::TestRecord::default(),
        observed: Vec::new(),
        limits: Vec::new(),
        simulation: Vec::new(),
        calculated: Vec::new(),
        prototype: None,
        keys: serde_json::Value::Null,
        cask_text: "[cask]".into(),
        input: Input {
            recording: "drop-2024-06-11/anf18-test-3.mcap".into(),
            recording_sha256: "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".into(),
            format: RecordingFormat::Mcap,
            reader: None,
            cask: "anf18.toml".into(),
            cask_sha256: "60303ae22b998861bce3b28f33eec1be758a213c86c93c076dbe9f558c11c752".into(),
            rest: None,
            rest_sha256: None,
            simulation: None,
            simulation_sha256: None,
        },
        first_impact: FirstImpact {
            time: estimate(CONTACT_S, 0.000_012, "s"),
            impact_velocity: estimate(IMPACT_VELOCITY_M_S, 0.054, "m/s"),
            duration: estimate(SEPARATION_S - CONTACT_S, 0.000_35, "s"),
            rebound_velocity: estimate(7.425, 0.13, "m/s"),
            angular_velocity: estimate(5.152, 0.031, "rad/s"),
        },
        slap_down: SlapDown {
            time: estimate(SLAP_DOWN_S, 0.000_02, "s"),
            flight_time: estimate(SLAP_DOWN_S - SEPARATION_S, 0.000_36, "s"),
            speed: estimate(20.56, 0.11, "m/s"),
            vertical_velocity: estimate(-20.44, 0.11, "m/s"),
            horizontal_velocity: estimate(2.18, 0.14, "m/s"),
            angle: estimate(-5.04, 0.22, "deg"),
            second_end_height: estimate(0.012, 0.09, "m"),
            local_speed: estimate(20.71, 0.13, "m/s"),
        },
        k: estimate(0.5588, 0.0102, "1"),
        reconstruction: Some(sample_reconstruction::choice()),
        model: Some(model()),
        predictions: predictions(),
        comparison: Some(Comparison {
            predicted: 20.49,
            predicted_u95: 0.19,
            measured: 20.56,
            measured_u95: 0.11,
            difference_percent: 0.34,
            agrees: true,
        }),
        causes: vec![],
        quality: quality(),
        missing: Vec::new(),
        verdict: Verdict::Review,
        events: Events {
            release_s: None,
            fall_end_s: None,
            first_contact: Some(At::exact(CONTACT_S)),
            separation: Some(At::exact(SEPARATION_S)),
            slap_down: Some(At::exact(SLAP_DOWN_S)),
        },
        channels: vec![
            summary("A1", End::First, "/daq/a1.samples"),
            summary("A2", End::Second, "/daq/a2.samples"),
        ],
        other_channels: Vec::new(),
        flight: Some(flight()),
        budget: sample_reconstruction::budget(),
        untested: vec![sample_reconstruction::untested()],
        settings: settings(),
    }
}

fn model() -> ModelChoice {
    let candidate = |rung, model, predicted, u95, difference, consistent| ModelCandidate {
        rung,
        model,
        predicted: Some(predicted),
        u95: Some(u95),
        difference_percent: Some(difference),
        consistent,
    };
    ModelChoice {
        name: BodyModel::Body,
        rung: Rung::Body,
        reason: "the rod predicts 22.76 m/s, 10.7 % above the measurement and beyond both intervals; the \
                 body with its section of 0.792 m lies within them"
            .into(),
        candidates: vec![
            candidate(Rung::Rod, BodyModel::Rod, 22.76, 0.20, -9.7, false),
            candidate(Rung::Body, BodyModel::Body, 20.49, 0.19, 0.34, true),
        ],
    }
}

fn predictions() -> Vec<Prediction> {
    let rows = [
        (BodyModel::Rod, Contact::Rough, 0.0, 19.81, 1.80),
        (BodyModel::Rod, Contact::Rough, 1.0, 25.04, 2.26),
        (BodyModel::Rod, Contact::Smooth, 0.0, 20.32, 0.9),
        (BodyModel::Rod, Contact::Smooth, 1.0, 25.06, 1.2),
        (BodyModel::Body, Contact::Rough, 0.0, 18.02, 1.9),
        (BodyModel::Body, Contact::Rough, 1.0, 22.31, 2.4),
        (BodyModel::Body, Contact::Rough, 0.5588, 20.49, 2.17),
        (BodyModel::Body, Contact::Coulomb(0.4), 0.5588, 20.77, 1.8),
    ];
    rows.map(|(model, contact, k, speed, horizontal): (BodyModel, Contact, f64, f64, f64)| Prediction {
        model,
        contact,
        k,
        slap_down_speed_m_s: Some(speed),
        vertical_velocity_m_s: Some(-(speed * speed - horizontal * horizontal).sqrt()),
        horizontal_velocity_m_s: Some(horizontal),
        angular_velocity_rad_s: 4.0 + 1.8 * k,
        flight_time_s: Some(0.078 - 0.02 * k),
        energy_ratio: Some(0.72 + 0.25 * k),
        slap_down_angle_deg: Some(-4.0 - 1.9 * k),
        first_end_impacts: 1,
        impulse_ratio: 0.41,
        friction_to_stick: 0.4,
        sticks: true,
        regime: FlightRegime::Free,
        cog: CogVelocity::default(),
        closed_form_speed_m_s: None,
    })
    .to_vec()
}

fn quality() -> Vec<Finding> {
    let during = DropPart::FirstImpact;
    let clipped =
        ChannelFinding::Clipped { limit_m_s2: 4903.0, samples: 42, during, lost_m_s: 0.2, takes_step: false };
    vec![
        Finding {
            message: "A1 stands at ±500 g in 42 samples of the first impact; the rebound velocity may read \
                      low by up to 0.2 m/s. Repeat with a range of at least 1000 g, or leave the channel out"
                .into(),
            ..clipped.tag("A1").span(0.152_1, 0.152_4)
        },
        ChannelFinding::OffsetTakenOff { mean_m_s2: 0.31, is_large: false }.tag("A2"),
    ]
}

fn summary(name: &str, end: End, source: &str) -> ChannelSummary {
    ChannelSummary {
        name: name.into(),
        end,
        axis: Axis::Transverse,
        source: source.into(),
        samples: 30_000,
        sample_rate_hz: 100_000.0,
        unit: "g (cask file)".into(),
        offset_m_s2: Some(0.31),
        noise_m_s2: Some(4.2),
        peak_filtered_m_s2: Some(4_930.0),
        peak_raw_m_s2: Some(6_210.0),
        sensor: crate::data::SensorRecord::default(),
        clipped: Vec::new(),
    }
}

fn flight() -> FlightFit {
    let plateau = |channel: &str, step| Plateau {
        channel: channel.into(),
        velocity_step_m_s: step,
        u_m_s: 0.021,
        zero_shift_m_s2: 0.0,
        u_zero_shift_m_s2: 0.0,
        residual_m_s: 0.032,
        slow_residual_m_s: 0.032,
        ringing_m_s: vec![(0.7, -0.4)],
        late_mismatch_m_s: None,
        early_mismatch_m_s: None,
    };
    let score = |modes, drift, bic, residual_m_s| FlightScore {
        modes,
        drift,
        driven: false,
        taken: modes == 1 && !drift,
        bic,
        residual_m_s,
    };
    FlightFit {
        from_s: SEPARATION_S + 0.0005,
        to_s: SLAP_DOWN_S - 0.0005,
        plateaus: vec![plateau("A1", 20.1), plateau("A2", -6.3)],
        modes: vec![Mode { frequency_hz: 95.0, damping: 0.02, amplitude_m_s: 0.9 }],
        drift: false,
        candidates: vec![
            score(1, false, -3120.0, 0.032),
            score(1, true, -3107.0, 0.032),
            score(2, false, -3098.0, 0.032),
            score(0, false, 8123.0, 0.61),
        ],
        strike: None,
        landing: None,
    }
}

fn settings() -> Vec<Setting> {
    let setting = |name: &str, value: &str, origin: &str| Setting {
        name: name.into(),
        value: value.into(),
        origin: origin.into(),
    };
    vec![
        setting("low-pass for the curves", "CFC 180 (−3 dB at 298 Hz)", "default"),
        setting("gravity", "9.81 m/s²", "default"),
        setting("flight window", "157.8 to 215.6 ms", "from the data: 0.5 ms inside the contacts"),
        setting("contact law", "rough", "cask file"),
    ]
}

pub(super) fn cask_file() -> CaskFile {
    let channel = |name: &str, end, source: &str, position_m| ChannelSpec {
        unit: Some(Unit::G),
        full_scale: Some(500.0),
        ..ChannelSpec::new(name, end, source, position_m)
    };
    let cask = Cask {
        name: "ANF-18".into(),
        mass_kg: 4466.0,
        length_m: 5.512,
        height_m: 0.792,
        width_m: Some(0.96),
        cog_m: 2.756,
        inertia_kg_m2: 11_540.0,
        is_body: true,
    };
    let drop = Drop { impact_velocity_m_s: IMPACT_VELOCITY_M_S, ..Drop::from_height(9.0, 15.0 * PI / 180.0) };
    CaskFile {
        path: "anf18.toml".into(),
        sha256: "60303ae22b998861bce3b28f33eec1be758a213c86c93c076dbe9f558c11c752".into(),
        channels: vec![
            channel("A1", End::First, "/daq/a1.samples", 0.15),
            channel("A2", End::Second, "/daq/a2.samples", 5.362),
        ],
        defaults: ["cask.cog_m", "drop.gravity_m_s2", "contact.friction"]
            .map(String::from)
            .into_iter()
            // The sample states the tolerance of its angle, and no other.
            .chain(crate::data::TOLERANCES[1..].iter().map(|t| format!("tolerance.{}", t.key)))
            .collect(),
        ..CaskFile::new(cask, drop, Contact::Rough)
    }
}

fn curves() -> Curves {
    let time_s: Vec<f64> = (0..2000).map(|i| 0.14 + f64::from(i) / RATE_HZ).collect();
    let pulse = |t: f64, from: f64, length: f64, peak: f64| {
        let x = (t - from) / length;
        if (0.0..1.0).contains(&x) { peak * (PI * x).sin() } else { 0.0 }
    };
    let ringing = |t: f64, from: f64, amplitude: f64| {
        let tau = t - from;
        if tau < 0.0 { 0.0 } else { amplitude * (-12.0 * tau).exp() * (2.0 * PI * 95.0 * tau).sin() }
    };
    let first: Vec<f64> = time_s
        .iter()
        .map(|&t| pulse(t, CONTACT_S, SEPARATION_S - CONTACT_S, 5000.0) + ringing(t, CONTACT_S, 500.0))
        .collect();
    let second: Vec<f64> = time_s
        .iter()
        .map(|&t| {
            pulse(t, CONTACT_S, SEPARATION_S - CONTACT_S, -1600.0)
                + ringing(t, CONTACT_S, -450.0)
                + pulse(t, SLAP_DOWN_S, 0.009, 5600.0)
        })
        .collect();
    Curves {
        channels: vec![channel("A1", &time_s, &first), channel("A2", &time_s, &second)],
        motion: Some(motion()),
        others: Vec::new(),
        calculated: Vec::new(),
    }
}

fn channel(name: &str, time_s: &[f64], filtered_m_s2: &[f64]) -> ChannelCurve {
    let mut velocity = -IMPACT_VELOCITY_M_S;
    let velocity_m_s = filtered_m_s2
        .iter()
        .map(|a| {
            velocity += a / RATE_HZ;
            velocity
        })
        .collect();
    let raw = |(i, a): (i32, &f64)| {
        a * (1.0 + 0.2 * (f64::from(i) * 2.3).sin()) + 40.0 * (f64::from(i) * 1.7).sin()
    };
    ChannelCurve {
        channel: name.into(),
        time_s: time_s.to_vec(),
        raw_m_s2: (0..).zip(filtered_m_s2).map(raw).collect(),
        filtered_m_s2: filtered_m_s2.to_vec(),
        velocity_m_s,
    }
}

fn motion() -> MotionCurve {
    let mut motion = MotionCurve::default();
    let (mut angle, mut first_height, mut second_height) = (15.0 * PI / 180.0, 0.06, 1.486);
    for i in 0..1400 {
        let t = 0.146 + f64::from(i) / RATE_HZ;
        let done = ((t - CONTACT_S) / (SEPARATION_S - CONTACT_S)).clamp(0.0, 1.0);
        let omega = 5.15 * done;
        let first = -13.29 + 20.7 * done - 9.81 * (t - SEPARATION_S).max(0.0);
        let second = -13.29 - 6.3 * done - 9.81 * (t - SEPARATION_S).max(0.0);
        angle -= omega / RATE_HZ;
        first_height += first / RATE_HZ;
        second_height += second / RATE_HZ;
        motion.time_s.push(t);
        motion.angle_rad.push(angle);
        motion.angular_velocity_rad_s.push(omega);
        motion.first_end_vertical_m_s.push(first);
        motion.second_end_vertical_m_s.push(second);
        motion.second_end_horizontal_m_s.push(2.18 * done);
        motion.first_end_height_m.push(first_height);
        motion.second_end_height_m.push(second_height);
    }
    motion
}
