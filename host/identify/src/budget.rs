//! What a search may cost: evaluations of the model's equations, which no clock and no other program changes.
//!
//! A fit that ends at noise takes a part of it. Where noise alone is not reached the search for another minimum or a cause
//! goes on as long as something is left; what was not looked at then is told.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Times that all records may be followed, as far as evaluations tell: for the first minimum, and altogether.
const FIRST: u64 = 3000;
const ALL: u64 = 4000;

/// The same, to end at a minimum that is known to be near.
const MORE: u64 = 1500;

/// Evaluations altogether. One takes 0.20 to 0.24 us of processor time, with all that is done with it. What has begun is
/// finished, up to a tenth more, so a search ends within a minute of one core.
const MAX_EVALUATIONS: u64 = 225_000_000;

/// Evaluations of a run for each of its samples: a hundred times what they take where the model is near the rig.
const OF_A_SAMPLE: u64 = 5_000;

/// What is left to spend, counted for all copies of a model together.
#[derive(Clone, Debug, Default)]
pub(super) struct Budget {
    spent: Arc<AtomicU64>,
    /// Evaluations that it takes to follow all records once.
    once: u64,
    /// The budget, evaluations; None: unlimited.
    most: Option<u64>,
}

impl Budget {
    /// Evaluations that a run may take.
    pub fn of_a_run(samples: usize) -> u64 {
        OF_A_SAMPLE * samples as u64
    }

    /// Counts evaluations.
    pub fn spend(&self, evaluations: u64) {
        self.spent.fetch_add(evaluations, Ordering::Relaxed);
    }

    /// Evaluations so far.
    pub fn spent(&self) -> u64 {
        self.spent.load(Ordering::Relaxed)
    }

    /// Sets the budget of the first minimum, once all records have been followed.
    pub fn begin(&mut self) {
        self.once = self.spent();
        self.end_after(FIRST);
    }

    /// Sets the budget of the whole search, once the first minimum is found.
    pub fn go_on(&mut self) {
        self.end_after(ALL);
    }

    /// Grants what it takes to reach a minimum from a point near it.
    pub fn finish(&mut self) {
        self.most = Some((self.spent() + MORE * self.once).min(MAX_EVALUATIONS));
    }

    fn end_after(&mut self, times: u64) {
        self.most = Some((times * self.once).min(MAX_EVALUATIONS * times / ALL));
    }

    /// Whether the budget is spent.
    pub fn is_spent(&self) -> bool {
        self.most.is_some_and(|most| self.spent() >= most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_ends_after_its_part_and_all_copies_share_what_is_left() {
        let mut budget = Budget::default();
        budget.spend(7);
        assert!(!budget.is_spent(), "it has not begun");
        budget.begin();
        let copy = budget.clone();
        copy.spend(7 * (FIRST - 1) - 1);
        assert!(!budget.is_spent());
        copy.spend(1);
        assert!(budget.is_spent() && copy.is_spent());
        budget.go_on();
        assert!(!budget.is_spent());
        budget.spend(7 * (ALL - FIRST));
        assert!(budget.is_spent());
        budget.finish();
        budget.spend(7 * MORE - 1);
        assert!(!budget.is_spent());
        budget.spend(1);
        assert!(budget.is_spent());
    }

    #[test]
    fn a_search_on_records_that_are_slow_to_follow_ends_after_a_fixed_number_of_evaluations() {
        let mut budget = Budget::default();
        budget.spend(1_000_000);
        budget.begin();
        budget.go_on();
        budget.spend(MAX_EVALUATIONS - 1_000_001);
        assert!(!budget.is_spent());
        budget.spend(1);
        assert!(budget.is_spent());
    }
}
