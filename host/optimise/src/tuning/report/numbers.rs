//! The results of a tuning for other programs.

use serde_json::{Value, json};

use crate::tuning::stroke::AtPlace;
use crate::tuning::tracking::Tracked;
use crate::tuning::tracking::limit::{self, Following, Limit};
use crate::tuning::{Behaviour, Found, Goal, LimitingImperfection, Performance, Tuned};
use pneudrive_evaluate::evaluation::LimitCycle;

/// Gains and their results (docs/reference/json.md). An unknown number is null.
#[must_use]
pub fn to_json(goal: &Goal, tuned: &Tuned, behaviour: &Behaviour) -> Value {
    let step = |step: &AtPlace| {
        let runs: Vec<Value> = step.runs.iter().map(|one| performance(one, goal)).collect();
        json!({ "ends_mm": step.ends_mm, "runs": runs })
    };
    let obstacle =
        |one: &LimitingImperfection| json!({ "without": one.suspect.what, "found": found(&one.found, goal) });
    json!({
        "goal": {
            "step_mm": goal.step_mm, "settled_mm": goal.settled_mm,
            "overshoot_percent": goal.overshoot_percent, "time_s": goal.time_s,
        },
        "changed": tuned.is_changed(),
        "before": found(&tuned.before, goal),
        "after": found(&tuned.after, goal),
        "along_the_stroke": behaviour.steps.iter().map(step).collect::<Vec<_>>(),
        "sines": behaviour.sines.iter().map(sine).collect::<Vec<_>>(),
        "obstacles": tuned.obstacles.iter().map(obstacle).collect::<Vec<_>>(),
        "runs": tuned.runs,
    })
}

/// How a sine is followed.
fn sine(one: &Tracked) -> Value {
    let all = |runs: &[Result<Following, String>]| runs.iter().map(following).collect::<Vec<_>>();
    json!({
        "frequency_hz": one.sine.frequency_hz,
        "amplitude_mm": one.sine.amplitude_mm(),
        "middle_mm": one.sine.middle_mm(),
        "gains": one.gains.word(),
        "limit": limit::common(&one.runs).map(Limit::word),
        "runs": all(&one.runs),
        "draws": all(&one.draws),
    })
}

fn following(run: &Result<Following, String>) -> Value {
    let figure = |of: &dyn Fn(&Following) -> f64| run.as_ref().ok().map(of);
    json!({
        "rms_mm": figure(&|run| run.rms_mm),
        "largest_mm": figure(&|run| run.largest_mm),
        "behind_s": figure(&|run| run.behind_s),
        "in_dead_band": figure(&|run| run.in_dead_band),
        "standing": figure(&|run| run.standing),
        "fully_open": figure(&|run| run.fully_open),
        "with_sine": figure(&|run| run.with_sine),
        "limit": run.as_ref().ok().and_then(Following::limit).map(Limit::word),
        "failure": run.as_ref().err().map_or("", String::as_str),
    })
}

/// Gains: in how many fresh draws they meet the goal, and their figures there.
fn found(found: &Found, goal: &Goal) -> Value {
    let met = found.met(goal);
    json!({
        "settings": found.settings,
        "met": met.met,
        "of": met.of,
        "interval_95": met.interval(),
        "draws": found.fresh.iter().map(|one| performance(one, goal)).collect::<Vec<_>>(),
    })
}

fn performance(one: &Performance, goal: &Goal) -> Value {
    let limit_cycle = match one.limit_cycle {
        LimitCycle::None { .. } => "none",
        LimitCycle::Sustained(_) => "sustained",
        LimitCycle::Undecided(_) => "undecided",
    };
    json!({
        "met": one.meets(goal),
        "settling_s": one.settling_s,
        "overshoot_percent": one.overshoot_percent,
        "error_mm": one.error_mm,
        "limit_cycle": limit_cycle,
        "failure": one.failure,
    })
}
