//! Stepper motor with a lead screw (6.4.1; thesis L(2) = 2): x = mm_per_step n, a step a pulse, at
//! once and rigidly. The pulses come one a sample, at the output.

use super::{Request, SpoolLaw};
use crate::key::keys;
use crate::values::Rig;

keys! {
    MM_PER_STEP: f64 = number("operator.mm_per_step", 0.0125, 1e-5, 1.0, "C(66)", "Spool travel of a step.").of(&["stepper"]);
    MAX_STEPS: i64 = integer("operator.max_steps", 40, 1, 2048, "L(20)", "Furthest step from mid-travel.").of(&["stepper"]);
    PULSE_WIDTH_US: i64 = integer("operator.pulse_width_us", 10, 1, 1000, "", "Length of a stepper's pulse, kept by the board.").of(&["stepper"]);
    DIRECTION_SETUP_US: i64 = integer("operator.direction_setup_us", 10, 1, 1000, "", "Time from a change of a stepper's direction to the pulse, kept by the board.").of(&["stepper"]);
}

impl Stepper {
    /// The stepper of a rig.
    pub(super) fn of(rig: &Rig) -> Stepper {
        Stepper::new(rig.get(&keys::MM_PER_STEP) * 1e-3)
    }
}

/// A stepper and where it is.
#[derive(Clone, Copy, Debug)]
pub struct Stepper {
    /// m (C(66)).
    travel_per_step: f64,
    steps: i32,
    target: i16,
}

impl Stepper {
    /// A stepper at mid-travel, with its travel per step in m.
    #[must_use]
    pub fn new(travel_per_step: f64) -> Stepper {
        Stepper { travel_per_step, steps: 0, target: 0 }
    }

    pub(super) fn drive(&mut self, request: Request) {
        self.target = request.counts;
        self.steps += i32::from(request.step);
    }

    pub(super) fn commanded(&self) -> f64 {
        f64::from(self.target) * self.travel_per_step
    }

    pub(super) fn spool_law(&self) -> SpoolLaw {
        SpoolLaw::Follows { per_count: self.travel_per_step }
    }

    pub(super) fn position(&self) -> f64 {
        f64::from(self.steps) * self.travel_per_step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spool_goes_one_step_a_pulse_whatever_is_asked_for() {
        let mut stepper = Stepper::new(0.0125e-3);
        for _ in 0..3 {
            stepper.drive(Request { counts: 20, step: 1 });
        }
        stepper.drive(Request { counts: 20, step: -1 });
        assert_eq!((stepper.position(), stepper.commanded()), (2.0 * 0.0125e-3, 20.0 * 0.0125e-3));
    }
}
