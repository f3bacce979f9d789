//! The two parameters that the hosts change: those of velocity and acceleration gain.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;

/// Their values.
pub type Pair = [i32; 2];

/// The pair in these parameters.
#[must_use]
pub fn pair(parameters: &Parameters) -> Pair {
    [id::VELOCITY_GAIN, id::ACCELERATION_GAIN].map(|id| parameters.get(id).unwrap_or(0))
}
