//! The results of a tuning: the page, its notes, and the rig file.

pub mod figures;
mod numbers;
mod rig_file;
pub mod sines;
pub mod tables;
mod verdict;

use std::path::Path;

use anyhow::Result;

use super::trial::Trial;
use super::{Behaviour, Found, Goal, Proportion, Space, Task, Tuned};
use pneudrive_report::{Figure, Library, Page, Table};

pub use numbers::to_json;
pub use rig_file::{MARK, rig_file};
pub use verdict::verdict;

/// Writes the page: the fresh draws first.
///
/// # Errors
/// When the step cannot be simulated, or the page cannot be written.
pub fn write_page(
    task: &Task,
    tuned: &Tuned,
    behaviour: &Behaviour,
    path: &Path,
    library: Library,
) -> Result<()> {
    let (page, draws) = page(task, tuned, behaviour)?;
    page.write_led_by(path, &draws, library)
}

/// The page, and the figure that leads it: the fresh draws.
///
/// # Errors
/// When the step cannot be simulated.
pub fn page(task: &Task, tuned: &Tuned, behaviour: &Behaviour) -> Result<(Page, Figure)> {
    let trial = Trial::of(task, &[])?;
    let goal = &task.goal;
    let mut tables = shown(tuned, behaviour, goal);
    if tuned.is_changed() {
        tables.extend([tables::gains(&trial, tuned), tables::places(tuned)]);
    }
    tables.push(tables::draws(&trial, tuned, goal));
    let profile = figures::profile(&trial, tuned);
    let search = (!tuned.progress.is_empty()).then(|| figures::search(tuned));
    let page = Page {
        title: format!("{}: gains for a step of {} mm", trial.rig.name(), goal.step_mm),
        notes: [notes(task, tuned), sines::notes(&trial, behaviour), vec![asked(task, &trial, tuned)]]
            .concat(),
        tables,
        figures: [Some(figures::places(&trial, tuned, goal)), profile, Some(figures::step(&trial, tuned))]
            .into_iter()
            .flatten()
            .chain(sines::figures(&trial, behaviour))
            .chain(search)
            .collect(),
        ..Page::default()
    };
    Ok((page, figures::draws(task, &trial, tuned)))
}

/// The tables of the results: the fresh draws first.
#[must_use]
pub fn shown(tuned: &Tuned, behaviour: &Behaviour, goal: &Goal) -> Vec<Table> {
    let mut tables = vec![
        tables::judged(tuned, goal),
        tables::members(tuned, goal),
        tables::along_the_stroke(&behaviour.steps, goal),
        sines::errors(&behaviour.sines),
        sines::shares(&behaviour.sines),
    ];
    if !tuned.obstacles.is_empty() {
        tables.push(tables::obstacles(&tuned.obstacles, goal));
    }
    tables
}

/// The verdict and its qualifications, a few sentences each.
#[must_use]
pub fn notes(task: &Task, tuned: &Tuned) -> Vec<String> {
    let reason = reason(task, tuned);
    [verdict(task, tuned), nominal(task, tuned)].into_iter().chain(reason).chain(limits(tuned)).collect()
}

/// Whether the rig of the file meets the goal, and its perturbed runs with it.
fn nominal(task: &Task, tuned: &Tuned) -> String {
    let seen = task.goal.met_in(&tuned.after.members);
    let how = match seen.met {
        0 => "does not meet it, nor does any of its perturbed runs".to_owned(),
        all if all == seen.of => format!("meets it, and so do its {} perturbed runs", seen.of - 1),
        some => format!(
            "may or may not meet it: it and its perturbed runs, which differ very slightly, do so in {some} of {} runs",
            seen.of
        ),
    };
    format!("The rig of the file, in mid-stroke, {how}.")
}

/// The obstacle to the goal, or to settling at all, if the goal is not met everywhere.
fn reason(task: &Task, tuned: &Tuned) -> Option<String> {
    let met = |found: &Found| found.met(&task.goal);
    let settled = |found: &Found| {
        let met = found.fresh.iter().filter(|one| one.settling_s.is_some()).count();
        Proportion { met, of: found.fresh.len() }
    };
    if tuned.obstacles.is_empty() {
        return None;
    }
    let better =
        remover(tuned, &met).map(|(what, count)| format!("With {what}, it is met in {count} of them."));
    let better = better.or_else(|| {
        let (what, count) = remover(tuned, &settled)?;
        let own = settled(&tuned.after);
        Some(format!("With {what}, the drive settles in {count} of them, instead of in {own}."))
    });
    let none = "Removing any single imperfection leaves the 95 % intervals overlapping, so none is named as the cause.";
    Some(better.unwrap_or_else(|| none.to_owned()))
}

/// The imperfections whose removal improves most draws, and the count then, if it is significant: if its interval does
/// not overlap that of the unchanged rig.
fn remover(tuned: &Tuned, count: &dyn Fn(&Found) -> Proportion) -> Option<(String, Proportion)> {
    let most = tuned.obstacles.iter().map(|one| count(&one.found)).max_by_key(|count| count.met)?;
    let with = tuned.obstacles.iter().filter(|one| count(&one.found) == most).map(|one| one.suspect.what);
    let is_more = most.interval()[0] > count(&tuned.after).interval()[1];
    is_more.then(|| (with.collect::<Vec<_>>().join("; or with "), most))
}

/// The values at an end of their search range: there may be better ones beyond it.
fn limits(tuned: &Tuned) -> Option<String> {
    let places = tuned.after.places.iter().filter(|place| place.at_limit).map(|place| {
        let [value, low, high] = [place.value, place.range[0], place.range[1]].map(tables::digits);
        format!("{} {value} {} (searched from {low} to {high})", place.what, place.unit)
    });
    let saturated = Space::saturated(&tuned.after.settings).into_iter();
    let saturated = saturated.map(|key| format!("{key} at 65535, the largest that the controller takes"));
    let all: Vec<String> = places.chain(saturated).collect();
    (!all.is_empty()).then(|| {
        format!(
            "At the limit of the search range, so there may be better gains beyond it: {}.",
            all.join("; ")
        )
    })
}

/// The task in words.
fn asked(task: &Task, trial: &Trial, tuned: &Tuned) -> String {
    let Goal { step_mm, settled_mm, overshoot_percent, time_s } = task.goal;
    let percent = |what: &str, by: f64| format!("{what} \u{b1}{:.0} %", 100.0 * by);
    let [low, high] = trial.range_mm();
    let fixed = match task.fixed.as_slice() {
        [] => String::new(),
        fixed => format!(" Fixed: {}.", fixed.join(", ")),
    };
    let left = match Space::left_alone(&trial.rig) {
        [] => String::new(),
        keys => format!(
            " Left as the file has them: {}. If you can set them, write operator.dither_adjustable = true.",
            keys.join(", ")
        ),
    };
    format!(
        "Goal: {step_mm} mm there and back, {time_s} s each way, settled within {settled_mm} mm, overshoot below {overshoot_percent} % of the step, no limit cycle. The spread: {}, {}, {}, {}, steps in either direction between {low:.1} and {high:.1} mm. The gains were tuned on {} trials, the rig of the file and draws from the spread; the cost of gains is the mean over these: for a step that meets the goal, the share of its time that it takes to settle; otherwise 1 to 2, growing with the distance from the goal. They are judged on {} other draws, which the search has not seen.{fixed}{left} {} runs, seed {}.",
        percent("load", task.spread.load),
        percent("friction", task.spread.friction),
        percent("supply", task.spread.supply),
        percent("valve", task.spread.valve),
        tuned.tuned_on.len(),
        tuned.fresh.len(),
        tuned.runs,
        task.budget.seed,
    )
}
