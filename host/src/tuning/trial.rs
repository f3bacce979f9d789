//! The step on a rig: from before the middle of the stroke to behind it, and back.

use anyhow::{Result, bail};
use pneudrive_sim::{Accuracy, Rig, run};

use super::{Task, Variant, read};
use crate::evaluation::{Motion, Move, moves};
use crate::run_folder::StoredRun;
use crate::transient::Transient;
use crate::words::fault_name;

use super::goal::{Goal, Performance};

/// Before the step the drive holds for so long, s; each way it then has so long.
const HOLD_S: f64 = 0.1;
const STEP_S: f64 = 1.5;

/// A rig with the step as its test.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The rig of the file, with the step.
    pub rig: Rig,
    /// Its file and what is set in it.
    source: (String, String),
    settings: Vec<String>,
    goal: Goal,
}

impl Trial {
    /// The step of a task; `more` keys are set.
    ///
    /// # Errors
    /// When the step does not fit into the stroke, or a key is wrong.
    pub fn of(task: &Task, more: &[String]) -> Result<Trial> {
        let rig = read(task, more)?;
        let (stroke_mm, step_mm) = (1e3 * rig.number("actuator.stroke_m"), task.goal.step_mm);
        if step_mm > 0.9 * stroke_mm {
            bail!(
                "a step of {step_mm} mm does not fit into the stroke of {stroke_mm:.0} mm; make it shorter (--step)"
            );
        }
        let settings: Vec<String> =
            task.settings.iter().chain(more).cloned().chain(step(&rig, step_mm)).collect();
        let rig = Rig::read_with(&task.source.0, &task.source.1, &settings)?;
        Ok(Trial { rig, source: task.source.clone(), settings, goal: task.goal })
    }

    /// The step with these gains on a variant of the rig.
    #[must_use]
    pub fn run(&self, gains: &[String], variant: &Variant) -> Performance {
        match self.transient(gains, variant) {
            Ok((_, moves)) => {
                let steps: Vec<&Move> = moves.iter().skip(1).collect();
                Performance::of(&steps, self.goal.step_mm, STEP_S)
            }
            Err(failure) => Performance::failed(failure),
        }
    }

    /// The same: its transient, and its moves.
    ///
    /// # Errors
    /// Why it did not come to its end.
    pub fn transient(&self, gains: &[String], variant: &Variant) -> Result<(Transient, Vec<Move>), String> {
        let settings: Vec<String> =
            self.settings.iter().chain(gains).cloned().chain(variant.settings(&self.rig)).collect();
        let rig = Rig::read_with(&self.source.0, &self.source.1, &settings).map_err(|all| all.to_string())?;
        let run = run(&rig, Accuracy::of_draw(&rig)).map_err(|error| error.to_string())?;
        if let Some((fault, k)) = run.fault {
            return Err(format!("{} at sample {k}", fault_name(fault)));
        }
        let transient = Transient::of_run("", &StoredRun::of(&rig, &run));
        let moves = moves(&transient, &Motion::of(&transient), None, self.goal.settled_mm);
        Ok((transient, moves))
    }
}

/// The step as a test, as `key=value`: it starts half a count beside its first setpoint, since a start on the edge
/// of a count is ill-defined.
fn step(rig: &Rig, step_mm: f64) -> Vec<String> {
    let mm = rig.number("encoder.mm_per_count");
    let middle_mm = 500.0 * rig.number("actuator.stroke_m");
    let low = ((middle_mm - step_mm / 2.0) / mm).round();
    let high = low + (step_mm / mm).round();
    let (up, down) = (HOLD_S, HOLD_S + STEP_S);
    vec![
        format!("test.moves=[[0.0, {low}], [{up:?}, {high}], [{down:?}, {low}]]"),
        format!("test.duration_s={:?}", HOLD_S + 2.0 * STEP_S),
        format!("test.position_m={:?}", (low + 0.5) * mm / 1e3),
    ]
}
