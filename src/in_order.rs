//! Pieces of work to what is made of them: each on one of so many threads, handed over in order, so many ahead at most.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError, mpsc};

/// Pieces that may be ready before the one that is waited for, for each job: more would be held in memory.
const AHEAD: usize = 4;

/// Makes something of each of `pieces` by `make` on `jobs` threads, one core each, and hands it to `take` in their order.
///
/// # Errors
/// The first of `take`; what is being made then is ended, and no more begun.
pub fn each<P: Copy + Sync, T: Send, E>(
    pieces: &[P],
    jobs: usize,
    make: impl Fn(P) -> T + Sync,
    mut take: impl FnMut(P, T) -> Result<(), E>,
) -> Result<(), E> {
    let (next, taken, moved) = (AtomicUsize::new(0), Mutex::new(0_usize), Condvar::new());
    let (sender, receiver) = mpsc::channel();
    let work = || {
        // What a piece shares among threads stays on this one: pieces are what is shared here. A thread that waits for another would begin a
        // second piece in the middle of the first, and hold both.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let sender = sender.clone();
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(&piece) = pieces.get(place) else { return };
            let lead = taken.lock().unwrap_or_else(PoisonError::into_inner);
            drop(moved.wait_while(lead, |taken| place >= taken.saturating_add(AHEAD * jobs)));
            let made = match &pool {
                Ok(pool) => pool.install(|| make(piece)),
                Err(_) => make(piece),
            };
            if sender.send((place, made)).is_err() {
                return;
            }
        }
    };
    let end = |at: usize| {
        *taken.lock().unwrap_or_else(PoisonError::into_inner) = at;
        moved.notify_all();
    };
    std::thread::scope(|scope| {
        for _ in 0..jobs.min(pieces.len()) {
            scope.spawn(work);
        }
        let mut ready = BTreeMap::new();
        for (place, &piece) in pieces.iter().enumerate() {
            let made = loop {
                if let Some(made) = ready.remove(&place) {
                    break made;
                }
                // The threads end when all is made, so that there is always one that sends.
                let Ok((place, made)) = receiver.recv() else { return Ok(()) };
                ready.insert(place, made);
            };
            if let Err(fault) = take(piece, made) {
                next.store(pieces.len(), Ordering::Relaxed);
                end(usize::MAX);
                return Err(fault);
            }
            end(place + 1);
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_in_order_and_few_are_ahead() {
        let numbers: Vec<usize> = (0..200).map(|i| 3 * i).collect();
        for jobs in [1, 2, 5] {
            let made = AtomicUsize::new(0);
            let mut found = Vec::new();
            each(
                &numbers,
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
        let numbers: Vec<usize> = (0..1000).collect();
        let make = |_| made.fetch_add(1, Ordering::SeqCst);
        let ended = each(
            &numbers,
            2,
            make,
            |number, _| if number < 5 { Ok(()) } else { Err(miette::miette!("full")) },
        );
        assert!(ended.is_err() && made.load(Ordering::SeqCst) < 50);
    }
}
