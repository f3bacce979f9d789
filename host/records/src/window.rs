//! The windows over which the controller's estimator forms velocity and acceleration.

use pneudrive_controller::estimator::MAX_WINDOW_SAMPLES;

/// What is wrong with a window that [`whole_window`] refuses.
pub const WHOLE_WINDOW: &str = "it must be a whole number from 1 to 63";

/// A window that the controller's estimator can have, samples.
pub fn whole_window(samples: f64) -> Option<u8> {
    (1..=MAX_WINDOW_SAMPLES).find(|&whole| f64::from(whole) == samples)
}
