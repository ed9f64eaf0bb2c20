//! The samples of channels to what no column of a recording says of them: rows of several sensors by turns,
//! and blocks that were written twice.

use crate::data::{Channel, ChannelFinding, Finding, Samples, Span, TimesFinding};
use crate::numerics::{as_f64, extent, robust};
use std::collections::HashMap;

/// Samples count that are this part of the largest, from the median: only those of a shock move a velocity.
const LARGE: f64 = 0.05;
/// So many large samples are looked at.
const MOST_LARGE: usize = 1 << 18;
/// Rows after which the first of several sensors may come again: of two, three and five, singly or in blocks.
const TURNS: [usize; 7] = [2, 3, 4, 5, 6, 8, 16];
/// The rows are cut into so many parts of equal energy, which must all show the same factors.
const PARTS: usize = 6;
/// Large samples a sensor, weighted by their energy, below which chance or a short pulse makes factors.
const LEAST_ROWS: f64 = 12.0;
/// Sensors that differ by less, over their mean, move k by less than its interval.
const LEAST_DIFFERENCE: f64 = 0.04;
/// The parts keep to the whole's difference within this part of it.
const ALIKE: f64 = 0.35;
/// Large samples of nearly one size are of no shock.
const MOST_LEVEL: f64 = 0.95;
/// What the factors of more than two sensors leave of the rows' differences.
const MOST_LEFT: f64 = 0.25;
/// Rows that are compared at first.
const WINDOW: usize = 4;
/// Bits by which a run must be less likely than chance among all pairs of rows.
const CERTAIN_BITS: f64 = 30.0;
/// A window that comes more often is of a periodic signal.
const MOST_COPIES: usize = 3;
/// More runs that repeat are those of a periodic signal.
const MOST_RUNS: usize = 8;

/// The samples of a channel about their median, with the least that counts as large.
struct Centred<'a> {
    samples: &'a Samples,
    median: f64,
    least: f64,
}

impl<'a> Centred<'a> {
    fn of(samples: &'a Samples) -> Self {
        let every = (samples.len() / 4096).max(1);
        let thinned = (0..samples.len()).step_by(every).map(|i| samples.get(i));
        let mut thinned: Vec<f64> = thinned.filter(|x| x.is_finite()).collect();
        let median = if thinned.is_empty() { 0.0 } else { robust::median(&mut thinned) };
        let far = |most: f64, i: usize| most.max((samples.get(i) - median).abs());
        let most = (0..samples.len()).fold(0.0, far);
        Self { samples, median, least: LARGE * most }
    }

    fn at(&self, row: usize) -> f64 {
        self.samples.get(row) - self.median
    }

    fn is_large(&self, row: usize) -> bool {
        self.at(row).abs() > self.least
    }

    fn large(&self) -> impl Iterator<Item = usize> {
        (0..self.samples.len()).filter(|row| self.is_large(*row)).take(MOST_LARGE)
    }
}

/// Rows of several sensors by turns.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turns {
    /// Rows after which the first sensor comes again.
    rows: usize,
    /// The least of the sensors over the largest.
    factor: f64,
}

/// The turns that the samples show: rows against the mean over all sensors about them, where the same pattern
/// returns throughout the recording.
fn turns(samples: &Samples) -> Option<Turns> {
    let centred = Centred::of(samples);
    let large: Vec<usize> = centred.large().collect();
    TURNS.into_iter().find_map(|rows| Some(Turns { rows, factor: factor_of(&centred, &large, rows)? }))
}

fn factor_of(centred: &Centred, large: &[usize], turn: usize) -> Option<f64> {
    let half = turn / 2;
    let mean = |row: usize| {
        let ends = centred.at(row - half) + centred.at(row + half);
        let inner: f64 = (row - half + 1..row + half).map(|near| centred.at(near)).sum();
        // An even number of rows has its two ends half.
        (inner + if turn.is_multiple_of(2) { ends / 2.0 } else { ends }) / as_f64(turn)
    };
    let is_inside = |row: &&usize| **row >= half && **row + half < centred.samples.len();
    let rows = large.iter().filter(is_inside).map(|row| (*row, mean(*row)));
    let rows: Vec<(usize, f64)> = rows.filter(|(_, mean)| mean.is_finite()).collect();
    let energy: f64 = rows.iter().map(|(_, mean)| mean * mean).sum();
    let fourth: f64 = rows.iter().map(|(_, mean)| mean.powi(4)).sum();
    let is_level = energy * energy > MOST_LEVEL * as_f64(rows.len()) * fourth;
    if energy * energy < as_f64(turn) * LEAST_ROWS * fourth || energy <= 0.0 || (turn > 2 && is_level) {
        return None;
    }
    // Of each part, of each sensor: the products and the squares.
    let mut sums = vec![vec![[0.0; 2]; turn]; PARTS];
    let mut before = 0.0;
    for &(row, mean) in &rows {
        let part = (0..PARTS - 1).find(|part| before < energy * as_f64(part + 1) / as_f64(PARTS));
        let [products, squares] = &mut sums[part.unwrap_or(PARTS - 1)][row % turn];
        (*products, *squares) = (*products + centred.at(row) * mean, *squares + mean * mean);
        before += mean * mean;
    }
    let pattern = |sums: &dyn Fn(usize) -> [f64; 2]| -> Vec<f64> {
        let factors: Vec<f64> = (0..turn).map(|sensor| sums(sensor)[0] / sums(sensor)[1]).collect();
        let mean = factors.iter().sum::<f64>() / as_f64(turn);
        factors.iter().map(|factor| factor / mean).collect()
    };
    let whole = pattern(&|sensor| [0, 1].map(|sum| sums.iter().map(|part| part[sensor][sum]).sum()));
    let off = |other: &[f64]| whole.iter().zip(other).map(|(own, other)| (own - other).powi(2)).sum::<f64>();
    let (least, most) = extent(whole.iter().copied());
    let size = off(&vec![1.0; turn]);
    // Ringing of as many rows a period adds to the samples, and the sensors' factors explain them.
    let left = |factor: &dyn Fn(usize) -> f64| -> f64 {
        rows.iter().map(|(row, mean)| (centred.at(*row) - factor(row % turn) * mean).powi(2)).sum()
    };
    if turn > 2 && left(&|sensor| whole[sensor]) > MOST_LEFT * left(&|_| 1.0) {
        return None;
    }
    let is_alike = |part: &Vec<[f64; 2]>| off(&pattern(&|sensor| part[sensor])) <= ALIKE * ALIKE * size;
    (most - least >= LEAST_DIFFERENCE && sums.iter().all(is_alike)).then_some(least / most)
}

/// Says of a channel that its rows are of several sensors by turns, where its samples show it.
pub(super) fn by_turns(channel: &Channel) -> Option<Finding> {
    let Turns { rows, factor } = turns(&channel.samples)?;
    Some(ChannelFinding::ByTurns { rows, factor }.tag(&channel.name))
}

/// Takes blocks that were written a second time for lost, with a finding for each: in all channels of one
/// clock at once, since one of them alone may be periodic.
pub(super) fn drop_repeated(channels: &mut [Channel], issues: &mut Vec<Finding>) {
    let clock = |c: &Channel| (c.samples.len(), c.sample_rate_hz.to_bits(), c.start_s.to_bits());
    let mut clocks: Vec<_> = channels.iter().map(clock).collect();
    clocks.sort_unstable();
    clocks.dedup();
    for own in clocks {
        let mut together: Vec<&mut Channel> = channels.iter_mut().filter(|c| clock(c) == own).collect();
        lose_repeated(&mut together, issues);
        // A driver of its own may have written one of them.
        if together.len() > 1 {
            for channel in together {
                lose_repeated(&mut [channel], issues);
            }
        }
    }
}

fn lose_repeated(together: &mut [&mut Channel], issues: &mut Vec<Finding>) {
    let runs = runs(&together.iter().map(|c| Centred::of(&c.samples)).collect::<Vec<_>>());
    for channel in together {
        for &RepeatedRun { from, copy, count } in &runs {
            let time_s = |row: usize| channel.start_s + as_f64(row) / channel.sample_rate_hz;
            let found = TimesFinding::Repeated { samples: count, of_s: time_s(from), from_s: time_s(copy) };
            issues.push(Finding::from(found).span(time_s(copy), time_s(copy + count)).tag(&channel.name));
            let span = Span { from: copy, to: copy + count };
            channel.samples.erase(span);
            channel.gaps.push(span);
        }
        channel.gaps.sort_by_key(|span| span.from);
    }
}

/// Rows that are the same at two places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct RepeatedRun {
    from: usize,
    /// The first row of the copy.
    copy: usize,
    count: usize,
}

fn runs(channels: &[Centred]) -> Vec<RepeatedRun> {
    let rows = channels.first().map_or(0, |channel| channel.samples.len());
    let is_large = |row: usize| channels.iter().any(|channel| channel.is_large(row));
    let large: Vec<usize> = (0..rows).filter(|row| is_large(*row)).take(MOST_LARGE).collect();
    let bits = |row: usize| channels.iter().map(move |channel| channel.samples.get(row).to_bits());
    let are_same = |one: usize, other: usize| {
        bits(one).eq(bits(other)) && channels.iter().any(|channel| channel.at(one).is_finite())
    };
    let mix = |hash: u64, bits: u64| (hash ^ bits).wrapping_mul(0x0100_0000_01b3).rotate_left(29);
    let whole = large.iter().filter(|row| **row + WINDOW <= rows);
    let mut windows: Vec<(u64, usize)> =
        whole.map(|&row| ((row..row + WINDOW).flat_map(bits).fold(0xcbf2_9ce4, mix), row)).collect();
    windows.sort_unstable();
    let mut found: Vec<RepeatedRun> = Vec::new();
    let same = windows.chunk_by(|one, other| one.0 == other.0).filter(|same| same.len() <= MOST_COPIES);
    for pair in same.flat_map(|same| same.windows(2)) {
        let (one, other) = (pair[0].1, pair[1].1);
        let is_known = |run: &RepeatedRun| {
            run.copy - run.from == other - one && (run.copy..run.copy + run.count).contains(&other)
        };
        if found.iter().any(is_known) {
            continue;
        }
        let lag = other - one;
        let back = (1..=one).take_while(|back| are_same(one - back, other - back)).count();
        let on = (0..rows - other).take_while(|on| are_same(one + on, other + on)).count();
        let (from, count) = (one - back, back + on);
        // What begins and ends at rest is an event that came twice; what comes more than three times, or
        // reaches an end of the recording, is periodic.
        let is_cut = is_large(from) || is_large(from + count - 1);
        let is_inside = from > 0 && from + lag + count < rows;
        if count <= 2 * lag && count >= WINDOW && is_cut && is_inside {
            found.push(RepeatedRun { from, copy: from + lag, count });
        }
    }
    if found.is_empty() {
        return found;
    }
    let known = channels.iter().map(|channel| Frequencies::of(channel, &large)).collect::<Vec<_>>();
    let each = as_f64(large.len()).log2();
    found.retain(|&RepeatedRun { from, copy, count }| {
        // What stands right behind its original has one place instead of any.
        let certain = CERTAIN_BITS + if from + count >= copy { each } else { 2.0 * each };
        let inner = from + 1..from + count - 1;
        // A value that merely stays, as coarse steps make it, repeats by itself.
        let own = known.iter().map(|known| {
            let changed = inner.clone().filter(|row| known.value(*row) != known.value(*row - 1));
            changed.map(|row| known.bits(row)).sum::<f64>()
        });
        own.sum::<f64>() >= certain
    });
    found.sort_unstable();
    if found.len() > MOST_RUNS { Vec::new() } else { found }
}

/// How often the values of a channel come, and those of its second differences, of which a smooth signal has
/// few.
struct Frequencies<'a> {
    channel: &'a Centred<'a>,
    rows: f64,
    values: HashMap<u64, u32>,
    bends: HashMap<u64, u32>,
}

impl<'a> Frequencies<'a> {
    fn of(channel: &'a Centred<'a>, large: &[usize]) -> Self {
        let mut known =
            Self { channel, rows: as_f64(large.len()), values: HashMap::new(), bends: HashMap::new() };
        for &row in large.iter().filter(|row| **row > 0 && **row + 1 < channel.samples.len()) {
            let (value, bend) = (known.value(row), known.bend(row));
            *known.values.entry(value).or_default() += 1;
            *known.bends.entry(bend).or_default() += 1;
        }
        known
    }

    fn value(&self, row: usize) -> u64 {
        self.channel.samples.get(row).to_bits()
    }

    fn bend(&self, row: usize) -> u64 {
        let bend = self.channel.at(row - 1) - 2.0 * self.channel.at(row) + self.channel.at(row + 1);
        // Free of the last digits of the differences.
        ((bend / self.channel.least * 1e5).round() + 0.0).to_bits()
    }

    /// How unlikely the sample in a row is, in bits.
    fn bits(&self, row: usize) -> f64 {
        let rarity = |known: &HashMap<u64, u32>, key: u64| {
            let count = known.get(&key).copied().unwrap_or(1);
            (self.rows / f64::from(count)).log2().max(0.0)
        };
        rarity(&self.values, self.value(row)).min(rarity(&self.bends, self.bend(row)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::as_count;

    /// A drop's shocks and ringing with noise, so many rows a millisecond.
    fn shocks(rate: f64, noise: f64, digits: f64) -> Vec<f64> {
        let mut seed = 7_u64;
        let mut chance = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(seed >> 40).unwrap()) / f64::from(1 << 24) - 0.5
        };
        let pulse =
            |t: f64| if (0.0..3.0).contains(&t) { (t * std::f64::consts::PI / 3.0).sin() } else { 0.0 };
        let ring = |t: f64| if t > 0.0 { (-t / 8.0).exp() * (t * 2.1).sin() } else { 0.0 };
        let at = |t: f64| 700.0 * pulse(t - 50.0) + 90.0 * ring(t - 50.0) + 300.0 * pulse(t - 90.0);
        (0..as_count(120.0 * rate))
            .map(|i| ((at(as_f64(i) / rate) + noise * chance()) * digits).round() / digits)
            .collect()
    }

    fn factor(samples: Vec<f64>) -> Option<f64> {
        turns(&Samples::F64(samples)).map(|turns| turns.factor)
    }

    #[test]
    fn odd_rows_of_another_sensor_are_seen_and_nothing_else() {
        for other in [0.7, 0.8, 0.93, 1.1, 1.25] {
            let rows = shocks(20.0, 0.3, 1e3).into_iter().enumerate();
            let found = factor(rows.map(|(i, x)| if i % 2 == 0 { x } else { other * x }).collect());
            let expected = f64::min(other, 1.0 / other);
            assert!((found.unwrap() - expected).abs() < 0.02, "{other}: {found:?}");
        }
        for (turn, own) in
            [(3, &[1.0, 0.8, 1.1][..]), (4, &[1.0, 1.0, 0.8, 0.8]), (5, &[1.0, 0.8, 0.9, 1.1, 0.85])]
        {
            let rows = shocks(10.0 * as_f64(turn), 0.3, 1e3).into_iter().enumerate();
            let found = turns(&Samples::F64(rows.map(|(i, x)| own[i % turn] * x).collect())).unwrap();
            assert_eq!(found.rows, turn);
            assert!((found.factor - if turn == 4 { 0.8 } else { 0.8 / 1.1 }).abs() < 0.02, "{found:?}");
        }
        for rate in [1.0, 2.0, 5.0, 10.0, 20.0, 100.0] {
            for (noise, digits) in [(0.0, 1e9), (0.3, 1e3), (30.0, 1e3), (0.3, 0.05)] {
                assert_eq!(factor(shocks(rate, noise, digits)), None, "{rate} {noise} {digits}");
            }
        }
        assert_eq!(factor(vec![21.0; 1000]), None);
        assert_eq!(factor((0..1000).map(|i| f64::from(u8::from(i % 40 > 19))).collect()), None);
    }

    #[test]
    fn a_block_that_was_written_twice_is_lost_and_nothing_else() {
        let found = |a: &[f64], b: &[f64]| {
            let both = [a, b].map(|samples| Samples::F64(samples.to_vec()));
            runs(&both.iter().map(Centred::of).collect::<Vec<_>>())
        };
        for rate in [5.0, 10.0, 50.0] {
            for (noise, digits) in [(0.3, 1e3), (0.3, 10.0), (0.0, 1e3), (0.0, 1.0), (0.3, 0.1)] {
                let mut a = shocks(rate, noise, digits);
                let mut b: Vec<f64> = a.iter().rev().map(|x| (x * 0.7 * digits).round() / digits).collect();
                assert_eq!(found(&a, &b), [], "{rate} {noise} {digits}");
                let from = as_count(50.2 * rate);
                for samples in [&mut a, &mut b] {
                    samples.copy_within(from..from + 12, from + 12);
                }
                let run = RepeatedRun { from, copy: from + 12, count: 12 };
                let is_certain = digits >= 10.0 && noise > 0.0;
                assert!(!is_certain || found(&a, &b) == [run], "{rate} {noise}: {:?}", found(&a, &b));
            }
        }
        let alone = |samples: &[f64]| runs(&[Centred::of(&Samples::F64(samples.to_vec()))]);
        let mut once = shocks(10.0, 0.3, 1e3);
        assert_eq!(alone(&once), []);
        once.copy_within(502..514, 514);
        assert_eq!(alone(&once), [RepeatedRun { from: 502, copy: 514, count: 12 }]);
        let mut thrice = shocks(10.0, 0.3, 1e3);
        thrice.copy_within(502..508, 508);
        thrice.copy_within(502..508, 514);
        assert_eq!(found(&thrice, &thrice), [RepeatedRun { from: 502, copy: 508, count: 12 }]);
        let hum: Vec<f64> = (0..2000).map(|i| (f64::from(i % 200) * 0.0314).sin()).collect();
        assert_eq!(found(&hum, &hum), []);
    }
}
