//! How the drive follows the continuous controller, whose command is a function of the state.
//!
//! The demand jumps when its target, the entry of its profile, or the load's acceleration does. Its rate also jumps
//! when the load meets a stop. An operator that remembers the path of its command is informed of these jumps
//! (EQUATIONS section 11 rules 3 and 8).

use super::layout::spool_state;
use super::{Assembly, StateVector, slot};
use crate::component::load::Motion;
use crate::component::operator;
use crate::continuous::ContinuousLaw;
use pneudrive_solver::Derivative;

impl Assembly {
    /// The target of the continuous controller changes, at a sample instant.
    pub fn set_target(&mut self, t: f64, x: &StateVector, target: i32) -> Derivative {
        self.follow(x);
        if let Some(law) = &mut self.parts.continuous {
            law.set_target(target, x[slot::POSITION]);
        }
        self.report_jump(t, x);
        Derivative::Discontinuous
    }

    /// The command of the continuous controller, counts: every state has its own.
    pub fn follow(&mut self, x: &StateVector) -> Option<f64> {
        let demand = self.demand(x)?;
        self.parts.operator.follow(demand);
        Some(operator::within_range(demand))
    }

    /// The demand of the continuous controller, counts.
    fn demand(&self, x: &StateVector) -> Option<f64> {
        self.parts.continuous.as_ref().map(|law| self.demand_of(law, x))
    }

    /// The same of its law.
    #[inline(never)]
    fn demand_of(&self, law: &ContinuousLaw, x: &StateVector) -> f64 {
        let acceleration = self.parts.load.acceleration(&self.body(x));
        law.demand(x[slot::POSITION], x[slot::VELOCITY], acceleration)
    }

    /// Tells the operator the rate of the demand, if a mode of it depends on that.
    pub(super) fn follow_rate(&mut self, t: f64, x: &StateVector) {
        if self.parts.operator.needs_rate()
            && let Some(rate) = self.demand_rate(t, x)
        {
            self.parts.operator.follow_rate(rate);
        }
    }

    /// The rate of the demand, counts/s: of all that it depends on, only the spool is not in it.
    fn demand_rate(&mut self, t: f64, x: &StateVector) -> Option<f64> {
        self.parts.continuous.as_ref()?;
        let slope = self.rates_but_spool(t, x);
        let [p1, p2] = self.acting_rates(x, &slope);
        let motion = Motion {
            position: x[slot::POSITION],
            velocity: x[slot::VELOCITY],
            acceleration: slope[slot::VELOCITY],
        };
        let force_rate = self.parts.actuator.force_rate(p1, p2);
        let jerk = self.parts.load.jerk(force_rate, self.load_side, motion, &self.body(x));
        let law = self.parts.continuous.as_ref()?;
        Some(law.demand_rate(motion.velocity, motion.acceleration, jerk))
    }

    /// The modes that the demand depends on have changed. The last value that the operator followed must be the
    /// demand in the modes before.
    pub(super) fn report_jump(&mut self, t: f64, x: &StateVector) {
        if self.parts.operator.remembers_demand()
            && let (Some(demand), Some(rate)) = (self.demand(x), self.demand_rate(t, x))
        {
            let flow_force = self.flow_force(t, x);
            self.parts.operator.jump(t, spool_state(x), [demand, rate], flow_force);
        }
    }
}

#[cfg(test)]
mod tests;
