//! The load of a drive in a state: its forces, its motion, and its modes.

use super::layout::{friction_states, guard};
use super::{Assembly, Parts, StateVector, slot};
use crate::component::air::ChamberAir;
use crate::component::friction::{Body, Contact, FrictionModel, States};
use crate::number::Pair;

/// Quantities that depend only on the state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effects {
    pub air: ChamberAir<Pair>,
    pub actuator_force: f64,
    pub friction_force: f64,
    pub acceleration: f64,
}

impl Parts {
    /// The mode of the load at the start of a test in the state `x`, and the states of its friction.
    pub fn friction_at_rest(&self, x: &StateVector) -> (Contact, States) {
        let position = x[slot::POSITION];
        let [p1, p2] = slot::EXNER.map(|i| self.gas.pressure(x[i]));
        let side = self.load.stops.side(position);
        let applied = self.load.applied_force(self.actuator.force(p1, p2), side, position, x[slot::VELOCITY]);
        self.load.friction.at_rest(applied)
    }
}

impl Assembly {
    /// The load under the air of a state.
    pub(super) fn body(&self, x: &StateVector) -> Body {
        let [p1, p2] = self.acting(self.spear, x, slot::EXNER.map(|i| self.parts.gas.pressure(x[i])));
        self.body_under(self.parts.actuator.force(p1, p2), x)
    }

    /// The same under a force of the cylinder, N.
    #[inline(always)]
    fn body_under(&self, actuator_force: f64, x: &StateVector) -> Body {
        let (load, velocity) = (&self.parts.load, x[slot::VELOCITY]);
        let applied = load.applied_force(actuator_force, self.load_side, x[slot::POSITION], velocity);
        load.body(applied, velocity, (self.load_contact, friction_states(x)))
    }

    /// The rates of the load and of its friction under a force of the cylinder, N.
    #[inline(always)]
    pub(super) fn move_load(&self, actuator_force: f64, x: &StateVector, slope: &mut StateVector) {
        let body = self.body_under(actuator_force, x);
        slope[slot::POSITION] = body.velocity;
        slope[slot::VELOCITY] = self.parts.load.acceleration(&body);
        for (place, rate) in slot::FRICTION.into_iter().zip(self.parts.load.friction.derivative(&body)) {
            slope[place] = rate;
        }
    }

    /// Quantities that depend only on the state.
    pub fn effects(&self, x: &StateVector) -> Effects {
        let air = self.air(x);
        let [one, two] = self.acting(self.spear, x, air.pressure.to_array());
        let actuator_force = self.parts.actuator.force(one, two);
        let body = self.body_under(actuator_force, x);
        Effects {
            air,
            actuator_force,
            friction_force: self.parts.load.friction.force(&body),
            acceleration: self.parts.load.acceleration(&body),
        }
    }

    /// Not negative as long as the contact of the load holds.
    #[inline(always)]
    pub(super) fn friction_guard(&self, x: &StateVector) -> f64 {
        let load = &self.parts.load;
        load.friction.guard(&match self.load_contact {
            Contact::Stuck => self.body(x),
            // Whatever the force.
            contact => load.body(0.0, x[slot::VELOCITY], (contact, friction_states(x))),
        })
    }

    /// A mode of the load or an entry of the profile ends: the continuous command jumps, or its rate does.
    pub(super) fn cross_load(&mut self, index: usize, t: f64, x: &mut StateVector) {
        self.follow(x);
        match index {
            guard::LOAD_FRICTION => {
                if self.load_contact != Contact::Stuck {
                    x[slot::VELOCITY] = 0.0;
                }
                let applied = self.body(x).applied;
                self.load_contact = self.parts.load.friction.after(self.load_contact, applied);
            }
            guard::LOAD_STOPS if self.meets_spear(x[slot::POSITION]) => self.move_spear(t, x),
            guard::LOAD_STOPS => {
                self.load_side = self.parts.load.stops.after(self.load_side, x[slot::POSITION])
            }
            _ => {
                if let Some(law) = &mut self.parts.continuous {
                    law.cross(x[slot::POSITION]);
                }
            }
        }
        self.report_jump(t, x);
    }
}
