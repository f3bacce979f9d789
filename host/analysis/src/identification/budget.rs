//! What a search may cost: evaluations of the model's equations, which no clock and no other program changes.
//!
//! A fit that ends at noise takes a small part of it. Where noise alone is not reached the search for another minimum or a
//! cause goes on as long as something is left; what was not looked at then is told.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Evaluations of all runs together.
const ALL: u64 = 150_000_000;

/// Evaluations of a run for each of its samples: a hundred times what they take where the model is near the rig.
const OF_A_SAMPLE: u64 = 5_000;

/// A search may go on for so many times what its first minimum took, where that is more.
const OF_FIRST: u64 = 3;

/// What is left to spend, counted for all copies of a model together.
#[derive(Clone, Debug, Default)]
pub(super) struct Budget {
    spent: Arc<AtomicU64>,
    /// What may be spent; None before the first minimum, which is found whatever that takes.
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

    /// The first minimum is found: from now on there is an end.
    pub fn limit(&mut self) {
        let spent = self.spent.load(Ordering::Relaxed);
        self.most.get_or_insert(ALL.max(OF_FIRST * spent));
    }

    /// Whether nothing is left.
    pub fn is_spent(&self) -> bool {
        self.most.is_some_and(|most| self.spent.load(Ordering::Relaxed) >= most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_ends_after_its_first_minimum_alone_and_all_copies_share_what_is_left() {
        let mut budget = Budget::default();
        budget.spend(ALL);
        assert!(!budget.is_spent());
        budget.limit();
        let copy = budget.clone();
        copy.spend(2 * ALL - 1);
        assert!(!budget.is_spent(), "three times as much as the first minimum");
        copy.spend(1);
        assert!(budget.is_spent() && copy.is_spent());
        budget.limit();
        assert!(budget.is_spent(), "the end does not move");
    }
}
