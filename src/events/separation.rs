//! Finds the end of a first end's pulse: the times at which the force fades out and at which the impulse is
//! complete.

use super::onset::NOISE_FACTOR;
use crate::data::{At, Signal};
use crate::numerics::{as_count, as_f64, reduce};

/// A pulse has ended when the force stays below this share of its peak.
const TAIL: f64 = 0.05;
/// If the noise of single samples exceeds this share of the peak, the noise of the moving mean is used
/// instead.
const MOST_NOISE: f64 = 0.2;
/// The last part of the time from first contact to the slap-down shows the whole impulse.
const LAST_PART: f64 = 0.3;
/// In that part the impulse must stay this close to its whole, as a share.
const MOST_LEFT: f64 = 0.25;
/// Remaining share of the impulse near the contact's end: a half sine has this much in its last eighth.
const LEAST_LEFT: f64 = 0.04;
/// The largest such share, if ringing reaches as far: a half sine has this much in its last fifth.
const MOST_LEFT_AT_END: f64 = 0.1;
/// Ringing changes its sign at least this often: the force of a contact does not.
const LEAST_TURNS: usize = 2;
/// After this many sign changes the cask rings without a contact; the time at which the impulse was complete
/// is then known to this share of it.
const RINGING_TURNS: usize = 4;
const U_GIVEN: f64 = 0.15;
/// Longest first contact looked for, s: pulses of shock-absorbed casks reach 20 ms.
const LONGEST_CONTACT_S: f64 = 0.05;

/// Time at which L leaves the target on its signal that still rings, s: the force first drops to the foot.
pub fn first_separation(signal: &Signal, contact_s: f64, before_s: f64) -> Option<f64> {
    let from = signal.index_from(contact_s);
    let to = signal.index_from(before_s.min(contact_s + LONGEST_CONTACT_S));
    let smooth = smooth(signal.force_m_s2.get(from..to)?, signal.sample_rate_hz);
    let peak = smooth.iter().fold(0.0_f64, |m, &f| m.max(f));
    let at_peak = smooth.iter().position(|&f| f >= peak)?;
    let tail = (TAIL * peak).max(noise_m_s2(signal, peak));
    let end = (at_peak..smooth.len()).find(|&i| smooth[i] < tail)?;
    Some(signal.time_s(from + end))
}

/// Time at which L has received its impulse on a signal that still rings, s, or most of it if the ringing is
/// strong: no stage of the contact follows. `None` if the last part of the time to `before_s` does not show
/// the whole impulse.
pub fn impulse_end(signal: &Signal, contact_s: f64, before_s: f64) -> Option<f64> {
    let flight = before_s - LAST_PART * (before_s - contact_s)..before_s;
    let left = Remainder::new(signal, contact_s, &flight)?;
    let ringing = left.peak();
    let end = if ringing < MOST_LEFT_AT_END { left.ending()[0] } else { as_f64(left.falls_below(MOST_LEFT)) };
    let end_s = end / signal.sample_rate_hz;
    (ringing < MOST_LEFT && end_s < LONGEST_CONTACT_S).then_some(contact_s + end_s)
}

/// Remaining impulse on a signal of L, as a share of the whole.
struct Remainder {
    /// Shares from first contact up to the end of the flight.
    shares: Vec<f64>,
    /// Index at which the flight begins.
    flight: usize,
}

impl Remainder {
    fn new(signal: &Signal, contact_s: f64, flight_s: &std::ops::Range<f64>) -> Option<Self> {
        let from = signal.index_from(contact_s);
        let flight = signal.index_from(flight_s.start).checked_sub(from)?;
        let mut shares = cumulative(signal.force_m_s2.get(from..signal.index_from(flight_s.end))?);
        let after = shares.get(flight..).filter(|after| !after.is_empty())?;
        let whole = reduce::sum(after) / as_f64(after.len());
        for given in &mut shares {
            *given = 1.0 - *given / whole;
        }
        (whole > 0.0).then_some(Self { shares, flight })
    }

    /// The largest share in the flight, where nothing should remain.
    fn peak(&self) -> f64 {
        reduce::peak(&self.shares[self.flight..])
    }

    /// First sample at which nothing remains: later changes are ringing.
    fn first_zero(&self) -> f64 {
        as_f64(self.shares.iter().position(|left| *left <= 0.0).unwrap_or(self.flight))
    }

    /// First sample from which the remaining share stays below `share`.
    fn falls_below(&self, share: f64) -> usize {
        self.shares[..self.flight].iter().rposition(|left| *left > share).map_or(0, |last| last + 1)
    }

    /// End of the impulse, in samples: the remainder of a force that falls linearly to zero goes with the
    /// square of the time to its end, and nearly so does that of a half sine. The second value is the time of
    /// the fall from four times a share to that share, which ringing does not reach.
    fn ending(&self) -> [f64; 2] {
        let end_by = |share: f64| {
            let [last, before] = [share, 4.0 * share].map(|share| as_f64(self.falls_below(share)));
            [last + (last - before), last - before]
        };
        let after = as_count(end_by(LEAST_LEFT)[0]).min(self.flight);
        end_by((1.5 * reduce::peak(&self.shares[after..])).clamp(LEAST_LEFT, MOST_LEFT_AT_END))
    }
}

/// Compares the separation `by_force` with the impulse on the same signal: a ringing sensor seat keeps up the
/// force, but gives no further impulse.
///
/// The difference between both, over √3, enters the standard uncertainty. If it exceeds the fall time of the
/// force, and the force changes its sign between them, the impulse determines the end, to a third of that
/// fall; if impulse is still given after it, the end lies between both. A cask that a short impact makes ring
/// in more modes than are fitted may show a tenth of the impulse for twice as long as its contact: then the
/// contact ended when the impulse was first complete.
pub fn refine_end(signal: &Signal, contact_s: f64, by_force: At, flight_s: &std::ops::Range<f64>) -> At {
    // The end of a long flight is ignored: it may contain a touch.
    let flight_s = flight_s.start..flight_s.end.min(flight_s.start + LONGEST_CONTACT_S);
    let left = Remainder::new(signal, contact_s, &flight_s).filter(|left| left.peak() < MOST_LEFT_AT_END);
    let Some(left) = left else { return by_force };
    let [end_s, fall_s] = left.ending().map(|samples| samples / signal.sample_rate_hz);
    let end_s = contact_s + end_s;
    let apart_s = (by_force.time_s - end_s).abs();
    let found = if end_s - by_force.time_s > fall_s {
        At { time_s: by_force.time_s.midpoint(end_s), u_s: by_force.u_s.hypot(apart_s / 12.0_f64.sqrt()) }
    } else if apart_s <= fall_s || peak_and_turns(signal, end_s, by_force.time_s).1 < LEAST_TURNS {
        At { u_s: by_force.u_s.hypot(apart_s.min(fall_s) / 3.0_f64.sqrt()), ..by_force }
    } else {
        At { time_s: end_s, u_s: by_force.u_s.min((end_s - contact_s) / 40.0).max(fall_s / 3.0) }
    };
    let given_s = left.first_zero() / signal.sample_rate_hz;
    let is_late = found.time_s > contact_s + 2.0 * given_s;
    let rings = is_late && peak_and_turns(signal, contact_s + given_s, found.time_s).1 >= RINGING_TURNS;
    if rings { At { time_s: contact_s + given_s, u_s: U_GIVEN * given_s } } else { found }
}

/// The largest force between two times, m/s², and the number of its sign changes there.
fn peak_and_turns(signal: &Signal, from_s: f64, to_s: f64) -> (f64, usize) {
    let [from, to] = [from_s, to_s].map(|time_s| signal.index_from(time_s));
    let smooth = smooth(signal.force_m_s2.get(from..to).unwrap_or_default(), signal.sample_rate_hz);
    let turned = |pair: &&[f64]| (pair[0] < 0.0) != (pair[1] < 0.0);
    (reduce::peak(&smooth), smooth.windows(2).filter(turned).count())
}

/// Time at which L leaves the target on its signal without ringing, s: going back from `free_s`, where it
/// flies, the force leaves zero.
///
/// The standard uncertainty covers the fall of the force from the foot to zero, a fortieth of the contact, or
/// a sample.
pub fn separation(signal: &Signal, contact_s: f64, free_s: f64) -> Option<At> {
    let from = signal.index_from(contact_s);
    let to = signal.index_from(free_s);
    let beyond = signal.index_from(free_s + 0.5 * (free_s - contact_s));
    let smooth = smooth(signal.force_m_s2.get(from..beyond.max(to))?, signal.sample_rate_hz);
    let (contact, flight) = smooth.split_at(to - from);
    let peak = contact.iter().fold(0.0_f64, |m, &f| m.max(f));
    let left = flight.iter().fold(0.0_f64, |m, &f| m.max(f.abs()));
    let tail = (TAIL * peak).max(noise_m_s2(signal, peak)).max(1.5 * left).min(0.5 * peak);
    let end = contact.iter().rposition(|f| f.abs() > tail)? + 1;
    let time_s = signal.time_s(from + end);
    let u_s = ((time_s - contact_s) / 40.0).max(1.0 / signal.sample_rate_hz);
    Some(At { time_s, u_s })
}

/// Delay of a sensor behind the force if its seat rings after the contact, s: the period of that ringing over
/// 2π; 0 if the signal, without the cask's own ringing, is quiet.
pub fn seat_delay_s(signal: &Signal, contact_s: f64, left_s: f64) -> f64 {
    let after_s = left_s - contact_s;
    let (contact, (after, turns)) =
        (peak_and_turns(signal, contact_s, left_s).0, peak_and_turns(signal, left_s, left_s + after_s));
    if turns < LEAST_TURNS || after < (TAIL * contact).max(noise_m_s2(signal, contact)) {
        return 0.0;
    }
    after_s / as_f64(turns) / std::f64::consts::PI
}

/// Sums of all samples before each index; one longer than `values`.
fn cumulative(values: &[f64]) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for v in values {
        sum += v;
        sums.push(sum);
    }
    sums
}

/// Half the width of the moving mean, samples: the high modes of the sensor's mount do not end a pulse.
fn half_width(sample_rate_hz: f64) -> usize {
    as_count(1e-4 * sample_rate_hz)
}

/// Level that exceeds the noise of a signal, m/s²: if it is a large share of a pulse's `peak`, the level
/// after the moving mean.
fn noise_m_s2(signal: &Signal, peak: f64) -> f64 {
    let raw = NOISE_FACTOR * signal.noise_m_s2;
    let of_mean = raw / as_f64(2 * half_width(signal.sample_rate_hz) + 1).sqrt();
    raw.min(of_mean.max(MOST_NOISE * peak))
}

/// Moving mean over 0.2 ms.
fn smooth(force: &[f64], sample_rate_hz: f64) -> Vec<f64> {
    let half = half_width(sample_rate_hz);
    let sums = cumulative(force);
    (0..force.len())
        .map(|i| {
            let (a, b) = (i.saturating_sub(half), (i + half + 1).min(force.len()));
            (sums[b] - sums[a]) / as_f64(b - a)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;
    use std::f64::consts::{PI, TAU};

    /// A half sine of 6 ms from 20.03 ms on at 100 kHz, and behind it a seat that rings with a share of its
    /// peak.
    fn signal(rings: f64) -> Signal {
        let force = |i: i32| {
            let t = f64::from(i) * 1e-5 - 0.020_03;
            let seat =
                |since_s: f64| 3000.0 * rings * (-30.0 * since_s).exp() * (TAU * 1500.0 * since_s).sin();
            match t {
                t if t < 0.0 => 0.0,
                t if t < 0.006 => 3000.0 * (PI * t / 0.006).sin(),
                t => seat(t - 0.006),
            }
        };
        Signal {
            noise_m_s2: 0.1,
            free_fall_s: 0.25,
            ..example::signal(1e5, (0..20_000).map(force).collect())
        }
    }

    #[test]
    fn separation_is_the_end_of_the_pulse() {
        let quiet = signal(0.0);
        let by_force = separation(&quiet, 0.020_03, 0.04).expect("a separation");
        assert!((by_force.time_s - 0.026_03).abs() < 2.0 * by_force.u_s, "{by_force:?}");
        let rough_s = first_separation(&quiet, 0.020_03, 0.04).expect("a separation");
        assert!((rough_s - 0.026_03).abs() < 2.0 * by_force.u_s, "{rough_s}");
        let held = refine_end(&quiet, 0.020_03, by_force, &(0.04..0.1));
        assert!((held.time_s - by_force.time_s).abs() < 1e-9 && held.u_s < 1.2 * by_force.u_s, "{held:?}");
        assert!(seat_delay_s(&quiet, 0.020_03, 0.026_03).abs() < 1e-9);
    }

    #[test]
    fn ringing_with_a_tenth_of_the_impulse_is_no_contact() {
        // 500 Hz with 15 % of the impulse, and with 10 % still 16 ms later.
        let quiet = signal(0.0);
        let rings = |since_s: f64| 5400.0 * (-25.0 * since_s).exp() * (TAU * 500.0 * since_s).sin();
        let force = |(i, force): (u32, &f64)| force + rings((f64::from(i) * 1e-5 - 0.026_03).max(0.0));
        let force_m_s2 = (0_u32..).zip(&quiet.force_m_s2).map(force).collect();
        let ringing = Signal { force_m_s2, ..quiet };
        let by_force = separation(&ringing, 0.020_03, 0.06).expect("a separation");
        assert!(by_force.time_s > 0.04, "{by_force:?}");
        let held = refine_end(&ringing, 0.020_03, by_force, &(0.06..0.1));
        assert!((held.time_s - 0.026_03).abs() < 2.0 * held.u_s && held.u_s < 1.2e-3, "{held:?}");
    }

    #[test]
    fn a_pulse_in_the_noise_ends_where_means_show_it() {
        let quiet = signal(0.0);
        // White noise, by a hash of the sample's number, of a standard deviation of 400 m/s².
        let noise = |i: u32| {
            let hash = |salt: u32| (i ^ salt).wrapping_mul(2_654_435_761) >> 16;
            let uniform = |salt: u32| f64::from(hash(salt)) / 65_536.0 - 0.5;
            400.0 * (uniform(0x5bd1) + uniform(0xe995) + uniform(0x1b87)) * 2.0
        };
        let force_m_s2 = (0_u32..).zip(&quiet.force_m_s2).map(|(i, force)| force + noise(i)).collect();
        let noisy = Signal { noise_m_s2: 400.0, force_m_s2, ..quiet };
        let found = separation(&noisy, 0.020_03, 0.04).expect("a separation");
        // Single samples would need a force above half its peak, 1 ms before its end.
        assert!((found.time_s - 0.026_03).abs() < 6e-4, "{found:?}");
    }

    #[test]
    fn ringing_behind_the_pulse_is_no_contact() {
        let ringing = signal(0.3);
        let by_force = separation(&ringing, 0.020_03, 0.06).expect("a separation");
        assert!(by_force.time_s > 0.04, "{by_force:?}");
        let left = refine_end(&ringing, 0.020_03, by_force, &(0.06..0.1));
        assert!((left.time_s - 0.026_03).abs() < 2.0 * left.u_s && left.u_s < 5e-4, "{left:?}");
        // 1500 Hz turn by a radian in 0.106 ms.
        let seat_s = seat_delay_s(&ringing, 0.020_03, 0.026_03);
        assert!((seat_s - 1.06e-4).abs() < 2e-5, "{seat_s}");
    }

    #[test]
    fn the_impulse_is_given_after_the_last_stage() {
        let mut staged = signal(0.0);
        // A second, weaker pulse follows 3 ms after the first.
        let again: Vec<f64> = staged.force_m_s2.iter().map(|force| 0.5 * force).collect();
        staged.force_m_s2.iter_mut().skip(900).zip(again).for_each(|(force, again)| *force += again);
        let given_s = impulse_end(&staged, 0.020_03, 0.08).expect("a flight");
        assert!((given_s - 0.035_03).abs() < 1e-3, "{given_s}");
    }
}
