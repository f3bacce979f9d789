//! `pneudrive simulate`.

use std::time::Instant;

use anyhow::{Context, Result};
use pneudrive_sim::{Rig, Run, run_watched};

use super::{Progress, accuracy, load_choice, load_rig};
use crate::cli::Simulate;
use crate::report;
use crate::run_folder::{self, StoredRun, make_writable};
use crate::transient::Transient;
use crate::words;

pub(super) fn execute(arguments: &Simulate) -> Result<()> {
    make_writable(&arguments.out)?;
    let mut rig = load_choice(&arguments.rig)?;
    if let Some(test) = &arguments.test {
        rig = rig.with_test_of(&load_rig(test, &[])?)?;
    }
    let accuracy = accuracy(&arguments.integration, &rig);
    let mut progress = Progress::new("simulating");
    let begin = Instant::now();
    let run = run_watched(&rig, accuracy, |done, all| progress.at(u64::from(done), u64::from(all)));
    let took = begin.elapsed();
    progress.done();
    let run = run.with_context(|| format!("{} cannot be simulated", rig.name()))?;
    run_folder::write(&arguments.out, &rig, accuracy, &run)?;
    let summary = summary(&rig, &run);
    say!("{summary}, in {:.1} ms", 1e3 * took.as_secs_f64());
    let page_path = arguments.out.join("report.html");
    if arguments.no_report {
        // One from before would be of another run.
        if page_path.exists() {
            std::fs::remove_file(&page_path).with_context(|| page_path.display().to_string())?;
        }
        say!("{}: trace.csv, run.json", arguments.out.display());
        return Ok(());
    }
    let transient = Transient::of_run("simulated", &StoredRun::of(&rig, &run));
    let title = format!("{}, simulated", rig.name());
    let page = report::page(&title, vec![summary], &[transient], Vec::new());
    page.write(&page_path)?;
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
