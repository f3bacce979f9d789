//! The next event of a spool that has a closed form.
//!
//! The events of such a spool (stick and slip, stops, the edges of the lands) depend on time alone. They are located
//! before a step is made, and the step ends on them. A spool under a flow force, in a stop or under a command that
//! moves all the time has no closed form; its guards are evaluated in every step (`System::guards`).

use super::layout::{SPOOL_GUARDS, guard, spool_state};
use super::{Assembly, StateVector};
use crate::component::operator::{KnownMotion, Met, Search, rounding};
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
        if !self.parts.operator.has_closed_form() {
            return self.clear_from(t);
        }
        self.parts.operator.catch_up(t);
        let found = self.spool_event(t, x);
        self.next_spool_event = Some(found);
        found
    }

    /// How far a step may go for all but the guards of the spool.
    fn clear_from(&self, t: f64) -> StepLimit {
        let time_event = StepLimit { until: self.next_time_event(t), event: Some(Event::Time) };
        time_event.within(t + self.parts.operator.max_step().min(self.longest_look()))
    }

    /// The longest time in which the edges of the lands are searched for, s: a null that drifts passes a spool at rest.
    fn longest_look(&self) -> f64 {
        if self.parts.null_drift == 0.0 { f64::INFINITY } else { 1.0 }
    }

    /// The first event of a spool with a closed form.
    fn spool_event(&self, t: f64, x: &StateVector) -> StepLimit {
        let clear = || self.clear_from(t);
        let edges = self.lands.limits(&self.parts.valve);
        let course = self.parts.operator.course(t, spool_state(x), &edges);
        // A null that drifts takes the edges along.
        if self.parts.null_drift != 0.0 {
            let clear = match (clear(), course) {
                (clear, KnownMotion::Stands(exit, Some(own))) if exit < clear.until => {
                    limit_at(exit, Met::Guard(own))
                }
                (clear, _) => clear,
            };
            return self.searched_event(t, x, clear);
        }
        match course {
            KnownMotion::Stands(until, broken_away) => self.while_standing(until, broken_away),
            KnownMotion::Flies(flight, limits) => {
                let clear = clear();
                match flight.first_limit(&limits, [t, clear.until]) {
                    Search::Clear => clear,
                    Search::Found(met, at) => limit_at(at, met),
                    Search::Undecided => self.searched_event(t, x, clear),
                }
            }
            KnownMotion::Unknown => self.searched_event(t, x, clear()),
        }
    }

    /// Only faults come before the end of a spool's standing.
    fn while_standing(&self, until: f64, broken_away: Option<usize>) -> StepLimit {
        let fault = StepLimit { until: self.parts.faults.next_time_event(), event: Some(Event::Time) };
        match broken_away {
            _ if fault.until <= until => fault,
            Some(own) => limit_at(until, Met::Guard(own)),
            None => StepLimit { until, event: None },
        }
    }

    /// The same by looks at all guards of the spool.
    fn searched_event(&self, t: f64, x: &StateVector, clear: StepLimit) -> StepLimit {
        // Forever at rest.
        if clear.until.is_infinite() {
            return clear;
        }
        let span = clear.until - t;
        // A spool at an edge is not beyond it by rounding alone.
        let open = rounding(clear.until);
        let beyond_rounding = |guard: f64| if guard.abs() <= open { 0.0 } else { guard };
        let guards_at = |part: f64| self.spool_guards(t + part * span, x, 0.0).map(beyond_rounding);
        let found = first_crossing(&guards_at(0.0), &PROBES.map(guards_at), guards_at);
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

/// A step that ends where a limit of the spool is met.
fn limit_at(until: f64, met: Met) -> StepLimit {
    let guard = match met {
        Met::Edge(land) => guard::LANDS[land],
        Met::Guard(own) => guard::OPERATOR[own],
    };
    StepLimit { until, event: Some(Event::Guard(guard)) }
}

#[cfg(test)]
mod tests;
