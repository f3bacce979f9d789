//! The verdict on a tuning, in a sentence or two.

use super::super::{Task, Tuned};

/// How often the goal is met in fresh draws, and in the trials that the gains were tuned on.
#[must_use]
pub fn verdict(task: &Task, tuned: &Tuned) -> String {
    let goal = &task.goal;
    let fresh = format!("The goal is met in {} of the fresh draws", tuned.after.met(goal));
    if !tuned.is_changed() {
        let why = if task.budget.generations == 0 {
            "with the gains of the file, without a search"
        } else {
            "with the gains of the file; the search found none that are better in its own trials"
        };
        return format!("{fresh}, {why}.");
    }
    let seen = goal.met_in(&tuned.after.tuned_on);
    format!(
        "{fresh} (in brackets 95 % intervals), and in {} of {} trials that the gains were tuned on. With the gains of the file it is met in {} of the same fresh draws.",
        seen.met,
        seen.of,
        tuned.before.met(goal)
    )
}
