//! The force that pressure sensors with a lag do not show yet.

use super::constants::Constants;

#[derive(Default)]
pub struct Hidden {
    force: f64,
    rate: f64,
}

impl Hidden {
    /// After a sample with this rate of the force.
    pub fn take(&mut self, c: &Constants, rate: f64) -> f64 {
        let [decay, gain] = c.sensors;
        self.force = (decay * self.force + gain * rate).clamp(-2.0, 2.0);
        self.force
    }

    /// The rate as the sensors show it.
    pub fn shown(&mut self, c: &Constants, rate: f64) -> f64 {
        self.rate = rate + c.sensors[0] * (self.rate - rate);
        self.rate
    }
}
