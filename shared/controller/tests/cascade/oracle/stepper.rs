//! A spool that a stepper moves, a step a sample.

use super::constants::{Constants, Stepper};

#[derive(Default)]
pub struct Stepped {
    begun: bool,
    steps: f64,
    wanted: f64,
    owed: f64,
    pub mean: f64,
}

impl Stepped {
    pub fn sense(&mut self, c: &Constants, stepper: &Stepper, steps: i16) {
        let steps = f64::from(steps);
        let before = if self.begun { self.steps } else { steps };
        (self.begun, self.steps) = (true, steps);
        self.mean = (c.share * before + (1.0 - c.share) * steps) * stepper.step;
    }

    pub fn drive(&mut self, stepper: &Stepper, wanted: f64) -> i16 {
        self.owed = (self.owed + 0.5 * (self.wanted - self.mean)).clamp(-stepper.step, stepper.step);
        self.wanted = wanted;
        let away = (wanted + self.owed) / stepper.step - self.steps;
        let step = if away.abs() > 0.6 { away.signum() } else { 0.0 };
        (self.steps + step).clamp(-stepper.farthest, stepper.farthest) as i16
    }
}
