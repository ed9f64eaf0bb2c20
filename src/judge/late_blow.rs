//! Finds blows on the cask in the flight and in the first contact that do not come from the target.

use crate::data::{
    ChannelFinding, DropFinding, End, Estimate, Events, Finding, FlightFit, Signal, transverse,
};
use crate::numerics::as_f64;
use crate::numerics::reduce::{block_means, block_size, peak};

/// Smallest gain in the Bayesian information criterion by which a step explains a flight: of 2600 simulated
/// sound drops none has more, but for steps below [`LEAST_STEP`].
const LEAST_GAIN: f64 = 20.0;
/// Smallest step that matters, as a share of v0: a smaller one changes the slap-down speed by less than its
/// interval.
const LEAST_STEP: f64 = 0.01;

/// Rate of the means of the force, Hz: ringing of a sensor's mount is no force.
const RATE_HZ: f64 = 10_000.0;
/// A force pauses below this share of its peak, or below this many standard deviations of the noise.
const PAUSE_SHARE: f64 = 0.01;
const PAUSE_NOISE: f64 = 6.0;
/// A pause lasts at least this share of the contact, and this many means.
const LEAST_PAUSE: f64 = 0.25;
const LEAST_MEANS: usize = 5;
/// After a pause the force returns to at least this share of its peak.
const RETURN_SHARE: f64 = 0.05;

/// True if a step in the flight is large enough to matter. The residual of modes that a prediction cannot
/// include makes steps of at most 0.1 % of v0 in 66 simulated drops of elastic bodies.
pub fn changes_motion(step_m_s: f64, v0_m_s: f64) -> bool {
    step_m_s.abs() > LEAST_STEP * v0_m_s
}

/// Reports a blow within the flight, around which modes and drift were fitted; a small one moves the `speed`
/// at slap-down by less than its half-width.
pub fn judge_late_blow(flight: &FlightFit, v0_m_s: f64, speed: Option<Estimate>) -> Option<Finding> {
    let strike = flight.strike.filter(|s| s.gain > LEAST_GAIN && changes_motion(s.step_m_s, v0_m_s))?;
    let (step_m_s, after_s) = (strike.step_m_s.abs(), strike.time_s - flight.from_s);
    let is_small = speed.is_some_and(|speed| step_m_s < speed.u95);
    let finding = if is_small {
        DropFinding::SmallBlow { step_m_s, after_s }
    } else {
        DropFinding::Blow { step_m_s, after_s }
    };
    Some(Finding::from(finding).span(strike.time_s, strike.time_s))
}

/// Reports a first end on which the force pauses during its contact: it left the target before, and the later
/// force is another blow.
pub fn judge_force_pause(signals: &[Signal], events: &Events) -> Option<Finding> {
    let (contact_s, left_s) = events.first_contact_s().zip(events.separation_s())?;
    let struck = transverse(signals, End::First)?;
    let block = block_size(RATE_HZ, struck.sample_rate_hz);
    let force = struck.force_m_s2.get(struck.index_from(contact_s)..struck.index_from(left_s))?;
    let means = block_means(force, block);
    let limit = (PAUSE_SHARE * peak(&means)).max(PAUSE_NOISE * struck.noise_m_s2);
    let (mut from, mut longest) = (0, 0..0);
    for (i, mean) in means.iter().enumerate() {
        if mean.abs() > limit {
            from = i + 1;
        } else if i + 1 - from > longest.len() {
            longest = from..i + 1;
        }
    }
    let returns = peak(&means[longest.end..]) > RETURN_SHARE * peak(&means);
    let is_long = as_f64(longest.len()) > LEAST_PAUSE * as_f64(means.len()) && longest.len() >= LEAST_MEANS;
    (longest.start > 0 && is_long && returns).then(|| {
        let at_s = |mean: usize| contact_s + as_f64(mean * block) / struck.sample_rate_hz;
        let (from_s, to_s) = (at_s(longest.start), at_s(longest.end));
        let finding = ChannelFinding::ForceRests { from_s: from_s - contact_s, to_s: to_s - contact_s };
        finding.tag(&struck.name).span(from_s, to_s)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, FindingKind, FlightShock, example};
    use std::f64::consts::PI;

    fn flight(step_m_s: f64, gain: f64) -> FlightFit {
        FlightFit {
            strike: Some(FlightShock { time_s: 0.05, step_m_s, gain }),
            ..example::flight(0.02, 0.08, vec![])
        }
    }

    #[test]
    fn a_step_counts_that_is_large_and_beyond_doubt() {
        let said = judge_late_blow(&flight(-0.5, 40.0), 13.3, None).expect("a blow");
        let is_as_given = |after_s: f64| (after_s - 0.03).abs() < 1e-9;
        assert!(
            matches!(said.what, FindingKind::Drop(DropFinding::Blow { after_s, .. }) if is_as_given(after_s))
        );
        assert!(judge_late_blow(&flight(-0.5, 8.0), 13.3, None).is_none());
        assert!(judge_late_blow(&flight(0.1, 40.0), 13.3, None).is_none());
        let speed = Some(Estimate::new(20.0, 0.6, "m/s"));
        let small = judge_late_blow(&flight(-0.5, 40.0), 13.3, speed).expect("a blow");
        assert!(!small.removes(crate::data::ResultPart::Motion), "{small:?}");
    }

    /// Half sines of 4 ms at these times, s, with these peaks.
    fn signal(pulses: &[(f64, f64)]) -> Signal {
        let half_sine = |t: f64, &(from_s, peak): &(f64, f64)| {
            let x = (t - from_s) / 4e-3;
            if (0.0..1.0).contains(&x) { peak * (PI * x).sin() } else { 0.0 }
        };
        let force = |i: u32| pulses.iter().map(|pulse| half_sine(f64::from(i) * 1e-5, pulse)).sum();
        Signal { noise_m_s2: 0.5, ..example::signal(1e5, (0..10_000).map(force).collect()) }
    }

    #[test]
    fn a_force_that_rests_and_comes_again_is_two_contacts() {
        let events = |left_s| Events {
            first_contact: Some(At::exact(0.01)),
            separation: Some(At::exact(left_s)),
            ..Events::default()
        };
        let twice = signal(&[(0.01, 3000.0), (0.022, 400.0)]);
        let found = judge_force_pause(std::slice::from_ref(&twice), &events(0.026)).expect("two contacts");
        let are = |from_s: f64, to_s: f64| (from_s - 4e-3).abs() < 1e-4 && (to_s - 12.1e-3).abs() < 1e-4;
        let FindingKind::Channel(ChannelFinding::ForceRests { from_s, to_s }) = found.what else {
            panic!("{found:?}")
        };
        assert!(are(from_s, to_s), "{}", found.message);
        assert!(judge_force_pause(&[twice], &events(0.014)).is_none(), "one contact");
        // An impact limiter that yields and then bottoms out never releases.
        let staged = signal(&[(0.01, 400.0), (0.0125, 400.0), (0.015, 3000.0)]);
        assert!(judge_force_pause(&[staged], &events(0.019)).is_none());
    }
}
