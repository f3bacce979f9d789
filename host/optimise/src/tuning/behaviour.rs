//! The behaviour of a drive with its gains, beside the goal: the step along the stroke, and sines.

use anyhow::Result;

use super::stroke::{AtPlace, along_the_stroke};
use super::tracking::{self, Tracked, tracked};
use super::{Progress, Task, Tuned};
use pneudrive_evaluate::cancel::CancelToken;

/// The behaviour of a drive with its gains.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// The step along the stroke, with the gains that were found.
    pub steps: Vec<AtPlace>,
    /// Sines, also with the file's gains.
    pub sines: Vec<Tracked>,
}

impl Behaviour {
    /// The behaviour after a tuning; `progress` is told of the sines.
    ///
    /// # Errors
    /// When it cannot be simulated, or nobody waits for it any more.
    pub fn of(
        task: &Task,
        tuned: &Tuned,
        progress: impl FnMut(Progress) + Send,
        cancel: CancelToken<'_>,
    ) -> Result<Behaviour> {
        let steps = along_the_stroke(task, tuned)?;
        let sines = tracked(task, tuned, progress, cancel)?;
        cancel.check()?;
        Ok(Behaviour { steps, sines })
    }
}

/// How long that takes together with the page, in runs of the step.
#[must_use]
pub fn steps_worth(task: &Task) -> f64 {
    tracking::steps_worth(task) + (super::stroke::RUNS + task.draws) as f64
}
