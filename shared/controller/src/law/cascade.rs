//! A model-based law: observers, a learned load, a trajectory, a force loop.
//!
//! ```text
//! sample -> motion -> flow -> load, lag -> plan: trajectory, profile or rest -> force -> valve -> command
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`air`] | the force of the pressures, and what motion and flow make of it |
//! | [`doubt`] | what ends a run: something learned at its bound, a pressure that cannot be |
//! | [`motion`] | place, speed, and the force that stands against them |
//! | [`flow`] | what the model of the flow misses |
//! | [`load`] | mass, friction and standing force, learned while it moves |
//! | [`lag`] | how much slower than by the rig file the valve is, learned while it moves |
//! | [`trajectory`] | from any motion to rest at a target, or from a deviation to a profile |
//! | [`force`] | the rate of the force that keeps the load on its trajectory |
//! | `begin`, [`rest`] | how a run begins; when a load rests, and the force that holds it |
//! | [`kept`] | what is kept of what a run has learned, for the next one |
//! | [`sensor`] | the force that pressure sensors with a lag do not show yet |
//! | [`valve`] | the command for that rate |
//! | `land`, `tubes` | how far a land before a port opens, and what tubes leave of the flow |
//! | `spring`, `transition` | a spool on a spring with friction, that is measured; how a spool moves |
//! | `stepper` | a spool that goes a step a sample |
//! | `settings`, [`known`] | what the parameters say of the drive; what is known at a sample, to be looked at |
//! | `number`, `squares` | products, quotients and roots; least squares |
//!
//! Units are counts of the encoder, samples, the supply pressure, and the force of that on area 1; a number in 2^-16 is Q16. What it
//! knows of its drive is in its parameters, which `pneudrive-sim` makes of a rig file.
//!
//! A trajectory begins from the motion that there is: at a new setpoint, and when the valve has been short of what is asked for 8 ms. A
//! load above 100 mm/s that would pass its target is stopped first. The second sample of a run tells whether the load moves as the run
//! begins. A profile is followed as it comes. Where it begins, where it jumps and where the valve has been short, a trajectory of the
//! deviation joins it. A load that stands at the end of its trajectory, or creeps within 40 um of its target, rests.

// An index that may lie outside is a panic, and whether a compiler sees that it never does differs from image to image.
#![cfg_attr(not(test), deny(clippy::indexing_slicing))]

pub mod air;
mod begin;
pub mod doubt;
pub mod flow;
pub mod force;
pub mod kept;
pub mod known;
pub mod lag;
mod land;
pub mod load;
pub mod motion;
mod number;
pub mod rest;
pub mod sensor;
mod settings;
mod spring;
mod squares;
mod stepper;
pub mod trajectory;
mod transition;
mod tubes;
pub mod valve;

use super::{ControlLaw, LawConfig, Measured, Reference};
use crate::fault::Fault;
use crate::profile::Point;
use air::Air;
use begin::Begun;
use doubt::Doubt;
use flow::Flow;
use lag::Lag;
use load::Load;
use motion::Motion;
use number::product;
use rest::Rest;
use sensor::Hidden;
pub use settings::Settings;
use trajectory::Trajectory;
use valve::Valve;

/// 0.4 in Q16: the part of the running friction that a load at rest begins with.
const LANDED: i32 = 26_214;

/// What the load does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// At rest, held by this force, about that which would hold it without friction, Q24.
    Rest { held: i32, centre: i32 },
    /// On a trajectory of its own, or at its end until it stands.
    Trajectory,
    /// On that of a profile.
    Profile,
}

/// What it remembers from sample to sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cascade {
    /// The first samples, until it is known whether the load moved as the run began.
    begun: Begun,
    target: i32,
    phase: Phase,
    trajectory: Trajectory,
    /// Whether it only stops the load.
    stops: bool,
    /// From the motion that there was to that of a profile, and the point of the profile at the sample before.
    joining: Trajectory,
    led: Point,
    reference: Point,
    /// The force by the pressures and the wanted one, Q24: for who looks.
    forces: [i32; 2],
    /// Samples for which the valve has been short.
    short: u32,
    /// The sign of its velocity.
    side: i32,
    rest: Rest,
    motion: Motion,
    flow: Flow,
    load: Load,
    lag: Lag,
    /// Whether this sample is one for the load, or for the valve.
    for_load: bool,
    air: Air,
    hidden: Hidden,
    valve: Valve,
    doubt: Doubt,
}

impl Default for Cascade {
    fn default() -> Cascade {
        Cascade {
            begun: Begun::No,
            target: 0,
            phase: Phase::Rest { held: 0, centre: 0 },
            trajectory: Trajectory::default(),
            stops: false,
            joining: Trajectory::default(),
            led: Point::default(),
            reference: Point::default(),
            forces: [0; 2],
            short: 0,
            side: 0,
            rest: Rest::default(),
            motion: Motion::default(),
            flow: Flow::default(),
            load: Load::default(),
            lag: Lag::default(),
            for_load: false,
            air: Air::default(),
            hidden: Hidden::default(),
            valve: Valve::default(),
            doubt: Doubt::default(),
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

    /// What is learned of the valve.
    #[must_use]
    pub fn lag(&self) -> &Lag {
        &self.lag
    }

    /// The force, of which sensors with a lag show an older one.
    fn unhidden(&mut self, settings: &Settings, shown: i32) -> i32 {
        if settings.sensor.are_swift() {
            return shown;
        }
        let rate = settings.valve.rate(&self.air, self.valve.mean);
        let spring = product(self.air.stiffness, self.motion.v, 22);
        shown.saturating_add(self.hidden.take(&settings.sensor, rate.saturating_sub(spring)))
    }

    /// Both observers, and the air for what follows; returns the flow observer's error.
    fn observe(
        &mut self,
        settings: &Settings,
        count: i32,
        raw: [i16; 2],
        pressures: [i32; 2],
        force: i32,
    ) -> i32 {
        self.for_load = !self.for_load;
        let step = self.motion.observe(&settings.motion, &settings.load, &self.load, count, force);
        let rate = settings.valve.rate(&self.air, self.valve.mean);
        let spring = product(self.air.stiffness, self.motion.v, 22);
        let missed = self.flow.observe(&settings.flow, force, rate.saturating_sub(spring));
        self.lag.take(&settings.lag, self.hidden.shown(&settings.sensor, rate));
        let seen = doubt::Seen { raw, pressures, force, count, step, air: &self.air };
        self.doubt.take(&settings.doubt, &seen, self.for_load);
        if !self.for_load {
            self.doubt.miss(&settings.doubt, self.flow.unknown(), &self.air);
            if !self.motion.stuck {
                let is_at_bound =
                    self.load.is_at_bound() || self.lag.is_at_bound() || self.motion.is_at_bound();
                self.doubt.stray(&settings.doubt, is_at_bound);
            }
        }
        let x = (self.motion.x >> 16) as i32;
        self.air = settings.air.at(x, pressures);
        if self.motion.stuck {
            self.load.forget();
        } else {
            if count <= settings.near_end || count >= settings.air.stroke.saturating_sub(settings.near_end) {
                self.load.lose();
            }
            self.load.learn(&settings.load, step, self.motion.v, force, self.for_load);
        }
        missed
    }

    /// What the load shall do from this sample on.
    fn plan(&mut self, settings: &Settings, count: i32, reference: &Reference, force: i32) {
        let target = count.saturating_add(reference.error);
        let new = core::mem::replace(&mut self.target, target) != target;
        if new {
            self.rest.aim();
            if matches!(self.phase, Phase::Rest { .. }) {
                self.load.may_be_exchanged();
            }
        }
        if let Some(point) = &reference.point {
            self.follow(settings, point, force);
            return;
        }
        let (of_rest, error) = (&settings.rest, reference.error.unsigned_abs());
        match self.phase {
            Phase::Profile if self.has_been_led(of_rest, target) => {
                (self.phase, self.short) = (Phase::Trajectory, 0);
                (self.trajectory, self.stops) = (Trajectory::at_rest(motion::middle(target)), false);
                self.rest.set_off(&self.motion);
            }
            Phase::Profile => self.set_off(settings, force),
            _ if new && self.motion.stuck && error < of_rest.near => {
                self.come_to_rest(settings, count, force)
            }
            _ if new => self.set_off(settings, force),
            Phase::Trajectory => {
                self.trajectory.advance();
                let over = self.trajectory.over();
                if over.is_some_and(|over| self.stops || over > of_rest.overdue) {
                    self.set_off(settings, force);
                } else if over.is_some_and(|over| self.rest.has_come(of_rest, &self.motion, over, error)) {
                    self.come_to_rest(settings, count, force);
                } else if self.short > settings.late && self.motion.v.saturating_abs() > settings.moving {
                    self.set_off(settings, force);
                }
            }
            Phase::Rest { held, centre } => {
                if self.rest.is_lost(of_rest, &mut self.motion, count, error) {
                    if self.motion.stuck {
                        self.motion.d = centre;
                    }
                    self.set_off(settings, force);
                } else {
                    let held = held.saturating_add(of_rest.pulled(reference.error));
                    let held = self.load.held(&settings.load, held, centre, 1 << 16);
                    self.phase = Phase::Rest { held, centre };
                }
            }
        }
    }

    /// A profile, joined by a trajectory of its own where it begins, where it jumps, and where the valve has not kept up with it.
    fn follow(&mut self, settings: &Settings, point: &Point, force: i32) {
        let led = core::mem::replace(&mut self.led, *point);
        let most = u64::from(settings.trajectory[1].unsigned_abs());
        let leaves = |is: i64, expected: i64| is.wrapping_sub(expected).unsigned_abs() > most;
        let jumps = leaves(point.x, led.x.wrapping_add(led.v.into()))
            || leaves(point.v.into(), i64::from(led.v) + i64::from(led.a));
        let is_late = self.short > settings.late && self.motion.v.saturating_abs() > settings.moving;
        self.joining.advance();
        if self.phase != Phase::Profile || jumps || is_late {
            let a = self.motion.acceleration(&settings.load, &self.load, force);
            let from = Point {
                x: self.motion.x.wrapping_sub(point.x),
                v: self.motion.v.saturating_sub(point.v),
                a: a.saturating_sub(point.a),
                j: 0,
            };
            let limits = settings.limits((self.motion.x >> 16) as i32, self.load.by_mass);
            (self.phase, self.short) = (Phase::Profile, 0);
            self.joining = Trajectory::slowing(0, from, &limits);
        }
    }

    /// Whether a profile has come to rest at the target, and was not cut short.
    fn has_been_led(&self, rest: &rest::Constants, target: i32) -> bool {
        let left = motion::middle(target).saturating_sub(self.reference.x).unsigned_abs() >> 16;
        left < u64::from(rest.near) && self.reference.v.saturating_abs() < rest.slow
    }

    fn come_to_rest(&mut self, settings: &Settings, count: i32, force: i32) {
        self.motion.stuck = true;
        self.rest.begin(count);
        let centre = match self.phase {
            Phase::Rest { centre, .. } => centre,
            // To a thousandth of the supply's: it is not known better.
            Phase::Trajectory | Phase::Profile => (self.load.standing.saturating_add(1 << 13) >> 14) << 14,
        };
        self.phase = Phase::Rest { held: self.load.held(&settings.load, force, centre, LANDED), centre };
    }

    /// A trajectory from the motion that there is.
    fn set_off(&mut self, settings: &Settings, force: i32) {
        let a = self.motion.acceleration(&settings.load, &self.load, force);
        let from = Point { x: self.motion.x, v: self.motion.v, a, j: 0 };
        let target = motion::middle(self.target);
        let middle = (self.motion.x >> 17).wrapping_add(target >> 17) as i32;
        let limits = settings.limits(middle, self.load.by_mass);
        let is_fast = from.v.saturating_abs() > settings.fast;
        let stop = if is_fast { Trajectory::braking(target, from, &limits) } else { None };
        self.stops = stop.is_some();
        self.trajectory = match (stop, self.phase) {
            (Some(stop), _) => stop,
            // It may have ended in motion.
            (None, Phase::Profile) => Trajectory::slowing(target, from, &limits),
            (None, Phase::Trajectory | Phase::Rest { .. }) => Trajectory::to(target, from, &limits),
        };
        (self.phase, self.short) = (Phase::Trajectory, 0);
        self.rest.set_off(&self.motion);
    }

    /// The speed along a profile two dead times later; that of one dead time later is `soon`, with what joins it.
    fn turning(&self, point: &Point, soon: i32) -> i32 {
        let [once, twice] = [1, 2].map(|times| point.later(self.lag.dead_time.saturating_mul(times)).v);
        twice.saturating_add(soon.saturating_sub(once))
    }

    /// The friction of the wanted force with a sign. A profile that turns leaves a stuck load behind, and so does a trajectory to a target that
    /// it has missed: it is pushed to where it breaks away.
    fn friction(&self, of_load: &load::Constants, sign: i32) -> i32 {
        let stiction = of_load.stiction;
        match self.phase {
            Phase::Profile if self.motion.stuck => sign.saturating_mul(stiction - (stiction >> 2)),
            _ if self.motion.stuck && self.rest.tries_again() => sign.saturating_mul(stiction),
            _ => self.load.slide(of_load, sign),
        }
    }

    /// The rate of the force (Q24 a sample), and below which one the valve stays shut.
    fn rate(&mut self, settings: &Settings, reference: &Reference, force: i32) -> (i32, i32) {
        let (loops, load, of_load) = (&settings.force, &self.load, &settings.load);
        let swift = self.lag.swift;
        match self.phase {
            Phase::Rest { held, .. } => {
                let slowed = product(load.inertia(of_load), settings.rest.slowed(self.motion.v), 16);
                let wanted = held.saturating_sub(slowed);
                self.forces = [force, wanted];
                let rate = loops.approach(wanted, force, swift);
                (if self.motion.stuck { rate >> 3 } else { rate }, settings.rest.least)
            }
            Phase::Trajectory | Phase::Profile => {
                let (now, soon) = match reference.point {
                    Some(point) => (
                        point.plus(self.joining.now()),
                        point.later(self.lag.dead_time).plus(self.joining.later(self.lag.dead_time)),
                    ),
                    None => (self.trajectory.now(), self.trajectory.later(self.lag.dead_time)),
                };
                let seen = force::Seen { load, of_load, motion: &self.motion, air: &self.air, force, swift };
                let turn = match reference.point {
                    Some(point) => self.turning(&point, soon.v),
                    None => soon.v,
                };
                if turn != 0 {
                    self.side = turn.signum();
                }
                let sign = if self.rest.is_loose() { self.side } else { turn.signum() };
                let wanted = loops.wanted(&seen, &now, self.friction(of_load, sign));
                (self.reference, self.forces) = (now, [force, wanted]);
                (loops.rate(&seen, &now, &soon, wanted).saturating_sub(self.flow.unknown()), 0)
            }
        }
    }
}

impl ControlLaw for Cascade {
    type Settings = Settings;

    fn pushes_beyond(settings: &Settings) -> u32 {
        settings.rest.away
    }

    fn fault(&self) -> Option<Fault> {
        self.doubt.fault
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
        let null = measured.null(config);
        self.valve.sense(&settings.valve, measured.spool, null);
        let force = self.unhidden(settings, settings.air.force(pressures));
        match self.begun {
            Begun::No => self.begin_at(settings, count, force),
            Begun::Once => self.begin_again(settings, count, &reference, force),
            Begun::Yes => {}
        }
        let missed = self.observe(settings, count, measured.pressures, pressures, force);
        self.plan(settings, count, &reference, force);
        if !self.motion.stuck && !self.for_load && !self.load.is_lost() {
            self.lag.learn(&settings.lag, missed);
        }
        let (rate, least) = self.rate(settings, &reference, force);
        let is_short = settings.valve.is_short(&self.air, rate);
        self.short = if is_short { self.short.saturating_add(1) } else { 0 };
        let place = settings.valve.opening(&self.air, rate, least);
        self.valve.drive(&settings.valve, self.lag.by_pace, place).saturating_add(null)
    }
}
