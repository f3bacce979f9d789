//! The same for each of many, on several threads.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// As many threads as the machine has processors.
#[must_use]
pub fn processors() -> NonZeroUsize {
    thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// What `make` makes of each item, in their order: each thread takes the next item as soon as it is free, and which
/// thread that is changes nothing. `progress` is given items done.
pub fn map<T: Sync, U: Send>(
    items: &[T],
    threads: NonZeroUsize,
    make: impl Fn(&T) -> U + Sync,
    mut progress: impl FnMut(usize),
) -> Vec<U> {
    let (next, make) = (AtomicUsize::new(0), &make);
    let mut made: Vec<Option<U>> = items.iter().map(|_| None).collect();
    thread::scope(|scope| {
        let (give, taken) = channel();
        for _ in 0..threads.get().min(items.len()) {
            let (give, next) = (give.clone(), &next);
            scope.spawn(move || {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(place) else { return };
                    if give.send((place, make(item))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(give);
        for (done, (place, one)) in (1..).zip(taken) {
            made[place] = Some(one);
            progress(done);
        }
    });
    made.into_iter().map(|one| one.expect("a thread that panics ends the scope with its panic")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_made_stands_in_the_order_of_the_items_for_any_number_of_threads() {
        let items: Vec<u64> = (0..100).collect();
        for threads in [1, 3, 200] {
            let mut told = Vec::new();
            let threads = NonZeroUsize::new(threads).expect("some");
            let squares = map(&items, threads, |item| item * item, |done| told.push(done));
            assert!(squares.iter().zip(&items).all(|(square, item)| *square == item * item));
            assert!(told.into_iter().eq(1..=100));
        }
        assert!(map(&items[..0], NonZeroUsize::MIN, |item| *item, |_| {}).is_empty());
    }
}
