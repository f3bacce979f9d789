//! The command for a rate of the force, and where it takes the spool.

use super::air::Air;
use super::constants::Constants;
use super::observers::sign_of;
use super::spring::Spool;
use super::stepper::Stepped;

#[derive(Default)]
pub struct Valve {
    s: f64,
    s_dot: f64,
    u: f64,
    held: f64,
    first: f64,
    pub mean: f64,
    spool: Spool,
    stepped: Stepped,
}

/// Where the spool has to be; `least`: a rate that is not worth a move.
pub fn opening(c: &Constants, air: &Air, rate: f64, least: f64) -> f64 {
    let shut = c.conductance(f64::NEG_INFINITY);
    let [extends, retracts] = [(air.extend, air.narrow[0]), (air.retract, air.narrow[1])]
        .map(|(open, narrow)| c.rate(open, narrow, shut));
    let net = rate - (extends - retracts);
    let (open, narrow, leak) =
        if net > 0.0 { (air.extend, air.narrow[0], extends) } else { (air.retract, air.narrow[1], retracts) };
    let share = ((net.abs() + leak) / open.max(1e-9)).min(1.0);
    if net.abs() < least {
        return 0.0;
    }
    sign_of(net) * c.place(c.part(narrow, share)).clamp(0.0, 2048.0)
}

impl Valve {
    fn through_play(&mut self, c: &Constants) -> f64 {
        self.held = self.held.clamp(self.s - c.play, self.s + c.play);
        self.held
    }

    fn move_spool(&mut self, m: [f64; 4], pace: f64) {
        let (s, v, u) = (self.s - self.u, self.s_dot, self.u);
        let (to, speed) = (u + m[0] * s + m[1] * v, m[2] * s + m[3] * v);
        self.s += (to - self.s) / pace;
        self.s_dot += (speed - v) / pace;
    }

    pub fn sense(&mut self, c: &Constants, raw: i16) {
        if let Some(spring) = &c.spring {
            self.spool.sense(spring, raw);
            self.mean = self.spool.mean;
        } else if let Some(stepper) = &c.stepper {
            self.stepped.sense(c, stepper, raw);
            self.mean = self.stepped.mean;
        }
    }

    pub fn drive(&mut self, c: &Constants, pace: f64, wanted: f64) -> i16 {
        if let Some(spring) = &c.spring {
            return self.spool.drive(c, spring, wanted);
        }
        if let Some(stepper) = &c.stepper {
            return self.stepped.drive(stepper, wanted);
        }
        self.first = self.through_play(c);
        self.move_spool(c.to_output, pace);
        let (near, play) = (2.0, c.play);
        let goal = if wanted > self.held + near {
            wanted + play
        } else if wanted < self.held - near {
            wanted - play
        } else {
            self.s.clamp(self.held - play, self.held + play)
        };
        let u = self.s + 2.25 * (goal - self.s) - 0.5 * c.lag * self.s_dot;
        u.round().clamp(-c.largest, c.largest) as i16
    }

    /// What was commanded: where that takes the spool until the next sample.
    pub fn commanded(&mut self, c: &Constants, pace: f64, counts: i16) {
        if let Some(spring) = &c.spring {
            self.spool.commanded(c, spring, counts);
            return;
        }
        self.u = f64::from(counts);
        let (first, middle) = (self.first, self.through_play(c));
        self.move_spool(c.to_sample, pace);
        let last = self.through_play(c);
        self.mean = 0.5 * (c.share * (first + middle) + (1.0 - c.share) * (middle + last));
    }
}
