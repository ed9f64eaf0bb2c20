//! Tests of the judgement of single channels.

use super::*;
use crate::data::{At, Contact, Drop, IssueCode, Plateau, example};

fn cask_file() -> CaskFile {
    let cask = example::cask(4000.0, 5.0, 0.0);
    CaskFile::new(cask, Drop { impact_velocity_m_s: 13.29, ..Drop::from_height(9.0, 0.25) }, Contact::Rough)
}

/// Simulates a half sine of 5 ms from 20 ms on at 10 kHz; white noise of 1 m/s² is stated, but not present.
fn signal(name: &str, end: End, position_m: f64, peak: f64) -> Signal {
    let force = |i: u32| {
        let x = (f64::from(i) - 200.0) / 50.0;
        if (0.0..1.0).contains(&x) { peak * (std::f64::consts::PI * x).sin() } else { 0.0 }
    };
    Signal {
        name: name.into(),
        end,
        position_m,
        noise_m_s2: 1.0,
        noise_spectrum: vec![(10.0, 2e-4), (5000.0, 2e-4)],
        free_fall_s: 0.2,
        ..example::signal(1e4, (0..1000).map(force).collect())
    }
}

fn pair() -> [Signal; 2] {
    [signal("A1", End::First, 0.2, 4000.0), signal("A2", End::Second, 4.8, -1500.0)]
}

fn found(signals: &[Signal]) -> Vec<(IssueCode, Option<String>)> {
    let events = Events { separation: Some(At::exact(0.025)), ..example::events(0.02, 0.09) };
    judge_singly(signals, &events, None, &cask_file()).into_iter().map(|i| (i.code, i.channel)).collect()
}

#[test]
fn sound_channels_are_not_mentioned() {
    assert!(found(&pair()).is_empty());
}

#[test]
fn noise_that_moves_the_velocity_is_named() {
    let mut noisy = pair();
    // White: u² = S/2 (T + T²/T0) = S · 0.0472 s: 0.043 m/s for 0.04, below 0.5 % of 13.29; 0.22 for 1, a
    // note; 0.69 for 10, above 3 %.
    let severity = |noisy: &[Signal]| {
        let events = example::events(0.02, 0.09);
        judge_singly(noisy, &events, None, &cask_file()).first().map(|i| (i.code, i.severity))
    };
    noisy[0].noise_spectrum = vec![(10.0, 0.04), (5000.0, 0.04)];
    assert_eq!(severity(&noisy), None);
    noisy[0].noise_spectrum = vec![(10.0, 1.0), (5000.0, 1.0)];
    assert_eq!(severity(&noisy), Some((IssueCode::Noise, Severity::Note)));
    noisy[0].noise_spectrum = vec![(10.0, 10.0), (5000.0, 10.0)];
    assert_eq!(severity(&noisy), Some((IssueCode::Noise, Severity::Warning)));
    // A plateau known to 0.05 m/s by the flight leaves the noise of the 5 ms of contact: 0.16 m/s.
    let plateau = Plateau { channel: noisy[0].name.clone(), u_m_s: 0.05, ..Plateau::default() };
    let flight = FlightFit { plateaus: vec![plateau], ..FlightFit::default() };
    let events = Events { separation: Some(At::exact(0.025)), ..example::events(0.02, 0.09) };
    let by_flight = judge_noise(&noisy[0], &events, Some(&flight), 13.29).map(|found| found.severity);
    assert_eq!(by_flight, Some(Severity::Note));
}

#[test]
fn what_the_numbers_are_known_to_holds_noise_and_a_coarse_step() {
    let noise =
        ChannelFinding::Noise { noise_m_s2: 30.0, u_m_s: 0.8, length_s: 0.1, severity: Severity::Warning };
    let coarse = ChannelFinding::LowRate { samples: 7.0, pulse_s: 4e-4, off_percent: 1.0, least_hz: 5e4 };
    let severities = |k_u95: f64, speed_u95: f64| {
        let mut found = [noise.clone().tag("A1"), coarse.clone().tag("A1")];
        let (k, speed) = (Estimate::new(0.5, k_u95, "1"), Estimate::new(20.0, speed_u95, "m/s"));
        downgrade_harmless(&mut found, k, Some(speed));
        found.map(|found| found.severity)
    };
    assert_eq!(severities(0.05, 0.5), [Severity::Note, Severity::Note]);
    // 1 % of the step is 0.015 of k, and 0.2 m/s.
    assert_eq!(severities(0.02, 0.5), [Severity::Note, Severity::Warning]);
    assert_eq!(severities(0.05, 0.3), [Severity::Note, Severity::Warning]);
    assert_eq!(severities(0.2, 0.5), [Severity::Warning, Severity::Note]);
    assert_eq!(severities(0.05, 2.5), [Severity::Warning, Severity::Note]);
}

#[test]
fn a_place_that_cannot_be_is_named() {
    let place = |first_m: f64, second_m: f64| {
        let mut signals = pair();
        (signals[0].position_m, signals[1].position_m) = (first_m, second_m);
        found(&signals)
    };
    let position_of = |name: &str| (IssueCode::SensorPosition, Some(name.to_owned()));
    assert!(place(-0.03, 5.04).is_empty());
    assert_eq!(place(-0.2, 4.8), [position_of("A1")]);
    assert_eq!(place(0.2, 480.0), [position_of("A2")]);
    assert_eq!(place(4.8, 0.2), [position_of("A1")]);
    assert_eq!(place(2.7, 4.8), [position_of("A1")]);
}

#[test]
fn a_record_that_begins_in_the_impact_is_named() {
    for (cut, wanted) in [(199, 0), (225, 1)] {
        let mut late = pair().map(|s| s.cut(cut, 1000));
        for s in &mut late {
            // No quiet part remains that shows the noise.
            s.noise_spectrum.clear();
        }
        let mut events =
            Events { first_contact: Some(At::exact(late[0].start_s.max(0.02))), ..Events::default() };
        events.separation = Some(At::exact(0.025));
        let findings = judge_singly(&late, &events, None, &cask_file());
        assert_eq!(findings.iter().filter(|i| i.severity == Severity::Error).count(), wanted, "{findings:?}");
    }
}

#[test]
fn units_taken_for_one_another_are_named() {
    let mut mixed = pair();
    mixed[0].noise_m_s2 *= 9.806_65;
    // Noise alone may differ from sensor to sensor.
    assert!(found(&mixed).is_empty());
    for f in &mut mixed[0].force_m_s2 {
        *f *= 9.806_65;
    }
    assert_eq!(found(&mixed), [(IssueCode::Scale, Some("A1".into()))]);
}
