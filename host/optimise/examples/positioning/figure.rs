//! docs/pictures/control.svg: a step on the draws under each law, above the position and below the size of the error in decades.

use std::fmt::Write;

use anyhow::Result;
use pneudrive_evaluate::parallel;
use pneudrive_optimise::positioning::course::HOLD_S;
use pneudrive_optimise::positioning::draw::Place;
use pneudrive_optimise::positioning::{Plan, Steps, bound, draws};
use pneudrive_sim::component::encoder::{self, mm_per_count};
use pneudrive_sim::{Accuracy, Rig, Runner};

use crate::laws::Law;

/// What is shown of a step, s.
const SHOWN_S: f64 = 1.0;
/// Decades of the error, mm.
const DECADES: [i32; 2] = [-3, 2];
/// The band that a step shall end within, mm.
const BAND_MM: f64 = 0.05;

/// Both fields, in pixels: left, width, and top and height of each.
const LEFT: f64 = 60.0;
const WIDTH: f64 = 560.0;
const ABOVE: [f64; 2] = [20.0, 180.0];
const BELOW: [f64; 2] = [240.0, 220.0];

/// Points nearer than this are one.
const NEAR_PX: f64 = 1.5;

/// In the order of the laws.
const COLOURS: [&str; 4] = ["#b5651d", "#777", "#1f5fa8", "#2a7d2a"];

/// A run: time since the step and distance to its target, s and mm.
type Course = Vec<[f64; 2]>;

fn x(time_s: f64) -> f64 {
    LEFT + WIDTH * time_s / SHOWN_S
}

fn y_position(left_mm: f64, step_mm: f64) -> f64 {
    let [top, height] = ABOVE;
    // From a tenth of the step before its begin to a fifth beyond its end.
    top + height * (left_mm / step_mm + 0.2) / 1.3
}

fn y_error(left_mm: f64) -> f64 {
    let ([top, height], [low, high]) = (BELOW, DECADES.map(f64::from));
    top + height * (high - left_mm.abs().log10().clamp(low, high)) / (high - low)
}

/// The figure of a step of `step_mm` about the middle of the stroke, extending.
pub fn of(laws: &[(&Law, Rig)], plan: &Plan, step_mm: f64) -> Result<String> {
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"510\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"640\" height=\"510\" fill=\"white\"/>\n",
    );
    axes(&mut svg, step_mm)?;
    for ((law, rig), (colour, row)) in laws.iter().zip(COLOURS.iter().zip(0..)) {
        for course in courses(rig, plan, step_mm)? {
            line(&mut svg, colour, course.iter().map(|[t, left]| [x(*t), y_position(*left, step_mm)]))?;
            line(&mut svg, colour, course.iter().map(|[t, left]| [x(*t), y_error(*left)]))?;
        }
        let (beside, at) = (x(0.62 * SHOWN_S), ABOVE[0] + 90.0 + 18.0 * f64::from(row));
        writeln!(svg, "<text x=\"{beside:.0}\" y=\"{at:.0}\" fill=\"{colour}\">{}</text>", law.name)?;
    }
    if let Some((_, rig)) = laws.first() {
        bang_bang(&mut svg, rig, step_mm)?;
    }
    Ok(svg + "</svg>\n")
}

/// The step on each draw of a plan.
fn courses(rig: &Rig, plan: &Plan, step_mm: f64) -> Result<Vec<Course>> {
    let steps = Steps::of(rig, step_mm, Place { along: 0.5, extends: true })?;
    let target_mm = encoder::middle(rig, steps.to as f64) * mm_per_count(rig);
    let rigs: Vec<Rig> = draws(rig, plan.spread, plan.seed, plan.draws)?
        .iter()
        .map(|draw| steps.on(&draw.rig(rig)?))
        .collect::<Result<_>>()?;
    let one = |rig: &Rig| -> Result<Course> {
        let mut runner = <Runner>::new(rig, Accuracy::of(rig));
        let rows = &runner.run()?.rows;
        let since = rows.iter().map(|row| [row.time - HOLD_S, target_mm - 1e3 * row.plant.position]);
        Ok(since.filter(|[time, _]| (0.0..=SHOWN_S).contains(time)).collect())
    };
    parallel::map(&rigs, one, |_| {}).into_iter().collect()
}

/// A line through the points that can be told from the one before.
fn line(svg: &mut String, colour: &str, points: impl Iterator<Item = [f64; 2]>) -> Result<()> {
    let mut last = [f64::NAN; 2];
    let mut shown = Vec::new();
    for at in points {
        let [x, y] = at;
        let is_near = (x - last[0]).abs() < NEAR_PX && (y - last[1]).abs() < NEAR_PX;
        if !is_near {
            shown.push(format!("{x:.0},{y:.0}"));
            last = at;
        }
    }
    let points = shown.join(" ");
    writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" opacity=\"0.6\"/>")?;
    Ok(())
}

/// The time at which a valve that is only ever fully open could have the piston at the target.
fn bang_bang(svg: &mut String, rig: &Rig, step_mm: f64) -> Result<()> {
    let Some(bound) = bound(rig, step_mm, true)? else { return Ok(()) };
    let (at, top, bottom) = (x(bound.time_s), ABOVE[0], BELOW[0] + BELOW[1]);
    writeln!(svg, "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"black\" stroke-dasharray=\"4 3\"/>")?;
    let (beside, at_foot, ms) = (at + 5.0, top + ABOVE[1] + 14.0, 1e3 * bound.time_s);
    writeln!(svg, "<text x=\"{beside:.1}\" y=\"{at_foot}\">bang-bang bound, {ms:.0} ms</text>")?;
    Ok(())
}

fn axes(svg: &mut String, step_mm: f64) -> Result<()> {
    let right = LEFT + WIDTH;
    let mut across = |y: f64, label: &str| -> Result<()> {
        writeln!(svg, "<path d=\"M{LEFT} {y:.1}H{right}\" stroke=\"#ddd\"/>")?;
        writeln!(svg, "<text x=\"{}\" y=\"{y:.1}\" dy=\"4\" text-anchor=\"end\">{label}</text>", LEFT - 6.0)?;
        Ok(())
    };
    for part in 0..=3 {
        let travel_mm = f64::from(part) / 3.0 * step_mm;
        across(y_position(step_mm - travel_mm, step_mm), &format!("{travel_mm:.0}"))?;
    }
    for decade in DECADES[0]..=DECADES[1] {
        let mm = 10_f64.powi(decade);
        across(y_error(mm), &format!("{mm}"))?;
    }
    across(y_error(BAND_MM), &BAND_MM.to_string())?;
    let foot = BELOW[0] + BELOW[1];
    for part in 0..=5 {
        let time_s = f64::from(part) / 5.0 * SHOWN_S;
        let (x, below) = (x(time_s), foot + 18.0);
        writeln!(svg, "<text x=\"{x:.1}\" y=\"{below}\" text-anchor=\"middle\">{time_s:.1}</text>")?;
    }
    for ([top, height], name) in [(ABOVE, "travel, mm"), (BELOW, "distance to the target, mm")] {
        let middle = top + 0.5 * height;
        writeln!(
            svg,
            "<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{name}</text>"
        )?;
    }
    let (middle, below) = (LEFT + 0.5 * WIDTH, foot + 38.0);
    writeln!(svg, "<text x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">time since the step, s</text>")?;
    Ok(())
}
