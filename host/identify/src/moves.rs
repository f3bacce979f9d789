//! The tests whose transients show the parameters of a fit.
//!
//! Open loop, in strokes of the valve, short, and from rest. What makes a test good for a fit:
//!
//! - **The sum of squares is smooth.** A stroke opens the valve far and at once, so the drive breaks away once. Slow
//!   motion, and a closed loop that creeps to its setpoint, sticks and slips at instants that depend on tiny differences: a
//!   little more stiction then shifts everything that follows. So a record ends while the drive moves.
//! - **Spool steps of a medium size.** A spool oscillates to its new position and sticks there; the number of swings
//!   changes at steps of 745 and 1205 counts from rest, and at every further 480 counts, for servo-drive B. The strokes stay
//!   10 % away from these, so that a gain within 10 % of the file's is found without a jump.
//! - **Both directions, two sizes, there and back.** Accelerations show the mass, speeds the viscous and Coulomb friction
//!   and the discharge, breakaways the stiction.
//! - **A half open valve**, so that its opening matters: gain and null.
//! - **Rests of two lengths**, in which pressures creep: noise, leakage and null.
//!
//! How long a stroke takes is told by the model of the rig file, so that any cylinder stays within its ends.

use anyhow::{Result, bail};
use pneudrive_controller::{Command, drive};
use pneudrive_sim::component::encoder::{self, mm_per_count};
use pneudrive_sim::component::operator;
use pneudrive_sim::follow::Timing;
use pneudrive_sim::keys;
use pneudrive_sim::{Accuracy, Rig, follow, run};

use super::recording::{FEWEST_AT_REST, FEWEST_OF_A_RECORD};

/// Command, counts of a converter, and how far the drive goes on it, of what it may; 0 is where it starts.
pub type Strokes = &'static [(i32, f64)];

/// Name, rest before, s, strokes.
pub type Test = (&'static str, f64, Strokes);

/// The test that shows whether the drive moves in the direction of the valve.
pub(crate) const MOVEMENT: Test = ("movement", 0.04, &[(960, 0.15)]);

/// The test that shows the top speed and the acceleration.
pub(crate) const DYNAMIC: Test = ("dynamic", 0.04, &[(drive::MAX_COUNTS as i32, 0.9)]);

/// The tests for the fit.
pub const FITTED: [Test; 6] = [
    ("extension, half open", 0.04, &[(560, 1.0)]),
    ("retraction, half open", 0.04, &[(-560, 1.0)]),
    ("extension and back", 0.04, &[(960, 0.7), (-700, 0.0)]),
    ("retraction and back", 0.04, &[(-960, 0.7), (700, 0.0)]),
    ("extension after a rest", 0.10, &[(620, 0.8)]),
    ("retraction after a rest", 0.10, &[(-620, 0.8)]),
];

/// Largest travel of a stroke of the valve, and smallest distance from an end, as parts of the cylinder's stroke.
const MAX_STROKE: f64 = 0.3;
const FROM_END: f64 = 0.15;

/// Shortest travel that shows anything, as a part of the cylinder's stroke.
const SHORTEST: f64 = 0.1;

/// Longest time of a stroke, s.
const LONGEST_S: f64 = 0.6;

/// Fewest samples of a rest before a stroke and of a test: a few more than a fit asks for.
const RESTING: usize = FEWEST_AT_REST + 4;
const FEWEST: usize = FEWEST_OF_A_RECORD + 4;

/// Stairs of the ramp that shows stiction and hysteresis: how many, and how high (counts) and how long (s) each, the
/// best first; the first ones with which the model stays within its range are taken.
const STAIRS: i32 = 14;
const STAIR: [(i32, f64); 6] =
    [(60, 0.026), (60, 0.013), (60, 0.0078), (60, 0.0052), (45, 0.0052), (45, 0.0026)];

/// The valve opened slowly to both sides, up and down: breakaways at forces that rise slowly, and the loop of the
/// spool. None where the model goes too far on any.
///
/// # Errors
/// When the piston is too near to an end.
pub fn ramp(rig: &Rig, position: f64) -> Result<Option<Rig>> {
    let room = room(rig, position, 1.0)?.min(room(rig, position, -1.0)?.abs());
    for (height, seconds) in STAIR {
        let test = staircase(rig, position, height, seconds)?;
        let rows = run(&test, Accuracy::default())?.rows;
        if rows.iter().all(|row| (row.plant.position - position).abs() < room) {
            return Ok(Some(test));
        }
    }
    Ok(None)
}

fn staircase(rig: &Rig, position: f64, height: i32, seconds: f64) -> Result<Rig> {
    let hill = (0..=STAIRS).chain((0..STAIRS).rev());
    let stairs: Vec<i32> = hill.clone().chain(hill.skip(1).map(|stair| -stair)).collect();
    let time = |stair: usize| 0.04 + stair as f64 * seconds;
    let moves: Vec<(f64, i32)> =
        stairs.iter().enumerate().map(|(i, stair)| (time(i), scaled(rig, stair * height))).collect();
    with_moves(rig, position, &moves, time(stairs.len()))
}

/// A test on the drive of `rig` with its piston at `position`, m: the rig with this test.
///
/// # Errors
/// When the piston is too near to an end, or the model does not move.
pub fn test(rig: &Rig, position: f64, (_, rest, strokes): Test) -> Result<Rig> {
    let start = middle_of_count(rig, position);
    let rig = &rig.with_numbers(&[(keys::test::POSITION_M.path, start)])?;
    let period = 1e-6 * f64::from(rig.period_us().get());
    let mut moves = vec![(0.0, 0)];
    let mut time = rest.max(period * RESTING as f64);
    for (command, part) in strokes {
        let room = room(rig, start, f64::from(strokes[0].0).signum())?;
        moves.push((time, scaled(rig, *command)));
        time += stroke_time(rig, &moves, start + part * room)?;
    }
    // A short cylinder rests longer before.
    let later = (period * FEWEST as f64 - time).max(0.0);
    moves[1..].iter_mut().for_each(|(at, _)| *at += later);
    with_moves(rig, position, &moves, time + later)
}

/// A start on the edge of a count is ill-defined.
fn middle_of_count(rig: &Rig, position: f64) -> f64 {
    let pulse = 1e-3 * mm_per_count(rig);
    encoder::middle(rig, encoder::count_at(rig, position / pulse)) * pulse
}

/// Counts of a converter as those of the rig's drive stage.
fn scaled(rig: &Rig, counts: i32) -> i32 {
    if rig.get(&keys::operator::MODEL) != operator::OperatorKind::Stepper {
        return counts;
    }
    let full = operator::largest_command(rig) as f64;
    (f64::from(counts) / f64::from(drive::MAX_COUNTS) * full).round() as i32
}

fn with_moves(rig: &Rig, position: f64, moves: &[(f64, i32)], duration: f64) -> Result<Rig> {
    let position = middle_of_count(rig, position);
    let moves: Vec<String> = moves.iter().map(|(time, counts)| format!("[{time:.4}, {counts}]")).collect();
    let settings = [
        keys::test::MOVES.setting(format_args!("[{}]", moves.join(", "))),
        keys::test::DURATION_S.setting(format_args!("{duration:.4}")),
        keys::test::POSITION_M.setting(position),
    ];
    Ok(rig.with_test(&settings)?)
}

/// How far the drive may go in a direction, m, signed.
fn room(rig: &Rig, start: f64, direction: f64) -> Result<f64> {
    let stroke = rig.get(&keys::actuator::STROKE_M);
    let end = if direction > 0.0 { stroke - start } else { start };
    let room = (end - FROM_END * stroke).min(MAX_STROKE * stroke);
    if room < SHORTEST * stroke {
        let (end, middle) = (1e3 * end, 500.0 * stroke);
        bail!(
            "the piston is {end:.0} mm from an end; bring it to rest near {middle:.0} mm, the middle of its stroke \
             (pneudrive device go {middle:.0}mm --rig FILE)"
        );
    }
    Ok(direction * room)
}

/// How long the last of these moves takes to `goal`, m, on the model, s.
fn stroke_time(rig: &Rig, moves: &[(f64, i32)], goal: f64) -> Result<f64> {
    let period_us = u64::from(rig.period_us().get());
    let timing = Timing { period_us, delay_us: rig.microseconds(&keys::controller::DELAY_S) };
    let time = |k: usize| 1e-6 * period_us as f64 * k as f64;
    let (begun, counts) = moves[moves.len() - 1];
    let samples = ((begun + LONGEST_S) / time(1)) as usize;
    let mut spool = 0;
    let commands: Vec<Command> = (0..samples)
        .map(|k| {
            let counts = moves.iter().rev().find(|(at, _)| time(k) >= *at).map_or(0, |(_, counts)| *counts);
            let step = (counts - spool).signum();
            spool += step;
            Command { counts: counts as i16, step: step as i8, drive_enable: true }
        })
        .collect();
    let readings = follow(rig, Accuracy::default(), timing, &commands)?;
    let first = (begun / time(1)).ceil() as usize;
    let beyond = |position: f64| (position - goal) * f64::from(counts.signum()) >= 0.0;
    let arrived = readings.iter().skip(first).position(|reading| beyond(reading.position));
    let moved = (readings[readings.len() - 1].position - readings[first].position).abs();
    if arrived.is_none() && moved < 0.1 * SHORTEST * rig.get(&keys::actuator::STROKE_M) {
        bail!("the model of {} does not move under a command of {counts}", rig.name());
    }
    Ok(time(arrived.unwrap_or(samples - first)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_servo_drive_stays_far_from_its_ends_on_every_test() {
        for name in ["servo-a-tuned", "servo-b-tuned", "servo-c-tuned"] {
            let text = pneudrive_sim::rigfile::builtin(name).expect("built in");
            let rig = Rig::read_with(name, text, &["controller.loop=open".to_owned()]).expect("valid");
            let stroke = rig.get(&keys::actuator::STROKE_M);
            let timed = [MOVEMENT, DYNAMIC].into_iter().chain(FITTED);
            let mut tests: Vec<Rig> =
                timed.map(|each| test(&rig, 0.5 * stroke, each).expect("a test")).collect();
            tests.extend(ramp(&rig, 0.5 * stroke).expect("a ramp"));
            for test in tests {
                let rows = run(&test, Accuracy::default()).expect("a run").rows;
                let moved = rows.iter().map(|row| row.plant.position);
                assert!(moved.clone().all(|y| y > 0.05 * stroke && y < 0.95 * stroke), "{name}");
                assert!(
                    moved.clone().any(|y| (y - 0.5 * stroke).abs() > 0.03 * stroke),
                    "{name} does not move"
                );
            }
        }
    }

    #[test]
    fn a_drive_near_an_end_is_refused_with_where_it_should_stand() {
        let rig = Rig::read("test", "[controller]\nloop = \"open\"\n").expect("valid");
        let refused = test(&rig, 0.02, MOVEMENT).map(|_| ()).and(test(&rig, 0.02, FITTED[1]).map(|_| ()));
        let message = refused.expect_err("refused").to_string();
        assert!(message.contains("20 mm from an end") && message.contains("near 150 mm"), "{message}");
    }
}
