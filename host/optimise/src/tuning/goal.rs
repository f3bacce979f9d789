//! The goal of a step, and the cost of a run.
//!
//! The search minimises a cost that favours gains which meet the goal in as many trials as possible and, among those, the
//! fastest. With the time t of a step, a trial costs
//!
//! ```text
//! settling / t       if the goal is met: less than 1
//! 1 + c / (c + 5 s)  if it is not: from 1 to 2
//! ```
//!
//! and gains cost the mean over their trials. The worst trial alone is not a useful cost: if it cannot meet the goal, the
//! search would sacrifice all others for it. c is the distance of a step from the goal: its settling time or, if it does
//! not settle, the time of the step and a second for each multiple of the allowed error at its end. Each percent of
//! excess overshoot adds 0.2 s; a limit cycle adds 0.5 s and a second for each multiple of the settling tolerance in half its
//! swing, a possible one the same with the range of its last quarter. A run that trips costs more than all of that.

use super::Proportion;
use pneudrive_evaluate::evaluation::{Doubt, LimitCycle, Move};

/// The requirements on a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Length of the step, mm.
    pub step_mm: f64,
    /// Settling tolerance: the largest distance from the setpoint, mm.
    pub settled_mm: f64,
    /// Largest overshoot, % of the step.
    pub overshoot_percent: f64,
    /// Time for the step each way, s.
    pub time_s: f64,
}

impl Goal {
    /// The number of these trials in which it is met.
    #[must_use]
    pub(crate) fn met_in(&self, trials: &[Performance]) -> Proportion {
        Proportion { met: trials.iter().filter(|trial| trial.meets(self)).count(), of: trials.len() }
    }
}

/// A step that is within the distance only later than this part of its time has not settled: it passes by.
const SETTLED_BY: f64 = 0.75;

/// Cost of a run that tripped, or could not be simulated, s.
const FAILED: f64 = 1e3;

/// A trial this far from the goal has half of the extra cost of a hopeless one, s.
const HALFWAY_S: f64 = 5.0;

/// The result of a step there and back; the worse of the two.
#[derive(Clone, Debug, PartialEq)]
pub struct Performance {
    /// Settling time, s; None: it does not settle.
    pub settling_s: Option<f64>,
    /// Time for the step, s.
    pub allowed_s: f64,
    /// Overshoot, % of the step; None: it is still on its way to the target.
    pub overshoot_percent: Option<f64>,
    /// Mean distance from the setpoint in the last quarter of its time, mm.
    pub error_mm: f64,
    /// Whether it ends in a limit cycle.
    pub limit_cycle: LimitCycle,
    /// From its lowest to its highest position in that quarter, mm.
    pub range_mm: f64,
    /// Why the run ended early, or "".
    pub failure: String,
}

impl Performance {
    /// The result of the moves of a step there and back.
    #[must_use]
    pub fn of(moves: &[&Move], step_mm: f64, allowed_s: f64) -> Performance {
        let largest = |of: &dyn Fn(&Move) -> Option<f64>| {
            moves.iter().map(|one| of(one)).reduce(|a, b| Some(a?.max(b?))).flatten()
        };
        let stays = |settling: &f64| *settling <= SETTLED_BY * allowed_s;
        let cycles = moves.iter().map(|one| one.limit_cycle);
        Performance {
            settling_s: largest(&|one| one.settling_s.filter(stays)),
            allowed_s,
            overshoot_percent: largest(&|one| Some(100.0 * one.overshoot_mm? / step_mm)),
            error_mm: largest(&|one| Some(one.mean_error_mm?.abs())).unwrap_or(f64::NAN),
            limit_cycle: cycles.reduce(LimitCycle::or_worse).unwrap_or(LimitCycle::Undecided(Doubt::NoMove)),
            range_mm: moves.iter().map(|one| one.range_mm).fold(0.0, f64::max),
            failure: String::new(),
        }
    }

    /// The result of a run that did not complete.
    #[must_use]
    pub fn failed(failure: String) -> Performance {
        Performance {
            settling_s: None,
            allowed_s: 0.0,
            overshoot_percent: None,
            error_mm: f64::NAN,
            limit_cycle: LimitCycle::Undecided(Doubt::NoMove),
            range_mm: f64::NAN,
            failure,
        }
    }

    /// Its cost in the search, from 0 to 2.
    #[must_use]
    pub fn cost(&self, goal: &Goal) -> f64 {
        match self.settling_s {
            Some(settling_s) if self.meets(goal) => settling_s / goal.time_s,
            _ => 1.0 + self.distance_s(goal) / (self.distance_s(goal) + HALFWAY_S),
        }
    }

    /// Its distance from the goal, s.
    #[must_use]
    pub(crate) fn distance_s(&self, goal: &Goal) -> f64 {
        if !self.failure.is_empty() {
            return FAILED;
        }
        let settled = self
            .settling_s
            .unwrap_or_else(|| self.allowed_s + (self.error_mm / goal.settled_mm).min(FAILED / 4.0));
        let beyond =
            self.overshoot_percent.map_or(0.0, |percent| (percent - goal.overshoot_percent).max(0.0));
        let swings = match self.limit_cycle {
            LimitCycle::None { .. } => None,
            LimitCycle::Sustained(seen) => Some(seen.swing_mm),
            LimitCycle::Undecided(_) => Some(self.range_mm),
        };
        let swings = swings.map_or(0.0, |mm| 0.5 + (mm / 2.0 / goal.settled_mm).min(FAILED / 4.0));
        settled + 0.2 * beyond + swings
    }

    /// The unmet requirements, in words; none: the goal is met.
    #[must_use]
    pub fn faults(&self, goal: &Goal) -> Vec<&'static str> {
        if !self.failure.is_empty() {
            return vec!["the run failed"];
        }
        [
            (self.settling_s.is_none(), "it does not settle"),
            (self.overshoot_percent.is_some_and(|percent| percent > goal.overshoot_percent), "it overshoots"),
            (self.overshoot_percent.is_none(), "it may overshoot"),
            (matches!(self.limit_cycle, LimitCycle::Sustained(_)), "it limit-cycles"),
            (matches!(self.limit_cycle, LimitCycle::Undecided(_)), "it may limit-cycle"),
        ]
        .into_iter()
        .filter_map(|(fails, what)| fails.then_some(what))
        .collect()
    }

    /// Whether the goal is met.
    #[must_use]
    pub fn meets(&self, goal: &Goal) -> bool {
        self.faults(goal).is_empty()
    }
}
