//! External disturbances of the plant: faults, and changes of the supply pressure and of the load.

use super::layout::spool_state;
use super::{Assembly, StateVector, slot};
use crate::component::air::GasState;
use crate::component::friction::{Contact, FrictionModel};
use crate::component::load::Load;
use pneudrive_solver::Derivative;

impl Assembly {
    /// Applies faults of the plant that begin or end at `t`; returns whether any do. They change the flows.
    pub(super) fn pass_faults(&mut self, t: f64, x: &mut StateVector) -> bool {
        if !self.parts.faults.pass(t) {
            return false;
        }
        self.supply_the_network();
        self.parts.network.cross_tubes(self.parts.faults.now.swapped_tubes);
        if self.parts.faults.now.stuck_spool {
            self.settle(t, x);
            self.parts.operator.stick(t, spool_state(x));
            x[slot::SPOOL_VELOCITY] = 0.0;
        }
        self.parts.network.jump();
        self.solved = None;
        self.find_port_directions(t, x);
        true
    }

    /// The supply, or the line in front of its receiver, has another pressure from `t` on, Pa, or its regulator is set to another.
    pub fn set_supply_pressure(&mut self, t: f64, x: &StateVector, pressure: f64) -> Derivative {
        if !self.parts.receiver.as_mut().is_some_and(|receiver| receiver.set_regulator(pressure)) {
            self.parts.supply_pressure = pressure;
        }
        self.supply_the_network();
        self.next_spool_event = None;
        self.solved = None;
        self.parts.network.jump();
        self.find_port_directions(t, x);
        Derivative::Discontinuous
    }

    /// Another load has the piston from `t` on, with the same kind of friction.
    pub fn set_load(&mut self, x: &StateVector, load: Load) -> Derivative {
        self.parts.load = load;
        self.load_side = load.stops.side(x[slot::POSITION]);
        if self.load_contact == Contact::Stuck && self.friction_guard(x) < 0.0 {
            let applied = self.body(x).applied;
            self.load_contact = load.friction.after(Contact::Stuck, applied);
        }
        self.solved = None;
        Derivative::Discontinuous
    }

    /// Sets the pressure of the supply, or of the line in front of its receiver: its own, or a fault's.
    fn supply_the_network(&mut self) {
        let pressure = self.parts.faults.now.supply_pressure.unwrap_or(self.parts.supply_pressure);
        if let Some(receiver) = &mut self.parts.receiver {
            receiver.set_line(pressure);
            return;
        }
        let exner = self.parts.gas.exner(pressure);
        self.draw_from(GasState { exner, ..*self.parts.network.supply() });
    }

    /// Network and tubes draw this air.
    pub(super) fn draw_from(&mut self, supply: GasState) {
        self.parts.network.set_supply(supply);
        if let Some(lag) = &mut self.parts.lag {
            lag.supply = supply;
        }
    }
}
