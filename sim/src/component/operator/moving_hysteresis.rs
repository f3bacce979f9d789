//! The hysteresis of a coil whose command moves all the time: play on the command of the continuous
//! controller plus dither (EQUATIONS section 11 rules 3 and 8).
//!
//! ```text
//! r = gain X_c                         what the amplifier is asked for: a function of the state
//! u = clamp(r, +-limit) + dither       du/dt = r' + dither', or dither' alone where r is limited
//! s = play(u)
//! ```
//!
//! There are two modes, each with a guard: the branch of the play, and whether the amplifier is at its limit, where u
//! has a kink. A driven branch ends at du/dt = 0, which needs r' and so the flows. A held branch needs only the
//! state. Where r or r' jumps, rule 3 decides again.

use crate::component::dither::Dither;
use crate::component::play::{self, Branch, Motion, Play};

/// Where the amplifier is in its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Range {
    Linear,
    AtLow,
    AtHigh,
}

/// Guards: those of the play, then the range of the amplifier.
pub(crate) const GUARDS: usize = RANGE + 1;
const RANGE: usize = play::GUARDS;

/// Play on a moving command plus dither, all in m of spool travel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingHysteresis {
    play: Play,
    dither: Dither,
    limit: f64,
    range: Range,
    /// r, m.
    demand: f64,
    /// r', m/s.
    demand_rate: f64,
}

impl MovingHysteresis {
    /// At rest as the play is, before its first command (EQUATIONS section 11 rule 4).
    pub fn new(play: Play, dither: Dither, limit: f64) -> MovingHysteresis {
        MovingHysteresis { play, dither, limit, range: Range::Linear, demand: 0.0, demand_rate: 0.0 }
    }

    fn command(&self) -> f64 {
        match self.range {
            Range::Linear => self.demand,
            Range::AtLow => -self.limit,
            Range::AtHigh => self.limit,
        }
    }

    fn command_rate(&self) -> f64 {
        if self.range == Range::Linear { self.demand_rate } else { 0.0 }
    }

    /// u.
    fn input(&self, t: f64) -> f64 {
        self.command() + self.dither.value(t)
    }

    /// s.
    pub fn output(&self, t: f64) -> f64 {
        self.play.output(self.input(t))
    }

    /// Which way u moves just after `t`. A command at rest leaves that to the dither, which knows its
    /// extrema.
    fn motion(&self, t: f64) -> Motion {
        match self.command_rate() {
            0.0 => self.dither.direction(t),
            rate => Motion::of_rate(rate + self.dither.rate(t)),
        }
    }

    /// The demand has moved on to `demand` within the present modes.
    pub fn follow(&mut self, demand: f64) {
        self.demand = demand;
    }

    /// The rate of the demand that it follows.
    pub fn follow_rate(&mut self, rate: f64) {
        self.demand_rate = rate;
    }

    /// Whether the guards ask for the rate of the demand.
    pub fn needs_rate(&self) -> bool {
        let driven = !matches!(self.play.branch(), Branch::Held(_));
        driven && self.range == Range::Linear && self.play.half_width() > 0.0
    }

    /// The demand, its rate or both jump at `t`: rule 3.
    pub fn jump(&mut self, t: f64, demand: f64, rate: f64) {
        let before = self.input(t);
        (self.demand, self.demand_rate) = (demand, rate);
        self.range = match demand {
            _ if demand > self.limit => Range::AtHigh,
            _ if demand < -self.limit => Range::AtLow,
            _ => Range::Linear,
        };
        self.go_on(t, before);
    }

    /// The branch after `t`, for an input that came from `before`.
    fn go_on(&mut self, t: f64, before: f64) {
        let (u, motion) = (self.input(t), self.motion(t));
        let stays = match self.play.branch() {
            Branch::DrivenUp => motion == Motion::Rising,
            Branch::DrivenDown => motion == Motion::Falling,
            Branch::Held(_) => false,
        };
        if u != before || !stays {
            self.play.jump(before, u, motion);
        }
    }

    /// Not negative as long as the modes hold.
    pub fn guards(&self, t: f64) -> [f64; GUARDS] {
        let rate = self.command_rate() + self.dither.rate(t);
        let room = match self.range {
            Range::Linear => self.limit - self.demand.abs(),
            Range::AtLow => -self.limit - self.demand,
            Range::AtHigh => self.demand - self.limit,
        };
        let [rising, falling] = self.play.guards(self.input(t), rate);
        [rising, falling, room]
    }

    /// Changes the mode whose guard has become negative at `t`.
    pub fn cross(&mut self, guard: usize, t: f64) {
        if guard != RANGE {
            self.play.turn(self.input(t));
            return;
        }
        self.range = match self.range {
            Range::Linear if self.demand > 0.0 => Range::AtHigh,
            Range::Linear => Range::AtLow,
            Range::AtLow | Range::AtHigh => Range::Linear,
        };
        // u goes through the kink without a jump.
        self.go_on(t, self.input(t));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FALLING: usize = 1;
    const STILL: Dither = Dither { amplitude: 0.0, frequency_hz: 50.0, phase_cycles: 0.0 };
    const DITHER: Dither = Dither { amplitude: 0.2, ..STILL };

    fn driven_to(demand: f64, rate: f64, dither: Dither) -> MovingHysteresis {
        let mut hysteresis = MovingHysteresis::new(Play::held(0.05, 0.0), dither, 1.0);
        hysteresis.jump(0.0, demand, rate);
        hysteresis
    }

    #[test]
    fn a_rising_command_drives_the_output_until_it_turns() {
        let mut hysteresis = driven_to(0.3, 2.0, STILL);
        hysteresis.follow(0.4);
        assert!((hysteresis.output(0.1) - 0.35).abs() < 1e-15);
        hysteresis.follow_rate(-1.0);
        assert!(hysteresis.guards(0.1)[FALLING] < 0.0);
        hysteresis.cross(FALLING, 0.1);
        hysteresis.follow(0.33);
        assert!((hysteresis.output(0.1) - 0.35).abs() < 1e-15, "held within the slack");
        hysteresis.follow(0.299);
        assert!(hysteresis.guards(0.1)[FALLING] < 0.0, "the slack is used up");
    }

    #[test]
    fn a_command_that_jumps_back_while_it_drives_leaves_the_output_where_it_was() {
        let mut hysteresis = driven_to(0.3, 2.0, STILL);
        hysteresis.jump(0.1, 0.22, 2.0);
        assert!((hysteresis.output(0.1) - 0.25).abs() < 1e-15);
        assert!(!hysteresis.needs_rate(), "it has to rise by 0.08 before it drives again");
    }

    #[test]
    fn after_a_jump_the_motion_of_the_command_and_the_dither_together_decides() {
        let slope = DITHER.rate(0.0);
        assert_eq!(driven_to(0.3, -0.9 * slope, DITHER).play.branch(), Branch::DrivenUp);
        assert_eq!(driven_to(0.3, -1.1 * slope, DITHER).play.branch(), Branch::Held(0.25));
    }

    /// The load sticks and there is no dither: du/dt is 0, not small.
    #[test]
    fn a_command_at_rest_without_dither_is_held() {
        let hysteresis = driven_to(0.3, 0.0, STILL);
        assert_eq!(hysteresis.play.branch(), Branch::Held(0.25));
        assert!(hysteresis.guards(0.1).iter().all(|guard| *guard >= -1e-15));
    }

    /// EQUATIONS section 11 rule 3: the second derivative decides, not a rounded cosine.
    #[test]
    fn a_command_that_jumps_at_a_crest_of_the_dither_and_rests_is_held() {
        let mut hysteresis = MovingHysteresis::new(Play::held(0.05, 0.0), DITHER, 1.0);
        hysteresis.jump(0.085, 0.3, 0.0);
        assert_eq!(hysteresis.play.branch(), Branch::Held(0.3 + 0.2 - 0.05));
    }

    #[test]
    fn at_the_limit_of_the_amplifier_the_dither_alone_moves_the_output() {
        let mut hysteresis = driven_to(0.999, 50.0, DITHER);
        hysteresis.follow(1.0 + 1e-15);
        let falling = 0.007;
        assert!(hysteresis.guards(falling)[FALLING] > 0.0, "the command outweighs the dither");
        assert!(hysteresis.guards(falling)[RANGE] < 0.0);
        hysteresis.cross(RANGE, falling);
        assert!(matches!(hysteresis.play.branch(), Branch::Held(_)), "now the dither decides: it falls");
        hysteresis.follow(1.7);
        assert_eq!(hysteresis.input(falling), 1.0 + DITHER.value(falling));
        assert!(!hysteresis.needs_rate());
    }

    #[test]
    fn a_demand_that_jumps_beyond_the_limit_and_back_is_limited_in_between() {
        let mut hysteresis = driven_to(-3.0, 50.0, STILL);
        assert_eq!(hysteresis.output(0.0), -0.95);
        assert!(hysteresis.guards(0.0)[RANGE] > 0.0);
        hysteresis.jump(0.1, 0.0, 0.0);
        assert_eq!(hysteresis.output(0.1), -0.05);
    }
}
