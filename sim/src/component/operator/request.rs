//! The request to an operator.

use pneudrive_controller::drive;

/// The action of the drive stage at an output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Request {
    /// Counts of a DAC; for a stepper the requested location, steps.
    pub counts: i16,
    /// Pulse for a stepper: -1, 0 or 1.
    pub step: i8,
}

/// A demand in counts, limited to the range of a DAC.
#[must_use]
pub fn within_range(demand: f64) -> f64 {
    demand.clamp(-f64::from(drive::MAX_COUNTS), f64::from(drive::MAX_COUNTS))
}
