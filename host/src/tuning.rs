//! Gains for a drive: a step there and back, judged at the worst of all rigs within a stated spread.
//!
//! ```text
//! genes in [0, 1] -> gains, windows, dither, null -> runs of the step on every rig of the spread -> worst cost
//!        ^______________________ differential evolution ______________________________________________|
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`gains`] | what is looked for, in units that fit every rig, and the keys that it becomes |
//! | [`goal`] | what is asked of a step, and what a run costs |
//! | [`spread`] | the rigs that the drive may turn out to be |
//! | [`trial`] | the step on a rig |
//! | [`mod@search`] | differential evolution |
//! | [`obstacle`] | which parameter of the rig is in the way |
//! | [`report`] | the page, and the rig file |
//!
//! The same seed finds the same gains, whatever the number of threads.

pub mod gains;
pub mod goal;
pub mod obstacle;
pub mod report;
pub mod search;
pub mod spread;
pub mod trial;

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::Result;
use pneudrive_sim::Rig;

pub use gains::Space;
pub use goal::{Goal, Performance};
pub use obstacle::Obstacle;
pub use spread::{Relative, Variant};

use crate::parallel;
use search::{Budget, Outcome, search};
use trial::Trial;

/// What is to be done.
#[derive(Clone, Debug)]
pub struct Task {
    /// The rig file, for messages, and its text.
    pub source: (String, String),
    /// Keys that are typed, as `key=value`.
    pub settings: Vec<String>,
    /// What is asked of a step.
    pub goal: Goal,
    /// By how much the rig may be another one.
    pub spread: Relative,
    /// How long is looked for.
    pub budget: Budget,
    /// How many threads look.
    pub threads: NonZeroUsize,
}

/// Gains and what they do.
#[derive(Clone, Debug)]
pub struct Found {
    /// As `key=value`; none: those of the file.
    pub settings: Vec<String>,
    /// On every variant, in their order.
    pub performances: Vec<Performance>,
}

impl Found {
    /// The worst of all variants.
    #[must_use]
    pub fn cost(&self, goal: &Goal) -> f64 {
        self.performances.iter().map(|one| one.cost(goal)).fold(0.0, f64::max)
    }

    /// On how many variants the goal is met.
    #[must_use]
    pub fn met(&self, goal: &Goal) -> usize {
        self.performances.iter().filter(|one| one.meets(goal)).count()
    }
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// The rigs that all was judged on; the first one is the file's.
    pub variants: Vec<Variant>,
    /// The gains of the file.
    pub before: Found,
    /// The gains that were found; those of the file, if no better ones were.
    pub after: Found,
    /// The best cost of each generation.
    pub progress: Vec<f64>,
    /// What is in the way, if the goal is not met.
    pub obstacles: Vec<Obstacle>,
    /// Runs in all.
    pub runs: usize,
}

/// Looks for gains. `progress` is given generations done and in all, and the best cost so far.
///
/// # Errors
/// When the rig has no gains to look for, or the step does not fit into its stroke.
pub fn tune(task: &Task, mut progress: impl FnMut(usize, usize, f64)) -> Result<Tuned> {
    let drive = Drive::of(task, &[])?;
    let variants = spread::all(&task.spread, task.budget.seed);
    let suspects = obstacle::suspects(&drive.trial.rig);
    let later = Budget { generations: obstacle::generations(task.budget.generations), ..task.budget };
    let all = task.budget.generations + suspects.len() * later.generations;
    let (counter, mut done) = (AtomicUsize::new(0), 0);
    let mut progress = |best: f64| {
        done += 1;
        progress(done, all, best);
    };
    let outcome = drive.search(&task.budget, &[], &counter, &mut progress);
    let before = drive.judged(&[], &variants, &counter);
    let mut after = drive.judged(&drive.space.settings(&outcome.best), &variants, &counter);
    if after.cost(&task.goal) >= before.cost(&task.goal) {
        after = before.clone();
    }
    let mut obstacles = Vec::new();
    if after.met(&task.goal) < variants.len() {
        for suspect in suspects {
            let drive = Drive::of(task, &suspect.settings)?;
            let without = drive.search(&later, &outcome.population, &counter, &mut progress);
            let found = drive.judged(&drive.space.settings(&without.best), &variants, &counter);
            obstacles.push(Obstacle { suspect, found });
        }
    }
    let runs = counter.load(Ordering::Relaxed);
    Ok(Tuned { variants, before, after, progress: outcome.history, obstacles, runs })
}

/// A rig to be tuned, and what its genes mean: in its own counts and samples.
struct Drive<'a> {
    task: &'a Task,
    trial: Trial,
    space: Space,
}

impl Drive<'_> {
    /// The rig of a task; `more` keys are set.
    fn of<'a>(task: &'a Task, more: &[String]) -> Result<Drive<'a>> {
        let trial = Trial::of(task, more)?;
        let space = Space::of(&trial.rig, task.goal.settled_mm)?;
        Ok(Drive { task, trial, space })
    }

    fn search(
        &self,
        budget: &Budget,
        start: &[Vec<f64>],
        counter: &AtomicUsize,
        progress: impl FnMut(f64),
    ) -> Outcome {
        let corners = spread::corners(&self.task.spread);
        let costs = |genes: &[Vec<f64>], limits: &[f64]| self.costs(genes, limits, &corners, counter);
        search(self.space.len(), budget, start, costs, progress)
    }

    /// The cost of each candidate: its worst corner. One that is above its limit is not looked at any further.
    fn costs(
        &self,
        genes: &[Vec<f64>],
        limits: &[f64],
        corners: &[Variant],
        counter: &AtomicUsize,
    ) -> Vec<f64> {
        let worst = |(genes, limit): &(&Vec<f64>, f64)| {
            let settings = self.space.settings(genes);
            let mut worst = 0.0_f64;
            for corner in corners {
                counter.fetch_add(1, Ordering::Relaxed);
                worst = worst.max(self.trial.run(&settings, corner).cost(&self.task.goal));
                if worst >= *limit {
                    break;
                }
            }
            worst
        };
        let jobs: Vec<(&Vec<f64>, f64)> = genes.iter().zip(limits.iter().copied()).collect();
        parallel::map(&jobs, self.task.threads, worst, |_| {})
    }

    /// Gains on every variant.
    fn judged(&self, settings: &[String], variants: &[Variant], counter: &AtomicUsize) -> Found {
        counter.fetch_add(variants.len(), Ordering::Relaxed);
        let run = |variant: &Variant| self.trial.run(settings, variant);
        let performances = parallel::map(variants, self.task.threads, run, |_| {});
        Found { settings: settings.to_vec(), performances }
    }
}

/// The rig file of a task.
fn read(task: &Task, more: &[String]) -> Result<Rig> {
    let settings: Vec<String> = task.settings.iter().chain(more).cloned().collect();
    Ok(Rig::read_with(&task.source.0, &task.source.1, &settings)?)
}

#[cfg(test)]
mod tests;
