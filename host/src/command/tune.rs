//! `pneudrive tune`.

use anyhow::Result;

use super::{Progress, rig_text};
use crate::cli::Tune;
use crate::page::GENERATOR;
use crate::parallel::processors;
use crate::run_folder::{make_writable, put, refuse_foreign};
use crate::tuning::search::Budget;
use crate::tuning::{Goal, Relative, Task, report, tune};

pub(super) fn execute(arguments: &Tune) -> Result<()> {
    let (page, rig) = (arguments.out.join("tune.html"), arguments.out.join("tuned.toml"));
    make_writable(&arguments.out)?;
    refuse_foreign(&page, GENERATOR)?;
    refuse_foreign(&rig, report::MARK)?;
    let task = task(arguments)?;
    let mut progress = Progress::of("tuning", "generations");
    let tuned = tune(&task, |done, all, _| progress.at(done as u64, all as u64))?;
    progress.done();
    report::page(&task, &tuned)?.write(&page)?;
    put(&rig, &report::rig_file(&task, &tuned)?)?;
    let figures = report::figures(&tuned, &task.goal);
    say!("{}\n{}", figures.heading, figures.to_text());
    if !tuned.obstacles.is_empty() {
        let obstacles = report::obstacles(&tuned.obstacles, &task.goal);
        say!("{}\n{}", obstacles.heading, obstacles.to_text());
    }
    say!("{}\n{}: tuned.toml, tune.html", report::verdict(&task, &tuned), arguments.out.display());
    Ok(())
}

fn task(arguments: &Tune) -> Result<Task> {
    Ok(Task {
        source: rig_text(&arguments.rig.rig)?,
        settings: arguments.rig.settings.clone(),
        goal: Goal {
            step_mm: arguments.step_mm,
            settled_mm: arguments.settled_mm,
            overshoot_percent: arguments.overshoot_percent,
        },
        spread: Relative { load: arguments.load, friction: arguments.friction, supply: arguments.supply },
        budget: Budget {
            population: arguments.population,
            generations: arguments.generations,
            seed: arguments.seed,
        },
        threads: arguments.threads.unwrap_or_else(processors),
    })
}
