//! Runs the drives of studies, as many at a time as the machine has processors. A drive that several
//! studies ask for is run once.

use anyhow::{Context, Result};
use pneudrive_sim::rig::builtin;
use pneudrive_sim::{Accuracy, Rig};

use super::{Outcome, Study, Variant};
use crate::parallel;

/// Rig and settings: what makes two variants the same run.
type Drive = (&'static str, &'static [&'static str]);

/// The outcomes of each study, in the order of its variants. `progress` is given runs done and runs in all.
///
/// # Errors
/// When a drive cannot be integrated.
pub fn run(studies: &[&Study], mut progress: impl FnMut(usize, usize)) -> Result<Vec<Vec<Outcome>>> {
    let mut drives: Vec<Drive> = Vec::new();
    for variant in studies.iter().flat_map(|study| study.variants) {
        if !drives.contains(&drive(variant)) {
            drives.push(drive(variant));
        }
    }
    let runs = parallel::map(
        &drives,
        parallel::processors(),
        |drive| run_one(*drive),
        |done| progress(done, drives.len()),
    );
    let runs: Vec<(Rig, pneudrive_sim::Run)> = runs.into_iter().collect::<Result<_>>()?;
    let outcome = |variant: &Variant| {
        let (rig, run) = &runs[drives.iter().position(|one| *one == drive(variant)).expect("it was run")];
        Outcome::of(*variant, rig, run)
    };
    Ok(studies.iter().map(|study| study.variants.iter().map(outcome).collect()).collect())
}

fn drive(variant: &Variant) -> Drive {
    (variant.rig, variant.settings)
}

fn run_one((name, settings): Drive) -> Result<(Rig, pneudrive_sim::Run)> {
    let text = builtin(name).with_context(|| format!("there is no built-in rig {name}"))?;
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    let rig = Rig::read_with(name, text, &settings)?;
    let run = pneudrive_sim::run(&rig, Accuracy::of(&rig))
        .with_context(|| format!("{name} with {settings:?} cannot be simulated"))?;
    Ok((rig, run))
}
