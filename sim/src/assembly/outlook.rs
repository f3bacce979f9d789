//! What the spool will do, known beforehand.
//!
//! Where time alone moves the spool, so it does its events: stick and slip, stops and the edges of the lands.
//! They are located before a step is made, which then ends on them. A spool under a flow force, in a stop or with
//! a command that moves all the time is watched at every step instead (`System::guards`).

use super::layout::{SPOOL_GUARDS, guard, spool_state};
use super::{Assembly, StateVector};
use pneudrive_solver::crossing::{PROBES, first_crossing};
use pneudrive_solver::{Event, StepLimit};

impl Assembly {
    /// What ends the next step, if its error does not.
    pub(super) fn find_step_limit(&mut self, t: f64, x: &StateVector) -> StepLimit {
        if let Some(outlook) = self.outlook
            && t < outlook.until
        {
            return outlook;
        }
        let instant = self.parts.operator.next_time_event(t).min(self.parts.faults.next_time_event());
        let instant = StepLimit { until: instant, event: Some(Event::Time) };
        let clear = instant.within(t + self.parts.operator.max_step().min(self.longest_look()));
        if !self.parts.operator.is_foreseen() {
            return clear;
        }
        let found = self.spool_event(t, x, clear);
        self.outlook = Some(found);
        found
    }

    /// For how long the edges of the lands are looked after, s: a null that drifts passes a spool at rest.
    fn longest_look(&self) -> f64 {
        if self.parts.null_drift == 0.0 { f64::INFINITY } else { 1.0 }
    }

    /// The spool's first event before what ends the time that is looked at.
    fn spool_event(&self, t: f64, x: &StateVector, clear: StepLimit) -> StepLimit {
        // Forever at rest.
        if clear.until.is_infinite() {
            return clear;
        }
        let span = clear.until - t;
        let guards_at = |part: f64| self.spool_guards(t + part * span, x, 0.0);
        let [one, two, three, four] = PROBES;
        let looks = [guards_at(one), guards_at(two), guards_at(three), guards_at(four)];
        let found = first_crossing(&guards_at(0.0), &looks, guards_at);
        found.map_or(clear, |(index, part)| StepLimit {
            until: t + part * span,
            event: Some(Event::Guard(guard::SPOOL + index)),
        })
    }

    /// Guards of the edges of the lands and of the operator.
    pub(super) fn spool_guards(&self, t: f64, x: &StateVector, flow_force: f64) -> [f64; SPOOL_GUARDS] {
        let place = self.parts.operator.place(t, spool_state(x));
        let spool = self.parts.operator.position(t, place);
        let mut guards = [1.0; SPOOL_GUARDS];
        [guards[0], guards[1]] = self.lands.guards(&self.parts.valve, self.beside_null(t, spool));
        guards[2..].copy_from_slice(&self.parts.operator.guards(t, place, flow_force));
        guards
    }
}
