//! Runs the drives of studies, each with its neighbours on all processors. A drive that several studies ask for is run
//! once.

use anyhow::{Context, Result, bail};
use pneudrive_sim::rig::builtin;
use pneudrive_sim::{Accuracy, Rig};

use super::{Outcome, Study, Variant};
use crate::ensemble::{Spacing, run_ensemble};
use crate::run_folder::StoredRun;
use crate::transient::Transient;

/// Rig and settings: what makes two variants the same run.
type Drive = (&'static str, &'static [&'static str]);

/// The outcomes of each study: of its drives as they are, in the order of its variants, and then of each of their
/// neighbours. `progress` is given drives done and drives in all.
///
/// # Errors
/// When a drive cannot be integrated, or `progress` wants no more.
pub fn run(
    studies: &[&Study],
    spacing: Spacing,
    mut progress: impl FnMut(usize, usize) -> Result<()>,
) -> Result<Vec<Vec<Vec<Outcome>>>> {
    let mut drives: Vec<Drive> = Vec::new();
    for variant in studies.iter().flat_map(|study| study.variants) {
        if !drives.contains(&drive(variant)) {
            drives.push(drive(variant));
        }
    }
    let mut runs: Vec<Vec<Outcome>> = Vec::with_capacity(drives.len());
    for drive in &drives {
        progress(runs.len(), drives.len())?;
        runs.push(run_one(*drive, spacing)?);
    }
    progress(drives.len(), drives.len())?;
    let of_drive = |variant: &Variant, number: usize| {
        let drive = drives.iter().position(|one| *one == drive(variant)).expect("it was run");
        runs[drive][number].called(*variant)
    };
    let of_study = |study: &&Study, number: usize| -> Vec<Outcome> {
        study.variants.iter().map(|variant| of_drive(variant, number)).collect()
    };
    Ok(studies
        .iter()
        .map(|study| (0..spacing.runs).map(|number| of_study(study, number)).collect())
        .collect())
}

fn drive(variant: &Variant) -> Drive {
    (variant.rig, variant.settings)
}

/// A drive and its neighbours, the nominal run with the band of all.
fn run_one((name, settings): Drive, spacing: Spacing) -> Result<Vec<Outcome>> {
    let text = builtin(name).with_context(|| format!("there is no built-in rig {name}"))?;
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    let rig = Rig::read_with(name, text, &settings)?;
    let ensemble = run_ensemble(&rig, Accuracy::of(&rig), spacing, Outcome::of, |_, _| {})
        .with_context(|| format!("{name} with {settings:?} cannot be simulated"))?;
    if let Some(why) = ensemble.nominal.lost.failed.first() {
        bail!("a neighbour of {name} with {settings:?} cannot be simulated; write a smaller --change: {why}");
    }
    let mut outcomes = ensemble.measured;
    outcomes[0].transient = Transient::of_run(name, &StoredRun::of_judged(&rig, &ensemble.nominal));
    Ok(outcomes)
}
