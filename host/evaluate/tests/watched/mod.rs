//! Drives that are watched for long after a step, and what a short record of the step says of them.

use pneudrive_evaluate::evaluation::{LimitCycle, Motion, moves};
use pneudrive_evaluate::transient::{POSITION, Transient};
use pneudrive_sim::{Accuracy, Rig, run};

pub use crate::own_drives::Kind;
use crate::own_drives::{Steps, own_drive};

/// When the step comes, and how long it is watched, s.
pub const STEP_S: f64 = 0.3;
pub const WATCHED_S: f64 = 12.0;

/// mm: a drive that moves by more did not rest.
pub const MOVES_MM: f64 = 0.05;

/// An own drive of a seed with one step.
pub fn stepping(seed: u64, kind: Kind) -> Rig {
    own_drive(seed, kind, Steps { at_s: &[STEP_S], duration_s: STEP_S + WATCHED_S })
}

/// All of it; None if its run ends before its time.
pub fn watched(rig: &Rig) -> Option<Transient> {
    let run = run(rig, Accuracy::of_motion(rig)).ok().filter(|run| run.fault.is_none())?;
    Some(Transient::of_simulation(rig.name(), rig, &run))
}

/// What its first seconds after the step say.
pub fn verdict(drive: &Transient, seconds: f64) -> LimitCycle {
    let record = drive.between(0.0, STEP_S + seconds);
    moves(&record, &Motion::of(&record), None, MOVES_MM).last().expect("a step").limit_cycle
}

/// How far it goes after these seconds from where it is then, mm.
pub fn moves_later_mm(drive: &Transient, seconds: f64) -> f64 {
    let after = drive.time.partition_point(|time| *time <= STEP_S + seconds);
    let later = &drive.channels[POSITION][after - 1..];
    later.iter().map(|position| (position - later[0]).abs()).fold(0.0, f64::max)
}
