//! Finds channels that show nothing: unplugged, stuck, or with nothing but noise and hum; and channels that
//! stand at their stop from some time to their end.

use crate::data::{Axis, Channel, ChannelFinding, End, Events, Finding, Signal, of_either};
use crate::numerics::{as_count, reduce, robust};
use rayon::prelude::*;

/// A channel that never deviates by more than this many of its spreads shows nothing: 10⁷ samples of normal
/// noise stay within 5.5, a sine within 1.4.
pub(super) const SILENT_SPREADS: f64 = 8.0;
/// Another channel that deviates by this many spreads proves that there was a signal.
const LOUD_SPREADS: f64 = 50.0;
/// Smallest deviation of a channel, as a share of the largest one: even at the centre of percussion more
/// arrives.
const SHARE: f64 = 1e-3;
/// Number of intervals of which the quietest determines the spread: ringing after the impact is no noise.
const STRETCHES: usize = 20;
/// Samples of an interval that determine its spread, to 5 %.
const SAMPLED: usize = 500;

/// Shortest time, s, and fewest samples for which a channel stands at its stop to its end.
const AT_STOP_S: f64 = 0.01;
const LEAST_AT_STOP: usize = 64;
/// The second end strikes within this time, s, after its slap-down is found.
const STRIKES_S: f64 = 0.02;
/// Those samples lie within this many spreads, plus this share of the level.
const WITHIN_SPREADS: f64 = 6.0;
const WITHIN_SHARE: f64 = 1e-3;
/// Largest share by which a reading exceeds the stop: the level at rest after a drop is far below the impact.
const BEYOND_STOP: f64 = 0.1;

/// Returns the number of samples to keep of a channel that stands at its stop to its end, with the finding:
/// those before, none of a channel beside others of its kind; `all` are the recording's channels.
pub fn judge_at_stop(channel: &Channel, all: &[Channel]) -> Option<(usize, Finding)> {
    let count = channel.samples.len();
    let last = count.checked_sub(LEAST_AT_STOP.max(as_count(AT_STOP_S * channel.sample_rate_hz)))?;
    let end: Vec<f64> = (count - LEAST_AT_STOP..count).map(|i| channel.samples.get(i)).collect();
    let (level, spread) = robust::centre_and_spread(&end);
    let within = WITHIN_SPREADS * spread + WITHIN_SHARE * level.abs();
    let stands = |i: &usize| (channel.samples.get(*i) - level).abs() <= within;
    let from = (0..count).rev().take_while(stands).last().filter(|from| (1..=last).contains(from))?;
    let [low, high] = channel.extremes()?.map(|extreme| extreme.value);
    let is_stop = high.max(-low) < (1.0 + BEYOND_STOP) * level.abs() && level.abs() > SILENT_SPREADS * within;
    let is_beside_others = all.iter().filter(|o| (o.end, o.axis) == (channel.end, channel.axis)).count() > 1;
    let finding = ChannelFinding::AtStop { level_m_s2: level * channel.scale_m_s2, is_beside_others };
    let [from_s, to_s] = [from, count - 1].map(|i| channel.time_s(i));
    let kept = if is_beside_others { 0 } else { from };
    is_stop.then(|| (kept, finding.tag(&channel.name).span(from_s, to_s)))
}

/// Reports each transverse channel of the second end that reads nothing but noise as that end strikes, while
/// another channel is struck.
pub fn judge_quiet(signals: &[Signal], events: &Events) -> Vec<Finding> {
    let times = events.first_contact_s().zip(events.slap_down_s());
    let Some((contact_s, struck_s)) = times else { return Vec::new() };
    let range = |s: &Signal| {
        let to_s = struck_s + STRIKES_S;
        let within = s.force_m_s2.get(s.index_from(struck_s)..s.index_from(to_s)).unwrap_or_default();
        let (low, high) = reduce::extremes(within, within.first().copied().unwrap_or_default());
        (within.len() >= LEAST_AT_STOP && !s.overlaps(&s.gaps, struck_s, to_s)).then_some(high - low)
    };
    let across = || signals.iter().filter(|s| s.axis == Axis::Transverse);
    let others_m_s2 = across().filter_map(range).fold(0.0, f64::max);
    let is_quiet = |s: &&Signal| {
        let is_struck = s.end == End::Second && others_m_s2 > LOUD_SPREADS * s.noise_m_s2;
        is_struck && range(s).is_some_and(|range| range < 2.0 * SILENT_SPREADS * s.noise_m_s2)
    };
    let finding = ChannelFinding::Quiet { after_s: struck_s - contact_s, others_m_s2 };
    across().filter(is_quiet).map(|s| finding.clone().tag(&s.name)).collect()
}

/// Largest deviation of a channel from its median, m/s², and the spread of its samples where it is quietest,
/// m/s².
struct Excursion {
    farthest: f64,
    spread: f64,
}

/// Names each channel that stays within its noise over the whole recording while another does not.
pub fn judge_silent(channels: &[&Channel]) -> Vec<Finding> {
    let excursion = |c: &&Channel| of_either!(&c.samples, v => measure_excursion(v, c.scale_m_s2.abs()));
    let excursions: Vec<Excursion> = channels.par_iter().map(excursion).collect();
    let is_loud = |r: &Excursion| r.farthest > LOUD_SPREADS * r.spread && r.farthest > 0.0;
    let loudest = excursions.iter().filter(|r| is_loud(r)).map(|r| r.farthest).fold(0.0, f64::max);
    let is_silent = |r: &Excursion| r.farthest <= SILENT_SPREADS * r.spread || r.farthest < SHARE * loudest;
    let all: Vec<_> = channels.iter().zip(&excursions).collect();
    let (silent, heard): (Vec<_>, Vec<_>) = all.into_iter().partition(|(_, r)| loudest > 0.0 && is_silent(r));
    let is_beside = |channel: &Channel| {
        channel.axis == Axis::Axial
            || heard.iter().any(|(o, _)| (o.end, o.axis) == (channel.end, channel.axis))
    };
    let judge_dead = |(channel, r): &(&&Channel, &Excursion)| {
        let finding =
            ChannelFinding::Dead { farthest_m_s2: r.farthest, is_beside_others: is_beside(channel) };
        finding.tag(&channel.name)
    };
    silent.iter().map(judge_dead).collect()
}

fn measure_excursion<T: Copy + Into<f64>>(samples: &[T], scale: f64) -> Excursion {
    let value = |x: &T| -> f64 { (*x).into() };
    let stretches: Vec<Vec<f64>> = samples
        .chunks((samples.len() / STRETCHES).max(1))
        .map(|part| {
            let every = (part.len() / SAMPLED).max(1);
            part.iter().step_by(every).map(value).filter(|x| x.is_finite()).collect()
        })
        .filter(|part: &Vec<f64>| part.len() >= 8)
        .collect();
    let middle = robust::median(&mut stretches.concat());
    let spread = stretches.iter().map(|part| robust::spread(part)).fold(f64::INFINITY, f64::min);
    // Running extremes replace distances: comparisons alone keep up with the reading.
    let (low, high) = reduce::extremes(samples, middle);
    if stretches.is_empty() {
        return Excursion { farthest: 0.0, spread: 0.0 };
    }
    Excursion { farthest: scale * (high - middle).max(middle - low), spread: scale * spread }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{ResultPart, example};

    fn channel(name: &str, sample: impl Fn(u32) -> f64) -> Channel {
        Channel {
            name: name.into(),
            axis: Axis::Axial,
            scale_m_s2: 9.806_65,
            unit: "g".into(),
            ..example::channel((0..20_000).map(sample).collect())
        }
    }

    /// Uniform noise of ± 0.5.
    fn noise(i: u32) -> f64 {
        f64::from(i.wrapping_mul(1_664_525).wrapping_add(1_013_904_223) >> 8) / f64::from(1_u32 << 24) - 0.5
    }

    fn pulse(size: f64) -> impl Fn(u32) -> f64 {
        move |i| noise(i) + if (5000..5050).contains(&i) { size } else { 0.0 }
    }

    fn silent(beside: &Channel) -> Vec<Option<String>> {
        judge_silent(&[&channel("A1", pulse(300.0)), beside]).into_iter().map(|i| i.channel).collect()
    }

    #[test]
    fn noise_hum_and_a_rail_are_dead_on_any_axis() {
        let dead = [Some("A2".to_owned())];
        assert_eq!(silent(&channel("A2", noise)), dead);
        assert_eq!(silent(&channel("A2", |_| 500.0)), dead);
        assert_eq!(silent(&channel("A2", |_| 0.0)), dead);
        assert_eq!(silent(&channel("A2", |_| f64::NAN)), dead);
        assert_eq!(silent(&channel("A2", |i| 4.0 * (f64::from(i) * 0.0314).sin() + noise(i))), dead);
    }

    #[test]
    fn a_dead_channel_beside_others_of_its_end_is_left_out() {
        let takes_motion = |first_axis: Axis, second_axis: Axis| {
            let struck = Channel { axis: first_axis, ..channel("A1", pulse(300.0)) };
            let dead = Channel { axis: second_axis, ..channel("A2", noise) };
            judge_silent(&[&struck, &dead]).iter().any(|found| found.removes(ResultPart::Motion))
        };
        assert!(!takes_motion(Axis::Transverse, Axis::Transverse));
        assert!(!takes_motion(Axis::Transverse, Axis::Axial));
        assert!(takes_motion(Axis::Axial, Axis::Transverse));
    }

    #[test]
    fn a_channel_that_stands_at_its_stop_to_the_end_is_torn() {
        let torn_at = |end: End, level: f64, until: u32| {
            let reads = move |i: u32| {
                if (6000..until).contains(&i) { level + example::noise(i, 5) } else { pulse(300.0)(i) }
            };
            let all = [channel("A1", pulse(300.0)), Channel { end, ..channel("A2", reads) }];
            judge_at_stop(&all[1], &all).map(|(kept, _)| kept)
        };
        let torn = |level: f64, until: u32| torn_at(End::Second, level, until);
        assert_eq!(torn(-320.0, 20_000), Some(6000));
        // Nothing remains of a channel beside another of its end and axis.
        assert_eq!(torn_at(End::First, -320.0, 20_000), Some(0));
        // None of these is a stop: a plateau that ends, rest after a drop, and a level below other readings
        // of the channel.
        assert_eq!(
            [(320.0, 19_000), (10.0, 20_000), (250.0, 20_000)].map(|(level, until)| torn(level, until)),
            [None; 3]
        );
    }

    #[test]
    fn a_second_end_that_reads_its_noise_as_it_strikes_is_named() {
        let signal = |name: &str, end: End, struck_m_s2: f64| {
            let force = |i: u32| noise(i) + if (1200..1230).contains(&i) { struck_m_s2 } else { 0.0 };
            let signal = example::signal(2e4, (0..2000).map(force).collect());
            Signal { name: name.into(), end, noise_m_s2: 0.3, ..signal }
        };
        let named = |first_m_s2: f64, second_m_s2: f64| {
            let signals = [signal("A1", End::First, first_m_s2), signal("A2", End::Second, second_m_s2)];
            let found = judge_quiet(&signals, &example::events(0.02, 0.06));
            found.into_iter().filter_map(|finding| finding.channel).collect::<Vec<String>>()
        };
        assert_eq!(named(300.0, 0.0), ["A2"]);
        // The first end may read nothing at its centre of percussion, and a quiet record names nobody.
        assert!(named(300.0, 900.0).is_empty() && named(0.0, 900.0).is_empty() && named(0.0, 0.0).is_empty());
    }

    #[test]
    fn ringing_through_most_of_a_record_is_not_noise() {
        let rings = |i: u32| noise(i) + if i > 3000 { 200.0 * (f64::from(i) * 0.06).sin() } else { 0.0 };
        assert!(silent(&channel("A2", rings)).is_empty());
        let both = [&channel("A1", rings), &channel("A2", noise)];
        assert_eq!(judge_silent(&both).len(), 1);
    }

    #[test]
    fn a_weak_answer_is_not_dead_and_a_quiet_record_names_nobody() {
        assert!(silent(&channel("A2", pulse(6.0))).is_empty());
        assert!(judge_silent(&[&channel("A1", noise), &channel("A2", noise)]).is_empty());
        assert!(judge_silent(&[]).is_empty());
    }
}
