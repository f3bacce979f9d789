//! The law "cascade" in real numbers, written from its equations alone, in the units of its parameters; a module for each of the
//! law's.

mod air;
mod constants;
mod lag;
mod load;
mod observers;
mod plan;
mod sensors;
mod spring;
mod squares;
mod stepper;
mod trajectory;
mod valve;

use air::Air;
use constants::Constants;
pub use lag::Lag;
pub use load::Load;
use observers::Flow;
pub use observers::Motion;
use plan::{Plan, Seen};
use pneudrive_controller::Parameters;
use sensors::Hidden;
use valve::{Valve, opening};

pub struct Oracle {
    c: Constants,
    begun: bool,
    pub motion: Motion,
    pub load: Load,
    pub lag: Lag,
    for_load: bool,
    flow: Flow,
    air: Air,
    hidden: Hidden,
    plan: Plan,
    valve: Valve,
}

impl Oracle {
    pub fn of(parameters: &Parameters) -> Oracle {
        Oracle {
            c: Constants::of(parameters),
            begun: false,
            motion: Motion::default(),
            load: Load::default(),
            lag: Lag::default(),
            for_load: false,
            flow: Flow::default(),
            air: Air::default(),
            hidden: Hidden::default(),
            plan: Plan::new(0, 0.0),
            valve: Valve::default(),
        }
    }

    pub fn step(&mut self, count: i32, raw: [i16; 2], spool: i16, target: i32) -> i16 {
        let c = &self.c;
        self.valve.sense(c, spool);
        let p = raw.map(|raw| (c.offset + c.gain * f64::from(raw)).max(0.5 * c.exhaust));
        let open = c.rate_at(&self.air, self.valve.mean);
        let hidden = self.hidden.take(c, open - self.air.stiffness * self.motion.v);
        let force = p[0] - c.ratio * p[1] - c.exhaust * (1.0 - c.ratio) + hidden;
        if !self.begun {
            self.begun = true;
            self.motion = Motion::new(c, count, force);
            self.flow = Flow::new(force);
            self.plan = Plan::new(count, force);
        }
        self.for_load = !self.for_load;
        let step = self.motion.observe(c, &self.load, count, force);
        let missed = self.flow.observe(c, force, open - self.air.stiffness * self.motion.v);
        self.lag.take(c, self.hidden.shown(c, open));
        self.air = c.air(self.motion.x, p);
        if self.motion.stuck {
            self.load.forget();
        } else {
            self.load.learn(c, step, self.motion.v, force, self.for_load);
        }
        let mut seen = Seen { c, motion: &mut self.motion, load: &mut self.load, count, force };
        self.plan.go_on(&mut seen, target);
        if !seen.motion.stuck && !self.for_load {
            self.lag.learn(c, missed);
        }
        let (rate, least) = self.plan.rate(&seen, &self.air, &self.flow, self.lag.dead_time(c));
        self.plan.is_short(&self.air, rate);
        let wanted = opening(c, &self.air, rate, least);
        self.valve.drive(c, self.lag.pace, wanted)
    }

    /// What was commanded: where that takes the spool until the next sample.
    pub fn commanded(&mut self, counts: i16) {
        self.valve.commanded(&self.c, self.lag.pace, counts);
    }
}
