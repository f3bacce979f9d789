//! The continuous controller: the simulator's own, in real numbers (thesis 6.3.1, L(22) = 1; EQUATIONS
//! section 9 and section 11 rule 8).
//!
//! ```text
//! n_p = target - y/pulse,   i = min(floor(|n_p| / span), 255)
//! n_v = y' Wv T / pulse,    n_a = y'' Wv Wa T^2 / pulse
//! n   = clamp((Kp[i] n_p - Kv n_v - Ka n_a) / scale + null offset, +-2048)
//! ```
//!
//! In open loop (L(3) = 0, "available for all controller modules", 6.3.3) the target is the command itself.
//!
//! The windows Wv T and Wa T give n_v and n_a the units of the sampled law, so the same gains mean the same. y''
//! includes the friction, so the command jumps at stick and slip. The index of the profile is a mode: each change of
//! it is an event. The target changes only at sample instants.
//!
//! A hysteresis needs the direction of the command. Between the jumps, and before the command is limited:
//!
//! ```text
//! dn/dt = -(Kp[i] y' + Kv y'' Wv T + Ka y''' Wv Wa T^2) / (pulse scale)
//! ```

use pneudrive_controller::Config;
use pneudrive_controller::law::{LawConfig, Loop, Settings, gain_profile};

use crate::component::controller;
use crate::component::encoder::pulse;
use crate::component::operator;
use crate::values::Rig;

/// The law on one target, and the entry of the profile that it is in.
#[derive(Clone, Debug)]
pub struct ContinuousLaw {
    law: LawConfig,
    /// m.
    pulse: f64,
    /// Wv T, s.
    velocity_window: f64,
    /// Wa T, s.
    acceleration_window: f64,
    /// Counts.
    target: f64,
    index: usize,
    /// Before its first target, a waiting law demands the null.
    waits: bool,
}

impl ContinuousLaw {
    /// The law of a rig, if it has the continuous controller.
    ///
    /// # Panics
    /// When the rig has not been checked.
    #[must_use]
    pub fn of(rig: &Rig) -> Option<ContinuousLaw> {
        (rig.get(&controller::keys::MODEL) == controller::ControllerKind::Continuous).then(|| {
            let config = Config::new(&rig.parameters()).expect("a checked rig has a consistent controller");
            let law = ContinuousLaw::new(&config, pulse(rig));
            if rig.get(&controller::keys::START_S) > 0.0 { law.waiting() } else { law }
        })
    }

    /// The law of a controller's configuration, for an encoder pulse in m.
    #[must_use]
    pub fn new(config: &Config, pulse: f64) -> ContinuousLaw {
        let period = f64::from(config.timing.period_us.get()) / 1e6;
        ContinuousLaw {
            law: config.law.clone(),
            pulse,
            velocity_window: f64::from(config.estimator.velocity_window) * period,
            acceleration_window: f64::from(config.estimator.acceleration_window) * period,
            target: 0.0,
            index: 0,
            waits: false,
        }
    }

    /// The same, whose controller has not started yet.
    #[must_use]
    pub fn waiting(self) -> ContinuousLaw {
        ContinuousLaw { waits: true, ..self }
    }

    /// A new target, in counts.
    pub(crate) fn set_target(&mut self, target: i32, position: f64) {
        self.waits = false;
        self.target = f64::from(target);
        self.index = (self.spans(position).floor() as usize).min(self.last_index());
    }

    /// Whether the target is the command: in open loop, and before the start, when it is 0.
    fn is_open(&self) -> bool {
        self.waits || self.law.control_loop == Loop::Open
    }

    fn last_index(&self) -> usize {
        self.profile().map_or(0, |profile| profile.gains.len() - 1)
    }

    fn profile(&self) -> Option<&gain_profile::Settings> {
        match &self.law.settings {
            Settings::GainProfile(profile) => Some(profile),
            _ => None,
        }
    }

    /// n_p.
    fn error(&self, position: f64) -> f64 {
        self.target - position / self.pulse
    }

    fn spans(&self, position: f64) -> f64 {
        self.error(position).abs()
            / self.profile().map_or(f64::INFINITY, |profile| f64::from(profile.span.get()))
    }

    /// The command in DAC counts, -2048 to 2048, for the motion in SI.
    #[must_use]
    pub fn command(&self, position: f64, velocity: f64, acceleration: f64) -> f64 {
        operator::within_range(self.demand(position, velocity, acceleration))
    }

    /// The demand of the law, in DAC counts, before it is limited to their range.
    #[must_use]
    pub fn demand(&self, position: f64, velocity: f64, acceleration: f64) -> f64 {
        if self.is_open() {
            return self.target;
        }
        self.sum(self.error(position), velocity, acceleration) / f64::from(self.law.scale.get())
            + f64::from(self.law.null_offset)
    }

    /// The rate of the demand, counts/s, in the present entry of the profile.
    #[must_use]
    pub(crate) fn demand_rate(&self, velocity: f64, acceleration: f64, jerk: f64) -> f64 {
        if self.is_open() {
            return 0.0;
        }
        self.sum(-velocity / self.pulse, acceleration, jerk) / f64::from(self.law.scale.get())
    }

    /// Kp n_p - Kv n_v - Ka n_a, or its rate from the rates of n_p, y' and y''.
    fn sum(&self, error: f64, velocity: f64, acceleration: f64) -> f64 {
        let gain = match &self.law.settings {
            Settings::GainProfile(profile) => profile.gains[self.index],
            Settings::Proportional(law) => law.gain,
            // A checked rig has no other law here.
            _ => 0,
        };
        let n_v = velocity * self.velocity_window / self.pulse;
        let n_a = acceleration * self.velocity_window * self.acceleration_window / self.pulse;
        f64::from(gain) * error
            - f64::from(self.law.velocity_gain) * n_v
            - f64::from(self.law.acceleration_gain) * n_a
    }

    /// Not negative as long as the error is in the present entry of the profile: up to the next entry,
    /// and down to the one before. A fast load leaves at one end soon after it came in at the other.
    #[must_use]
    pub fn guards(&self, position: f64) -> [f64; 2] {
        if self.is_open() {
            return [1.0; 2];
        }
        let (spans, index) = (self.spans(position), self.index as f64);
        let farther = if self.index == self.last_index() { 1.0 } else { index + 1.0 - spans };
        let nearer = if self.index == 0 { 1.0 } else { spans - index };
        [farther, nearer]
    }

    /// The entry after a guard has become negative.
    pub fn cross(&mut self, position: f64) {
        if self.spans(position) > self.index as f64 + 0.5 {
            self.index = (self.index + 1).min(self.last_index());
        } else {
            self.index = self.index.saturating_sub(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law() -> ContinuousLaw {
        let mut law = ContinuousLaw::new(&Config::default(), 0.01205e-3);
        law.set_target(8192, 8192.5 * 0.01205e-3);
        law
    }

    /// The reference transient of the continuous drive B begins with this command.
    #[test]
    fn half_a_pulse_of_error_asks_for_16_counts() {
        assert!((law().command(8192.5 * 0.01205e-3, 0.0, 0.0) + 16.0).abs() < 1e-9);
    }

    #[test]
    fn velocity_and_acceleration_count_as_in_the_sampled_law() {
        // 1 m/s moves 539.4 counts in 6.5 ms, EQUATIONS section 9; gains are 1 and the scale is 256.
        let at = 8192.0 * 0.01205e-3;
        assert!((law().command(at, 1.0, 0.0) + 539.42 / 256.0).abs() < 1e-4);
        let n_a = 6.5e-3 * 3.9e-3 / 0.01205e-3;
        assert!((law().command(at, 0.0, 1.0) + n_a / 256.0).abs() < 1e-9);
    }

    #[test]
    fn an_open_loop_asks_for_its_target_whatever_the_load_does() {
        let open = LawConfig { control_loop: Loop::Open, null_offset: 30, ..Config::default().law };
        let mut law = ContinuousLaw::new(&Config { law: open, ..Config::default() }, 0.01205e-3);
        law.set_target(-700, 0.1);
        assert_eq!([law.command(0.1, 0.0, 0.0), law.command(0.2, 1.0, 50.0)], [-700.0; 2]);
        assert_eq!(law.demand_rate(1.0, 50.0, 1e4), 0.0);
        assert_eq!(law.guards(0.2), [1.0; 2], "no entry of the profile to leave");
    }

    #[test]
    fn the_rate_of_the_demand_is_the_slope_of_the_demand_along_a_motion() {
        let law = law();
        let (start, velocity, acceleration, jerk) = (8190.0 * 0.01205e-3, 0.02, 3.0, 800.0);
        let at = |t: f64| {
            let position = start + t * (velocity + t * (acceleration / 2.0 + t * jerk / 6.0));
            let speed = velocity + t * (acceleration + t * jerk / 2.0);
            law.demand(position, speed, acceleration + t * jerk)
        };
        let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
        let rate = law.demand_rate(velocity, acceleration, jerk);
        assert!((rate / slope - 1.0).abs() < 1e-8, "{rate} {slope}");
        assert_eq!(law.demand_rate(0.0, 0.0, 0.0), 0.0, "a load at rest");
    }

    #[test]
    fn the_index_changes_where_the_guard_says() {
        let mut law = law();
        let at = |counts: f64| counts * 0.01205e-3;
        assert!(law.guards(at(8188.5)) == [0.125, 1.0] && law.guards(at(8187.5))[0] < 0.0);
        law.cross(at(8188.0));
        assert_eq!(law.index, 1);
        assert!(law.guards(at(8187.5)) == [0.875, 0.125] && law.guards(at(8188.5))[1] < 0.0);
        law.cross(at(8188.0));
        assert_eq!(law.index, 0);
    }
}
