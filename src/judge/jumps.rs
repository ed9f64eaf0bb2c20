//! Finds jumps of one channel within a few samples from the first contact to the slap-down: an electric
//! contact makes them, and no force after a recorder's filter.

use crate::data::{At, Axis, ChannelFinding, Events, Finding, Signal};
use crate::numerics::{as_count, as_f64, reduce, robust};
use std::ops::Range;

/// A jump exceeds this share of the channel's peak.
const SHARE_OF_PEAK: f64 = 0.05;
/// It is also this many times the largest step of the samples on either side. Of 40 simulated sound drops
/// none is named; of 120 with a cable that breaks once, repeatedly or permanently, 79.
const ISOLATED_FACTOR: f64 = 8.0;
const AROUND: usize = 12;
/// Share of a jump that remains in the median of as many samples after it: less is a spike.
const LASTING_SHARE: f64 = 0.3;
/// Another channel is struck as well, as all places of a rigid body are, if its step at that time has this
/// share of the jump and is this many times the largest beside it.
const OTHER_SHARE: f64 = 0.1;
const STRUCK_FACTOR: f64 = 1.5;
/// A jump this near to the separation, as a share of the contact, is the end of the contact; so is a stop
/// within the second share.
const RELEASE: f64 = 0.1;
const STOP: f64 = 0.25;
/// A jump within this many samples after the first contact is its beginning.
const ONSET_SAMPLES: f64 = 3.0;
/// A cable that breaks leaves nothing but noise in its channel, which comes within the second share of the
/// change of its new level in this many samples.
const FALL_SAMPLES: usize = 4;
const SETTLED_SHARE: f64 = 0.3;
/// Number of samples in which a recorder's filter rings after the break.
const RING_SAMPLES: usize = 16;
/// Shortest time, s, and fewest samples in which the channel is then still. None of 364 simulated sound beams
/// is so named, and 63 of 115 with a cable that breaks for 1 to 20 ms or permanently.
const STILL_S: f64 = 1e-3;
const LEAST_STILL: usize = 16;
/// Smallest change of a channel by the break, in standard deviations of its noise and as a share of its peak.
const LEAST_CHANGE: f64 = 40.0;
const LEAST_CHANGE_SHARE: f64 = 0.2;
/// Largest noise of a still channel over its noise before the contact, beside the scatter of that many
/// samples.
const STILL_NOISE: f64 = 1.25;
/// The search begins this long before the first contact, and ends this long before the slap-down, s.
const BEFORE_S: f64 = 1e-3;
/// End of the search after the first contact if no slap-down is found, s.
const LONGEST_S: f64 = 0.05;

/// Reports the largest jump of each transverse channel that has one.
pub fn judge_jumps(signals: &[Signal], events: &Events) -> Vec<Finding> {
    let Some(contact_s) = events.first_contact_s() else { return Vec::new() };
    let to_s = events.slap_down_s().map_or(contact_s + LONGEST_S, |struck_s| struck_s - BEFORE_S);
    let across = || signals.iter().filter(|signal| signal.axis == Axis::Transverse);
    let jumps = across().filter_map(|signal| {
        let within = signal.index_from(contact_s - BEFORE_S)..signal.index_from(to_s);
        let others = || across().filter(|other| other.name != signal.name);
        // A stiff end without damping releases within a sample.
        let is_inside = |at_s: f64, share: f64| {
            let is_end =
                |left: At| (at_s - left.time_s).abs() < share * (left.time_s - contact_s) + 2.0 * left.u_s;
            !events.separation.is_some_and(is_end)
        };
        let is_alone = |size, at_s| others().all(|other| !is_struck(other, at_s, size));
        let jump = || {
            let jumps = find_jumps(signal, within.clone(), is_alone);
            // A contact begins and ends once.
            let begins_s = contact_s + ONSET_SAMPLES / signal.sample_rate_hz;
            let is_between = |at_s| at_s > begins_s && is_inside(at_s, RELEASE);
            let is_break = |at: &&usize| jumps.len() > 1 || is_between(signal.time_s(**at));
            let force = &signal.force_m_s2;
            let breaks = jumps.iter().filter(is_break);
            let at = *breaks.max_by(|a, b| step(force, **a).total_cmp(&step(force, **b)))?;
            Some((at, force[at + 1] - force[at]))
        };
        let stops_alone = |at_s| is_inside(at_s, STOP) && others().all(|other| !stops_about(other, at_s));
        let (at, size_m_s2) = jump().or_else(|| first_stop(signal, within.clone(), stops_alone))?;
        let finding = ChannelFinding::Jumps { after_s: signal.time_s(at) - contact_s, size_m_s2 };
        Some(finding.tag(&signal.name).span(signal.time_s(at), signal.time_s(at + 1)))
    });
    jumps.collect()
}

/// Returns the samples before the jumps in a range whose size and time are `alone`.
fn find_jumps(signal: &Signal, within: Range<usize>, alone: impl Fn(f64, f64) -> bool) -> Vec<usize> {
    let force = &signal.force_m_s2;
    let least = SHARE_OF_PEAK * reduce::peak(force);
    let high = steps_with_sides(force, within).filter(|i| step(force, *i) > least);
    let is_jump = |&i: &usize| {
        let level = |samples: Range<usize>| robust::median(&mut force[samples].to_vec());
        let lasting = level(i + 1..i + 1 + AROUND) - level(i + 1 - AROUND..i + 1);
        is_isolated(force, i, ISOLATED_FACTOR)
            && lasting * (force[i + 1] - force[i]).signum() > LASTING_SHARE * step(force, i)
            && !has_lost(signal, (i + 1).saturating_sub(AROUND)..i + AROUND + 1)
            && alone(step(force, i), signal.time_s(i))
    };
    high.filter(is_jump).collect()
}

/// True if a channel also jumps about a time at which another one jumps by `size`.
fn is_struck(signal: &Signal, at_s: f64, size: f64) -> bool {
    let force = &signal.force_m_s2;
    let at = signal.index_from(at_s);
    steps_with_sides(force, at.saturating_sub(1)..at + 2)
        .any(|i| step(force, i) > OTHER_SHARE * size && is_isolated(force, i, STRUCK_FACTOR))
}

/// True if samples of a range are missing or stand at a limit.
fn has_lost(signal: &Signal, range: Range<usize>) -> bool {
    signal.gaps.iter().chain(&signal.clipped).any(|span| span.from < range.end && range.start < span.to)
}

/// Change of a channel after a sample if it falls to a level and stays there with nothing but noise, m/s²;
/// else `None`.
fn stop_m_s2(signal: &Signal, least: f64, i: usize) -> Option<f64> {
    let (force, noise) = (&signal.force_m_s2, signal.noise_m_s2);
    let count = LEAST_STILL.max(as_count(STILL_S * signal.sample_rate_hz));
    let still = force.get(i + RING_SAMPLES..i + RING_SAMPLES + count)?;
    let is_near = |f: &f64| (f - still[0]).abs() < LEAST_CHANGE / 4.0 * noise;
    let is_lost = || has_lost(signal, i.saturating_sub(AROUND)..i + RING_SAMPLES + count);
    if (force[i] - still[0]).abs() < least || !still.iter().all(is_near) || is_lost() {
        return None;
    }
    let level = reduce::sum(still) / as_f64(count);
    let change = level - force[i];
    let mut settling = force[i + FALL_SAMPLES..i + RING_SAMPLES].iter();
    let settles = settling.all(|f| (f - level).abs() < SETTLED_SHARE * change.abs());
    let variance = reduce::sum_by(still, |f| (f - level).powi(2)) / as_f64(count - 1);
    let most = STILL_NOISE * noise * (1.0 + 3.0 / (2.0 * as_f64(count)).sqrt());
    (settles && variance < most.powi(2) && change.abs() > least).then_some(change)
}

/// First sample of a range after which a channel stops, and the change of the channel, m/s².
fn first_stop(signal: &Signal, within: Range<usize>, alone: impl Fn(f64) -> bool) -> Option<(usize, f64)> {
    let least = (LEAST_CHANGE * signal.noise_m_s2).max(LEAST_CHANGE_SHARE * reduce::peak(&signal.force_m_s2));
    let mut stops = within.filter_map(|i| Some((i, stop_m_s2(signal, least, i)?)));
    stops.find(|(i, _)| alone(signal.time_s(*i)))
}

/// True if a channel also stops about a time.
fn stops_about(signal: &Signal, at_s: f64) -> bool {
    let at = signal.index_from(at_s);
    first_stop(signal, at.saturating_sub(2 * AROUND)..at + 2 * AROUND, |_| true).is_some()
}

/// Limits a range to samples with enough neighbours to decide if a step is isolated.
fn steps_with_sides(force: &[f64], range: Range<usize>) -> Range<usize> {
    range.start.max(AROUND)..range.end.min(force.len().saturating_sub(AROUND + 1))
}

fn step(force: &[f64], i: usize) -> f64 {
    (force[i + 1] - force[i]).abs()
}

/// True if the step after a sample is this many times the largest beside it, except the adjacent ones, to
/// which a filter spreads the jump, and except one by which a short break jumps back.
fn is_isolated(force: &[f64], i: usize, times: f64) -> bool {
    let beside = (i - AROUND..i - 1).chain(i + 2..i + AROUND);
    let large: Vec<usize> = beside.filter(|beside| step(force, i) <= times * step(force, *beside)).collect();
    let jump = |i: usize| force[i + 1] - force[i];
    let returns = |at: usize| at.abs_diff(i) > FALL_SAMPLES && -2.0 * jump(at) / jump(i) > 1.0;
    large.is_empty() || large.len() == 1 && returns(large[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;
    use crate::data::example::noise;
    use std::f64::consts::{PI, TAU};

    /// Simulates a contact of 10 ms from 20 ms on with ringing of 200 Hz after it, at 20 kHz, plus `more` at
    /// each time, s.
    fn channel(name: &str, size: f64, more: impl Fn(f64) -> f64) -> Signal {
        let force = |i: u32| {
            let t = f64::from(i) / 2e4 - 0.02;
            let pulse = if (0.0..0.01).contains(&t) { (PI * t / 0.01).sin() } else { 0.0 };
            let rings = if t > 0.0 { 0.3 * (-20.0 * t).exp() * (TAU * 200.0 * t).sin() } else { 0.0 };
            size * (pulse + rings) + noise(i, 1) + more(t)
        };
        Signal { name: name.into(), ..example::signal(2e4, (0..1400).map(force).collect()) }
    }

    fn named(first: &Signal, second: &Signal) -> Vec<Option<String>> {
        named_with(&example::events(0.02, 0.06), first, second)
    }

    fn named_with(events: &Events, first: &Signal, second: &Signal) -> Vec<Option<String>> {
        let found = judge_jumps(&[first.clone(), second.clone()], events);
        found.into_iter().map(|found| found.channel).collect()
    }

    #[test]
    fn a_jump_of_one_channel_alone_is_electrical() {
        let sound = channel("A2", -1500.0, |_| 0.0);
        let alone = vec![Some("A1".to_owned())];
        // The spike of a trigger in the contact, a cable that breaks in the flight.
        let trigger = |t: f64| if t > 0.0043 { 1200.0 * (-(t - 0.0043) / 5e-4).exp() } else { 0.0 };
        assert_eq!(named(&channel("A1", 4000.0, trigger), &sound), alone);
        let cut = |t: f64| if (0.0162..0.03).contains(&t) { 900.0 } else { 0.0 };
        assert_eq!(named(&channel("A1", 4000.0, cut), &sound), alone);
    }

    #[test]
    fn a_break_that_returns_is_electrical_within_a_dozen_samples_and_at_the_contacts_end() {
        let sound = channel("A2", -1500.0, |_| 0.0);
        let between = |from: f64, to: f64| move |t: f64| if (from..to).contains(&t) { 900.0 } else { 0.0 };
        let short = channel("A1", 4000.0, between(0.00411, 0.00451));
        assert_eq!(named(&short, &sound), [Some("A1".to_owned())]);
        // The separation is found where the break ends: a contact ends once.
        let broken = channel("A1", 4000.0, between(0.0162, 0.03));
        let ends =
            |left_s: f64| Events { separation: Some(At::exact(left_s)), ..example::events(0.02, 0.06) };
        assert_eq!(named_with(&ends(0.05), &broken, &sound), [Some("A1".to_owned())]);
        let ended = channel("A1", 4000.0, between(0.0162, 1.0));
        assert_eq!(named_with(&ends(0.03), &ended, &sound), [Some("A1".to_owned())]);
        assert!(named_with(&ends(0.0362), &ended, &sound).is_empty());
        // So does its beginning.
        assert!(named(&channel("A1", 4000.0, between(7.5e-5, 1.0)), &sound).is_empty());
    }

    #[test]
    fn a_channel_that_a_break_leaves_with_its_noise_alone_is_electrical() {
        // A filter spreads the break over some samples, to zero and to a supply rail.
        for level in [0.0, 900.0] {
            let broken = |name: &str| {
                let mut channel = channel(name, 4000.0, |_| 0.0);
                for (f, i) in channel.force_m_s2.iter_mut().zip(0..).skip(496).take(60) {
                    let settles = 1.0 - (-0.7 * f64::from(i - 496)).exp();
                    *f += settles * (level + noise(u32::try_from(i).unwrap_or(0), 4) - *f);
                }
                channel
            };
            let sound = channel("A2", -1500.0, |_| 0.0);
            assert_eq!(named(&broken("A1"), &sound), [Some("A1".to_owned())], "{level}");
            // A change of both channels at once is a body that comes to rest.
            assert!(named(&broken("A1"), &broken("A2")).is_empty(), "{level}");
        }
    }

    #[test]
    fn a_force_a_spike_and_what_both_channels_show_are_none() {
        let sound = channel("A2", -1500.0, |_| 0.0);
        assert!(named(&channel("A1", 4000.0, |_| 0.0), &sound).is_empty());
        let spike = |t: f64| if (0.01621..0.01634).contains(&t) { 900.0 } else { 0.0 };
        assert!(named(&channel("A1", 4000.0, spike), &sound).is_empty());
        let release = |size: f64| move |t: f64| if t > 0.00701 { size } else { 0.0 };
        let both = [("A1", 4000.0, 1200.0), ("A2", -1500.0, -500.0)];
        let [first, second] = both.map(|(name, size, step)| channel(name, size, release(step)));
        assert!(named(&first, &second).is_empty());
    }
}
