//! Repeated runs on a drive that is never switched off.

use std::fmt::Write;
use std::time::{Duration, Instant};

use pneudrive_controller::Observation;
use pneudrive_sim::{Accuracy, Rig, run};

use super::run::{assert_is_the_simulation, rig, run_and_record};
use crate::Target;

/// Length of a run, s: as much as the recorder holds at decimation 1.
const RUN_S: f64 = 5.6;

/// Moves of a run.
const MOVES: u32 = 8;

/// Where moves go to, counts: within the stroke of servo-drive B.
const TARGETS: std::ops::Range<u32> = 2500..22_000;

/// What a soak came to.
#[derive(Clone, Copy, Debug)]
pub struct Soaked {
    /// Runs.
    pub runs: u32,
    /// Samples, each equal to that of the simulation.
    pub samples: usize,
    /// Time of the computer on the execution level.
    pub on_level: Duration,
    /// Time of the computer in the simulations that it is compared with.
    pub in_simulation: Duration,
}

/// The drive that is soaked, without moves.
///
/// # Panics
/// Never: it is built in.
#[must_use]
pub fn drive() -> Rig {
    rig("servo-b-tuned", &[])
}

/// Numbers that look random and are the same each time (Park and Miller's generator).
struct Numbers(u64);

impl Numbers {
    fn next_in(&mut self, range: std::ops::Range<u32>) -> u32 {
        self.0 = self.0 * 48_271 % 0x7fff_ffff;
        range.start + self.0 as u32 % (range.end - range.start)
    }
}

fn moves_of(numbers: &mut Numbers) -> Rig {
    let mut moves = String::from("test.moves=[[0.0, 8192]");
    for nth in 0..MOVES {
        let time = f64::from(numbers.next_in(100..700) + 680 * nth) / 1000.0;
        let _ = write!(moves, ", [{time}, {}]", numbers.next_in(TARGETS));
    }
    rig("servo-b-tuned", &[&format!("{moves}]"), &format!("test.duration_s={RUN_S}")])
}

/// The drive with the moves of a run; the first run is number 0.
///
/// # Panics
/// Never: it is built in.
#[must_use]
pub fn run_of(number: u32) -> Rig {
    let mut numbers = Numbers(1);
    for _ in 0..number {
        let _ = moves_of(&mut numbers);
    }
    moves_of(&mut numbers)
}

fn simulated(rig: &Rig) -> Vec<Observation> {
    let run = run(rig, Accuracy::of(rig)).expect("a transient");
    assert_eq!(run.fault, None, "{}", rig.name());
    run.observations
}

/// Runs with other moves each, for this time of the drive: every record is the simulation, and nothing has gone wrong
/// on the way.
///
/// # Panics
/// At the first difference, or when a counter tells of a loss.
#[must_use]
pub fn soak(target: &dyn Target, seconds: f64) -> Soaked {
    let mut soaked = Soaked { runs: 0, samples: 0, on_level: Duration::ZERO, in_simulation: Duration::ZERO };
    let mut numbers = Numbers(1);
    while f64::from(soaked.runs) * RUN_S < seconds {
        let rig = moves_of(&mut numbers);
        let begun = Instant::now();
        let simulated = simulated(&rig);
        soaked.in_simulation += begun.elapsed();
        let begun = Instant::now();
        let record = run_and_record(target, &rig);
        soaked.on_level += begun.elapsed();
        assert_is_the_simulation(&format!("{}, run {}", target.name(), soaked.runs), &record, &simulated);
        soaked.runs += 1;
        soaked.samples += record.samples.len();
    }
    assert_nothing_was_lost(target);
    soaked
}

fn assert_nothing_was_lost(target: &dyn Target) {
    let mut client = target.connect().expect("a rig that answers");
    assert_eq!(client.status().expect("an answer").damaged_frames, 0, "frames");
    assert_eq!(client.events().expect("a log"), [], "faults");
    let [interval, latency] = client.timing().expect("an answer");
    assert!(interval.count > 0 && latency.count > 0);
    let drive = drive();
    let period_us = drive.period_us().get();
    assert_eq!((interval.least_us, interval.most_us), (period_us, period_us), "intervals of the last run");
}
