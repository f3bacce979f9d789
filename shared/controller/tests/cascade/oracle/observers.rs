//! Both observers: place, speed and standing force of the load; the rate of the force that the flow's model does not know.

use super::constants::Constants;
use super::load::Load;

pub fn sign_of(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

#[derive(Default)]
pub struct Motion {
    pub x: f64,
    pub v: f64,
    pub d: f64,
    pub stuck: bool,
    pub still: u32,
    count: i32,
    last_force: f64,
}

impl Motion {
    pub fn new(c: &Constants, count: i32, force: f64) -> Motion {
        let d = (c.weight + c.constant).clamp(force - c.stiction, force + c.stiction);
        let x = f64::from(count) + 0.5;
        Motion { x, v: 0.0, d, stuck: true, still: 1000, count, last_force: force }
    }

    /// Returns the step of the count.
    pub fn observe(&mut self, c: &Constants, load: &Load, count: i32, force: f64) -> f64 {
        let mean = 0.5 * (force + std::mem::replace(&mut self.last_force, force));
        let step = f64::from(count - std::mem::replace(&mut self.count, count));
        let (position, moved) = (f64::from(count) + 0.5, sign_of(step));
        self.still = if moved == 0.0 { self.still + 1 } else { 0 };
        let alpha = c.acceleration / load.mass();
        if self.stuck {
            (self.x, self.v) = (position, 0.0);
            if moved != 0.0 {
                self.stuck = false;
                let least = c.speed(0.5 * c.period);
                let pull = (alpha * (force - self.d - load.slide(c, moved)) * moved).max(least);
                self.v = moved * pull.sqrt();
                self.x = position - 0.4 * moved;
            }
        } else if f64::from(self.still) > c.samples(5e-3) && self.v.abs() < c.speed(10e-3) {
            (self.stuck, self.v) = (true, 0.0);
        } else {
            let sliding = load.slide(c, sign_of(self.v)) * (self.v.abs() / c.speed(2e-3)).min(1.0);
            let a = alpha * (mean - load.viscous(c) * self.v - sliding - self.d);
            let expected = self.x + self.v + 0.5 * a;
            let error = position - expected;
            let q = c.motion_decay;
            self.x = expected + (1.0 - q * q * q) * error;
            self.v += a + 1.5 * (1.0 - q).powi(2) * (1.0 + q) * error;
            self.d = (self.d - (1.0 - q).powi(3) / alpha * error).clamp(-1.0, 1.0);
        }
        step
    }

    /// The acceleration that it has.
    pub fn acceleration(&self, c: &Constants, load: &Load, force: f64) -> f64 {
        if self.stuck {
            return 0.0;
        }
        let pull = force - load.viscous(c) * self.v - load.slide(c, sign_of(self.v)) - self.d;
        c.acceleration / load.mass() * pull
    }
}

#[derive(Default)]
pub struct Flow {
    force: f64,
    pub unknown: f64,
}

impl Flow {
    pub fn new(force: f64) -> Flow {
        Flow { force, unknown: 0.0 }
    }

    /// Returns the error of what was expected.
    pub fn observe(&mut self, c: &Constants, force: f64, rate: f64) -> f64 {
        let q = c.flow_decay;
        let expected = self.force + rate + self.unknown;
        let error = force - expected;
        self.force = expected + (1.0 - q * q) * error;
        self.unknown += (1.0 - q).powi(2) * error;
        error
    }
}
