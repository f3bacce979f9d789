//! Doubt: when what was learned, or what the pressures say, is not of this drive.
//!
//! ```text
//! bound      M, d of the load, d of the motion or the pace is at a bound                longer by a time than not, in motion
//! flow       |g| > max(E, R) + half a count of a pressure                               longer than a time
//! jump       |F - F_1| > 1.25 (max(E, R) + K (|step| + 1)) + 1/32, and the next sample is not back at F_1
//! frozen     a raw pressure stays the same while F changes by 0.08 and the load moves by 5 mm
//! ```
//!
//! F_1 is the force of the sample before. A fully open valve and the piston change the force by E or R and K v. So a longer step of it
//! is one of a sensor, and a rate that the flow observer misses by all of that is not one of the air. Less is no evidence: a supply
//! that is a fifth below that of the rig file fills no chamber any more which the model still sees filled. What the observer misses lags, and the small chamber of a piston at its end fills within
//! samples: so the largest of E and R falls by no more than 1/16 in two samples there. A single reading that is wrong is none of them.
//! A chamber that is full, or empty, keeps its pressure while the other changes: above 0.92 and within 0.05 of the exhaust nothing
//! counts as frozen. A pressure that passes its extremum, as before a piston that ends its acceleration, may stay within a count for
//! 8 mm, so a reading that still has noise does not count as frozen. A long chamber sleeps through the first millimetres of a piston that leaves its stop.
//!
//! Friction and B are no evidence: they are guessed, and a sound drive may have less or more of them than their bounds allow.
//!
//! Forces are Q24, K is Q30, steps are counts.

use super::air::Air;
use super::number::{ONE, product, samples};
use crate::fault::Fault;
use crate::fixed::quotient;
use crate::parameters::{Parameters, id};

/// 1/32, Q24: a step of the force that needs no cause.
const STEP: i32 = ONE / 32;
/// 0.08, Q24: the change of the force that no chamber sleeps through.
const CHANGE: i32 = ONE / 25 * 2;
/// A chamber within 0.05 of the exhaust is empty, one above 0.92 is full, Q24.
const EMPTY: i32 = ONE / 20;
const FULL: i32 = ONE / 25 * 23;

/// How long each doubt may last, and how far a load moves under a frozen pressure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// Samples at a bound and beyond the flow that do not trip yet; `u32::MAX`: none do.
    bound: u32,
    flow: u32,
    /// 5 mm, counts.
    moved: u32,
    /// Half a count of a pressure, Q24: its noise in a rate.
    noise: i32,
    /// Pressure of an empty chamber, Q24.
    empty: i32,
}

/// What it sees at a sample.
pub(super) struct Seen<'a> {
    pub raw: [i16; 2],
    /// P and F, Q24.
    pub pressures: [i32; 2],
    pub force: i32,
    /// Position and its step, counts.
    pub count: i32,
    pub step: i32,
    /// The air of the sample before.
    pub air: &'a Air,
}

/// The last reading at which a pressure changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Reading {
    raw: i16,
    force: i32,
    count: i32,
}

/// What it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Doubt {
    /// F of the sample before, and that before the jump at it.
    force: i32,
    from: Option<i32>,
    last: [Reading; 2],
    /// The rate of the open valve, no less than 15/16 of what it was two samples before.
    reach: i32,
    /// Samples with something at a bound less those without, and samples on end beyond the flow.
    at_bound: u32,
    beyond: u32,
    /// The first that ended the run.
    pub(super) fault: Option<Fault>,
}

impl Reading {
    /// Whether a pressure is still that of this reading, although force and place are not. Otherwise it is the new one.
    #[inline(always)]
    fn stays(&mut self, constants: &Constants, seen: &Seen, raw: i16, pressure: i32) -> bool {
        if raw != self.raw {
            *self = Reading { raw, force: seen.force, count: seen.count };
            return false;
        }
        seen.force.abs_diff(self.force) > CHANGE as u32
            && seen.count.abs_diff(self.count) > constants.moved
            && constants.empty <= pressure
            && pressure < FULL
    }
}

/// The samples of a time in which nothing trips yet; a time below a period is one sample, and 0 is off.
fn most(ms: i32, period_us: u32) -> u32 {
    let whole = samples(ms.unsigned_abs().saturating_mul(1000), period_us).max(1);
    if ms == 0 { u32::MAX } else { whole - 1 }
}

impl Constants {
    pub(super) fn of(parameters: &Parameters, period_us: u32, count_pm: u64) -> Constants {
        let get = |id| parameters.scalar(id);
        Constants {
            bound: most(get(id::MODEL_BOUND_MS), period_us),
            flow: most(get(id::PRESSURE_DOUBT_MS), period_us),
            moved: quotient(5_000_000_000, count_pm).max(1) as u32,
            noise: get(id::CASCADE_PRESSURE_GAIN) >> 7,
            empty: get(id::CASCADE_EXHAUST_PRESSURE).saturating_add(EMPTY),
        }
    }

    fn looks_at_pressures(&self) -> bool {
        self.flow != u32::MAX
    }
}

impl Doubt {
    /// Of a run that begins with this force.
    pub(super) fn new(force: i32) -> Doubt {
        Doubt { force, ..Doubt::default() }
    }

    /// A sample, of which every second one looks at the single pressures.
    #[inline(always)]
    pub(super) fn take(&mut self, constants: &Constants, seen: &Seen, each: bool) {
        let last = core::mem::replace(&mut self.force, seen.force);
        let change = seen.force.saturating_sub(last).saturating_abs();
        let reach = seen.air.extend.max(seen.air.retract);
        let jumps = self.from.is_some() || change > reach.saturating_add(STEP);
        let doubts =
            jumps && self.jumped(seen, last, change, reach) || each && self.is_frozen(constants, seen);
        if doubts && constants.looks_at_pressures() {
            self.fault = Some(Fault::PressureDoubtful);
        }
    }

    /// Whether the force is still where it jumped to at the sample before.
    #[cold]
    #[inline(never)]
    fn jumped(&mut self, seen: &Seen, last: i32, change: i32, reach: i32) -> bool {
        if let Some(from) = self.from.take() {
            return seen.force.abs_diff(from) > change.unsigned_abs();
        }
        let moved = seen.step.saturating_abs().saturating_add(1);
        let reach = reach.saturating_add(product(seen.air.stiffness, moved, 6));
        if change.saturating_sub(STEP) > reach.saturating_add(reach >> 2) {
            self.from = Some(last);
        }
        false
    }

    #[inline(always)]
    fn is_frozen(&mut self, constants: &Constants, seen: &Seen) -> bool {
        let ([first, second], [one, two]) = (&mut self.last, seen.pressures);
        first.stays(constants, seen, seen.raw[0], one) || second.stays(constants, seen, seen.raw[1], two)
    }

    /// A sample with this rate that the flow observer misses, of every second one.
    #[inline(always)]
    pub(super) fn miss(&mut self, constants: &Constants, unknown: i32, air: &Air) {
        let missed = unknown.saturating_abs();
        let reach = air.extend.max(air.retract).saturating_add(constants.noise);
        self.reach = reach.max(self.reach - (self.reach >> 4));
        self.beyond = if missed > self.reach { self.beyond.saturating_add(2) } else { 0 };
        if self.beyond > constants.flow {
            self.fault = Some(Fault::PressureDoubtful);
        }
    }

    /// A sample in motion, of every second one: whether something that was learned is at a bound.
    #[inline(always)]
    pub(super) fn stray(&mut self, constants: &Constants, is_at_bound: bool) {
        self.at_bound =
            if is_at_bound { self.at_bound.saturating_add(2) } else { self.at_bound.saturating_sub(2) };
        if self.at_bound > constants.bound {
            self.fault = self.fault.or(Some(Fault::ModelAtBound));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piston that ends its acceleration: the force falls by 0.19 in 8.4 mm while the pressure before it passes its minimum. Counts
    /// of 10 um.
    fn turns(raw: impl Fn(i16) -> i16) -> Option<Fault> {
        let constants = Constants { bound: 500, flow: 5, moved: 500, noise: 0, empty: 2 * EMPTY };
        let air = Air { extend: ONE / 8, retract: ONE / 8, ..Air::default() };
        let mut doubt = Doubt::new(ONE / 2);
        for n in 0..15 {
            let (force, count) = (ONE / 2 - ONE / 75 * i32::from(n), 3000 + 60 * i32::from(n));
            let (raw, pressures) = ([2600 - 40 * n, raw(n)], [ONE / 25 * 22 - force / 8, ONE / 2]);
            doubt.take(&constants, &Seen { raw, pressures, force, count, step: 60, air: &air }, true);
        }
        doubt.fault
    }

    /// It stays within a count of 1900 all the while, but its noise is there.
    #[test]
    fn a_pressure_that_turns_is_not_frozen() {
        assert_eq!(turns(|n| 1900 + [0, 1, -1][n as usize % 3]), None);
        assert_eq!(turns(|n| 1900 + n / 8), None);
    }

    #[test]
    fn a_reading_that_stands_still_while_the_other_falls_is_frozen() {
        assert_eq!(turns(|_| 1900), Some(Fault::PressureDoubtful));
    }
}
