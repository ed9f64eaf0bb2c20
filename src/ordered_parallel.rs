//! Pieces of work to what is made of them: each on one of so many threads, handed over in order, so many
//! ahead at most.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Condvar, Mutex, PoisonError, mpsc};

/// Pieces that may be ready before the one that is waited for, for each job: more would be held in memory.
const AHEAD: usize = 4;

/// Told in place of how many are taken where no more are.
const ENDED: usize = usize::MAX;

/// Makes something of each of `pieces` by `make` on `jobs` threads, one core each, and hands it to `take` in
/// their order.
///
/// # Errors
/// The first of `take`; what is being made then is ended, and no more begun.
pub fn each<P: Copy + Send + Sync, T: Send, E>(
    pieces: impl Iterator<Item = P> + Send,
    jobs: usize,
    make: impl Fn(P) -> T + Sync,
    mut take: impl FnMut(P, T) -> Result<(), E>,
) -> Result<(), E> {
    let threads = pieces.size_hint().1.map_or(jobs, |most| jobs.min(most));
    let (next, taken, moved) = (Mutex::new(pieces.enumerate()), Mutex::new(0_usize), Condvar::new());
    let (sender, receiver) = mpsc::channel();
    let work = |sender: mpsc::Sender<_>| {
        // What a piece shares among threads stays on this one: pieces are what is shared here. A thread that
        // waits for another would begin a second piece in the middle of the first, and hold both.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        loop {
            let Some((place, piece)) = next.lock().unwrap_or_else(PoisonError::into_inner).next() else {
                return;
            };
            let lead = taken.lock().unwrap_or_else(PoisonError::into_inner);
            let lead = moved.wait_while(lead, |taken| place >= taken.saturating_add(AHEAD * jobs));
            if *lead.unwrap_or_else(PoisonError::into_inner) == ENDED {
                return;
            }
            let made = catch_unwind(AssertUnwindSafe(|| match &pool {
                Ok(pool) => pool.install(|| make(piece)),
                Err(_) => make(piece),
            }));
            if sender.send((place, piece, made)).is_err() {
                return;
            }
        }
    };
    let tell = |now: usize| {
        *taken.lock().unwrap_or_else(PoisonError::into_inner) = now;
        moved.notify_all();
    };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let (work, sender) = (&work, sender.clone());
            scope.spawn(move || work(sender));
        }
        // The threads hold the others, so that there is an end to what they send.
        drop(sender);
        let (mut ready, mut count) = (BTreeMap::new(), 0);
        for (place, piece, made) in receiver {
            ready.insert(place, (piece, made));
            while let Some((piece, made)) = ready.remove(&count) {
                // The other threads wait for this piece.
                let made = made.unwrap_or_else(|fault| {
                    tell(ENDED);
                    resume_unwind(fault)
                });
                if let Err(fault) = take(piece, made) {
                    tell(ENDED);
                    return Err(fault);
                }
                count += 1;
                tell(count);
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn lines_come_in_order_and_few_are_ahead() {
        let numbers: Vec<usize> = (0..200).map(|i| 3 * i).collect();
        for jobs in [1, 2, 5] {
            let made = AtomicUsize::new(0);
            let mut found = Vec::new();
            each(
                numbers.iter().copied(),
                jobs,
                |number| {
                    made.fetch_add(1, Ordering::SeqCst);
                    if number == 0 {
                        std::thread::sleep(std::time::Duration::from_millis(20));
                        assert!(made.load(Ordering::SeqCst) <= (AHEAD + 1) * jobs);
                    }
                    number
                },
                |number, made| {
                    assert_eq!(number, made);
                    found.push(number);
                    Ok::<(), miette::Report>(())
                },
            )
            .unwrap();
            assert_eq!(found, numbers);
        }
    }

    #[test]
    fn what_cannot_be_taken_ends_the_work() {
        let made = AtomicUsize::new(0);
        let make = |_| made.fetch_add(1, Ordering::SeqCst);
        let ended = each(
            0..1000,
            2,
            make,
            |number, _| if number < 5 { Ok(()) } else { Err(miette::miette!("full")) },
        );
        assert!(ended.is_err() && made.load(Ordering::SeqCst) < 50);
    }

    #[test]
    fn a_fault_ends_the_work_of_all_threads() {
        let run = || each(0..1000, 2, |number| assert!(number != 7), |_, ()| Ok::<(), ()>(()));
        assert!(catch_unwind(run).is_err());
    }
}
