//! How well a control law positions: steps and sines on rigs drawn around a rig file, judged by the true position of the piston.
//!
//! ```text
//! rig file -> draws -> a rig each, its test a step there, back and there again, or a sine -> runs -> arrivals -> score
//!          -> nominal rig, valve fully open one way, then the other -> the bang-bang bound on the time of the same step
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`draw`] | the rigs that the drive may turn out to be |
//! | [`course`] | the steps and sines, as the test of a rig |
//! | [`arrival`] | how a step ended, and how far a drive was from a sine |
//! | [`armings`] | the first steps after several armings |
//! | [`score`] | both over all draws |
//! | [`mod@soak`] | many moves in many armings of a drive that changes |
//! | [`bang_bang`] | the bound on the time of a step |
//! | [`mod@beside`] | the steps of any run beside that bound |
//!
//! The law is that of `controller.law` in the rig file, with its gains. The same seed draws the same rigs and places,
//! whatever the law and the number of threads, so that laws are compared on the same draws.

pub mod armings;
pub mod arrival;
pub mod bang_bang;
pub mod beside;
pub mod course;
pub mod draw;
pub mod score;
pub mod soak;

use anyhow::Result;
use pneudrive_evaluate::parallel;
use pneudrive_sim::{Accuracy, Rig, Run, check_convergence};

pub use arrival::{Arrival, BANDS_MM};
pub use bang_bang::{Bound, bound};
pub use beside::beside_bound;
pub use course::{Sine, Steps, usual_step_mm};
pub use draw::{Draw, Spread, draws, places};
pub use score::{SineScore, StepScore};

use crate::runners::Runners;
use arrival::to_its_end;

/// What a law is measured on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// What differs from the rig file.
    pub spread: Spread,
    /// How many rigs are drawn.
    pub draws: usize,
    /// The same seed draws the same rigs and places.
    pub seed: u64,
}

/// The result of a run: what was measured, and whether the run has converged (docs/explanation/agreement.md). Otherwise why
/// it did not come to its end.
pub type Measured<T> = Result<(T, bool), String>;

/// Steps of `step_mm` on the draws of a plan: the first one of each, and that after two moves.
///
/// # Errors
/// When the step does not fit into the stroke, or the rig file leaves nothing open that could be drawn.
pub fn steps(rig: &Rig, plan: &Plan, step_mm: f64) -> Result<[StepScore; 2]> {
    let courses = places(plan.seed, plan.draws);
    let courses: Vec<Steps> =
        courses.into_iter().map(|place| Steps::of(rig, step_mm, place)).collect::<Result<_>>()?;
    let runs = on_draws(
        rig,
        plan,
        |n, drawn| courses[n].on(drawn),
        |n, drawn, run| courses[n].arrivals(drawn, run),
    )?;
    Ok([course::FIRST, course::AFTER_TWO].map(|number| {
        StepScore::of(
            runs.iter().map(|run| run.as_ref().map(|(moves, converged)| (&moves[number], *converged))),
        )
    }))
}

/// Steps on one rig: the first one, and that after two moves.
///
/// # Errors
/// When the rig cannot have this test.
pub fn steps_on(drawn: &Rig, steps: &Steps) -> Result<Measured<[Arrival; 2]>> {
    let drawn = steps.on(drawn)?;
    let measured = measured(&Runners::default(), &drawn, |run| steps.arrivals(&drawn, run));
    Ok(measured.map(|(moves, converged)| ([course::FIRST, course::AFTER_TWO].map(|n| moves[n]), converged)))
}

/// A sine of `hz` about the middle of the stroke, `peak_to_peak_mm` high, on the draws of a plan.
///
/// # Errors
/// As [`steps`].
pub fn sine(rig: &Rig, plan: &Plan, peak_to_peak_mm: f64, hz: f64) -> Result<SineScore> {
    let sine = Sine::of(rig, peak_to_peak_mm, hz)?;
    let runs =
        on_draws(rig, plan, |_, drawn| sine.on(drawn), |_, drawn, run| sine.largest_error_mm(drawn, run))?;
    Ok(SineScore::of(runs))
}

/// Runs a test on each rig of a plan, on all threads of the pool.
fn on_draws<T: Send>(
    rig: &Rig,
    plan: &Plan,
    course: impl Fn(usize, &Rig) -> Result<Rig> + Sync,
    measure: impl Fn(usize, &Rig, &Run) -> Result<T, String> + Sync,
) -> Result<Vec<Measured<T>>> {
    let draws = draws(rig, plan.spread, plan.seed, plan.draws)?;
    let drawn: Vec<(usize, Rig)> = draws
        .iter()
        .enumerate()
        .map(|(n, draw)| Ok((n, course(n, &draw.rig(rig)?)?)))
        .collect::<Result<_>>()?;
    let runners = Runners::default();
    let one = |(n, drawn): &(usize, Rig)| measured(&runners, drawn, |run| measure(*n, drawn, run));
    Ok(parallel::map(&drawn, one, |_| {}))
}

/// What a run of a rig's test shows.
fn measured<T>(runners: &Runners, rig: &Rig, measure: impl Fn(&Run) -> Result<T, String>) -> Measured<T> {
    let accuracy = Accuracy::of(rig);
    let measured = runners.run(rig, accuracy, |run| {
        let measured = to_its_end(run).and_then(|()| measure(run))?;
        let convergence = check_convergence(rig, accuracy, run).map_err(|error| error.to_string())?;
        Ok((measured, convergence.is_converged()))
    });
    measured.unwrap_or_else(|error| Err(error.to_string()))
}

#[cfg(test)]
mod tests;
