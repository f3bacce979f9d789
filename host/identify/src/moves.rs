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
//! How long a stroke takes is told by the model of the rig file, so that any cylinder stays within its ends. Behind what is fitted the
//! valve opens to the other side until the model has lost most of its speed: a fast load would run into the end of its stroke.

use anyhow::{Result, bail};
use pneudrive_controller::{Command, drive};
use pneudrive_records::target::TargetFile;
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

/// The same toward the retracted end.
pub(crate) const MOVEMENT_BACK: Test = ("movement", 0.04, &[(-960, 0.15)]);

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

/// Part of its speed that the model has left when it is no longer braked. A lighter load than the model's is thrown back a little, and
/// a heavier one goes farther.
const LEFT_OF_SPEED: f64 = 0.1;

/// How far from the ends of the stroke the model stays until it has stopped, as a part of the stroke.
pub const STOPS_FROM_END: f64 = 0.1;

/// How far a load that starts nearer to an end may yield toward it, as a part of the stroke.
const YIELDS: f64 = 1e-3;

/// Parts of a stroke of the valve that are tried for that, the best first.
const PARTS: [f64; 5] = [1.0, 0.8, 0.6, 0.45, 0.3];

/// Fewest samples of a rest before a stroke and of a test: a few more than a fit asks for.
const RESTING: usize = FEWEST_AT_REST + 4;
const FEWEST: usize = FEWEST_OF_A_RECORD + 4;

/// How long a drive stands enabled before a test, s: its spool comes to rest first. The samples are recorded as those from before the
/// start, as many as a recorder keeps.
const SETTLES_S: f64 = 0.1;
const MAX_PRE_TRIGGER: f64 = 2000.0;

/// Stairs of the ramp that shows stiction and hysteresis: how many, and how high (counts) and how long (s) each, the
/// best first; the first ones with which the model stays within its range are taken.
const STAIRS: i32 = 14;
const STAIR: [(i32, f64); 6] =
    [(60, 0.026), (60, 0.013), (60, 0.0078), (60, 0.0052), (45, 0.0052), (45, 0.0026)];

/// How long the model goes on behind the stairs with its valve at null, s: by then a host has said what comes next.
const COASTS_S: f64 = 0.3;

/// The valve opened slowly to both sides, up and down: breakaways at forces that rise slowly, and the loop of the
/// spool. None where the model goes too far on any, or behind it.
///
/// # Errors
/// When the piston is too near to an end.
pub fn ramp(rig: &Rig, position: f64) -> Result<Option<Planned>> {
    let room = room(rig, position, 1.0)?.min(room(rig, position, -1.0)?.abs());
    for (height, seconds) in STAIR {
        let test = staircase(rig, position, (height, seconds), 0.0)?;
        let rows = run(&staircase(rig, position, (height, seconds), COASTS_S)?, Accuracy::default())?.rows;
        if rows.iter().all(|row| (row.plant.position - position).abs() < room) {
            let samples = test.last_sample() as usize + 1;
            return Ok(Some(Planned { name: "static", rig: test, samples }));
        }
    }
    Ok(None)
}

/// Stairs of a height and a length, and a time behind them, s.
fn staircase(rig: &Rig, position: f64, (height, seconds): (i32, f64), behind: f64) -> Result<Rig> {
    let hill = (0..=STAIRS).chain((0..STAIRS).rev());
    let stairs: Vec<i32> = hill.clone().chain(hill.skip(1).map(|stair| -stair)).collect();
    let time = |stair: usize| 0.04 + stair as f64 * seconds;
    let moves: Vec<(f64, i32)> =
        stairs.iter().enumerate().map(|(i, stair)| (time(i), scaled(rig, stair * height))).collect();
    with_moves(rig, position, &moves, time(stairs.len()) + behind)
}

/// A test on a drive, and how many of its samples come before it brakes.
#[derive(Clone, Debug)]
pub struct Planned {
    /// What it is.
    pub name: &'static str,
    /// The rig with the test.
    pub rig: Rig,
    /// The samples that are read off and fitted.
    pub samples: usize,
}

impl Planned {
    /// The part of a record of it that is read off and fitted.
    #[must_use]
    pub fn before_it_brakes(&self, mut record: TargetFile) -> TargetFile {
        record.samples.retain(|(index, _)| usize::try_from(*index).is_ok_and(|index| index < self.samples));
        record.seal();
        record
    }
}

/// A test on the drive of `rig` with its piston at `position`, m, shortened until the model stays inside of the stroke.
///
/// # Errors
/// When the piston is too near to an end, or the model does not move or does not stay inside.
pub fn test(rig: &Rig, position: f64, test: Test) -> Result<Planned> {
    let start = middle_of_count(rig, position);
    let rig = &rig.with_numbers(&[(keys::test::POSITION_M.path, start)])?;
    let stroke = rig.get(&keys::actuator::STROKE_M);
    let inside = (STOPS_FROM_END * stroke).min(start - YIELDS * stroke)
        ..=((1.0 - STOPS_FROM_END) * stroke).max(start + YIELDS * stroke);
    for part in PARTS {
        let (planned, [low, high]) = part_of_test(rig, start, test, part)?;
        if inside.contains(&low) && inside.contains(&high) {
            return Ok(planned);
        }
    }
    bail!(
        "the model of {} cannot be kept within its stroke of {:.0} mm once the valve is open: it is too fast for the tests",
        rig.name(),
        1e3 * stroke
    )
}

/// A part of a test, and the lowest and the highest position of the model until it has stopped, m.
fn part_of_test(
    rig: &Rig,
    start: f64,
    (name, rest, strokes): Test,
    part: f64,
) -> Result<(Planned, [f64; 2])> {
    let period = period_s(rig);
    let mut moves = vec![(0.0, 0)];
    let mut time = rest.max(period * RESTING as f64);
    for (command, share) in strokes {
        let room = room(rig, start, f64::from(strokes[0].0).signum())?;
        moves.push((time, scaled(rig, *command)));
        time += stroke_time(rig, &moves, start + part * share * room)?;
    }
    // A short cylinder rests longer before.
    let later = (period * FEWEST as f64 - time).max(0.0);
    moves[1..].iter_mut().for_each(|(at, _)| *at += later);
    let last = with_moves(rig, start, &moves, time + later)?.last_sample();
    let end = period * f64::from(last + 1);
    moves.push((end, -moves[moves.len() - 1].1));
    let (braking, range) = braking(rig, &moves)?;
    let rig = with_moves(rig, start, &moves, end + braking)?;
    Ok((Planned { name, rig, samples: last as usize + 1 }, range))
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
        keys::test::PRE_TRIGGER.setting((SETTLES_S / period_s(rig)).ceil().min(MAX_PRE_TRIGGER)),
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
    let (first, positions) = positions_on_model(rig, moves)?;
    let counts = moves[moves.len() - 1].1;
    let beyond = |position: &f64| (position - goal) * f64::from(counts.signum()) >= 0.0;
    let arrived = positions.iter().skip(first).position(beyond);
    let moved = (positions[positions.len() - 1] - positions[first]).abs();
    if arrived.is_none() && moved < 0.1 * SHORTEST * rig.get(&keys::actuator::STROKE_M) {
        bail!("the model of {} does not move under a command of {counts}", rig.name());
    }
    Ok(period_s(rig) * arrived.unwrap_or(positions.len() - first) as f64)
}

/// How long the last of these moves takes to stop the model but for a part of its speed, s, and the lowest and the highest position
/// until then, m.
fn braking(rig: &Rig, moves: &[(f64, i32)]) -> Result<(f64, [f64; 2])> {
    let (first, positions) = positions_on_model(rig, moves)?;
    let travel = |k: usize| positions[k] - positions[k - 1];
    let direction = travel(first).signum();
    let slow = LEFT_OF_SPEED * travel(first).abs();
    let braked = (first..positions.len()).find(|k| direction * travel(*k) <= slow);
    let braked = braked.unwrap_or(positions.len() - 1);
    let [low, high] = [f64::min, f64::max].map(|of| positions[..=braked].iter().copied().reduce(of));
    Ok((period_s(rig) * (braked - first) as f64, [low.unwrap_or(0.0), high.unwrap_or(0.0)]))
}

/// Where the model is, m, at each sample until [`LONGEST_S`] after the last of these moves, and the sample at which that begins.
fn positions_on_model(rig: &Rig, moves: &[(f64, i32)]) -> Result<(usize, Vec<f64>)> {
    let period_us = u64::from(rig.period_us().get());
    let timing = Timing { period_us, delay_us: rig.microseconds(&keys::controller::DELAY_S) };
    let time = |k: usize| 1e-6 * period_us as f64 * k as f64;
    let begun = moves[moves.len() - 1].0;
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
    Ok(((begun / time(1)).ceil() as usize, readings.iter().map(|reading| reading.position).collect()))
}

/// The period of the controller, s.
fn period_s(rig: &Rig) -> f64 {
    1e-6 * f64::from(rig.period_us().get())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rig in open loop in the middle of its stroke, and its stroke, m.
    fn in_the_middle(name: &str) -> (Rig, f64) {
        let text = pneudrive_sim::rigfile::builtin(name).expect("built in");
        let rig = Rig::read_with(name, text, &["controller.loop=open".to_owned()]).expect("valid");
        let stroke = rig.get(&keys::actuator::STROKE_M);
        (rig, stroke)
    }

    /// A test with the valve at its null behind it, for as long as a host takes to say what comes next.
    fn left_alone(test: &Rig) -> Rig {
        let end = test.get(&keys::test::DURATION_S);
        let moves = test.moves().into_iter().chain([(end, 0)]);
        let moves: Vec<String> = moves.map(|(time, counts)| format!("[{time:.4}, {counts}]")).collect();
        let settings = [
            keys::test::MOVES.setting(format_args!("[{}]", moves.join(", "))),
            keys::test::DURATION_S.setting(end + 0.3),
            keys::test::POSITION_M.setting(test.get(&keys::test::POSITION_M)),
        ];
        test.with_test(&settings).expect("a test")
    }

    #[test]
    fn every_drive_stays_far_from_its_ends_on_every_test_and_behind_it() {
        for name in ["servo-a-tuned", "servo-b-tuned", "servo-c-tuned", "press"] {
            let (rig, stroke) = in_the_middle(name);
            let timed = [MOVEMENT, DYNAMIC].into_iter().chain(FITTED);
            let mut tests: Vec<Rig> =
                timed.map(|each| test(&rig, 0.5 * stroke, each).expect("a test").rig).collect();
            tests.extend(ramp(&rig, 0.5 * stroke).expect("a ramp").map(|ramp| ramp.rig));
            for (i, test) in tests.iter().map(left_alone).enumerate() {
                let rows = run(&test, Accuracy::default()).expect("a run").rows;
                let moved: Vec<f64> = rows.iter().map(|row| row.plant.position / stroke).collect();
                assert!(moved.iter().all(|y| (0.09..0.91).contains(y)), "{name}, test {i}");
                assert!(moved.iter().any(|y| (y - 0.5).abs() > 0.03), "{name} does not move");
            }
        }
    }

    /// Its load is light, its valve wide.
    #[test]
    fn a_fast_drive_has_shorter_strokes() {
        let (rig, stroke) = in_the_middle("press");
        let end = |settings: &[String]| {
            let rig = rig.with_settings(settings).expect("valid");
            let planned = test(&rig, 0.5 * stroke, DYNAMIC)?;
            let rows = run(&left_alone(&planned.rig), Accuracy::default())?.rows;
            Ok::<f64, anyhow::Error>(rows.iter().map(|row| row.plant.position / stroke).fold(0.0, f64::max))
        };
        let wide = |times: f64| {
            let conductance = keys::iso6358::SONIC_CONDUCTANCE_M3_PER_S_PA;
            let of_file = rig.get(&conductance).expect("by its conductance");
            vec![conductance.setting(times * of_file), "load.mass_kg=2.0".to_owned()]
        };
        for times in [1.0, 2.0, 4.0] {
            let end = end(&wide(times));
            assert!(end.as_ref().is_ok_and(|end| *end < 0.93), "{times}: {end:?}");
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
