//! The first step of a drive after each of several armings, while its plant changes from one to the next.
//!
//! Each arming begins the test of [`Steps`] anew, at the same place: there, back and there again. A drive with
//! `controller.adapt = "kept"` begins with what the tests before have taught it, and another one with its rig file.

use anyhow::Result;
use pneudrive_controller::law::cascade::kept::{Changed, Kept};
use pneudrive_evaluate::parallel;
use pneudrive_sim::{Accuracy, Rig, Run, run_keeping};

use super::Plan;
use super::arrival::{Arrival, to_its_end};
use super::course::{FIRST, HOLD_S, MOVE_S, Steps};
use super::draw::{draws, places};
use super::score::{StepScore, median};

/// On a trajectory of its own.
const TRAJECTORY: f64 = 1.0;

/// The first step after an arming, over all draws.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmingScore {
    /// How it ended.
    pub step: StepScore,
    /// How far the piston was at most from the trajectory of its law on that step, mm: median of the draws, and the worst.
    pub deviation_mm: Option<[f64; 2]>,
    /// Draws that tell of a change at this arming.
    pub changed: usize,
    /// Mass and friction that the law began with over those of the rig file, medians of the draws.
    pub begun: [f64; 2],
}

/// What one arming of a draw shows: what it began with, how its first step ended, and the largest deviation on it, mm.
struct Shown {
    kept: Kept,
    step: Result<(Arrival, f64), String>,
}

/// The first steps of so many armings, each on the draws of a plan. `plant` makes the rig of an arming, from 0 on, of that of a draw.
///
/// # Errors
/// When the step does not fit into the stroke, or a rig cannot have this test.
pub fn first_steps(
    rig: &Rig,
    plan: &Plan,
    step_mm: f64,
    armings: usize,
    plant: impl Fn(usize, &Rig) -> Result<Rig> + Sync,
) -> Result<Vec<ArmingScore>> {
    let drawn: Vec<(Rig, Steps)> = draws(rig, plan.spread, plan.seed, plan.draws)?
        .iter()
        .zip(places(plan.seed, plan.draws))
        .map(|(draw, place)| Ok((draw.rig(rig)?, Steps::of(rig, step_mm, place)?)))
        .collect::<Result<_>>()?;
    let one = |(drawn, steps): &(Rig, Steps)| {
        let rigs = (0..armings).map(|arming| steps.on(&plant(arming, drawn)?));
        Ok(in_turn(&rigs.collect::<Result<Vec<_>>>()?, steps))
    };
    let all: Vec<Vec<Shown>> = parallel::map(&drawn, one, |_| {}).into_iter().collect::<Result<_>>()?;
    Ok((0..armings).map(|arming| score(&all, arming)).collect())
}

/// The tests of these rigs, each with what the ones before have taught.
fn in_turn(rigs: &[Rig], steps: &Steps) -> Vec<Shown> {
    let mut kept = Kept::default();
    rigs.iter()
        .map(|rig| {
            let begun = kept;
            let run = run_keeping(rig, Accuracy::of(rig), &kept).map_err(|error| error.to_string());
            if let Ok(run) = &run {
                kept = run.kept.unwrap_or(kept);
            }
            Shown { kept: begun, step: run.and_then(|run| first_step(rig, steps, &run)) }
        })
        .collect()
}

fn first_step(rig: &Rig, steps: &Steps, run: &Run) -> Result<(Arrival, f64), String> {
    to_its_end(run)?;
    let deviation = |row: &pneudrive_sim::trace::Row| {
        let known = row.known.filter(|known| known.stage == TRAJECTORY)?;
        Some(1e3 * (known.reference - row.plant.position).abs())
    };
    let of_step = run.rows.iter().filter(|row| (HOLD_S..HOLD_S + MOVE_S).contains(&row.time));
    let worst = of_step.filter_map(deviation).fold(0.0, f64::max);
    Ok((steps.arrivals(rig, run)?[FIRST], worst))
}

fn score(all: &[Vec<Shown>], arming: usize) -> ArmingScore {
    let shown: Vec<&Shown> = all.iter().map(|draw| &draw[arming]).collect();
    let step = shown.iter().map(|shown| match &shown.step {
        Ok((arrival, _)) => Ok((arrival, true)),
        Err(why) => Err(why),
    });
    let deviations: Vec<f64> = shown.iter().filter_map(|shown| Some(shown.step.as_ref().ok()?.1)).collect();
    let worst = deviations.iter().copied().fold(0.0, f64::max);
    let begun = |part: fn(&Kept) -> i32| {
        median(shown.iter().map(|shown| f64::from(part(&shown.kept)) / 65_536.0).collect()).unwrap_or(1.0)
    };
    ArmingScore {
        step: StepScore::of(step),
        deviation_mm: median(deviations).map(|middle| [middle, worst]),
        changed: shown.iter().filter(|shown| shown.kept.changed != Changed::No).count(),
        begun: [begun(|kept| kept.learned.mass), begun(|kept| kept.learned.friction)],
    }
}
