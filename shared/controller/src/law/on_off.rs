//! The on-off law (L(22) = 2): Burrows' relay with a dead zone and hysteresis, on position, velocity and quasi-transient
//! pressure (gain k5 = C(68)).
//!
//! ```text
//! s = (Kp n_p - Kv n_v - Ka n_a - k5 n_q) / scale                toward zero
//! ```
//!
//! switches the relay; the demand is the full range to either side, or 0. The position dead band is the relay's dead zone.
//! Nothing is fed forward, and there is no null offset: a closed valve has none.

use super::feedback::{Feedback, scaled, weighed};
use super::{ControlLaw, LawConfig, Measured, Reference};
use crate::drive::MAX_COUNTS;
use crate::parameters::{Parameters, id};

/// Its gain and its relay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Kp.
    pub gain: u16,
    /// The relay drops out this much below its dead zone, counts of error.
    pub hysteresis: u32,
}

impl Settings {
    pub(crate) fn of(parameters: &Parameters) -> Settings {
        Settings {
            gain: parameters.scalar(id::PROPORTIONAL_GAIN) as u16,
            hysteresis: parameters.scalar(id::RELAY_HYSTERESIS_COUNTS).unsigned_abs(),
        }
    }
}

/// What it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OnOff {
    feedback: Feedback,
    relay: Relay,
}

impl ControlLaw for OnOff {
    type Settings = Settings;

    #[cold]
    #[inline(never)]
    fn demand(
        &mut self,
        config: &LawConfig,
        settings: &Settings,
        measured: Measured,
        reference: Reference,
    ) -> i32 {
        let pressure = self.feedback.pressure(config, measured);
        let s = scaled(config, weighed(config, settings.gain, measured, reference.error) - pressure);
        let side = self.relay.switch(s, config.dead_band, settings.hysteresis);
        i32::from(side) * i32::from(MAX_COUNTS)
    }
}

/// The relay, and which way it is switched: -1, 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Relay(i8);

impl Relay {
    /// Picks up where |s| reaches the dead zone, drops out where it is `hysteresis` below.
    fn switch(&mut self, s: i32, dead_zone: u32, hysteresis: u32) -> i8 {
        let side = s.signum() as i8;
        let picks_up = s.unsigned_abs() >= dead_zone;
        let holds = side == self.0 && s.unsigned_abs() >= dead_zone.saturating_sub(hysteresis);
        self.0 = if picks_up || holds { side } else { 0 };
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relay_picks_up_at_its_dead_zone_and_drops_out_below_it_by_the_hysteresis() {
        let mut relay = Relay::default();
        let inputs = [9, 10, 8, 7, 6, 9, -9, -10, -7, -6];
        let states = inputs.map(|s| relay.switch(s, 10, 3));
        assert_eq!(states, [0, 1, 1, 1, 0, 0, 0, -1, -1, 0]);
    }

    #[test]
    fn a_relay_that_is_thrown_over_does_not_hold_on_the_other_side() {
        let mut relay = Relay(1);
        assert_eq!(relay.switch(-8, 10, 3), 0);
        assert_eq!(relay.switch(-10, 10, 3), -1);
    }

    #[test]
    fn a_relay_without_a_dead_zone_follows_the_sign() {
        let mut relay = Relay::default();
        assert_eq!([5, 1, 0, -1, i32::MIN, i32::MAX].map(|s| relay.switch(s, 0, 9)), [1, 1, 0, -1, -1, 1]);
    }
}
