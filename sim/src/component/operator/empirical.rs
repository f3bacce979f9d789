//! Empirical solenoid (6.32; thesis L(2) = 0): a damped oscillator that follows its command.
//!
//! ```text
//! x_s'' = K_S (X_c - x_s) - K_D x_s'                    the state is neither dithered nor limited
//! x     = clamp(play(x_s + dither), +-X_max)            what the valve sees
//! ```
//!
//! Dither, hysteresis and limit act on a copy of the state (6.4.2; EQUATIONS section 11 rule 5); the
//! play's memory is not limited.

use super::closed_form::{Forcing, FreeMotion, Oscillator};
use super::{GUARDS, Request, SpoolLaw, SpoolState};
use crate::component::dither::Dither;
use crate::component::operator::{amplifier, hysteresis};
use crate::component::play::{self, Play};
use crate::component::valve::spool_travel;
use crate::key::keys;
use crate::values::Rig;

keys! {
    STIFFNESS_PER_MASS_PER_S2: f64 = number("operator.stiffness_per_mass_per_s2", 36_000.0, 1.0, 1e9, "C(50)", "Squared natural frequency of the empirical operator.").of(&["solenoid-empirical"]);
    DAMPING_PER_S: f64 = number("operator.damping_per_s", 100.0, 0.0, 1e6, "C(51)", "Damping of the empirical operator.").of(&["solenoid-empirical"]);
}

impl Empirical {
    /// The operator of a rig, under a dither.
    pub(super) fn of(rig: &Rig, dither: Dither) -> Empirical {
        Empirical::new(EmpiricalParameters {
            travel_per_count: spool_travel(rig) / 2048.0,
            amplifier_gain: rig.get(&amplifier::keys::AMPLIFIER_GAIN),
            saturation: rig.get(&amplifier::keys::SATURATION_MM) * 1e-3,
            stiffness_per_mass: rig.get(&keys::STIFFNESS_PER_MASS_PER_S2),
            damping_per_mass: rig.get(&keys::DAMPING_PER_S),
            play: hysteresis::at_start(rig),
            dither,
            travel: spool_travel(rig),
        })
    }
}

/// The parameters of an empirical solenoid, SI.
#[derive(Clone, Copy, Debug)]
pub struct EmpiricalParameters {
    /// Spool travel of one command count, m.
    pub travel_per_count: f64,
    /// C(37).
    pub amplifier_gain: f64,
    /// C(38), m.
    pub saturation: f64,
    /// K_S, 1/s^2 (C(50)).
    pub stiffness_per_mass: f64,
    /// K_D, 1/s (C(51)).
    pub damping_per_mass: f64,
    /// The hysteresis at the start, m.
    pub(crate) play: Play,
    /// Dither on the spool position, m.
    pub dither: Dither,
    /// X_max, m (C(3)).
    pub travel: f64,
}

/// An empirical solenoid with its modes.
#[derive(Clone, Debug)]
pub struct Empirical {
    parameters: EmpiricalParameters,
    counts: f64,
    play: Play,
    /// Whether the play's output is beyond the travel.
    limited: bool,
    /// The motion until the next command, unless that moves all the time.
    flight: Option<FreeMotion>,
}

/// The guards of the play come first.
const LIMIT: usize = play::GUARDS;

impl Empirical {
    /// A solenoid with its spool at rest at mid-travel and a null command.
    #[must_use]
    pub fn new(parameters: EmpiricalParameters) -> Empirical {
        let mut play = parameters.play;
        play.jump(0.0, parameters.dither.value(0.0), parameters.dither.direction(0.0));
        Empirical { parameters, counts: 0.0, play, limited: false, flight: None }
    }

    pub(super) fn commanded(&self) -> f64 {
        self.counts * self.parameters.travel_per_count
    }

    /// The command reaches the spool through its acceleration alone: nothing jumps.
    pub(super) fn drive(&mut self, t: f64, spool: SpoolState, request: Request) {
        self.counts = f64::from(request.counts);
        let p = &self.parameters;
        let oscillator =
            Oscillator { stiffness_per_mass: p.stiffness_per_mass, damping_per_mass: p.damping_per_mass };
        let steady = p.stiffness_per_mass * self.amplified();
        let swing = Dither { amplitude: 0.0, ..p.dither };
        self.flight = FreeMotion::new(oscillator, Forcing { steady, swing }, t, spool);
    }

    pub(super) fn follow(&mut self, counts: f64) {
        self.counts = counts;
    }

    /// Where the spool is at `t`, if the integrator's state is `spool`.
    pub(super) fn state(&self, t: f64, spool: SpoolState) -> SpoolState {
        self.flight.as_ref().map_or(spool, |flight| flight.at(t))
    }

    /// Whether the motion is known, so that the integrator's state rests.
    pub(super) fn flies(&self) -> bool {
        self.flight.is_some()
    }

    /// s.
    pub(super) fn max_step(&self) -> f64 {
        self.flight.as_ref().map_or(f64::INFINITY, FreeMotion::quarter_period)
    }

    pub(super) fn spool_law(&self) -> SpoolLaw {
        let p = &self.parameters;
        SpoolLaw::Moves {
            per_count: p.amplifier_gain * p.travel_per_count,
            stiffness_per_mass: p.stiffness_per_mass,
            damping_per_mass: p.damping_per_mass,
            mass: f64::INFINITY,
        }
    }

    fn amplified(&self) -> f64 {
        let p = &self.parameters;
        (p.amplifier_gain * self.commanded()).clamp(-p.saturation, p.saturation)
    }

    fn input(&self, t: f64, spool: SpoolState) -> f64 {
        spool.position + self.parameters.dither.value(t)
    }

    fn rate(&self, t: f64, spool: SpoolState) -> f64 {
        spool.velocity + self.parameters.dither.rate(t)
    }

    pub(super) fn position(&self, t: f64, spool: SpoolState) -> f64 {
        let travel = self.parameters.travel;
        let unlimited = self.play.output(self.input(t, spool));
        // Within a step the mode stays, so that the areas are smooth a little beyond the limit.
        if self.limited { unlimited.clamp(-travel, travel) } else { unlimited }
    }

    pub(super) fn acceleration(&self, spool: SpoolState) -> f64 {
        let p = &self.parameters;
        p.stiffness_per_mass * (self.amplified() - spool.position) - p.damping_per_mass * spool.velocity
    }

    pub(super) fn guards(&self, t: f64, spool: SpoolState) -> [f64; GUARDS] {
        let input = self.input(t, spool);
        let room = self.parameters.travel - self.play.output(input).abs();
        let mut guards = [1.0; GUARDS];
        guards[..LIMIT].copy_from_slice(&self.play.guards(input, self.rate(t, spool)));
        guards[LIMIT] = if self.limited { -room } else { room };
        guards
    }

    pub(super) fn cross(&mut self, guard: usize, t: f64, spool: SpoolState) {
        if guard == LIMIT {
            self.limited = !self.limited;
        } else {
            self.play.turn(self.input(t, spool));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RISING: usize = 0;
    const FALLING: usize = 1;

    fn thesis() -> Empirical {
        Empirical::new(EmpiricalParameters {
            travel_per_count: 1e-3 / 2048.0,
            amplifier_gain: 1.0,
            saturation: 1e-3,
            stiffness_per_mass: 36_000.0,
            damping_per_mass: 100.0,
            play: Play::held(0.05e-3, 0.0),
            dither: Dither { amplitude: 0.0, frequency_hz: 50.0, phase_cycles: 0.0 },
            travel: 1e-3,
        })
    }

    #[test]
    fn at_its_command_and_at_rest_the_spool_stays() {
        let mut empirical = thesis();
        empirical.follow(1024.0);
        assert_eq!(empirical.acceleration(SpoolState { position: 0.5e-3, velocity: 0.0 }), 0.0);
        assert_eq!(empirical.acceleration(SpoolState::default()), 36_000.0 * 0.5e-3);
    }

    #[test]
    fn the_valve_sees_the_position_less_the_slack() {
        let mut empirical = thesis();
        empirical.cross(RISING, 0.0, SpoolState { position: 0.05e-3, velocity: 1.0 });
        let spool = SpoolState { position: 0.3e-3, velocity: 1.0 };
        assert!((empirical.position(0.0, spool) - 0.25e-3).abs() < 1e-18);
    }

    #[test]
    fn only_the_output_is_limited_and_not_the_memory_of_the_play() {
        let mut empirical = thesis();
        empirical.cross(RISING, 0.0, SpoolState { position: 0.05e-3, velocity: 1.0 });
        let beyond = SpoolState { position: 1.2e-3, velocity: 1.0 };
        assert!(empirical.guards(0.0, beyond)[LIMIT] < 0.0);
        empirical.cross(LIMIT, 0.0, beyond);
        assert_eq!(empirical.position(0.0, beyond), 1e-3);
        empirical.cross(FALLING, 0.0, beyond);
        let back = SpoolState { position: 1.1e-3, velocity: -1.0 };
        assert!(empirical.guards(0.0, back)[FALLING] >= 0.0, "held at 1.15 mm, beyond the limit");
    }
}
