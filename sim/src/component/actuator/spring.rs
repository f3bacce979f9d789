//! A return spring inside the cylinder, between the piston and an end cover.
//!
//! ```text
//! F_s = -(F_0 + k y)          pushes to the retracted end
//! F_s = F_0 + k (L - y)       pushes to the extended end
//! ```
//!
//! F_0 is the force at the end that the spring pushes to, and F_0 + k L that at the other end: data sheets of single-acting
//! cylinders print both. The law is Hooke's. Friction, damping and mass of the coils are left out, and so is a spring that leaves
//! its piston: F_0 keeps it pressed along the whole stroke. The thesis has no such spring. [`crate::component::load`] adds F_s to
//! the forces of 6.31.

use crate::component::actuator;
use crate::key::{keys, words};
use crate::values::Rig;

words! {
    /// The end that a return spring pushes the piston to.
    pub enum ReturnSpringKind {
        /// There is no spring.
        None = "none",
        /// The retracted end, y = 0.
        Retract = "retract",
        /// The extended end, y = L.
        Extend = "extend",
    }
}

keys! {
    RETURN_SPRING: ReturnSpringKind = choice("actuator.return_spring", "", "The end to which a spring in the cylinder pushes the piston.");
    RETURN_SPRING_PRELOAD_N: f64 = number("actuator.return_spring_preload_n", 50.0, 0.0, 1e5, "", "Force of the return spring at the end that it pushes to; a round number, not of a real cylinder.").chosen_by(&RETURN_SPRING, &["retract", "extend"]).spread();
    RETURN_SPRING_STIFFNESS_N_PER_M: f64 = number("actuator.return_spring_stiffness_n_per_m", 200.0, 0.0, 1e6, "", "Stiffness of the return spring; a round number, not of a real cylinder.").chosen_by(&RETURN_SPRING, &["retract", "extend"]).spread();
}

/// A spring with a linear law: F_s = force_at_0 - stiffness y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReturnSpring {
    /// Force at y = 0, N, in the direction of extension.
    pub force_at_0: f64,
    /// k, N/m.
    pub stiffness: f64,
}

impl ReturnSpring {
    /// The spring of a rig's cylinder; one without force where there is none.
    #[must_use]
    pub fn of(rig: &Rig) -> ReturnSpring {
        let kind = rig.get(&keys::RETURN_SPRING);
        let [preload, stiffness] =
            [&keys::RETURN_SPRING_PRELOAD_N, &keys::RETURN_SPRING_STIFFNESS_N_PER_M].map(|key| rig.get(key));
        ReturnSpring::new(kind, preload, stiffness, rig.get(&actuator::keys::STROKE_M))
    }

    /// A spring with a preload (N) and a stiffness (N/m) in a cylinder with a stroke (m).
    #[must_use]
    pub fn new(kind: ReturnSpringKind, preload: f64, stiffness: f64, stroke: f64) -> ReturnSpring {
        match kind {
            ReturnSpringKind::None => ReturnSpring { force_at_0: 0.0, stiffness: 0.0 },
            ReturnSpringKind::Retract => ReturnSpring { force_at_0: -preload, stiffness },
            ReturnSpringKind::Extend => ReturnSpring { force_at_0: preload + stiffness * stroke, stiffness },
        }
    }

    /// F_s, N, in the direction of extension, at a position (m).
    #[must_use]
    pub fn force(&self, position: f64) -> f64 {
        self.force_at_0 - self.stiffness * position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 60 N where it pushes to and 110 N at the other end of 0.1 m, as a data sheet has it.
    #[test]
    fn its_force_goes_from_the_preload_to_that_of_the_data_sheet_at_the_other_end() {
        let of = |kind| ReturnSpring::new(kind, 60.0, 500.0, 0.1);
        for (kind, at_0, at_end) in
            [(ReturnSpringKind::Retract, -60.0, -110.0), (ReturnSpringKind::Extend, 110.0, 60.0)]
        {
            assert!((of(kind).force(0.0) - at_0).abs() < 1e-12, "{kind:?}");
            assert!((of(kind).force(0.1) - at_end).abs() < 1e-12, "{kind:?}");
        }
        assert_eq!(of(ReturnSpringKind::None).force(0.05), 0.0);
    }
}
