//! On-off valve with three states (7.3.3; thesis L(2) = 3): closed, fully open to chamber 1, fully
//! open to chamber 2.
//!
//! The sign of the command chooses the state. The valve goes there at constant speeds: from closed to open within the time
//! to switch on, from open to closed within that to switch off.

use super::Request;
use crate::component::valve::spool_travel;
use crate::key::keys;
use crate::values::Rig;

keys! {
    SWITCH_TIME_S: f64 = number("operator.switch_time_s", 0.0, 0.0, 1.0, "", "Time in which an on-off valve opens, from closed to fully open.").of(&["on-off"]);
    SWITCH_OFF_TIME_S: Option<f64> = optional_number("operator.switch_off_time_s", 0.0, 1.0, "switch_time_s", "", "Time in which it closes again.").of(&["on-off"]);
}

impl OnOff {
    /// The on-off valve of a rig.
    pub(super) fn of(rig: &Rig) -> OnOff {
        let on = rig.get(&keys::SWITCH_TIME_S);
        OnOff::new(spool_travel(rig), [on, rig.get(&keys::SWITCH_OFF_TIME_S).unwrap_or(on)])
    }
}

/// An on-off valve and where it is going.
#[derive(Clone, Copy, Debug)]
pub struct OnOff {
    /// m.
    travel: f64,
    /// s from closed to an end, and back.
    times: [f64; 2],
    /// Where the valve was when it set out, and when that was.
    from: f64,
    since: f64,
    target: f64,
}

impl OnOff {
    /// A closed valve, with its travel in m and the times in s in which it switches on and off.
    #[must_use]
    pub fn new(travel: f64, times: [f64; 2]) -> OnOff {
        OnOff { travel, times, from: 0.0, since: 0.0, target: 0.0 }
    }

    pub(super) fn drive(&mut self, t: f64, request: Request) {
        let target = f64::from(request.counts.signum()) * self.travel;
        if target != self.target {
            (self.from, self.since) = (self.position(t), t);
            self.target = target;
            self.arrive(t);
        }
    }

    pub(super) fn commanded(&self) -> f64 {
        self.target
    }

    /// How far it goes at its present speed, m, and the time of that speed for a whole travel, s.
    fn leg(&self) -> (f64, f64) {
        let [on, off] = self.times;
        let closes = self.from * self.target < 0.0 || (self.target == 0.0 && self.from != 0.0);
        match closes {
            true if on != off => (0.0, off),
            _ => (self.target, on),
        }
    }

    fn arrival(&self) -> f64 {
        let (end, time) = self.leg();
        self.since + (end - self.from).abs() / self.travel * time
    }

    pub(super) fn position(&self, t: f64) -> f64 {
        let (end, time) = self.leg();
        if t >= self.arrival() {
            return end;
        }
        let speed = self.travel / time;
        self.from + (end - self.from).signum() * speed * (t - self.since)
    }

    pub(super) fn next_time_event(&self, t: f64) -> f64 {
        let arrival = self.arrival();
        if arrival > t && self.from != self.target { arrival } else { f64::INFINITY }
    }

    pub(super) fn arrive(&mut self, t: f64) {
        if t >= self.arrival() {
            (self.from, self.since) = (self.leg().0, t);
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
        let mut valve = OnOff::new(1e-3, [0.0; 2]);
        for (counts, position) in [(5, 1e-3), (2048, 1e-3), (0, 0.0), (-1, -1e-3)] {
            valve.drive(1.0, request(counts));
            assert_eq!((valve.position(1.0), valve.commanded()), (position, position));
            assert_eq!(valve.next_time_event(1.0), f64::INFINITY, "without a switching time it is there");
        }
    }

    #[test]
    fn a_switch_takes_its_time_and_twice_that_from_end_to_end() {
        let mut valve = OnOff::new(1e-3, [0.01; 2]);
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
        let mut valve = OnOff::new(1e-3, [0.01; 2]);
        valve.drive(0.0, request(1));
        valve.drive(0.004, request(0));
        assert!((valve.position(0.004) - 0.4e-3).abs() < 1e-18);
        assert!((valve.next_time_event(0.004) - 0.008).abs() < 1e-15);
    }

    #[test]
    fn a_valve_that_closes_faster_than_it_opens_goes_from_end_to_end_at_both_speeds() {
        let mut valve = OnOff::new(1e-3, [0.01, 0.004]);
        valve.drive(0.0, request(1));
        valve.arrive(0.01);
        valve.drive(0.02, request(-1));
        assert_eq!(valve.next_time_event(0.02), 0.024);
        assert!((valve.position(0.022) - 0.5e-3).abs() < 1e-18);
        valve.arrive(0.024);
        assert!((valve.next_time_event(0.024) - 0.034).abs() < 1e-15);
        assert!((valve.position(0.029) + 0.5e-3).abs() < 1e-15);
        valve.arrive(0.034);
        assert_eq!((valve.position(0.034), valve.next_time_event(0.034)), (-1e-3, f64::INFINITY));
    }

    #[test]
    fn a_valve_that_closes_at_once_opens_to_the_other_side_within_its_time() {
        let mut valve = OnOff::new(1e-3, [0.01, 0.0]);
        valve.drive(0.0, request(1));
        valve.arrive(0.01);
        valve.drive(0.02, request(-1));
        assert_eq!((valve.position(0.02), valve.next_time_event(0.02)), (0.0, 0.03));
    }
}
