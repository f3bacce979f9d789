//! Runs the drives of studies from many starts: all of them together on all processors. At each start the drives of a
//! study begin at the same position and phase, so that they differ only by the change that is studied.

use anyhow::{Context, Result};
use pneudrive_sim::{Accuracy, run as simulate};

use super::starts::at_start;
use super::{Finding, Outcome, Study, Variant};
use pneudrive_evaluate::evaluation::Move;
use pneudrive_evaluate::parallel;

/// A study that has been run.
#[derive(Clone, Debug)]
pub struct Studied {
    /// The outcome of each drive at the first start, the one of the unchanged rig, in the order of the variants.
    pub own: Vec<Outcome>,
    /// The moves of each drive at each start.
    pub moves: Vec<Vec<Vec<Move>>>,
    /// How far each drive swings at the end of its moves at each start, mm; None where that is not to be seen.
    pub swings_mm: Vec<Vec<Option<f64>>>,
    /// The model's answer to each statement, over all starts.
    pub findings: Vec<Finding>,
}

/// A study at one start.
struct AtStart {
    /// Kept of the first start alone: a transient takes half a megabyte.
    own: Option<Vec<Outcome>>,
    moves: Vec<Vec<Move>>,
    swings_mm: Vec<Option<f64>>,
    findings: Vec<Finding>,
}

/// Runs studies, from this many starts each. `progress` receives the work done and the whole work, in studies at a
/// start each.
///
/// # Errors
/// When a drive cannot be integrated.
///
/// # Panics
/// If the number of starts is 0.
pub fn run(
    studies: &[&Study],
    starts: usize,
    mut progress: impl FnMut(usize, usize) + Send,
) -> Result<Vec<Studied>> {
    assert!(starts > 0, "a study needs a start");
    let jobs: Vec<(&Study, usize)> =
        studies.iter().flat_map(|study| (0..starts).map(|start| (*study, start))).collect();
    let one = |job: &(&Study, usize)| at_one_start(job.0, job.1);
    let done = parallel::map(&jobs, one, |done| progress(done, jobs.len()));
    let done: Vec<AtStart> = done.into_iter().collect::<Result<_>>()?;
    let mut done = done.into_iter();
    Ok(studies.iter().map(|study| together(study, done.by_ref().take(starts).collect())).collect())
}

fn at_one_start(study: &Study, start: usize) -> Result<AtStart> {
    let outcomes: Vec<Outcome> =
        study.variants.iter().map(|variant| outcome(variant, start)).collect::<Result<_>>()?;
    Ok(AtStart {
        moves: outcomes.iter().map(|outcome| outcome.moves.clone()).collect(),
        swings_mm: outcomes.iter().map(Outcome::swing_mm).collect(),
        findings: study.statements.iter().map(|statement| (statement.judge)(&outcomes)).collect(),
        own: (start == 0).then_some(outcomes),
    })
}

fn outcome(variant: &Variant, start: usize) -> Result<Outcome> {
    let rig = at_start(variant, start)?;
    let run = simulate(&rig, Accuracy::of_motion(&rig))
        .with_context(|| format!("{}, start {start}, cannot be simulated", variant.name))?;
    Ok(Outcome::of(variant.name, &rig, &run))
}

fn together(study: &Study, starts: Vec<AtStart>) -> Studied {
    let of_statement = |number: usize| {
        Finding::over(&starts.iter().map(|start| start.findings[number].clone()).collect::<Vec<_>>())
    };
    let swings = |drive: usize| starts.iter().map(|start| start.swings_mm[drive]).collect();
    let of_drive = |drive: usize| starts.iter().map(|start| start.moves[drive].clone()).collect();
    Studied {
        findings: (0..study.statements.len()).map(of_statement).collect(),
        moves: (0..study.variants.len()).map(of_drive).collect(),
        swings_mm: (0..study.variants.len()).map(swings).collect(),
        own: starts.into_iter().find_map(|start| start.own).expect("the first start is among them"),
    }
}
