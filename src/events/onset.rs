//! Finds the beginning of a pulse, more finely than the sampling.

use crate::data::{At, CoarseEvent, End, Signal, transverse};
use crate::numerics::{as_count, as_f64, reduce, robust};
use std::borrow::Cow;

/// The foot of a pulse is this share of its peak, or the noise if that is higher.
const FOOT: f64 = 0.02;
/// The foot stands this many times above the ringing in the flight, but at most at this share of the peak.
const ABOVE_RINGING: f64 = 1.2;
const HIGHEST_FOOT: f64 = 0.3;
/// The rise is followed up to this share of the peak to extrapolate it to zero.
const SHOULDER: f64 = 0.3;
/// If noise lifts the foot above this share of the peak, the foot is sought on means: converters with a range
/// for a slap-down of hundreds of g show a first impact of 20 g in their noise.
const HIGHEST_NOISE: f64 = 0.1;
/// A signal exceeds the noise if it is this many standard deviations above zero.
pub(super) const NOISE_FACTOR: f64 = 6.0;
/// If the velocity changed by this share of the pulse's step before its rise, an earlier stage of the pulse
/// did so.
const EARLIER_STAGE: f64 = 0.02;
/// Such a share for the second impact, before which a flight rings and drifts.
const SECOND_STAGE: f64 = 0.2;
/// The velocity shows a rise between these shares of its change up to the middle of the pulse.
const LEAST_GIVEN: f64 = 0.04;
const MOST_GIVEN: f64 = 0.4;
/// Ringing shifts a rise by this many times the time that it needs to give as much velocity: in 600 drawn
/// pulses u then holds.
const SHIFT_FACTOR: f64 = 3.0;
/// Fewest samples before the rise that show the ringing.
const FEWEST_CALM: usize = 16;
/// If no free fall shows the offset, it is the level of the record's first millisecond, s.
const LEVEL_S: f64 = 1e-3;
/// That level is used only up to this share of the peak, the largest offset of accelerometers; the second
/// number is its coverage in standard uncertainties.
const MOST_LEVEL: f64 = 0.05;
const LEVEL_COVERAGE: f64 = 4.0;
/// A calm signal departs from the flight if it exceeds the flight's largest value by this factor.
const DEPARTURE_FACTOR: f64 = 2.0;
/// The departure begins after the last pause of this length, s.
const PAUSE_S: f64 = 1e-3;
/// Width of the means that R's velocity is compared by, s: two periods of an 80 Hz mode, less than a flight
/// from 5°. A cask shorter than 4 m, a model perhaps, rings and turns faster in proportion.
const WIDTH_S: f64 = 0.025;
const WIDTH_S_PER_M: f64 = WIDTH_S / 4.0;
/// The means are compared this often, s: a hundredth of the stretch in which the onset is then sought.
const BLOCK_S: f64 = 1e-4;
/// R strikes where its velocity change over the width reaches this share of the largest in the record.
const SHARE: f64 = 0.5;

/// Width of the means that compare R's velocity in a cask of `length_m`, s.
fn width_s(length_m: f64) -> f64 {
    WIDTH_S.min(WIDTH_S_PER_M * length_m)
}

/// First contact of L and its standard uncertainty, s; from R alone if L has no channel.
pub fn first_contact(signals: &[Signal], coarse: &CoarseEvent) -> Option<At> {
    let signal = transverse(signals, End::First).or_else(|| transverse(signals, End::Second))?;
    let from = signal.index_from(coarse.near_s - 0.2 * coarse.spread_s);
    let stretch = from..signal.index_from(coarse.near_s + 1.2 * coarse.spread_s);
    match signal.end {
        End::First => first_rise(remove_level(signal), stretch, coarse.velocity_step_m_s),
        End::Second => first_deviation(signal, stretch),
    }
}

/// The signal without its offset, if the record begins too shortly before the contact for its free fall to
/// show one, and the standard uncertainty of that offset, m/s²: an offset that accumulates before the rise
/// would look like a stage of the contact.
fn remove_level(signal: &Signal) -> (Cow<'_, Signal>, f64) {
    let first = &signal.force_m_s2[..signal.index_from(signal.start_s + LEVEL_S)];
    if signal.free_fall_s > 0.0 || first.is_empty() {
        return (Cow::Borrowed(signal), 0.0);
    }
    let (level_m_s2, spread_m_s2) = robust::centre_and_spread(first);
    if level_m_s2.abs() > MOST_LEVEL * reduce::peak(&signal.force_m_s2) {
        return (Cow::Borrowed(signal), 0.0);
    }
    let force_m_s2 = signal.force_m_s2.iter().map(|force| force - level_m_s2).collect();
    (Cow::Owned(Signal { force_m_s2, ..signal.clone() }), spread_m_s2 / as_f64(first.len()).sqrt())
}

/// The first rise of a pulse that changes the velocity by `step_m_s`, of either sign, without ringing before
/// it. A layer that yields far below the peak and recovers has struck before the rise to the peak.
fn first_rise(
    (signal, u_level_m_s2): (Cow<'_, Signal>, f64),
    stretch: std::ops::Range<usize>,
    step_m_s: f64,
) -> Option<At> {
    let (signal, sign) = (&*signal, step_m_s.signum());
    let found = onset(signal, stretch.clone(), sign, Rise::First, 0.0)?.at;
    // The remainder of an offset that noise hid accumulates too.
    let open_m_s = LEVEL_COVERAGE * u_level_m_s2 * (found.time_s - signal.time_s(stretch.start));
    let least_m_s = sign * (EARLIER_STAGE * step_m_s.abs()).max(open_m_s);
    Some(first_stage(signal, stretch.start, found, least_m_s, 0.0))
}

/// The rise that was found, or the earliest one from `from` on before which the velocity has not changed by
/// `least_m_s`, in its direction. Before it the ringing is at most `ringing_m_s2`.
fn first_stage(signal: &Signal, from: usize, mut found: At, least_m_s: f64, ringing_m_s2: f64) -> At {
    let sign = least_m_s.signum();
    loop {
        let before = from..signal.index_from(found.time_s);
        let mut gained = 0.0;
        let Some(force) = signal.force_m_s2.get(before.clone()) else { return found };
        let running = force.iter().map(|force| {
            gained += sign * force / signal.sample_rate_hz;
            gained
        });
        let gained_m_s: Vec<f64> = running.collect();
        let all_m_s = gained_m_s.last().copied().filter(|all_m_s| *all_m_s > least_m_s.abs());
        let Some(all_m_s) = all_m_s else { return found };
        let earlier = onset(signal, before, sign, Rise::First, ringing_m_s2);
        let earlier = earlier.filter(|e| e.border == Border::Clear && e.at.time_s < found.time_s);
        let Some(OnsetFound { at: earlier, .. }) = earlier else {
            // The noise hides where that began.
            let begun = gained_m_s.iter().position(|gained_m_s| *gained_m_s > 0.1 * all_m_s).unwrap_or(0);
            let open_s = found.time_s - signal.time_s(from + begun);
            return At { u_s: found.u_s.hypot(open_s / 3.0_f64.sqrt()), ..found };
        };
        found = earlier;
    }
}

/// Time at which a signal first leaves its noise, to either side, and its standard uncertainty, s: the far
/// end responds by bending first, which may be opposite to the rigid body's rotation.
fn first_deviation(signal: &Signal, stretch: std::ops::Range<usize>) -> Option<At> {
    let from = stretch.start;
    let force = signal.force_m_s2.get(stretch)?;
    let foot = (FOOT * reduce::peak(force)).max(NOISE_FACTOR * signal.noise_m_s2);
    let first = force.iter().position(|f| f.abs() >= foot)?;
    Some(At { time_s: signal.time_s(from + first), u_s: 0.5 / signal.sample_rate_hz })
}

/// First contact of R on its signal between two times and its standard uncertainty, s; `None` if the record
/// holds none.
///
/// Ringing of a cask of `length_m` has no mean over 25 ms, but an impact of R has: the means before and after
/// each time are compared, and the largest difference, if above `least_change_m_s`, is the slap-down. On
/// signals that still ring the rise is sought backwards from the pulse's peak; on signals without ringing,
/// except for `calm_m_s2` that the flight shows, the first rise beyond that is used.
pub fn slap_down(
    signal: &Signal,
    length_m: f64,
    between_s: std::ops::Range<f64>,
    least_change_m_s: f64,
    calm_m_s2: Option<f64>,
) -> Option<At> {
    let width_s = width_s(length_m);
    let start = signal.index_from(between_s.start - width_s);
    let end = signal.index_from(between_s.end + width_s);
    let force = signal.force_m_s2.get(start..end)?;
    let [block, width] = [BLOCK_S, width_s].map(|s| as_count(s * signal.sample_rate_hz).max(1));
    let blocks = (width / block).max(1);
    let sums = velocity_sums(force, block, 1.0 / signal.sample_rate_hz);
    let last_sum = sums.len() - 1;
    let mean = |a: usize, b: usize| (sums[b] - sums[a]) / as_f64((b - a).max(1) * block);
    let change = |i: usize| mean(i, (i + blocks).min(last_sum)) - mean(i.saturating_sub(blocks), i);
    let first = (signal.index_from(between_s.start).saturating_sub(start) / block).max(1);
    // A mean over less than a third of the width is meaningless: R's pulse must be in the record.
    let last = (signal.index_from(between_s.end).saturating_sub(start) / block)
        .min(last_sum.saturating_sub(blocks / 3));
    let largest = (first..last).map(change).fold(0.0, f64::max);
    if largest < least_change_m_s {
        return None;
    }
    // The first hump that reaches the share, followed to its top: the middle of the pulse.
    let crossing = (first..last).find(|&i| change(i) >= SHARE * largest)?;
    let hump = crossing..(crossing + blocks).min(last);
    let middle = start + block * hump.max_by(|&a, &b| change(a).total_cmp(&change(b)))?;
    let (earliest, reach) = (start + first * block, (width * 3 / 5).max(1));
    let to = (middle + width / 2).min(signal.force_m_s2.len());
    let (rise, left_m_s2) = calm_m_s2.map_or((Rise::BeforePeak, 0.0), |left_m_s2| (Rise::First, left_m_s2));
    // A pulse longer than the width has its rise before the stretch.
    let mut from = middle.saturating_sub(reach).max(earliest);
    loop {
        let OnsetFound { at, border } = onset(signal, from..to, 1.0, rise, left_m_s2)?;
        if border == Border::Clear && calm_m_s2.is_some() {
            // A sensor may ring higher behind the pulse than in it.
            let from = from.saturating_sub(reach).max(earliest);
            let found = first_stage(signal, from, at, SECOND_STAGE * largest, left_m_s2);
            return Some(refine_by_velocity(signal, earliest, found, middle));
        }
        // Persistent ringing has a foot anywhere.
        if calm_m_s2.is_none() && border != Border::Shoulder {
            return Some(at);
        }
        if from == earliest {
            return Some(At { u_s: at.u_s.hypot(width_s), ..at });
        }
        from = from.saturating_sub(reach).max(earliest);
    }
}

/// Compares the onset `by_force` with the velocity that the pulse has given up to its `middle` on the same
/// signal: ringing hides the foot of a slow rise, but gives no velocity.
///
/// If the force grows with the n-th power of the time, a share of the velocity, twice and four times that
/// share are reached after times in the ratio of q = 2^(1/(n + 1)): between a step, n = 0, and a line, n = 1.
fn refine_by_velocity(signal: &Signal, from: usize, by_force: At, middle: usize) -> At {
    let Some(force) = signal.force_m_s2.get(from..middle) else { return by_force };
    let calm = signal.index_from(by_force.time_s).saturating_sub(from) * 2 / 3;
    if calm < FEWEST_CALM || calm > force.len() {
        return by_force;
    }
    let level = reduce::sum(&force[..calm]) / as_f64(calm);
    let add = |sum: &mut f64, f: &f64| {
        *sum += f - level;
        Some(*sum)
    };
    let velocities: Vec<f64> = force.iter().scan(0.0, add).collect();
    let gained = velocities[velocities.len() - 1];
    let rings = reduce::peak(&velocities[..calm]);
    let least = (LEAST_GIVEN * gained).max(ABOVE_RINGING * rings);
    if least > MOST_GIVEN * gained {
        return by_force;
    }
    let reached = |share: f64| as_f64(velocities.iter().rposition(|v| *v < share).map_or(0, |last| last + 1));
    let [first, second, fourth] = [1.0, 2.0, 4.0].map(|times| reached(times * least));
    let rise = (second - first).max(1.0);
    let begun = |q: f64| signal.time_s(from) + (first - rise / (q - 1.0)) / signal.sample_rate_hz;
    let (earliest_s, latest_s) = (begun(std::f64::consts::SQRT_2), begun(2.0));
    if by_force.time_s - by_force.u_s < latest_s {
        // Ringing may look like a foot.
        let may_ring = least > LEAST_GIVEN * gained;
        let early_s = if may_ring { (earliest_s - by_force.time_s).max(0.0) } else { 0.0 };
        return At { u_s: by_force.u_s.hypot(early_s / 3.0_f64.sqrt()), ..by_force };
    }
    let time_s = if least < MOST_GIVEN / 4.0 * gained {
        begun((fourth - second) / rise).clamp(earliest_s, latest_s)
    } else {
        earliest_s.midpoint(latest_s)
    };
    let shifted_s = SHIFT_FACTOR * rise * rings / least / signal.sample_rate_hz;
    let u_s = ((latest_s - earliest_s) / 12.0_f64.sqrt()).hypot(shifted_s);
    At { time_s, u_s: u_s.max(by_force.u_s) }
}

/// Slap-down as the beginning of the movement that a calm signal shows without a pause up to the rise that
/// was found: when a body of `length_m` bends, the sensors near a corner on the target first move in the
/// opposite direction.
///
/// From `from_s` on the signal is known to be calm, except for `calm_m_s2`. Movement without a pause for
/// longer than the width of the means is ringing.
pub fn departure(signal: &Signal, length_m: f64, struck: At, from_s: f64, calm_m_s2: f64) -> At {
    let rate_hz = signal.sample_rate_hz;
    let width_s = width_s(length_m);
    let earliest_s = struck.time_s - width_s;
    // A long flight rings less in its last quarter than where it was fitted.
    let quarter_s = ((earliest_s - from_s) / 4.0).max(width_s);
    let [before, after] = [earliest_s - quarter_s, earliest_s].map(|time_s| signal.index_from(time_s));
    let is_flight = earliest_s - quarter_s > from_s;
    let shown_m_s2 = signal.force_m_s2.get(before..after).filter(|_| is_flight).map(reduce::peak);
    let calm_m_s2 = shown_m_s2.map_or(calm_m_s2, |shown_m_s2| shown_m_s2.min(calm_m_s2));
    let level = (NOISE_FACTOR * signal.noise_m_s2).max(DEPARTURE_FACTOR * calm_m_s2);
    let [from, to] = [from_s, struck.time_s].map(|time_s| signal.index_from(time_s));
    let Some(force) = signal.force_m_s2.get(from..to) else { return struck };
    let pause = as_count(PAUSE_S * rate_hz).max(2);
    let beyond = (0..force.len()).rev().filter(|&i| force[i].abs() > level);
    let mut first = force.len();
    for i in beyond {
        if first - i > pause {
            break;
        }
        first = i;
    }
    let doubled = (first..force.len()).find(|&i| force[i].abs() > 2.0 * level).unwrap_or(first);
    let rise_s = as_f64((doubled - first).clamp(1, pause)) / rate_hz;
    let time_s = signal.time_s(from + first) - rise_s / 2.0;
    let is_earlier = struck.time_s - time_s > 2.0 * struck.u_s;
    if is_earlier && time_s > earliest_s { At { time_s, u_s: rise_s / 2.0 } } else { struck }
}

/// Slap-down whose pulse continues to the end of the record: the movement of a calm signal without a pause
/// until then, if it changes the velocity by `least_change_m_s`.
pub fn cut_short(
    signal: &Signal,
    length_m: f64,
    from_s: f64,
    calm_m_s2: f64,
    least_change_m_s: f64,
) -> Option<At> {
    let end = At { time_s: signal.end_s(), u_s: 0.0 };
    let found = departure(signal, length_m, end, from_s, calm_m_s2);
    let pulse = signal.force_m_s2.get(signal.index_from(found.time_s)..)?;
    let change_m_s = reduce::sum(pulse) / signal.sample_rate_hz;
    (found != end && change_m_s > least_change_m_s).then_some(found)
}

/// Rise of a stretch that begins the pulse.
#[derive(Clone, Copy, PartialEq)]
enum Rise {
    /// The first one past the shoulder.
    First,
    /// The one that leads to the highest peak.
    BeforePeak,
}

/// Level of the force at the beginning of the stretch.
#[derive(Clone, Copy, PartialEq)]
enum Border {
    /// The force is still low: the rise lies within the stretch.
    Clear,
    /// More than the foot of the pulse, so that it may have begun before.
    Foot,
    /// More than its shoulder: it has begun before.
    Shoulder,
}

/// Beginning of a pulse in a stretch, and the level at the beginning of the stretch.
struct OnsetFound {
    at: At,
    border: Border,
}

/// Time at which the pulse in a stretch of samples leaves zero: the zero of a line through its rise from foot
/// to shoulder. The foot stands above the ringing of at most `ringing_m_s2`.
fn onset(
    signal: &Signal,
    stretch: std::ops::Range<usize>,
    sign: f64,
    rise: Rise,
    ringing_m_s2: f64,
) -> Option<OnsetFound> {
    let from = stretch.start;
    let sampled = signal.force_m_s2.get(stretch)?;
    let peak_of = |force: &[f64]| force.iter().fold(0.0_f64, |m, f| m.max(sign * f));
    let (noise, largest) = (NOISE_FACTOR * signal.noise_m_s2, peak_of(sampled));
    let calm = reduce::average_noise(sampled, noise, HIGHEST_NOISE * largest, largest);
    let width = calm.as_ref().map_or(1, |(_, width)| *width);
    let force = calm.as_ref().map_or(sampled, |(means, _)| &means[..]);
    let peak = peak_of(force);
    let foot = (FOOT * peak).max(noise / as_f64(width).sqrt());
    if peak <= 2.0 * foot {
        return None;
    }
    let foot = foot.max((ABOVE_RINGING * ringing_m_s2).min(HIGHEST_FOOT * peak));
    let shoulder = (SHOULDER * peak).max(2.0 * foot);
    // The rise reaches from the last sample below the foot to the first one past the shoulder.
    let high = match rise {
        Rise::First => force.iter().position(|f| sign * f >= shoulder)?,
        Rise::BeforePeak => {
            let at_peak = force.iter().position(|f| sign * f >= peak)?;
            (0..=at_peak).rev().find(|&i| sign * force[i] < shoulder).map_or(0, |i| i + 1)
        }
    };
    let low = (0..high).rev().find(|&i| sign * force[i] < foot).map_or(0, |i| i + 1);
    let crossing = interpolate(force, low, sign * foot);
    let points: Vec<(f64, f64)> = (low..=high).map(|i| (as_f64(i), sign * force[i])).collect();
    let extrapolated = zero_of_line(&points).unwrap_or(crossing);
    // If a rise is steeper than the sampling, or bends, the zero of the line lies past the crossing or far
    // before it. If the first stage yields, a line through the whole rise meets zero far too early: a
    // straight rise takes as long to the foot as from there to twice the foot.
    let doubled = (low..=high).find(|&i| sign * force[i] >= 2.0 * foot).map_or(crossing, as_f64);
    let reach = 2.0 * (doubled - crossing).max(1.0);
    let position = extrapolated.clamp((crossing - reach).max(0.0), crossing);
    // A rise that begins slowly may be a foot that another channel does not show: its upper half alone meets
    // zero later.
    let upper: Vec<(f64, f64)> = points.into_iter().filter(|point| point.1 >= shoulder / 2.0).collect();
    let steep = zero_of_line(&upper).map_or(0.0, |zero| zero.min(as_f64(high)) - position);
    let u_s =
        ((crossing - position).max(steep).max(0.5 * as_f64(width)) / 3.0_f64.sqrt()) / signal.sample_rate_hz;
    let border = match low {
        0 if sign * force[0] >= shoulder => Border::Shoulder,
        0 if sign * force[0] >= foot => Border::Foot,
        _ => Border::Clear,
    };
    Some(OnsetFound {
        at: At { time_s: signal.time_s(from) + position / signal.sample_rate_hz, u_s },
        border,
    })
}

/// Sums of the velocity's samples before each whole block; one more than the number of whole blocks.
fn velocity_sums(force: &[f64], block: usize, step_s: f64) -> Vec<f64> {
    let (mut velocity_m_s, mut sum) = (0.0, 0.0);
    let weights: Vec<f64> = (1..=block).rev().map(as_f64).collect();
    let mut sums = vec![0.0];
    sums.extend(force.chunks_exact(block).map(|chunk| {
        // The sum over the block of v + f_0 h + … + f_i h follows from the weights, without the velocity of
        // each sample.
        sum += velocity_m_s * as_f64(block) + reduce::dot(chunk, &weights) * step_s;
        velocity_m_s += reduce::sum(chunk) * step_s;
        sum
    }));
    sums
}

/// Position between sample `index − 1` and `index` at which the force crosses `level`, in samples.
fn interpolate(force: &[f64], index: usize, level: f64) -> f64 {
    if index == 0 {
        return 0.0;
    }
    let (a, b) = (force[index - 1], force[index]);
    let share = if (b - a).abs() > 0.0 { ((level - a) / (b - a)).clamp(0.0, 1.0) } else { 1.0 };
    as_f64(index) - 1.0 + share
}

/// Zero of the least-squares line through points; `None` for fewer than two or a line that does not rise.
fn zero_of_line(points: &[(f64, f64)]) -> Option<f64> {
    let n = as_f64(points.len());
    let (mx, my) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (sxx, sxy) =
        points.iter().fold((0.0, 0.0), |(xx, xy), p| (xx + (p.0 - mx).powi(2), xy + (p.0 - mx) * (p.1 - my)));
    (points.len() > 1 && sxy > 0.0).then(|| mx - my * sxx / sxy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;
    use std::f64::consts::PI;

    /// A half sine of 6 ms from 20.03 ms on, at L positive, at R later.
    fn signal(end: End, rate: f64, start_s: f64, peak: f64) -> Signal {
        let force_m_s2 = (0..100_000)
            .map(|i| f64::from(i) / rate)
            .take_while(|t| *t < 0.2)
            .map(|t| {
                let x = (t - start_s) / 0.006;
                if (0.0..1.0).contains(&x) { peak * (PI * x).sin() } else { 0.0 }
            })
            .collect();
        Signal { end, noise_m_s2: 0.1, free_fall_s: 0.25, ..example::signal(rate, force_m_s2) }
    }

    #[test]
    fn onsets_are_finer_than_the_shoulder() {
        // The chord of a half sine from 2 % to 30 % of its peak meets zero within 1 % of its length.
        for rate in [5e3, 2e4, 1e5] {
            let coarse = CoarseEvent { near_s: 0.01, spread_s: 0.025, velocity_step_m_s: 20.0 };
            let first =
                first_contact(&[signal(End::First, rate, 0.020_03, 3000.0)], &coarse).expect("an onset");
            assert!((first.time_s - 0.020_03).abs() < 6e-5, "{rate}: {first:?}");
            let second =
                slap_down(&signal(End::Second, rate, 0.080_03, 3000.0), 5.0, 0.03..0.19, 2.0, Some(0.0))
                    .expect("an onset");
            assert!((second.time_s - 0.080_03).abs() < 6e-5, "{rate}: {second:?}");
        }
    }

    /// 0.9 g over 17 ms before a half sine of 8 ms, through a sensor that ends at `limit`.
    fn with_foot(rate: f64, limit: f64, noise_m_s2: f64) -> Signal {
        let plain = signal(End::First, rate, 0.037, 1.0);
        let force = |i: usize| match plain.time_s(i) {
            t if (0.02..0.037).contains(&t) => 8.8,
            t if (0.037..0.045).contains(&t) => (630.0 * (PI * (t - 0.037) / 0.008).sin()).min(limit),
            _ => 0.0,
        };
        let force_m_s2 = (0..plain.force_m_s2.len()).map(force).collect();
        Signal { force_m_s2, noise_m_s2, ..plain }
    }

    #[test]
    fn a_pulse_that_yields_in_its_first_stage_begins_where_that_does() {
        // 300 m/s² within 2 ms, from there to 1500 within 25: a line through all of it meets zero 4 ms too
        // soon.
        let plain = signal(End::First, 5e3, 0.037, 1.0);
        let force = |i: usize| match plain.time_s(i) - 0.03 {
            t if (0.0..0.002).contains(&t) => 1.5e5 * t,
            t if (0.002..0.027).contains(&t) => 300.0 + 4.8e4 * (t - 0.002),
            _ => 0.0,
        };
        let force_m_s2 = (0..plain.force_m_s2.len()).map(force).collect();
        let coarse = CoarseEvent { near_s: 0.03, spread_s: 0.025, velocity_step_m_s: 20.0 };
        let found = first_contact(&[Signal { force_m_s2, ..plain }], &coarse).expect("an onset");
        // Two samples.
        assert!((found.time_s - 0.03).abs() < 4.1e-4, "{found:?}");
    }

    #[test]
    fn what_one_sensor_takes_for_the_foot_is_in_the_interval() {
        let coarse = CoarseEvent { near_s: 0.015, spread_s: 0.025, velocity_step_m_s: 3.2 };
        let seen = |signal| first_contact(&[signal], &coarse).expect("an onset");
        let (slow, noisy) = (seen(with_foot(2e3, 412.0, 0.05)), seen(with_foot(2e4, 1e4, 5.0)));
        let apart_s = noisy.time_s - slow.time_s;
        assert!((0.016..0.018).contains(&apart_s), "{slow:?} {noisy:?}");
        assert!(apart_s < 2.0 * slow.u_s.hypot(noisy.u_s), "{slow:?} {noisy:?}");
        // Where the noise lets it be seen, in means at the least, it is the contact's first stage.
        let in_means = seen(with_foot(2e4, 1e4, 1.0));
        assert!((in_means.time_s - 0.02).abs() < 2.0 * in_means.u_s, "{in_means:?}");
        let quiet = seen(with_foot(2e4, 1e4, 0.05));
        assert!((quiet.time_s - 0.02).abs() < 1e-4, "{quiet:?}");
    }

    #[test]
    fn a_slow_rise_begins_before_it_leaves_what_rings_on() {
        // A half sine of 40 ms to 1000 m/s² under 100 m/s² at 900 Hz that no fit took off hides its foot.
        let plain = signal(End::Second, 2e4, 0.08, 1.0);
        let force = |i: usize| {
            let t = plain.time_s(i) - 0.08;
            let pulse = if (0.0..0.04).contains(&t) { 1000.0 * (PI * t / 0.04).sin() } else { 0.0 };
            pulse + 100.0 * (1800.0 * PI * t).cos()
        };
        let force_m_s2 = (0..plain.force_m_s2.len()).map(force).collect();
        let ringing = Signal { force_m_s2, ..plain };
        let found = slap_down(&ringing, 5.0, 0.03..0.19, 2.0, Some(100.0)).expect("an onset");
        assert!((found.time_s - 0.08).abs() < 2.0 * found.u_s && found.u_s < 2e-3, "{found:?}");
    }

    #[test]
    fn a_pulse_longer_than_the_means_begins_at_its_rise() {
        // The force of a limiter: 2 ms of rise, 40 of plateau, where the means are 25 ms long.
        let plain = signal(End::Second, 2e4, 0.08, 1.0);
        let force = |i: usize| match plain.time_s(i) - 0.08 {
            t if (0.0..0.002).contains(&t) => 2e5 * t,
            t if (0.002..0.042).contains(&t) => 400.0,
            _ => 0.0,
        };
        let force_m_s2 = (0..plain.force_m_s2.len()).map(force).collect();
        let long = Signal { force_m_s2, ..plain };
        for is_calm in [true, false] {
            let found = slap_down(&long, 5.0, 0.03..0.19, 2.0, is_calm.then_some(0.0)).expect("an onset");
            assert!((found.time_s - 0.08).abs() < 1e-4 && found.u_s < 1e-3, "{found:?}");
        }
        // Where R cannot have struck before, no rise is seen: the time is as uncertain as the means are long.
        let hidden = slap_down(&long, 5.0, 0.09..0.19, 2.0, Some(0.0)).expect("an onset");
        assert!(hidden.u_s > 0.02, "{hidden:?}");
    }

    #[test]
    fn a_sensor_that_rings_higher_behind_the_pulse_does_not_hide_it() {
        let plain = signal(End::Second, 1e5, 0.08, 4000.0);
        let force = |i: usize| {
            let rings = (0.0885..0.089).contains(&plain.time_s(i));
            plain.force_m_s2[i] + if rings { 30_000.0 } else { 0.0 }
        };
        let force_m_s2 = (0..plain.force_m_s2.len()).map(force).collect();
        let ringing = Signal { force_m_s2, ..plain.clone() };
        let found = slap_down(&ringing, 5.0, 0.03..0.19, 2.0, Some(0.0)).expect("an onset");
        assert!((found.time_s - 0.08).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn an_offset_that_no_free_fall_shows_is_no_stage_of_the_contact() {
        let coarse = CoarseEvent { near_s: 0.01, spread_s: 0.025, velocity_step_m_s: 11.0 };
        for offset_m_s2 in [-20.0, 20.0] {
            let plain = signal(End::First, 2e4, 0.0301, 3000.0);
            let force_m_s2 = plain.force_m_s2.iter().map(|force| force + offset_m_s2).collect();
            let offset = Signal { force_m_s2, free_fall_s: 0.0, noise_m_s2: 0.0, ..plain };
            let found = first_contact(&[offset], &coarse).expect("an onset");
            assert!((found.time_s - 0.0301).abs() < 1e-4, "{found:?}");
        }
    }

    /// A half sine of 6 ms and 300 m/s² in so much noise.
    fn noisy(noise_m_s2: f64) -> Signal {
        let plain = signal(End::First, 1e5, 0.08, 300.0);
        // White in [−½, ½], of variance 1/12.
        let white = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let wave = |(i, force): (u32, &f64)| force + 12.0_f64.sqrt() * noise_m_s2 * white(i);
        let force_m_s2 = (0..).zip(&plain.force_m_s2).map(wave).collect();
        Signal { force_m_s2, noise_m_s2, ..plain }
    }

    #[test]
    fn a_soft_pulse_is_found_in_the_noise_of_a_wide_range() {
        let coarse = CoarseEvent { near_s: 0.07, spread_s: 0.025, velocity_step_m_s: 1.1 };
        let found = first_contact(&[noisy(40.0)], &coarse).expect("an onset");
        // Six standard deviations are 80 % of the peak; means over a tenth of the pulse show its foot.
        assert!((found.time_s - 0.08).abs() < 6e-4 && found.u_s < 6e-4, "{found:?}");
        assert!((found.time_s - 0.08).abs() < 3.0 * found.u_s, "{found:?}");
    }

    #[test]
    fn a_body_that_bends_first_has_struck_where_it_leaves_its_calm() {
        // The signal has a hum of 3 m/s² throughout, a shock of a cable, and 8 ms in the other direction
        // before the rise.
        let bent = |pause_s: f64| {
            let plain = signal(End::Second, 2e4, 0.08, 300.0);
            let before = |t: f64| match t - 0.08 + pause_s {
                t if (-0.03..-0.029).contains(&t) => 40.0,
                t if (-0.008..0.0).contains(&t) => -60.0 * (PI * (t + 0.008) / 0.008).sin().abs().sqrt(),
                _ => 3.0 * (500.0 * t).sin(),
            };
            let force_m_s2 =
                plain.force_m_s2.iter().enumerate().map(|(i, force)| force + before(plain.time_s(i)));
            Signal { force_m_s2: force_m_s2.collect(), ..plain.clone() }
        };
        let struck = At { time_s: 0.08, u_s: 1e-4 };
        let found = departure(&bent(0.0), 5.0, struck, 0.03, 3.0);
        assert!((found.time_s - 0.072).abs() < 2e-4 && found.u_s < 2e-4, "{found:?}");
        // A movement that ended 3 ms before the rise does not belong to the slap-down.
        assert_eq!(departure(&bent(0.003), 5.0, struck, 0.03, 3.0), struck);
        // A long flight may ring more in the fitted part than at its end.
        let found = departure(&bent(0.0), 2.0, At { time_s: 0.078, ..struck }, 0.03, 30.0);
        assert!((found.time_s - 0.072).abs() < 2e-4, "{found:?}");
        // A movement of a short body that lasts as long as ringing does not count either.
        assert_eq!(departure(&bent(0.0), 1.0, struck, 0.03, 3.0), struck);
    }

    #[test]
    fn a_record_that_ends_in_the_pulse_shows_where_that_began() {
        let whole = signal(End::Second, 2e4, 0.08, 300.0);
        let ends = |after_s: f64| whole.cut(0, whole.index_from(0.08 + after_s));
        let found = cut_short(&ends(0.002), 5.0, 0.03, 3.0, 0.1).expect("an onset");
        assert!((found.time_s - 0.08).abs() < 1e-4 && found.u_s < 1e-4, "{found:?}");
        assert_eq!(cut_short(&ends(0.0005), 5.0, 0.03, 3.0, 0.1), None);
        assert_eq!(cut_short(&whole, 5.0, 0.03, 3.0, 0.1), None);
    }

    #[test]
    fn a_quiet_record_has_no_slap_down() {
        assert!(slap_down(&signal(End::Second, 1e5, 0.08, 1.0), 5.0, 0.03..0.19, 2.0, Some(0.0)).is_none());
    }
}
