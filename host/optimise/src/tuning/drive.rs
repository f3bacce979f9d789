//! Candidates on many rigs, with their progress.

use anyhow::{Error, Result};

use super::cost::Cost;
use super::memory::Memory;
use super::search::{Budget, Outcome, search};
use super::trial::{MEMBERS, Trial};
use super::{Found, Performance, Space, Task, Variant, fixed};
use pneudrive_evaluate::cancel::{CancelToken, Cancelled};
use pneudrive_evaluate::parallel;

/// The stage of a tuning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Searches for gains.
    Search,
    /// Checks the best few with the perturbed runs of the file's rig.
    Finalists,
    /// Judges them on fresh draws.
    Draws,
    /// Searches for the causes.
    Obstacles,
    /// Follows sines with the gains found.
    Sines,
}

impl Stage {
    /// The stages of the search, in order.
    pub const ALL: [Stage; 4] = [Stage::Search, Stage::Finalists, Stage::Draws, Stage::Obstacles];
}

/// The progress of a stage of a tuning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage.
    pub stage: Stage,
    /// Runs that are done or no longer needed: a candidate that is worse than the one to beat is given up.
    pub done: usize,
    /// Total number of runs of this stage.
    pub all: usize,
}

/// Counts runs.
pub(super) struct Meter<'a> {
    tell: &'a mut (dyn FnMut(Progress) + Send),
    at: Progress,
    /// Number of runs that were made in all stages.
    runs: usize,
}

impl<'a> Meter<'a> {
    pub fn new(tell: &'a mut (dyn FnMut(Progress) + Send)) -> Meter<'a> {
        Meter { tell, at: Progress { stage: Stage::Search, done: 0, all: 0 }, runs: 0 }
    }

    /// Begins a stage that needs this many runs.
    pub fn begin(&mut self, stage: Stage, all: usize) {
        self.at = Progress { stage, done: 0, all };
        (self.tell)(self.at);
    }

    /// Counts this many runs of the stage as no longer needed.
    pub fn done(&mut self, runs: usize) {
        self.at.done += runs;
        (self.tell)(self.at);
    }

    /// Candidates that were run before an interruption, on this many variants each.
    fn recall(&mut self, known: &[Cost], variants: usize) {
        self.runs += known.iter().map(|one| one.runs).sum::<usize>();
        self.done(known.len() * variants);
    }

    pub fn runs(&self) -> usize {
        self.runs
    }
}

/// A rig to be tuned, and the meaning of its genes: in its own counts and samples.
pub(super) struct TunedDrive<'a> {
    pub task: &'a Task,
    pub trial: Trial,
    pub space: Space,
    /// Keys that are set beside those of the task.
    more: Vec<String>,
    pub with: Companions<'a>,
}

/// What goes with a tuning.
#[derive(Clone, Copy)]
pub(super) struct Companions<'a> {
    /// Ends the tuning early.
    pub cancel: CancelToken<'a>,
    /// What is computed already.
    pub memory: &'a Memory,
}

impl TunedDrive<'_> {
    /// The rig of a task; `more` keys are set.
    pub fn of<'a>(task: &'a Task, more: &[String], with: Companions<'a>) -> Result<TunedDrive<'a>> {
        let trial = Trial::of(task, more)?;
        task.spread.check(&trial.rig)?;
        let space = Space::of(&trial.rig, task.goal.settled_mm, &fixed::keys(task))?;
        Ok(TunedDrive { task, trial, space, more: more.to_vec(), with })
    }

    /// The step with these gains on a variant of the rig, unless the tuning is cancelled.
    fn run(&self, settings: &[String], variant: &Variant) -> Performance {
        if self.with.cancel.is_live() {
            self.trial.run(settings, variant)
        } else {
            Performance::failed(Cancelled.to_string())
        }
    }

    /// The last generation of a search; of none, nothing.
    pub fn search(
        &self,
        budget: &Budget,
        start: &[Vec<f64>],
        variants: &[Variant],
        meter: &mut Meter,
    ) -> Outcome {
        if budget.generations == 0 {
            return Outcome { population: Vec::new(), history: Vec::new() };
        }
        let mut order: Vec<usize> = (0..variants.len()).collect();
        let mut refused = vec![0_usize; variants.len()];
        let costs = |variables: &[Vec<f64>], limits: &[f64]| {
            let found = self.costs_once(variables, limits, (variants, &order), meter);
            for place in found.iter().filter_map(|one| one.given_up_at) {
                refused[order[place]] += 1;
            }
            // The variants that have refused most candidates come first: a poor candidate then costs a run or two.
            order.sort_by_key(|&place| (std::cmp::Reverse(refused[place]), place));
            found.iter().map(|one| one.mean).collect()
        };
        search(self.space.len(), budget, start, costs)
    }

    /// The cost of each candidate, computed now or before an interruption.
    fn costs_once(
        &self,
        variables: &[Vec<f64>],
        limits: &[f64],
        (variants, order): (&[Variant], &[usize]),
        meter: &mut Meter,
    ) -> Vec<Cost> {
        let question = (&self.more, variables, limits, order);
        if let Some(known) = self.with.memory.recalled(&question) {
            meter.recall(&known, variants.len());
            return known;
        }
        let ordered: Vec<&Variant> = order.iter().map(|&place| &variants[place]).collect();
        let found = self.costs(variables, limits, &ordered, meter);
        if self.with.cancel.is_live() {
            self.with.memory.keep(&question, &found);
        }
        found
    }

    /// The cost of each candidate: the mean over the variants. One that is above its limit, whatever the variants that
    /// are left may show, is not looked at any further.
    fn costs(
        &self,
        variables: &[Vec<f64>],
        limits: &[f64],
        variants: &[&Variant],
        meter: &mut Meter,
    ) -> Vec<Cost> {
        let cost = |(variables, limit): &(&Vec<f64>, f64)| {
            let settings = self.space.settings(variables);
            let mut cost = Cost { mean: 0.0, given_up_at: None, runs: 0 };
            for (place, variant) in variants.iter().enumerate() {
                cost.runs += 1;
                let of_one = self.run(&settings, variant).cost(&self.task.goal);
                cost.mean += of_one / variants.len() as f64;
                if cost.mean > *limit + ROUNDING {
                    cost.given_up_at = Some(place);
                    break;
                }
            }
            cost
        };
        let jobs: Vec<(&Vec<f64>, f64)> = variables.iter().zip(limits.iter().copied()).collect();
        let costs = parallel::map(&jobs, cost, |_| meter.done(variants.len()));
        meter.runs += costs.iter().map(|one| one.runs).sum::<usize>();
        costs
    }

    /// A candidate of the last generation, or the gains of the file, on the draws of the search and on the perturbed
    /// runs of the file's rig.
    pub(crate) fn finalist(&self, shares: Option<&[f64]>, tuned_on: &[Variant], meter: &mut Meter) -> Found {
        let settings = shares.map_or_else(Vec::new, |shares| self.space.settings(shares));
        let places = shares.map_or_else(Vec::new, |shares| self.space.places(shares));
        let performances = self.judged(&settings, tuned_on, meter);
        let members =
            self.with.cancel.check().map_err(Error::from).and_then(|()| self.trial.members(&settings));
        meter.runs += MEMBERS;
        meter.done(MEMBERS);
        let members = members.unwrap_or_else(|error| vec![Performance::failed(format!("{error:#}"))]);
        Found { settings, places, tuned_on: performances, members, fresh: Vec::new() }
    }

    /// Gains on every variant.
    pub fn judged(&self, settings: &[String], variants: &[Variant], meter: &mut Meter) -> Vec<Performance> {
        let run = |variant: &Variant| self.run(settings, variant);
        let performances = parallel::map(variants, run, |_| meter.done(1));
        meter.runs += variants.len();
        performances
    }
}

/// Sums in another order of the variants differ by less.
const ROUNDING: f64 = 1e-12;
