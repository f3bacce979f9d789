//! How exactly a plant is integrated, and what a run of a rig needs.

use crate::component::controller::Loop;
use crate::component::operator::Model;
use crate::keys;
use crate::values::Rig;
use pneudrive_solver::Method;

/// How exactly a plant is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// The method.
    pub method: Method,
    /// Allowed error of a step, relative to what counts as large in each state.
    pub tolerance: f64,
}

impl Default for Accuracy {
    /// For a plant under given commands: repeats the reference transients to a tenth of their tolerances, over the
    /// whole run (docs/agreement.md).
    fn default() -> Self {
        Accuracy { method: Method::DormandPrince, tolerance: 1e-9 }
    }
}

impl Accuracy {
    /// What a run of a rig needs. In a closed loop a count that flips makes another transient, so that it is
    /// integrated until that is rare (see [`crate::convergence`]).
    #[must_use]
    pub fn of(rig: &Rig) -> Accuracy {
        match rig.get(&keys::controller::LOOP) {
            Loop::Closed => Accuracy { tolerance: 1e-11, ..Accuracy::default() },
            Loop::Open => Accuracy::of_motion(rig),
        }
    }

    /// What the motion needs to be exact as long as no count flips. A spool that a stepper places does not shake, and no
    /// position depends on the last nanometres of its motion.
    #[must_use]
    pub fn of_motion(rig: &Rig) -> Accuracy {
        match rig.get(&keys::operator::MODEL) {
            Model::Stepper => Accuracy { tolerance: 3e-8, ..Accuracy::default() },
            _ => Accuracy::default(),
        }
    }

    /// What a run needs that shows what a relative change `apart` of mass and starting position may do: its error is to be
    /// small beside the change (docs/agreement.md).
    #[must_use]
    pub fn of_member(rig: &Rig, apart: f64) -> Accuracy {
        let motion = Accuracy::of_motion(rig);
        Accuracy { tolerance: motion.tolerance * (apart / NEAREST).max(1.0), ..motion }
    }

    /// What a run needs that is one of many draws: another transient of the same drive is as good, and draws are farther
    /// apart than perturbed runs.
    #[must_use]
    pub fn of_draw(rig: &Rig) -> Accuracy {
        Accuracy::of_member(rig, PERTURBATION)
    }
}

/// The usual relative change of perturbed runs.
pub const PERTURBATION: f64 = 1e-5;

/// A relative change beside which the error of a motion is small.
const NEAREST: f64 = 3e-7;
