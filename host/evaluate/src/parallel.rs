//! Parallel maps on the threads of one pool.
//!
//! The pool is rayon's: the program sets its number of threads, by default one for each processor; on a system without
//! threads (wasm), the caller does all the work. The result does not depend on which thread computes what.

use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

/// Threads of the pool.
#[must_use]
pub fn threads() -> NonZeroUsize {
    NonZeroUsize::new(rayon::current_num_threads()).unwrap_or(NonZeroUsize::MIN)
}

/// The results of `make` for each item, in their order. `progress` is given the number of items done.
pub fn map<T: Sync, U: Send>(
    items: &[T],
    make: impl Fn(&T) -> U + Sync,
    progress: impl FnMut(usize) + Send,
) -> Vec<U> {
    let told = Mutex::new((0, progress));
    let one = |item: &T| {
        let made = make(item);
        let (done, progress) = &mut *told.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        progress(*done);
        made
    };
    items.par_iter().with_max_len(1).map(one).collect()
}

/// Gives the result of `make` for each item to `take`, one after the other as they are finished. After an error no item is
/// started.
///
/// # Errors
/// The first one of `take`.
pub fn each<T: Sync, U, E: Send>(
    items: &[T],
    make: impl Fn(&T) -> U + Sync,
    take: impl FnMut(U) -> Result<(), E> + Send,
) -> Result<(), E> {
    let take = Mutex::new(take);
    items.par_iter().with_max_len(1).try_for_each(|item| {
        let made = make(item);
        let take = &mut *take.lock().unwrap_or_else(PoisonError::into_inner);
        take(made)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(work)
    }

    #[test]
    fn what_is_made_stands_in_the_order_of_the_items_for_any_number_of_threads() {
        let items: Vec<u64> = (0..100).collect();
        for threads in [1, 3, 200] {
            let mut told = Vec::new();
            let squares = on(threads, || map(&items, |item| item * item, |done| told.push(done)));
            assert!(squares.iter().zip(&items).all(|(square, item)| *square == item * item));
            assert!(told.into_iter().eq(1..=100));
        }
        assert!(map(&items[..0], |item| *item, |_| {}).is_empty());
    }

    #[test]
    fn a_map_within_a_map_comes_to_its_end_on_any_number_of_threads() {
        let items: Vec<u64> = (0..20).collect();
        let sum = |outer: &u64| map(&items, |inner| outer * inner, |_| {}).into_iter().sum::<u64>();
        for threads in [1, 2, 5] {
            let sums = on(threads, || map(&items, sum, |_| {}));
            assert!(sums.iter().zip(&items).all(|(sum, outer)| *sum == outer * 190));
        }
    }

    #[test]
    fn each_is_taken_once_and_none_is_begun_after_an_error() {
        let items: Vec<u64> = (0..100).collect();
        let mut taken = Vec::new();
        let take = |item| {
            taken.push(item);
            Ok::<(), ()>(())
        };
        assert_eq!(on(3, || each(&items, |item| *item, take)), Ok(()));
        taken.sort_unstable();
        assert_eq!(taken, items);
        let mut before = 0;
        let full = |_| {
            before += 1;
            if before == 5 { Err("full") } else { Ok(()) }
        };
        assert_eq!(on(1, || each(&items, |item| *item, full)), Err("full"));
        assert_eq!(before, 5);
    }
}
