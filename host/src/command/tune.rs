//! `pneudrive tune`.

use std::time::{Duration, Instant};

use anyhow::Result;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::tolerance_mm;
use pneudrive_optimise::tuning::memory::Memory;
use pneudrive_optimise::tuning::search::Budget;
use pneudrive_optimise::tuning::trial::Trial;
use pneudrive_optimise::tuning::{
    Behaviour, Goal, Progress as At, Relative, Stage, Task, behaviour, report, tune, tune_with,
};
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_records::whole_file::put;
use pneudrive_sim::keys;
use pneudrive_sim::rig::find_key;
use pneudrive_sim::rigfile::RigFile;

use super::long_work::{about, allow};
use super::progress::Progress;
use super::rig_source::{load_choice, rig_text};
use super::threads;
use crate::cli::Tune;
use crate::json;

pub(super) fn execute(arguments: &Tune) -> Result<()> {
    let (page, rig) = (arguments.out.join("tune.html"), arguments.out.join("tuned.toml"));
    make_writable(&arguments.out)?;
    refuse_to_replace(&page, GENERATOR)?;
    refuse_to_replace(&rig, report::MARK)?;
    let task = task(arguments)?;
    let memory = Memory::open(&arguments.out, &task)?;
    threads::prepare(arguments.threads)?;
    if let Some(lasts) = lasts(&task)? {
        tell!(
            "tuning: {}, estimated from a few runs with the gains of the file; poorer ones take longer",
            about(lasts)
        );
        allow("the tuning", lasts, arguments.yes)?;
    }
    if memory.generations() > 0 {
        tell!("tuning: goes on after the {} generations of an interrupted search", memory.generations());
    }
    let mut bars = Bars::default();
    let tuned = tune_with(&task, |at| bars.at(at), CancelToken::NEVER, &memory)?;
    let behaviour = Behaviour::of(&task, &tuned, |at| bars.at(at), CancelToken::NEVER)?;
    bars.done();
    report::write_page(&task, &tuned, &behaviour, &page, arguments.pages.library())?;
    put(&rig, &report::rig_file(&task, &tuned)?)?;
    memory.end()?;
    json::figures(|| report::to_json(&task.goal, &tuned, &behaviour));
    report::notes(&task, &tuned).iter().for_each(|note| say!("{note}"));
    let tables = report::shown(&tuned, &behaviour, &task.goal);
    tables.iter().for_each(|table| say!("\n{}\n{}", table.heading, table.to_text().trim_end()));
    say!("\n{}: tuned.toml, tune.html", arguments.out.display());
    Ok(())
}

/// A bar for each stage.
#[derive(Default)]
struct Bars(Option<(Stage, Progress)>);

impl Bars {
    fn at(&mut self, at: At) {
        let bar = match self.0.take() {
            Some((stage, bar)) if stage == at.stage => bar,
            before => {
                before.into_iter().for_each(|(_, bar)| bar.done());
                Progress::of(name(at.stage), "runs")
            }
        };
        let (_, bar) = self.0.insert((at.stage, bar));
        bar.at(at.done as u64, at.all as u64);
    }

    fn done(self) {
        self.0.into_iter().for_each(|(_, bar)| bar.done());
    }
}

/// How long a tuning takes; None without a search and with few draws.
fn lasts(task: &Task) -> Result<Option<Duration>> {
    if task.budget.generations == 0 && task.draws <= FEW {
        return Ok(None);
    }
    let begun = Instant::now();
    let runs = tune(&task.taste(), |_| {}, CancelToken::NEVER)?.runs.max(1);
    let all = task.max_runs()? as f64 + behaviour::steps_worth(task);
    Ok(Some(begun.elapsed().mul_f64(all / runs as f64)))
}

/// So few draws are judged in a moment.
const FEW: usize = 200;

fn name(stage: Stage) -> &'static str {
    match stage {
        Stage::Search => "tuning",
        Stage::Finalists => "checking",
        Stage::Draws => "fresh draws",
        Stage::Obstacles => "obstacles",
        Stage::Sines => "sines",
    }
}

fn task(arguments: &Tune) -> Result<Task> {
    let source = rig_text(&arguments.rig.rig)?;
    let tolerance = arguments.tolerance_mm.map(|mm| keys::test::TOLERANCE_MM.setting(mm));
    let settings: Vec<String> = arguments.rig.settings.iter().cloned().chain(tolerance).collect();
    // The tuning itself reports what is wrong with a rig or a step.
    let rig = RigFile::read(&source.0, &source.1).with(&settings).ok();
    let mut task = Task {
        goal: Goal {
            step_mm: arguments.step_mm,
            settled_mm: tolerance_mm(rig.as_ref()),
            overshoot_percent: arguments.overshoot_percent,
            time_s: arguments.time_s,
        },
        source,
        settings,
        fixed: fixed(arguments)?,
        spread: Relative {
            load: arguments.load,
            friction: arguments.friction,
            supply: arguments.supply,
            valve: arguments.valve,
        },
        between_mm: [arguments.lowest_mm, arguments.highest_mm],
        draws: arguments.draws,
        budget: Budget {
            population: arguments.population.unwrap_or(Budget::OF_GAINS[0]),
            generations: arguments.generations.unwrap_or(Budget::OF_GAINS[1]),
            seed: arguments.seed,
        },
    };
    if let Ok(trial) = Trial::of(&task, &[]) {
        let [population, generations] = Budget::usual(&trial.rig);
        task.budget.population = arguments.population.unwrap_or(population);
        task.budget.generations = arguments.generations.unwrap_or(generations);
    }
    Ok(task)
}

/// The fixed keys, as `key=value`; a key without a value keeps the file's value.
fn fixed(arguments: &Tune) -> Result<Vec<String>> {
    let with_value = |key: &String| {
        if key.contains('=') || find_key(key.trim()).is_none() {
            return Ok(key.clone());
        }
        let rig = load_choice(&arguments.rig)?;
        Ok(rig.value(key.trim()).map_or_else(|| key.clone(), |value| format!("{}={value}", key.trim())))
    };
    arguments.fixed.iter().map(with_value).collect()
}
