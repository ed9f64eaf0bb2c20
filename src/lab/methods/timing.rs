//! Pieces of work to the time of one call of each, measured in turn.

use std::time::{Duration, Instant};

/// How thoroughly times are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Rounds: in each every piece of work has its turn once.
    pub rounds: usize,
    /// A turn repeats its work until this has passed: the clock's grain and its call vanish in it.
    pub turn: Duration,
}

impl Effort {
    /// Of the quick or of the full run.
    #[must_use]
    pub fn of(quick: bool) -> Self {
        // The quartiles of 7 rounds are their second and sixth; of 25 the seventh and nineteenth.
        if quick {
            Self { rounds: 7, turn: Duration::from_millis(1) }
        } else {
            Self { rounds: 25, turn: Duration::from_millis(4) }
        }
    }
}

/// Time of one call over the rounds, ns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Median over the rounds, ns.
    pub median_ns: f64,
    /// Lower and upper quartile over the rounds, ns.
    pub quartiles_ns: [f64; 2],
}

impl Timing {
    /// The same for one of `count` parts of a call: a sample of a channel.
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "counts stay below 2^52")]
    pub fn per(self, count: usize) -> Self {
        let share = 1.0 / count.max(1) as f64;
        Self { median_ns: self.median_ns * share, quartiles_ns: self.quartiles_ns.map(|q| q * share) }
    }
}

/// A piece of work; it must pass its result through [`std::hint::black_box`], or the compiler may leave it out.
pub type Work<'a> = Box<dyn FnMut() + 'a>;

/// The time of one call of each piece of work, in their order.
///
/// Every round gives each its turn, so that a machine that slows down slows all alike; a first round warms caches and sets how
/// often each is called in a turn.
#[must_use]
pub fn in_turn(work: &mut [Work], effort: Effort) -> Vec<Timing> {
    let calls: Vec<u32> = work
        .iter_mut()
        .map(|one| {
            one();
            let begun = Instant::now();
            let mut calls = 0;
            while begun.elapsed() < effort.turn {
                one();
                calls += 1;
            }
            calls.max(1)
        })
        .collect();
    let mut taken_ns = vec![Vec::with_capacity(effort.rounds); work.len()];
    for _ in 0..effort.rounds.max(1) {
        for ((one, calls), taken_ns) in work.iter_mut().zip(&calls).zip(&mut taken_ns) {
            let begun = Instant::now();
            for _ in 0..*calls {
                one();
            }
            taken_ns.push(1e9 * begun.elapsed().as_secs_f64() / f64::from(*calls));
        }
    }
    taken_ns.into_iter().map(summary).collect()
}

/// Median and quartiles; each the value of a round, none in between.
fn summary(mut taken_ns: Vec<f64>) -> Timing {
    taken_ns.sort_by(f64::total_cmp);
    let at = |quarters: usize| taken_ns[(taken_ns.len() - 1) * quarters / 4];
    Timing { median_ns: at(2), quartiles_ns: [at(1), at(3)] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn everything_has_its_turn_in_every_round() {
        let (first, second) = (Cell::new(0), Cell::new(0));
        let mut work: Vec<Work> =
            vec![Box::new(|| first.set(first.get() + 1)), Box::new(|| second.set(second.get() + 1))];
        let effort = Effort { rounds: 3, turn: Duration::ZERO };
        let timings = in_turn(&mut work, effort);
        drop(work);
        // One call to warm up, then one in each round.
        assert_eq!((first.get(), second.get(), timings.len()), (4, 4, 2));
    }

    #[test]
    fn a_summary_is_the_median_and_the_quartiles() {
        let timing = summary(vec![5.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!(timing, Timing { median_ns: 3.0, quartiles_ns: [2.0, 4.0] });
        assert_eq!(timing.per(2), Timing { median_ns: 1.5, quartiles_ns: [1.0, 2.0] });
    }
}
