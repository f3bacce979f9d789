//! A tuning of the rig of the page.

use std::ops::RangeInclusive;

use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::tolerance_mm;
use pneudrive_optimise::tuning::search::Budget;
use pneudrive_optimise::tuning::{
    self, Behaviour, Progress, Relative, Space, Stage, Task, behaviour, report, tune,
};
use pneudrive_sim::Rig;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::meter::Meter;
use super::{Audience, exhibit};
use crate::page_rig::PageRig;
use crate::refusal::HttpRefusal;

/// A rig, and the requirements on a step.
#[derive(Debug, Deserialize)]
pub struct TuneRequest {
    #[serde(flatten)]
    asked: PageRig,
    goal: Goal,
}

/// The requirements on a step, its spread, and the size of the search, as in the options of `tune`.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub struct Goal {
    /// Size of the step, mm.
    step_mm: f64,
    /// The drive has settled within this distance of its setpoint, mm; without it, `test.tolerance_mm` of the rig.
    settled_mm: Option<f64>,
    /// Largest overshoot allowed, % of the step.
    overshoot_percent: f64,
    /// Time for the step each way, s.
    time_s: f64,
    /// Largest deviation of the load's mass, %.
    load_percent: f64,
    /// Largest deviation of the load's friction, %.
    friction_percent: f64,
    /// Largest deviation of the supply pressure, %.
    supply_percent: f64,
    /// Largest deviation of the valve's conductances, %.
    #[serde(default)]
    valve_percent: f64,
    /// Number of draws on which the gains are judged.
    draws: usize,
    /// Candidates per generation; without it, the default of the command for the rig's law.
    #[serde(default)]
    population: Option<usize>,
    /// Generations; without it, the default of the command for the rig's law.
    #[serde(default)]
    generations: Option<usize>,
}

impl Default for Goal {
    /// The defaults of the command.
    fn default() -> Goal {
        Goal {
            step_mm: 60.0,
            settled_mm: Some(tolerance_mm(None)),
            overshoot_percent: 1.0,
            time_s: 1.5,
            load_percent: 30.0,
            friction_percent: 30.0,
            supply_percent: 0.0,
            valve_percent: 0.0,
            draws: 60,
            population: None,
            generations: None,
        }
    }
}

impl TuneRequest {
    pub fn plan(&self) -> Result<Value, HttpRefusal> {
        let task = self.task()?;
        let impossible = |error: anyhow::Error| HttpRefusal::wrong(format!("{error:#}"));
        let runs = task.max_runs().map_err(impossible)?;
        let rig = self.asked.rig()?;
        let searched = Space::of(&rig, self.goal.settled_on(&rig), &[]).map_err(impossible)?.names();
        let Budget { population, generations, .. } = task.budget;
        Ok(json!({
            "command": self.asked.command("tune", &format!("{} --out tuned", self.goal.options(&task.budget))),
            "size": format!("{runs} runs at most"),
            "search": { "settled_mm": task.goal.settled_mm, "population": population, "generations": generations, "what": searched },
        }))
    }

    pub fn work(&self, audience: Audience<'_>) -> Result<Value, HttpRefusal> {
        let (task, cancel) = (self.task()?, CancelToken::cancelled_unless(audience.waits));
        let impossible = |error: anyhow::Error| {
            HttpRefusal::gone_or(&error, |error| HttpRefusal::wrong(format!("{error:#}")))
        };
        let most = task.max_runs().map_err(impossible)?;
        let runs = tune(&task.taste(), |_| {}, cancel).map_err(impossible)?.runs;
        // The page multiplies the elapsed time by `all` / `done`: the result is an upper bound on the whole time.
        let all = most as f64 + behaviour::steps_worth(&task);
        (audience.hears)(json!({ "what": "taste", "done": runs, "all": all }));
        let mut meter = Meter::new(audience.hears);
        let tell = |at: Progress| meter.at(stage(at.stage), at.done, at.all);
        let tuned = tune(&task, tell, cancel).map_err(impossible)?;
        let tell = |at: Progress| meter.at(stage(at.stage), at.done, at.all);
        let behaviour = Behaviour::of(&task, &tuned, tell, cancel).map_err(impossible)?;
        let (mut page, draws) = report::page(&task, &tuned, &behaviour).map_err(impossible)?;
        page.figures.insert(0, draws);
        Ok(json!({
            "result": report::to_json(&task.goal, &tuned, &behaviour),
            "page": exhibit::to_json(&page),
            "settings": tuned.after.settings,
        }))
    }

    fn task(&self) -> Result<Task, HttpRefusal> {
        let rig = self.asked.rig()?;
        let [population, generations] = Budget::usual(&rig);
        let goal = self.goal.checked()?;
        let population = goal.population.unwrap_or(population);
        let generations = goal.generations.unwrap_or(generations);
        Ok(Task {
            source: (self.asked.name.clone(), self.asked.text.clone()),
            settings: self.asked.settings.clone(),
            fixed: Vec::new(),
            goal: tuning::Goal {
                step_mm: goal.step_mm,
                settled_mm: goal.settled_on(&rig),
                overshoot_percent: goal.overshoot_percent,
                time_s: goal.time_s,
            },
            spread: Relative {
                load: goal.load_percent / 100.0,
                friction: goal.friction_percent / 100.0,
                supply: goal.supply_percent / 100.0,
                valve: goal.valve_percent / 100.0,
            },
            between_mm: [None; 2],
            draws: goal.draws,
            budget: Budget { population, generations, seed: SEED },
        })
    }
}

/// The default of the command.
const SEED: u64 = 1;

fn stage(stage: Stage) -> &'static str {
    match stage {
        Stage::Search => "runs of the search",
        Stage::Finalists => "runs that check the best",
        Stage::Draws => "runs on fresh draws",
        Stage::Obstacles => "runs that look for what is in the way",
        Stage::Sines => "runs that follow a sine",
    }
}

impl Goal {
    /// Within the ranges of the command's options.
    fn checked(self) -> Result<Goal, HttpRefusal> {
        let above_zero = f64::MIN_POSITIVE..=f64::MAX;
        within("step", self.step_mm, &above_zero, "above 0 mm")?;
        if let Some(settled_mm) = self.settled_mm {
            within("settled within", settled_mm, &above_zero, "above 0 mm")?;
        }
        within("overshoot", self.overshoot_percent, &above_zero, "above 0 %")?;
        within("time", self.time_s, &(0.1..=100.0), "between 0.1 and 100 s")?;
        for (name, percent) in [
            ("load", self.load_percent),
            ("friction", self.friction_percent),
            ("supply", self.supply_percent),
            ("valve", self.valve_percent),
        ] {
            within(name, percent, &(0.0..=50.0), "between 0 and 50 %")?;
        }
        within("draws", self.draws, &(1..=1000), "between 1 and 1000")?;
        within("candidates", self.population.unwrap_or(2), &(2..=1000), "between 2 and 1000")?;
        within("generations", self.generations.unwrap_or(0), &(0..=1000), "between 0 and 1000")?;
        // In whole milliseconds.
        Ok(Goal { time_s: (1e3 * self.time_s).round() / 1e3, ..self })
    }

    /// The tolerance, mm; that of the rig if none is asked for.
    fn settled_on(&self, rig: &Rig) -> f64 {
        self.settled_mm.unwrap_or_else(|| tolerance_mm(Some(rig)))
    }

    /// As the command takes it.
    fn options(&self, Budget { population, generations, .. }: &Budget) -> String {
        let settled = self.settled_mm.map_or_else(String::new, |mm| format!(" --tolerance-mm {mm}"));
        format!(
            "--step {}{settled} --overshoot {} --time {} --load {}% --friction {}% --supply {}% --valve {}% --draws {} --population {population} --generations {generations}",
            self.step_mm,
            self.overshoot_percent,
            self.time_s,
            self.load_percent,
            self.friction_percent,
            self.supply_percent,
            self.valve_percent,
            self.draws,
        )
    }
}

fn within<T: PartialOrd + std::fmt::Display>(
    name: &str,
    value: T,
    range: &RangeInclusive<T>,
    words: &str,
) -> Result<(), HttpRefusal> {
    if range.contains(&value) {
        Ok(())
    } else {
        Err(HttpRefusal::wrong(format!("{name} must be {words}, is {value}")))
    }
}

#[cfg(test)]
mod tests {
    use pneudrive_sim::rigfile::builtin;

    use super::*;
    use crate::press;

    /// The same as the command's, which asks the rig.
    #[test]
    fn a_search_has_the_size_that_suits_the_law_of_its_rig() {
        let plan = |name: &str, text: &str| {
            let body = json!({ "name": name, "text": text, "goal": Goal::default() });
            TuneRequest::deserialize(&body).expect("a request").plan().expect("a plan")
        };
        let gains = plan("servo-b-tuned", builtin("servo-b-tuned").expect("a rig"));
        assert!(
            gains["command"].as_str().expect("a line").contains("--population 24 --generations 25 "),
            "{gains}"
        );
        let free = plan("press.toml", &press::text());
        assert!(
            free["command"].as_str().expect("a line").contains("--population 8 --generations 6 "),
            "{free}"
        );
        assert_eq!(free["search"]["what"].as_array().map(Vec::len), Some(3), "{free}");
    }

    #[test]
    fn what_is_asked_of_a_step_is_held_to_the_ranges_of_the_command() {
        assert!(Goal::default().checked().is_ok());
        let wrong = [
            (Goal { step_mm: 0.0, ..Goal::default() }, "step must be above 0 mm, is 0"),
            (
                Goal { settled_mm: Some(f64::NAN), ..Goal::default() },
                "settled within must be above 0 mm, is NaN",
            ),
            (Goal { time_s: 0.05, ..Goal::default() }, "time must be between 0.1 and 100 s, is 0.05"),
            (Goal { load_percent: 60.0, ..Goal::default() }, "load must be between 0 and 50 %, is 60"),
            (Goal { population: Some(1), ..Goal::default() }, "candidates must be between 2 and 1000, is 1"),
            (Goal { draws: 0, ..Goal::default() }, "draws must be between 1 and 1000, is 0"),
        ];
        for (goal, message) in wrong {
            assert_eq!(goal.checked().expect_err(message).message, message);
        }
    }
}
