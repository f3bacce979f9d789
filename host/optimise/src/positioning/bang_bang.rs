//! The bang-bang bound on the time of a step: the valve fully open one way, then fully open the other way, until the piston
//! stands.
//!
//! ```text
//! u(t) = U until t_s, -U from then on;   v(t_e) = 0, the first time after the piston moves;   t_s so that x(t_e) = target
//! ```
//!
//! with U the largest command in the direction of the step. The command switches at a sample. So the twin is run in open loop
//! with the switch at whole samples k T, found by doubling and bisection, until two neighbours end short of the target and
//! beyond it:
//!
//! ```text
//! x_k <= target < x_(k+1),   t_e = t_k + (t_(k+1) - t_k) (target - x_k)/(x_(k+1) - x_k)
//! ```
//!
//! The interpolation leaves an error of order T^2. For a constant force F on a mass M, where t_e = 2 sqrt(M D/F) over a distance D,
//! it is T^2/(2 t_e) at most.
//!
//! The bound is that of the nominal rig from rest at its initial pressures, with the lag and delay of its valve, without dither.
//! Commands with more switches are not tried. At the end the piston stands for an instant between unlike pressures, which a law
//! has to balance as well.

use anyhow::{Result, bail};
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::component::operator;
use pneudrive_sim::trace::MotionRow;
use pneudrive_sim::{Accuracy, IntegrationError, Rig, Runner, keys};

use super::course::{Steps, with_test};
use super::draw::Place;

/// Time between the positions in which the standstill is looked for, s.
const ROWS_S: f64 = 1e-4;

/// A run is this many times as long as the valve is open one way, and this longer, s.
const BRAKING: f64 = 4.0;
const AFTERWARDS_S: f64 = 0.3;

/// A step that is not over with the switch at this sample is none that a valve makes.
const LATEST: u32 = 1 << 14;

/// The bound on a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// From the sample at which the step is asked for until the piston stands at its target, s.
    pub time_s: f64,
    /// When the command switches, s.
    pub switch_s: f64,
}

/// The end of a motion: when the piston stands for the first time, and how far it has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Time, s.
    pub at_s: f64,
    /// Travel in the direction of the step, m.
    pub travel_m: f64,
}

/// The bound on a step of `step_mm` about the middle of the stroke; None for a step that a valve which is open for a single
/// sample exceeds.
///
/// # Errors
/// When the step does not fit into the stroke, cannot be simulated, or is too much for the drive.
pub fn bound(rig: &Rig, step_mm: f64, extends: bool) -> Result<Option<Bound>> {
    bound_of(rig, Steps::of(rig, step_mm, Place { along: 0.5, extends })?)
}

/// The same for a step from one count to another.
///
/// # Errors
/// When it cannot be simulated, or is too much for the drive.
pub(crate) fn bound_of(rig: &Rig, steps: Steps) -> Result<Option<Bound>> {
    if steps.from == steps.to {
        return Ok(None);
    }
    let nominal = open_loop(rig)?;
    let travel_m = 1e-3 * mm_per_count(rig) * (steps.to - steps.from).unsigned_abs() as f64;
    let period_s = rig.get(&keys::controller::PERIOD_S);
    let found = switched(travel_m, |samples| stop(&nominal, steps, samples, period_s))?;
    Ok(found.map(|(samples, at_s)| Bound { time_s: at_s, switch_s: samples * period_s }))
}

/// The switch, in samples, and the time at which a motion ends after `travel_m`; `stop` tells how it ends for a switch at a sample.
///
/// # Errors
/// The first of `stop`, and where no switch leads as far.
fn switched(travel_m: f64, mut stop: impl FnMut(u32) -> Result<Stop>) -> Result<Option<(f64, f64)>> {
    let (mut short, mut far) = (0, 1);
    let mut ends = [Stop { at_s: 0.0, travel_m: 0.0 }, stop(1)?];
    while ends[1].travel_m <= travel_m {
        if far >= LATEST {
            bail!(
                "the drive does not make {:.1} mm in {far} samples with its valve fully open",
                1e3 * travel_m
            );
        }
        (short, far) = (far, 2 * far);
        ends = [ends[1], stop(far)?];
    }
    while far - short > 1 {
        let middle = u32::midpoint(short, far);
        let end = stop(middle)?;
        if end.travel_m <= travel_m {
            (short, ends[0]) = (middle, end);
        } else {
            (far, ends[1]) = (middle, end);
        }
    }
    let part = (travel_m - ends[0].travel_m) / (ends[1].travel_m - ends[0].travel_m);
    let between = |from: f64, to: f64| from + part * (to - from);
    let moves = ends[0].travel_m > 0.0;
    Ok(moves.then(|| (between(f64::from(short), f64::from(far)), between(ends[0].at_s, ends[1].at_s))))
}

/// The rig without its law and its dither.
fn open_loop(rig: &Rig) -> Result<Rig> {
    let mut settings = vec![format!("{}={}", keys::controller::LOOP.path, Loop::Open.word())];
    if rig.get(&keys::operator::MODEL).is_solenoid() {
        settings.push(format!("{}=0.0", keys::dither::DITHER_MM.path));
    }
    // The moves of a closed loop mean nothing in an open one.
    settings.push("test.moves=[[0.0, 0]]".to_owned());
    Ok(rig.without_events().with_settings(&settings)?)
}

/// How the nominal drive ends with the switch at this sample.
fn stop(nominal: &Rig, steps: Steps, samples: u32, period_s: f64) -> Result<Stop> {
    let direction = (steps.to - steps.from).signum();
    let full = direction * operator::largest_command(nominal);
    let switch_s = (1e6 * f64::from(samples) * period_s).round() / 1e6;
    let duration_s = (1e6 * (BRAKING * switch_s + AFTERWARDS_S)).round() / 1e6;
    let moves = format!("test.moves=[[0.0, {full}], [{switch_s:?}, {}]]", -full);
    let rig = with_test(nominal, moves, duration_s, steps.from)?;
    let rig = rig.with_numbers(&[("test.trace_period_s", ROWS_S)])?;
    standstill(&rig, direction as f64)?.map_or_else(
        || bail!("{} still moves {duration_s} s after its valve was fully open for {switch_s} s", rig.name()),
        Ok,
    )
}

/// The first standstill of a drive after it has begun to move in a direction; at its start if it does not.
fn standstill(rig: &Rig, direction: f64) -> Result<Option<Stop>, IntegrationError> {
    let mut runner = Runner::<MotionRow>::new(rig, Accuracy::of_motion(rig));
    let rows = &runner.run()?.rows;
    let speed = |row: &MotionRow| direction * row.velocity;
    let Some(begin) = rows.iter().position(|row| speed(row) > 0.0) else {
        return Ok(Some(Stop { at_s: 0.0, travel_m: 0.0 }));
    };
    let ends = (begin + 1..rows.len()).find(|&k| speed(&rows[k]) <= 0.0);
    Ok(ends.map(|k| {
        let last = &rows[k - 1];
        // Its deceleration there goes on until it stands, at most to the next row.
        let slows = speed(&rows[k.max(2) - 2]) - speed(last);
        let rest_s = if slows > 0.0 { (ROWS_S * speed(last) / slows).min(ROWS_S) } else { ROWS_S };
        let travel_m = direction * (last.position - rows[0].position) + speed(last) * rest_s / 2.0;
        Stop { at_s: last.time + rest_s, travel_m }
    }))
}

#[cfg(test)]
mod tests;
