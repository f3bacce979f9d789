//! The windows of the controller's estimator for velocity and acceleration.

use pneudrive_controller::estimator::MAX_WINDOW_SAMPLES;

/// The requirement on a window, for messages.
pub const WHOLE_WINDOW: &str = "it must be a whole number from 1 to 63";

/// A valid window of the controller's estimator, samples.
pub fn whole_window(samples: f64) -> Option<u8> {
    (1..=MAX_WINDOW_SAMPLES).find(|&whole| f64::from(whole) == samples)
}
