//! The graphs of a tuning.

use pneudrive_sim::Rig;
use pneudrive_sim::component::controller;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys;
use pneudrive_sim::rig::Value;

use crate::tuning::trial::Trial;
use crate::tuning::{Goal, Task, Tuned, Variant};
use pneudrive_evaluate::evaluation::Move;
use pneudrive_evaluate::parallel;
use pneudrive_evaluate::transient::{CHANNELS, COMMAND, POSITION, SETPOINT, SPOOL, Transient};
use pneudrive_report::{Curve, Figure, Look, Panel};

/// The curves of the file's rig, from top to bottom.
const DRAWN: [usize; 3] = [POSITION, COMMAND, SPOOL];

pub(super) const BEFORE: &str = "#7f7f7f";
pub(super) const AFTER: &str = "#1f4e9c";
pub(super) const REQUIRED: &str = "#c0392b";
const MET: &str = "#1f4e9c";
pub(super) const MISSED: &str = "#e08214";

/// Every this many samples of many runs, one is drawn.
pub(super) const EVERY: usize = 3;

/// The steps of all fresh draws from their beginnings on: how far they have gone, and how close they come.
#[must_use]
pub fn draws(task: &Task, trial: &Trial, tuned: &Tuned) -> Figure {
    let goal = &task.goal;
    let run = |variant: &Variant| trial.transient(&tuned.after.settings, variant).ok();
    let runs = parallel::map(&tuned.fresh, run, |_| {});
    let near = 20.0 * goal.settled_mm;
    let curve = |is_met: bool, of: &dyn Fn(f64, f64) -> f64| {
        let these = runs.iter().zip(&tuned.after.fresh).filter(|(_, one)| one.meets(goal) == is_met);
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for (transient, moves) in these.clone().filter_map(|(run, _)| run.as_ref()) {
            moves.iter().skip(1).for_each(|step| add(transient, step, of, &mut x, &mut y));
        }
        let (word, colour) = if is_met { ("goal met", MET) } else { ("goal not met", MISSED) };
        Curve { colour: Some(colour), ..Curve::new(&format!("{word}: {} draws", these.count()), x, y) }
    };
    let travel = |gone: f64, _: f64| gone;
    let error = |_: f64, beyond: f64| if beyond.abs() <= near { beyond } else { f64::NAN };
    let mut close = vec![curve(false, &error), curve(true, &error)];
    close.extend([goal.settled_mm, -goal.settled_mm].map(|bound| Curve {
        look: Look::Dashed,
        colour: Some(REQUIRED),
        ..Curve::new("settled within", vec![0.0, goal.time_s], vec![bound; 2])
    }));
    Figure {
        heading: format!("steps there and back in {} fresh draws", tuned.fresh.len()),
        across: "time since the step, s".to_owned(),
        panels: vec![
            Panel::new("travel, mm", shown(vec![curve(false, &travel), curve(true, &travel)])),
            Panel::new("beyond the setpoint, mm", shown(close)),
        ],
        ..Figure::default()
    }
}

/// Adds a step to a curve, behind a gap: `of` is given the travel since the step and how far it is beyond the setpoint.
fn add(transient: &Transient, step: &Move, of: &dyn Fn(f64, f64) -> f64, x: &mut Vec<f64>, y: &mut Vec<f64>) {
    let Some(to) = step.to_mm else { return };
    let side = (to - step.from_mm).signum();
    let first = transient.time.partition_point(|time| *time < step.start_s);
    let setpoint = &transient.channels[SETPOINT];
    let samples = (first..transient.time.len()).take_while(|&k| (setpoint[k] - to).abs() < 1e-9);
    for k in samples.step_by(EVERY) {
        let at = transient.channels[POSITION][k];
        x.push(rounded(transient.time[k] - step.start_s));
        y.push(rounded(of(side * (at - step.from_mm), side * (at - to))));
    }
    x.push(0.0);
    y.push(f64::NAN);
}

/// The curves that show something.
fn shown(curves: Vec<Curve>) -> Vec<Curve> {
    curves.into_iter().filter(|curve| curve.y.iter().any(|value| value.is_finite())).collect()
}

/// A page holds many of them.
pub(super) fn rounded(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// Where on the stroke a step settles when.
#[must_use]
pub fn places(trial: &Trial, tuned: &Tuned, goal: &Goal) -> Figure {
    let all = || tuned.fresh.iter().zip(&tuned.after.fresh);
    let points = |name: &str, colour, is_met: bool, settles: bool| {
        let these = all().filter(|(_, one)| one.meets(goal) == is_met && one.settling_s.is_some() == settles);
        let (x, y) = these
            .map(|(variant, one)| (trial.ends_mm(variant)[0], one.settling_s.unwrap_or(goal.time_s)))
            .unzip();
        Curve { look: Look::Points, colour: Some(colour), ..Curve::new(name, x, y) }
    };
    let curves = vec![
        points("goal met", MET, true, true),
        points("settles, but the goal is not met", MISSED, false, true),
        points("does not settle (at the top)", REQUIRED, false, false),
    ];
    Figure {
        heading: "settling time over the start position of a step; the slower of the two directions"
            .to_owned(),
        across: "begins at, mm".to_owned(),
        panels: vec![Panel::new("settles after, s", shown(curves))],
        ..Figure::default()
    }
}

/// The gain over the error, as the controller takes it: one for each span, none between them.
#[must_use]
pub fn profile(trial: &Trial, tuned: &Tuned) -> Option<Figure> {
    let mut found = vec![("of the file", BEFORE, zones(&trial.rig)?)];
    if tuned.is_changed() {
        let rig = trial.with(&tuned.after.settings).ok()?;
        found.push(("found", AFTER, zones(&rig)?));
    }
    let widest = found.iter().filter_map(|(_, _, zones)| zones.last()).map(|zone| zone.0).fold(0.0, f64::max);
    let mm = mm_per_count(&trial.rig);
    let curve = |(name, colour, zones): &(&str, &'static str, Vec<(f64, f64)>)| {
        let shown = zones.iter().copied().chain(zones.last().map(|last| (2.0 * widest, last.1)));
        let (x, y): (Vec<f64>, Vec<f64>) = shown.map(|(from, gain)| (from.max(mm), gain)).unzip();
        Curve { colour: Some(*colour), look: Look::Steps, ..Curve::new(name, x, y) }
    };
    Some(Figure {
        heading:
            "the gain profile: the controller uses one gain for each span of error, without interpolation"
                .to_owned(),
        across: "size of the error, mm (from one count on)".to_owned(),
        logarithmic: true,
        panels: vec![Panel {
            logarithmic: true,
            ..Panel::new("gain on the error", found.iter().map(curve).collect())
        }],
    })
}

/// Where each zone of a profile begins, mm, and its gain; None of a law without one.
fn zones(rig: &Rig) -> Option<Vec<(f64, f64)>> {
    let Some(Value::Integers(entries)) = rig.value(keys::controller::GAIN_PROFILE.path) else { return None };
    let span = rig.get(&keys::controller::PROFILE_SPAN_COUNTS) as f64 * mm_per_count(rig);
    let zones = entries.iter().enumerate().map(|(i, gain)| (i as f64 * span, *gain as f64));
    (rig.get(&keys::controller::LAW) == controller::Law::GainProfile).then(|| zones.collect())
}

/// The step before and after, on the rig of the file.
#[must_use]
pub fn step(trial: &Trial, tuned: &Tuned) -> Figure {
    let both = [("before", BEFORE, &tuned.before), ("after", AFTER, &tuned.after)];
    let both = &both[usize::from(!tuned.is_changed())..];
    let runs: Vec<_> = both
        .iter()
        .filter_map(|(name, colour, found)| {
            let (transient, _) = trial.transient(&found.settings, &Variant::NOMINAL).ok()?;
            Some((*name, *colour, transient))
        })
        .collect();
    let curve = |name: &str, colour, look, transient: &Transient, channel: usize| {
        let (x, y) = (transient.time.clone(), transient.channels[channel].clone());
        Curve { colour: Some(colour), look, ..Curve::new(name, x, y) }
    };
    let panel = |channel: usize| {
        let (name, unit) = CHANNELS[channel];
        let asked = runs.first().filter(|_| channel == POSITION);
        let asked = asked.map(|(_, _, run)| curve("setpoint", REQUIRED, Look::DashedSteps, run, SETPOINT));
        let curves = runs.iter().map(|(name, colour, run)| curve(name, colour, Look::Line, run, channel));
        Panel::new(&format!("{name}, {unit}"), asked.into_iter().chain(curves).collect())
    };
    Figure {
        heading: "step in mid-stroke, rig of the file".to_owned(),
        ..Figure::over_time(DRAWN.map(panel).to_vec())
    }
}

/// The best cost of each generation.
#[must_use]
pub fn search(tuned: &Tuned) -> Figure {
    let generations = (1..=tuned.progress.len()).map(|n| n as f64).collect();
    Figure {
        heading: "search".to_owned(),
        across: "generation".to_owned(),
        panels: vec![Panel::new(
            "mean cost of a trial, 0 to 2",
            vec![Curve::new("best so far", generations, tuned.progress.clone())],
        )],
        ..Figure::default()
    }
}
