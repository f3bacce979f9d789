//! The force that holds the load of a simulated run, by the values of its rig.

use pneudrive_sim::component::actuator::Actuator;
use pneudrive_sim::{Rig, keys};

/// The dry friction that holds a load at rest, and the pistons that pull at it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Holding {
    /// At which friction it breaks away, N: against extension, and against retraction.
    pub breakaway_n: [f64; 2],
    /// Areas of the piston in chambers 1 and 2, m^2.
    pub areas_m2: [f64; 2],
}

impl Holding {
    /// The force of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Holding {
        let actuator = Actuator::of(rig);
        Holding {
            breakaway_n: [&keys::friction::STATIC_EXTEND_N, &keys::friction::STATIC_RETRACT_N]
                .map(|key| rig.get(key)),
            areas_m2: [actuator.area_1, actuator.area_2],
        }
    }
}
