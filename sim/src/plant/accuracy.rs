//! The accuracy of an integration, and the accuracy that a run of a rig needs.

use crate::component::controller::Loop;
use crate::component::operator::OperatorKind;
use crate::keys;
use crate::values::Rig;
use pneudrive_solver::Method;

/// The accuracy of an integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// The method.
    pub method: Method,
    /// Allowed error of a step, relative to the scale of each state.
    pub tolerance: f64,
}

impl Default for Accuracy {
    /// For a plant under given commands: repeats the reference transients to a tenth of their tolerances, over the
    /// whole run (docs/explanation/agreement.md).
    fn default() -> Self {
        Accuracy { method: Method::DormandPrince, tolerance: 1e-9 }
    }
}

impl Accuracy {
    /// The accuracy that a run of a rig needs. In a closed loop a flipped count gives another transient, so the
    /// integration must be exact enough for that to be rare (see [`crate::convergence`]).
    #[must_use]
    pub fn of(rig: &Rig) -> Accuracy {
        match rig.get(&keys::controller::LOOP) {
            Loop::Closed => Accuracy { tolerance: 1e-11, ..Accuracy::default() },
            Loop::Open => Accuracy::of_motion(rig),
        }
    }

    /// The accuracy that the motion needs as long as no count flips. The spool of a stepper does not shake, and no
    /// position depends on the last nanometres of its motion.
    #[must_use]
    pub fn of_motion(rig: &Rig) -> Accuracy {
        match rig.get(&keys::operator::MODEL) {
            OperatorKind::Stepper => Accuracy { tolerance: 3e-8, ..Accuracy::default() },
            _ => Accuracy::default(),
        }
    }

    /// The accuracy of a perturbed run with a relative change `apart` of mass and starting position: its error must
    /// be small beside the effect of that change (docs/explanation/agreement.md).
    #[must_use]
    pub fn of_member(rig: &Rig, apart: f64) -> Accuracy {
        let motion = Accuracy::of_motion(rig);
        Accuracy { tolerance: motion.tolerance * (apart / NEAREST).max(1.0), ..motion }
    }

    /// The accuracy of a run that is one of many draws: another transient of the same drive is as good, and draws are
    /// farther apart than perturbed runs.
    #[must_use]
    pub fn of_draw(rig: &Rig) -> Accuracy {
        Accuracy::of_member(rig, PERTURBATION)
    }
}

/// The usual relative change of perturbed runs.
pub const PERTURBATION: f64 = 1e-5;

/// A relative change that is large beside the error of a motion.
const NEAREST: f64 = 3e-7;
