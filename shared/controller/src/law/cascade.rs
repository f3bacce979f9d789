//! A law on a model of its drive: observers, a learned load, a way, a loop of the force.
//!
//! ```text
//! sample -> motion -> flow -> load -> plan: way or rest -> force -> valve -> command
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`air`] | the force of the pressures, and what motion and flow make of it |
//! | [`motion`] | place, speed, and the force that stands against them |
//! | [`flow`] | what the model of the flow misses |
//! | [`load`] | mass, friction and standing force, learned while it moves |
//! | [`way`] | from any motion to rest at a target |
//! | [`force`] | the rate of the force that keeps the load on its way |
//! | [`valve`] | the command for that rate |
//! | `number` | products, quotients and roots |
//!
//! Units are counts of the encoder, samples, the supply pressure, and the force of that on area 1; a number in 2^-16 is Q16. What it
//! knows of its drive is in its parameters, which `pneudrive-sim` makes of a rig file.
//!
//! A new setpoint begins a way from the motion that there is, and so does a valve that has been short of what is asked for 8 ms; a
//! profile is followed as it comes. A load that stands at the end of its way, or creeps within 40 um of its target, rests: its
//! force stays within 0.35 of the stiction of where it came to rest, goes to the middle of that band, or beyond 20 um at 125 m/s^3
//! of the mass for each mm. So a load at rest is held by its dry friction, whatever error is left.
//!
//! Friction that gives way like a spring would be shaken for ever. A load that turns four times after the end of its way, or creeps at
//! rest, has such bristles: from then on its friction keeps its sign at the end of a way, it rests as soon as it is slow, and its rest
//! is damped by 65/s of the mass. At the ninth turn it rests wherever it is. What gets away from there three times by 0.9 mm is dry after all.

pub mod air;
pub mod flow;
pub mod force;
pub mod load;
pub mod motion;
mod number;
pub mod valve;
pub mod way;

use super::{ControlLaw, LawConfig, Measured, Reference};
use crate::fixed::quotient;
use crate::parameters::{Parameters, id};
use crate::profile::Point;
use air::Air;
use flow::Flow;
use load::Load;
use motion::Motion;
use number::{product, ratio, within};
use valve::Valve;
use way::{Limits, Way};

/// A load that turns more often than this after the end of its way is let rest where it is.
const MOST_TURNS: u32 = 8;

/// What it knows of its drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    air: air::Constants,
    motion: motion::Constants,
    flow: flow::Constants,
    load: load::Constants,
    force: force::Constants,
    valve: valve::Constants,
    rest: Rest,
    /// Speed and acceleration of its own ways, Q16; the part of the flow for their jerk, Q16; their shortest time, samples.
    way: [i32; 3],
    shortest: u32,
    /// 8 ms, samples, and 20 mm/s, Q16: a way is late.
    late: u32,
    under_way: i32,
}

/// When a load rests, and what holds it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Rest {
    /// 6 ms, samples.
    still: u32,
    /// 5 mm/s, Q16.
    slow: i32,
    /// 40, 20 and 60 um, counts.
    near: u32,
    close: u32,
    slipped: u32,
    /// On bristles: 3 and 8 mm/s, Q16; 0.3 and 0.9 mm and 15 um, counts; 10 and 20 ms, samples; 65/s, Q16 a sample.
    turning: i32,
    creeping: i32,
    at_target: u32,
    away: u32,
    crept: u32,
    asleep: u32,
    settled: u32,
    damper: i32,
    /// Force a sample (Q24) for a count of error, Q8; for a force off the middle of the band, Q30.
    pull: i32,
    ease: i32,
    /// A rate that is not worth a move of the valve, Q24 a sample.
    least: i32,
}

/// What the load does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// At rest.
    Rest {
        /// The force that holds it, and that at which it came to rest, Q24.
        held: i32,
        /// The latter.
        at: i32,
    },
    /// On a way of its own, or at its end until it stands.
    Way,
    /// On that of a profile.
    Profile,
}

/// What it remembers from sample to sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cascade {
    /// Whether it has seen a sample.
    begun: bool,
    target: i32,
    /// Where the load came to rest, counts.
    stood: i32,
    phase: Phase,
    way: Way,
    reference: Point,
    wanted: i32,
    /// Samples for which the valve has been short, and for which the load has rested.
    short: u32,
    rested: u32,
    /// Turns after the end of a way, and the sign of the last; the sign of the way.
    turns: u32,
    turned: i32,
    side: i32,
    /// Whether friction gives way like a spring, and how often a load got away from there.
    elastic: bool,
    lost: u32,
    motion: Motion,
    flow: Flow,
    load: Load,
    air: Air,
    valve: Valve,
}

impl Default for Cascade {
    fn default() -> Cascade {
        Cascade {
            begun: false,
            target: 0,
            stood: 0,
            phase: Phase::Rest { held: 0, at: 0 },
            way: Way::default(),
            reference: Point::default(),
            wanted: 0,
            short: 0,
            rested: 0,
            turns: 0,
            turned: 0,
            side: 0,
            elastic: false,
            lost: 0,
            motion: Motion::default(),
            flow: Flow::default(),
            load: Load::default(),
            air: Air::default(),
            valve: Valve::default(),
        }
    }
}

impl Settings {
    pub(crate) fn of(parameters: &Parameters) -> Settings {
        let get = |id| parameters.scalar(id);
        let period_us = get(id::PERIOD_US).unsigned_abs();
        let count_pm = u64::from(get(id::ENCODER_PM_PER_COUNT).unsigned_abs());
        // A m/s, counts a sample in Q16: up to 10^5 us times 10^6.
        let speed = quotient((u64::from(period_us) * 1_000_000) << 16, count_pm).clamp(1, 1 << 30) as i32;
        let air = air::Constants::of(parameters);
        let load = load::Constants::of(parameters, period_us, speed);
        let dead_time = get(id::CASCADE_DEAD_TIME).unsigned_abs();
        Settings {
            motion: motion::Constants::of(parameters, &load, period_us, speed),
            flow: flow::Constants::of(parameters),
            force: force::Constants::of(parameters, &air),
            valve: valve::Constants::of(parameters),
            rest: Rest::of(parameters, period_us, count_pm, speed),
            way: [get(id::CASCADE_WAY_SPEED), get(id::CASCADE_WAY_ACCELERATION), get(id::CASCADE_WAY_FLOW)],
            shortest: ((2 * dead_time) >> 16).saturating_add(1).max(6),
            late: samples(8000, period_us),
            under_way: product(speed, 1311, 16),
            air,
            load,
        }
    }

    /// The limits of a way about a place (counts): the jerk is that of the flow at three fifths of the supply.
    fn limits(&self, x: i32) -> Limits {
        const MIDDLE: i32 = air::ONE / 5 * 3;
        let air = self.air.at(x, [MIDDLE; 2]);
        let rate = product(air.extend.min(air.retract), self.way[2], 16);
        let [speed, acceleration, _] = self.way;
        Limits {
            speed,
            acceleration,
            jerk: product(rate, self.load.acceleration, 16).max(1),
            shortest: self.shortest,
        }
    }
}

/// Whole samples in microseconds.
fn samples(us: u32, period_us: u32) -> u32 {
    us.checked_div(period_us).unwrap_or(0)
}

impl Rest {
    fn of(parameters: &Parameters, period_us: u32, count_pm: u64, speed: i32) -> Rest {
        let counts = |um: u64| quotient(um * 1_000_000, count_pm) as u32;
        let period = u64::from(period_us);
        let acceleration = u64::from(parameters.scalar(id::CASCADE_ACCELERATION).unsigned_abs());
        let most = |value: u64| value.min(1 << 30) as i32;
        Rest {
            still: samples(6000, period_us).max(4),
            slow: product(speed, 328, 16),
            near: counts(40).max(1),
            close: counts(20),
            slipped: counts(60).max(2),
            turning: product(speed, 197, 16),
            creeping: product(speed, 524, 16),
            at_target: counts(300),
            away: counts(900),
            crept: counts(15).saturating_add(1),
            asleep: samples(10_000, period_us),
            settled: samples(20_000, period_us),
            damper: most(quotient(4260 * period, 1000)),
            // 1.25e5/s^3 T^3/A in Q32.
            pull: most(ratio(35 * period * period * period, acceleration)),
            ease: most(ratio(period << 30, 50_000)),
            least: most(quotient(604 * period, 1000)),
        }
    }
}

impl Cascade {
    /// The motion observer: place, speed, disturbance.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// What is learned of the load.
    #[must_use]
    pub fn load(&self) -> &Load {
        &self.load
    }

    /// What the model of the flow misses, force a sample in Q24.
    #[must_use]
    pub fn unknown_rate(&self) -> i32 {
        self.flow.unknown()
    }

    /// Where the load shall be, and the force wanted for it, Q24.
    #[must_use]
    pub fn reference(&self) -> (Point, i32) {
        (self.reference, self.wanted)
    }

    /// What the load does.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    fn begin_at(&mut self, settings: &Settings, count: i32, force: i32) {
        self.load = Load::new(&settings.load);
        self.motion = Motion::new(count, force, &self.load, settings.load.stiction);
        self.flow = Flow::new(force);
        (self.begun, self.target, self.stood) = (true, count, count);
        self.phase = Phase::Rest { held: force, at: force };
    }

    /// Both observers, and the air for what follows.
    fn observe(&mut self, settings: &Settings, count: i32, pressures: [i32; 2], force: i32) {
        let step = self.motion.observe(&settings.motion, &settings.load, &self.load, count, force);
        let rate = settings.valve.rate(&self.air, self.valve.mean);
        let spring = product(self.air.stiffness, self.motion.v, 22);
        self.flow.observe(&settings.flow, force, rate.saturating_sub(spring));
        self.air = settings.air.at((self.motion.x >> 16) as i32, pressures);
        if self.motion.stuck {
            self.load.forget();
        } else {
            self.load.learn(&settings.load, step, self.motion.v, force);
        }
    }

    /// What the load shall do from this sample on.
    fn plan(&mut self, settings: &Settings, count: i32, reference: &Reference, force: i32) {
        let target = count.saturating_add(reference.error);
        let new = core::mem::replace(&mut self.target, target) != target;
        if new {
            self.lost = 0;
        }
        if reference.point.is_some() {
            self.phase = Phase::Profile;
            return;
        }
        let error = reference.error.unsigned_abs();
        match self.phase {
            Phase::Profile if self.has_been_led(&settings.rest, target) => {
                (self.phase, self.way) = (Phase::Way, Way::at_rest(motion::middle(target)));
            }
            Phase::Profile => self.set_off(settings, force),
            _ if new && self.motion.stuck && error < settings.rest.near => self.rest(count, force),
            _ if new => self.set_off(settings, force),
            Phase::Way => {
                self.way.advance();
                self.count_turns(&settings.rest);
                if self.has_come(&settings.rest, error) {
                    self.rest(count, force);
                } else if self.short > settings.late && self.motion.v.saturating_abs() > settings.under_way {
                    self.set_off(settings, force);
                }
            }
            Phase::Rest { .. }
                if !self.elastic
                    && self.motion.still == 0
                    && count.abs_diff(self.stood) > settings.rest.slipped =>
            {
                self.motion.stuck = false;
                self.set_off(settings, force);
            }
            Phase::Rest { .. } if self.elastic && error > settings.rest.away => {
                self.lost = self.lost.saturating_add(1);
                (self.elastic, self.motion.stuck) = (self.lost < 3, false);
                self.set_off(settings, force);
            }
            Phase::Rest { held, at } => {
                self.rested = self.rested.saturating_add(1);
                self.motion.stuck = !self.elastic || self.motion.still > settings.rest.asleep;
                // Dry friction does not creep.
                let crept = count.abs_diff(self.stood) > settings.rest.crept;
                self.elastic |= crept && self.rested > settings.rest.settled;
                let held = self.eased(settings, reference.error, held, at);
                self.phase = Phase::Rest { held, at };
            }
        }
    }

    /// Whether a profile has come to rest at the target, and was not cut short.
    fn has_been_led(&self, rest: &Rest, target: i32) -> bool {
        let left = motion::middle(target).saturating_sub(self.reference.x).unsigned_abs() >> 16;
        left < u64::from(rest.near) && self.reference.v.saturating_abs() < rest.slow
    }

    /// Turns after the end of a way are those of a load on a spring.
    fn count_turns(&mut self, rest: &Rest) {
        let sign = self.motion.v.signum();
        if self.way.over().is_some() && self.motion.v.saturating_abs() > rest.turning && sign != self.turned {
            (self.turns, self.turned) = (self.turns.saturating_add(1), sign);
            self.elastic |= self.turns > 3 && self.lost < 3;
        }
    }

    /// Whether a load at the end of its way stands, or creeps where it shall be.
    fn has_come(&self, rest: &Rest, error: u32) -> bool {
        let (slow, near, wait) = match self.elastic {
            true => (rest.creeping, rest.at_target, 0),
            false => (rest.slow, rest.near, rest.still),
        };
        self.way.over().is_some_and(|over| {
            let creeps = over > wait && self.motion.v.saturating_abs() < slow && error < near;
            self.motion.still >= rest.still || creeps || self.turns > MOST_TURNS
        })
    }

    fn rest(&mut self, count: i32, force: i32) {
        (self.motion.stuck, self.stood, self.rested) = (true, count, 0);
        self.phase = Phase::Rest { held: force, at: force };
    }

    /// A way from the motion that there is.
    fn set_off(&mut self, settings: &Settings, force: i32) {
        let a = self.motion.acceleration(&settings.load, &self.load, force);
        let from = Point { x: self.motion.x, v: self.motion.v, a, j: 0 };
        let target = motion::middle(self.target);
        let middle = (self.motion.x >> 17).wrapping_add(target >> 17) as i32;
        self.way = Way::to(target, from, &settings.limits(middle));
        (self.phase, self.short) = (Phase::Way, 0);
        (self.turns, self.turned) = (0, self.motion.v.signum());
    }

    /// The force that holds a load at rest, a sample later.
    fn eased(&self, settings: &Settings, error: i32, held: i32, at: i32) -> i32 {
        let rest = &settings.rest;
        let share = if self.elastic { 3 << 16 } else { 22_938 };
        let band = product(product(settings.load.stiction, self.load.friction, 16), share, 16);
        let change = if error.unsigned_abs() > rest.close {
            product(rest.pull, within(error, 1 << 15), 8)
        } else if self.elastic {
            0
        } else {
            product(self.load.standing.saturating_sub(held), rest.ease, 30)
        };
        held.saturating_add(change).min(at.saturating_add(band)).max(at.saturating_sub(band))
    }

    /// The rate of the force (Q24 a sample), and below which one the valve stays shut.
    fn rate(&mut self, settings: &Settings, reference: &Reference, force: i32) -> (i32, i32) {
        let loops = &settings.force;
        let (rate, least) = match self.phase {
            Phase::Rest { held, .. } if self.elastic => {
                let slowed = product(self.motion.v, settings.rest.damper, 16);
                self.wanted = held.saturating_sub(product(self.load.inertia(&settings.load), slowed, 16));
                let spring = product(self.air.stiffness, self.motion.v, 22);
                (loops.damping(self.wanted, force).saturating_add(spring), settings.rest.least)
            }
            Phase::Rest { held, .. } => {
                self.wanted = held;
                (loops.holding(held, force), settings.rest.least)
            }
            Phase::Way | Phase::Profile => {
                let (now, soon) = match reference.point {
                    Some(point) => (point, point.later(loops.dead_time)),
                    None => (self.way.now(), self.way.later(loops.dead_time)),
                };
                let (load, of_load) = (&self.load, &settings.load);
                let seen = force::Seen { load, of_load, motion: &self.motion, air: &self.air, force };
                // A profile that turns leaves a stuck load behind: it is pushed to where it breaks away.
                let breaks_away = self.phase == Phase::Profile && self.motion.stuck;
                if soon.v != 0 {
                    self.side = soon.v.signum();
                }
                let sign = if self.elastic { self.side } else { soon.v.signum() };
                self.wanted = loops.wanted(&seen, &now, sign, breaks_away);
                self.reference = now;
                (loops.rate(&seen, &now, &soon, self.wanted), 0)
            }
        };
        (rate.saturating_sub(self.flow.unknown()), least)
    }
}

impl ControlLaw for Cascade {
    type Settings = Settings;

    fn pushes_beyond(settings: &Settings) -> u32 {
        settings.rest.away
    }

    #[inline(never)]
    fn demand(
        &mut self,
        config: &LawConfig,
        settings: &Settings,
        measured: Measured,
        reference: Reference,
    ) -> i32 {
        let count = measured.motion.position;
        let pressures = measured.pressures.map(|raw| settings.air.pressure(raw));
        let force = settings.air.force(pressures);
        if !self.begun {
            self.begin_at(settings, count, force);
        }
        self.observe(settings, count, pressures, force);
        self.plan(settings, count, &reference, force);
        let (rate, least) = self.rate(settings, &reference, force);
        let is_short = settings.valve.is_short(&self.air, rate);
        self.short = if is_short { self.short.saturating_add(1) } else { 0 };
        let place = settings.valve.opening(&self.air, rate, least);
        self.valve.drive(&settings.valve, place).saturating_add(measured.null(config))
    }
}
