//! `pneudrive simulate`.

use anyhow::{Context, Result};
use pneudrive_sim::{Rig, Run, run};

use super::{accuracy, load_choice, load_rig};
use crate::cli::Simulate;
use crate::report::Report;
use crate::run_folder::{self, StoredRun};
use crate::transient::Transient;
use crate::words;

pub(super) fn execute(arguments: &Simulate) -> Result<()> {
    let mut rig = load_choice(&arguments.rig)?;
    if let Some(test) = &arguments.test {
        rig = rig.with_test_of(&load_rig(test, &[])?)?;
    }
    let accuracy = accuracy(&arguments.integration);
    let run = run(&rig, accuracy).with_context(|| format!("{} cannot be simulated", rig.name()))?;
    run_folder::write(&arguments.out, &rig, accuracy, &run)?;
    let transient = Transient::of_run("simulated", &StoredRun::of(&rig, &run));
    let title = format!("{}, simulated", rig.name());
    let report =
        Report { title: &title, notes: &[summary(&rig, &run)], transients: &[transient], deviations: &[] };
    report.write(&arguments.out.join("report.html"))?;
    say!("{}", summary(&rig, &run));
    say!("{}: trace.csv, run.json, report.html", arguments.out.display());
    Ok(())
}

/// One line about a run.
pub(super) fn summary(rig: &Rig, run: &Run) -> String {
    let fault = run.fault.map_or(String::new(), |(fault, k)| {
        format!(
            "; tripped at sample {k}: {} ({})",
            words::fault_name(fault),
            words::fault_meaning(fault.code())
        )
    });
    format!(
        "{}: {} samples of {} us, {} steps of the integrator{fault}",
        rig.name(),
        run.observations.len(),
        rig.period_us(),
        run.work.integrator.steps
    )
}
