//! The state of a download: a window of requests over the chunks of a record, with selective repeat. No input or output
//! here, no clock.
//!
//! A chunk is missing, requested, or there. Answers come in the order of the requests, so a chunk whose answer is
//! overtaken is lost, and is requested again before any new one. When the line falls silent, all requested chunks are
//! lost. However often a chunk arrives, it is taken once.

use std::collections::VecDeque;

/// Requests in flight at once. Eight chunks take 40 ms at 921,600 baud: the line does not idle as long as a request and
/// its answer take less.
pub(crate) const WINDOW: usize = 8;

/// The state of a download.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Download {
    there: Vec<bool>,
    /// Chunks that are not there yet.
    missing: usize,
    /// Requested, in this order.
    asked: VecDeque<usize>,
    /// Lost, to be requested again.
    lost: VecDeque<usize>,
    /// Chunks before this one have been requested, or were there from the beginning.
    fresh: usize,
    repeats: usize,
}

impl Download {
    /// A download of this many chunks, none of which is there.
    #[must_use]
    pub fn new(chunks: usize) -> Download {
        Download {
            there: vec![false; chunks],
            missing: chunks,
            asked: VecDeque::with_capacity(WINDOW),
            lost: VecDeque::new(),
            fresh: 0,
            repeats: 0,
        }
    }

    /// The next chunk to request, while the window has room; it counts as requested from now on.
    pub fn ask(&mut self) -> Option<usize> {
        if self.asked.len() >= WINDOW {
            return None;
        }
        let chunk = self.next_missing().or_else(|| self.next_fresh())?;
        self.asked.push_back(chunk);
        Some(chunk)
    }

    /// A chunk that was lost and has not arrived late.
    fn next_missing(&mut self) -> Option<usize> {
        while let Some(chunk) = self.lost.pop_front() {
            if !self.there[chunk] {
                self.repeats += 1;
                return Some(chunk);
            }
        }
        None
    }

    /// A chunk that was never requested.
    fn next_fresh(&mut self) -> Option<usize> {
        let chunk = (self.fresh..self.there.len()).find(|&chunk| !self.there[chunk])?;
        self.fresh = chunk + 1;
        Some(chunk)
    }

    /// Records the arrival of a chunk. True if it was missing: then it is to be taken.
    pub fn arrived(&mut self, chunk: usize) -> bool {
        let Some(there @ false) = self.there.get_mut(chunk) else { return false };
        *there = true;
        self.missing -= 1;
        if let Some(place) = self.asked.iter().position(|&asked| asked == chunk) {
            self.lost.extend(self.asked.drain(..place));
            self.asked.pop_front();
        }
        true
    }

    /// Records a silence that was too long: all requested chunks are lost.
    pub(crate) fn fell_silent(&mut self) {
        self.lost.extend(self.asked.drain(..));
    }

    /// Whether all chunks are there.
    #[must_use]
    pub(crate) fn is_complete(&self) -> bool {
        self.missing == 0
    }

    /// Chunks that are there.
    #[must_use]
    pub fn arrivals(&self) -> usize {
        self.there.len() - self.missing
    }

    /// Requests that were sent again.
    #[must_use]
    pub fn repeats(&self) -> usize {
        self.repeats
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    fn asked(download: &mut Download) -> Vec<usize> {
        std::iter::from_fn(|| download.ask()).collect()
    }

    #[test]
    fn a_window_of_chunks_is_asked_for_and_each_arrival_makes_room_for_the_next() {
        let mut download = Download::new(20);
        assert_eq!(asked(&mut download), (0..WINDOW).collect::<Vec<_>>());
        assert!(download.arrived(0));
        assert_eq!(asked(&mut download), [WINDOW]);
        assert_eq!((download.arrivals(), download.repeats(), download.is_complete()), (1, 0, false));
    }

    #[test]
    fn a_chunk_that_is_overtaken_is_asked_for_again_before_new_ones_and_no_other_is() {
        let mut download = Download::new(20);
        asked(&mut download);
        assert!(download.arrived(2), "0 and 1 are lost");
        assert_eq!(asked(&mut download), [0, 1, 8]);
        assert_eq!(download.repeats(), 2);
        assert!(download.arrived(0), "it was late, not lost: 3 to 7 are asked for again, none is lost twice");
    }

    #[test]
    fn silence_loses_what_was_asked_for_and_what_comes_late_after_all_is_not_asked_for_again() {
        let mut download = Download::new(3);
        assert_eq!(asked(&mut download), [0, 1, 2]);
        download.fell_silent();
        assert!(download.arrived(1));
        assert_eq!(asked(&mut download), [0, 2]);
        assert!(download.arrived(0) && download.arrived(2) && download.is_complete());
        assert!(asked(&mut download).is_empty());
    }

    #[test]
    fn a_chunk_is_taken_once_and_one_that_the_record_does_not_have_never() {
        let mut download = Download::new(2);
        asked(&mut download);
        assert!(download.arrived(1));
        assert!(!download.arrived(1));
        assert!(!download.arrived(2));
        assert!(!download.is_complete());
    }

    #[test]
    fn what_an_earlier_call_got_is_not_asked_for() {
        let mut download = Download::new(5);
        assert!(download.arrived(0) && download.arrived(3));
        assert_eq!(asked(&mut download), [1, 2, 4]);
    }

    #[test]
    fn a_record_without_samples_is_complete() {
        assert!(Download::new(0).is_complete());
        assert_eq!(Download::new(0).ask(), None);
    }

    proptest! {
        /// Whatever arrives, is lost or comes twice, in whatever order: no more are on their way than the
        /// window holds, none is on its way twice, and asking and hearing on ends with every chunk taken
        /// once.
        #[test]
        fn every_chunk_is_taken_once(
            chunks in 0..60usize,
            events in vec((any::<prop::sample::Index>(), 0..4u8), 0..200),
        ) {
            let mut download = Download::new(chunks);
            let mut taken = vec![0; chunks];
            let mut hear = |download: &mut Download, chunk: usize| {
                if download.arrived(chunk) {
                    taken[chunk] += 1;
                }
            };
            for (which, what) in events {
                asked(&mut download);
                let on_their_way: Vec<usize> = download.asked.iter().copied().collect();
                prop_assert!(on_their_way.len() <= WINDOW);
                prop_assert!((1..on_their_way.len()).all(|i| !on_their_way[i..].contains(&on_their_way[i - 1])));
                match what {
                    0 => download.fell_silent(),
                    1 if chunks > 0 => hear(&mut download, which.index(chunks)),
                    _ if !on_their_way.is_empty() => hear(&mut download, on_their_way[which.index(on_their_way.len())]),
                    _ => {}
                }
            }
            for _ in 0..=chunks {
                asked(&mut download);
                if let Some(&chunk) = download.asked.front() {
                    hear(&mut download, chunk);
                }
            }
            prop_assert!(download.is_complete());
            prop_assert_eq!(taken, vec![1; chunks]);
        }
    }
}
