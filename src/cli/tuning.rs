//! Work to the same work with threads awake and memory kept: what the machine gains by, measured in
//! docs/measured/time-and-memory.md.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Threads that are kept awake at most: an analysis shares its work among a few.
const MOST: usize = 3;

/// Whether some work has the pool's threads look out for it: two of them would wait for each other's.
static IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// Gives a flag another value where work is over, also where it panics.
struct Then<'a>(&'a AtomicBool, bool);

impl Drop for Then<'_> {
    fn drop(&mut self) {
        self.0.store(self.1, Ordering::Release);
    }
}

/// Does `work` on a thread of the pool while others look out for what it shares with them.
///
/// An analysis shares pieces of a tenth of a millisecond upwards. A thread that has gone to sleep in between
/// takes as long to wake, on a virtual machine up to two milliseconds. Those that look out give way to any
/// other process. Of works at one time the first has them look out.
pub fn keep_threads_awake<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    if IS_TAKEN.swap(true, Ordering::AcqRel) {
        return rayon::scope(|_| work());
    }
    let _free = Then(&IS_TAKEN, false);
    let (is_over, awake) = (AtomicBool::new(false), AtomicUsize::new(0));
    rayon::scope(|scope| {
        // The thread that works is one of the pool's.
        let own = rayon::current_thread_index().unwrap_or(0);
        let (is_over, awake) = (&is_over, &awake);
        scope.spawn_broadcast(move |_, thread| {
            let rank = thread.index() - usize::from(thread.index() > own);
            if thread.index() == own || rank >= MOST {
                return;
            }
            awake.fetch_add(1, Ordering::AcqRel);
            while !is_over.load(Ordering::Acquire) {
                if rayon::yield_now() != Some(rayon::Yield::Executed) {
                    std::thread::yield_now();
                }
            }
        });
        // A thread that took a piece of the work before it looks out would look out in the middle of that
        // piece, and never end it.
        while awake.load(Ordering::Acquire) < MOST.min(rayon::current_num_threads() - 1) {
            std::thread::yield_now();
        }
        let _over = Then(is_over, true);
        work()
    })
}

/// Lets the many pieces of an analysis take their memory from those before them. glibc gives freed pieces
/// above a limit back to the system, and each page of the next one is fetched anew; the limit rises to the
/// size of a piece when that is freed, up to 32 MiB.
pub fn keep_freed_memory() {
    const PIECE_BYTES: usize = 31 << 20;
    drop(std::hint::black_box(Vec::<u8>::with_capacity(PIECE_BYTES)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::Mutex;

    /// Sums by pieces that are shared again and again, nested as in an analysis.
    fn shared(depth: u32) -> u64 {
        let piece = |i: u64| if depth == 0 { i } else { shared(depth - 1) };
        (0..4_u64).into_par_iter().map(piece).sum()
    }

    /// Held by each test, for which threads then do look out.
    static ALONE: Mutex<()> = Mutex::new(());

    #[test]
    fn nested_pieces_all_end() {
        let _alone = ALONE.lock();
        for _ in 0..200 {
            assert_eq!(keep_threads_awake(|| shared(4)), 6 * 4_u64.pow(4));
        }
    }

    #[test]
    fn a_panic_lets_threads_sleep_again() {
        let _alone = ALONE.lock();
        for _ in 0..20 {
            assert!(
                catch_unwind(AssertUnwindSafe(|| keep_threads_awake(|| panic!("as it is meant to"))))
                    .is_err()
            );
        }
        assert_eq!(keep_threads_awake(|| shared(1)), 24);
    }

    #[test]
    fn works_at_one_time_all_end() {
        let _alone = ALONE.lock();
        for _ in 0..100 {
            let both = std::thread::scope(|scope| {
                let works = [(); 3].map(|()| scope.spawn(|| keep_threads_awake(|| shared(3))));
                works.map(|work| work.join().unwrap_or(0))
            });
            assert_eq!(both, [6 * 4_u64.pow(3); 3]);
        }
    }
}
