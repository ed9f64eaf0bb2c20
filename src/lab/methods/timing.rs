//! Pieces of work to the time of one call of each, measured in turn.

use std::time::{Duration, Instant};

/// A piece of work; it must pass its result through [`std::hint::black_box`], or the compiler may leave it out.
pub type Work<'a> = Box<dyn FnMut() + 'a>;

/// Quartiles of the time of one call of each piece of work, ns, in their order.
///
/// Every round gives each its turn, so that a machine that slows down slows all alike; a first round warms caches and sets how
/// often each is called in a turn.
#[must_use]
pub fn in_turn(work: &mut [Work], quick: bool) -> Vec<[f64; 3]> {
    // The quartiles of 7 rounds are their second and sixth; of 25 the seventh and nineteenth.
    let (rounds, turn) = if quick { (7, Duration::from_millis(1)) } else { (25, Duration::from_millis(4)) };
    let mut warmed = |one: &mut Work| {
        one();
        let begun = Instant::now();
        let mut calls = 0_u32;
        // The clock's grain and its call vanish in a turn.
        while begun.elapsed() < turn {
            one();
            calls += 1;
        }
        calls.max(1)
    };
    let calls: Vec<u32> = work.iter_mut().map(&mut warmed).collect();
    let mut taken_ns = vec![Vec::with_capacity(rounds); work.len()];
    for _ in 0..rounds {
        for ((one, calls), taken_ns) in work.iter_mut().zip(&calls).zip(&mut taken_ns) {
            let begun = Instant::now();
            for _ in 0..*calls {
                one();
            }
            taken_ns.push(1e9 * begun.elapsed().as_secs_f64() / f64::from(*calls));
        }
    }
    taken_ns.into_iter().map(quartiles).collect()
}

/// Lower quartile, median and upper quartile; each the value of a round, none in between.
pub(super) fn quartiles(mut taken_ns: Vec<f64>) -> [f64; 3] {
    taken_ns.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarters| taken_ns[(taken_ns.len() - 1) * quarters / 4])
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
        let times_ns = in_turn(&mut work, true);
        drop(work);
        // One call to warm up, then one at least in each round.
        assert!(first.get() >= 8 && second.get() >= 8);
        assert!(times_ns.len() == 2 && times_ns.iter().all(|of| of.is_sorted()));
    }

    #[test]
    fn quartiles_are_those_of_rounds() {
        assert_eq!(
            quartiles(vec![5.0, 1.0, 3.0, 2.0, 4.0]).map(f64::to_bits),
            [2.0_f64, 3.0, 4.0].map(f64::to_bits)
        );
    }
}
