//! The lag of the valve, learned by what the flow observer misses.

use super::constants::Constants;
use super::squares::Squares;

/// The flow observer's error of a rate, and what it makes of it.
#[derive(Default)]
struct Missed {
    error: f64,
    rate: f64,
}

impl Missed {
    fn take(&mut self, q: f64, rate: f64) {
        self.rate += (1.0 - q).powi(2) * self.error;
        self.error = q * q * self.error + rate - self.rate;
    }
}

pub struct Lag {
    squares: Squares<2>,
    of_flow: Missed,
    of_change: Missed,
    last: f64,
    pub pace: f64,
}

impl Default for Lag {
    fn default() -> Lag {
        let (of_flow, of_change) = Default::default();
        Lag { squares: Squares::default(), of_flow, of_change, last: 0.0, pace: 1.0 }
    }
}

impl Lag {
    pub fn take(&mut self, c: &Constants, rate: f64) {
        let change = rate - std::mem::replace(&mut self.last, rate);
        self.of_flow.take(c.flow_decay, rate);
        self.of_change.take(c.flow_decay, -change);
    }

    pub fn learn(&mut self, c: &Constants, error: f64) {
        if c.noise == 0.0 || c.lag == 0.0 {
            return;
        }
        let errors = [self.of_flow.error, self.of_change.error];
        let millisecond = c.samples(1e-3);
        self.squares.fit(
            [0.1 * errors[0] / c.noise, millisecond * errors[1] / c.noise],
            error / c.noise,
            0.0,
        );
        if self.squares.unknown[1].abs() > 0.1 {
            let longer = std::mem::replace(&mut self.squares.unknown[1], 0.0) * millisecond;
            self.pace = (self.pace + longer / c.lag).clamp(0.5, 3.0);
        }
    }

    /// tau'
    pub fn dead_time(&self, c: &Constants) -> f64 {
        c.tau + (self.pace - 1.0) * c.lag / 1.5
    }
}
