//! A plant under known commands: those recorded on a rig drive its model.
//!
//! The loop is not closed a second time. A controller that sees a model instead of the rig gives other commands, and two
//! closed loops diverge; with the recorded commands, a deviation is due to the plant alone.

use pneudrive_controller::Command;

pub use crate::component::sensors::Reading;
use crate::plant::{Accuracy, Plant};
use crate::values::Rig;
use pneudrive_solver::IntegrationError;

/// Sample period and delay of the output after the sample, whole microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// From sample to sample.
    pub period_us: u64,
    /// From a sample to its output; less than the period.
    pub delay_us: u64,
}

/// The readings at the samples 0, 1, 2... of the plant of `rig`, in the initial state of its test, under
/// the commands computed from these samples: as many as there are commands.
///
/// # Errors
/// When the integration fails.
pub fn follow(
    rig: &Rig,
    accuracy: Accuracy,
    timing: Timing,
    commands: &[Command],
) -> Result<Vec<Reading>, IntegrationError> {
    let mut plant = Plant::new(rig, accuracy, 0).with_timing(timing.period_us, timing.delay_us);
    let mut readings = Vec::with_capacity(commands.len());
    for &command in commands {
        readings.push(plant.reading()?);
        plant.command(command);
        plant.next_sample()?;
    }
    Ok(readings)
}
