//! The page of a tuning: before and after, every rig of the spread, what is in the way; and the rig file.

use anyhow::Result;

use super::trial::Trial;
use super::{Found, Goal, Obstacle, Task, Tuned};
use crate::evaluation::LimitCycle;
use crate::page::{Curve, Figure, Page, Panel, Table};
use crate::rig_text;
use crate::transient::{CHANNELS, COMMAND, POSITION, SETPOINT, SPOOL};
use crate::tuning::Variant;

/// What is drawn, from top to bottom.
const DRAWN: [usize; 3] = [POSITION, COMMAND, SPOOL];

const BEFORE: &str = "#7f7f7f";
const AFTER: &str = "#1f4e9c";
const ASKED: &str = "#c0392b";

/// The page.
///
/// # Errors
/// When the step cannot be simulated any more.
pub fn page(task: &Task, tuned: &Tuned) -> Result<Page> {
    let trial = Trial::of(task, &[])?;
    let mut tables = vec![figures(tuned, &task.goal), gains(&trial, tuned), variants(tuned, &task.goal)];
    if !tuned.obstacles.is_empty() {
        tables.insert(1, obstacles(&tuned.obstacles, &task.goal));
    }
    let generations = (0..tuned.progress.len()).map(|n| n as f64).collect();
    let search = Figure {
        heading: "the search".to_owned(),
        across: "generation".to_owned(),
        panels: vec![Panel::new(
            "cost, s",
            vec![Curve::new("best so far", generations, tuned.progress.clone())],
        )],
        ..Figure::default()
    };
    Ok(Page {
        title: format!("{}: gains for a step of {} mm", trial.rig.name(), task.goal.step_mm),
        notes: vec![verdict(task, tuned), asked(task, tuned)],
        tables,
        figures: vec![step(&trial, tuned), closely(&trial, tuned, &task.goal), search],
    })
}

/// What was asked for.
fn asked(task: &Task, tuned: &Tuned) -> String {
    let Goal { step_mm, settled_mm, overshoot_percent } = task.goal;
    let percent = |what: &str, by: f64| format!("{what} \u{b1}{:.0} %", 100.0 * by);
    format!(
        "Asked for: {step_mm} mm there and back, settled within {settled_mm} mm, overshoot below {overshoot_percent} % of the step, no limit cycle, on {} rigs: the one of the file, the corners of {}, {}, {}, and draws between them. The cost of gains is that of their worst rig: the settling time, and more for what is not as asked. {} runs, seed {}.",
        tuned.variants.len(),
        percent("load", task.spread.load),
        percent("friction", task.spread.friction),
        percent("supply", task.spread.supply),
        tuned.runs,
        task.budget.seed,
    )
}

/// In a sentence: is the goal met, and if not, what is in the way.
#[must_use]
pub fn verdict(task: &Task, tuned: &Tuned) -> String {
    let (all, goal) = (tuned.variants.len(), &task.goal);
    let (before, after) = (tuned.before.met(goal), tuned.after.met(goal));
    let counts = format!("the goal is met on {after} of {all} rigs; with the gains of the file on {before}");
    if after == all {
        return format!(
            "{} The slowest settles after {}.",
            capital(&counts) + ".",
            said(slowest(&tuned.after), 3) + " s"
        );
    }
    let removers = |count: usize| {
        let of = tuned.obstacles.iter().filter(move |one| one.found.met(goal) >= count);
        of.map(|one| one.suspect.what).collect::<Vec<_>>().join("; or with ")
    };
    let most = tuned.obstacles.iter().map(|one| one.found.met(goal)).max().unwrap_or(0);
    let why = match (removers(all), most) {
        (met, _) if !met.is_empty() => format!("It is met on all with {met}."),
        (_, most) if most > after => format!("With {} it is met on {most}.", removers(most)),
        _ => "None of the imperfections that were taken away one by one changes that.".to_owned(),
    };
    format!("{}. {why}", capital(&counts))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn slowest(found: &Found) -> Option<f64> {
    let times = found.performances.iter().map(|one| one.settling_s);
    times.reduce(|a, b| Some(a?.max(b?))).flatten()
}

fn said(value: Option<f64>, decimals: usize) -> String {
    value
        .filter(|value| value.is_finite())
        .map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// Columns of what a step does.
const SHOWN: [&str; 5] =
    ["met", "settles after, s", "overshoot, %", "error at the end, mm", "limit cycle, mm peak to peak"];

/// The worst of everything, over all rigs.
fn worst(found: &Found, goal: &Goal) -> Vec<String> {
    let all = || found.performances.iter();
    let largest = |of: &dyn Fn(&super::Performance) -> Option<f64>| {
        all().map(of).reduce(|a, b| Some(a?.max(b?))).flatten()
    };
    vec![
        format!("{} of {}", found.met(goal), found.performances.len()),
        said(slowest(found), 3),
        said(largest(&|one| one.overshoot_percent), 2),
        said(largest(&|one| Some(one.error_mm)), 3),
        all().map(|one| one.limit_cycle).reduce(LimitCycle::or_worse).map_or_else(|| "-".to_owned(), swing),
    ]
}

/// A limit cycle in words.
fn swing(limit_cycle: LimitCycle) -> String {
    match limit_cycle {
        LimitCycle::None { .. } => "none".to_owned(),
        LimitCycle::Sustained(seen) => format!("{:.3}", seen.swing_mm),
        LimitCycle::Undecided(_) => "not decidable".to_owned(),
    }
}

fn table(heading: &str, first: &str, rows: Vec<Vec<String>>) -> Table {
    let columns = std::iter::once(first).chain(SHOWN).map(str::to_owned).collect();
    Table { heading: heading.to_owned(), columns, rows }
}

/// Before and after.
#[must_use]
pub fn figures(tuned: &Tuned, goal: &Goal) -> Table {
    let row = |name: &str, found: &Found| [vec![name.to_owned()], worst(found, goal)].concat();
    let rows = vec![row("of the file", &tuned.before), row("found", &tuned.after)];
    table("the worst over all rigs", "gains", rows)
}

/// What is in the way.
#[must_use]
pub fn obstacles(all: &[Obstacle], goal: &Goal) -> Table {
    let row = |one: &Obstacle| [vec![one.suspect.what.to_owned()], worst(&one.found, goal)].concat();
    table(
        "what is in the way: the same, with gains found for a rig that has",
        "instead",
        all.iter().map(row).collect(),
    )
}

fn variants(tuned: &Tuned, goal: &Goal) -> Table {
    let row = |(variant, one): (&Variant, &super::Performance)| {
        let faults = one.faults(goal);
        let met = if faults.is_empty() { "yes".to_owned() } else { faults.join(", ") };
        let failure = if one.failure.is_empty() { met } else { one.failure.clone() };
        vec![
            variant.name(),
            failure,
            said(one.settling_s, 3),
            said(one.overshoot_percent, 2),
            said(Some(one.error_mm), 3),
            swing(one.limit_cycle),
        ]
    };
    let rows = tuned.variants.iter().zip(&tuned.after.performances).map(row).collect();
    table("the gains found, rig by rig", "rig", rows)
}

/// The keys that were found, and what they were.
#[must_use]
pub fn gains(trial: &Trial, tuned: &Tuned) -> Table {
    let row = |setting: &String| {
        let (key, found) = setting.split_once('=').unwrap_or((setting, ""));
        let before = trial.rig.value(key).map_or_else(|| "-".to_owned(), ToString::to_string);
        vec![key.to_owned(), before, found.to_owned()]
    };
    Table {
        heading: "the gains".to_owned(),
        columns: ["key", "in the file", "found"].map(str::to_owned).to_vec(),
        rows: tuned.after.settings.iter().map(row).collect(),
    }
}

/// The step before and after, on the rig of the file.
fn step(trial: &Trial, tuned: &Tuned) -> Figure {
    let runs = [("before", BEFORE, &tuned.before), ("after", AFTER, &tuned.after)];
    let runs =
        runs.map(|(name, colour, found)| (name, colour, trial.transient(&found.settings, &Variant::NOMINAL)));
    let curve = |(name, colour, run): &(&str, &'static str, Result<(crate::transient::Transient, _), _>),
                 channel: usize| {
        let (transient, _) = run.as_ref().ok()?;
        let (x, y) = (transient.time.clone(), transient.channels[channel].clone());
        Some(Curve { colour: Some(*colour), ..Curve::new(name, x, y) })
    };
    let setpoint = || {
        let (transient, _) = runs[1].2.as_ref().ok()?;
        let (x, y) = (transient.time.clone(), transient.channels[SETPOINT].clone());
        Some(Curve {
            colour: Some(ASKED),
            look: crate::page::Look::DashedSteps,
            ..Curve::new("setpoint", x, y)
        })
    };
    let panel = |channel: usize| {
        let (name, unit) = CHANNELS[channel];
        let asked = (channel == POSITION).then(setpoint).flatten();
        let curves = asked.into_iter().chain(runs.iter().filter_map(|run| curve(run, channel)));
        Panel::new(&format!("{name}, {unit}"), curves.collect())
    };
    Figure {
        heading: "the step, on the rig of the file".to_owned(),
        ..Figure::over_time(DRAWN.map(panel).to_vec())
    }
}

/// The distance from the setpoint on each rig, near zero.
fn closely(trial: &Trial, tuned: &Tuned, goal: &Goal) -> Figure {
    let near = 20.0 * goal.settled_mm;
    let curves = tuned.variants.iter().take(9).filter_map(|variant| {
        let (transient, _) = trial.transient(&tuned.after.settings, variant).ok()?;
        let [setpoint, position] = [SETPOINT, POSITION].map(|channel| &transient.channels[channel]);
        let error = setpoint.iter().zip(position).map(|(to, at)| to - at);
        let shown = error.map(|error| if error.abs() <= near { error } else { f64::NAN }).collect();
        Some(Curve::new(&variant.name(), transient.time.clone(), shown))
    });
    let mut curves: Vec<Curve> = curves.collect();
    let ends = vec![0.0, curves.first().and_then(|curve| curve.x.last().copied()).unwrap_or(1.0)];
    for bound in [goal.settled_mm, -goal.settled_mm] {
        let name = "settled within".to_owned();
        let look = crate::page::Look::Dashed;
        curves.push(Curve { name, x: ends.clone(), y: vec![bound; 2], look, colour: Some(ASKED) });
    }
    Figure {
        heading: "how close it comes: the rig of the file, and the corners of the spread".to_owned(),
        ..Figure::over_time(vec![Panel::new("setpoint less position, mm", curves)])
    }
}

/// The rig file with what was set and found, and in its first line where it comes from.
///
/// # Errors
/// When the text is no TOML.
pub fn rig_file(task: &Task, tuned: &Tuned) -> Result<String> {
    let settings: Vec<String> = task.settings.iter().chain(&tuned.after.settings).cloned().collect();
    let text = rig_text::with_settings(&task.source.1, &settings, "found by pneudrive tune")?;
    Ok(format!("{MARK}: {}\n{text}", verdict(task, tuned)))
}

/// First line of a rig file that was written here.
pub const MARK: &str = "# Written by pneudrive tune";
