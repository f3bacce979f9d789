//! A spool that a stepper moves, a step a sample: where its pulses have taken it, and the step towards a place.
//!
//! ```text
//! place       s = n S,   S = 2048/N                     n: steps from the null, by the pulses that were given;  N: the farthest
//! mean        o s- + (1 - o) s                          of the last sample: s- before its pulse, s after it;  o: part of it before that
//! owed        q += (z- - mean)/2,   within S            what the spool was short of its last place z-
//! step        towards z + q, if that is more than 0.6 S away: the nearest step, with 0.1 S to stay where it is
//! ```
//!
//! Steps are coarse, and z is mostly between two of them: what is owed makes the flow right in the mean. A spool that is on its way
//! owes a step at most, so that it passes its place by no more.
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | s, z, q, S | Q16 counts, 2048 of which are the farthest step | 2^12 | 2^-16 N |
//! | n | steps | -N to N | |

use super::number::{product, within};
use super::transition::MOST;
use crate::parameters::{Parameters, id};

/// 0.6 in Q16.
const WORTH: i32 = 39_322;

/// What it knows of the stepper.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Constants {
    /// N.
    farthest: i32,
    /// S.
    step: i32,
    /// What a step has to be worth.
    worth: i32,
    /// o, Q16.
    share: i32,
}

/// Where the spool is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Stepped {
    /// Whether it has been seen.
    begun: bool,
    /// n.
    steps: i32,
    /// z- and q.
    wanted: i32,
    owed: i32,
    /// Since the sample before, on average.
    pub mean: i32,
}

impl Constants {
    /// Those of a drive with a stepper.
    pub(super) fn of(parameters: &Parameters) -> Option<Constants> {
        let get = |id| parameters.scalar(id);
        let farthest = get(id::MAX_STEPS);
        let step = MOST.checked_div(farthest).filter(|_| get(id::STEPPER) != 0)?;
        let share = get(id::CASCADE_OUTPUT_SHARE);
        Some(Constants { farthest, step, worth: product(step, WORTH, 16), share })
    }
}

impl Stepped {
    /// Takes the steps that were made; `null`: those at which the valve is at its null.
    pub(super) fn sense(&mut self, constants: &Constants, steps: i16, null: i32) {
        let steps = within(i32::from(steps).saturating_sub(null), 2 * constants.farthest);
        let before = if self.begun { self.steps } else { steps };
        (self.begun, self.steps) = (true, steps);
        let gone = (steps - before).saturating_mul(constants.step);
        self.mean = steps.saturating_mul(constants.step) - product(gone, constants.share, 16);
    }

    /// The step that brings it nearer to a place: where it is after that, steps.
    pub(super) fn drive(&mut self, constants: &Constants, wanted: i32) -> i32 {
        let short = self.wanted.saturating_sub(self.mean) / 2;
        self.owed = within(self.owed.saturating_add(short), constants.step);
        self.wanted = wanted;
        let way = wanted.saturating_add(self.owed) - self.steps.saturating_mul(constants.step);
        let step = if way.saturating_abs() > constants.worth { way.signum() } else { 0 };
        within(self.steps.saturating_add(step), constants.farthest)
    }
}
