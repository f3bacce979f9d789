//! Drives of one's own drawn at random: each runs, or is refused by the answer that is wrong, with answers that make a rig.

use crate::outcome::{Outcome, outcome};

#[test]
fn a_drawn_drive_runs_or_is_refused_with_answers_that_make_a_rig() {
    let outcomes: Vec<Outcome> = (0..40).map(outcome).collect();
    let failed: Vec<&Outcome> = outcomes.iter().filter(|one| matches!(one, Outcome::Fails(_))).collect();
    assert!(failed.is_empty(), "{failed:#?}");
    let run = outcomes.iter().filter(|one| **one == Outcome::Runs).count();
    assert!((20..40).contains(&run), "{run} of 40 run");
}
