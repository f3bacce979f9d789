//! What pressure sensors with a lag do not show yet.
//!
//! ```text
//! L Fm' = F - Fm                                        L: lag of both sensors, Fm: force of what they show
//! e = F - Fm,    e' = F' - e/L                           F' = E C - R C - K v, by the model of valve and air
//! of a sample   e+ = a e + b r,   a = exp(-T/L),   b = (1 - a) L/T        r: F' of a sample
//! ```
//!
//! So F = Fm + e follows the valve at once, and stays with the sensors: nothing is made steeper, so that their noise is no larger.
//! The flow that the model does not know shows with the lag, to [`super::flow`] and to [`super::lag`].
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | e | Q24 | -2 to 2 | 2^-24 (1 + b)/(1 - a) |
//! | a, b | Q30 | 0 to 1 | |

use super::number::{ONE, product, within};
use crate::parameters::{Parameters, id};

/// The lag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// a and b, Q30.
    decay: i32,
    gain: i32,
}

/// What the sensors do not show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hidden {
    /// e.
    force: i32,
    /// The rate as the sensors show it.
    rate: i32,
}

impl Constants {
    pub(super) fn of(parameters: &Parameters) -> Constants {
        let get = |id| parameters.scalar(id);
        Constants { decay: get(id::CASCADE_SENSOR_DECAY), gain: get(id::CASCADE_SENSOR_GAIN) }
    }

    /// Whether the sensors show all at once.
    pub(super) fn are_swift(&self) -> bool {
        self.gain == 0
    }
}

impl Hidden {
    /// e after a sample with this rate of the force, Q24.
    pub(super) fn take(&mut self, constants: &Constants, rate: i32) -> i32 {
        let left = product(self.force, constants.decay, 30);
        self.force = within(left.saturating_add(product(rate, constants.gain, 30)), 2 * ONE);
        self.force
    }

    /// A rate (Q24) as sensors with the lag show it: `s+ = r + a (s - r)`.
    pub(super) fn shown(&mut self, constants: &Constants, rate: i32) -> i32 {
        if constants.are_swift() {
            return rate;
        }
        let old = self.rate.saturating_sub(rate);
        self.rate = rate.saturating_add(product(old, constants.decay, 30));
        self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sensor of the first order shows a force that rises for a while: with e it is that force, whatever the lag, and
    /// the rate is the one that such a sensor shows.
    #[test]
    fn what_is_shown_and_what_is_hidden_are_the_force() {
        for lag in [0.0, 0.3, 2.0, 5.0, 1000.0] {
            let decay = if lag > 0.0 { f64::exp(-1.0 / lag) } else { 0.0 };
            let q30 = |value: f64| (value * f64::from(1 << 30)).round() as i32;
            let gain = (1.0 - decay) * lag;
            let constants = Constants { decay: q30(decay), gain: q30(gain) };
            assert_eq!(constants.are_swift(), lag == 0.0);
            let (mut hidden, mut force, mut shown, mut of_rate) = (Hidden::default(), 0.0, 0.0, 0.0);
            for k in 0..3000 {
                let rate = if k < 50 { 100_000.0 } else { -3.0 };
                // The lag of a ramp over a sample.
                shown = force + rate - gain * rate + decay * (shown - force);
                force += rate;
                let error = f64::from(hidden.take(&constants, rate as i32)) + shown - force;
                assert!(error.abs() < 2.0 + 1.5 * lag, "lag {lag}, sample {k}: {error}");
                of_rate += (1.0 - decay) * (rate - of_rate);
                let error = f64::from(hidden.shown(&constants, rate as i32)) - of_rate;
                assert!(error.abs() < 2.0 + lag, "lag {lag}, sample {k}: {error} of the rate");
            }
        }
    }
}
