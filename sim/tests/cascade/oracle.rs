//! The law "cascade" in real numbers, written from its equations alone, in the units of its parameters.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;

/// The constants, as the rig's parameters have them.
struct Constants {
    stroke: f64,
    dead: [f64; 2],
    offset: f64,
    gain: f64,
    exhaust: f64,
    ratio: f64,
    n: f64,
    flow: [f64; 2],
    steep: [f64; 2],
    leak: f64,
    acceleration: f64,
    coulomb: [f64; 2],
    stiction: f64,
    viscous: f64,
    weight: f64,
    constant: f64,
    tau: f64,
    force_pole: f64,
    position_pole: f64,
    motion_decay: f64,
    flow_decay: f64,
    to_output: [f64; 4],
    to_sample: [f64; 4],
    lag: f64,
    share: f64,
    /// Largest command, counts.
    largest: f64,
    lap: f64,
    span: f64,
    play: f64,
    way: [f64; 3],
    noise: f64,
    /// s, m.
    period: f64,
    count: f64,
}

impl Constants {
    fn of(parameters: &Parameters) -> Constants {
        let get = |id, bits: i32| f64::from(parameters.get(id).expect("known id")) / 2.0_f64.powi(bits);
        let spool = |first: u16| [get(first, 30), get(first + 1, 30), get(first + 2, 28), get(first + 3, 30)];
        Constants {
            stroke: get(id::CASCADE_STROKE, 0),
            dead: [get(id::CASCADE_DEAD_LENGTH_1, 0), get(id::CASCADE_DEAD_LENGTH_2, 0)],
            offset: get(id::CASCADE_PRESSURE_OFFSET, 24),
            gain: get(id::CASCADE_PRESSURE_GAIN, 30),
            exhaust: get(id::CASCADE_EXHAUST_PRESSURE, 24),
            ratio: get(id::CASCADE_AREA_RATIO, 24),
            n: get(id::CASCADE_EXPONENT, 16),
            flow: [get(id::CASCADE_FLOW_SUPPLY, 16), get(id::CASCADE_FLOW_EXHAUST, 16)],
            steep: [get(id::CASCADE_STEEPNESS_SUPPLY, 16), get(id::CASCADE_STEEPNESS_EXHAUST, 16)],
            leak: get(id::CASCADE_LEAKAGE, 16),
            acceleration: get(id::CASCADE_ACCELERATION, 16),
            coulomb: [get(id::CASCADE_COULOMB_EXTEND, 24), get(id::CASCADE_COULOMB_RETRACT, 24)],
            stiction: get(id::CASCADE_STICTION, 24),
            viscous: get(id::CASCADE_VISCOUS, 30),
            weight: get(id::CASCADE_WEIGHT, 24),
            constant: get(id::CASCADE_STANDING_FORCE, 24),
            tau: get(id::CASCADE_DEAD_TIME, 16),
            force_pole: get(id::CASCADE_FORCE_POLE, 16),
            position_pole: get(id::CASCADE_POSITION_POLE, 16),
            motion_decay: get(id::CASCADE_MOTION_DECAY, 30),
            flow_decay: get(id::CASCADE_FLOW_DECAY, 30),
            to_output: spool(id::CASCADE_SPOOL_OUTPUT_PLACE),
            to_sample: spool(id::CASCADE_SPOOL_SAMPLE_PLACE),
            lag: get(id::CASCADE_SPOOL_LAG, 16),
            share: get(id::CASCADE_OUTPUT_SHARE, 16),
            largest: get(id::MAX_COMMAND_COUNTS, 0),
            lap: get(id::CASCADE_OVERLAP, 16),
            span: get(id::CASCADE_SPAN, 16),
            play: get(id::CASCADE_PLAY, 16),
            way: [
                get(id::CASCADE_WAY_SPEED, 16),
                get(id::CASCADE_WAY_ACCELERATION, 16),
                get(id::CASCADE_WAY_FLOW, 16),
            ],
            noise: get(id::CASCADE_LEARNING_NOISE, 24),
            period: get(id::PERIOD_US, 0) * 1e-6,
            count: get(id::ENCODER_PM_PER_COUNT, 0) * 1e-12,
        }
    }

    fn samples(&self, seconds: f64) -> f64 {
        seconds / self.period
    }

    fn counts(&self, metres: f64) -> f64 {
        metres / self.count
    }

    fn speed(&self, metres_per_second: f64) -> f64 {
        metres_per_second * self.period / self.count
    }

    fn coulomb(&self, sign: f64) -> f64 {
        sign * self.coulomb[usize::from(sign < 0.0)]
    }

    fn path(&self, up: f64, drop: f64, which: usize) -> f64 {
        let y = (self.steep[which] * drop / up).clamp(0.0, 1.0);
        self.flow[which] * up * (y * (2.0 - y)).sqrt()
    }

    fn air(&self, x: f64, p: [f64; 2]) -> Air {
        let x = x.clamp(0.0, self.stroke);
        let l = [self.dead[0] + x, self.dead[1] + self.stroke - x];
        let fill = |i: usize| self.path(1.0, 1.0 - p[i], 0) / l[i];
        let vent = |i: usize| self.path(p[i], p[i] - self.exhaust, 1) / l[i];
        Air {
            stiffness: self.n * (p[0] / l[0] + self.ratio * p[1] / l[1]),
            extend: fill(0) + vent(1),
            retract: vent(0) + fill(1),
        }
    }

    fn conductance(&self, spool: f64) -> f64 {
        self.leak + (1.0 - self.leak) * ((spool - self.lap) / self.span).clamp(0.0, 1.0)
    }
}

#[derive(Clone, Copy, Default)]
struct Air {
    stiffness: f64,
    extend: f64,
    retract: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Point {
    x: f64,
    v: f64,
    a: f64,
    j: f64,
}

#[derive(Default)]
struct Way {
    c: [f64; 8],
    k: f64,
    length: f64,
}

impl Way {
    fn to(target: f64, from: Point, length: f64) -> Way {
        let t = length;
        let (c1, c2) = (from.v * t, from.a * t * t / 2.0);
        let r = [target - from.x - c1 - c2, -c1 - 2.0 * c2, -2.0 * c2];
        let sum = |k: [f64; 3]| (0..3).map(|i| k[i] * r[i]).sum::<f64>();
        let c = [
            sum([35.0, -15.0, 2.5]),
            sum([-84.0, 39.0, -7.0]),
            sum([70.0, -34.0, 6.5]),
            sum([-20.0, 10.0, -2.0]),
        ];
        Way { c: [from.x, c1, c2, 0.0, c[0], c[1], c[2], c[3]], k: 0.0, length }
    }

    fn at(&self, k: f64) -> Point {
        let (s, t) = ((k / self.length).min(1.0), self.length);
        let mut p = [0.0; 4];
        for c in self.c.iter().rev() {
            p = [p[0] * s + c, p[1] * s + p[0], p[2] * s + p[1], p[3] * s + p[2]];
        }
        let moving = f64::from(u8::from(s < 1.0));
        Point {
            x: p[0],
            v: moving * p[1] / t,
            a: moving * 2.0 * p[2] / (t * t),
            j: moving * 6.0 * p[3] / (t * t * t),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Rest { held: f64, at: f64 },
    Move,
}

/// Three equal poles on speed, force and friction, and on what they began with.
struct Filter {
    v: [f64; 3],
    force: [f64; 3],
    slide: [f64; 3],
    left: [f64; 3],
}

pub struct Oracle {
    c: Constants,
    begun: bool,
    pub x: f64,
    pub v: f64,
    pub d: f64,
    last_force: f64,
    count: i32,
    still: u32,
    stuck: bool,
    flow_force: f64,
    pub unknown: f64,
    air: Air,
    theta: [f64; 4],
    p: [[f64; 4]; 4],
    filter: Option<Filter>,
    target: i32,
    way: Way,
    phase: Phase,
    short: u32,
    rested: u32,
    turns: u32,
    turned: f64,
    side: f64,
    elastic: bool,
    lost: u32,
    stood: f64,
    pub wanted: f64,
    s: f64,
    s_dot: f64,
    u: f64,
    held: f64,
    first: f64,
    mean: f64,
}

fn sign_of(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

impl Oracle {
    pub fn of(parameters: &Parameters) -> Oracle {
        let c = Constants::of(parameters);
        let d = c.weight + c.constant;
        let unit = |i: usize| std::array::from_fn(|j| f64::from(u8::from(i == j)));
        Oracle {
            begun: false,
            x: 0.0,
            v: 0.0,
            d,
            last_force: 0.0,
            count: 0,
            still: 1000,
            stuck: true,
            flow_force: 0.0,
            unknown: 0.0,
            air: Air::default(),
            theta: [0.0; 4],
            p: std::array::from_fn(unit),
            filter: None,
            target: 0,
            way: Way { length: 1.0, ..Way::default() },
            phase: Phase::Rest { held: 0.0, at: 0.0 },
            short: 0,
            rested: 0,
            turns: 0,
            turned: 0.0,
            side: 0.0,
            elastic: false,
            lost: 0,
            stood: 0.0,
            wanted: 0.0,
            s: 0.0,
            s_dot: 0.0,
            u: 0.0,
            held: 0.0,
            first: 0.0,
            mean: 0.0,
            c,
        }
    }

    pub fn mass(&self) -> f64 {
        (1.0 + 0.3 * self.theta[0]).clamp(0.25, 4.0)
    }

    pub fn friction(&self) -> f64 {
        (1.0 + 0.3 * self.theta[1]).clamp(0.3, 2.0)
    }

    pub fn viscous(&self) -> f64 {
        self.c.viscous * (1.0 + self.theta[3]).clamp(0.0, 5.0)
    }

    fn standing(&self) -> f64 {
        self.mass() * self.c.weight + self.c.constant + self.c.stiction * self.theta[2]
    }

    fn slide(&self, sign: f64) -> f64 {
        self.friction() * self.c.coulomb(sign)
    }

    pub fn step(&mut self, count: i32, raw: [i16; 2], target: i32) -> i16 {
        let p = raw.map(|raw| (self.c.offset + self.c.gain * f64::from(raw)).max(0.5 * self.c.exhaust));
        let force = p[0] - self.c.ratio * p[1] - self.c.exhaust * (1.0 - self.c.ratio);
        let position = f64::from(count) + 0.5;
        if !self.begun {
            self.begun = true;
            (self.x, self.stood, self.count, self.target) = (position, position, count, count);
            (self.flow_force, self.last_force) = (force, force);
            self.d = self.d.clamp(force - self.c.stiction, force + self.c.stiction);
            self.phase = Phase::Rest { held: force, at: force };
        }
        self.observe_motion(count, position, force);
        self.observe_flow(p, force);
        self.learn(count, force);
        self.plan(target, position, force);
        let rate = self.rate(force);
        let open = if rate > 0.0 { self.air.extend } else { self.air.retract };
        self.short = if rate.abs() > 1.2 * open { self.short + 1 } else { 0 };
        let goal = self.spool_for(rate);
        self.drive(goal)
    }

    fn observe_motion(&mut self, count: i32, position: f64, force: f64) {
        let mean = 0.5 * (force + std::mem::replace(&mut self.last_force, force));
        let moved = f64::from((count - self.count).signum());
        self.still = if moved == 0.0 { self.still + 1 } else { 0 };
        let alpha = self.c.acceleration / self.mass();
        if self.stuck {
            (self.x, self.v) = (position, 0.0);
            if moved != 0.0 {
                self.stuck = false;
                let least = self.c.speed(0.5 * self.c.period);
                let pull = (alpha * (force - self.d - self.slide(moved)) * moved).max(least);
                self.v = moved * pull.sqrt();
                self.x = position - 0.4 * moved;
            }
        } else if f64::from(self.still) > self.c.samples(5e-3) && self.v.abs() < self.c.speed(10e-3) {
            (self.stuck, self.v) = (true, 0.0);
        } else {
            let sliding = self.slide(sign_of(self.v)) * (self.v.abs() / self.c.speed(2e-3)).min(1.0);
            let a = alpha * (mean - self.viscous() * self.v - sliding - self.d);
            let expected = self.x + self.v + 0.5 * a;
            let error = position - expected;
            let q = self.c.motion_decay;
            self.x = expected + (1.0 - q * q * q) * error;
            self.v += a + 1.5 * (1.0 - q).powi(2) * (1.0 + q) * error;
            self.d = (self.d - (1.0 - q).powi(3) / alpha * error).clamp(-1.0, 1.0);
        }
    }

    fn observe_flow(&mut self, p: [f64; 2], force: f64) {
        let flow = self.air.extend * self.c.conductance(self.mean)
            - self.air.retract * self.c.conductance(-self.mean);
        let q = self.c.flow_decay;
        let expected = self.flow_force + flow - self.air.stiffness * self.v + self.unknown;
        let error = force - expected;
        self.flow_force = expected + (1.0 - q * q) * error;
        self.unknown += (1.0 - q).powi(2) * error;
        self.air = self.c.air(self.x, p);
    }

    fn learn(&mut self, count: i32, force: f64) {
        let step = f64::from(count - std::mem::replace(&mut self.count, count));
        if self.stuck || self.c.noise == 0.0 {
            self.filter = None;
            return;
        }
        let slide = self.c.coulomb(if self.v > 0.0 { 1.0 } else { -1.0 });
        let rest = self.standing() + self.friction() * slide;
        let filter = self.filter.get_or_insert(Filter {
            v: [0.0; 3],
            force: [rest; 3],
            slide: [slide; 3],
            left: [1.0; 3],
        });
        let w = 300.0 * self.c.period;
        let k = w / (1.0 + w);
        let pass = |y: &mut [f64; 3], u: f64| {
            let before = y[2];
            y[0] += k * (u - y[0]);
            y[1] += k * (y[0] - y[1]);
            y[2] += k * (y[1] - y[2]);
            before
        };
        let before = pass(&mut filter.v, step);
        let (speed, a) = (0.5 * (filter.v[2] + before), filter.v[2] - before);
        let force_then = pass(&mut filter.force, force);
        let slide_then = pass(&mut filter.slide, slide);
        let left = pass(&mut filter.left, 0.0);
        if speed.abs() <= self.c.speed(0.03) || speed * self.v <= 0.0 {
            return;
        }
        let c = &self.c;
        let inertia = a / c.acceleration + c.weight;
        let phi = [0.3 * inertia, 0.3 * slide_then, c.stiction, c.viscous * speed].map(|phi| phi / c.noise);
        let known = inertia + slide_then + c.viscous * speed;
        let y = (force_then - c.constant - known) / c.noise;
        let doubt = 1.0 + (left * c.stiction / c.noise).powi(2);
        let p_phi: [f64; 4] = std::array::from_fn(|i| (0..4).map(|j| self.p[i][j] * phi[j]).sum());
        let s = doubt + (0..4).map(|i| phi[i] * p_phi[i]).sum::<f64>();
        let error = y - (0..4).map(|i| phi[i] * self.theta[i]).sum::<f64>();
        for i in 0..4 {
            self.theta[i] += p_phi[i] / s * error;
            for j in 0..4 {
                self.p[i][j] -= p_phi[i] * p_phi[j] / s;
            }
        }
    }

    fn motion(&self, force: f64) -> Point {
        if self.stuck {
            return Point { x: self.x, ..Point::default() };
        }
        let pull = force - self.viscous() * self.v - self.slide(sign_of(self.v)) - self.d;
        Point { x: self.x, v: self.v, a: self.c.acceleration / self.mass() * pull, j: 0.0 }
    }

    fn set_off(&mut self, target: f64, force: f64) {
        let from = self.motion(force);
        let distance = (target - from.x).abs();
        let air = self.c.air(0.5 * (from.x + target), [0.6; 2]);
        let [v, a, flow] = self.c.way;
        let j = flow * air.extend.min(air.retract) * self.c.acceleration;
        let length = (2.19 * distance / v).max((7.5 * distance / a).sqrt()).max((52.5 * distance / j).cbrt());
        let length = length.max(6.0).max(2.0 * self.c.tau).ceil();
        let most = 2.0 * distance / (length * length);
        self.way = Way::to(target, Point { a: from.a.clamp(-most, most), ..from }, length);
        (self.phase, self.short) = (Phase::Move, 0);
        (self.turns, self.turned) = (0, sign_of(self.v));
    }

    fn plan(&mut self, target: i32, position: f64, force: f64) {
        let goal = f64::from(target) + 0.5;
        let error = goal - position;
        if target != self.target {
            (self.target, self.lost) = (target, 0);
            if self.stuck && error.abs() < self.c.counts(40e-6) {
                self.rest(position, force);
            } else {
                self.set_off(goal, force);
            }
            return;
        }
        match self.phase {
            Phase::Move => {
                self.way.k += 1.0;
                let over = self.way.k - self.way.length;
                if over >= 0.0 && self.v.abs() > self.c.speed(3e-3) && sign_of(self.v) != self.turned {
                    (self.turns, self.turned) = (self.turns + 1, sign_of(self.v));
                    self.elastic |= self.turns > 3;
                }
                let (slow, near, wait) = if self.elastic { (8e-3, 0.3e-3, 0.0) } else { (5e-3, 40e-6, 6e-3) };
                let still = f64::from(self.still) >= self.c.samples(6e-3).max(4.0);
                let creeps = over > self.c.samples(wait)
                    && self.v.abs() < self.c.speed(slow)
                    && error.abs() < self.c.counts(near);
                if still && over >= 0.0 || creeps || over >= 0.0 && self.turns > 8 {
                    self.rest(position, force);
                } else if f64::from(self.short) > self.c.samples(8e-3) && self.v.abs() > self.c.speed(0.02) {
                    self.set_off(goal, force);
                }
            }
            Phase::Rest { .. }
                if !self.elastic
                    && self.still == 0
                    && (position - self.stood).abs() > self.c.counts(60e-6) =>
            {
                self.stuck = false;
                self.set_off(goal, force);
            }
            Phase::Rest { .. } if self.elastic && error.abs() > self.c.counts(0.9e-3) => {
                self.lost += 1;
                (self.elastic, self.stuck) = (self.lost < 3, false);
                self.set_off(goal, force);
            }
            Phase::Rest { held, at } => {
                self.rested += 1;
                self.stuck = !self.elastic || f64::from(self.still) > self.c.samples(10e-3);
                let crept = (position - self.stood).abs() > self.c.counts(15e-6) + 1.0;
                self.elastic |= crept && f64::from(self.rested) > self.c.samples(0.02);
                let some = if self.elastic { 3.0 } else { 0.35 } * self.friction() * self.c.stiction;
                let rate = if error.abs() > self.c.counts(20e-6) {
                    // 1e6 N/(m s) of 8 kg: 1.25e5 1/s^3 of the mass.
                    1.25e5 * self.c.period.powi(3) / self.c.acceleration * error
                } else if self.elastic {
                    0.0
                } else {
                    (self.standing() - held) / self.c.samples(0.05)
                };
                self.phase = Phase::Rest { held: (held + rate).clamp(at - some, at + some), at };
            }
        }
    }

    fn rest(&mut self, position: f64, force: f64) {
        (self.stuck, self.stood, self.rested) = (true, position, 0);
        self.phase = Phase::Rest { held: force, at: force };
    }

    fn rate(&mut self, force: f64) -> f64 {
        let c = &self.c;
        let most = 0.8 * (1.0 - c.exhaust) * c.ratio.min(1.0);
        let rate = match self.phase {
            Phase::Move => {
                let now = self.way.at(self.way.k);
                let soon = self.way.at(self.way.k + c.tau);
                if soon.v != 0.0 {
                    self.side = sign_of(soon.v);
                }
                let sign = if self.elastic { self.side } else { sign_of(soon.v) };
                let wp = c.position_pole;
                let mass = self.mass() / c.acceleration;
                let back = 2.0 * wp * (now.v - self.v) + wp * wp * (now.x - self.x);
                let wanted = mass * (now.a + back) + self.viscous() * now.v + self.slide(sign) + self.d;
                self.wanted = wanted.clamp(-most, most);
                mass * soon.j
                    + self.viscous() * soon.a
                    + c.force_pole * (self.wanted - force)
                    + self.air.stiffness * (self.v + soon.v - now.v)
            }
            Phase::Rest { held, .. } if self.elastic => {
                let inertia = self.mass() / c.acceleration;
                self.wanted = held - inertia * 65.0 * c.period * self.v;
                0.7 * c.force_pole * (self.wanted - force) + self.air.stiffness * self.v
            }
            Phase::Rest { held, .. } => {
                self.wanted = held;
                0.2 * c.force_pole * (held - force)
            }
        };
        rate - self.unknown
    }

    fn spool_for(&self, rate: f64) -> f64 {
        let (c, air) = (&self.c, &self.air);
        let net = rate - c.leak * (air.extend - air.retract);
        let open = if net > 0.0 { air.extend } else { air.retract };
        let share = ((net.abs() + c.leak * open) / open.max(1e-9)).min(1.0);
        // 20 N/s of 560 N.
        if matches!(self.phase, Phase::Rest { .. }) && net.abs() < 0.036 * c.period {
            return 0.0;
        }
        sign_of(net) * (c.lap + c.span * (share - c.leak).max(0.0) / (1.0 - c.leak)).clamp(0.0, 2048.0)
    }

    fn through_play(&mut self) -> f64 {
        self.held = self.held.clamp(self.s - self.c.play, self.s + self.c.play);
        self.held
    }

    fn move_spool(&mut self, m: [f64; 4]) {
        let (s, v, u) = (self.s - self.u, self.s_dot, self.u);
        (self.s, self.s_dot) = (u + m[0] * s + m[1] * v, m[2] * s + m[3] * v);
    }

    fn drive(&mut self, wanted: f64) -> i16 {
        let first = self.through_play();
        self.move_spool(self.c.to_output);
        let (near, play) = (2.0, self.c.play);
        let goal = if wanted > self.held + near {
            wanted + play
        } else if wanted < self.held - near {
            wanted - play
        } else {
            self.s.clamp(self.held - play, self.held + play)
        };
        let u = self.s + 2.25 * (goal - self.s) - 0.5 * self.c.lag * self.s_dot;
        self.first = first;
        u.round().clamp(-self.c.largest, self.c.largest) as i16
    }

    /// What was commanded: where that takes the spool until the next sample.
    pub fn commanded(&mut self, counts: i16) {
        self.u = f64::from(counts);
        let (first, middle) = (self.first, self.through_play());
        self.move_spool(self.c.to_sample);
        let last = self.through_play();
        self.mean = 0.5 * (self.c.share * (first + middle) + (1.0 - self.c.share) * (middle + last));
    }
}
