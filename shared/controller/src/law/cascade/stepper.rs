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
        let away = wanted.saturating_add(self.owed) - self.steps.saturating_mul(constants.step);
        let step = if away.saturating_abs() > constants.worth { away.signum() } else { 0 };
        within(self.steps.saturating_add(step), constants.farthest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spool that follows places drawn at random, some of them for many samples, beside the equations in real numbers, which take
    /// over what is owed at each sample: the step is the same but where 0.6 of a step falls to the other side by the rounding.
    #[test]
    fn each_step_is_that_of_the_equations() {
        let mut random = 1_u32;
        let mut draw = |below: u32| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 8) % below
        };
        for farthest in [1, 20, 40, 400] {
            let step = MOST / farthest;
            let share = 39_322;
            let constants = Constants { farthest, step, worth: product(step, WORTH, 16), share };
            let real = |value: i32| f64::from(value) / f64::from(step);
            let (mut spool, mut place, mut wanted, mut unlike) = (Stepped::default(), 0, 0, 0);
            for _ in 0..20_000 {
                if draw(8) == 0 {
                    wanted = draw(2 * MOST as u32) as i32 - MOST;
                }
                let before = if spool.begun { f64::from(spool.steps) } else { f64::from(place) };
                spool.sense(&constants, place as i16, 0);
                let mean = 0.6 * before + 0.4 * f64::from(place);
                assert!((real(spool.mean) - mean).abs() < 1e-3, "{} of {mean}", real(spool.mean));
                let owed = (real(spool.owed) + 0.5 * (real(spool.wanted) - mean)).clamp(-1.0, 1.0);
                let away = real(wanted) + owed - f64::from(place);
                let exact = if away.abs() > 0.6 { place + away.signum() as i32 } else { place };
                place = spool.drive(&constants, wanted);
                assert!((real(spool.owed) - owed).abs() < 1e-3, "{} of {owed}", real(spool.owed));
                let is_close = (away.abs() - 0.6).abs() < 2e-3;
                assert!(
                    place == exact.clamp(-farthest, farthest) || is_close,
                    "{place} of {exact}, {away} away"
                );
                unlike += u32::from(place != exact.clamp(-farthest, farthest));
                assert!(place.abs() <= farthest);
            }
            assert!(unlike < 100, "{unlike} of 20,000");
        }
    }

    #[test]
    fn a_spool_in_the_mean_of_two_steps_is_what_its_place_asks_for() {
        let farthest = 40;
        let step = MOST / farthest;
        let constants = Constants { farthest, step, worth: product(step, WORTH, 16), share: 0 };
        for wanted in [0.3, 1.5, -7.25, 20.5] {
            let (mut spool, mut place, mut sum) = (Stepped::default(), 0, 0);
            for k in 0..2040 {
                spool.sense(&constants, place as i16, 0);
                place = spool.drive(&constants, (wanted * f64::from(step)) as i32);
                sum += if k < 40 { 0 } else { place };
            }
            assert!((f64::from(sum) / 2000.0 - wanted).abs() < 0.02, "{wanted}: {sum}");
        }
    }
}
