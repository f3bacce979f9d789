//! The tables of a tuning.

use crate::tuning::stroke::AtPlace;
use crate::tuning::trial::Trial;
use crate::tuning::{Found, Goal, LimitingImperfection, Performance, Tuned, Variant};
use pneudrive_evaluate::evaluation::LimitCycle;
use pneudrive_evaluate::range::with_range;
use pneudrive_report::Table;

/// Columns for the performance of gains on many rigs.
const ON_MANY: [&str; 9] = [
    "goal met, fresh draws",
    "95 % interval",
    "goal met, tuning trials",
    "settle",
    "after, s: median, slowest",
    "overshoot, %: largest",
    "error at the end, mm: largest",
    "limit-cycle",
    "not decidable",
];

/// The performance of gains in the fresh draws.
fn on_many(found: &Found, goal: &Goal) -> Vec<String> {
    let all = &found.fresh;
    let count = |is: &dyn Fn(&Performance) -> bool| all.iter().filter(|one| is(one)).count().to_string();
    let [low, high] = found.met(goal).interval().map(|end| 100.0 * end);
    let seen = goal.met_in(&found.tuned_on);
    let mut times: Vec<f64> = all.iter().filter_map(|one| one.settling_s).collect();
    times.sort_by(f64::total_cmp);
    let settling = match times.last() {
        Some(slowest) => format!("{:.3}, {slowest:.3}", times[times.len() / 2]),
        None => "-".to_owned(),
    };
    let largest = |of: &dyn Fn(&Performance) -> Option<f64>| all.iter().filter_map(of).reduce(f64::max);
    let overshoots = all.iter().all(|one| one.overshoot_percent.is_some());
    vec![
        format!("{} of {}", found.met(goal).met, all.len()),
        format!("{low:.0} to {high:.0} %"),
        format!("{} of {}", seen.met, seen.of),
        count(&|one| one.settling_s.is_some()),
        settling,
        match largest(&|one| one.overshoot_percent) {
            Some(seen) if !overshoots => format!("at least {seen:.2}"),
            seen => formatted(seen, 2),
        },
        formatted(largest(&|one| Some(one.error_mm).filter(|mm| mm.is_finite())), 3),
        count(&|one| matches!(one.limit_cycle, LimitCycle::Sustained(_))),
        count(&|one| matches!(one.limit_cycle, LimitCycle::Undecided(_))),
    ]
}

fn many(heading: &str, first: &str, rows: Vec<Vec<String>>) -> Table {
    Table::new(heading, std::iter::once(first).chain(ON_MANY), rows)
}

/// Before and after, in the fresh draws.
#[must_use]
pub fn judged(tuned: &Tuned, goal: &Goal) -> Table {
    let row = |name: &str, found: &Found| [vec![name.to_owned()], on_many(found, goal)].concat();
    let mut rows = vec![row("of the file", &tuned.before)];
    if tuned.is_changed() {
        rows.push(row("found", &tuned.after));
    }
    many(&format!("in {} fresh draws from the spread", tuned.fresh.len()), "gains", rows)
}

/// The limits on the performance.
#[must_use]
pub fn obstacles(all: &[LimitingImperfection], goal: &Goal) -> Table {
    let row =
        |one: &LimitingImperfection| [vec![one.suspect.what.to_owned()], on_many(&one.found, goal)].concat();
    many(
        "what limits it: the same draws, with gains found for a rig that has",
        "instead",
        all.iter().map(row).collect(),
    )
}

/// The rig of the file with its perturbed runs.
#[must_use]
pub fn members(tuned: &Tuned, goal: &Goal) -> Table {
    let row = |name: &str, found: &Found| with_ensemble(name.to_owned(), &found.members, goal);
    let mut rows = vec![row("of the file", &tuned.before)];
    if tuned.is_changed() {
        rows.push(row("found", &tuned.after));
    }
    Table::new(
        "the rig of the file in mid-stroke; in brackets the range over it and its perturbed runs, whose mass and starting position differ by 1e-5",
        std::iter::once("gains").chain(WITH_ENSEMBLE),
        rows,
    )
}

/// The step along the stroke.
#[must_use]
pub(crate) fn along_the_stroke(steps: &[AtPlace], goal: &Goal) -> Table {
    let row = |step: &AtPlace| {
        let [from, to] = step.ends_mm;
        with_ensemble(format!("{from:.1} to {to:.1}"), &step.runs, goal)
    };
    Table::new(
        "the step along the stroke, with the gains that were found; in brackets the range over the rig of the file and its perturbed runs",
        std::iter::once("step and back, mm").chain(WITH_ENSEMBLE),
        steps.iter().map(row),
    )
}

/// Columns of a step on a rig and its perturbed runs.
const WITH_ENSEMBLE: [&str; 5] = [
    "goal met",
    "settles after, s",
    "overshoot, %",
    "error at the end, mm",
    "limit cycle, mm peak to peak: worst",
];

/// A step on a rig, first, and on its perturbed runs.
fn with_ensemble(name: String, runs: &[Performance], goal: &Goal) -> Vec<String> {
    let seen = goal.met_in(runs);
    let of = |of: &dyn Fn(&Performance) -> Option<f64>| runs.iter().map(of).collect::<Vec<_>>();
    let cycles = runs.iter().map(|one| one.limit_cycle).reduce(LimitCycle::or_worse);
    vec![
        name,
        format!("{} of {}", seen.met, seen.of),
        with_range(&of(&|one| one.settling_s), 3),
        with_range(&of(&|one| one.overshoot_percent), 2),
        with_range(&of(&|one| Some(one.error_mm).filter(|mm| mm.is_finite())), 3),
        cycles.map_or_else(|| "-".to_owned(), swing),
    ]
}

/// The keys found, and their former values.
#[must_use]
pub fn gains(trial: &Trial, tuned: &Tuned) -> Table {
    let row = |setting: &String| {
        let (key, found) = setting.split_once('=').unwrap_or((setting, ""));
        let before = trial.rig.value(key).map_or_else(|| "-".to_owned(), ToString::to_string);
        vec![key.to_owned(), before, found.to_owned()]
    };
    Table::new("the gains", ["key", "in the file", "found"], tuned.after.settings.iter().map(row))
}

/// The gains found, with their search ranges.
#[must_use]
pub fn places(tuned: &Tuned) -> Table {
    let rows = tuned.after.places.iter().map(|place| {
        let [value, low, high] = [place.value, place.range[0], place.range[1]].map(digits);
        let note = if place.at_limit { "at its limit" } else { "" };
        vec![place.what.to_owned(), value, format!("{low} to {high}"), place.unit.to_owned(), note.to_owned()]
    });
    Table::new("the gains within their search ranges", ["what", "found", "searched from", "unit", ""], rows)
}

/// Every fresh draw, the worst first.
#[must_use]
pub fn draws(trial: &Trial, tuned: &Tuned, goal: &Goal) -> Table {
    let mut all: Vec<(&Variant, &Performance)> = tuned.fresh.iter().zip(&tuned.after.fresh).collect();
    all.sort_by(|(_, a), (_, b)| {
        (a.meets(goal), b.distance_s(goal))
            .partial_cmp(&(b.meets(goal), a.distance_s(goal)))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let row = |(variant, one): (&Variant, &Performance)| {
        let faults = one.faults(goal);
        let met = if faults.is_empty() { "yes".to_owned() } else { faults.join(", ") };
        let [from, to] = trial.ends_mm(variant);
        vec![
            variant.name(),
            format!("{from:.1} to {to:.1}"),
            if one.failure.is_empty() { met } else { one.failure.clone() },
            formatted(one.settling_s, 3),
            formatted(one.overshoot_percent, 2),
            formatted(Some(one.error_mm), 3),
            swing(one.limit_cycle),
        ]
    };
    let columns = [
        "rig",
        "step and back, mm",
        "goal met",
        "settles after, s",
        "overshoot, %",
        "error at the end, mm",
        "limit cycle, mm peak to peak",
    ];
    Table::new("the fresh draws one by one, the worst first", columns, all.into_iter().map(row))
}

/// A limit cycle in words.
fn swing(limit_cycle: LimitCycle) -> String {
    match limit_cycle {
        LimitCycle::None { .. } => "none".to_owned(),
        LimitCycle::Sustained(seen) => format!("{:.3}", seen.swing_mm),
        LimitCycle::Undecided(_) => "not decidable".to_owned(),
    }
}

fn formatted(value: Option<f64>, decimals: usize) -> String {
    value
        .filter(|value| value.is_finite())
        .map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// A value with three digits.
pub(super) fn digits(value: f64) -> String {
    let before_point = if value == 0.0 { 1.0 } else { value.abs().log10().floor() + 1.0 };
    let decimals = (3.0 - before_point).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_said_with_three_digits() {
        let formatted = [0.0, 0.003, 0.0401, 0.598, 2.0, 12.345, 150.0, -1.5].map(digits);
        assert_eq!(formatted, ["0", "0.003", "0.0401", "0.598", "2", "12.3", "150", "-1.5"]);
    }
}
