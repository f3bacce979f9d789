//! A spool on a spring with dry friction, that is measured.

use super::constants::{Constants, Spring};
use super::observers::sign_of;

/// Places nearer than this are the same, counts.
const NEAR: f64 = 8.0;

#[derive(Default)]
pub struct Spool {
    begun: bool,
    s: f64,
    s_dot: f64,
    command: f64,
    pull: f64,
    pub mean: f64,
    before: f64,
}

impl Spool {
    pub fn sense(&mut self, spring: &Spring, raw: i16) {
        let measured = spring.offset + spring.gain * f64::from(raw);
        if !self.begun {
            *self = Spool { begun: true, s: measured, mean: measured, ..Spool::default() };
            return;
        }
        let error = measured - self.s;
        self.s += 0.7 * error;
        self.s_dot += 0.4 * error;
        self.mean += 0.5 * error;
    }

    pub fn drive(&mut self, c: &Constants, spring: &Spring, wanted: f64) -> i16 {
        self.before = self.glide(spring, c.to_output, c.share);
        let most = c.largest - c.play;
        let change = self.pull_to(spring, most, wanted).clamp(-most, most) - self.pull;
        let u = if change.abs() < 2.0 { self.command } else { self.pull + change + c.play * sign_of(change) };
        u.round().clamp(-c.largest, c.largest) as i16
    }

    pub fn commanded(&mut self, c: &Constants, spring: &Spring, counts: i16) {
        self.command = f64::from(counts);
        self.pull = self.pull.clamp(self.command - c.play, self.command + c.play);
        let after = self.glide(spring, c.to_sample, 1.0 - c.share);
        self.mean = c.share * self.before + (1.0 - c.share) * after;
    }

    fn pull_to(&self, spring: &Spring, most: f64, wanted: f64) -> f64 {
        let travel = wanted - self.s;
        let is_still = self.s_dot.abs() < spring.still;
        if is_still && travel.abs() < NEAR {
            return self.s;
        }
        let sign = sign_of(if self.s_dot.abs() > 2.0 * spring.still { self.s_dot } else { travel });
        let stay = |of_speed: f64| self.s + of_speed * self.s_dot + sign * spring.friction;
        let within = |[of_travel, of_speed]: [f64; 2]| {
            let (from, to) = (stay(of_speed), stay(of_speed) + of_travel * travel);
            if to.abs() <= most {
                1.0
            } else {
                ((most * sign_of(to - from) - from) / (to - from)).clamp(0.0, 1.0)
            }
        };
        let share = within(spring.first).min(within(spring.second));
        let pull = stay(spring.first[1]) + share * spring.first[0] * travel;
        let away = self.s + 1.05 * spring.stiction * sign_of(travel);
        if is_still && (pull - away) * travel < 0.0 { away } else { pull }
    }

    fn glide(&mut self, spring: &Spring, m: [f64; 4], time: f64) -> f64 {
        let (s, v) = (self.s, self.s_dot);
        let free = self.pull - s;
        if v == 0.0 && free.abs() <= spring.stiction {
            return s;
        }
        let sign = sign_of(if v == 0.0 { free } else { v });
        let rest = self.pull - sign * spring.friction;
        let (next, then) = (rest + m[0] * (s - rest) + m[1] * v, m[2] * (s - rest) + m[3] * v);
        (self.s, self.s_dot) = (next, then);
        if then * sign < 0.0 {
            let gone = v.abs() / (v.abs() + then.abs());
            (self.s, self.s_dot) = (s + 0.5 * v * gone * time, 0.0);
            let free = self.pull - self.s;
            if free.abs() > spring.stiction {
                self.s_dot = -m[2] * (free - spring.friction * sign_of(free)) * (1.0 - gone);
                self.s += 0.5 * self.s_dot * (1.0 - gone) * time;
            }
        }
        0.5 * (s + self.s)
    }
}
