//! Samples from the first contact to the slap-down to jumps of one channel from one sample to the next, as an
//! electric contact makes them and no force behind a recorder's filter.

use crate::data::{At, Axis, ChannelFinding, Events, Finding, Signal};
use crate::numerics::{reduce, robust};
use std::ops::Range;

/// A jump is above this share of the channel's peak …
const SHARE_OF_PEAK: f64 = 0.05;
/// … and this many times the largest step of so many samples on either side. Of 40 simulated sound drops
/// none is named; of 120 with a cable that breaks once, by turns or for good, 79.
const ISOLATED: f64 = 8.0;
const AROUND: usize = 12;
/// So much of it is left in the median of as many samples behind it: less is a spike.
const LASTS: f64 = 0.3;
/// Another channel whose step then is of this share of it, and this many times the largest beside it, is
/// struck as well, as all places of a rigid body are.
const ELSEWHERE: f64 = 0.1;
const STRUCK: f64 = 1.5;
/// A jump this near to the separation, over the contact, is the end of the contact.
const LETS_GO: f64 = 0.1;
/// Looked at from so long before the first contact, and until so long before the slap-down, s.
const BEFORE_S: f64 = 1e-3;
/// Where no slap-down is found: so long after the first contact, s.
const LONGEST_S: f64 = 0.05;

/// The largest jump of each transverse channel that has one.
pub fn judge_jumps(signals: &[Signal], events: &Events) -> Vec<Finding> {
    let Some(contact_s) = events.first_contact_s() else { return Vec::new() };
    let to_s = events.slap_down_s().map_or(contact_s + LONGEST_S, |struck_s| struck_s - BEFORE_S);
    let across = || signals.iter().filter(|signal| signal.axis == Axis::Transverse);
    let jumps = across().filter_map(|signal| {
        let within = signal.index_from(contact_s - BEFORE_S)..signal.index_from(to_s);
        let at = largest_jump(signal, within, |size, at_s| {
            !events.separation.is_some_and(|left| is_end(left, at_s, contact_s))
                && across().filter(|o| o.name != signal.name).all(|other| !is_struck(other, at_s, size))
        })?;
        let size_m_s2 = signal.force_m_s2[at + 1] - signal.force_m_s2[at];
        let found = ChannelFinding::Jumps { after_s: signal.time_s(at) - contact_s, size_m_s2 };
        Some(found.on(&signal.name).between(signal.time_s(at), signal.time_s(at + 1)))
    });
    jumps.collect()
}

/// Whether a jump is the end of the contact: a stiff end that keeps nothing lets go within a sample.
fn is_end(left: At, at_s: f64, contact_s: f64) -> bool {
    (at_s - left.time_s).abs() < LETS_GO * (left.time_s - contact_s) + 2.0 * left.u_s
}

/// The sample before the largest jump within a range, of those whose size and time are `alone`.
fn largest_jump(signal: &Signal, within: Range<usize>, alone: impl Fn(f64, f64) -> bool) -> Option<usize> {
    let force = &signal.force_m_s2;
    let least = SHARE_OF_PEAK * reduce::peak(force);
    let high = steps_with_sides(force, within).filter(|i| step(force, *i) > least);
    let is_lost = |i: usize| {
        signal.gaps.iter().chain(&signal.clipped).any(|s| s.from <= i + AROUND && i < s.to + AROUND)
    };
    let is_jump = |&i: &usize| {
        let level = |samples: Range<usize>| robust::median(&mut force[samples].to_vec());
        let left = level(i + 1..i + 1 + AROUND) - level(i + 1 - AROUND..i + 1);
        is_isolated(force, i, ISOLATED)
            && left * (force[i + 1] - force[i]).signum() > LASTS * step(force, i)
            && !is_lost(i)
            && alone(step(force, i), signal.time_s(i))
    };
    high.filter(is_jump).max_by(|one, other| step(force, *one).total_cmp(&step(force, *other)))
}

/// Whether a channel jumps, too, about a time at which another one does by `size`.
fn is_struck(signal: &Signal, at_s: f64, size: f64) -> bool {
    let force = &signal.force_m_s2;
    let at = signal.index_from(at_s);
    steps_with_sides(force, at.saturating_sub(1)..at + 2)
        .any(|i| step(force, i) > ELSEWHERE * size && is_isolated(force, i, STRUCK))
}

/// The samples of a range with so many beside them that a step behind them can be isolated.
fn steps_with_sides(force: &[f64], range: Range<usize>) -> Range<usize> {
    range.start.max(AROUND)..range.end.min(force.len().saturating_sub(AROUND + 1))
}

fn step(force: &[f64], i: usize) -> f64 {
    (force[i + 1] - force[i]).abs()
}

/// Whether the step behind a sample is so many times the largest beside it, without those next to it, which a
/// filter behind the jump spreads it over.
fn is_isolated(force: &[f64], i: usize, times: f64) -> bool {
    let beside = (i - AROUND..i - 1).chain(i + 2..i + AROUND);
    step(force, i) > times * beside.map(|i| step(force, i)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;
    use crate::data::example::noise;
    use std::f64::consts::{PI, TAU};

    /// A contact of 10 ms from 20 ms on and ringing of 200 Hz behind it, at 20 kHz; `more` at each time, s.
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
        let found = judge_jumps(&[first.clone(), second.clone()], &example::events(0.02, 0.06));
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
