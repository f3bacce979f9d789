//! What the load shall do: in motion, or at rest.

use super::air::Air;
use super::constants::Constants;
use super::load::Load;
use super::observers::{Flow, Motion, sign_of};
use super::trajectory::{Point, Trajectory};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Rest { held: f64, centre: f64 },
    Move,
}

pub struct Plan {
    target: i32,
    trajectory: Trajectory,
    phase: Phase,
    short: u32,
    stops: bool,
    side: f64,
    stood: i32,
    rested: u32,
    turns: u32,
    turned: f64,
    looseness: i32,
    tries: u32,
}

/// What is known at a sample.
pub struct Seen<'a> {
    pub c: &'a Constants,
    pub motion: &'a mut Motion,
    pub load: &'a mut Load,
    pub count: i32,
    pub force: f64,
}

impl Seen<'_> {
    /// A force no farther from a centre than a part of the running friction.
    fn within_friction(&self, force: f64, centre: f64, part: f64) -> f64 {
        let both = [1.0, -1.0].map(|sign| self.load.slide(self.c, sign).abs());
        let most = part * both[0].min(both[1]);
        force.clamp(centre - most, centre + most)
    }
}

impl Plan {
    pub fn new(count: i32, force: f64) -> Plan {
        Plan {
            target: count,
            trajectory: Trajectory { length: 1.0, ..Trajectory::default() },
            phase: Phase::Rest { held: force, centre: force },
            short: 0,
            stops: false,
            side: 0.0,
            stood: count,
            rested: 0,
            turns: 0,
            turned: 0.0,
            looseness: 0,
            tries: 0,
        }
    }

    /// What the valve was short of.
    pub fn is_short(&mut self, air: &Air, rate: f64) {
        let open = if rate > 0.0 { air.extend } else { air.retract };
        self.short = if rate.abs() > 1.2 * open { self.short + 1 } else { 0 };
    }

    pub fn go_on(&mut self, seen: &mut Seen, target: i32) {
        let (c, v) = (seen.c, seen.motion.v);
        let error = f64::from(target - seen.count);
        if target != self.target {
            (self.target, self.turns, self.tries) = (target, 0, 0);
            if matches!(self.phase, Phase::Rest { .. }) {
                seen.load.may_be_exchanged();
            }
            if seen.motion.stuck && error.abs() < c.counts(40e-6) {
                self.rest(seen);
            } else {
                self.set_off(seen);
            }
            return;
        }
        match self.phase {
            Phase::Move => {
                self.trajectory.k += 1.0;
                let over = self.trajectory.k - self.trajectory.length;
                if over >= 0.0 && (self.stops || over > c.samples(0.1)) {
                    self.set_off(seen);
                } else if over >= 0.0 && self.has_come(seen, over, error.abs()) {
                    self.rest(seen);
                } else if f64::from(self.short) > c.samples(8e-3) && v.abs() > c.speed(0.02) {
                    self.set_off(seen);
                }
            }
            Phase::Rest { held, centre } => {
                if self.is_lost(seen, error.abs()) {
                    if seen.motion.stuck {
                        seen.motion.d = centre;
                    }
                    self.set_off(seen);
                    return;
                }
                let pull = 16e3 * c.period * c.count * c.coulomb.iter().sum::<f64>() / 2.0;
                let change = if error.abs() > c.counts(20e-6) { pull * error } else { 0.0 };
                self.phase = Phase::Rest { held: seen.within_friction(held + change, centre, 1.0), centre };
            }
        }
    }

    fn has_come(&mut self, seen: &Seen, over: f64, error: f64) -> bool {
        let (c, motion) = (seen.c, &seen.motion);
        if motion.v.abs() > c.speed(3e-3) && sign_of(motion.v) != self.turned {
            (self.turns, self.turned) = (self.turns + 1, sign_of(motion.v));
            if self.turns > 2 {
                self.looseness = (self.looseness + 1).min(4);
            }
        }
        let still = c.samples(6e-3).max(4.0);
        let wait = if self.looseness > 0 { 0.0 } else { still };
        let slow = c.speed(5e-3) * (1.0 + 0.25 * f64::from(self.looseness));
        let near = c.counts(40e-6) * 2.0_f64.powi(self.looseness);
        f64::from(motion.still) >= still || over > wait && motion.v.abs() < slow && error < near
    }

    fn is_lost(&mut self, seen: &mut Seen, error: f64) -> bool {
        let (c, motion) = (seen.c, &mut *seen.motion);
        self.rested += 1;
        motion.stuck = f64::from(motion.still) > c.samples(10e-3);
        let settled = f64::from(self.rested) > c.samples(0.03);
        let from = f64::from(seen.count - self.stood).abs();
        let moved = motion.still == 0 && self.looseness == 0 && from > c.counts(60e-6);
        if !motion.stuck && error > c.counts(0.9e-3) || settled && moved {
            motion.stuck = false;
            return true;
        }
        let again = settled && motion.stuck && error > c.counts(0.2e-3) && self.tries < 4;
        self.tries += u32::from(again);
        again
    }

    fn rest(&mut self, seen: &mut Seen) {
        seen.motion.stuck = true;
        (self.stood, self.rested) = (seen.count, 0);
        let centre = match self.phase {
            Phase::Rest { centre, .. } => centre,
            Phase::Move => (1024.0 * seen.load.standing(seen.c)).round() / 1024.0,
        };
        self.phase = Phase::Rest { held: seen.within_friction(seen.force, centre, 0.4), centre };
    }

    fn set_off(&mut self, seen: &Seen) {
        let (c, motion) = (seen.c, &seen.motion);
        let target = f64::from(self.target) + 0.5;
        let distance = (target - motion.x).abs();
        let air = c.air(0.5 * (motion.x + target), [0.6; 2]);
        let [v, a, flow] = c.trajectory;
        let [a, flow] = [a, flow].map(|limit| limit / seen.load.mass());
        let j = flow * air.extend.min(air.retract) * c.acceleration;
        let length = (2.19 * distance / v).max((7.5 * distance / a).sqrt()).max((52.5 * distance / j).cbrt());
        let length = length.max(6.0).max(2.0 * c.tau).ceil();
        let v = motion.v.abs();
        let stop = (0.9375 * v / a).max((2.887 * v / j).sqrt());
        let stop = (stop + 1.0).floor().max(6.0).max((2.0 * c.tau).floor() + 1.0);
        let travel = 0.5 * motion.v * stop;
        let left = target - motion.x;
        self.stops = v > c.speed(0.1) && if motion.v > 0.0 { left < travel } else { left > travel };
        let (target, distance, length) =
            if self.stops { (motion.x + travel, travel.abs(), stop) } else { (target, distance, length) };
        let most = 2.0 * distance / (length * length);
        let a = motion.acceleration(c, seen.load, seen.force).clamp(-most, most);
        self.trajectory = Trajectory::to(target, Point { x: motion.x, v: motion.v, a, j: 0.0 }, length);
        (self.phase, self.short, self.turned) = (Phase::Move, 0, sign_of(motion.v));
    }

    /// The rate of the force, and which one is not worth a move of the valve.
    pub fn rate(&mut self, seen: &Seen, air: &Air, flow: &Flow, dead_time: f64) -> (f64, f64) {
        let Seen { c, motion, load, force, .. } = seen;
        let slower = dead_time / c.tau;
        let (f, p) = (c.force_pole / slower, c.position_pole / slower);
        let mass = load.mass() / c.acceleration;
        match self.phase {
            Phase::Move => {
                let most = 0.8 * (1.0 - c.exhaust) * c.ratio.min(1.0);
                let now = self.trajectory.at(self.trajectory.k);
                let soon = self.trajectory.at(self.trajectory.k + dead_time);
                if soon.v != 0.0 {
                    self.side = sign_of(soon.v);
                }
                let sign = if self.looseness > 0 { self.side } else { sign_of(soon.v) };
                let back = 2.0 * p * (now.v - motion.v) + p * p * (now.x - motion.x);
                let friction =
                    if self.tries > 0 && motion.stuck { sign * c.stiction } else { load.slide(c, sign) };
                let wanted = mass * (now.a + back) + load.viscous(c) * now.v + friction + motion.d;
                let rate = mass * soon.j
                    + load.viscous(c) * soon.a
                    + f * (wanted.clamp(-most, most) - force)
                    + air.stiffness * (motion.v + soon.v - now.v);
                (rate - flow.unknown, 0.0)
            }
            // 20 N/s of 560 N.
            Phase::Rest { held, .. } => {
                let f = if motion.stuck { 0.125 * f } else { f };
                (f * (held - mass * 50.0 * c.period * motion.v - force), 0.036 * c.period)
            }
        }
    }
}
