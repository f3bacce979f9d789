//! Gains for a drive: a step there and back, on rigs and at positions drawn from a stated spread.
//!
//! ```text
//! genes in [0, 1] -> gains, windows, dither, null -> runs of the step on draws from the spread -> mean cost
//!        ^______________________ differential evolution _______________________________________________|
//! the best few -> perturbed runs of the file's rig -> the one with the least cost -> fresh draws -> how often it meets the goal
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`behaviour`] | the drive with its gains beside the goal: the step along the stroke, sines |
//! | [`gains`] | the design variables, in units that suit every rig, and the keys that they set |
//! | [`fixed`] | which keys a user may fix |
//! | [`goal`] | the goal of a step, and the cost of a run |
//! | [`spread`] | the rigs that the drive may turn out to be, and the positions and directions of its steps |
//! | [`stroke`] | the step at five positions of the stroke |
//! | [`tracking`] | sines with the gains found, and the limits on following them |
//! | [`trial`] | the step on a rig |
//! | [`mod@search`] | differential evolution |
//! | [`drive`] | candidates on many rigs, and how far that is |
//! | [`memory`] | what an interrupted search goes on from |
//! | [`limiting_imperfection`] | which parameter of the rig is in the way |
//! | [`proportion`] | how often a goal is met, and how well that is known |
//! | [`report`] | the page, and the rig file |
//!
//! The same seed finds the same gains, whatever the number of threads.

pub mod behaviour;
mod cost;
mod design_variable;
pub mod drive;
pub mod fixed;
pub mod gains;
pub mod goal;
pub mod limiting_imperfection;
pub mod memory;
pub mod proportion;
pub mod report;
pub mod search;
pub mod spread;
pub mod stroke;
pub mod tracking;
pub mod trial;

use anyhow::Result;

pub use behaviour::Behaviour;
pub use drive::{Progress, Stage};
pub use gains::{Optimum, Space};
pub use goal::{Goal, Performance};
pub use limiting_imperfection::LimitingImperfection;
pub use proportion::Proportion;
pub use spread::{Relative, Variant};

use drive::{Companions, Meter, TunedDrive};
use memory::Memory;
use pneudrive_evaluate::cancel::CancelToken;
use search::Budget;

/// The task.
#[derive(Clone, Debug)]
pub struct Task {
    /// The name of the rig file, for messages, and its text.
    pub source: (String, String),
    /// The user's settings, as `key=value`.
    pub settings: Vec<String>,
    /// Keys that no search changes, as `key=value`.
    pub fixed: Vec<String>,
    /// The requirements on a step.
    pub goal: Goal,
    /// The spread: by how much the real rig may differ from the file.
    pub spread: Relative,
    /// Lowest and highest position of a step, mm; None: as far as the rig allows.
    pub between_mm: [Option<f64>; 2],
    /// Number of draws on which the gains are judged.
    pub draws: usize,
    /// The size of the search; with 0 generations the gains of the file are judged.
    pub budget: Budget,
}

impl Task {
    /// The same without a search, judged on one draw: the time of its runs gives the longest time of all.
    #[must_use]
    pub fn taste(&self) -> Task {
        Task { draws: 1, budget: Budget { generations: 0, ..self.budget }, ..self.clone() }
    }

    /// The largest number of runs that it takes: no candidate is given up early, and every suspect is tried.
    ///
    /// # Errors
    /// When the rig has no gains to look for.
    pub fn max_runs(&self) -> Result<usize> {
        let with = Companions { cancel: CancelToken::NEVER, memory: &Memory::default() };
        let drive = TunedDrive::of(self, &[], with)?;
        let each = spread::tuned_on(&self.spread, self.budget.seed).len();
        let finalists = (FINALISTS + 1) * (each + trial::MEMBERS);
        let of_suspect = limiting_imperfection::budget(&self.budget).runs(each) + each + self.draws;
        let suspects = match self.budget.generations {
            0 => 0,
            _ => limiting_imperfection::suspects(&drive.trial.rig).len(),
        };
        Ok(self.budget.runs(each) + finalists + 2 * self.draws + suspects * of_suspect)
    }
}

/// Gains and their results.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The gains, as `key=value`; empty: those of the file.
    pub settings: Vec<String>,
    /// The values found, each with the range that was searched; empty: the gains of the file.
    pub places: Vec<Optimum>,
    /// Trials on the draws of the search.
    pub tuned_on: Vec<Performance>,
    /// Trials on the rig of the file and its perturbed runs; empty where they were not run.
    pub members: Vec<Performance>,
    /// Trials on the fresh draws.
    pub fresh: Vec<Performance>,
}

impl Found {
    /// Mean cost on the draws of the search, and on the worst of the perturbed runs of the file's rig.
    #[must_use]
    pub fn cost(&self, goal: &Goal) -> f64 {
        let worst = self.members.iter().map(|one| one.cost(goal)).reduce(f64::max);
        let all = self.tuned_on.iter().map(|one| one.cost(goal)).chain(worst);
        all.sum::<f64>() / (self.tuned_on.len() + usize::from(worst.is_some())) as f64
    }

    /// In how many of the fresh draws the goal is met.
    #[must_use]
    pub fn met(&self, goal: &Goal) -> Proportion {
        goal.met_in(&self.fresh)
    }
}

/// The result.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// The rigs for the search; the first one is the rig of the file.
    pub tuned_on: Vec<Variant>,
    /// The rigs for the judgement.
    pub fresh: Vec<Variant>,
    /// The gains of the file.
    pub before: Found,
    /// The gains found; the file's, if no better ones were found.
    pub after: Found,
    /// The best cost of each generation.
    pub progress: Vec<f64>,
    /// The causes, if the goal is not met.
    pub obstacles: Vec<LimitingImperfection>,
    /// Runs in all.
    pub runs: usize,
}

impl Tuned {
    /// Whether other gains than the file's were found.
    #[must_use]
    pub(crate) fn is_changed(&self) -> bool {
        !self.after.settings.is_empty()
    }
}

/// This many of the last generation are checked with the perturbed runs of the file's rig.
const FINALISTS: usize = 3;

/// Searches for gains, and reports the progress to `progress`.
///
/// # Errors
/// When the rig has no gains to look for, a key cannot be held, the step does not fit into its stroke, or nobody waits
/// for it any more ([`Cancelled`](pneudrive_evaluate::cancel::Cancelled)).
pub fn tune(task: &Task, progress: impl FnMut(Progress) + Send, cancel: CancelToken<'_>) -> Result<Tuned> {
    tune_with(task, progress, cancel, &Memory::default())
}

/// The same with what an interrupted search of the task has computed already.
///
/// # Errors
/// As for [`tune`].
pub fn tune_with(
    task: &Task,
    mut progress: impl FnMut(Progress) + Send,
    cancel: CancelToken<'_>,
    memory: &Memory,
) -> Result<Tuned> {
    fixed::check(task)?;
    let drive = TunedDrive::of(task, &[], Companions { cancel, memory })?;
    let (tuned_on, fresh) = (
        spread::tuned_on(&task.spread, task.budget.seed),
        spread::fresh(&task.spread, task.budget.seed, task.draws),
    );
    let mut meter = Meter::new(&mut progress);
    meter.begin(Stage::Search, task.budget.runs(tuned_on.len()));
    let outcome = drive.search(&task.budget, &[], &tuned_on, &mut meter);
    let finalists = &outcome.population[..outcome.population.len().min(FINALISTS)];
    let finalists: Vec<Option<&[f64]>> =
        std::iter::once(None).chain(finalists.iter().map(|shares| Some(shares.as_slice()))).collect();
    meter.begin(Stage::Finalists, finalists.len() * (tuned_on.len() + trial::MEMBERS));
    let mut finalists: Vec<Found> =
        finalists.iter().map(|shares| drive.finalist(*shares, &tuned_on, &mut meter)).collect();
    let best = (0..finalists.len())
        .min_by(|&a, &b| finalists[a].cost(&task.goal).total_cmp(&finalists[b].cost(&task.goal)));
    let mut after = finalists.swap_remove(best.unwrap_or(0));
    let mut before = if after.settings.is_empty() { after.clone() } else { finalists.swap_remove(0) };
    meter.begin(Stage::Draws, fresh.len() * if after.settings.is_empty() { 1 } else { 2 });
    after.fresh = drive.judged(&after.settings, &fresh, &mut meter);
    before.fresh = if after.settings.is_empty() {
        after.fresh.clone()
    } else {
        drive.judged(&before.settings, &fresh, &mut meter)
    };
    let met = after.met(&task.goal);
    let obstacles = if met.met < met.of && task.budget.generations > 0 {
        limiting_imperfection::search(task, &drive, &outcome.population, [&tuned_on, &fresh], &mut meter)?
    } else {
        Vec::new()
    };
    cancel.check()?;
    let runs = meter.runs();
    Ok(Tuned { tuned_on, fresh, before, after, progress: outcome.history, obstacles, runs })
}

#[cfg(test)]
mod tests;
