//! Rigs, runs and columns that several experiments share.

use std::ops::Range;

use anyhow::{Context, Result};
use pneudrive_sim::component::controller;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys;
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::trace::Row;
use pneudrive_sim::{Accuracy, Recording, Rig, Run, run_recorded};

use super::{Chart, Line};

/// A built-in rig with settings.
///
/// # Errors
/// When there is no such rig, or it refuses the settings.
pub(super) fn rig(name: &str, settings: &[&str]) -> Result<Rig> {
    rig_and(name, "", settings)
}

/// The same with additional settings.
pub(super) fn rig_and(name: &str, more: &str, settings: &[&str]) -> Result<Rig> {
    let text = builtin(name).with_context(|| format!("there is no built-in rig {name}"))?;
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    Ok(Rig::read_with(name, &format!("{text}{more}"), &settings)?)
}

/// The run of a rig, as exact as its motion needs, with the air inside its valve.
pub(super) fn run(rig: &Rig) -> Result<Run> {
    run_recorded(rig, Accuracy::of_motion(rig), Recording { valve: true }, |_, _| {})
        .with_context(|| format!("{} cannot be simulated", rig.name()))
}

/// A figure of each row.
pub(super) fn column(run: &Run, of: impl Fn(&Row) -> f64) -> Vec<f64> {
    run.rows.iter().map(of).collect()
}

/// Rows whose time lies within a span, s.
pub(super) fn rows_within(run: &Run, [from, to]: [f64; 2]) -> Range<usize> {
    let place = |time: f64| run.rows.partition_point(|row| row.time < time);
    place(from)..place(to)
}

/// Root of the mean square.
pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    (sum / count).sqrt()
}

/// The middle one of values.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => f64::NAN,
        count if count % 2 == 0 => f64::midpoint(sorted[middle - 1], sorted[middle]),
        _ => sorted[middle],
    }
}

/// Position with its setpoint, and the chamber pressures of a run.
pub(super) fn step_charts(title: &str, rig: &Rig, run: &Run) -> [Chart; 2] {
    let time = column(run, |row| row.time);
    let pulse_mm = mm_per_count(rig);
    let line = |name: &str, of: &dyn Fn(&Row) -> f64| Line::new(name, &time, &column(run, of));
    let mut position = vec![line("position", &|row| 1e3 * row.plant.position)];
    if rig.get(&keys::controller::LOOP) == controller::Loop::Closed {
        position.push(line("setpoint", &|row| pulse_mm * f64::from(row.observation.setpoint)));
    }
    let pressures = [0, 1]
        .map(|chamber| line(&format!("chamber {}", chamber + 1), &|row| 1e-3 * row.plant.pressures[chamber]));
    let chart = |what: &str, up: &'static str, lines: Vec<Line>| Chart {
        title: format!("{title}: {what}"),
        across: "time, s",
        up,
        lines,
        ..Chart::default()
    };
    [chart("position", "position, mm", position), chart("pressures", "pressure, kPa", pressures.into())]
}
