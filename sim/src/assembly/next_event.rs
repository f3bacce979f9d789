//! The next event of a spool that has a closed form.
//!
//! The events of such a spool (stick and slip, stops, the edges of the lands) depend on time alone. They are located
//! before a step is made, and the step ends on them. A spool under a flow force, in a stop or under a command that
//! moves all the time has no closed form: its guards are evaluated in every step instead (`System::guards`).

use super::layout::{SPOOL_GUARDS, guard, spool_state};
use super::{Assembly, StateVector};
use pneudrive_solver::crossing::{PROBES, first_crossing};
use pneudrive_solver::{Event, StepLimit, System};

impl Assembly {
    /// How far the next step may go.
    pub(super) fn find_step_limit(&mut self, t: f64, x: &StateVector) -> StepLimit {
        if let Some(next_event) = self.next_spool_event
            && t < next_event.until
        {
            return next_event;
        }
        let time_event = StepLimit { until: self.next_time_event(t), event: Some(Event::Time) };
        let clear = time_event.within(t + self.parts.operator.max_step().min(self.longest_look()));
        if !self.parts.operator.has_closed_form() {
            return clear;
        }
        let found = self.spool_event(t, x, clear);
        self.next_spool_event = Some(found);
        found
    }

    /// The longest time in which the edges of the lands are searched for, s: a null that drifts passes a spool at rest.
    fn longest_look(&self) -> f64 {
        if self.parts.null_drift == 0.0 { f64::INFINITY } else { 1.0 }
    }

    /// The spool's first event before `clear`, or `clear`.
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
        let spool_state = self.parts.operator.state(t, spool_state(x));
        let spool = self.parts.operator.position(t, spool_state);
        let mut guards = [1.0; SPOOL_GUARDS];
        [guards[0], guards[1]] = self.lands.guards(&self.parts.valve, self.beside_null(t, spool));
        guards[2..].copy_from_slice(&self.parts.operator.guards(t, spool_state, flow_force));
        guards
    }
}
