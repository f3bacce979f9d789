//! On-off valve with three states (7.3.3; thesis L(2) = 3): closed, fully open to chamber 1, fully
//! open to chamber 2.
//!
//! The sign of the command chooses the state. The spool goes there at a constant speed that takes
//! one switching time for the whole travel to one side.

use super::Request;
use crate::component::valve::spool_travel;
use crate::key::keys;
use crate::values::Rig;

keys! {
    SWITCH_TIME_S: f64 = number("operator.switch_time_s", 0.0, 0.0, 1.0, "", "Time from state to state of an on-off valve.").of(&["on-off"]);
}

impl OnOff {
    /// The on-off valve of a rig.
    pub(super) fn of(rig: &Rig) -> OnOff {
        OnOff::new(spool_travel(rig), rig.get(&keys::SWITCH_TIME_S))
    }
}

/// An on-off valve and where its spool is going.
#[derive(Clone, Copy, Debug)]
pub struct OnOff {
    /// m.
    travel: f64,
    /// s from the middle to an end.
    switch_time: f64,
    /// Where the spool was when it set out, and when that was.
    from: f64,
    since: f64,
    target: f64,
}

impl OnOff {
    /// A closed valve, with its travel in m and its switching time in s.
    #[must_use]
    pub fn new(travel: f64, switch_time: f64) -> OnOff {
        OnOff { travel, switch_time, from: 0.0, since: 0.0, target: 0.0 }
    }

    pub(super) fn drive(&mut self, t: f64, request: Request) {
        let target = f64::from(request.counts.signum()) * self.travel;
        if target != self.target {
            (self.from, self.since) = (self.position(t), t);
            self.target = target;
        }
    }

    pub(super) fn commanded(&self) -> f64 {
        self.target
    }

    fn arrival(&self) -> f64 {
        self.since + (self.target - self.from).abs() / self.travel * self.switch_time
    }

    pub(super) fn position(&self, t: f64) -> f64 {
        if t >= self.arrival() {
            return self.target;
        }
        let speed = self.travel / self.switch_time;
        self.from + (self.target - self.from).signum() * speed * (t - self.since)
    }

    pub(super) fn next_time_event(&self, t: f64) -> f64 {
        let arrival = self.arrival();
        if arrival > t && self.from != self.target { arrival } else { f64::INFINITY }
    }

    pub(super) fn arrive(&mut self, t: f64) {
        if t >= self.arrival() {
            (self.from, self.since) = (self.target, t);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(counts: i16) -> Request {
        Request { counts, step: 0 }
    }

    #[test]
    fn the_sign_of_the_command_chooses_one_of_three_states() {
        let mut valve = OnOff::new(1e-3, 0.0);
        for (counts, position) in [(5, 1e-3), (2048, 1e-3), (0, 0.0), (-1, -1e-3)] {
            valve.drive(1.0, request(counts));
            assert_eq!((valve.position(1.0), valve.commanded()), (position, position));
            assert_eq!(valve.next_time_event(1.0), f64::INFINITY, "without a switching time it is there");
        }
    }

    #[test]
    fn a_switch_takes_its_time_and_twice_that_from_end_to_end() {
        let mut valve = OnOff::new(1e-3, 0.01);
        valve.drive(0.0, request(1));
        assert_eq!(valve.next_time_event(0.0), 0.01);
        assert!((valve.position(0.005) - 0.5e-3).abs() < 1e-18);
        valve.arrive(0.01);
        valve.drive(0.02, request(-1));
        assert!((valve.next_time_event(0.02) - 0.04).abs() < 1e-15);
        assert!(valve.position(0.03).abs() < 1e-15);
    }

    #[test]
    fn a_change_of_mind_begins_where_the_spool_is() {
        let mut valve = OnOff::new(1e-3, 0.01);
        valve.drive(0.0, request(1));
        valve.drive(0.004, request(0));
        assert!((valve.position(0.004) - 0.4e-3).abs() < 1e-18);
        assert!((valve.next_time_event(0.004) - 0.008).abs() < 1e-15);
    }
}
