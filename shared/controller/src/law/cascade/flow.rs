//! The flow observer: the part of the force's rate that the model of valve and air does not know.
//!
//! ```text
//! F' = E C(z) - R C(-z) - K v + g,   g' = 0             two poles at q, corrected by the measured force
//! e = F - (f + rate + g),   f += rate + g + (1 - q^2) e,   g += (1 - q)^2 e
//! ```
//!
//! E, R and K are those of the sample before, z the mean place of the spool since then.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | f | Q24 | saturated |
//! | g | Q40, 64 bits | -16 to 16 |

use super::number::{product, scaled};
use crate::fixed::saturate;
use crate::parameters::{Parameters, id};

/// Gains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// 1 - q^2 and (1 - q)^2, Q30.
    force: i32,
    rate: i32,
}

/// What it knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flow {
    force: i32,
    unknown: i64,
}

/// Largest g, Q40.
const MOST: i64 = 1 << 44;

impl Constants {
    pub(super) fn of(parameters: &Parameters) -> Constants {
        let q = parameters.scalar(id::CASCADE_FLOW_DECAY);
        let left = (1 << 30) - q;
        Constants { force: (1 << 30) - product(q, q, 30), rate: product(left, left, 30) }
    }
}

impl Flow {
    pub(super) fn new(force: i32) -> Flow {
        Flow { force, unknown: 0 }
    }

    /// Takes a sample: the measured force and the rate that is known, both Q24; returns the error of what was expected.
    pub(super) fn observe(&mut self, constants: &Constants, force: i32, rate: i32) -> i32 {
        let expected = self.force.saturating_add(rate).saturating_add(self.unknown());
        let error = force.saturating_sub(expected);
        self.force = expected.saturating_add(scaled(error, constants.force, 30));
        let change = (i64::from(error) * i64::from(constants.rate)) >> 14;
        self.unknown = (self.unknown + change).clamp(-MOST, MOST);
        error
    }

    /// g, force a sample, Q24.
    #[must_use]
    pub fn unknown(&self) -> i32 {
        saturate((self.unknown + (1 << 15)) >> 16)
    }
}
