//! What becomes of a spool over a time: Phi [s - u, s'].

use super::number::product;
use crate::drive::MAX_COUNTS;
use crate::parameters::Parameters;

/// Largest command of any drive, Q16.
pub(super) const MOST: i32 = (MAX_COUNTS as i32) << 16;

/// Phi over a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Transition([i32; 4]);

impl Transition {
    /// Of four parameters from the first on.
    pub(super) fn of(parameters: &Parameters, first: u16) -> Transition {
        Transition([0, 1, 2, 3].map(|i| parameters.scalar(first + i)))
    }

    /// Speed by a place, Q28.
    pub(super) fn pull(self) -> i32 {
        let Transition([_, _, pull, _]) = self;
        pull
    }

    /// What becomes of a place, from that of rest, and of a speed.
    #[inline(always)]
    pub(super) fn moved(self, from: i32, of_speed: i32) -> (i32, i32) {
        let Transition([place, speed, pull, coast]) = self;
        (
            product(from, place, 30).saturating_add(product(of_speed, speed, 30)),
            product(from, pull, 28).saturating_add(product(of_speed, coast, 30)),
        )
    }
}
