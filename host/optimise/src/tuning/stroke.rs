//! The step along the stroke: at five places, with the gains that were found, on the rig of the file and its perturbed runs.

use anyhow::Result;

use super::trial::{MEMBERS, Trial};
use super::{Performance, Task, Tuned, Variant};

/// Parts of the range that the step leaves.
const PLACES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// The largest number of runs that it takes.
pub(super) const RUNS: usize = PLACES.len() * MEMBERS;

/// The step at one position of the stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct AtPlace {
    /// Begin and end of the step, and back, mm.
    pub ends_mm: [f64; 2],
    /// On the rig of the file, first, and on its perturbed runs.
    pub runs: Vec<Performance>,
}

/// The step there and back at five places, from the retracted end to the extended one; at one where it takes the whole range.
///
/// # Errors
/// When it cannot be simulated.
pub(crate) fn along_the_stroke(task: &Task, tuned: &Tuned) -> Result<Vec<AtPlace>> {
    let trial = Trial::of(task, &[])?;
    let mut steps: Vec<AtPlace> = Vec::new();
    for place in PLACES {
        let variant = Variant { place, ..Variant::NOMINAL };
        let ends_mm = trial.ends_mm(&variant);
        if steps.iter().all(|step| step.ends_mm != ends_mm) {
            steps.push(AtPlace { ends_mm, runs: trial.members_of(&tuned.after.settings, &variant)? });
        }
    }
    Ok(steps)
}
